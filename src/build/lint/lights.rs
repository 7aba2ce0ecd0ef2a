//! Warnings about lights that light nothing: shut in by an opaque shape, or behind clear glass and mirrors.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};

use super::rays::{Met, bounds, emitted, is_within, meet, surrounding};
use super::{Linted, first_few};
use crate::bsdf::Passage;
use crate::effects::Effects;
use crate::math::Density;
use crate::scene::Scene as _;
use crate::world::World;

/// The least number of rays of a light for a warning about it: an opening of a twentieth of all directions is then missed by all of them
/// in 1 of 27 cases.
const ENOUGH: u32 = 64;

/// What the rays of one light meet first.
#[derive(Default)]
struct Reach {
    /// The number of rays.
    rays: u32,
    /// The number of rays that meet a surface of clear glass or a mirror.
    specular: u32,
    /// For each shape, the number of rays that meet its opaque inner side.
    inner: BTreeMap<u32, u32>,
    /// The start of one of the rays.
    start: Vec3,
    /// Whether the light is a point, which no path hits by chance.
    is_point: bool,
}

/// What the rays of each light meet first, by the index of the light.
fn reach(world: &World) -> BTreeMap<u32, Reach> {
    let mut all = BTreeMap::<u32, Reach>::new();
    for emitted in emitted(world) {
        let reach = all.entry(emitted.light).or_default();
        reach.start = emitted.ray.origin;
        reach.is_point = matches!(emitted.position, Density::Delta);
        reach.rays += 1;
        match meet(world, &emitted.ray) {
            None => {}
            Some(Met { material, .. }) if (material.effects() - Effects::SCATTERED) == material.effects() => reach.specular += 1,
            Some(Met { hit, surface, passage: Passage::Blocked, is_outside: false, .. })
                if hit.instance.is_none() && surface.emission.is_none() =>
            {
                *reach.inner.entry(hit.shape).or_insert(0) += 1;
            }
            Some(_) => {}
        }
    }
    all.retain(|_, reach| reach.rays >= ENOUGH);
    all
}

/// Warnings about lights all of whose rays meet the inner side of one opaque shape that surrounds them, and that the camera is not in.
pub(super) fn shut_in(linted: &Linted) -> Vec<String> {
    let world = linted.world;
    let eye = world.camera().ray(Vec2::splat(0.5), 1.0, Vec2::splat(0.5), 0.0).origin;
    let by_one = |reach: &Reach| {
        let (&shape, _) = reach.inner.iter().find(|(_, count)| **count == reach.rays)?;
        // A floor whose normal points down is met from its inner side too, but does not surround the light.
        (surrounding(world, reach.start)? == (shape, Passage::Blocked)).then_some(shape)
    };
    let shut_in = reach(world).into_iter().filter_map(|(light, reach)| Some((light, by_one(&reach)?)));
    let said = shut_in.filter(|&(_, shape)| !is_within(eye, &bounds(world, shape))).map(|(light, shape)| {
        format!(
            "{:?}: this light is inside of {}, which is closed and opaque, so that none of it gets out, but for small \
             openings; move one of the two",
            linted.light(light),
            linted.name(shape)
        )
    });
    first_few(said.collect(), "more lights that are shut in")
}

/// Warnings about point lights all of whose rays meet clear glass or mirrors first: no shadow ray gets past these, and no path from the
/// camera hits a point.
pub(super) fn behind_glass(linted: &Linted) -> Vec<String> {
    let is_hidden = |reach: &Reach| reach.is_point && reach.specular == reach.rays;
    let hidden = reach(linted.world).into_iter().filter(|(_, reach)| is_hidden(reach));
    let said = hidden.map(|(light, _)| {
        format!(
            "{:?}: all of this light meets clear glass or mirrors first, which shadow rays do not pass, and no path hits a point by chance: its \
             light is missing; make it a small sphere that emits, or use the integrator \"light\"",
            linted.light(light)
        )
    });
    first_few(said.collect(), "more such lights")
}
