//! Warnings about bodies of glass that overlap in part.

use std::collections::BTreeMap;

use super::open_glass::{LOST_BY_ROUNDING, MOST_HITS, bodies, is_body};
use super::rays::{Met, OnShape, are_of_one_shape, meet, onward, points_of, scattered};
use super::{Linted, first_few};
use crate::bsdf::Passage;
use crate::primitive::Hit;
use crate::world::World;

/// Warnings about bodies of glass of which one reaches out of the other. Each surface refracts by its own index, as if the other body
/// were not there: light that leaves one of them within the other is refracted as if it went into air.
///
/// A body that lies wholly within another is no mistake, nor are two that share a face.
pub(super) fn warnings(linted: &Linted) -> Vec<String> {
    let (glass, ways) = bodies(linted.world);
    let mut pairs = BTreeMap::<[u32; 2], u32>::new();
    for &shape in glass.iter().filter(|_| glass.len() > 1) {
        let others = points_of(linted.world, shape, ways, is_body).filter_map(|from| overlapped(linted.world, from));
        for other in others {
            *pairs.entry([shape.min(other), shape.max(other)]).or_insert(0) += 1;
        }
    }
    let said = pairs.into_iter().filter(|&(_, ways)| ways > LOST_BY_ROUNDING).map(|([a, b], _)| sentence(linted, a, b));
    first_few(said.collect(), "more such pairs")
}

fn sentence(linted: &Linted, a: u32, b: u32) -> String {
    format!(
        "{}: overlaps {}: in the common part light is refracted and absorbed as if only one of them were there; leave a gap \
         between them, put one wholly into the other, or make them one mesh",
        linted.name(a),
        linted.name(b)
    )
}

/// The shape that a straight ray into a body enters and has not left again where it leaves the body.
fn overlapped(world: &World, OnShape { hit: entered, point, mut numbers }: OnShape) -> Option<u32> {
    let mut ray = scattered(&point, -1.0, &mut numbers);
    let mut within: Option<Hit> = None;
    for _ in 0..MOST_HITS {
        let Met { hit, surface, passage, is_outside, .. } = meet(world, &ray)?;
        let is_same = are_of_one_shape(&hit, &entered);
        match (passage, within, is_outside) {
            (Passage::Sheet, ..) => {}
            (Passage::Body, None, true) if !is_same => within = Some(hit),
            (Passage::Body, Some(inner), false) if is_same => return Some(inner.shape),
            _ => return None,
        }
        ray = onward(&surface.point, ray.direction);
    }
    None
}
