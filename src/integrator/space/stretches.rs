//! Rays from boundary to boundary of media.

use std::ops::ControlFlow;

use crate::math::Ray;
use crate::medium::{Inside, Media, Medium, MediumId};
use crate::scene::Scene;

/// Greatest number of boundaries of media on the way from one surface to the next. Media beyond them are left out.
const MOST_BOUNDARIES: u32 = 1 << 16;

/// Stretch of a ray within one medium, or within none.
#[derive(Clone)]
pub struct Stretch<'s> {
    pub medium: Option<(MediumId, &'s Medium)>,
    /// Length of the way from the point that the ray leaves to the start of the stretch (m).
    pub start: f32,
    /// Length of the stretch (m).
    pub length: f32,
    /// Bodies around it.
    pub inside: Inside,
}

/// Calls `visit` for each stretch of a ray between boundaries of media, until it breaks.
///
/// - `inside`: bodies around the start of the ray; afterwards those around its end
/// - `t_max`: end of the ray (m)
pub fn stretches<'s, T>(
    scene: &dyn Scene,
    media: &'s Media,
    inside: &mut Inside,
    ray: &Ray,
    t_max: f32,
    mut visit: impl FnMut(&Stretch<'s>) -> ControlFlow<T>,
) -> ControlFlow<T> {
    // `origin` is offset from `from`, the point that the ray leaves, to avoid self-intersection. Lengths count from `from`.
    let whole = (t_max + (ray.origin - ray.from).dot(ray.direction)).max(0.0);
    let (mut onward, mut start) = (Ray { t_max, ..*ray }, 0.0);
    for _ in 0..MOST_BOUNDARIES {
        let crossing = scene.interface(&onward);
        // Not the end minus the start of the stretch: far from the ray's start, that difference would lose precision.
        let rest = (whole - start).max(0.0);
        let length = crossing.as_ref().map_or(rest, |crossing| crossing.length.min(rest));
        visit(&Stretch { medium: media.at(inside), start, length, inside: *inside })?;
        let Some(crossing) = crossing else { return ControlFlow::Continue(()) };
        inside.cross(&crossing.boundaries, ray.direction);
        (onward, start) = (crossing.onward, start + length);
    }
    ControlFlow::Continue(())
}
