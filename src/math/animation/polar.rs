//! Polar decomposition of matrices into a rotation and a scale along perpendicular axes.

use glam::DMat3;

/// Greatest number of iterations. Ten are enough for any matrix whose inverse has a few correct digits.
const MOST_ITERATIONS: usize = 64;

/// Rotation R and symmetric matrix S with M = R S, for a regular matrix M. S is positive definite, or negative definite if M mirrors.
/// `None` for a matrix that is singular within rounding.
///
/// Q ← ½ (g Q + Q⁻ᵀ / g),    g = √(|Q⁻¹| / |Q|),    beginning with M, converges to the orthogonal matrix nearest to M.
///
/// Source: Higham, *Computing the Polar Decomposition, with Applications* (1986). Tests: polar_parts_make_the_matrix.
pub fn decomposed(m: DMat3) -> Option<(DMat3, DMat3)> {
    let norm = |m: DMat3| (m.x_axis.length_squared() + m.y_axis.length_squared() + m.z_axis.length_squared()).sqrt();
    let mut q = m * (1.0 / norm(m));
    for _ in 0..MOST_ITERATIONS {
        let inverse = q.inverse();
        let scale = (norm(inverse) / norm(q)).sqrt();
        let next = (q * scale + inverse.transpose() * (1.0 / scale)) * 0.5;
        if !next.is_finite() {
            return None;
        }
        let change = norm(next - q);
        q = next;
        if change <= 4.0 * f64::EPSILON {
            let rotation = if q.determinant() < 0.0 { q * -1.0 } else { q };
            let s = rotation.transpose() * m;
            let s = (s + s.transpose()) * 0.5;
            return is_definite(if q.determinant() < 0.0 { s * -1.0 } else { s }).then_some((rotation, s));
        }
    }
    None
}

/// Whether a symmetric matrix is positive definite: all of its leading minors are above 0. Rounding may take that from a matrix whose scales
/// differ by a factor of 10¹³ or more.
fn is_definite(s: DMat3) -> bool {
    let minor = s.x_axis.x * s.y_axis.y - s.x_axis.y * s.y_axis.x;
    s.x_axis.x > 0.0 && minor > 0.0 && s.determinant() > 0.0
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn greatest(m: DMat3) -> f64 {
        m.to_cols_array().into_iter().fold(0.0, |most: f64, x| most.max(x.abs()))
    }

    /// R S is the matrix, R is a rotation, and S is symmetric, for rotations, scales, shears and mirrors of any size.
    #[test]
    fn polar_parts_make_the_matrix() {
        for k in 0..1000 {
            let k = f64::from(k);
            let axis = DVec3::new((1.3 * k).sin(), (2.1 * k).cos(), (0.7 * k).sin()).normalize();
            let turn = DMat3::from_axis_angle(axis, 0.37 * k);
            let scale = DMat3::from_diagonal(DVec3::new((0.3 * k).sin() + 1.1, 1.0, if k % 2.0 == 0.0 { -2.0 } else { 0.3 }));
            let shear = DMat3::from_cols(DVec3::X, DVec3::new((0.9 * k).sin(), 1.0, 0.0), DVec3::Z);
            let m = turn * scale * shear * 2f64.powf((k % 80.0) - 40.0);
            let (rotation, stretch) = decomposed(m).expect("regular");
            let size = greatest(m);
            assert!(greatest(rotation * stretch - m) <= 1e-14 * size, "{m} = {rotation} {stretch}");
            assert!(greatest(rotation.transpose() * rotation - DMat3::IDENTITY) <= 1e-15, "{rotation}");
            assert!(rotation.determinant() > 0.0 && stretch == stretch.transpose());
            assert_eq!(stretch.determinant() < 0.0, m.determinant() < 0.0);
        }
        assert_eq!(decomposed(DMat3::from_cols(DVec3::X, DVec3::X, DVec3::Z)), None);
    }
}
