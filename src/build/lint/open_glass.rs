//! Warnings about glass that does not enclose a volume: open meshes, single sheets, inconsistent winding.

use super::rays::{Met, OnShape, are_of_one_shape, meet, onward, points_of, scattered};
use super::{Linted, first_few};
use crate::bsdf::{Material, Passage};
use crate::world::World;

/// The number of test paths into each shape, unless that makes more than `MOST_WAYS` in total. For a pane without rims that is two
/// hundred times as wide as thick, about twenty of them leave through the missing rims.
const WAYS: u32 = 2048;
/// The largest number of test paths in total.
const MOST_WAYS: u32 = 1 << 15;
/// The number of test paths that rounding at edges may lose.
pub(super) const LOST_BY_ROUNDING: u32 = 2;
/// The number of hits after which a test path is given up.
pub(super) const MOST_HITS: u32 = 64;

/// Warnings about glass shapes that light can enter and then be outside of without crossing their surface.
pub(super) fn warnings(linted: &Linted) -> Vec<String> {
    let (glass, ways) = bodies(linted.world);
    let lost = glass.into_iter().map(|shape| (shape, lost(linted.world, shape, ways)));
    let said = lost.filter(|&(_, lost)| lost > LOST_BY_ROUNDING).map(|(shape, lost)| sentence(linted.name(shape), lost, ways));
    first_few(said.collect(), "more shapes of such glass")
}

/// The shapes of which some part is glass, and the number of test paths into each.
pub(super) fn bodies(world: &World) -> (Vec<u32>, u32) {
    let shapes = world.shapes();
    let is_glass = |shape: &u32| world.materials(*shape).any(is_body) && shapes[*shape as usize].is_sampled();
    let glass: Vec<u32> = (0..shapes.len() as u32).filter(is_glass).collect();
    let ways = MOST_WAYS.checked_div(glass.len() as u32).map_or(0, |ways| ways.min(WAYS));
    (glass, ways)
}

/// Whether a material has another medium behind it.
pub(super) fn is_body(material: &Material) -> bool {
    material.passage() == Passage::Body
}

fn sentence(name: &str, lost: u32, ways: u32) -> String {
    let percent = (100.0 * f64::from(lost) / f64::from(ways)).max(1.0).round();
    format!(
        "{name}: open or inconsistently wound glass: {percent} % of the ways into it lead out past its surface, where light is off by the \
         square of the index; close it, all faces outwards, or make a single sheet \"thin_dielectric\""
    )
}

/// The number of test paths into a shape that end outside of it without having left it.
fn lost(world: &World, shape: u32, ways: u32) -> u32 {
    points_of(world, shape, ways, is_body).map(|from| is_lost(world, from)).filter(|is_lost| *is_lost).count() as u32
}

/// Whether a path into a body hits what cannot be inside of it: nothing at all, or the outer side of the same glass.
///
/// The path goes straight on through thin sheets and scatters at opaque surfaces. So water in a basin counts as a body, and a single
/// pane in a closed room does not. A path that hits the outer side of another glass is not lost: touching media share one face.
fn is_lost(world: &World, OnShape { hit: entered, point, mut numbers }: OnShape) -> bool {
    let glass = world.material(&entered);
    let mut ray = scattered(&point, -1.0, &mut numbers);
    for _ in 0..MOST_HITS {
        let Some(Met { hit, surface, passage, material, is_outside }) = meet(world, &ray) else { return true };
        ray = match passage {
            Passage::Body => return is_outside && are_of_one_shape(&hit, &entered) && std::ptr::eq(material, glass),
            Passage::Sheet => onward(&surface.point, ray.direction),
            Passage::Blocked => scattered(&surface.point, if is_outside { 1.0 } else { -1.0 }, &mut numbers),
        };
    }
    false
}
