//! Glass: the direction and the amount of refracted light.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::Row;
use super::meshes::{block, mesh, round_mesh};
use super::radiance::{Depth, KnownRadiance, at, black, facing, glow, gray, picture, probe, stored};
use crate::bsdf::{Glass, Lobe, Material, MaterialId, TransportMode, textured};
use crate::camera::{Camera, Perspective, Pose};
use crate::film::FilmSpec;
use crate::integrator::Integrator;
use crate::integrators::whitted::Whitted;
use crate::light::{Environment, Light};
use crate::math::{Ray, Rgb, Transform, Wavelength, thin_film};
use crate::sampler::{Kind, SamplerSpec};
use crate::scene::Scene;
use crate::shape::{Quad, Sphere, TriangleMesh};
use crate::world::{World, WorldBuilder};

/// The rows.
pub fn rows() -> Vec<Row> {
    let mean = |id, what, scenes: Vec<KnownRadiance>| {
        scenes.into_iter().fold(Row::new(id, what, "confidence interval of the mean"), Row::radiance)
    };
    vec![
        parallel(),
        shift(),
        magnification(),
        thin_panes(),
        mean("O5", "light through 1 to 10 panes, 0.1 mm apart: (1 - R)/(1 + (2N - 1) R)", panes_in_a_row()),
        mean("O7", "light through a pane with all inner reflections: (1 - R)/(1 + R)", transmittance()),
        mean("O9", "light through an absorbing pane, index 1.5, optical depth 1", absorbing()),
        mean("O10", "light through a pane with at most 2, 4 or 6 boundaries", limited()),
        focus(),
        prism(),
        rainbow(),
        film(),
        mean("O15", "glass in uniform light: 1 from outside, n² within", uniform_field()),
    ]
}

/// Limits of the default settings.
const DEFAULT: Depth = Depth { max: 64, roulette: 4 };

/// O1. A ray that enters a slab at the angle θ leaves it at θ.
///
/// Within 2·10⁻⁶ rad: a few roundings of a unit vector. Near grazing the second interface magnifies the rounding of the direction inside
/// by dθ/dθt = n cos θt/cos θ, which the tolerance includes.
fn parallel() -> Row {
    let angles = [0.0, 1e-3, 1.0, 10.0, 30.0, 45.0, 60.0, 75.0, 85.0, 89.0, 89.8];
    let row = Row::new("O1", "angle between the rays before and behind a slab, rad", "2e-6, and the rounding inside near grazing");
    [1.33f32, 1.5, 2.42].into_iter().flat_map(|eta| angles.map(|degrees| (eta, degrees))).fold(row, |row, (eta, degrees)| {
        let (n, theta) = (f64::from(eta), f64::to_radians(degrees));
        let inside = (theta.sin() / n).asin();
        let tolerance = 2e-6f64.max(f64::from(f32::EPSILON) * n * inside.cos() / theta.cos());
        [false, true].into_iter().fold(row, |row, closed| {
            row.number(format!("index {eta}, {degrees}°, {}", form(closed)), 0.0, tolerance, move || {
                let ray = slanting(degrees);
                through(&slab(eta, closed), ray, 2)
                    .map_or(f64::NAN, |out| out.direction.as_dvec3().cross(ray.direction.as_dvec3()).length())
            })
        })
    })
}

fn form(closed: bool) -> &'static str {
    if closed { "box" } else { "two squares" }
}

/// O2. d = t sin θ (1 − cos θ/(n cos θt)), for n = 1.5 and t = 1; numbers computed with 20 digits.
fn shift() -> Row {
    let table = [
        (15.0, 0.0896145574),
        (30.0, 0.1938137822),
        (45.0, 0.3291423082),
        (60.0, 0.5124720132),
        (75.0, 0.7480800141),
        (85.0, 0.9187717616),
    ];
    let row =
        Row::new("O2", "sideways shift of a ray by a slab of thickness 1, index 1.5", "the starts of two rays, 1e-6 off their surfaces");
    table.into_iter().flat_map(|row| [false, true].map(|closed| (row, closed))).fold(row, |row, ((degrees, exact), closed)| {
        row.number(format!("{degrees}°, {}", form(closed)), exact, 1e-5, move || {
            let ray = slanting(degrees);
            through(&slab(1.5, closed), ray, 2)
                .map_or(f64::NAN, |out| (out.origin - ray.origin).as_dvec3().cross(ray.direction.as_dvec3()).length())
        })
    })
}

