//! Loads curves, from files or from the scene file.

use glam::{DVec3, Vec3};

use super::Builder;
use crate::describe::Curves;
use crate::describe::curves_file::CurvePoints;
use crate::error::{Error, Result};
use crate::math::Transform;
use crate::shape;

impl Builder<'_> {
    /// Loads curves from their file, or from the scene file. Returns `None` after adding a fault.
    pub(super) fn curves(&mut self, pointer: &str, curves: &Curves, to_world: &Transform) -> Result<Option<shape::Curves>> {
        if shape::Curves::scale(to_world).is_none() {
            let message =
                "curves stay round: expected no step, and no group around them, that stretches them in one direction or shears them";
            self.fault(&format!("{pointer}/transform"), message);
            return Ok(None);
        }
        let found = match &curves.file {
            Some(file) => match self.source.files.curves(file) {
                Ok((found, hash)) => {
                    self.contents.insert(file.clone(), hash);
                    found
                }
                Err(Error::Invalid(faults)) => {
                    self.file_faults(&format!("{pointer}/file"), file, faults);
                    return Ok(None);
                }
                Err(other) => return Err(other),
            },
            None => inline(curves),
        };
        if let Some((k, wrong)) = (0..).zip(&found.counts).find_map(|(k, count)| Some((k, curves.basis.wrong_number(*count as usize)?))) {
            self.fault(&format!("{pointer}/file"), &format!("points of curve {}: {wrong}", k + 1));
            return Ok(None);
        }
        let radii = match (curves.radius, found.radii) {
            (Some(radius), _) => tapered(&found.counts, radius.ends()),
            (None, Some(radii)) => radii,
            (None, None) => {
                self.fault(pointer, "the file has no radius: give a \"radius\"");
                return Ok(None);
            }
        };
        Ok(Some(shape::Curves {
            basis: curves.basis.basis(),
            points: found.positions.iter().zip(radii).map(|(p, r)| p.extend(r)).collect(),
            counts: found.counts,
            normals: curves.normals.iter().flatten().flatten().map(|n| vec3(&n.0)).collect(),
        }))
    }
}

fn vec3(v: &[f64; 3]) -> Vec3 {
    DVec3::from(*v).as_vec3()
}

/// Curves that are given in the scene file itself.
fn inline(curves: &Curves) -> CurvePoints {
    let points = || curves.points.iter().flatten();
    CurvePoints {
        positions: points().flatten().map(|p| vec3(&p.0)).collect(),
        radii: None,
        counts: points().map(|curve| curve.len() as u32).collect(),
    }
}

/// Radii that change in equal steps from the first point of each curve to its last.
fn tapered(counts: &[u32], [first, last]: [f64; 2]) -> Vec<f32> {
    let of_curve = |count: u32| (0..count).map(move |k| (first + (last - first) * f64::from(k) / f64::from(count - 1)) as f32);
    counts.iter().flat_map(|count| of_curve(*count)).collect()
}
