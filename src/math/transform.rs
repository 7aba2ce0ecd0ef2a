//! Affine transforms, kept with their inverses in double precision.

use glam::{BVec3, DAffine3, DMat3, DMat4, DVec3, DVec4};

use super::float::sin_cos_degrees;
use crate::error::{Error, Fault, Result};

/// Invertible affine transform p ↦ M p + t of column vectors, with its inverse.
///
/// Transforms are in double precision, because a scene is baked only once. Constructors return an error if the given numbers make no
/// invertible transform. Composition multiplies the inverses, so that it cannot fail.
///
/// Tests: inverse round trips, normals stay perpendicular, handedness of mirrored mirrors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    matrix: DAffine3,
    inverse: DAffine3,
    flips: bool,
}

impl Default for Transform {
    fn default() -> Transform {
        Transform::IDENTITY
    }
}

impl Transform {
    /// The identity.
    pub const IDENTITY: Transform = Transform { matrix: DAffine3::IDENTITY, inverse: DAffine3::IDENTITY, flips: false };

    /// A translation.
    ///
    /// # Errors
    /// `Invalid` if the vector is not finite.
    pub fn translate(by: DVec3) -> Result<Transform> {
        let moved = Transform::checked(DAffine3::from_translation(by), DAffine3::from_translation(-by), false);
        moved.ok_or_else(|| refused(format!("expected a translation by finite numbers, found {by}")))
    }

    /// A scale along each axis. Negative factors mirror.
    ///
    /// # Errors
    /// `Invalid` if a factor or its inverse is zero or not finite.
    pub fn scale(by: DVec3) -> Result<Transform> {
        let flips = (by.x < 0.0) ^ (by.y < 0.0) ^ (by.z < 0.0);
        let scaled = Transform::checked(DAffine3::from_scale(by), DAffine3::from_scale(by.recip()), flips);
        scaled.ok_or_else(|| refused(format!("expected scale factors that are finite and not 0, found {by}")))
    }

    /// A rotation about an axis through the origin, counter-clockwise as seen from the tip of the axis.
    ///
    /// R = cos θ·1 + sin θ·(a×) + (1 − cos θ)·a aᵀ
    ///
    /// Multiples of 90° about a coordinate axis are exact.
    ///
    /// # Errors
    /// `Invalid` if the axis is zero or a number is not finite.
    ///
    /// Source: Rodrigues (1840). Tests: exact quarter turns, length and handedness kept.
    pub fn rotate(axis: DVec3, degrees: f64) -> Result<Transform> {
        unit(axis)
            .and_then(|axis| Transform::rotation(axis, degrees))
            .ok_or_else(|| refused(format!("expected a finite angle and an axis that is not 0, found {degrees}° about {axis}")))
    }

    /// Rotation about the unit vector `a`.
    fn rotation(a: DVec3, degrees: f64) -> Option<Transform> {
        let (sin, cos) = sin_cos_degrees(degrees);
        let cross = DMat3::from_cols(DVec3::new(0.0, a.z, -a.y), DVec3::new(-a.z, 0.0, a.x), DVec3::new(a.y, -a.x, 0.0));
        let outer = DMat3::from_cols(a * a.x, a * a.y, a * a.z);
        let rotation = DMat3::IDENTITY * cos + cross * sin + outer * (1.0 - cos);
        Transform::checked(DAffine3::from_mat3(rotation), DAffine3::from_mat3(rotation.transpose()), false)
    }

    /// Transform from camera space to world space of a camera at `from` that looks along −z to `to`, with x right and y up.
    ///
    /// # Errors
    /// `Invalid` if `from` is `to`, or `up` is zero or parallel to the line of sight.
    ///
    /// Tests: orthonormal and right-handed, −z hits the target, degenerate input rejected.
    pub fn look_at(from: DVec3, to: DVec3, up: DVec3) -> Result<Transform> {
        let refused = || refused(format!("a view from {from} to {to} with {up} up has no direction, or up is along it"));
        Transform::view(from, to, up).ok_or_else(refused)
    }

    fn view(from: DVec3, to: DVec3, up: DVec3) -> Option<Transform> {
        let z = unit(from - to)?;
        let up = unit(up)?;
        let x = up.cross(z);
        // The cross product of unit vectors has an error of a few roundings. If it is shorter, its direction is not reliable.
        if x.length() <= 8.0 * f64::EPSILON {
            return None;
        }
        // If up is nearly parallel to z, x is not exactly perpendicular to it. y is, and x is computed again from y.
        let y = unit(z.cross(unit(x)?))?;
        let rotation = DMat3::from_cols(y.cross(z), y, z);
        let back = rotation.transpose();
        let matrix = DAffine3::from_mat3_translation(rotation, from);
        Transform::checked(matrix, DAffine3::from_mat3_translation(back, -(back * from)), false)
    }

    /// Transform of an affine matrix.
    ///
    /// # Errors
    /// `Invalid` if the matrix is projective, not finite, or singular. A matrix counts as singular if |det M| is within its rounding
    /// error, |det M| ≤ 8 ε perm |M|. This bound scales with rows and columns, so that transforms of small objects are not singular.
    ///
    /// Tests: singular, projective and non-finite input rejected; tiny and huge scales accepted.
    pub fn from_matrix(m: DMat4) -> Result<Transform> {
        Transform::affine(m).ok_or_else(|| refused("expected an invertible affine matrix, with the last row 0, 0, 0, 1".into()))
    }

