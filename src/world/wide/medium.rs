//! Points at which a medium scatters the paths of several lanes.

use glam::Vec3;

use super::{LightLanes, ReceiverLanes, ScatteredLanes, WideWorld};
use crate::accel::NO_PLACE;
use crate::math::lanes::{Lanes, Rays, Vector};
use crate::medium::{Media, Medium, Phase};

/// Points of the medium of [`WideWorld::medium`], one in each lane.
pub struct MediumLanes<'a, L: Lanes> {
    /// Which lanes have one.
    pub found: L::Mask,
    /// Positions (m).
    pub p: Vector<L>,
    /// Phase function of the medium.
    pub phase: &'a Phase,
}

impl<'a> WideWorld<'a> {
    /// The medium that is everywhere, if there is one.
    #[inline(always)]
    pub fn medium(&self) -> Option<&'a Medium> {
        // A scene with other media has no tables.
        self.world.media.as_ref().and_then(Media::around)
    }
}

impl<L: Lanes> MediumLanes<'_, L> {
    /// The points as lights are sampled for them.
    #[inline(always)]
    pub fn receiver(&self) -> ReceiverLanes<L> {
        ReceiverLanes::at(self.p)
    }

    /// Shadow rays towards light samples, as [`Interaction::shadow_ray`](crate::scene::Interaction::shadow_ray).
    #[inline(always)]
    pub fn shadow_rays(&self, light: &LightLanes<L>) -> Rays<L> {
        light.rays_from(self.p)
    }

    /// The samples of surfaces, with samples of the phase function in the lanes of the points.
    #[inline(always)]
    pub fn scatter(&self, wo: Vector<L>, [_, u, v]: [L::F32; 3], at_surfaces: ScatteredLanes<L>) -> ScatteredLanes<L> {
        let (which, one) = (self.found, L::f32(1.0));
        let wi = self.phase.sample_lanes(wo, [u, v]);
        let pdf = self.phase.eval_lanes(wo, wi);
        ScatteredLanes {
            found: at_surfaces.found | which,
            wi: Vector::select(which, wi, at_surfaces.wi),
            weight: Vector::select(which, Vector::splat(Vec3::ONE), at_surfaces.weight),
            pdf: L::select(which, pdf, at_surfaces.pdf),
            eta: L::select(which, one, at_surfaces.eta),
        }
    }

    /// In the lanes of the points, lets rays start there.
    #[inline(always)]
    pub fn leave(&self, wi: Vector<L>, rays: &mut Rays<L>, from: &mut ReceiverLanes<L>) {
        let (which, receiver) = (self.found, self.receiver());
        rays.origin = Vector::select(which, self.p, rays.origin);
        rays.direction = Vector::select(which, wi, rays.direction);
        rays.skip = L::select_u32(which, L::u32(NO_PLACE), rays.skip);
        from.p = Vector::select(which, self.p, from.p);
        from.ng = Vector::select(which, receiver.ng, from.ng);
        from.ns = Vector::select(which, receiver.ns, from.ns);
        from.transmits = from.transmits & !which;
    }
}
