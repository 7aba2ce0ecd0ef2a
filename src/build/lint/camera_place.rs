//! Warnings about cameras inside of glass or of solid things.

use glam::Vec2;

use super::Linted;
use super::rays::{bounds, has_light_within, surrounding};
use crate::bsdf::Passage;
use crate::scene::Scene as _;

/// The number of positions on the film whose rays are tested, along each axis.
const FILM: u32 = 3;

/// A warning about the camera, if all its rays start inside of one body of glass, or inside of one opaque shape with no light in it.
pub(super) fn warnings(linted: &Linted) -> Vec<String> {
    let world = linted.world;
    let film = |k: u32| Vec2::new((k % FILM) as f32 + 0.5, (k / FILM) as f32 + 0.5) / FILM as f32;
    let starts = (0..FILM * FILM).map(|k| world.camera().ray(film(k), 1.0, Vec2::splat(0.5), 0.0).origin);
    let mut all = starts.map(|start| surrounding(world, start));
    let Some(Some((shape, passage))) = all.next() else { return vec![] };
    if !all.all(|other| other == Some((shape, passage))) {
        return vec![];
    }
    match passage {
        Passage::Body => vec![format!(
            "camera: it is inside of {}: all is seen from within the glass, and refracted where it leaves; move the camera out, unless this \
             is meant",
            linted.name(shape)
        )],
        Passage::Blocked if !has_light_within(world, &bounds(world, shape)) => vec![format!(
            "camera: it is inside of {}, which is closed and opaque and has no light in it, so that the picture is black, but for what \
             small openings let in; move the camera out",
            linted.name(shape)
        )],
        _ => vec![],
    }
}
