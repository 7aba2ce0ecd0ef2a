//! Closed meshes whose vertices move: no ray leaves them, at any time.

use glam::{DVec3, Vec3};

use super::meshes::{icosphere, mesh, shapes};
use super::{Failures, Random, Row};
use crate::accel;
use crate::math::{Ray, Transform};
use crate::shape::moving_mesh::Pose;
use crate::shape::{Geometry, MovingMesh, TriangleMesh};

/// Rays from inside, at vertices and edges where they are at the time of the ray.
pub fn leaks() -> Row {
    let row = Row::new("G1b", "rays out of a closed mesh of 1280 triangles whose vertices move", "none may leave");
    let places = [(0.0, 2f64.powi(-20)), (0.0, 1.0), (1e3, 1e3), (1e6, 1e3)];
    places.into_iter().fold(row, |row, (coordinate, radius)| {
        row.never(format!("radius {radius:.3e}, coordinates {coordinate:e}"), 2_000_000, move |tries| {
            let center = DVec3::splat(coordinate);
            let (sphere, triangles) = icosphere(3);
            let mut random = Random::new(1);
            let mut pose = |time: f64| Pose {
                time,
                positions: sphere.iter().map(|p| (center + *p * (radius * random.range(0.8, 1.2))).as_vec3()).collect(),
                normals: vec![],
            };
            let poses = [0.0, 0.3, 1.0].map(&mut pose);
            let moving = MovingMesh { mesh: TriangleMesh::new(mesh(poses[0].positions.clone(), triangles.clone())), poses: poses.to_vec() };
            let hierarchy = accel::build(shapes(vec![moving.bake(&Transform::IDENTITY).expect("some triangle has an area")]));
            Failures::count(tries, |random| {
                let time = random.unit() as f32;
                let vertex = |v: u32| place(&poses, v as usize, time.into());
                let [a, b, _] = triangles[random.below(triangles.len())].map(vertex);
                let target = if random.below(3) == 0 { a } else { a.lerp(b, random.unit()) };
                let origin = (center + random.in_cube() * (0.3 * radius)).as_vec3();
                let ray = Ray { time, ..Ray::new(origin, (target - origin.as_dvec3()).normalize().as_vec3()) };
                let leaks = hierarchy.intersect(&ray).is_none() || !hierarchy.occluded(&ray);
                leaks.then(|| format!("from {:?} towards {:?} at {time}", ray.origin, ray.direction))
            })
        })
    })
}

/// Where a vertex is at a time, in f64.
fn place(poses: &[Pose; 3], vertex: usize, time: f64) -> DVec3 {
    let [start, end] = if time < poses[1].time { [&poses[0], &poses[1]] } else { [&poses[1], &poses[2]] };
    let [a, b]: [Vec3; 2] = [start, end].map(|pose| pose.positions[vertex]);
    a.as_dvec3().lerp(b.as_dvec3(), (time - start.time) / (end.time - start.time))
}
