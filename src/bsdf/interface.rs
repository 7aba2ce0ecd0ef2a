//! The boundary of a medium, without a surface.

use glam::{DVec3, Vec2};

use super::description::{Description, Prepare};
use super::parameter::Lookup;
use super::{Bsdf, BsdfSample, HitContext, Lobe, Material, Passage, ScatteringModel, TexturedModel, TransportMode};
use crate::effects::Effects;
use crate::format::Textured;
use crate::math::{Density, Local, Spectrum};
use crate::texture::Texture;

/// A boundary between media of the same index of refraction. Light goes straight on.
///
/// f(wo, wi) = δ(wi + wo) / |cos θi|
///
/// Tests: own_models_are_proved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface;

impl ScatteringModel for Interface {
    fn sample(&self, wo: Local, _choice: f32, _u: Vec2, _mode: TransportMode) -> Option<BsdfSample> {
        Some(BsdfSample { wi: Local(-wo.0), weight: Spectrum::ONE, density: Density::Delta, lobe: Lobe::Transmission, eta: 1.0 })
    }

    fn delta_lobes(&self, wo: Local, mode: TransportMode) -> [Option<BsdfSample>; 2] {
        [self.sample(wo, 0.0, Vec2::ZERO, mode), None]
    }

    fn has_smooth_lobe(&self) -> bool {
        false
    }
}

/// The description in a scene file.
pub mod described {
    use schemars::JsonSchema;
    use serde::{Deserialize, Serialize};

    /// No surface: the boundary of a medium that light passes straight through, as if it were not there. It is the default for shapes with
    /// a `medium`.
    #[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub struct Interface {}
}

/// The model as materials contain it.
pub mod textured {
    /// The boundary of a medium.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Interface;
}

impl Description for described::Interface {
    fn textures(&self) -> Vec<(String, &Textured)> {
        vec![]
    }

    fn prepare(&self, _builder: &mut dyn Prepare) -> Material {
        textured::Interface.into()
    }
}

impl Lookup for textured::Interface {
    type Model = Bsdf<'static>;

    fn at(&self, _at: &HitContext) -> Bsdf<'static> {
        Bsdf::Interface(Interface)
    }

    fn textures(&self) -> Vec<&Texture> {
        vec![]
    }

    fn recentred(self, _origin: DVec3) -> textured::Interface {
        self
    }
}

impl TexturedModel for textured::Interface {
    fn effects(&self) -> Effects {
        Effects::MEDIA
    }

    fn passage(&self) -> Passage {
        Passage::Sheet
    }
}
