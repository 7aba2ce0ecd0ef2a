//! Shadow terminator: coarse meshes with smooth normals are lit like the smooth surfaces that they represent.

use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use pt::bsdf::{Lobe, Material, TransportMode};
use pt::build::Source;
use pt::camera::{Camera, Perspective, Pose};
use pt::describe::{self, Files};
use pt::film::FilmSpec;
use pt::integrators::ALL;
use pt::light::{Directional, Environment, Light, Point};
use pt::math::{Density, Ray, Transform};
use pt::sampler::SamplerSpec;
use pt::scene::{Scene, Surface};
use pt::shape::{Geometry, MeshData, Sphere, TriangleMesh, triangle};
use pt::world::{World, WorldBuilder};

use crate::random::Random;
use crate::scenes::{Depth, Effort, KnownRadiance, at, black, confirm, glow, gray, integrator, picture, probe, stored, two_sided};
use pt::torture::everything::{Bits, bits};
use pt::torture::meshes::icosphere;
use pt::torture::meshes::round_mesh;
use pt::torture::terminator::{cylinder, lit, step_and_error};

const ALBEDO: f64 = 0.5;

fn wide(from: DVec3, to: DVec3) -> Camera {
    let pose = Transform::look_at(from, to, DVec3::Y).expect("not straight up");
    Camera::Perspective(Perspective::new(Pose::new(&pose), 90.0, 0.0, 1.0))
}

/// Scene of one mesh with one material.
fn alone(data: &MeshData, smooth_shadows: bool, place: Transform, material: Material) -> WorldBuilder {
    let mut world = World::builder(probe(DVec3::Z * 5.0, DVec3::ZERO));
    let material = world.material(material);
    world.shape(TriangleMesh { smooth_shadows, ..TriangleMesh::new(data.clone()) }, place, material, None);
    world
}

fn matte(data: &MeshData, smooth_shadows: bool) -> World {
    alone(data, smooth_shadows, Transform::IDENTITY, Material::diffuse(stored(gray(ALBEDO)))).build().expect("a mesh")
}

/// Ball with its corners on the unit sphere and the normals of the sphere.
fn ball((points, triangles): (Vec<DVec3>, Vec<[u32; 3]>)) -> MeshData {
    let positions: Vec<Vec3> = points.iter().map(|p| p.as_vec3()).collect();
    MeshData { normals: positions.clone(), positions, triangles, ..MeshData::default() }
}

/// Eight triangles.
fn octahedron() -> MeshData {
    let flat = round_mesh(0);
    MeshData { normals: flat.positions.clone(), ..flat }
}

/// Without the offset, a facet that just faces away is black up to its edge, where the radiance should be sin 9° = 16 %: in the worst of 18
/// turns the step is at least 12 %. With it, row N22 of `pt torture` has no step.
#[test]
fn coarse_cylinders_have_steps_without_the_offset() {
    for above in [0f64, 10.0, 60.0].map(f64::to_radians) {
        let turns = (0..18).map(|turn| step_and_error(false, f64::from(turn) + 0.3, above));
        let (step, error) = turns.reduce(|a, b| (a.0.max(b.0), a.1.max(b.1))).expect("some turns");
        assert!(step > 0.12 * above.cos() && error > 0.12 * above.cos(), "{step}, {error}");
    }
}

/// Convex meshes, the coarsest first.
fn convex() -> [MeshData; 4] {
    [octahedron(), ball(icosphere(0)), ball(icosphere(1)), cylinder(7.0)]
}

/// A point of the mesh that a random ray from outside hits, seen from outside by both normals; and the direction back along the ray.
fn met<'a>(scene: &'a World, random: &mut Random) -> Option<(Surface<'a>, Vec3)> {
    let (from, to) = (random.direction() * 4.0, random.in_cube());
    let ray = Ray::new(from.as_vec3(), (to - from).normalize().as_vec3());
    let surface = scene.surface(&ray, &scene.intersect(&ray)?);
    let wo = -ray.direction;
    (surface.point.ng.dot(wo) > 0.0 && surface.point.ns.dot(wo) > 0.0).then_some((surface, wo))
}

