//! The point at which a texture is looked up, and the area around it that a pixel covers.

use glam::{DVec3, Vec2, Vec3};

use crate::shape::{SurfacePoint, VertexColor};

/// The point of a surface at which a texture is looked up: what a texture may depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureContext {
    /// The position in world space, moved behind the surface by its error bound (m). A wall on the border of two cells of a pattern so shows
    /// only one of them.
    pub p: Vec3,
    /// The texture coordinates.
    pub uv: Vec2,
    /// The interpolated colour of the vertices.
    pub color: VertexColor,
    /// The area that the texture is averaged over; `None` for the value at the point.
    pub footprint: Option<Footprint>,
}

/// The part of a surface that a ray of the camera stands for: a parallelogram on the tangent plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// The width along each axis of world space of the box with the same variance along it (m).
    pub widths: Vec3,
    /// The sides in texture coordinates; 0 where the surface's texture coordinates have no derivatives.
    pub uv: [Vec2; 2],
}

impl TextureContext {
    /// The context for the value at a point.
    pub fn exact(point: &SurfacePoint) -> TextureContext {
        TextureContext { p: point.p - point.ng * point.offset, uv: point.uv, color: point.color, footprint: None }
    }
}

impl Footprint {
    /// The footprint with given sides on the tangent plane.
    ///
    /// Solves side = du ∂p/∂u + dv ∂p/∂v in the sense of least squares, since the tangents of a smooth surface may lie off the plane.
    ///
    /// - `p`: the sides (m)
    /// - `tangents`: ∂p/∂u, ∂p/∂v (m)
    pub fn new(p: [Vec3; 2], tangents: Option<[Vec3; 2]>) -> Footprint {
        let solved = |[du, dv]: [Vec3; 2]| {
            let [du, dv] = [du, dv].map(|tangent| tangent.as_dvec3());
            let (uu, uv, vv) = (du.dot(du), du.dot(dv), dv.dot(dv));
            let determinant = uu * vv - uv * uv;
            let sides = p.map(|side| {
                let (u, v) = (du.dot(side.as_dvec3()), dv.dot(side.as_dvec3()));
                Vec2::new(((vv * u - uv * v) / determinant) as f32, ((uu * v - uv * u) / determinant) as f32)
            });
            sides.iter().all(|side| side.is_finite()).then_some(sides)
        };
        Footprint { widths: width(p).as_vec3(), uv: tangents.and_then(solved).unwrap_or_default() }
    }
}

/// The width along each axis of the box with the variance of a parallelogram along it.
///
/// For the sides a and b the variance is (a² + b²) / 12, for a box of the width w it is w² / 12.
pub(super) fn width(sides: [Vec3; 2]) -> DVec3 {
    let [a, b] = sides.map(|side| side.as_dvec3());
    (a * a + b * b).map(f64::sqrt)
}
