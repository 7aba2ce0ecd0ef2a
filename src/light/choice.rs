//! Choice of a light for a point.

mod lanes;

use super::tree::{Importances, LightTree, Receiver, Sides};
use super::{InfiniteIrradiance, Light, LightBounds, LightSampleContext};
use crate::math::float::ONE_MINUS_EPSILON;

pub(crate) use self::lanes::{ChosenLanes, OneSidedLanes};

/// Chooses one of several lights in proportion to about the irradiance that each brings to a point if nothing is in its way.
///
/// Lights that are infinitely far away are compared with each other and with all other lights together, among which a [`LightTree`]
/// chooses.
pub(crate) struct Choice {
    /// The only light that can be chosen. No importance is computed for it.
    only: Option<u32>,
    infinite: Vec<Infinite>,
    tree: Option<LightTree>,
}

/// Light that is infinitely far away.
struct Infinite {
    light: u32,
    /// Irradiance, relative to the intensities in the tree [W·m⁻²].
    irradiance: InfiniteIrradiance,
}

/// Fraction of the choices that is divided equally between the infinite lights and all other lights together. What is in the way of
/// lights is not known, and rooms hide the sky.
const EQUAL_FRACTION: f32 = 0.25;

/// Importances of the infinite lights and of the tree for one point.
struct Parts {
    sum: f32,
    /// Number of parts with an importance above 0.
    count: f32,
    tree: Option<Importances>,
}

impl Choice {
    /// A choice among the lights that emit and can be sampled.
    ///
    /// - `bounds`: bounds of each light; `None` for those that are infinitely far away, cannot be sampled or do not emit
    pub(super) fn new(lights: &[Light], bounds: Vec<Option<LightBounds>>) -> Choice {
        let finite: Vec<(LightBounds, u32)> = (0..).zip(bounds).filter_map(|(light, bounds)| Some((bounds?, light))).collect();
        // Intensities and irradiances are compared as numbers: any unit will do, as long as it is a power of two.
        let unit = finite.iter().fold(0.0, |most: f64, (bounds, _)| most.max(bounds.intensity));
        let infinite = (0..).zip(lights).filter_map(|(light, each)| {
            let irradiance = each.infinite_irradiance().filter(|irradiance| irradiance.most() > 0.0)?;
            Some(Infinite { light, irradiance })
        });
        let infinite: Vec<Infinite> = infinite.collect();
        let unit = infinite.iter().fold(unit, |most, infinite| most.max(infinite.irradiance.most()));
        // Scaling all lights by a power of two then changes no bit.
        let scale = f64::from_bits(unit.to_bits() & 0x7ff0_0000_0000_0000).recip();
        let only = match (&finite[..], &infinite[..]) {
            ([(_, light)], []) | ([], [Infinite { light, .. }]) => Some(*light),
            _ => None,
        };
        let is_many = only.is_none() && !finite.is_empty();
        let infinite = infinite.into_iter().map(|each| Infinite { irradiance: each.irradiance.scaled(scale), ..each });
        Choice { only, infinite: infinite.collect(), tree: is_many.then(|| LightTree::new(finite, lights.len(), scale)) }
    }

    /// The only light that can be chosen, with the probability 1.
    pub fn only(&self) -> Option<u32> {
        self.only
    }

    /// Chooses a light, with its probability; `None` if no light reaches the point.
    ///
    /// - `choice`: uniform number in [0, 1)
    #[inline]
    pub fn sample(&self, cx: &LightSampleContext, choice: f32) -> Option<(u32, f32)> {
        if let Some(light) = self.only {
            return Some((light, 1.0));
        }
        let at = Receiver::new(cx);
        let parts = self.parts(&at);
        let (mut choice, mut last) = (choice, None);
        for infinite in &self.infinite {
            let share = parts.share(infinite.importance(&at));
            if share > 0.0 {
                last = Some((infinite.light, share));
                if choice < share {
                    return last;
                }
            }
            choice -= share;
        }
        match (&self.tree, parts.tree) {
            (Some(tree), Some(uppermost)) if uppermost.total() > 0.0 => {
                let share = parts.share(uppermost.total());
                let (light, probability) = tree.sample(&at, uppermost, (choice / share).clamp(0.0, ONE_MINUS_EPSILON));
                Some((light, share * probability))
            }
            // The rounded shares of the infinite lights may add up to less than 1.
            _ => last,
        }
    }

