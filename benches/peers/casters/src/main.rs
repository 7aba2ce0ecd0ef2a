//! `pt::rays` beside the ray casters of the crates parry3d-f64 and bvh, all in double precision, on one thread.
//!
//!     cargo run --release --manifest-path benches/peers/casters/Cargo.toml
//!
//! A closed sphere of triangles; rays from inside towards vertices, points of edges and anywhere. Counts the rays that leave the sphere
//! without a hit, and the time of a ray in the median of alternating runs. Each cell has both.

use std::time::Instant;

use bvh::aabb::{Aabb, Bounded};
use bvh::bounding_hierarchy::BHShape;
use bvh::bvh::Bvh;
use nalgebra::{Point3, Vector3};
use parry3d_f64::math::Vector;
use parry3d_f64::query::RayCast;
use parry3d_f64::shape::TriMesh;
use pt::glam::DVec3;
use pt::rays::{Ray, RayCaster};
use pt::torture::Random;
use pt::torture::meshes::icosphere;

const RAYS: usize = 200_000;
const RUNS: usize = 5;

/// A triangle for the crate bvh.
struct Triangle {
    corners: [Point3<f64>; 3],
    node: usize,
}

impl Bounded<f64, 3> for Triangle {
    fn aabb(&self) -> Aabb<f64, 3> {
        self.corners.iter().fold(Aabb::empty(), |all, corner| all.grow(corner))
    }
}

impl BHShape<f64, 3> for Triangle {
    fn set_bh_node_index(&mut self, index: usize) {
        self.node = index;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

/// The first distance of a ray, by one program.
type Cast<'a> = Box<dyn Fn(&Ray) -> Option<f64> + 'a>;

fn main() {
    println!("{:<17}{:<9}{:>18}{:>18}{:>18}", "mesh", "aim", "pt::rays", "parry3d-f64", "bvh");
    for (splits, scale, centre) in [(4, 1.0, 0.0), (7, 1.0, 0.0), (4, 1.0, 1e6)] {
        let (points, triangles) = icosphere(splits);
        let points: Vec<DVec3> = points.iter().map(|p| *p * scale + DVec3::splat(centre)).collect();
        let exact = RayCaster::new(points.clone(), triangles.clone()).expect("a mesh");
        let parry = TriMesh::new(points.iter().map(|p| Vector::new(p.x, p.y, p.z)).collect(), triangles.clone()).expect("a mesh");
        let corner = |v: u32| Point3::from(points[v as usize].to_array());
        // The crate bvh hits triangles from the front only, and these rays come from behind.
        let mut shapes: Vec<Triangle> = triangles.iter().map(|&[a, b, c]| Triangle { corners: [a, c, b].map(corner), node: 0 }).collect();
        let tree = Bvh::build(&mut shapes);
        let casts: [Cast; 3] = [
            Box::new(|ray| exact.closest(ray).map(|hit| hit.t)),
            Box::new(|ray| {
                let [origin, direction] = [ray.origin, ray.direction].map(|v| Vector::new(v.x, v.y, v.z));
                parry.cast_local_ray(&parry3d_f64::query::Ray::new(origin, direction), f64::MAX, false)
            }),
            Box::new(|ray| {
                let ray = bvh::ray::Ray::new(Point3::from(ray.origin.to_array()), Vector3::from(ray.direction.to_array()));
                let hits = tree.traverse_iterator(&ray, &shapes);
                let distances = hits.map(|t| ray.intersects_triangle(&t.corners[0], &t.corners[1], &t.corners[2]).distance);
                distances.reduce(f64::min).filter(|t| t.is_finite())
            }),
        ];
        for aim in ["vertices", "edges", "anywhere"] {
            let mut random = Random::new(1);
            let rays: Vec<Ray> = (0..RAYS).map(|_| ray(&points, &triangles, centre, scale, aim, &mut random)).collect();
            let mut nanoseconds = [const { vec![] }; 3];
            let mut leaks = [0; 3];
            for _ in 0..RUNS {
                for (k, cast) in casts.iter().enumerate() {
                    let start = Instant::now();
                    leaks[k] = rays.iter().filter(|ray| cast(ray).is_none()).count();
                    nanoseconds[k].push(start.elapsed().as_nanos() as f64 / RAYS as f64);
                }
            }
            let cell = |k: usize| {
                let mut times: Vec<f64> = nanoseconds[k].clone();
                times.sort_by(f64::total_cmp);
                format!("{} {:.0} ns", leaks[k], times[RUNS / 2])
            };
            let mesh = format!("{} at {centre:e}", triangles.len());
            println!("{mesh:<17}{aim:<9}{:>18}{:>18}{:>18}", cell(0), cell(1), cell(2));
        }
    }
}

/// A ray from within the sphere, not from its middle.
fn ray(points: &[DVec3], triangles: &[[u32; 3]], centre: f64, scale: f64, aim: &str, random: &mut Random) -> Ray {
    let origin = DVec3::splat(centre) + random.in_cube() * (0.5 * scale);
    let [a, b, _] = random.pick(triangles).map(|v| points[v as usize]);
    let target = match aim {
        "vertices" => a,
        "edges" => a.lerp(b, random.unit()),
        _ => origin + random.direction(),
    };
    Ray::new(origin, target - origin)
}
