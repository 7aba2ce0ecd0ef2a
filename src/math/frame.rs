//! Shading space: the normal is +z.

use glam::Vec3;

/// A direction in the local frame of a surface, +z along the shading normal.
///
/// A type of its own, so that world directions cannot be passed to a BSDF:
///
/// ```compile_fail
/// use pt::math::{Local, Vec3};
/// fn cosine(w: Local) -> f32 { w.cos() }
/// cosine(Vec3::Z); // a world direction: does not compile
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local(pub Vec3);

impl Local {
    pub const NORMAL: Local = Local(Vec3::Z);

    pub fn new(x: f32, y: f32, z: f32) -> Local {
        Local(Vec3::new(x, y, z))
    }

    /// cos θ, signed: negative below the surface.
    pub fn cos(self) -> f32 {
        self.0.z
    }

    pub fn abs_cos(self) -> f32 {
        self.0.z.abs()
    }

    /// The same direction, or its mirror image on the side of the surface where `other` is.
    pub fn on_the_side_of(self, other: Local) -> Local {
        Local(self.0.with_z(self.0.z.copysign(other.0.z)))
    }

    /// Both on the same side of the surface; a direction in the surface is on neither.
    pub fn same_side(self, other: Local) -> bool {
        // Not the sign of the product, which may underflow to 0.
        let (a, b) = (self.0.z, other.0.z);
        (a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0)
    }
}

/// An orthonormal basis, right-handed: x × y = z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    pub x: Vec3,
    pub y: Vec3,
    pub z: Vec3,
}

impl Frame {
    /// A basis around the unit vector `z`, for every `z` and without a branch.
    ///
    /// Source: Duff et al., *Building an Orthonormal Basis, Revisited*, JCGT 6(1), 2017.
    /// Tests: frames_are_orthonormal.
    pub fn around(z: Vec3) -> Frame {
        let sign = 1f32.copysign(z.z);
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        Frame { x: Vec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x), y: Vec3::new(b, sign + z.y * z.y * a, -z.y), z }
    }

    /// The basis around the unit vector `z` whose x axis is as near to `x` as can be; `None` where that is along `z`.
    pub fn along(z: Vec3, x: Vec3) -> Option<Frame> {
        let x = (x - z * z.dot(x)).try_normalize()?;
        Some(Frame { x, y: z.cross(x), z })
    }

    pub fn to_local(&self, world: Vec3) -> Local {
        Local(Vec3::new(world.dot(self.x), world.dot(self.y), world.dot(self.z)))
    }

    pub fn to_world(&self, Local(w): Local) -> Vec3 {
        self.x * w.x + self.y * w.y + self.z * w.z
    }
}
