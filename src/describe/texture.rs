//! Textures: colours that vary over a surface.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::color::{Color, Srgb};
use super::value::{Fraction, Positive};
use crate::reader::by_type;

/// A colour that varies over a surface.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Texture {
    Constant(Constant),
    Checker(Checker),
}

by_type!(Texture { Constant(Constant), Checker(Checker) });

impl Texture {
    /// The colours it is made of that may be textures themselves, with their keys.
    pub(super) fn parts(&self) -> Vec<(&'static str, &Textured)> {
        match self {
            Texture::Constant(_) => vec![],
            Texture::Checker(checker) => vec![("even", &checker.even), ("odd", &checker.odd)],
        }
    }
}

/// The same colour everywhere; gives a colour a name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Constant {
    /// Components from 0 to 1.
    pub color: Color<Fraction>,
}

/// Squares (or cubes) of two colours.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Checker {
    /// The colour of the square at the origin, and of every other.
    #[serde(default = "Textured::white")]
    pub even: Textured,
    /// The colour of the others.
    #[serde(default = "Textured::black")]
    pub odd: Textured,
    /// Squares per unit of the texture coordinates, or cubes per metre.
    #[serde(default = "one")]
    pub scale: Positive,
    #[serde(default)]
    pub on: CheckerOn,
}

fn one() -> Positive {
    Positive::known(1.0)
}

/// What a checker divides into squares.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum CheckerOn {
    /// The surface's texture coordinates: squares.
    #[default]
    Uv,
    /// The position in world space: cubes.
    Position,
}

/// A reflected colour: a colour (components from 0 to 1), the name of a texture, or a texture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, from = "TexturedForm")]
#[schemars(!from)]
pub enum Textured {
    Color(Color<Fraction>),
    /// The name of a texture under `textures`.
    Named(String),
    Texture(Box<Texture>),
}

impl Textured {
    pub fn gray(value: f64) -> Textured {
        Textured::Color(Color::Gray(Fraction::known(value)))
    }

    pub(super) fn white() -> Textured {
        Textured::gray(1.0)
    }

    pub(super) fn black() -> Textured {
        Textured::gray(0.0)
    }
}

/// The forms of [`Textured`], by the kind of the JSON value.
#[derive(Deserialize)]
#[serde(rename = "by kind", rename_all = "snake_case")]
enum TexturedForm {
    Number(Fraction),
    Array([Fraction; 3]),
    String(String),
    Object(TextureOrSrgb),
}

impl From<TexturedForm> for Textured {
    fn from(form: TexturedForm) -> Textured {
        match form {
            TexturedForm::Number(gray) => Textured::Color(Color::Gray(gray)),
            TexturedForm::Array(rgb) => Textured::Color(Color::Rgb(rgb)),
            TexturedForm::String(name) => Textured::Named(name),
            TexturedForm::Object(TextureOrSrgb::Srgb(color)) => Textured::Color(Color::Srgb(color)),
            TexturedForm::Object(TextureOrSrgb::Constant(texture)) => Textured::Texture(Box::new(Texture::Constant(texture))),
            TexturedForm::Object(TextureOrSrgb::Checker(texture)) => Textured::Texture(Box::new(Texture::Checker(texture))),
        }
    }
}

/// The objects among the forms of [`Textured`].
enum TextureOrSrgb {
    Constant(Constant),
    Checker(Checker),
    Srgb(Srgb),
}

by_type!(TextureOrSrgb { Constant(Constant), Checker(Checker) } or Srgb(Srgb));
