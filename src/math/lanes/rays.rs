//! Rays in each lane.

use super::{Lanes, MAX_COUNT, Vector, get};
use crate::math::Ray;

/// Rays side by side, one in each lane.
#[derive(Clone, Copy)]
pub struct Rays<L: Lanes> {
    /// Origins (m).
    pub origin: Vector<L>,
    /// Unit directions.
    pub direction: Vector<L>,
    /// Ends (m).
    pub t_max: L::F32,
    /// Numbers of triangles that the rays leave and so do not hit, as the hierarchy numbers them; `u32::MAX` for none.
    pub skip: L::U32,
}

impl<L: Lanes> Rays<L> {
    /// Rays in the first lanes, and these lanes. Panics if there are more rays than lanes.
    #[inline(always)]
    pub fn new(rays: &[Ray]) -> (Rays<L>, L::Mask) {
        assert!(rays.len() <= L::COUNT, "more rays than lanes");
        let mut numbers = [[0.0; MAX_COUNT]; 7];
        for (k, ray) in rays.iter().enumerate() {
            let (o, d) = (ray.origin, ray.direction);
            for (row, number) in [o.x, o.y, o.z, d.x, d.y, d.z, ray.t_max].into_iter().enumerate() {
                numbers[row][k] = number;
            }
        }
        let [ox, oy, oz, dx, dy, dz, t_max] = &numbers;
        let (origin, direction) = (Vector::load(ox, oy, oz), Vector::load(dx, dy, dz));
        (Rays { origin, direction, t_max: L::load(t_max), skip: L::u32(u32::MAX) }, L::mask((1 << rays.len()) - 1))
    }

    /// The ray of a lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> Ray {
        Ray { t_max: get::<L>(self.t_max, lane), ..Ray::new(self.origin.get(lane), self.direction.get(lane)) }
    }
}

impl<L: Lanes> Vector<L> {
    /// Components of all lanes.
    #[inline(always)]
    pub fn to_arrays(self) -> [[f32; MAX_COUNT]; 3] {
        let mut arrays = [[0.0; MAX_COUNT]; 3];
        L::store(self.x, &mut arrays[0]);
        L::store(self.y, &mut arrays[1]);
        L::store(self.z, &mut arrays[2]);
        arrays
    }

    /// Vectors with the given components.
    #[inline(always)]
    pub fn from_arrays(arrays: &[[f32; MAX_COUNT]; 3]) -> Vector<L> {
        Vector::load(&arrays[0], &arrays[1], &arrays[2])
    }

    /// Lanes all of whose components are 0.
    #[inline(always)]
    pub fn is_black(self) -> L::Mask {
        let zero = L::f32(0.0);
        L::le(L::abs(self.x), zero) & L::le(L::abs(self.y), zero) & L::le(L::abs(self.z), zero)
    }

    /// Greatest component, as [`Vec3::max_element`](glam::Vec3::max_element).
    #[inline(always)]
    pub fn max_element(self) -> L::F32 {
        L::max(self.x, L::max(self.y, self.z))
    }
}
