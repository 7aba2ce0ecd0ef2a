//! Cylinders, cones, parts of spheres and disks, and bilinear patches. What is expected is computed in object space from the formulas of
//! their points and of the functions that are 0 on them, which pt does not use.

mod borders;
mod coordinates;
mod hits;
mod light;

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DMat3, DMat4, DVec3, Vec3};
use pt::Result;
use pt::math::Transform;
use pt::shape::{BilinearPatch, Cone, Cylinder, Geometry, PartialDisk, PartialSphere, Shape};
use pt::torture::meshes::mesh;

use crate::random::Random;

/// A shape that can be given away more than once.
#[derive(Clone)]
struct Shared(Arc<dyn Geometry + Send + Sync>);

impl Geometry for Shared {
    fn bounds(&self, to_world: &Transform) -> (DVec3, DVec3) {
        self.0.bounds(to_world)
    }

    fn bake(&self, to_world: &Transform) -> Result<Box<dyn Shape>> {
        self.0.bake(to_world)
    }
}

/// A shape with its formulas in object space.
struct Kind {
    name: &'static str,
    geometry: Shared,
    /// Point of the surface for u and v from 0 to 1. Its derivatives ∂p/∂u × ∂p/∂v point to the outside.
    point: Box<dyn Fn(f64, f64) -> DVec3 + Send + Sync>,
    /// Function that is 0 on the surface without its borders.
    implicit: Box<dyn Fn(DVec3) -> f64 + Sync>,
    /// Distance of a point of the surface from the nearest border, negative outside of it, in objects of size 1.
    inside: Box<dyn Fn(DVec3) -> f64 + Sync>,
}

impl Kind {
    fn bake(&self, place: &Transform) -> Box<dyn Shape> {
        self.geometry.bake(place).expect("an area")
    }

    /// The surface in `n` × `n` cells of two triangles, in world space.
    fn triangles(&self, place: &Transform, n: u32) -> Vec<[DVec3; 3]> {
        let share = |k: u32| f64::from(k) / f64::from(n);
        let corner = |i: u32, j: u32| place.point((self.point)(share(i), share(j)));
        let cells = (0..n * n).map(|k| (k % n, k / n));
        let halves = cells.flat_map(|(i, j)| {
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            [[a, b, c], [a, c, d]]
        });
        let turned = halves.map(|[a, b, c]| if place.flips_handedness() { [a, c, b] } else { [a, b, c] });
        turned.filter(|[a, b, c]| (*b - *a).cross(*c - *a) != DVec3::ZERO).collect()
    }