/// O11. A ball lens n = 1.5, R = 1: a ray at height h crosses the axis at h/sin 2(θi − θt) from the centre.
fn focus() -> Row {
    let table = [(1e-4f32, 1.5), (0.1, 1.4958270631), (0.3, 1.461978437), (0.5, 1.3915729489), (0.7, 1.2777870234)];
    let row = Row::new("O11", "where a ball lens brings rays to its axis", "roundings of directions");
    table.into_iter().fold(row, |row, (h, exact)| {
        row.number(format!("height {h}"), exact, 2e-5, move || {
            let mut world = World::builder(no_camera());
            let glass = world.material(Material::glass(1.5));
            world.shape(Sphere { radius: 1.0 }, Transform::IDENTITY, glass, None);
            let ball = world.build().expect("a ball");
            through(&ball, Ray::new(Vec3::new(h, 0.0, 5.0), -Vec3::Z), 2).map_or(f64::NAN, |out| {
                let (p, d) = (out.origin.as_dvec3(), out.direction.as_dvec3());
                d.z * p.x / d.x - p.z
            })
        })
    })
}

/// O3. M = D/(D − t(1 − 1/n)): 6 mm at 2 m, 100 mm at 1 m, 1 m at 3 m.
fn magnification() -> Row {
    let row = Row::new("O3", "magnification of a ruler behind a pane", "0.05 %: tan is the angle to 1e-4").peers("Baikal magnified (#142)");
    let panes = [(2.0, 0.006, 1.001001001), (1.0, 0.1, 1.034482759), (3.0, 1.0, 1.125)];
    let stands = [(false, 0.1), (true, 0.1), (true, 0.6)];
    panes.into_iter().flat_map(|pane| stands.map(|stand| (pane, stand))).fold(
        row,
        |row, ((distance, thickness, exact), (closed, share))| {
            let stand = Stand { distance, near: share * distance, thickness, closed, offset: 0.0 };
            row.number(format!("{distance} m, {thickness} m thick at {share}, {}", form(closed)), exact, 5e-4 * exact, move || {
                read(stand, &whitted())
            })
        },
    )
}

/// O4. Thin panes do not magnify, at any position in the world: no distance is too short for a ray.
fn thin_panes() -> Row {
    let row =
        Row::new("O4", "the same with ever thinner panes, at any place in the world", "0.1 %").peers("thin panes vanish in Baikal (#142)");
    let stands = [1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5].into_iter().flat_map(|t| [0.0, 1e3, 1e5].map(|o| (t, o)));
    stands.flat_map(|stand| [false, true].map(|closed| (stand, closed))).fold(row, |row, ((thickness, offset), closed)| {
        let stand = Stand { distance: 2.0, near: 0.5, thickness, closed, offset };
        let exact = stand.magnification(1.5);
        row.number(format!("{thickness:e} m, x {offset:e}, {}", form(closed)), exact, 1e-3 * exact, move || read(stand, &whitted()))
    })
}

/// O9. T = (1 − R)² e^−τ / (1 − R² e^−2τ), τ = σ t / cos θt; the numbers confirmed by a simulation of 10⁷ paths.
fn absorbing() -> Vec<KnownRadiance> {
    let table = [(0.0, 0.3391111229), (30.0, 0.3181373350), (45.0, 0.2903338618), (60.0, 0.2439254592), (75.0, 0.1516899626)];
    let law = |(degrees, transmitted): (f64, f64)| {
        let mut world = before_lamp(degrees);
        let glass = world.material(Material::from(textured::Dielectric::smooth(1.5, Rgb::WHITE).absorbing(Rgb::gray(1.0))));
        pane(&mut world, glass, DVec3::ZERO, [-0.5, 0.5], 400.0);
        KnownRadiance::new(format!("{degrees}°"), world, transmitted, DEFAULT).resolution(2e-3, 1e-2)
    };
    table.map(law).into()
}