/// Rays in all directions above the horizon of the shading normal leave the mesh, because the convex smooth surface does not shadow
/// itself. Directions within 10⁻⁵ of the horizon are excluded because of rounding.
#[test]
fn offset_rays_leave_a_convex_mesh() {
    let squash = Transform::scale(DVec3::new(1.5, 0.4, 0.8)).expect("not zero");
    for (k, data) in convex().iter().enumerate() {
        for place in [Transform::IDENTITY, squash] {
            let stuck = |smooth_shadows| {
                let scene = alone(data, smooth_shadows, place, Material::diffuse(stored(gray(ALBEDO)))).build().expect("a mesh");
                let mut random = Random::new(k as u64);
                let (mut rays, mut stuck) = (0, 0);
                while rays < 20_000 {
                    let (Some((surface, wo)), wi) = (met(&scene, &mut random), random.direction().as_vec3()) else { continue };
                    if surface.point.ns.dot(wi) > 1e-5 {
                        rays += 1;
                        let black = surface.eval(wo, wi, TransportMode::Radiance).is_black();
                        stuck += u32::from(black || scene.occluded(&surface.spawn(wi, 0.0)));
                    }
                }
                stuck
            };
            assert_eq!(stuck(true), 0, "mesh {k}, {place:?}");
            assert!(stuck(false) > 100, "mesh {k}: the facets hide nothing without the fix, {place:?}");
        }
    }
}

/// At the silhouette of a coarse ball, facets are visible whose interpolated normals face away from the viewer. They are lit nevertheless,
/// for matte surfaces and mirrors, from outside and from inside. Sampling and evaluation agree there, so that all integrators give the same
/// result.
#[test]
fn silhouettes_have_no_dark_fringe() {
    for (k, subdivisions) in [0, 1].into_iter().enumerate() {
        let data = ball(icosphere(subdivisions));
        let scenes = [Material::diffuse(stored(gray(ALBEDO))), Material::mirror(stored(gray(1.0)))]
            .map(|material| alone(&data, false, Transform::IDENTITY, material).build().expect("a ball"));
        let mut random = Random::new(k as u64);
        let mut turned = 0;
        for _ in 0..20_000 {
            let (from, to) = (random.direction() * if random.unit() < 0.5 { 4.0 } else { 0.3 }, random.in_cube());
            let ray = Ray::new(from.as_vec3(), (to - from).normalize().as_vec3());
            let (wo, choice, u) = (-ray.direction, random.unit() as f32, random.uniform_square());
            for scene in &scenes {
                let Some(hit) = scene.intersect(&ray) else { continue };
                let surface = scene.surface(&ray, &hit);
                let ng = surface.point.ng * 1f32.copysign(surface.point.ng.dot(wo));
                // The vertices lie on a unit sphere.
                turned += u32::from((ray.origin + ray.direction * hit.t).dot(wo) * surface.point.ng.dot(wo) < 0.0);
                let sample = surface.sample(wo, choice, u, TransportMode::Radiance);
                if surface.bsdf.has_smooth_lobe() {
                    assert!(!surface.eval(wo, ng, TransportMode::Radiance).is_black(), "{surface:?}");
                    let Some((wi, sample)) = sample else { continue };
                    let Density::Smooth(pdf) = sample.density else { panic!("a matte ball") };
                    let f = surface.eval(wo, wi, TransportMode::Radiance).average();
                    assert!((f - sample.weight.average() * pdf.get()).abs() <= 1e-5 * f + 1e-7);
                    assert!((surface.pdf(wo, wi).get() - pdf.get()).abs() <= 1e-5 * pdf.get() + 1e-7);
                } else {
                    assert!(sample.is_some_and(|(wi, _)| wi.dot(ng) > 0.0), "{surface:?}");
                }
            }
        }
        assert!(turned > 30, "{turned} normals faced away");
    }
}

/// In uniform light a convex body has the radiance L = ρ Le with every integrator.
#[test]
fn furnace() {
    let seen = |data: &MeshData, from: DVec3| {
        let mut world = World::builder(probe(from * 3.0, from * 0.5));
        let material = world.material(Material::diffuse(stored(gray(ALBEDO))));
        world.shape(TriangleMesh { smooth_shadows: true, ..TriangleMesh::new(data.clone()) }, Transform::IDENTITY, material, None);
        world.light(Light::Environment(Environment { radiance: stored(gray(1.0)) }));
        world
    };
    let law = |(data, from): (MeshData, DVec3)| {
        KnownRadiance::new(format!("{from}"), seen(&data, from), ALBEDO, Depth::exactly(4)).resolution(1e-3, 2e-3).by_chance(2e-3)
    };
    let from = DVec3::new(0.5, 0.6, 0.7).normalize();
    confirm([(octahedron(), from), (ball(icosphere(0)), DVec3::new(0.1, 0.2, 1.0).normalize())].map(law).into(), Effort::Standard);
}

