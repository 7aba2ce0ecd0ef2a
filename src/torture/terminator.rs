//! Shadow terminator: coarse meshes with smooth normals are lit like the smooth surfaces that they represent.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use glam::{DVec3, Vec3};

use super::Row;
use super::radiance::{gray, probe, stored};
use crate::bsdf::{Material, TransportMode};
use crate::light::ShadowTarget;
use crate::math::{Ray, Transform};
use crate::scene::Scene;
use crate::shape::{MeshData, TriangleMesh};
use crate::world::World;

const ALBEDO: f64 = 0.5;

/// N22. A cylinder of 20 facets, lit from 80° beside the viewer, horizontally and from above.
///
/// Without the offset of shadow rays a facet that just faces away is black up to its edge, where the radiance should be sin 9° = 16 %.
pub fn row() -> Row {
    let row = Row::new(
        "N22",
        "steps of radiance between facets, and error against the cylinder",
        "at most 2 %; both sides of an edge differ by 2e-4",
    );
    let row = row.peers("steps of 12 % and more without an offset (mitsuba3 #885)");
    [0.0, 10.0, 60.0].into_iter().fold(row, |row, above| {
        // The worst of 18 turns.
        let worst = move |which: fn((f64, f64)) -> f64| {
            (0..18).map(|turn| which(step_and_error(true, f64::from(turn) + 0.3, f64::to_radians(above)))).fold(0.0, f64::max)
        };
        row.number(format!("light {above}° above, step"), 0.0, 3e-4, move || worst(|found| found.0)).number(
            format!("light {above}° above, error"),
            0.0,
            1e-5,
            move || worst(|found| found.1),
        )
    })
}

const SEGMENTS: u32 = 20;

/// Long cylinder of radius 1 around y whose first edge is rotated by `turn` degrees, with the normals of an exact cylinder.
pub fn cylinder(turn: f64) -> MeshData {
    let normals: Vec<Vec3> = (0..2 * SEGMENTS).map(|k| around(turn.to_radians() + edge(k / 2)).as_vec3()).collect();
    let positions = normals.iter().enumerate().map(|(k, n)| n.with_y(if k % 2 == 0 { -100.0 } else { 100.0 })).collect();
    let side = |k| [0, 1, 2, 3].map(|corner| (2 * k + corner) % (2 * SEGMENTS));
    let triangles = (0..SEGMENTS).map(side).flat_map(|[a, b, c, d]| [[a, c, b], [b, c, d]]).collect();
    MeshData { positions, normals, triangles, ..MeshData::default() }
}

fn edge(k: u32) -> f64 {
    f64::from(k) * TAU / f64::from(SEGMENTS)
}

/// Point at an angle on a circle in the plane y = 0, from z towards x.
fn around(azimuth: f64) -> DVec3 {
    DVec3::new(azimuth.sin(), 0.0, azimuth.cos())
}

/// Radiance along the ray for parallel light from `sun` with irradiance 1, and the shading normal at the hit.
pub fn lit(scene: &World, ray: &Ray, sun: DVec3) -> Option<(f64, DVec3)> {
    let surface = scene.surface(ray, &scene.intersect(ray)?);
    let wi = sun.as_vec3();
    let f = surface.eval(-ray.direction, wi, TransportMode::Radiance);
    let lit = !f.is_black() && !scene.occluded(&surface.shadow_ray(wi, &ShadowTarget::Infinity, 0.0));
    Some((if lit { f.average().into() } else { 0.0 }, surface.point.ns.as_dvec3()))
}

/// Greatest step of radiance from one facet of the cylinder to the next, and greatest deviation from the formula
///
/// L = ρ/π E max(0, n·ω)
///
/// of an exact cylinder, both relative to ρ/π E.
///
/// The view is along −z and the light comes from 80° beside the viewer, so that the terminator is visible at an azimuth of −10°. `turn`
/// moves the edges of the facets relative to it. Azimuths beyond 60°, seen nearly edge-on, are left out.
pub fn step_and_error(smooth_shadows: bool, turn: f64, above: f64) -> (f64, f64) {
    let scene = smooth(cylinder(turn), smooth_shadows);
    let sun = (around(80f64.to_radians()) * above.cos() + DVec3::Y * above.sin()).normalize();
    let seen = |azimuth: f64| {
        // The point is on the facet at this azimuth, not on the circle.
        let beside = (azimuth - turn.to_radians()).rem_euclid(edge(1)) - 0.5 * edge(1);
        let p = around(azimuth) * ((0.5 * edge(1)).cos() / beside.cos());
        let ray = Ray::new((p + DVec3::Z * 3.0).as_vec3(), -Vec3::Z);
        lit(&scene, &ray, sun).expect("aimed at the cylinder").0 / (ALBEDO * FRAC_1_PI)
    };
    let in_view = |azimuth: &f64| azimuth.abs() < 60f64.to_radians();
    let edges = (0..SEGMENTS).map(|k| turn.to_radians() + edge(k)).map(|a| (a + PI).rem_euclid(TAU) - PI).filter(in_view);
    let step = edges.map(|a| (seen(a + 1e-4) - seen(a - 1e-4)).abs()).fold(0.0, f64::max);
    let azimuths = (-600..=600).map(|k| (0.1 * f64::from(k) + 0.0123).to_radians()).filter(in_view);
    let error = azimuths.map(|a| (seen(a) - around(a).dot(sun).max(0.0)).abs()).fold(0.0, f64::max);
    (step, error)
}

/// The mesh, matte; with `smooth_shadows` its shadow rays start from the surface that it represents.
fn smooth(data: MeshData, smooth_shadows: bool) -> World {
    let mut world = World::builder(probe(DVec3::Z * 5.0, DVec3::ZERO));
    let matte = world.material(Material::diffuse(stored(gray(ALBEDO))));
    world.shape(TriangleMesh { smooth_shadows, ..TriangleMesh::new(data) }, Transform::IDENTITY, matte, None);
    world.build().expect("a mesh")
}