    /// Probability with which [`Choice::sample`] chooses a light for a point: the same bits.
    #[inline]
    pub fn probability(&self, cx: &LightSampleContext, light: u32) -> f32 {
        if let Some(only) = self.only {
            return if light == only { 1.0 } else { 0.0 };
        }
        let at = Receiver::new(cx);
        let parts = self.parts(&at);
        if let Some(infinite) = self.infinite.iter().find(|infinite| infinite.light == light) {
            return parts.share(infinite.importance(&at));
        }
        match (&self.tree, parts.tree) {
            (Some(tree), Some(uppermost)) if uppermost.total() > 0.0 => {
                parts.share(uppermost.total()) * tree.probability(&at, uppermost, light)
            }
            _ => 0.0,
        }
    }

    fn parts(&self, at: &Receiver) -> Parts {
        let tree = self.tree.as_ref().map(|tree| tree.importances(at));
        let mut parts = Parts { sum: 0.0, count: 0.0, tree };
        let importances = self.infinite.iter().map(|infinite| infinite.importance(at)).chain(tree.map(|tree| tree.total()));
        for importance in importances.filter(|importance| *importance > 0.0) {
            parts.sum += importance;
            parts.count += 1.0;
        }
        parts
    }
}

impl Parts {
    /// Probability of a part with the given importance.
    fn share(&self, importance: f32) -> f32 {
        match (importance > 0.0, self.count > 1.0) {
            (false, _) => 0.0,
            (true, false) => 1.0,
            (true, true) => (1.0 - EQUAL_FRACTION) * (importance / self.sum) + EQUAL_FRACTION / self.count,
        }
    }
}

impl Infinite {
    fn importance(&self, at: &Receiver) -> f32 {
        match &self.irradiance {
            InfiniteIrradiance::Equal(irradiance) => *irradiance as f32 * at.side_count(),
            // Raised by the sine of the half angle, the cosine is above 0 where any point of the disk is above the horizon.
            InfiniteIrradiance::Towards(direction, irradiance, sine) => {
                let cos = at.normal.dot(*direction);
                let cos = if at.sides == Sides::Both { cos.abs() } else { cos };
                *irradiance as f32 * at.cosine((cos + sine).min(1.0))
            }
            InfiniteIrradiance::Map(rotation, map) => match at.sides {
                Sides::NoSurface => map.mean() * at.side_count(),
                Sides::Both => map.at(*rotation * at.normal) + map.at(-(*rotation * at.normal)),
                Sides::One => map.at(*rotation * at.normal),
            },
        }
    }
}

impl InfiniteIrradiance {
    /// Irradiance of a plane that faces the light, or the mean over all planes [W·m⁻²].
    fn most(&self) -> f64 {
        match self {
            InfiniteIrradiance::Equal(irradiance) | InfiniteIrradiance::Towards(_, irradiance, _) => *irradiance,
            InfiniteIrradiance::Map(_, map) => map.mean().into(),
        }
    }

    /// This irradiance times a factor. Single precision must not round it to 0, or the light would never be chosen.
    fn scaled(self, factor: f64) -> InfiniteIrradiance {
        let scaled = |irradiance: f64| (irradiance * factor).max(f32::MIN_POSITIVE.into());
        match self {
            InfiniteIrradiance::Equal(irradiance) => InfiniteIrradiance::Equal(scaled(irradiance)),
            InfiniteIrradiance::Towards(direction, irradiance, sine) => InfiniteIrradiance::Towards(direction, scaled(irradiance), sine),
            InfiniteIrradiance::Map(rotation, map) => InfiniteIrradiance::Map(rotation, map.scaled(factor)),
        }
    }
}
