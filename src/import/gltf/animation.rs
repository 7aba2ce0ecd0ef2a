//! Animations: values of the nodes at a time.
//!
//! All animations of a file are played together. Before its first key and after its last, a value stays as it is there.
//!
//! Source: Khronos, *glTF 2.0 Specification* (2.0.1), §3.11 and appendix C.

use std::collections::BTreeMap;

use glam::{DQuat, DVec4};
use gltf::animation::{Interpolation, Property};

use super::document::Document;

/// Animated values of all nodes, by node and property.
#[derive(Default)]
pub struct Animations(BTreeMap<(usize, Animated), Track>);

/// A property of a node that animations change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Animated {
    /// Translation.
    Translation,
    /// Rotation, a quaternion.
    Rotation,
    /// Scale.
    Scale,
    /// Weights of morph targets.
    Weights,
}

/// A value over time: its keys.
struct Track {
    /// Times of the keys (s), increasing.
    times: Vec<f64>,
    /// Values of all keys. Cubic splines have three for each key: the tangent before it, the value, and the tangent after it.
    values: Vec<f64>,
    /// Number of components of a value.
    width: usize,
    interpolation: Interpolation,
}

impl Animations {
    /// The animations of a file; `None` with a fault noted.
    pub fn read(document: &Document) -> Option<Animations> {
        have_valid_indices(document)?;
        let mut tracks = BTreeMap::new();
        for animation in document.gltf.animations() {
            for channel in animation.channels() {
                let path = ["animations", &animation.index().to_string(), "channels", &channel.index().to_string()];
                let at = document.at(&path);
                let (target, sampler) = (channel.target(), channel.sampler());
                let animated = match target.property() {
                    Property::Translation => Animated::Translation,
                    Property::Rotation => Animated::Rotation,
                    Property::Scale => Animated::Scale,
                    Property::MorphTargetWeights => Animated::Weights,
                };
                let times: Vec<f64> = document.rows(&sampler.input())?.into_iter().map(|[time]: [f32; 1]| time.into()).collect();
                let values: Vec<f64> = match animated {
                    Animated::Rotation => wide(document.rows::<4>(&sampler.output())?),
                    Animated::Translation | Animated::Scale => wide(document.rows::<3>(&sampler.output())?),
                    Animated::Weights => wide(document.rows::<1>(&sampler.output())?),
                };
                let interpolation = sampler.interpolation();
                let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
                let width = match animated {
                    Animated::Rotation => 4,
                    Animated::Translation | Animated::Scale => 3,
                    Animated::Weights => values.len() / (per_key * times.len().max(1)),
                };
                if times.is_empty() || width == 0 || values.len() != times.len() * per_key * width {
                    at.fault(format!("{} times for {} numbers of an animation", times.len(), values.len()));
                    return None;
                }
                if !times.is_sorted_by(|a, b| a < b) || !times.iter().chain(&values).all(|x| x.is_finite()) {
                    at.fault("the times of an animation are finite and increase, and its values are finite");
                    return None;
                }
                let key = (target.node().index(), animated);
                if tracks.contains_key(&key) {
                    document.note(&at, "of several animations of the same property of a node the first is shown");
                    continue;
                }
                tracks.insert(key, Track { times, values, width, interpolation });
            }
        }
        Some(Animations(tracks))
    }

    /// Value of a property of a node at a time (s); `None` if nothing animates it.
    pub fn at(&self, node: usize, animated: Animated, time: f64) -> Option<Vec<f64>> {
        let track = self.0.get(&(node, animated))?;
        Some(if animated == Animated::Rotation { track.rotation(time) } else { track.value(time) })
    }

    /// Times between the ends of an interval at which a key is, in order.
    pub fn keys_within(&self, [open, close]: [f64; 2]) -> Vec<f64> {
        let mut keys: Vec<f64> = self.0.values().flat_map(|track| &track.times).copied().filter(|t| open < *t && *t < close).collect();
        keys.sort_by(f64::total_cmp);
        keys.dedup();
        keys
    }

