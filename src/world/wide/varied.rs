//! Surfaces that do not look the same everywhere: textured ones, those with normal maps, absorbing glass, compounds. They are computed by
//! the code for single paths.

use super::{SurfaceLanes, WideWorld};
use crate::bsdf::Bsdf;
use crate::math::Spectrum;
use crate::math::lanes::{Lanes, MAX_COUNT, Vector, to_array};
use crate::primitive::Hit;
use crate::scene::{Scene, Surface};

/// Properties of the surfaces of all lanes, as arrays in which single lanes can be set.
pub struct SurfaceArrays {
    p: [[f32; MAX_COUNT]; 3],
    ng: [[f32; MAX_COUNT]; 3],
    ns: [[f32; MAX_COUNT]; 3],
    tangents: [[[f32; MAX_COUNT]; 3]; 2],
    offset: [f32; MAX_COUNT],
    albedo: [[f32; MAX_COUNT]; 3],
    radiance: [[f32; MAX_COUNT]; 3],
    is_diffuse: u32,
    emits: u32,
    is_two_sided: u32,
}

impl<'a> WideWorld<'a> {
    /// The scene of single paths.
    pub fn scene(&self) -> &'a dyn Scene {
        self.world
    }

    /// Whether the surface of a lane may reflect or refract into single directions.
    #[inline(always)]
    pub fn has_delta_lobes<L: Lanes>(&self, surface: &SurfaceLanes<'_, L>, lane: usize) -> bool {
        self.world.materials[surface.materials[lane] as usize].has_delta_lobes
    }
}

impl<'a, L: Lanes> SurfaceLanes<'a, L> {
    /// Bit mask of the lanes whose surfaces do not look the same everywhere. [`WideWorld::surfaces`] leaves them to its caller.
    #[inline(always)]
    pub fn varied(&self) -> u32 {
        self.varied
    }

    /// Hit of a lane.
    #[inline(always)]
    pub fn hit(&self, lane: usize) -> Hit {
        self.hits.get(lane)
    }

    /// The properties of all lanes.
    #[inline(always)]
    pub fn to_arrays(&self) -> SurfaceArrays {
        SurfaceArrays {
            p: self.p.to_arrays(),
            ng: self.ng.to_arrays(),
            ns: self.ns.to_arrays(),
            tangents: [self.tangents[0].to_arrays(), self.tangents[1].to_arrays()],
            offset: to_array::<L>(self.offset),
            albedo: self.albedo.to_arrays(),
            radiance: self.radiance.to_arrays(),
            is_diffuse: L::bits(self.is_diffuse),
            emits: L::bits(self.emits),
            is_two_sided: L::bits(self.is_two_sided),
        }
    }

    /// Sets the surface of a lane. Lanes must be set in ascending order, each once.
    #[inline(always)]
    pub fn set(&mut self, arrays: &mut SurfaceArrays, lane: usize, surface: &Surface<'a>) {
        arrays.set(lane, surface);
        if !matches!(surface.bsdf, Bsdf::Diffuse(_)) {
            self.modelled |= 1 << lane;
            self.models.reserve_exact(MAX_COUNT - self.models.len());
            self.models.push(surface.bsdf);
        }
    }

    /// Takes the properties from arrays in which lanes were set.
    #[inline(always)]
    pub fn take(&mut self, arrays: &SurfaceArrays) {
        self.p = Vector::from_arrays(&arrays.p);
        self.ng = Vector::from_arrays(&arrays.ng);
        self.ns = Vector::from_arrays(&arrays.ns);
        self.tangents = [Vector::from_arrays(&arrays.tangents[0]), Vector::from_arrays(&arrays.tangents[1])];
        self.offset = L::load(&arrays.offset);
        self.albedo = Vector::from_arrays(&arrays.albedo);
        self.radiance = Vector::from_arrays(&arrays.radiance);
        self.is_diffuse = L::mask(arrays.is_diffuse);
        self.emits = L::mask(arrays.emits);
        self.is_two_sided = L::mask(arrays.is_two_sided);
    }
}

impl SurfaceArrays {
    #[inline(never)]
    fn set(&mut self, lane: usize, surface: &Surface) {
        let Surface { point, frame, bsdf, emission, .. } = surface;
        let albedo = if let Bsdf::Diffuse(diffuse) = bsdf { diffuse.albedo } else { Spectrum::BLACK };
        let radiance = emission.map_or(Spectrum::BLACK, |emission| emission.radiance);
        let [x, y] = &mut self.tangents;
        let rows: [(&mut [[f32; MAX_COUNT]; 3], [f32; 3]); 7] = [
            (&mut self.p, point.p.into()),
            (&mut self.ng, point.ng.into()),
            (&mut self.ns, frame.z.into()),
            (x, frame.x.into()),
            (y, frame.y.into()),
            (&mut self.albedo, albedo.coefficients()),
            (&mut self.radiance, radiance.coefficients()),
        ];
        for (row, values) in rows {
            (row[0][lane], row[1][lane], row[2][lane]) = values.into();
        }
        self.offset[lane] = point.offset;
        set_bit(&mut self.is_diffuse, lane, matches!(bsdf, Bsdf::Diffuse(_)));
        set_bit(&mut self.emits, lane, emission.is_some());
        set_bit(&mut self.is_two_sided, lane, emission.is_some_and(|emission| emission.two_sided));
    }
}

fn set_bit(bits: &mut u32, k: usize, yes: bool) {
    *bits = *bits & !(1 << k) | u32::from(yes) << k;
}
