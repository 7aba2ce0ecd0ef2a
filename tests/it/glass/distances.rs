//! Distances are measured from surface to surface: absorption, holes and distance limits do not depend on the offset of ray origins.

use glam::{DVec3, Vec3};
use pt::bsdf::{Lobe, Material, MaterialId, SurfaceMaterial, TransportMode, textured};
use pt::film::FilmSpec;
use pt::integrators::ALL;
use pt::math::fresnel::dielectric;
use pt::math::{Ray, Rgb};
use pt::sampler::SamplerSpec;
use pt::scene::{Scene, Surface};
use pt::shape::{Quad, Sphere, TriangleMesh};
use pt::world::{World, WorldBuilder};

use crate::scenes::{Depth, at, black, facing, glow, gray, integrator, picture, probe, room, stored};
use pt::torture::glass::{no_camera, pane};
use pt::torture::meshes::block;

const ETA: f32 = 1.7;
/// The absorption coefficient of the glass (1/m).
const SIGMA: f64 = 1000.0;

fn absorbing(world: &mut WorldBuilder) -> MaterialId {
    world.material(Material::from(textured::Dielectric::smooth(ETA, 1.0).absorbing(Rgb::gray(SIGMA as f32))))
}

/// Adds fine details at the coordinates' origin, so that the origin stays there. There are several, so that the choice of the origin is
/// unique.
fn anchored(world: &mut WorldBuilder) {
    let dark = world.material(black());
    for y in [-1e-3, 0.0, 1e-3] {
        world.shape(Quad { size: [1e-5; 2] }, facing(DVec3::Y * y, DVec3::Z), dark, None);
    }
}

/// The transmittance of two faces due to absorption: Fresnel's reflections are divided out.
fn passed(scene: &World, mut ray: Ray) -> Option<f64> {
    let mut left = 1.0;
    for _ in 0..2 {
        let hit = scene.intersect(&ray)?;
        let surface = scene.surface(&ray, &hit);
        let wo = -ray.direction;
        let (wi, sample) = surface.delta_lobes(wo, TransportMode::Importance).find(|(_, s)| s.lobe == Lobe::Transmission)?;
        left *= f64::from(sample.weight.average()) / f64::from(1.0 - dielectric(surface.frame.to_local(wo).cos(), ETA));
        ray = surface.spawn(wi, 0.0);
    }
    Some(left)
}

/// Beer and Lambert's e^(−σ d / cos θt) through panes far from the coordinates' origin, where rays start 2 to 31 % of the thickness beside
/// their surface. Panes are two faces or a closed box.
///
/// The positions of the planes are exact in f32, so that the tolerance is only for the rounding of directions and of the exponential. (The
/// offset is 2⁻¹⁹ · 16 m = 31 µm.)
#[test]
fn absorption_does_not_depend_on_ray_offsets() {
    for thickness in [2f64.powi(-9), 2f64.powi(-10), 2f64.powi(-11), 2f64.powi(-12), 2f64.powi(-13)] {
        for closed in [false, true] {
            let mut world = World::builder(no_camera());
            anchored(&mut world);
            let glass = absorbing(&mut world);
            if closed {
                let half = 0.5 * thickness;
                let slab = block(Vec3::new(64.0, 64.0, half as f32));
                world.shape(TriangleMesh::new(slab), at(DVec3::Z * (16.0 + half)), glass, None);
            } else {
                pane(&mut world, glass, DVec3::ZERO, [16.0, 16.0 + thickness], 128.0);
            }
            let world = world.build().unwrap();
            assert!(world.origin().length() < 1e-2);
            for degrees in [0.0f64, 10.0, 30.0, 52.0, 75.0, 85.0] {
                let direction = DVec3::new(degrees.to_radians().sin(), 0.0, -degrees.to_radians().cos());
                let ray = Ray::new((DVec3::new(0.3, 0.2, 16.5) - direction).as_vec3(), direction.as_vec3().normalize());
                let cos = (1.0 - (degrees.to_radians().sin() / f64::from(ETA)).powi(2)).sqrt();
                let exact = (-SIGMA * thickness / cos).exp();
                let found = passed(&world, ray).unwrap_or_else(|| panic!("{thickness} m at {degrees}°: a face is missed"));
                assert!((found / exact - 1.0).abs() < 3e-6, "{thickness} m, closed {closed}, {degrees}°: {found}, not {exact}");
            }
        }
    }
}

/// Absorption along the chord 2 R cos θt of a ball, where rays start R/200 beside the surface.
///
/// A ray with an offset of o = 78 µm leaves a ball of R = 1/64 m at another point. The distance between ball and tangent plane there is
/// o²/2R, a few millionths of the chord, and points on the ball are rounded to 1 µm, 3·10⁻⁵ of the chord. σ × chord is up to 31.
#[test]
fn absorption_in_a_ball_does_not_depend_on_ray_offsets() {
    let radius = 2f64.powi(-6);
    let mut world = World::builder(no_camera());
    anchored(&mut world);
    let glass = absorbing(&mut world);
    world.shape(Sphere { radius }, at(DVec3::splat(16.0)), glass, None);
    let world = world.build().unwrap();
    for height in [0.0f64, 0.2, 0.5, 0.8, 0.95] {
        let ray = Ray::new((DVec3::splat(16.0) + DVec3::new(height * radius, 0.0, 1.0)).as_vec3(), -Vec3::Z);
        let chord = 2.0 * radius * (1.0 - (height / f64::from(ETA)).powi(2)).sqrt();
        let found = -passed(&world, ray).expect("through the ball").ln() / SIGMA;
        assert!((found / chord - 1.0).abs() < 2e-4, "at {height} R: {found} m, not {chord} m");
    }
}

