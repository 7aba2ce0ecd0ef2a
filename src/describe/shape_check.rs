//! Checks of the lengths of shapes before they are built.

use glam::DVec3;

use super::shape::{BilinearPatch, Cylinder, Disk, Sphere};
use crate::shape;

/// Says what is wrong with a shape: the key of each fault, and its message.
pub(super) type Faults = Vec<(&'static str, String)>;

pub(super) fn sphere(sphere: &Sphere) -> Faults {
    let ([low, high], radius) = (sphere.ends(), sphere.radius.get());
    if low >= radius {
        return vec![("z_min", format!("expected a number below {radius}, the radius, found {low}: nothing of the sphere is left"))];
    }
    if high <= -radius {
        return vec![(
            "z_max",
            format!("expected a number above {}, minus the radius, found {high}: nothing of the sphere is left", -radius),
        )];
    }
    let mut faults = ends([low, high]);
    if sphere.medium.is_some() && !sphere.is_whole() {
        faults.push(("medium", "a part of a sphere is open and contains nothing: leave out \"medium\", or the cuts".to_owned()));
    }
    faults
}

pub(super) fn cylinder(cylinder: &Cylinder) -> Faults {
    ends([cylinder.z_min.get(), cylinder.z_max.get()])
}

fn ends([low, high]: [f64; 2]) -> Faults {
    let message = || format!("expected a number above {low}, that of z_min, found {high}");
    if low < high { vec![] } else { vec![("z_max", message())] }
}

pub(super) fn disk(disk: &Disk) -> Faults {
    let [hole, radius] = [disk.inner_radius.get(), disk.radius.get()];
    let message = || format!("expected a number below {radius}, that of radius, found {hole}");
    if hole < radius { vec![] } else { vec![("inner_radius", message())] }
}

/// The least sine of the angles between the sides of a patch, and between its corner and the plane of the others, above which they count.
const LEAST_SINE: f64 = 1e-9;

/// A patch needs an area. A flat one whose normals at two corners are opposite to each other is folded over: its sides cross.
pub(super) fn bilinear_patch(patch: &BilinearPatch) -> Faults {
    let corners = patch.corners.map(|corner| DVec3::from(corner.0));
    let normals = shape::BilinearPatch { corners }.corner_normals();
    let size = corners.map(|corner| (corner - corners[0]).length()).into_iter().fold(0.0, f64::max);
    let greatest = normals.into_iter().fold(DVec3::ZERO, |a, b| if b.length() > a.length() { b } else { a });
    if greatest.length() <= LEAST_SINE * size * size {
        return vec![("corners", "the corners lie on one line".to_owned())];
    }
    let [a, b, c, d] = corners;
    let depth = (d - b - (c - a)).dot(greatest.normalize());
    let is_folded = normals.into_iter().any(|normal| normal.dot(greatest) < -LEAST_SINE * greatest.length_squared());
    match depth.abs() <= LEAST_SINE * size && is_folded {
        true => vec![(
            "corners",
            "the sides cross: expected the corners at [u, v] = [0, 0], [1, 0], [0, 1] and [1, 1], in this order".to_owned(),
        )],
        false => vec![],
    }
}
