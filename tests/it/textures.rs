//! Textures: the cells of checkers, lookups by materials, and independence of the world's origin.

use glam::{DVec3, IVec3, Vec2, Vec3};
use proptest::prelude::*;
use pt::bsdf::{Bsdf, HitContext, Material, textured};
use pt::camera::{Camera, Orthographic, Pose};
use pt::effects::Effects;
use pt::math::{Rgb, Spectrum, Transform};
use pt::scene::Scene;
use pt::shape::{Quad, Sphere, SurfacePoint, VertexColor};
use pt::texture::{Checker, Space, Texture, TextureContext};
use pt::world::World;

use crate::random::cases;

const EVEN: Rgb = Rgb::new(0.75, 0.5, 0.25);
const ODD: Rgb = Rgb::new(0.125, 0.25, 0.5);

fn checker(even: impl Into<Texture>, odd: impl Into<Texture>, scale: Vec3, space: Space) -> Texture {
    Texture::Checker(Box::new(Checker { even: even.into(), odd: odd.into(), scale, space }))
}

fn world() -> Space {
    Space::World(Transform::IDENTITY)
}

fn point(p: Vec3, uv: Vec2) -> SurfacePoint {
    SurfacePoint { p, offset: 0.0, ng: Vec3::Z, ns: Vec3::Z, uv, color: VertexColor::WHITE }
}

fn at(p: Vec3, uv: Vec2) -> TextureContext {
    TextureContext::exact(&point(p, uv))
}

/// The colour of a cell, computed with integers only.
fn shown(cell: IVec3) -> Rgb {
    if (cell.x + cell.y + cell.z) & 1 == 0 { EVEN } else { ODD }
}

/// A cell, whose indices may be negative, and a position in it in sixteenths from its lower corner, so that all numbers are exact in f32.
fn cell_and_place() -> impl Strategy<Value = (IVec3, Vec3)> {
    let cell = [-1000i32..1000, -1000..1000, -1000..1000].prop_map(IVec3::from_array);
    let place = [0u8..16, 0..16, 0..16].prop_map(|s| Vec3::from_array(s.map(|s| f32::from(s) / 16.0)));
    (cell, place)
}

/// Scales that are powers of two along each axis, so that division is exact.
fn scales() -> impl Strategy<Value = Vec3> {
    [-3i32..4, -3..4, -3..4].prop_map(|e| Vec3::from_array(e.map(|e| 2f32.powi(e))))
}

proptest! {
    #![proptest_config(cases(10_000))]

    #[test]
    fn cells_of_space_alternate((cell, place) in cell_and_place(), scale in scales(), uv in [-9f32..9.0, -9f32..9.0]) {
        let p = (cell.as_vec3() + place) / scale;
        let texture = checker(EVEN, ODD, scale, world());
        prop_assert_eq!(texture.at(&at(p, Vec2::from_array(uv))), shown(cell));
    }

    #[test]
    fn cells_of_the_surface_alternate((cell, place) in cell_and_place(), scale in scales(), p in [-9f32..9.0, -9f32..9.0, -9f32..9.0]) {
        let uv = ((cell.as_vec3() + place) / scale).truncate();
        let texture = checker(EVEN, ODD, scale, Space::Uv);
        prop_assert_eq!(texture.at(&at(Vec3::from_array(p), uv)), shown(cell.with_z(0)));
    }

    #[test]
    fn a_checker_may_hold_a_checker((cell, place) in cell_and_place()) {
        // Each even cell of size 1 holds cells of size ½ in space, each odd one cells of size ¼ of the surface.
        let (half, quarter) = (checker(EVEN, ODD, Vec3::splat(2.0), world()), checker(ODD, EVEN, Vec3::splat(4.0), Space::Uv));
        let texture = checker(half, quarter, Vec3::ONE, world());
        let inner = |n: i32| n * cell + (place * n as f32).floor().as_ivec3();
        let expected = if shown(cell) == EVEN { shown(inner(2)) } else { shown(inner(4).with_z(0) + IVec3::X) };
        let p = cell.as_vec3() + place;
        prop_assert_eq!(texture.at(&at(p, p.truncate())), expected);
    }

    /// texture(p) = recentred(p − o), also for nested checkers.
    #[test]
    fn recentring_does_not_move_checker_cells(
        (cell, place) in cell_and_place(),
        sixteenths in [-16_000i32..16_000, -16_000..16_000, -16_000..16_000],
    ) {
        let origin = DVec3::from_array(sixteenths.map(|s| f64::from(s) / 16.0));
        let quarter_turn = Transform::rotate(DVec3::Z, 90.0).expect("z is an axis");
        let texture = checker(checker(EVEN, ODD, Vec3::splat(4.0), world()), ODD, Vec3::splat(0.5), Space::World(quarter_turn));
        let (p, uv) = (cell.as_vec3() + place, place.truncate());
        let recentred = texture.clone().recentred(origin);
        prop_assert_eq!(recentred.at(&at((p.as_dvec3() - origin).as_vec3(), uv)), texture.at(&at(p, uv)));
    }
}