    /// Times of the first and the last key (s); `None` if nothing is animated.
    pub fn span(&self) -> Option<[f64; 2]> {
        let ends = self.0.values().filter_map(|track| Some([*track.times.first()?, *track.times.last()?]));
        ends.reduce(|[first, last], [from, to]| [first.min(from), last.max(to)])
    }

    /// Whether nothing is animated.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl Track {
    /// Key before a time, and the share of the way to the next one.
    fn place(&self, time: f64) -> (usize, f64) {
        let after = self.times.partition_point(|key| *key <= time);
        match after {
            0 => (0, 0.0),
            _ if after == self.times.len() => (after - 1, 0.0),
            _ => (after - 1, (time - self.times[after - 1]) / (self.times[after] - self.times[after - 1])),
        }
    }

    fn row(&self, i: usize) -> &[f64] {
        &self.values[i * self.width..(i + 1) * self.width]
    }

    /// Value at a time, component by component.
    fn value(&self, time: f64) -> Vec<f64> {
        let (key, t) = self.place(time);
        let combined =
            |rows: &[(usize, f64)]| (0..self.width).map(|c| rows.iter().map(|(row, factor)| self.row(*row)[c] * factor).sum()).collect();
        match self.interpolation {
            Interpolation::CubicSpline if t == 0.0 => self.row(3 * key + 1).to_vec(),
            Interpolation::CubicSpline => {
                let span = self.times[key + 1] - self.times[key];
                let (t2, t3) = (t * t, t * t * t);
                combined(&[
                    (3 * key + 1, 2.0 * t3 - 3.0 * t2 + 1.0),
                    (3 * key + 2, span * (t3 - 2.0 * t2 + t)),
                    (3 * key + 4, -2.0 * t3 + 3.0 * t2),
                    (3 * key + 3, span * (t3 - t2)),
                ])
            }
            Interpolation::Linear if t > 0.0 => combined(&[(key, 1.0 - t), (key + 1, t)]),
            Interpolation::Linear | Interpolation::Step => self.row(key).to_vec(),
        }
    }

    /// Rotation at a time. Linear interpolation turns at an even speed by the shorter way.
    fn rotation(&self, time: f64) -> Vec<f64> {
        let (key, t) = self.place(time);
        if self.interpolation != Interpolation::Linear || t == 0.0 {
            return self.value(time);
        }
        let of = |i: usize| DVec4::from_slice(self.row(i)).try_normalize().map_or(DQuat::IDENTITY, DQuat::from_vec4);
        of(key).slerp(of(key + 1), t).to_array().to_vec()
    }
}

/// Checks the indices of nodes and samplers, which the crate's validation leaves out; `None` with a fault noted.
fn have_valid_indices(document: &Document) -> Option<()> {
    let json = document.gltf.as_json();
    for (a, animation) in json.animations.iter().enumerate() {
        for (c, channel) in animation.channels.iter().enumerate() {
            let at = |key: &str| document.at(&["animations", &a.to_string(), "channels", &c.to_string(), key]);
            if channel.target.node.value() >= json.nodes.len() {
                at("target").fault(format!("node {}, but there are {}", channel.target.node.value(), json.nodes.len()));
                return None;
            }
            if channel.sampler.value() >= animation.samplers.len() {
                at("sampler").fault(format!("sampler {}, but there are {}", channel.sampler.value(), animation.samplers.len()));
                return None;
            }
        }
        for (s, sampler) in animation.samplers.iter().enumerate() {
            if let Some(index) = [sampler.input, sampler.output].iter().map(|index| index.value()).find(|i| *i >= json.accessors.len()) {
                let at = document.at(&["animations", &a.to_string(), "samplers", &s.to_string()]);
                at.fault(format!("accessor {index}, but there are {}", json.accessors.len()));
                return None;
            }
        }
    }
    Some(())
}

fn wide<const N: usize>(rows: Vec<[f32; N]>) -> Vec<f64> {
    rows.into_iter().flatten().map(f64::from).collect()
}
