//! Warnings about media: bodies that are not closed, and media that hide all distant light.

use super::open_glass::{LOST_BY_ROUNDING, is_body};
use super::rays::{points, scattered};
use super::{Linted, first_few};
use crate::accel;
use crate::effects::Effects;
use crate::light::Light;
use crate::math::Ray;
use crate::scene::Scene as _;
use crate::world::World;

/// The number of test rays into each body, unless that makes more than `MOST_RAYS` in total.
const RAYS: u32 = 1024;
/// The largest number of test rays in total.
const MOST_RAYS: u32 = 1 << 15;

/// Warnings about shapes with a medium that rays can enter and then be outside of without crossing their surface.
pub(super) fn open(linted: &Linted) -> Vec<String> {
    let Some(media) = linted.world.media() else { return vec![] };
    // What is wrong with glass is told of glass.
    let bodies: Vec<u32> = media.bodies().map(|(_, shape)| shape).filter(|shape| !linted.world.materials(*shape).any(is_body)).collect();
    let rays = MOST_RAYS.checked_div(bodies.len() as u32).map_or(0, |rays| rays.min(RAYS));
    let lost = bodies.into_iter().map(|shape| (shape, lost(linted.world, shape, rays)));
    let said = lost.filter(|(_, lost)| *lost > LOST_BY_ROUNDING).map(|(shape, lost)| {
        let percent = (100.0 * f64::from(lost) / f64::from(rays)).max(1.0).round();
        format!(
            "{}: the boundary of a medium that is open or inconsistently wound: {percent} % of the ways into it lead out past its surface, \
             and the medium reaches to infinity there; close it, all faces outwards",
            linted.name(shape)
        )
    });
    first_few(said.collect(), "more such shapes")
}

/// The number of straight rays into a body that meet its outer side from within, or nothing.
fn lost(world: &World, shape: u32, count: u32) -> u32 {
    let body = accel::build_with_instances(world.shapes(), vec![shape], vec![]);
    let is_lost = |ray: &Ray| body.intersect(ray).is_none_or(|hit| world.surface(ray, &hit).point.ng.dot(ray.direction) < 0.0);
    let rays = points(world, shape, count).map(|mut from| scattered(&from.point, -1.0, &mut from.numbers));
    rays.filter(is_lost).count() as u32
}

/// A warning if the medium around the scene swallows all light from infinitely far away.
pub(super) fn hidden(linted: &Linted) -> Vec<String> {
    let lights = linted.world.lights();
    let has_distant = lights.effects().contains(Effects::ENVIRONMENT) || lights.iter().any(|light| matches!(light, Light::Directional(_)));
    let around = linted.world.media().and_then(|media| media.around());
    let is_opaque = around.is_some_and(|medium| medium.density().is_none() && medium.extinction().min() > 0.0);
    let said = "/medium: the medium around the scene has no end, so that no light from infinitely far away passes it: backgrounds, suns and \
                directional lights do not show; put the medium into a large box or sphere";
    (has_distant && is_opaque).then(|| said.to_owned()).into_iter().collect()
}