/// O10. Each boundary that is passed or reflects counts. With 2: (1 − R)², and each two more add a term R² of the series.
fn limited() -> Vec<KnownRadiance> {
    let law = |(depth, transmitted): (u32, f64)| {
        let mut world = before_lamp(0.0);
        let glass = world.material(Material::glass(1.5));
        pane(&mut world, glass, DVec3::ZERO, [-0.05, 0.05], 400.0);
        KnownRadiance::new(format!("{depth} boundaries"), world, transmitted, Depth::exactly(depth)).resolution(1e-3, 3e-3)
    };
    [(2, 0.9216), (4, 0.92307456), (6, 0.9230769193)].map(law).into()
}

/// O12. A ray that passes a prism symmetrically: sin((A + D)/2) = n sin(A/2) for the apex A and the deviation D.
fn prism() -> Row {
    let row = Row::new("O12", "least deviation by a prism of 60°, degrees", "1e-4°: roundings of two refractions");
    let plain = |(eta, exact)| (format!("index {eta}"), Material::glass(eta), Wavelength::D_LINE, f64::from(eta), exact);
    let plain = [(1.5f32, 37.180755781), (1.522_378_7, 39.1383), (1.516_798_4, 38.6466), (1.514_321_5, 38.4291)].map(plain);
    // The lines F, d and C of the spectrum. Indices by Sellmeier's formula and the deviations were computed in double precision elsewhere.
    let lines = [("F", Wavelength::F_LINE), ("d", Wavelength::D_LINE), ("C", Wavelength::C_LINE)];
    let glasses = [
        ("BK7", Glass::Bk7, [(1.522376290, 39.138108736), (1.516800035, 38.646698505), (1.514322347, 38.429136704)]),
        ("SF11", Glass::Sf11, [(1.806512744, 69.178920092), (1.784719942, 66.342628821), (1.775955111, 65.240394830)]),
    ];
    let dispersive = glasses.into_iter().flat_map(|(name, glass, exact)| {
        lines.into_iter().zip(exact).map(move |((line, wavelength), (eta, exact))| {
            let material = Material::dispersive(textured::Dielectric::smooth(1.5, Rgb::WHITE), glass.dispersion());
            (format!("{name}, line {line}"), material, wavelength, eta, exact)
        })
    });
    plain.into_iter().chain(dispersive).fold(row, |row, (setup, material, wavelength, eta, exact)| {
        row.number(setup, exact, 1e-4, move || {
            let mut world = World::builder(no_camera());
            let glass = world.material(material.clone());
            // The apex is at the top, and the two faces are 30° from the vertical.
            let half = 1.0f32 / 3f32.sqrt();
            let corners =
                [-4.0f32, 4.0].into_iter().flat_map(|z| [Vec3::new(0.0, 1.0, z), Vec3::new(-half, 0.0, z), Vec3::new(half, 0.0, z)]);
            let triangles = vec![[0, 2, 1], [3, 4, 5], [0, 4, 3], [0, 1, 4], [0, 5, 2], [0, 3, 5], [1, 5, 4], [1, 2, 5]];
            world.shape(TriangleMesh::new(mesh(corners.collect(), triangles)), Transform::IDENTITY, glass, None);
            let prism = world.build().expect("a prism");
            // The angle of incidence whose refracted ray is level: sin i = n sin 30°. The normal of the left face points up by 30°.
            let rises = (0.5 * eta).asin() - 30f64.to_radians();
            let direction = DVec3::new(rises.cos(), rises.sin(), 0.0);
            let origin = DVec3::new(-0.5 * f64::from(half), 0.5, 0.0) - direction * 2.0;
            let ray = Ray::new((origin - prism.origin()).as_vec3(), direction.as_vec3().normalize());
            refracted(&prism, ray, 2, wavelength).map_or(f64::NAN, |out| {
                let out = out.direction.as_dvec3();
                direction.cross(out).length().atan2(direction.dot(out)).to_degrees()
            })
        })
    })
}