    fn mesh(&self, place: &Transform, n: u32) -> Box<dyn Shape> {
        let corners: Vec<Vec3> = self.triangles(place, n).into_iter().flatten().map(|p| p.as_vec3()).collect();
        let triangles = (0..corners.len() as u32 / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        pt::torture::meshes::baked(mesh(corners, triangles))
    }
}

/// Distance of a direction from the nearer end of the angles from 0 to `degrees`, times the distance from the axis; negative outside.
fn angle_inside(p: DVec3, degrees: f64) -> f64 {
    if degrees == 360.0 {
        return f64::INFINITY;
    }
    let (phi, end) = (p.y.atan2(p.x).rem_euclid(TAU), degrees.to_radians());
    let rho = p.truncate().length();
    if phi <= end { rho * phi.min(end - phi) } else { -rho * (phi - end).min(TAU - phi) }
}

fn around(u: f64, degrees: f64, rho: f64, z: f64) -> DVec3 {
    let (sin, cos) = (u * degrees.to_radians()).sin_cos();
    DVec3::new(rho * cos, rho * sin, z)
}

fn cylinder(name: &'static str, radius: f64, z: [f64; 2], phi_max: f64) -> Kind {
    Kind {
        name,
        geometry: Shared(Arc::new(Cylinder { radius, z, phi_max })),
        point: Box::new(move |u, v| around(u, phi_max, radius, z[0] + (z[1] - z[0]) * v)),
        implicit: Box::new(move |p| p.x * p.x + p.y * p.y - radius * radius),
        inside: Box::new(move |p| (p.z - z[0]).min(z[1] - p.z).min(angle_inside(p, phi_max))),
    }
}

fn cone(name: &'static str, radius: f64, height: f64, phi_max: f64) -> Kind {
    Kind {
        name,
        geometry: Shared(Arc::new(Cone { radius, height, phi_max })),
        point: Box::new(move |u, v| around(u, phi_max, radius * (1.0 - v), height * v)),
        implicit: Box::new(move |p| p.x * p.x + p.y * p.y - (radius * (1.0 - p.z / height)).powi(2)),
        inside: Box::new(move |p| p.z.min(height - p.z).min(angle_inside(p, phi_max))),
    }
}

fn partial_sphere(name: &'static str, radius: f64, z: [f64; 2], phi_max: f64) -> Kind {
    let ends = z.map(|z| z.clamp(-radius, radius));
    // What is not cut off has no border.
    let beyond = move |k: usize| if ends[k].abs() == radius { f64::INFINITY } else { 0.0 };
    Kind {
        name,
        geometry: Shared(Arc::new(PartialSphere { radius, z, phi_max })),
        // By the angle from +z, so that cells near the poles are as flat as others.
        point: Box::new(move |u, v| {
            let angles = ends.map(|z| (z / radius).acos());
            let (sin, cos) = (angles[0] + (angles[1] - angles[0]) * v).sin_cos();
            around(u, phi_max, radius * sin, radius * cos)
        }),
        implicit: Box::new(move |p| p.length_squared() - radius * radius),
        inside: Box::new(move |p| (p.z - ends[0] + beyond(0)).min(ends[1] - p.z + beyond(1)).min(angle_inside(p, phi_max))),
    }
}

fn partial_disk(name: &'static str, radius: f64, inner_radius: f64, phi_max: f64) -> Kind {
    Kind {
        name,
        geometry: Shared(Arc::new(PartialDisk { radius, inner_radius, phi_max })),
        // From the rim inwards, so that the derivatives point to +z.
        point: Box::new(move |u, v| around(u, phi_max, radius + (inner_radius - radius) * v, 0.0)),
        implicit: Box::new(|p| p.z),
        inside: Box::new(move |p| {
            let rho = p.truncate().length();
            let hole = if inner_radius > 0.0 { rho - inner_radius } else { f64::INFINITY };
            hole.min(radius - rho).min(angle_inside(p, phi_max))
        }),
    }
}

/// A patch whose corners are in no plane. With the sides a and b of its first corner and the twist c it is P + u a + v b + u v c, so that in
/// the coordinates (u, v, w) along a, b and c it is w = u v.
fn patch(name: &'static str, corners: [DVec3; 4]) -> Kind {
    let [p00, p10, p01, p11] = corners;
    let (a, b, c) = (p10 - p00, p01 - p00, p11 - p10 - p01 + p00);
    let inverse = DMat3::from_cols(a, b, c).inverse();
    Kind {
        name,
        geometry: Shared(Arc::new(BilinearPatch { corners })),
        point: Box::new(move |u, v| p00 + a * u + b * v + c * (u * v)),
        implicit: Box::new(move |p| {
            let q = inverse * (p - p00);
            q.z - q.x * q.y
        }),
        inside: Box::new(move |p| {
            let q = inverse * (p - p00);
            let lengths = [(a + c * q.y).length(), (b + c * q.x).length()];
            (q.x.min(1.0 - q.x) * lengths[0]).min(q.y.min(1.0 - q.y) * lengths[1])
        }),
    }
}

fn saddle() -> [DVec3; 4] {
    [DVec3::new(-0.7, -0.6, -0.2), DVec3::new(0.8, -0.7, 0.4), DVec3::new(-0.6, 0.8, 0.3), DVec3::new(0.7, 0.6, -0.35)]
}

/// All shapes, of sizes about 1.
fn kinds() -> Vec<Kind> {
    vec![
        cylinder("cylinder", 0.7, [-0.4, 0.9], 360.0),
        cylinder("part of a cylinder", 0.8, [0.2, 1.1], 250.0),
        cone("cone", 0.8, 1.3, 360.0),
        cone("part of a cone", 1.1, 0.5, 140.0),
        partial_sphere("bowl", 0.9, [-2.0, 0.3], 360.0),
        partial_sphere("part of a belt", 1.0, [-0.5, 0.6], 300.0),
        partial_sphere("slice", 0.8, [-0.8, 0.8], 40.0),
        partial_disk("ring", 1.0, 0.4, 360.0),
        partial_disk("part of a ring", 1.0, 0.35, 200.0),
        patch("patch", saddle()),
        patch("deep patch", saddle().map(|p| p * DVec3::new(1.0, 1.0, 3.0))),
    ]
}

/// A transform that turns, and stretches, shears or mirrors by factors near 1.
fn skewed(random: &mut Random) -> Transform {
    let shear = DMat3::from_cols(DVec3::X, DVec3::new(random.range(-0.5, 0.5), 1.0, 0.0), DVec3::new(random.range(-0.5, 0.5), 0.3, 1.0));
    let shear = Transform::from_matrix(DMat4::from_mat3(shear)).expect("not singular");
    let mirror = random.pick(&[1.0, -1.0]);
    let stretch = DVec3::new(random.range(0.5, 1.5) * mirror, random.range(0.5, 1.5), random.range(0.5, 1.5));
    shear.then(&Transform::scale(stretch).expect("no factor is zero")).then(&random.rotation())
}
