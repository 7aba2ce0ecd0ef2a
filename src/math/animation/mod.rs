//! Transforms that change with time.
//!
//! Time is a fraction of the shutter interval: 0 where the shutter opens, 1 where it closes.

mod bounds;
mod keyframes;
mod polar;

use std::borrow::Cow;
use std::sync::Arc;

use glam::DVec3;

use super::Transform;

pub use keyframes::Keyframes;

/// Affine transform that may change with time.
#[derive(Clone, Debug, PartialEq)]
pub enum AnimatedTransform {
    /// A transform that is always the same.
    Still(Transform),
    /// A transform that changes.
    Moving(Arc<Motion>),
}

/// Fixed transform, followed by keyframes and another fixed transform, once or several times.
///
/// A wheel on a moving car has two sets of keyframes: its turning, and then the drive of the car.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    first: Transform,
    steps: Vec<(Keyframes, Transform)>,
}

impl From<Transform> for AnimatedTransform {
    fn from(still: Transform) -> AnimatedTransform {
        AnimatedTransform::Still(still)
    }
}

/// Keyframes that change nothing are a still transform.
impl From<Keyframes> for AnimatedTransform {
    fn from(keyframes: Keyframes) -> AnimatedTransform {
        match keyframes.constant() {
            Some(still) => AnimatedTransform::Still(still),
            None => {
                let steps = vec![(keyframes, Transform::IDENTITY)];
                AnimatedTransform::Moving(Arc::new(Motion { first: Transform::IDENTITY, steps }))
            }
        }
    }
}

impl AnimatedTransform {
    /// The transform at a time.
    #[inline]
    pub fn at(&self, time: f32) -> Cow<'_, Transform> {
        match self {
            AnimatedTransform::Still(still) => Cow::Borrowed(still),
            AnimatedTransform::Moving(motion) => Cow::Owned(motion.at(time.into())),
        }
    }

    /// Whether the transform changes.
    pub fn is_moving(&self) -> bool {
        matches!(self, AnimatedTransform::Moving(_))
    }

    /// Composition: this transform first, then `next`, both at the same time.
    pub fn then(&self, next: &AnimatedTransform) -> AnimatedTransform {
        match (self, next) {
            (AnimatedTransform::Still(first), AnimatedTransform::Still(next)) => AnimatedTransform::Still(first.then(next)),
            (AnimatedTransform::Still(first), AnimatedTransform::Moving(next)) => {
                AnimatedTransform::Moving(Arc::new(Motion { first: first.then(&next.first), steps: next.steps.clone() }))
            }
            (AnimatedTransform::Moving(first), next) => {
                let mut motion = (**first).clone();
                let (fixed, more) = match next {
                    AnimatedTransform::Still(next) => (next, &[][..]),
                    AnimatedTransform::Moving(next) => (&next.first, &next.steps[..]),
                };
                if let Some((_, last)) = motion.steps.last_mut() {
                    *last = last.then(fixed);
                }
                motion.steps.extend_from_slice(more);
                AnimatedTransform::Moving(Arc::new(motion))
            }
        }
    }

    /// Times of all keyframes and both ends of the exposure, in order.
    pub fn keyframe_times(&self) -> Vec<f64> {
        let own = match self {
            AnimatedTransform::Still(_) => &[][..],
            AnimatedTransform::Moving(motion) => &motion.steps,
        };
        let mut times: Vec<f64> = own.iter().flat_map(|(keyframes, _)| keyframes.times()).copied().chain([0.0, 1.0]).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// This transform, followed by a translation by a finite vector.
    pub fn shifted(&self, by: DVec3) -> AnimatedTransform {
        Transform::translate(by).map_or_else(|_| self.clone(), |shift| self.then(&shift.into()))
    }

    /// Bounding box of a transformed box over all times; an empty box (low > high) stays empty.
    pub fn bounds(&self, corners: [DVec3; 2]) -> [DVec3; 2] {
        match self {
            AnimatedTransform::Still(still) => still.bounds(corners),
            AnimatedTransform::Moving(motion) => motion.bounds(corners),
        }
    }
}

impl Motion {
    /// The transform at a time.
    pub fn at(&self, time: f64) -> Transform {
        self.steps.iter().fold(self.first, |transform, (keyframes, fixed)| transform.then(&keyframes.at(time)).then(fixed))
    }

    /// Bounding box of a transformed box over all times.
    ///
    /// It is tight for one set of keyframes. For several it is that of the boxes one after the other, and may be larger than need be.
    pub fn bounds(&self, corners: [DVec3; 2]) -> [DVec3; 2] {
        let step = |(bounds, before): ([DVec3; 2], &Transform), (keyframes, fixed)| {
            (bounds::moved(bounds, before, keyframes, fixed), &Transform::IDENTITY)
        };
        self.steps.iter().map(|(keyframes, fixed)| (keyframes, fixed)).fold((corners, &self.first), step).0
    }
}
