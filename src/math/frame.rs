//! Local frames of surfaces, with the normal as +z.

use glam::Vec3;

/// Direction in the local frame of a surface, with +z along the shading normal.
///
/// The separate type ensures that world directions cannot be passed to a BSDF:
///
/// ```compile_fail
/// use pt::math::{Local, Vec3};
/// fn cosine(w: Local) -> f32 { w.cos() }
/// cosine(Vec3::Z); // a world direction: does not compile
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local(pub Vec3);

impl Local {
    /// The shading normal.
    pub const NORMAL: Local = Local(Vec3::Z);

    /// The direction with these coordinates.
    pub fn new(x: f32, y: f32, z: f32) -> Local {
        Local(Vec3::new(x, y, z))
    }

    /// cos θ, which is negative below the surface.
    pub fn cos(self) -> f32 {
        self.0.z
    }

    /// Absolute value of the cosine, |cos θ|.
    pub fn abs_cos(self) -> f32 {
        self.0.z.abs()
    }

    /// The direction, mirrored at the surface if necessary, so that it is on the side of `other`.
    pub fn on_the_side_of(self, other: Local) -> Local {
        Local(self.0.with_z(self.0.z.copysign(other.0.z)))
    }

    /// Whether both directions are on the same side of the surface. A direction in the surface is on neither side.
    pub fn same_side(self, other: Local) -> bool {
        // The signs are compared separately, because the product may underflow to 0.
        let (a, b) = (self.0.z, other.0.z);
        (a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0)
    }
}

/// Right-handed orthonormal basis: x × y = z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// First axis, a tangent.
    pub x: Vec3,
    /// Second axis, a tangent.
    pub y: Vec3,
    /// Third axis, the normal.
    pub z: Vec3,
}

impl Frame {
    /// A basis around the unit vector `z`, valid for every `z` and computed without branches.
    ///
    /// Source: Duff et al., *Building an Orthonormal Basis, Revisited*, JCGT 6(1), 2017.
    /// Tests: frames_are_orthonormal.
    pub fn around(z: Vec3) -> Frame {
        let sign = 1f32.copysign(z.z);
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        Frame { x: Vec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x), y: Vec3::new(b, sign + z.y * z.y * a, -z.y), z }
    }

    /// The basis around the unit vector `z` whose x axis is as close to `x` as possible; `None` if `x` is parallel to `z`.
    pub fn along(z: Vec3, x: Vec3) -> Option<Frame> {
        let x = (x - z * z.dot(x)).try_normalize()?;
        Some(Frame { x, y: z.cross(x), z })
    }

    /// Transforms a direction from world space to the local frame.
    pub fn to_local(&self, world: Vec3) -> Local {
        Local(Vec3::new(world.dot(self.x), world.dot(self.y), world.dot(self.z)))
    }

    /// Transforms a direction from the local frame to world space.
    pub fn to_world(&self, Local(w): Local) -> Vec3 {
        self.x * w.x + self.y * w.y + self.z * w.z
    }
}