/// A checkered floor seen from above, with or without a distant sphere.
fn floor(far: bool) -> World {
    let down = Transform::look_at(DVec3::new(0.0, 5.0, 0.0), DVec3::ZERO, DVec3::X).expect("x is not down");
    let mut builder = World::builder(Camera::Orthographic(Orthographic { pose: Pose::new(&down), height: 8.0 }));
    let checkered = builder.material(Material::diffuse(checker(EVEN, ODD, Vec3::splat(2.0), world())));
    let place = Transform::rotate(DVec3::X, -90.0).expect("x is an axis");
    let place = place.then(&Transform::translate(DVec3::new(0.0, 0.25, 0.0)).expect("finite"));
    builder.shape(Quad { size: [8.0, 8.0] }, place, checkered, None);
    if far {
        let there = Transform::translate(DVec3::new(300.3, 20.7, -700.1)).expect("finite");
        builder.shape(Sphere { radius: 1.0 }, there, checkered, None);
    }
    builder.build().expect("a sound scene")
}

#[test]
fn far_objects_do_not_move_the_pattern() {
    for far in [false, true] {
        let (world, mut seen) = (floor(far), [0, 0]);
        assert_eq!(world.origin().length() > 100.0, far, "only the far object moves the origin");
        for i in 0..64 * 64 {
            let film = (Vec2::new((i % 64) as f32, (i / 64) as f32) + 0.3) / 64.0;
            let ray = world.camera().ray(film, 1.0, Vec2::ZERO, 0.0);
            let hit = world.intersect(&ray).expect("the floor fills the film");
            // +x is up in the picture and +z to the right, over eight metres each.
            let at = world.surface(&ray, &hit);
            let p = at.point.p.as_dvec3() + world.origin();
            let expected_p = DVec3::new(8.0 * (0.5 - f64::from(film.y)), 0.25, 8.0 * (f64::from(film.x) - 0.5));
            // Coordinates about the distant origin are below 512 with a rounding error of 2⁻¹⁵ m. The tolerance is a few of these.
            assert!((p - expected_p).length() < 2e-4, "{p} is not {expected_p}");
            let expected = shown((expected_p * 2.0).floor().as_ivec3());
            let Bsdf::Diffuse(diffuse) = at.bsdf else { panic!("the floor is matte") };
            assert_eq!(diffuse.albedo, Spectrum::from_albedo(expected), "at {expected_p}");
            seen[usize::from(expected == ODD)] += 1;
        }
        assert_eq!(seen, [2048, 2048], "as much of each colour");
    }
}

#[test]
fn materials_look_up_their_textures() {
    let texture = || checker(EVEN, ODD, Vec3::ONE, Space::Uv);
    let materials = [
        Material::diffuse(texture()),
        Material::mirror(texture()),
        Material::from(textured::Dielectric::smooth(1.5, texture())),
        Material::MatteCone(textured::MatteCone { color: texture(), mattness: 0.5.into() }),
        Material::OrenNayar(textured::OrenNayar { albedo: texture(), roughness: 0.5.into() }),
        Material::Phong(textured::Phong { color: texture(), exponent: 2.0.into() }),
        Material::BlinnPhong(textured::BlinnPhong { color: texture(), exponent: 2.0.into() }),
        Material::Metal(textured::Metal { color: texture(), roughness: 0.5.into() }),
        Material::plastic(texture(), 1.5),
        Material::DiffuseTransmission(textured::DiffuseTransmission { reflectance: Rgb::BLACK.into(), transmittance: texture() }),
    ];
    for material in materials {
        for (u, expected) in [(0.5, EVEN), (1.5, ODD), (-0.5, ODD)] {
            let found = match material.bsdf_at(&HitContext::from_outside(point(Vec3::splat(7.5), Vec2::new(u, 0.5)))) {
                Bsdf::Diffuse(b) => b.albedo,
                Bsdf::Mirror(b) => b.color,
                Bsdf::Dielectric(b) => b.color,
                Bsdf::MatteCone(b) => b.color,
                Bsdf::OrenNayar(b) => b.albedo,
                Bsdf::Phong(b) => b.color,
                Bsdf::BlinnPhong(b) => b.color,
                Bsdf::Metal(b) => b.color,
                Bsdf::Plastic(b) => b.albedo,
                Bsdf::DiffuseTransmission(b) => b.transmittance,
                _ => panic!("none was asked for"),
            };
            assert_eq!(found, Spectrum::from_albedo(expected), "{material:?} at u = {u}");
        }
    }
}

#[test]
fn only_varying_materials_have_the_effect_textures() {
    let plain = Texture::Constant(EVEN);
    let varied = checker(EVEN, ODD, Vec3::ONE, Space::Uv);
    for (texture, is_textured) in [(plain, false), (varied, true)] {
        let materials = [
            Material::diffuse(texture.clone()),
            Material::mirror(texture.clone()),
            Material::from(textured::Dielectric::smooth(1.5, texture.clone())),
            Material::MatteCone(textured::MatteCone { color: texture.clone(), mattness: 0.5.into() }),
        ];
        for material in materials {
            assert_eq!(material.effects().contains(Effects::TEXTURES), is_textured, "{material:?}");
        }
    }
    let gold = Material::metal((Rgb::gray(0.2), Rgb::gray(3.0)), None, true);
    assert_eq!(gold.effects(), Effects::SPECULAR_REFLECTION);
}
