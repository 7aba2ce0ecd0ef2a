//! Glass: the direction and amount of refracted light, and how typical mistakes would look.

mod distances;
pub mod faults;
mod open_bodies;
mod ruler;
mod touching;

use std::sync::Arc;

use glam::{DVec3, Vec3};
use pt::bsdf::{Lobe, Material, MaterialId, TransportMode, textured};
use pt::camera::{Camera, Perspective, Pose};
use pt::film::FilmSpec;
use pt::integrators::ALL;
use pt::light::{Environment, Light};
use pt::math::{Ray, Transform};
use pt::sampler::SamplerSpec;
use pt::scene::Scene;
use pt::shape::{MeshData, MeshPart, Quad, Sphere, TriangleMesh};
use pt::world::{World, WorldBuilder};

use crate::scenes::{Depth, Effort, Law, at, black, confirm, facing, glow, gray, integrator, picture, probe, stored, two_sided};

/// The integrator with its default options.
const DEFAULT: Depth = Depth { max: 64, roulette: 4 };

/// Adds a pane between two planes across z. Its rims are open and far away.
pub fn pane(world: &mut WorldBuilder, glass: MaterialId, offset: DVec3, z: [f64; 2], size: f64) {
    for (z, normal) in z.into_iter().zip([-DVec3::Z, DVec3::Z]) {
        world.shape(Quad { size: [size; 2] }, facing(offset + DVec3::Z * z, normal), glass, None);
    }
}

/// A closed box around the origin; `half` are its half extents.
pub fn block(half: Vec3) -> MeshData {
    let positions = (0..8).map(|k| Vec3::from_array([0, 1, 2].map(|axis| if k >> axis & 1 == 1 { 1.0 } else { -1.0 })) * half).collect();
    let triangles: Vec<[u32; 3]> =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]].into_iter().flat_map(halves).collect();
    let parts = vec![MeshPart { triangles: 0..triangles.len() as u32, ..MeshPart::default() }];
    MeshData { positions, triangles, parts, ..MeshData::default() }
}

