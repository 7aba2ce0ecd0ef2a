//! Spaces of paths that are followed side by side.

use super::distances::{EquiangularLanes, TruncatedLanes};
use super::way::POINTS_PER_SCATTERING;
use super::{Filled, Space, Vacuum};
use crate::accel::Hits;
use crate::integrator::PathLanes;
use crate::math::float;
use crate::math::lanes::{Lanes, Rays, Vector};
use crate::medium::{Medium, transmittance_lanes};
use crate::sampler::NumberLanes;
use crate::sampler::dimension::{self, OnWay, Use};
use crate::scene::Scene;
use crate::world::{MediumLanes, WideWorld};

/// [`Space`] of several paths, one in each lane: each lane gets the bits of a single path.
///
/// Its methods must be `#[inline(always)]`, see [`Kernel`](crate::math::lanes::Kernel).
pub trait WideSpace: Space {
    /// The scene, if paths in this space can be followed side by side.
    fn scene(scene: &dyn Scene) -> Option<WideWorld<'_>>;

    /// [`Space::scatter`]: the points at which a medium scatters paths. The hits of those paths are removed.
    #[inline(always)]
    fn scatter_lanes<'s, L: Lanes>(
        _scene: WideWorld<'s>,
        _paths: &mut PathLanes<'_, L>,
        _hits: &mut Hits,
        _numbers: &mut NumberLanes<L>,
        _depth: u32,
        _active: L::Mask,
    ) -> Option<MediumLanes<'s, L>> {
        None
    }

    /// [`Space::point_on_way`]: points on the ways to the next surfaces, and the weights of the light that arrives there.
    #[inline(always)]
    fn points_on_way<'s, L: Lanes>(
        _scene: WideWorld<'s>,
        _paths: &PathLanes<'_, L>,
        _hits: &Hits,
        _numbers: &mut NumberLanes<L>,
        _depth: u32,
        _active: L::Mask,
    ) -> Option<(MediumLanes<'s, L>, Vector<L>)> {
        None
    }

    /// The lanes of `active` in which media let light pass along rays, and its share.
    ///
    /// - `from`: points that the rays leave
    #[inline(always)]
    fn transmittance_lanes<L: Lanes>(_scene: WideWorld, _rays: &Rays<L>, _from: Vector<L>, active: L::Mask) -> (L::Mask, L::F32) {
        (active, L::f32(1.0))
    }
}

impl WideSpace for Vacuum {
    fn scene(scene: &dyn Scene) -> Option<WideWorld<'_>> {
        WideWorld::of(scene)
    }
}

