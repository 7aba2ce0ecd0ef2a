//! Vectors of three numbers in each lane.

use std::ops::{Add, Mul, Neg, Sub};

use glam::{DVec3, Mat3, Vec3};

use super::{Lanes, One};

/// Number in a lane. Panics if there is no such lane.
#[inline(always)]
pub fn get<L: Lanes>(x: L::F32, lane: usize) -> f32 {
    to_array::<L>(x)[..L::COUNT][lane]
}

/// The numbers of all lanes, then zeros.
#[inline(always)]
pub fn to_array<L: Lanes>(x: L::F32) -> [f32; 16] {
    let mut array = [0.0; 16];
    L::store(x, &mut array);
    array
}

/// The numbers of all lanes, then zeros.
#[inline(always)]
pub fn to_array_u32<L: Lanes>(x: L::U32) -> [u32; 16] {
    let mut array = [0; 16];
    L::store_u32(x, &mut array);
    array
}

/// Vectors of three numbers, one vector in each lane. The operations give the same bits as those of [`Vec3`].
#[derive(Clone, Copy)]
pub struct Vector<L: Lanes> {
    /// First components.
    pub x: L::F32,
    /// Second components.
    pub y: L::F32,
    /// Third components.
    pub z: L::F32,
}

impl<L: Lanes> Vector<L> {
    /// `v` in all lanes.
    #[inline(always)]
    pub fn splat(v: Vec3) -> Vector<L> {
        Vector { x: L::f32(v.x), y: L::f32(v.y), z: L::f32(v.z) }
    }

    /// First components of three slices. Panics if one of them is too short.
    #[inline(always)]
    pub fn load(x: &[f32], y: &[f32], z: &[f32]) -> Vector<L> {
        Vector { x: L::load(x), y: L::load(y), z: L::load(z) }
    }

    /// Products with numbers.
    #[inline(always)]
    pub fn scaled(self, by: L::F32) -> Vector<L> {
        Vector { x: self.x * by, y: self.y * by, z: self.z * by }
    }

    /// Quotients by numbers, each component divided.
    #[inline(always)]
    pub fn divided(self, by: L::F32) -> Vector<L> {
        Vector { x: self.x / by, y: self.y / by, z: self.z / by }
    }

    /// Scalar products.
    #[inline(always)]
    pub fn dot(self, other: Vector<L>) -> L::F32 {
        (self.x * other.x) + (self.y * other.y) + (self.z * other.z)
    }

    /// Vector products.
    #[inline(always)]
    pub fn cross(self, other: Vector<L>) -> Vector<L> {
        Vector { x: self.y * other.z - other.y * self.z, y: self.z * other.x - other.z * self.x, z: self.x * other.y - other.x * self.y }
    }

    /// Squares of the lengths.
    #[inline(always)]
    pub fn length_squared(self) -> L::F32 {
        self.dot(self)
    }

    /// Lengths.
    #[inline(always)]
    pub fn length(self) -> L::F32 {
        L::sqrt(self.length_squared())
    }

    /// Vectors of the same directions with length 1.
    #[inline(always)]
    pub fn normalized(self) -> Vector<L> {
        self.scaled(L::f32(1.0) / self.length())
    }

    /// Products M·v with a matrix.
    #[inline(always)]
    pub fn transformed(self, matrix: &Mat3) -> Vector<L> {
        let (x, y, z) = (Vector::splat(matrix.x_axis), Vector::splat(matrix.y_axis), Vector::splat(matrix.z_axis));
        x.scaled(self.x) + y.scaled(self.y) + z.scaled(self.z)
    }

    /// `yes` where the mask is true, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: L::Mask, yes: Vector<L>, no: Vector<L>) -> Vector<L> {
        Vector { x: L::select(mask, yes.x, no.x), y: L::select(mask, yes.y, no.y), z: L::select(mask, yes.z, no.z) }
    }

    /// Converts to double precision, exactly.
    #[inline(always)]
    pub fn widened(self) -> VectorF64<L> {
        VectorF64 { x: L::widen(self.x), y: L::widen(self.y), z: L::widen(self.z) }
    }

    /// Vector in a lane. Panics if there is no such lane.
    #[inline(always)]
    pub fn get(self, lane: usize) -> Vec3 {
        Vec3::new(get::<L>(self.x, lane), get::<L>(self.y, lane), get::<L>(self.z, lane))
    }

    /// Replaces the vector in a lane. Panics if there is no such lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, v: Vec3) {
        let [mut x, mut y, mut z] = [to_array::<L>(self.x), to_array::<L>(self.y), to_array::<L>(self.z)];
        x[..L::COUNT][lane] = v.x;
        y[..L::COUNT][lane] = v.y;
        z[..L::COUNT][lane] = v.z;
        *self = Vector::load(&x, &y, &z);
    }
}