fn halves([a, b, c, d]: [u32; 4]) -> [[u32; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// A unit sphere of flat triangles: an octahedron, each triangle divided by four `levels` times.
pub fn round_mesh(levels: u32) -> MeshData {
    let mut faces: Vec<[Vec3; 3]> = vec![];
    for signs in 0..8 {
        let [x, y, z] = [0, 1, 2].map(|axis| if signs >> axis & 1 == 1 { -1.0 } else { 1.0 });
        let corners = [Vec3::X * x, Vec3::Y * y, Vec3::Z * z];
        faces.push(if x * y * z > 0.0 { corners } else { [corners[0], corners[2], corners[1]] });
    }
    for _ in 0..levels {
        let split = |[a, b, c]: [Vec3; 3]| {
            let [ab, bc, ca] = [a + b, b + c, c + a].map(Vec3::normalize);
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        faces = faces.into_iter().flat_map(split).collect();
    }
    let count = faces.len() as u32;
    let parts = vec![MeshPart { triangles: 0..count, ..MeshPart::default() }];
    let triangles = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    MeshData { positions: faces.into_iter().flatten().collect(), triangles, parts, ..MeshData::default() }
}

/// A camera for scenes that are not rendered.
fn no_camera() -> Camera {
    probe(DVec3::Z * 5.0, DVec3::ZERO)
}

/// The ray after refraction at the given number of interfaces. It starts at the last of them.
fn through(scene: &World, ray: Ray, interfaces: usize) -> Ray {
    let origin = scene.origin().as_vec3();
    let ray = passed(scene, Ray::new(ray.origin - origin, ray.direction), interfaces);
    Ray::new(ray.origin + origin, ray.direction)
}

/// The result of [`through`] for a ray in the coordinates of the built scene.
fn passed(scene: &World, mut ray: Ray, interfaces: usize) -> Ray {
    for k in 0..interfaces {
        let hit = scene.intersect(&ray).unwrap_or_else(|| panic!("no interface {k}"));
        let surface = scene.surface(&ray, &hit);
        let transmitted = surface.delta_lobes(-ray.direction, TransportMode::Radiance).find(|(_, s)| s.lobe == Lobe::Transmission);
        let (wi, _) = transmitted.unwrap_or_else(|| panic!("nothing passes interface {k}"));
        ray = surface.spawn(wi, 0.0);
    }
    ray
}

/// A ray in the plane y = 0 that meets the plane z = ½ above the origin at `degrees` from its normal.
fn slanting(degrees: f64) -> Ray {
    let direction = DVec3::new(degrees.to_radians().sin(), 0.0, -degrees.to_radians().cos());
    Ray::new((DVec3::Z * 0.5 - direction * 0.25).as_vec3(), direction.as_vec3().normalize())
}

/// Two slabs 1 m thick: one of two quads, and one that is a closed box.
fn slabs(eta: f32) -> [World; 2] {
    let slab = |closed: bool| {
        let mut world = World::builder(no_camera());
        let glass = world.material(Material::glass(eta));
        if closed {
            world.shape(TriangleMesh::new(block(Vec3::new(50.0, 50.0, 0.5))), Transform::IDENTITY, glass, None);
        } else {
            pane(&mut world, glass, DVec3::ZERO, [-0.5, 0.5], 100.0);
        }
        world.build().unwrap()
    };
    [false, true].map(slab)
}

/// O1. A ray that enters a slab at the angle θ leaves it at θ: 10° in, 10.000° out.
///
/// Within 2·10⁻⁶ rad: a few roundings of a unit vector. Near grazing the second interface magnifies the rounding of the direction inside by
/// dθ/dθt = n cos θt/cos θ, which the tolerance includes.
#[test]
fn slab_is_parallel() {
    for eta in [1.33f32, 1.5, 2.42] {
        for (slab, degrees) in
            slabs(eta).iter().flat_map(|slab| [0.0, 1e-3, 1.0, 10.0, 30.0, 45.0, 60.0, 75.0, 85.0, 89.0, 89.8].map(|d| (slab, d)))
        {
            let ray = slanting(degrees);
            let out = through(slab, ray, 2).direction.as_dvec3();
            let (n, theta) = (f64::from(eta), degrees.to_radians());
            let inside = (theta.sin() / n).asin();
            let granted = 2e-6f64.max(f64::from(f32::EPSILON) * n * inside.cos() / theta.cos());
            let off = out.cross(ray.direction.as_dvec3()).length();
            assert!(off <= granted, "η {eta}, {degrees}°: off by {off:e} rad");
        }
    }
    let out = through(&slabs(1.5)[0], slanting(10.0), 2).direction;
    let leaves = f64::from(out.x).atan2(f64::from(-out.z)).to_degrees();
    assert!((leaves - 10.0).abs() < 5e-5, "{leaves}");
}

/// O2. d = t sin θ (1 − cos θ/(n cos θt)), for n = 1.5 and t = 1; numbers computed with 20 digits.
#[test]
fn slab_shifts_sideways() {
    let table = [
        (15.0, 0.0896145574),
        (30.0, 0.1938137822),
        (45.0, 0.3291423082),
        (60.0, 0.5124720132),
        (75.0, 0.7480800141),
        (85.0, 0.9187717616),
    ];
    for (slab, (degrees, shift)) in slabs(1.5).iter().flat_map(|slab| table.map(|row| (slab, row))) {
        let ray = slanting(degrees);
        let out = through(slab, ray, 2);
        let measured = (out.origin - ray.origin).as_dvec3().cross(ray.direction.as_dvec3()).length();
        // The two ray origins are each at most 32·2⁻²⁴·½ m off their surface.
        assert!((measured - shift).abs() < 1e-5, "{degrees}°: {measured} for {shift}");
    }
}

/// O11. A ball lens n = 1.5, R = 1: a ray at height h crosses the axis at h/sin 2(θi − θt) from the centre.
#[test]
fn ball_lens_focuses() {
    let mut world = World::builder(no_camera());
    let glass = world.material(Material::glass(1.5));
    world.shape(Sphere { radius: 1.0 }, Transform::IDENTITY, glass, None);
    let ball = world.build().unwrap();
    for (h, crossing) in [(1e-4, 1.5), (0.1, 1.4958270631), (0.3, 1.461978437), (0.5, 1.3915729489), (0.7, 1.2777870234)] {
        let out = through(&ball, Ray::new(Vec3::new(h, 0.0, 5.0), -Vec3::Z), 2);
        let (p, d) = (out.origin.as_dvec3(), out.direction.as_dvec3());
        let measured = -(p.z - d.z * p.x / d.x);
        assert!((measured - crossing).abs() < 2e-5, "h {h}: {measured} for {crossing}");
    }
}

/// Reflectance of unpolarised light, by Fresnel's equations as the textbooks have them.
fn reflectance(degrees: f64, n: f64) -> f64 {
    let cos_i = degrees.to_radians().cos();
    let cos_t = (1.0 - (degrees.to_radians().sin() / n).powi(2)).sqrt();
    let s = (cos_i - n * cos_t) / (cos_i + n * cos_t);
    let p = (n * cos_i - cos_t) / (n * cos_i + cos_t);
    0.5 * (s * s + p * p)
}

/// A black room in which a lamp fills the plane z = −1, seen from the other side at `degrees` from the normal through the origin.
fn before_lamp(degrees: f64) -> WorldBuilder {
    let from = DVec3::new(-degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
    let mut world = World::builder(probe(from * 2.0, DVec3::ZERO));
    let dark = world.material(black());
    world.shape(Quad { size: [4000.0; 2] }, facing(-DVec3::Z, DVec3::Z), dark, glow(1.0));
    world
}

/// O7. The transmittance of a pane including all inner reflections: T = (1 − R)/(1 + R).
///
/// R is the mean of both polarisations at each interface, to which a renderer without polarisation converges. Without matte surfaces `path`
/// uses the same random numbers as `nee` and gives the same result, so only one of them is tested.
fn transmittance() -> Vec<Law> {
    let table =
        [(0.0, 0.9230769231), (30.0, 0.9202655325), (45.0, 0.9043267915), (60.0, 0.8362324627), (75.0, 0.5960920478), (85.0, 0.2400796378)];
    let law = |(degrees, transmitted): (f64, f64)| {
        let r = reflectance(degrees, 1.5);
        assert!(((1.0 - r) / (1.0 + r) - transmitted).abs() < 1e-9);
        let mut world = before_lamp(degrees);
        let glass = world.material(Material::glass(1.5));
        pane(&mut world, glass, DVec3::ZERO, [-0.05, 0.05], 400.0);
        let quick = if degrees > 70.0 { 1e-2 } else { 3e-3 };
        Law::new(format!("O7, {degrees}°"), world, transmitted, DEFAULT).resolution(1e-3, quick)
    };
    table.map(law).into()
}

/// O5. N panes, 0.1 mm apart: T = (1 − R)/(1 + (2N − 1)R).
fn panes_in_a_row() -> Vec<Law> {
    let law = |(count, transmitted): (u32, f64)| {
        let mut world = before_lamp(0.0);
        let glass = world.material(Material::glass(1.5));
        for k in 0..count {
            let near = 0.05 - f64::from(k) * 0.0041;
            pane(&mut world, glass, DVec3::ZERO, [near - 0.004, near], 4.0);
        }
        Law::new(format!("O5, {count} panes"), world, transmitted, Depth::exactly(1000)).resolution(2e-3, 1e-2)
    };
    [(1, 0.9230769231), (2, 0.8571428571), (3, 0.8), (10, 0.5454545455)].map(law).into()
}

/// A lamp seen from within glass: n²(1 − R), compressed into a narrower cone, where R is the reflectance from inside.
fn lamp_from_within() -> Vec<Law> {
    let table = [(10.0, 0.0400829592), (30.0, 0.0551901673), (40.0, 0.2452912043), (41.0, 0.3797512660)];
    let law = |(degrees, r): (f64, f64)| {
        let mut world = before_lamp(degrees);
        let glass = world.material(Material::glass(1.5));
        world.shape(Quad { size: [100.0; 2] }, facing(DVec3::ZERO, -DVec3::Z), glass, None);
        Law::new(format!("from within, {degrees}°"), world, 2.25 * (1.0 - r), DEFAULT).resolution(1e-3, 6e-3)
    };
    table.map(law).into()
}

/// A pane of index 1.7 whose faces multiply all light by c = .8, seen at 52° against a lamp on one side of it.
///
/// With F of one face: T = c² (1 − F)² / (1 − c² F²) with the lamp behind, R = c F (1 + T) with the lamp in front.
fn colored_pane() -> Vec<Law> {
    const COLOR: f64 = 0.8;
    let (theta, once) = (52f64.to_radians(), reflectance(52.0, 1.7));
    let transmitted = (COLOR * (1.0 - once)).powi(2) / (1.0 - (COLOR * once).powi(2));
    let law = |(lamp, radiance): (f64, f64)| {
        let mut world = World::builder(probe(DVec3::new(-theta.sin(), 0.0, theta.cos()) * 2.0, DVec3::ZERO));
        let dark = world.material(black());
        world.shape(Quad { size: [4000.0; 2] }, facing(DVec3::Z * lamp, -DVec3::Z * lamp), dark, glow(1.0));
        let glass = world.material(Material::from(textured::Dielectric::smooth(1.7, stored(gray(COLOR)))));
        pane(&mut world, glass, DVec3::ZERO, [-0.001, 0.001], 100.0);
        Law::new(format!("lamp at {lamp} m"), world, radiance, DEFAULT).resolution(1e-3, 3e-3)
    };
    vec![law((-4.0, transmitted)), law((4.0, COLOR * once * (1.0 + transmitted)))]
}

#[test]
fn the_color_of_glass_dims_reflections_too() {
    confirm(colored_pane(), Effort::Quick);
}

#[test]
fn panes_transmit() {
    confirm(transmittance(), Effort::Quick);
    confirm(panes_in_a_row(), Effort::Quick);
}

#[test]
fn lamps_seen_from_within_glass() {
    confirm(lamp_from_within(), Effort::Quick);
}

#[test]
#[ignore = "minutes: all of the above at full resolution"]
fn full_resolution() {
    confirm([transmittance(), panes_in_a_row(), lamp_from_within()].into_iter().flatten().collect(), Effort::Full);
}

/// At and beyond the critical angle, 41.81°, exactly all light is reflected.
#[test]
fn reflection_is_total() {
    for degrees in [41.82, 45.0, 60.0, 80.0, 89.0] {
        for (lamp_behind, radiance) in [(false, 0.0), (true, 1.0)] {
            let from = DVec3::new(-f64::to_radians(degrees).sin(), 0.0, f64::to_radians(degrees).cos());
            let mut world = World::builder(probe(from * 2.0, DVec3::ZERO));
            let (dark, glass) = (world.material(black()), world.material(Material::glass(1.5)));
            let z = if lamp_behind { 4.0 } else { -1.0 };
            world.shape(Quad { size: [4000.0; 2] }, facing(DVec3::Z * z, -DVec3::Z * f64::signum(z)), dark, glow(1.0));
            world.shape(Quad { size: [100.0; 2] }, facing(DVec3::ZERO, -DVec3::Z), glass, None);
            let scene = Arc::new(world.build().unwrap());
            for entry in ALL {
                let Some(integrator) = integrator(entry, DEFAULT) else { continue };
                let mean = crate::scenes::measure(scene.clone(), &*integrator, 4096, 1);
                assert_eq!((mean.value, mean.variance), (radiance, 0.0), "{degrees}° by {}", entry.name);
            }
        }
    }
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
#[test]
fn glass_in_a_uniform_field() {
    let outside = |(mesh, x): (bool, f64)| {
        let world = sphere_of_glass(mesh, probe(DVec3::new(x, 0.1, 4.0), DVec3::new(x, 0.1, 0.0)));
        let name = format!("O15, outside, x {x}, mesh {mesh}");
        Law::new(name, world, 1.0, Depth { max: 4000, roulette: 4 }).resolution(1e-3, 3e-3)
    };
    let inside = |(mesh, towards): (bool, DVec3)| {
        let from = DVec3::new(0.1, 0.2, 0.1);
        let world = sphere_of_glass(mesh, probe(from, from + towards));
        let name = format!("O15, inside towards {towards}, mesh {mesh}");
        Law::new(name, world, 2.25, Depth { max: 4000, roulette: 4 })
    };
    confirm([(false, 0.0), (false, 0.5), (false, 0.9), (true, 0.05), (true, 0.5), (true, 0.9)].map(outside).into(), Effort::Quick);
    let ways = [DVec3::X, DVec3::new(0.3, -0.5, 0.8)];
    confirm(ways.into_iter().flat_map(|w| [inside((false, w)), inside((true, w))]).collect(), Effort::Quick);
}

/// A body with η = 1 is invisible: the picture is the same, bit for bit, with and without it.
///
/// The picture shows lamps and their mirror images, so that the only random number is the position in the pixel.
#[test]
fn index_of_one_is_invisible() {
    let scene = |with: bool| {
        let pose = Pose::new(&Transform::look_at(DVec3::new(0.3, 0.4, 6.0), DVec3::ZERO, DVec3::Y).unwrap());
        let mut world = World::builder(Camera::Perspective(Perspective::new(pose, 50.0, 0.0, 1.0)));
        let (dark, mirror, nothing) =
            (world.material(black()), world.material(Material::mirror(stored(gray(0.9)))), world.material(Material::glass(1.0)));
        for k in 0..12 {
            let place = DVec3::new(f64::from(k % 4) - 1.5, f64::from(k / 4) - 1.0, -3.0 + 0.1 * f64::from(k));
            world.shape(
                Quad { size: [0.7, 0.5] },
                facing(place, DVec3::new(0.1 * f64::from(k), 0.3, 1.0)),
                dark,
                two_sided(1.0 + f64::from(k)),
            );
        }
        world.shape(Quad { size: [8.0; 2] }, facing(-DVec3::Y * 2.0, DVec3::Y), mirror, None);
        world.shape(Sphere { radius: 0.4 }, at(DVec3::new(0.8, 0.9, 0.2)), mirror, None);
        world.light(Light::Environment(Environment { radiance: stored(gray(0.25)) }));
        // The finest detail, below the floor, so that both scenes have their origin here.
        world.shape(Quad { size: [1e-3; 2] }, facing(-DVec3::Y * 3.0, DVec3::Y), dark, None);
        if with {
            world.shape(Sphere { radius: 1.0 }, at(DVec3::new(-0.5, 0.2, 1.0)), nothing, None);
            world.shape(TriangleMesh::new(block(Vec3::new(0.7, 0.5, 0.3))), at(DVec3::new(1.0, -0.6, 1.5)), nothing, None);
        }
        Arc::new(world.build().unwrap())
    };
    let (with, without) = (scene(true), scene(false));
    assert_eq!(with.origin(), without.origin());
    for entry in ALL {
        let Some(integrator) = integrator(entry, Depth::exactly(64)) else { continue };
        let image = |scene: &Arc<World>| {
            picture(scene.clone(), &*integrator, FilmSpec::new(64, 64), SamplerSpec { spp: 4, ..SamplerSpec::default() })
        };
        assert_eq!(image(&with), image(&without), "{}", entry.name);
    }
}
