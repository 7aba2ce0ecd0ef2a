//! Descriptions of the light that surfaces emit.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::format::{Color, Radiometric, Textured};

/// The emission of a surface: its radiance, or an object with further keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(from = "EmissionForm")]
pub struct Emission {
    /// Radiance, in W·m⁻²·sr⁻¹, the same in every direction.
    pub radiance: Color<Radiometric>,
    /// A texture that the radiance is multiplied by. Its pictures may have values above 1. Default: none, the emission is uniform.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub texture: Option<Textured>,
    /// Whether the back emits too. Otherwise only the side emits that the normal points to.
    pub two_sided: bool,
}

/// The forms of an [`Emission`], by the kind of the JSON value.
#[derive(Deserialize, JsonSchema)]
#[serde(rename = "by kind", rename_all = "snake_case")]
#[schemars(rename = "EmissionForm", untagged)]
enum EmissionForm {
    /// Radiance of the front, in W·m⁻²·sr⁻¹.
    Number(Radiometric),
    /// Radiance of the front, linear `[red, green, blue]`, in W·m⁻²·sr⁻¹.
    Array([Radiometric; 3]),
    Object(EmissionKeys),
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
struct EmissionKeys {
    /// Radiance, in W·m⁻²·sr⁻¹, the same in every direction.
    radiance: Color<Radiometric>,
    /// A texture that the radiance is multiplied by. Its pictures may have values above 1. Default: none, the emission is uniform.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    texture: Option<Textured>,
    /// Whether the back emits too. Otherwise only the side emits that the normal points to.
    #[serde(default)]
    two_sided: bool,
}

impl From<EmissionForm> for Emission {
    fn from(form: EmissionForm) -> Emission {
        let front = |radiance| Emission { radiance, texture: None, two_sided: false };
        match form {
            EmissionForm::Number(gray) => front(Color::Gray(gray)),
            EmissionForm::Array(rgb) => front(Color::Rgb(rgb)),
            EmissionForm::Object(EmissionKeys { radiance, texture, two_sided }) => Emission { radiance, texture, two_sided },
        }
    }
}