/// A spherical light near a facet lights the smooth surface, with every integrator: L = ρ Le (r/d)². The distance d is measured from the
/// smooth surface, which is h = (1 − |p|²)/(p·ng) above p.
#[test]
fn light_nearby() {
    let (corners, normals) = ([Vec3::X, Vec3::Y, Vec3::Z], vec![Vec3::X, Vec3::Y, Vec3::Z]);
    let data = MeshData { positions: corners.into(), normals, triangles: vec![[0, 1, 2]], ..MeshData::default() };
    let up = DVec3::ONE.normalize();
    let (p, across) = (DVec3::splat(1.0 / 3.0), DVec3::new(1.0, -1.0, 0.0));
    let h = (1.0 - p.length_squared()) / p.dot(up);
    let (radius, height) = (0.5, 3.0);
    let mut world = World::builder(probe(p + across + up * 0.5, p));
    let material = world.material(Material::diffuse(stored(gray(ALBEDO))));
    world.shape(TriangleMesh { smooth_shadows: true, ..TriangleMesh::new(data) }, Transform::IDENTITY, material, None);
    let dark = world.material(black());
    world.shape(Sphere { radius }, at(p + up * height), dark, glow(1.0));
    let radiance = ALBEDO * (radius / (height - h)).powi(2);
    // 7 % of the directions hit the light by chance.
    confirm(vec![KnownRadiance::new("near", world, radiance, Depth::exactly(1)).by_chance(1e-2)], Effort::Standard);
}

/// A closed body whose shading normals deviate randomly by up to 60° from those of its facets.
fn crooked() -> MeshData {
    let mut random = Random::new(11);
    let data = ball(icosphere(1));
    let lean = |n: &Vec3| (n.as_dvec3() + random.direction() * 0.8).normalize().as_vec3();
    MeshData { normals: data.normals.iter().map(lean).collect(), ..data }
}

/// Exactly no light enters or leaves a closed body, for arbitrary shading normals.
#[test]
fn closed_bodies_leak_no_light() {
    let bodies = [octahedron(), ball(icosphere(0)), ball(icosphere(2)), crooked()];
    for (k, data) in bodies.iter().enumerate() {
        for (lamp, eye) in [(DVec3::ZERO, DVec3::new(1.0, 1.5, 3.0)), (DVec3::new(1.0, 1.5, 3.0), DVec3::ZERO)] {
            let mut world = World::builder(wide(eye, DVec3::new(0.1, -0.2, 0.3)));
            let white = world.material(Material::diffuse(stored(gray(0.9))));
            world.shape(TriangleMesh { smooth_shadows: true, ..TriangleMesh::new(data.clone()) }, Transform::IDENTITY, white, None);
            let dark = world.material(black());
            world.shape(Sphere { radius: 0.1 }, at(lamp + DVec3::X * 0.2), dark, two_sided(1.0));
            world.light(Light::Point(Point { position: lamp, intensity: stored(gray(1.0)) }));
            let scene = Arc::new(world.build().expect("a body and a lamp"));
            for entry in ALL {
                let Some(integrator) = integrator(entry, Depth::exactly(8)) else { continue };
                let image = picture(scene.clone(), &*integrator, FilmSpec::new(48, 48), SamplerSpec { spp: 64, ..SamplerSpec::default() });
                let color = image.channels.iter().filter(|c| ["R", "G", "B"].contains(&c.name.as_str()));
                let values: Vec<f32> = color.flat_map(|c| c.values.clone()).collect();
                assert_eq!(values, vec![0.0; 3 * 48 * 48], "body {k} by {}, the lamp at {lamp}", entry.name);
            }
        }
    }
}