/// First two axes of [`Frame::around`](crate::math::Frame::around).
#[inline(always)]
pub fn tangents<L: Lanes>(z: Vector<L>) -> [Vector<L>; 2] {
    let one = L::f32(1.0);
    let sign = L::copysign(one, z.z);
    let a = -one / (sign + z.z);
    let b = z.x * z.y * a;
    [Vector { x: one + sign * z.x * z.x * a, y: sign * b, z: -sign * z.x }, Vector { x: b, y: sign + z.y * z.y * a, z: -z.y }]
}

impl From<Vec3> for Vector<One> {
    #[inline(always)]
    fn from(v: Vec3) -> Vector<One> {
        Vector::splat(v)
    }
}

impl From<Vector<One>> for Vec3 {
    #[inline(always)]
    fn from(v: Vector<One>) -> Vec3 {
        Vec3::new(v.x, v.y, v.z)
    }
}

impl<L: Lanes> Add for Vector<L> {
    type Output = Vector<L>;

    #[inline(always)]
    fn add(self, other: Vector<L>) -> Vector<L> {
        Vector { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl<L: Lanes> Sub for Vector<L> {
    type Output = Vector<L>;

    #[inline(always)]
    fn sub(self, other: Vector<L>) -> Vector<L> {
        Vector { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

/// Products component by component.
impl<L: Lanes> Mul for Vector<L> {
    type Output = Vector<L>;

    #[inline(always)]
    fn mul(self, other: Vector<L>) -> Vector<L> {
        Vector { x: self.x * other.x, y: self.y * other.y, z: self.z * other.z }
    }
}

impl<L: Lanes> Neg for Vector<L> {
    type Output = Vector<L>;

    #[inline(always)]
    fn neg(self) -> Vector<L> {
        Vector { x: -self.x, y: -self.y, z: -self.z }
    }
}

/// Vectors of three numbers in double precision, one vector in each lane. The operations give the same bits as those of
/// [`DVec3`].
#[derive(Clone, Copy)]
pub struct VectorF64<L: Lanes> {
    /// First components.
    pub x: L::F64,
    /// Second components.
    pub y: L::F64,
    /// Third components.
    pub z: L::F64,
}

impl<L: Lanes> VectorF64<L> {
    /// `v` in all lanes.
    #[inline(always)]
    pub fn splat(v: DVec3) -> VectorF64<L> {
        VectorF64 { x: L::f64(v.x), y: L::f64(v.y), z: L::f64(v.z) }
    }

    /// Scalar products.
    #[inline(always)]
    pub fn dot(self, other: VectorF64<L>) -> L::F64 {
        (self.x * other.x) + (self.y * other.y) + (self.z * other.z)
    }

    /// Vector products.
    #[inline(always)]
    pub fn cross(self, other: VectorF64<L>) -> VectorF64<L> {
        VectorF64 { x: self.y * other.z - other.y * self.z, y: self.z * other.x - other.z * self.x, z: self.x * other.y - other.x * self.y }
    }

    /// Squares of the lengths.
    #[inline(always)]
    pub fn length_squared(self) -> L::F64 {
        self.dot(self)
    }

    /// Lengths.
    #[inline(always)]
    pub fn length(self) -> L::F64 {
        L::sqrt_f64(self.length_squared())
    }

    /// Products with numbers.
    #[inline(always)]
    pub fn scaled(self, by: L::F64) -> VectorF64<L> {
        VectorF64 { x: self.x * by, y: self.y * by, z: self.z * by }
    }

    /// Quotients by numbers, each component divided.
    #[inline(always)]
    pub fn divided(self, by: L::F64) -> VectorF64<L> {
        VectorF64 { x: self.x / by, y: self.y / by, z: self.z / by }
    }

    /// Vectors of the same directions with length 1.
    #[inline(always)]
    pub fn normalized(self) -> VectorF64<L> {
        self.scaled(L::f64(1.0) / self.length())
    }

    /// The nearest vectors in single precision.
    #[inline(always)]
    pub fn narrowed(self) -> Vector<L> {
        Vector { x: L::narrow(self.x), y: L::narrow(self.y), z: L::narrow(self.z) }
    }
}

impl<L: Lanes> Add for VectorF64<L> {
    type Output = VectorF64<L>;

    #[inline(always)]
    fn add(self, other: VectorF64<L>) -> VectorF64<L> {
        VectorF64 { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl<L: Lanes> Sub for VectorF64<L> {
    type Output = VectorF64<L>;

    #[inline(always)]
    fn sub(self, other: VectorF64<L>) -> VectorF64<L> {
        VectorF64 { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}