/// Space that one medium fills, see [`Media::uniform`](crate::medium::Media::uniform).
impl WideSpace for Filled {
    fn scene(scene: &dyn Scene) -> Option<WideWorld<'_>> {
        WideWorld::of(scene).filter(|scene| scene.medium().is_some())
    }

    #[inline(always)]
    fn scatter_lanes<'s, L: Lanes>(
        scene: WideWorld<'s>,
        paths: &mut PathLanes<'_, L>,
        hits: &mut Hits,
        numbers: &mut NumberLanes<L>,
        depth: u32,
        active: L::Mask,
    ) -> Option<MediumLanes<'s, L>> {
        let medium = scene.medium()?;
        let (shift, length) = ways(paths, hits);
        if medium.emits() {
            paths.add(active, medium.emitted_lanes(length));
        }
        if !medium.scatters() {
            paths.beta = paths.beta.scaled(transmittance_lanes::<L>(medium.depth_lanes::<L>(length)));
            return None;
        }
        let u = numbers.get_1d(dimension::vertex(depth, Use::Medium));
        let reach = -float::ln_lanes::<L>(L::f32(1.0) - u) / extinction::<L>(medium);
        let found = active & L::lt(reach, length);
        if !L::any(found) {
            return None;
        }
        let albedo = Vector::splat(medium.albedo().coefficients().into());
        paths.beta = Vector::select(found, paths.beta * albedo, paths.beta);
        paths.leave_surfaces(found);
        hits.found &= !L::bits(found);
        Some(MediumLanes { found, p: point(paths, shift, reach), phase: &medium.phase })
    }

    #[inline(always)]
    fn points_on_way<'s, L: Lanes>(
        scene: WideWorld<'s>,
        paths: &PathLanes<'_, L>,
        hits: &Hits,
        numbers: &mut NumberLanes<L>,
        depth: u32,
        active: L::Mask,
    ) -> Option<(MediumLanes<'s, L>, Vector<L>)> {
        let medium = scene.medium().filter(|medium| medium.scatters())?;
        let (zero, half, one, two) = (L::f32(0.0), L::f32(0.5), L::f32(1.0), L::f32(2.0));
        let (shift, length) = ways(paths, hits);
        let flight = TruncatedLanes::<L>::new(extinction::<L>(medium), medium.depth_lanes::<L>(length));
        let v = numbers.get_1d(dimension::on_way(depth, OnWay::Distance));
        let chance = L::min(L::f32(POINTS_PER_SCATTERING) * flight.scattered, one);
        let chosen = active & L::lt(zero, length) & L::lt(zero, flight.scattered) & L::lt(v, chance);
        if !L::any(chosen) {
            return None;
        }
        let v = L::min(v / chance, L::f32(float::ONE_MINUS_EPSILON));
        let (guide, has_guide) = scene.place_of_light(numbers.get_3d(dimension::on_way(depth, OnWay::Guide)), chosen);
        let rays = &paths.rays;
        let start = rays.origin + rays.direction.scaled(-shift);
        let (angular, is_usable) = EquiangularLanes::<L>::new(guide - start, rays.direction, length);
        let is_usable = is_usable & has_guide;
        let (by_angle, twice) = (is_usable & L::lt(v, half), two * v);
        let along = flight.sample(L::select(is_usable, twice - one, v), length);
        let t = L::select(by_angle, angular.sample(twice), along);
        let passed = medium.depth_lanes::<L>(L::max(L::min(length, t), zero));
        let by_flight = flight.density(passed);
        let density = L::select(is_usable, half * (by_flight + angular.density(t)), by_flight);
        let found = chosen & L::lt(t, length) & L::lt(zero, density);
        let scattering = Vector::<L>::splat(medium.scattering().coefficients().into());
        let weight = scattering.scaled(transmittance_lanes::<L>(passed)).scaled(one / (chance * density));
        Some((MediumLanes { found, p: point(paths, shift, t), phase: &medium.phase }, weight))
    }

    #[inline(always)]
    fn transmittance_lanes<L: Lanes>(scene: WideWorld, rays: &Rays<L>, from: Vector<L>, active: L::Mask) -> (L::Mask, L::F32) {
        let (zero, Some(medium)) = (L::f32(0.0), scene.medium()) else { return (active, L::f32(1.0)) };
        let shift = (rays.origin - from).dot(rays.direction);
        let length = L::max(rays.t_max + shift, zero);
        let passed = transmittance_lanes::<L>(medium.depth_lanes::<L>(length));
        (active & L::lt(zero, passed), passed)
    }
}

/// σa + σs (m⁻¹).
#[inline(always)]
fn extinction<L: Lanes>(medium: &Medium) -> L::F32 {
    L::f32(medium.extinction().coefficients()[0])
}

/// Distances along the rays of their origins from the points that they leave, and lengths of the ways from those points to the hits (m).
#[inline(always)]
fn ways<L: Lanes>(paths: &PathLanes<'_, L>, hits: &Hits) -> (L::F32, L::F32) {
    let shift = (paths.rays.origin - paths.from.p).dot(paths.rays.direction);
    let t = L::select(L::mask(hits.found), L::load(&hits.t), L::f32(f32::INFINITY));
    (shift, L::max(t + shift, L::f32(0.0)))
}

/// Points of rays.
///
/// - `shift`: distances of the origins from the points that the rays leave (m)
/// - `length`: lengths of the ways from those points (m)
#[inline(always)]
fn point<L: Lanes>(paths: &PathLanes<'_, L>, shift: L::F32, length: L::F32) -> Vector<L> {
    paths.rays.origin + paths.rays.direction.scaled(L::max(length - shift, L::f32(0.0)))
}
