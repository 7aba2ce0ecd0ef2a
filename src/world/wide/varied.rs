//! Surfaces that do not look the same everywhere: textured ones, those with normal maps, absorbing glass, compounds. They are computed by
//! the code for single paths.

use super::{PointArrays, SurfaceLanes, WideWorld};
use crate::bsdf::Bsdf;
use crate::math::Spectrum;
use crate::math::lanes::{Lanes, MAX_COUNT, Vector, to_array};
use crate::primitive::Hit;
use crate::scene::{Scene, Surface};

/// Properties of the surfaces of all lanes, as arrays in which single lanes can be set.
pub struct SurfaceArrays {
    points: PointArrays,
    tangents: [[[f32; MAX_COUNT]; 3]; 2],
    albedo: [[f32; MAX_COUNT]; 3],
    radiance: [[f32; MAX_COUNT]; 3],
    is_diffuse: u32,
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
            points: PointArrays {
                p: self.p.to_arrays(),
                ng: self.ng.to_arrays(),
                ns: self.ns.to_arrays(),
                offset: to_array::<L>(self.offset),
            },
            tangents: [self.tangents[0].to_arrays(), self.tangents[1].to_arrays()],
            albedo: self.albedo.to_arrays(),
            radiance: self.radiance.to_arrays(),
            is_diffuse: L::bits(self.is_diffuse),
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
        self.p = Vector::from_arrays(&arrays.points.p);
        self.ng = Vector::from_arrays(&arrays.points.ng);
        self.ns = Vector::from_arrays(&arrays.points.ns);
        self.tangents = [Vector::from_arrays(&arrays.tangents[0]), Vector::from_arrays(&arrays.tangents[1])];
        self.offset = L::load(&arrays.points.offset);
        self.albedo = Vector::from_arrays(&arrays.albedo);
        self.radiance = Vector::from_arrays(&arrays.radiance);
        self.is_diffuse = L::mask(arrays.is_diffuse);
    }
}

impl SurfaceArrays {
    #[inline(never)]
    fn set(&mut self, lane: usize, surface: &Surface) {
        let Surface { point, frame, bsdf, emission, .. } = surface;
        let albedo = if let Bsdf::Diffuse(diffuse) = bsdf { diffuse.albedo } else { Spectrum::BLACK };
        let radiance = emission.map_or(Spectrum::BLACK, |emission| emission.radiance);
        let [x, y] = &mut self.tangents;
        self.points.set(lane, point);
        let rows: [(&mut [[f32; MAX_COUNT]; 3], [f32; 3]); 4] = [
            (x, frame.x.into()),
            (y, frame.y.into()),
            (&mut self.albedo, albedo.coefficients()),
            (&mut self.radiance, radiance.coefficients()),
        ];
        for (row, values) in rows {
            (row[0][lane], row[1][lane], row[2][lane]) = values.into();
        }
        self.is_diffuse = self.is_diffuse & !(1 << lane) | u32::from(matches!(bsdf, Bsdf::Diffuse(_))) << lane;
    }
}
