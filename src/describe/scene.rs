//! Description of the scene: the scene file as a whole.

use std::collections::{BTreeMap, BTreeSet};

use schemars::JsonSchema;
use serde::de::IgnoredAny;
use serde::{Deserialize, Deserializer, Serialize};

use super::background::Background;
use super::camera::Camera;
use super::film::Film;
use super::light::Light;
use super::medium::{Medium, MediumRef};
use super::meter::Meter;
use super::sampler::Sampler;
use super::shape::{Instances, Shape};
use super::{Material, MaterialRef};
use crate::format::{Shutter, Texture, Transform, Version};
use crate::reader::Node;

/// A scene in pt's format.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// The version of this format.
    pub pt: Version,
    /// The camera.
    pub camera: Camera,
    /// When the shutter is open. Only what has keyframes depends on it.
    #[serde(default, skip_serializing_if = "Shutter::is_default")]
    pub shutter: Shutter,
    /// The image: its size, pixel filter and layers.
    #[serde(default)]
    pub film: Film,
    /// The number of samples, and how they are distributed.
    #[serde(default)]
    pub sampler: Sampler,
    /// The integrator: its `type` and its own options, as `pt list integrators` shows them.
    #[serde(default, skip_serializing_if = "Integrator::is_default")]
    pub integrator: Integrator,
    /// Materials by name. Materials that are made of others may be nested 8 deep.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub materials: BTreeMap<String, Material>,
    /// Textures by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub textures: BTreeMap<String, Texture>,
    /// Participating media by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub media: BTreeMap<String, Medium>,
    /// The medium around all shapes, which reaches to infinity. No light from infinitely far away passes it. Default: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub medium: Option<MediumRef>,
    /// The shapes of the scene.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shapes: Vec<Shape>,
    /// Groups of shapes by name. A group shows only where a shape of type `instances` places it. Groups may contain instances of others,
    /// nested 8 deep.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub groups: BTreeMap<String, Vec<Shape>>,
    /// Lights without a surface. Shapes emit light by their `emission`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lights: Vec<Light>,
    /// The light that comes along rays that hit nothing. Default: none, black.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub background: Option<Background>,
    /// Places where `pt meter` measures light. They do not change the picture.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub meters: Vec<Meter>,
}

impl Scene {
    /// The material that a reference names; `None` for an unknown name.
    pub(crate) fn material<'s>(&'s self, chosen: &'s MaterialRef) -> Option<&'s Material> {
        match chosen {
            MaterialRef::Inline(inline) => Some(inline),
            MaterialRef::Named(name) => self.materials.get(name),
        }
    }

    /// The medium that a reference names; `None` for an unknown name.
    pub(crate) fn medium<'s>(&'s self, chosen: &'s MediumRef) -> Option<&'s Medium> {
        match chosen {
            MediumRef::Inline(inline) => Some(inline),
            MediumRef::Named(name) => self.media.get(name),
        }
    }

    /// Whether anything has keyframes.
    pub(crate) fn has_keyframes(&self) -> bool {
        fn of(shapes: &[Shape]) -> bool {
            shapes.iter().any(|shape| {
                shape.has_keyframes()
                    || match shape {
                        Shape::Group(group) => of(&group.shapes),
                        Shape::Instances(instances) => instances.placements.iter().flatten().any(|p| p.transform.has_keyframes()),
                        _ => false,
                    }
            })
        }
        self.camera.placement().1.is_some_and(Transform::has_keyframes)
            || self.lights.iter().any(|light| light.transform().has_keyframes())
            || self.groups.values().chain([&self.shapes]).any(|shapes| of(shapes))
    }

    /// The names of the groups that the scene shows, each after those that it contains. There must be no circles.
    pub fn shown_groups(&self) -> Vec<&str> {
        let (mut shown, mut known) = (vec![], BTreeSet::new());
        self.add_groups(&self.shapes, &mut known, &mut shown);
        shown
    }

    /// Adds the groups that `shapes` show.
    ///
    /// - `known`: names of the groups that are in `shown`, or will be
    fn add_groups<'s>(&'s self, shapes: &'s [Shape], known: &mut BTreeSet<&'s str>, shown: &mut Vec<&'s str>) {
        for shape in shapes {
            match shape {
                Shape::Group(group) => self.add_groups(&group.shapes, known, shown),
                Shape::Instances(Instances { group, .. }) if known.insert(group) => {
                    self.groups.get(group).into_iter().for_each(|shapes| self.add_groups(shapes, known, shown));
                    shown.push(group);
                }
                _ => {}
            }
        }
    }
}

/// The integrator's part of the scene file as JSON. Only the integrator knows its options and reads them.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Integrator(pub Option<Node>);

impl Integrator {
    /// Whether the scene file has no integrator.
    pub fn is_default(&self) -> bool {
        self.0.is_none()
    }
}

/// Ignores the value: [`read`](super::read()) puts the node of the JSON tree here afterwards, because serde would lose its positions
/// in the file.
impl<'de> Deserialize<'de> for Integrator {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Integrator, D::Error> {
        IgnoredAny::deserialize(d).map(|_| Integrator(None))
    }
}

impl JsonSchema for Integrator {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Integrator".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "description": "How light transport is simulated. Further keys are options of the integrator that `type` names.",
            "type": "object",
            "properties": { "type": { "type": "string", "description": "The name of an integrator." } },
            "required": ["type"],
        })
    }
}