/// O14. The reflectance of a film on a base. The numbers were computed in double precision elsewhere, by the film's characteristic matrix.
fn film() -> Row {
    let row = Row::new("O14", "reflectance of a thin film", "1e-9: roundings of phases in f64");
    // Wavelength and angle, thickness, indices of film and base, reflectance. A quarter of 550 nm of magnesium fluoride on glass, the bare
    // glass, half of 550 nm; a soap film; films on aluminium and on titanium.
    let (quarter, half) = (550.0 / 4.0 / 1.38, 550.0 / 2.0 / 1.38);
    let table = [
        ((550.0f32, 0.0), quarter, 1.38, [1.52, 0.0], 0.012600790215),
        ((550.0, 0.0), 0.0, 1.38, [1.52, 0.0], 0.042579994961),
        ((550.0, 0.0), half, 1.38, [1.52, 0.0], 0.042579994961),
        ((550.0, 45.0), quarter, 1.38, [1.52, 0.0], 0.020701728868),
        ((550.0, 0.0), 300.0, 1.33, [1.0, 0.0], 0.075430202997),
        ((650.0, 30.0), 300.0, 1.33, [1.0, 0.0], 0.015322460283),
        ((450.0, 60.0), 300.0, 1.33, [1.0, 0.0], 0.163027484362),
        ((550.0, 0.0), 100.0, 1.5, [0.96, 6.69], 0.855260955512),
        ((450.0, 60.0), 100.0, 1.5, [0.96, 6.69], 0.860849801058),
        ((600.0, 45.0), 50.0, 2.4, [2.5, 3.3], 0.064487184632),
        ((600.0, 80.0), 250.0, 2.4, [2.5, 3.3], 0.479206463412),
    ];
    table.into_iter().fold(row, |row, ((nanometres, degrees), thickness, film, base, exact)| {
        let setup = format!("{thickness:.0} nm of index {film} on {} + {}i, {nanometres} nm, {degrees}°", base[0], base[1]);
        row.number(setup, exact, 1e-9, move || {
            thin_film::reflectance(Wavelength::new(nanometres), f64::to_radians(degrees).cos(), thickness, film, base)
        })
    })
}

/// O13. Descartes' ray: of all rays reflected once within a drop, the one that is turned least.
fn rainbow() -> Row {
    let row = Row::new("O13", "least deviation by a drop with one reflection inside, degrees", "1e-4°");
    let water = || Material::dispersive(textured::Dielectric::smooth(1.5, Rgb::WHITE), Glass::Water.dispersion());
    let drops = [
        ("index 1.333", Material::glass(1.333), Wavelength::D_LINE, 137.92189262),
        ("water at 400 nm", water(), Wavelength::new(400.0), 139.43257699),
        ("water at 700 nm", water(), Wavelength::new(700.0), 137.55952252),
    ];
    drops.into_iter().fold(row, |row, (setup, material, wavelength, exact)| {
        row.number(setup, exact, 1e-4, move || {
            let mut world = World::builder(no_camera());
            let water = world.material(material.clone());
            world.shape(Sphere { radius: 1.0 }, Transform::IDENTITY, water, None);
            let drop = world.build().expect("a drop");
            let lobe = |ray: &Ray, wanted: Lobe| {
                let mut surface = drop.surface(ray, &drop.intersect(ray)?);
                surface.bsdf = surface.bsdf.at_wavelength(wavelength);
                let mut lobes = surface.delta_lobes(-ray.direction, TransportMode::Radiance);
                let (wi, _) = lobes.find(|(_, sample)| sample.lobe == wanted)?;
                Some(surface.spawn(wi, 0.0))
            };
            let deviation = |height: f64| {
                let ray = Ray::new(Vec3::new(height as f32, 0.0, 5.0), -Vec3::Z);
                let within = lobe(&ray, Lobe::Transmission)?;
                let out = lobe(&lobe(&within, Lobe::Reflection)?, Lobe::Transmission)?.direction.as_dvec3();
                Some(out.x.hypot(out.y).atan2(-out.z).to_degrees())
            };
            // Near the least deviation the height counts only by its square.
            (8500..8700).filter_map(|k| deviation(f64::from(k) * 1e-4)).fold(f64::INFINITY, f64::min)
        })
    })
}

