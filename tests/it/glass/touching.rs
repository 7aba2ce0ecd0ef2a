//! O6. Glass that touches glass: what pt does with coincident faces, and how to describe such bodies instead.

use pt::world::WorldBuilder;

use super::*;

const ETA: f64 = 1.5;

/// Two panes of half a metre, one above the other, with a gap between them. Shapes: 0 and 1 below and above the upper
/// pane, 2 and 3 the same of the lower one.
fn stacked(gap: f64) -> WorldBuilder {
    let mut world = World::builder(no_camera());
    let glass = world.material(Material::glass(ETA as f32));
    pane(&mut world, glass, DVec3::ZERO, [gap, 0.5], 100.0);
    pane(&mut world, glass, DVec3::ZERO, [-0.5, 0.0], 100.0);
    world
}

/// The shapes that a ray hits on its way through, and its direction behind them.
fn met(scene: &World, mut ray: Ray) -> (Vec<u32>, Vec3) {
    let mut shapes = vec![];
    ray.origin -= scene.origin().as_vec3();
    while let Some(hit) = scene.intersect(&ray) {
        shapes.push(hit.shape);
        ray = passed(scene, ray, 1).expect("an interface");
    }
    (shapes, ray.direction)
}

/// sin θ behind all interfaces, of a ray that comes from above at `degrees`.
fn leaves(scene: &World, degrees: f64) -> f64 {
    f64::from(met(scene, slanting(degrees)).1.x)
}

/// The documented limit (`describe::Dielectric`): of two faces at the same position, rays hit only the one that is listed first, from
/// either side. The light is treated as in air where it should be in glass, and leaves at n sin θ.
#[test]
fn of_coincident_faces_the_first_listed_is_met() {
    let scene = stacked(0.0).build().unwrap();
    for degrees in [0.0, 1.0, 10.0, 30.0] {
        assert_eq!(met(&scene, slanting(degrees)).0, [1, 0, 2], "from above, {degrees}°");
        let down = slanting(degrees);
        let up = Ray::new(down.origin * Vec3::new(1.0, 1.0, -1.0), down.direction * Vec3::new(1.0, 1.0, -1.0));
        assert_eq!(met(&scene, up).0, [2, 0, 1], "from below, {degrees}°");
        assert!((leaves(&scene, degrees) - ETA * degrees.to_radians().sin()).abs() < 1e-6, "{degrees}°");
    }
}

/// Two panes that touch must be described as one body, without the faces between them, or as two bodies with a gap that is larger than the
/// offset of rays. In both cases light leaves at the angle at which it entered.
#[test]
fn one_body_or_a_gap_is_right() {
    let mut merged = World::builder(no_camera());
    let glass = merged.material(Material::glass(ETA as f32));
    pane(&mut merged, glass, DVec3::ZERO, [-0.5, 0.5], 100.0);
    let merged = merged.build().unwrap();
    // As documented: a hundred-thousandth of the scene's size, 100 m; the panes lie at its end, where rounding is worst.
    let mut apart = stacked(100e-5);
    let nothing = apart.material(black());
    apart.shape(Quad { size: [1.0; 2] }, at(DVec3::new(20.0, 20.0, -100.0)), nothing, None);
    let apart = apart.build().unwrap();
    for degrees in [0.0f64, 1.0, 10.0, 30.0] {
        for (scene, interfaces) in [(&merged, 2), (&apart, 4)] {
            assert_eq!(met(scene, slanting(degrees)).0.len(), interfaces);
            assert!((leaves(scene, degrees) - degrees.to_radians().sin()).abs() < 1e-6, "{degrees}°");
        }
    }
}

/// Water in a glass: there is one face where both touch, and its η is the ratio of the two indices. Parallel interfaces keep n sin θ,
/// whatever lies between.
#[test]
fn one_face_with_the_ratio_of_the_indices_lies_between_two_media() {
    let (glass, water) = (1.5, 1.33);
    let mut world = World::builder(no_camera());
    let [top, between, bottom] = [glass, water / glass, water].map(|eta: f64| world.material(Material::glass(eta as f32)));
    for (z, normal, material) in [(0.5, DVec3::Z, top), (0.0, DVec3::Z, between), (-0.5, -DVec3::Z, bottom)] {
        world.shape(Quad { size: [100.0; 2] }, facing(DVec3::Z * z, normal), material, None);
    }
    let scene = world.build().unwrap();
    for degrees in [0.0f64, 1.0, 10.0, 30.0] {
        let inside = through(&scene, slanting(degrees), 2).expect("two interfaces").direction.x;
        assert!((f64::from(inside) - degrees.to_radians().sin() / water).abs() < 1e-6, "{degrees}°: {inside} in water");
        assert!((leaves(&scene, degrees) - degrees.to_radians().sin()).abs() < 1e-6, "{degrees}°");
    }
}
