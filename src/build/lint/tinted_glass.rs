//! Warnings about glass that absorbs light and has something else in it.
//!
//! Glass applies its absorption where a ray hits its inner side, over the length since the previous vertex of the path. A path that hits
//! another object inside of the glass starts a new segment there, and the segment that led to the object is not absorbed.

use super::open_glass::LOST_BY_ROUNDING;
use super::rays::{Met, OnShape, are_of_one_shape, meet, points_of, scattered};
use super::{Linted, first_few};
use crate::math::{Ray, Rgb};
use crate::scene::Scene as _;
use crate::world::World;

/// The number of test rays into each shape, unless that makes more than `MOST_RAYS` in total.
const RAYS: u32 = 512;
/// The largest number of test rays in total.
const MOST_RAYS: u32 = 1 << 14;

/// Warnings about shapes of absorbing glass whose absorption is not exact.
pub(super) fn warnings(linted: &Linted) -> Vec<String> {
    let world = linted.world;
    let absorbing = (0..world.shapes().len() as u32).filter_map(|shape| Some((shape, absorption(world, shape)?)));
    let absorbing: Vec<(u32, Rgb)> = absorbing.collect();
    let rays = MOST_RAYS.checked_div(absorbing.len() as u32).map_or(0, |rays| rays.min(RAYS));
    let said = absorbing.into_iter().filter_map(|(shape, absorption)| {
        let within_media = points_of(world, shape, 1, |_| true).any(|from| is_in_medium(world, from));
        let stopped =
            points_of(world, shape, rays, |material| material.absorption().is_some()).filter(|from| is_stopped(world, from, absorption));
        let is_exact = !within_media && stopped.count() as u32 <= LOST_BY_ROUNDING;
        (!is_exact).then(|| sentence(linted.name(shape), absorption))
    });
    first_few(said.collect(), "more shapes of such glass")
}

/// The absorption of a shape's glass (1/m).
fn absorption(world: &World, shape: u32) -> Option<Rgb> {
    world.materials(shape).find_map(|material| material.absorption()).filter(|absorption| !absorption.is_black())
}

fn sentence(name: &str, absorption: Rgb) -> String {
    // A channel that is absorbed at once has no finite coefficient.
    let [r, g, b] = absorption.to_array().map(|sigma| sigma.min(1e30));
    format!(
        "{name}: glass with an \"absorption\" that contains an object, or is in a medium: some light is not absorbed; give the shape a medium in \
         place of the absorption: \"medium\": {{\"type\": \"homogeneous\", \"absorption\": [{r}, {g}, {b}]}}"
    )
}

/// Whether a ray into a body meets something before the inner side of the body, or the boundary of a medium. A body may be of several shapes
/// whose glass absorbs alike. A ray that meets nothing, or the outer side of its shape, is told of by `open_glass`.
fn is_stopped(world: &World, from: &OnShape, absorption: Rgb) -> bool {
    let OnShape { hit: entered, point, mut numbers } = from.clone();
    let ray = scattered(&point, -1.0, &mut numbers);
    let Some(Met { hit, material, is_outside, .. }) = meet(world, &ray) else { return false };
    let is_its_end = are_of_one_shape(&hit, &entered) || (!is_outside && material.absorption() == Some(absorption));
    !is_its_end || world.interface(&Ray { t_max: hit.t, ..ray }).is_some()
}

/// Whether a medium is around the inner side of a surface.
fn is_in_medium(world: &World, OnShape { point, mut numbers, .. }: OnShape) -> bool {
    let within = scattered(&point, -1.0, &mut numbers).origin;
    world.media().is_some_and(|media| media.at(&world.bodies_around(within)).is_some())
}