fn whitted() -> Whitted {
    Whitted { max_depth: 2, ..Whitted::default() }
}

/// Adds a pane between two planes across z. Its rims are open and far away.
pub fn pane(world: &mut WorldBuilder, glass: MaterialId, offset: DVec3, z: [f64; 2], size: f64) {
    for (z, normal) in z.into_iter().zip([-DVec3::Z, DVec3::Z]) {
        world.shape(Quad { size: [size; 2] }, facing(offset + DVec3::Z * z, normal), glass, None);
    }
}

/// A slab 1 m thick: two squares, or a closed box.
fn slab(eta: f32, closed: bool) -> World {
    let mut world = World::builder(no_camera());
    let glass = world.material(Material::glass(eta));
    if closed {
        world.shape(TriangleMesh::new(block(Vec3::new(50.0, 50.0, 0.5))), Transform::IDENTITY, glass, None);
    } else {
        pane(&mut world, glass, DVec3::ZERO, [-0.5, 0.5], 100.0);
    }
    world.build().expect("a slab")
}

/// A camera for scenes that are not rendered.
pub fn no_camera() -> Camera {
    probe(DVec3::Z * 5.0, DVec3::ZERO)
}

/// The ray after refraction at the given number of interfaces; `None` if it meets fewer, or none of its light passes. It starts at the last
/// of them.
pub fn through(scene: &World, ray: Ray, interfaces: usize) -> Option<Ray> {
    let origin = scene.origin().as_vec3();
    let ray = passed(scene, Ray::new(ray.origin - origin, ray.direction), interfaces)?;
    Some(Ray::new(ray.origin + origin, ray.direction))
}

/// The result of [`through`] for a ray in the coordinates of the built scene.
pub fn passed(scene: &World, ray: Ray, interfaces: usize) -> Option<Ray> {
    refracted(scene, ray, interfaces, Wavelength::D_LINE)
}

/// The result of [`passed`] for light of a wavelength.
fn refracted(scene: &World, mut ray: Ray, interfaces: usize, wavelength: Wavelength) -> Option<Ray> {
    for _ in 0..interfaces {
        let mut surface = scene.surface(&ray, &scene.intersect(&ray)?);
        surface.bsdf = surface.bsdf.at_wavelength(wavelength);
        let mut lobes = surface.delta_lobes(-ray.direction, TransportMode::Radiance);
        let (wi, _) = lobes.find(|(_, sample)| sample.lobe == Lobe::Transmission)?;
        ray = surface.spawn(wi, 0.0);
    }
    Some(ray)
}

/// A ray in the plane y = 0 that meets the plane z = ½ above the origin at `degrees` from its normal.
pub fn slanting(degrees: f64) -> Ray {
    let direction = DVec3::new(degrees.to_radians().sin(), 0.0, -degrees.to_radians().cos());
    Ray::new((DVec3::Z * 0.5 - direction * 0.25).as_vec3(), direction.as_vec3().normalize())
}

