//! Checks of the lengths of shapes before they are built.

use std::borrow::Cow;

use glam::DVec3;

use super::shape::{BilinearPatch, CurveBasis, Curves, Cylinder, Disk, Sphere};
use crate::format::{Point, Vector};
use crate::shape;
use crate::shape::curves::Basis;

/// Says what is wrong with a shape: the key of each fault, or the path below the shape, and its message.
pub(super) type Faults = Vec<(Cow<'static, str>, String)>;

pub(super) fn sphere(sphere: &Sphere) -> Faults {
    let ([low, high], radius) = (sphere.ends(), sphere.radius.get());
    if low >= radius {
        return vec![("z_min".into(), format!("expected a number below {radius}, the radius, found {low}: nothing of the sphere is left"))];
    }
    if high <= -radius {
        return vec![(
            "z_max".into(),
            format!("expected a number above {}, minus the radius, found {high}: nothing of the sphere is left", -radius),
        )];
    }
    let mut faults = ends([low, high]);
    if sphere.medium.is_some() && !sphere.is_whole() {
        faults.push(("medium".into(), "a part of a sphere is open and contains nothing: leave out \"medium\", or the cuts".to_owned()));
    }
    faults
}

pub(super) fn cylinder(cylinder: &Cylinder) -> Faults {
    ends([cylinder.z_min.get(), cylinder.z_max.get()])
}

fn ends([low, high]: [f64; 2]) -> Faults {
    let message = || format!("expected a number above {low}, that of z_min, found {high}");
    if low < high { vec![] } else { vec![("z_max".into(), message())] }
}

pub(super) fn disk(disk: &Disk) -> Faults {
    let [hole, radius] = [disk.inner_radius.get(), disk.radius.get()];
    let message = || format!("expected a number below {radius}, that of radius, found {hole}");
    if hole < radius { vec![] } else { vec![("inner_radius".into(), message())] }
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
        return vec![("corners".into(), "the corners lie on one line".to_owned())];
    }
    let [a, b, c, d] = corners;
    let depth = (d - b - (c - a)).dot(greatest.normalize());
    let is_folded = normals.into_iter().any(|normal| normal.dot(greatest) < -LEAST_SINE * greatest.length_squared());
    match depth.abs() <= LEAST_SINE * size && is_folded {
        true => vec![(
            "corners".into(),
            "the sides cross: expected the corners at [u, v] = [0, 0], [1, 0], [0, 1] and [1, 1], in this order".to_owned(),
        )],
        false => vec![],
    }
}

impl CurveBasis {
    /// The basis of the shape.
    pub(crate) fn basis(self) -> Basis {
        match self {
            CurveBasis::CatmullRom => Basis::CatmullRom,
            CurveBasis::Bspline => Basis::Bspline,
            CurveBasis::Bezier => Basis::Bezier,
            CurveBasis::Linear => Basis::Linear,
        }
    }

    /// Says how many points a curve needs, if it has another number of them.
    pub(crate) fn wrong_number(self, points: usize) -> Option<String> {
        let expected = match self {
            CurveBasis::CatmullRom | CurveBasis::Linear => "at least two",
            CurveBasis::Bspline => "at least four for a B-spline",
            CurveBasis::Bezier => "4, 7, 10 and so on for a Bézier curve",
        };
        (!self.basis().fits(points)).then(|| format!("expected {expected}, found {points}"))
    }
}

/// Curves have their points from a file or from the scene, as many as their basis needs, and a radius above 0 somewhere.
pub(super) fn curves(curves: &Curves) -> Faults {
    let mut faults: Faults = vec![];
    match (&curves.file, &curves.points) {
        (Some(_), None) if curves.normals.is_some() => {
            faults.push(("normals".into(), "expected \"points\" beside them, found a file".into()))
        }
        (Some(_), None) => {}
        (None, Some(points)) => {
            if points.is_empty() {
                faults.push(("points".into(), "expected at least one curve".into()));
            }
            if curves.radius.is_none() {
                faults.push(("".into(), "curves with \"points\" need a \"radius\"".into()));
            }
            for (i, curve) in points.iter().enumerate() {
                let wrong = curves.basis.wrong_number(curve.len());
                faults.extend(wrong.map(|message| (format!("points/{i}").into(), message)));
            }
            faults.extend(curves.normals.iter().flat_map(|normals| normals_fit(points, normals)));
        }
        _ => faults.push(("".into(), "curves need either \"file\" or \"points\"".into())),
    }
    if curves.radius.is_some_and(|radius| radius.ends() == [0.0; 2]) {
        faults.push(("radius".into(), "expected a number above 0 at one end at least".into()));
    }
    faults
}

fn normals_fit(points: &[Vec<Point>], normals: &[Vec<Vector>]) -> Faults {
    if points.len() != normals.len() {
        return vec![("normals".into(), format!("expected a list for each of {} curves, found {}", points.len(), normals.len()))];
    }
    let pairs = points.iter().zip(normals).enumerate().filter(|(_, (points, normals))| points.len() != normals.len());
    let message = |points: usize, normals: usize| format!("expected one for each of {points} points, found {normals}");
    pairs.map(|(i, (points, normals))| (format!("normals/{i}").into(), message(points.len(), normals.len()))).collect()
}