/// A ball lit from above and seen from below has exactly 0 radiance where the smooth ball faces away, and follows Lambert's law elsewhere.
#[test]
fn the_far_side_stays_dark() {
    for data in [octahedron(), ball(icosphere(0)), ball(icosphere(2))] {
        let scene = matte(&data, true);
        let mut random = Random::new(3);
        let mut dark = 0;
        for _ in 0..20_000 {
            let from = DVec3::new(random.range(-1.0, 1.0), -4.0, random.range(-1.0, 1.0));
            let ray = Ray::new(from.as_vec3(), (random.in_cube() * 0.5 - from).normalize().as_vec3());
            // At its silhouette a coarse ball is seen edge-on: from below according to one normal and from above according to the other.
            let Some((radiance, ns)) = lit(&scene, &ray, DVec3::Y).filter(|(_, ns)| ns.dot(ray.direction.as_dvec3()) < 0.0) else {
                continue;
            };
            let expected = ALBEDO * FRAC_1_PI * ns.y;
            if expected <= 0.0 {
                dark += 1;
                assert_eq!(radiance, 0.0, "at {ns}");
            } else if expected > 1e-5 {
                assert!((radiance - expected).abs() < 1e-6, "{radiance} at {ns}, not {expected}");
            }
        }
        assert!(dark > 10_000, "{dark}");
    }
}

/// Rays that enter a body and rays inside are the same to the bit with and without the offset, and so is refraction.
#[test]
fn refracted_rays_are_not_offset() {
    for data in convex() {
        let [plain, smooth] =
            [false, true].map(|smooth| alone(&data, smooth, Transform::IDENTITY, Material::glass(1.5)).build().expect("a body of glass"));
        let mut random = Random::new(8);
        let (mut interfaces, mut changed) = (0, 0);
        for _ in 0..5_000 {
            let from = random.direction() * 4.0;
            let mut ray = Ray::new(from.as_vec3(), (random.in_cube() - from).normalize().as_vec3());
            for _ in 0..8 {
                let (Some(hit), wo) = (plain.intersect(&ray), -ray.direction) else { break };
                let [a, b] = [&plain, &smooth].map(|world| world.surface(&ray, &hit));
                let wi = random.direction().as_vec3();
                let from_above = a.point.ng.dot(wo) > 0.0 && a.point.ns.dot(wo) > 0.0;
                if from_above && (a.point.ng.dot(wi) > 0.0 || a.point.ns.dot(wi) > 0.0) {
                    changed += u32::from(a.spawn(wi, 0.0) != b.spawn(wi, 0.0));
                } else {
                    assert_eq!(a.spawn(wi, 0.0), b.spawn(wi, 0.0));
                }
                if !from_above {
                    assert_eq!(a.shadow_origin, b.shadow_origin);
                }
                // The ray is refracted if possible, or else totally reflected inside.
                let [a, b] = [a, b].map(|surface| {
                    let lobes: Vec<_> = surface.delta_lobes(wo, TransportMode::Radiance).collect();
                    let chosen = lobes.iter().find(|(_, s)| s.lobe == Lobe::Transmission).or(lobes.first().filter(|_| !from_above));
                    chosen.map(|(wi, sample)| (surface.spawn(*wi, 0.0), sample.weight, sample.eta))
                });
                assert_eq!(a, b);
                let Some((next, ..)) = a else { break };
                ray = next;
                interfaces += 1;
            }
        }
        assert!(interfaces > 5_000 && changed > 1_000, "{interfaces}, {changed}");
    }
}

/// Pictures of the mesh by every integrator, lit by the sun, the sky and a floor beside it.
fn pictures(data: &MeshData, smooth_shadows: bool, place: Transform) -> Vec<Bits> {
    let mut world = World::builder(wide(DVec3::new(0.5, 0.5, 2.0), DVec3::ZERO));
    let white = world.material(Material::diffuse(stored(gray(0.8))));
    world.shape(TriangleMesh { smooth_shadows, ..TriangleMesh::new(data.clone()) }, place, white, None);
    world.shape(Sphere { radius: 1.0 }, at(DVec3::new(1.5, -0.5, 0.5)), white, None);
    world.light(Light::Directional(Directional { direction: Vec3::new(-0.6, -0.8, 0.0), irradiance: stored(gray(3.0)) }));
    world.light(Light::Environment(Environment { radiance: stored(gray(0.2)) }));
    let scene = Arc::new(world.build().expect("a scene"));
    let taken = |entry| {
        let integrator = integrator(entry, Depth::exactly(3))?;
        Some(bits(&picture(scene.clone(), &*integrator, FilmSpec::new(32, 32), SamplerSpec { spp: 4, seed: 5, ..SamplerSpec::default() })))
    };
    ALL.iter().filter_map(taken).collect()
}