    fn affine(m: DMat4) -> Option<Transform> {
        if m.row(3) != DVec4::W {
            return None;
        }
        let matrix = DAffine3::from_mat4(m);
        let linear = matrix.matrix3;
        let det = linear.determinant();
        let is_regular = det.abs() > 8.0 * f64::EPSILON * permanent(linear.abs());
        if !is_regular {
            return None;
        }
        Transform::checked(matrix, matrix.inverse(), det < 0.0)
    }

    /// Composition: this transform first, then `next`.
    pub fn then(&self, next: &Transform) -> Transform {
        Transform { matrix: next.matrix * self.matrix, inverse: self.inverse * next.inverse, flips: self.flips ^ next.flips }
    }

    /// Inverse transform.
    pub fn inverse(&self) -> Transform {
        Transform { matrix: self.inverse, inverse: self.matrix, flips: self.flips }
    }

    /// Matrix of the inverse.
    pub fn inverse_matrix(&self) -> DAffine3 {
        self.inverse
    }

    /// Transforms a point.
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.matrix.transform_point3(p)
    }

    /// Transforms a difference of points, without translation.
    pub fn vector(&self, v: DVec3) -> DVec3 {
        self.matrix.transform_vector3(v)
    }

    /// Bounding box of a transformed box; an empty box (low > high) stays empty.
    pub fn bounds(&self, [low, high]: [DVec3; 2]) -> [DVec3; 2] {
        let nothing = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        if !low.cmple(high).all() {
            return nothing;
        }
        let corners = (0..8).map(|k| DVec3::select(BVec3::new(k & 1 != 0, k & 2 != 0, k & 4 != 0), high, low));
        corners.map(|p| self.point(p)).fold(nothing, |[low, high], p| [low.min(p), high.max(p)])
    }

    /// Transforms a normal to a unit normal, which is perpendicular to the transformed tangents.
    ///
    /// n ↦ M⁻ᵀ n / |M⁻ᵀ n|
    ///
    /// - A mirroring transform keeps the side that the normal marks. The cross product of transformed edges changes side instead, see
    ///   [`flips_handedness`](Self::flips_handedness).
    /// - A zero vector stays zero.
    ///
    /// Tests: n·t = 0 kept, scale (2, 1, 1), mirrors.
    pub fn normal(&self, n: DVec3) -> DVec3 {
        unit(self.inverse.matrix3.transpose() * n).unwrap_or(DVec3::ZERO)
    }

    /// Whether the transform mirrors, so that a right-handed frame becomes left-handed: det M < 0.
    pub fn flips_handedness(&self) -> bool {
        self.flips
    }

    /// Determinant: the factor by which volumes grow, negative for mirroring transforms.
    pub fn determinant(&self) -> f64 {
        self.matrix.matrix3.determinant()
    }

    /// Matrix of the transform.
    pub fn matrix(&self) -> DAffine3 {
        self.matrix
    }

    /// Transform of a linear part with its inverse, and a translation.
    ///
    /// - `flips`: whether the transform mirrors
    pub(super) fn of_parts([linear, inverse]: [DMat3; 2], translation: DVec3, flips: bool) -> Transform {
        let matrix = DAffine3::from_mat3_translation(linear, translation);
        Transform { matrix, inverse: DAffine3::from_mat3_translation(inverse, -(inverse * translation)), flips }
    }

    fn checked(matrix: DAffine3, inverse: DAffine3, flips: bool) -> Option<Transform> {
        (matrix.is_finite() && inverse.is_finite()).then_some(Transform { matrix, inverse, flips })
    }
}

fn refused(why: String) -> Error {
    Error::invalid(Fault::new(why))
}

/// Unit vector in the direction of a vector of any length; `None` if it is zero or not finite.
pub fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    if !v.is_finite() || largest == 0.0 {
        return None;
    }
    // The division prevents overflow and underflow of the squares.
    let v = v / largest;
    Some(v / v.length())
}

/// Permanent: the sum of the determinant with all signs positive. The rounding error of the determinant is proportional to it.
fn permanent(m: DMat3) -> f64 {
    let [a, b, c] = [m.x_axis, m.y_axis, m.z_axis];
    a.x * (b.y * c.z + b.z * c.y) + a.y * (b.x * c.z + b.z * c.x) + a.z * (b.x * c.y + b.y * c.x)
}

/// Upper bound of the factor by which a matrix stretches a length: exact for similarities, otherwise √(‖M‖₁ ‖M‖∞).
pub fn greatest_stretch(m: DMat3) -> f64 {
    let square = m.transpose() * m;
    let s2 = square.x_axis.x.max(square.y_axis.y).max(square.z_axis.z);
    // The tolerance covers a few roundings of each entry.
    let near = |column: DVec3, e: DVec3| (column - e * s2).abs().max_element() <= 16.0 * f64::EPSILON * s2;
    if near(square.x_axis, DVec3::X) && near(square.y_axis, DVec3::Y) && near(square.z_axis, DVec3::Z) {
        return s2.sqrt();
    }
    let norm = |m: DMat3| m.x_axis.abs().element_sum().max(m.y_axis.abs().element_sum()).max(m.z_axis.abs().element_sum());
    (norm(m) * norm(m.transpose())).sqrt()
}