/// Reflectance of unpolarised light, by Fresnel's equations as the textbooks have them.
pub fn reflectance(degrees: f64, n: f64) -> f64 {
    let cos_i = degrees.to_radians().cos();
    let cos_t = (1.0 - (degrees.to_radians().sin() / n).powi(2)).sqrt();
    let s = (cos_i - n * cos_t) / (cos_i + n * cos_t);
    let p = (n * cos_i - cos_t) / (n * cos_i + cos_t);
    0.5 * (s * s + p * p)
}

/// A black room in which a lamp fills the plane z = −1, seen from the other side at `degrees` from the normal through the origin.
pub fn before_lamp(degrees: f64) -> WorldBuilder {
    let from = DVec3::new(-degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
    let mut world = World::builder(probe(from * 2.0, DVec3::ZERO));
    let dark = world.material(black());
    world.shape(Quad { size: [4000.0; 2] }, facing(-DVec3::Z, DVec3::Z), dark, glow(1.0));
    world
}

/// O7. The transmittance of a pane including all inner reflections: T = (1 − R)/(1 + R).
///
/// R is the mean of both polarisations at each interface, to which a renderer without polarisation converges. Without matte surfaces `path`
/// uses the same random numbers as `nee` and gives the same result, so it is not asked.
fn transmittance() -> Vec<KnownRadiance> {
    let table =
        [(0.0, 0.9230769231), (30.0, 0.9202655325), (45.0, 0.9043267915), (60.0, 0.8362324627), (75.0, 0.5960920478), (85.0, 0.2400796378)];
    let law = |(degrees, transmitted): (f64, f64)| {
        let mut world = before_lamp(degrees);
        let glass = world.material(Material::glass(1.5));
        pane(&mut world, glass, DVec3::ZERO, [-0.05, 0.05], 400.0);
        let quick = if degrees > 70.0 { 1e-2 } else { 3e-3 };
        KnownRadiance::new(format!("{degrees}°"), world, transmitted, DEFAULT).resolution(1e-3, quick)
    };
    table.map(law).into()
}

/// O5. N panes, 0.1 mm apart: T = (1 − R)/(1 + (2N − 1)R).
fn panes_in_a_row() -> Vec<KnownRadiance> {
    let law = |(count, transmitted): (u32, f64)| {
        let mut world = before_lamp(0.0);
        let glass = world.material(Material::glass(1.5));
        for k in 0..count {
            let near = 0.05 - f64::from(k) * 0.0041;
            pane(&mut world, glass, DVec3::ZERO, [near - 0.004, near], 4.0);
        }
        KnownRadiance::new(format!("{count} panes"), world, transmitted, Depth::exactly(1000)).resolution(2e-3, 1e-2)
    };
    [(1, 0.9230769231), (2, 0.8571428571), (3, 0.8), (10, 0.5454545455)].map(law).into()
}

fn sphere_of_glass(mesh: bool, camera: Camera) -> WorldBuilder {
    let mut world = World::builder(camera);
    let glass = world.material(Material::glass(1.5));
    if mesh {
        world.shape(TriangleMesh::new(round_mesh(3)), Transform::IDENTITY, glass, None);
    } else {
        world.shape(Sphere { radius: 1.0 }, Transform::IDENTITY, glass, None);
    }
    world.light(Light::Environment(Environment { radiance: stored(gray(1.0)) }));
    world
}

/// O15. Glass is invisible in uniform light of radiance 1: seen from outside the radiance is 1 everywhere, and inside it is n².
///
/// In a sphere the angle to the surface stays the same, so that light that entered leaves again, and within `max_depth` reflections almost
/// nothing is left. In a mesh some light is trapped for long, so the depth is larger.
fn uniform_field() -> Vec<KnownRadiance> {
    let outside = |(mesh, x): (bool, f64)| {
        let world = sphere_of_glass(mesh, probe(DVec3::new(x, 0.1, 4.0), DVec3::new(x, 0.1, 0.0)));
        let name = format!("outside, x {x}, mesh {mesh}");
        KnownRadiance::new(name, world, 1.0, Depth { max: 4000, roulette: 4 }).resolution(1e-3, 3e-3)
    };
    let inside = |(mesh, towards): (bool, DVec3)| {
        let from = DVec3::new(0.1, 0.2, 0.1);
        let world = sphere_of_glass(mesh, probe(from, from + towards));
        let name = format!("inside towards {towards}, mesh {mesh}");
        KnownRadiance::new(name, world, 2.25, Depth { max: 4000, roulette: 4 })
    };
    let ways = [DVec3::X, DVec3::new(0.3, -0.5, 0.8)];
    let from_outside = [(false, 0.0), (false, 0.5), (false, 0.9), (true, 0.05), (true, 0.5), (true, 0.9)].map(outside);
    from_outside.into_iter().chain(ways.into_iter().flat_map(|way| [inside((false, way)), inside((true, way))])).collect()
}

/// The picture is a row of pixels over ±1/50 of the distance, with angles at which tan θ = θ to 10⁻⁴.
const WIDTH: u32 = 1024;
const HALF_WIDTH: f64 = 0.02;

/// Positions of the camera, a pane and a ruler behind it.
#[derive(Clone, Copy, Debug)]
pub struct Stand {
    /// From the camera to the ruler (m).
    pub distance: f64,
    /// From the camera to the near face (m).
    pub near: f64,
    /// Of the pane (m).
    pub thickness: f64,
    /// Whether the pane is a closed box. Otherwise it is two quads.
    pub closed: bool,
    /// Coordinate of the camera in the world, the same on every axis (m).
    pub offset: f64,
}

impl Stand {
    /// Builds the scene. Without glass the edge of the ruler appears half way from the middle of the row to its right end.
    pub fn scene(&self, glass: bool) -> Arc<World> {
        let eye = DVec3::splat(self.offset);
        let aspect = f64::from(WIDTH);
        let fov = 2.0 * (HALF_WIDTH / aspect).atan().to_degrees();
        let mut world = World::builder(Camera::Perspective(Perspective::new(Pose::new(&at(eye)), fov, 0.0, 1.0)));
        let (dark, clear) = (world.material(black()), world.material(Material::glass(1.5)));
        let edge = 0.5 * HALF_WIDTH * self.distance;
        let ruler = DVec3::new(edge - 2.0, 0.0, -self.distance);
        world.shape(Quad { size: [4.0, 4.0] }, facing(eye + ruler, DVec3::Z), dark, glow(1.0));
        if glass && self.closed {
            let half = Vec3::new(1.0, 1.0, 0.5 * self.thickness as f32);
            world.shape(TriangleMesh::new(block(half)), at(eye - DVec3::Z * (self.near + 0.5 * self.thickness)), clear, None);
        } else if glass {
            pane(&mut world, clear, eye, [-self.near - self.thickness, -self.near], 2.0);
        }
        Arc::new(world.build().expect("a pane"))
    }

    /// The magnification M = D/(D − t(1 − 1/n)), which does not depend on the position of the pane.
    pub fn magnification(&self, n: f64) -> f64 {
        self.distance / (self.distance - self.thickness * (1.0 - 1.0 / n))
    }
}

/// Distance of the ruler's edge from the middle of the row (pixels), computed from the light left of the edge.
///
/// The depth allows only two interfaces, because faint images by inner reflections must not count.
pub fn edge(scene: Arc<dyn Scene>, integrator: &dyn Integrator) -> f64 {
    let sampler = SamplerSpec { kind: Kind::Stratified, spp: 64, seed: 1, ..SamplerSpec::default() };
    let image = picture(scene, integrator, FilmSpec::new(WIDTH, 1), sampler);
    let row: Vec<f64> = image.pixels().map(|[r, _, _]| f64::from(r)).collect();
    let plateau = row[0];
    row.iter().sum::<f64>() / plateau - 0.5 * f64::from(WIDTH)
}

/// The measured magnification.
pub fn read(stand: Stand, integrator: &dyn Integrator) -> f64 {
    edge(stand.scene(true), integrator) / edge(stand.scene(false), integrator)
}