/// Adds shapes of a material to a scene.
type Add<'a> = &'a dyn Fn(&mut WorldBuilder, MaterialId);

/// A large ground, a distant lamp or a pair of distant balls does not change a bit of the picture of a closed room with absorbing glass and
/// holes, with every integrator.
#[test]
fn far_objects_change_no_bit() {
    let far: [Add; 4] = [
        &|world, dark| {
            for x in [-1e5, 1e5] {
                world.shape(Sphere { radius: 1.0 }, at(DVec3::X * x), dark, None);
            }
        },
        &|world, dark| world.shape(Sphere { radius: 1.0 }, at(DVec3::new(3e4, 20.0, -7e4)), dark, None),
        &|world, dark| world.shape(Quad { size: [2000.0; 2] }, facing(DVec3::new(900.0, -3.0, 0.0), DVec3::Y), dark, None),
        &|world, dark| world.shape(TriangleMesh::new(block(Vec3::splat(50.0))), at(DVec3::Y * 4000.0), dark, None),
    ];
    let scene = |more: Option<Add>| {
        let mut world = World::builder(probe(DVec3::new(0.1, 0.2, 0.9), DVec3::new(0.0, 0.0, -0.9)));
        let (white, dark) = (world.material(Material::diffuse(stored(gray(0.7)))), world.material(black()));
        let body = world.material(Material::from(textured::Dielectric::smooth(1.5, 1.0).absorbing(Rgb::gray(3.0))));
        let veil = world.material(SurfaceMaterial { opacity: Some(0.4.into()), ..Material::diffuse(stored(gray(0.5))).into() });
        room(&mut world, DVec3::ZERO, DVec3::ONE, |axis, side| (white, (axis == 1 && side > 0.0).then(|| glow(1.0)).flatten()));
        world.shape(Sphere { radius: 0.3 }, at(DVec3::new(0.05, 0.1, 0.0)), body, None);
        world.shape(TriangleMesh::new(block(Vec3::new(0.5, 0.4, 0.05))), at(-DVec3::Z * 0.5), body, None);
        world.shape(Quad { size: [1.0; 2] }, facing(DVec3::Z * 0.5, DVec3::Z), veil, None);
        if let Some(more) = more {
            more(&mut world, dark);
        }
        std::sync::Arc::new(world.build().unwrap())
    };
    for entry in ALL {
        let Some(integrator) = integrator(entry, Depth::exactly(16)) else { continue };
        let image = |more| picture(scene(more), &*integrator, FilmSpec::new(16, 16), SamplerSpec { spp: 4, ..SamplerSpec::default() });
        let alone = image(None);
        for (k, more) in far.iter().enumerate() {
            assert!(image(Some(*more)) == alone, "{}: far object {k}", entry.name);
        }
    }
}

/// Behind sixteen surfaces of opacity 0 a wall has the same distance as without them.
///
/// The tolerance is the rounding of sixteen coordinates at 16 m (2⁻²⁰ m each), over the cosine; the offset of a ray would be at least 31 µm
/// for each hole. For a ray with a given end, each hole moves the ray sideways by up to 2⁻¹⁹ · 17 m, and the distance to the wall by that
/// over the cosine.
#[test]
fn holes_do_not_shorten_distances() {
    let mut world = World::builder(no_camera());
    anchored(&mut world);
    let dark = world.material(black());
    let nothing = world.material(SurfaceMaterial { opacity: Some(0.0.into()), ..Material::diffuse(stored(gray(0.5))).into() });
    for k in 1..=16 {
        world.shape(Quad { size: [128.0; 2] }, facing(DVec3::Z * (17.0 - f64::from(k) / 32.0), DVec3::Z), nothing, None);
    }
    world.shape(Quad { size: [128.0; 2] }, facing(DVec3::Z * 16.0, DVec3::Z), dark, None);
    let world = world.build().unwrap();
    for degrees in [0.0f64, 30.0, 60.0, 80.0] {
        let direction = DVec3::new(degrees.to_radians().sin(), 0.0, -degrees.to_radians().cos());
        let ray = Ray::new(Vec3::Z * 17.0, direction.as_vec3().normalize());
        let hit = world.intersect(&ray).expect("the wall");
        let exact = 1.0 / degrees.to_radians().cos();
        let off = f64::from(hit.t) - exact;
        assert!(off.abs() < 16.0 * 2f64.powi(-20) * exact, "{degrees}°: {} m, not {exact} m", hit.t);
        let sideways = 16.0 * 2f64.powi(-19) * 17.0;
        assert!(!world.occluded(&Ray { t_max: (exact * (1.0 - sideways)) as f32, ..ray }));
        assert!(world.occluded(&Ray { t_max: (exact * (1.0 + sideways)) as f32, ..ray }));
    }
}

/// A ray that is limited to a distance ends at that distance from the surface point, not from its offset origin.
#[test]
fn distances_are_measured_from_the_surface() {
    let mut world = World::builder(no_camera());
    anchored(&mut world);
    let dark = world.material(black());
    world.shape(Quad { size: [1.0; 2] }, at(DVec3::Z * 16.0), dark, None);
    let world = world.build().unwrap();
    let down = Ray::new(Vec3::Z * 17.0, -Vec3::Z);
    let surface: Surface = world.surface(&down, &world.intersect(&down).expect("the quad"));
    let up = surface.spawn(Vec3::Z, 0.0).within(1e-3);
    assert!(surface.point.offset > 1e-5);
    // The tolerance is two roundings of 16 m.
    assert!((up.at(up.t_max).z - surface.point.p.z - 1e-3).abs() <= 2e-6, "{up:?}");
}