/// Vertex normals equal to the facet normals, and no vertex normals, give the same picture, bit for bit.
#[test]
fn normals_equal_to_facet_normals_change_no_bit() {
    let (points, triangles) = icosphere(1);
    let corners: Vec<Vec3> = triangles.as_flattened().iter().map(|&v| points[v as usize].as_vec3()).collect();
    let own: Vec<Vec3> = corners.chunks(3).flat_map(|t| [triangle::normal([t[0], t[1], t[2]]).expect("an area"); 3]).collect();
    let triangles = (0..corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let bare = MeshData { positions: corners, triangles, ..MeshData::default() };
    let faceted = MeshData { normals: own, ..bare.clone() };
    let far = Transform::rotate(DVec3::new(1.0, 2.0, 3.0), 40.0).expect("an axis").then(&at(DVec3::new(0.1, 0.2, 0.3)));
    for place in [Transform::IDENTITY, far] {
        for data in [&bare, &faceted] {
            assert!(pictures(data, true, place) == pictures(data, false, place), "{place:?}");
        }
        let smooth = ball(icosphere(1));
        assert!(pictures(&smooth, true, place) != pictures(&smooth, false, place), "the fix does nothing");
    }
}

/// The key of the scene format and its default are respected.
#[test]
fn the_key_switches_it_on() {
    let lifted = |key: &str| {
        let text = format!(
            r#"{{"pt": 1, "camera": {{}}, "shapes": [{{"type": "mesh", {key} "positions": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
                "normals": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "triangles": [[0, 1, 2]]}}]}}"#
        );
        let root = describe::root(text.as_bytes(), "s").expect("JSON");
        let scene = describe::read(&root, "s").expect("a scene");
        let built = pt::build::build(&scene, Source { root: &root, file: "s", files: &Files::within("") }).expect("a mesh");
        built.world.shapes()[0].has_shadow_terminator_offset()
    };
    assert_eq!(["", r#""smooth_shadows": false,"#, r#""smooth_shadows": true,"#].map(lifted), [false, false, true]);
}

/// The offset is twice the height of a sphere over its facet, 0 over a concave facet, and limited for implausible normals.
#[test]
fn shadow_offsets_are_bounded() {
    let shape = |normals: [Vec3; 3]| {
        let data = MeshData {
            positions: vec![Vec3::X, Vec3::Y, Vec3::Z],
            normals: normals.into(),
            triangles: vec![[0, 1, 2]],
            ..MeshData::default()
        };
        let mesh = TriangleMesh { smooth_shadows: true, ..TriangleMesh::new(data) };
        mesh.bake(&Transform::IDENTITY).expect("an area")
    };
    let middle = |normals: [Vec3; 3]| {
        let shape = shape(normals);
        let ray = Ray::new(Vec3::ONE, -Vec3::ONE.normalize());
        let hit = shape.intersect(0, &ray).expect("aimed at it");
        shape.shadow_terminator_offset(0, hit.uv, &shape.point(0, &ray, &hit), 0.0)
    };
    // (1 − 1/3)/(1/√3)
    assert!((middle(Vec3::AXES) - 2.0 / 3f32.sqrt()).abs() < 1e-6);
    let ng = Vec3::ONE.normalize();
    let mirrored = Vec3::AXES.map(|n| 2.0 * ng.dot(n) * ng - n);
    assert_eq!(middle(mirrored), 0.0);
    let flat = |tilt: f32| Vec3::AXES.map(|n| ((n - ng * n.dot(ng)).normalize() + ng * tilt).normalize());
    // Twice the distance to the corners, √(2/3).
    assert!((middle(flat(1e-3)) - 2.0 * (2f32 / 3.0).sqrt()).abs() < 1e-3);
    assert_eq!(middle(Vec3::AXES.map(|_| Vec3::ZERO)), 0.0);
}
