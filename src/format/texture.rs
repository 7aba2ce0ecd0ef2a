//! Textures: colours that vary over a surface.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::color::{Color, Srgb};
use super::size::Size;
use super::transform::Transform;
use super::value::{Fraction, Octaves, Positive};
use crate::reader::{by_kind, by_type};

/// A colour that varies over a surface.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Texture {
    Constant(Constant),
    Checker(Checker),
    Image(Image),
    Noise(Noise),
    Marble(Marble),
    Mix(Mix),
    Product(Product),
    Threshold(Threshold),
    VertexColor(VertexColor),
}

by_type!(Texture {
    Constant(Constant),
    Checker(Checker),
    Image(Image),
    Noise(Noise),
    Marble(Marble),
    Mix(Mix),
    Product(Product),
    Threshold(Threshold),
    VertexColor(VertexColor),
});

impl Texture {
    /// The colours it is made of that may be textures themselves, with their keys.
    pub(crate) fn parts(&self) -> Vec<(&'static str, &Textured)> {
        match self {
            Texture::Constant(_) | Texture::Image(_) | Texture::VertexColor(_) => vec![],
            Texture::Checker(t) => vec![("even", &t.even), ("odd", &t.odd)],
            Texture::Noise(t) => vec![("low", &t.low), ("high", &t.high)],
            Texture::Marble(t) => vec![("base", &t.base), ("veins", &t.veins)],
            Texture::Mix(t) => vec![("a", &t.a), ("b", &t.b), ("share", &t.share)],
            Texture::Product(t) => vec![("a", &t.a), ("b", &t.b)],
            Texture::Threshold(t) => vec![("by", &t.by)],
        }
    }
}

impl Texture {
    /// The coordinates that it varies over, and how it is placed in them; `None` where there is no choice.
    pub(crate) fn space(&self) -> Option<(TextureSpace, &Transform)> {
        match self {
            Texture::Checker(t) => Some((t.on, &t.transform)),
            Texture::Noise(t) => Some((t.on, &t.transform)),
            Texture::Marble(t) => Some((t.on, &t.transform)),
            Texture::Constant(_) | Texture::Image(_) | Texture::VertexColor(_) => None,
            Texture::Mix(_) | Texture::Product(_) | Texture::Threshold(_) => None,
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
    /// Squares per unit of the texture coordinates, or cubes per metre; or as waves, `{"radians": r}`.
    #[serde(default = "one_cell")]
    pub scale: CheckerScale,
    #[serde(default)]
    pub on: TextureSpace,
    /// With `position`: places the cubes in the world, steps applied in listed order.
    #[serde(default, skip_serializing_if = "Transform::is_identity")]
    pub transform: Transform,
}

/// Cells per unit: one number, or as waves, `{"radians": r}`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum CheckerScale {
    Cells(Positive),
    Waves(CheckerWaves),
}

by_kind!(CheckerScale { Number => Cells(Positive), Object => Waves(CheckerWaves) });

/// A checker by the sign of sin(r x) sin(r y) sin(r z), `odd` where it is negative: its cells are π/r wide. A coordinate that is
/// exactly 0 counts as just above it, so that a floor at 0 has a pattern.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CheckerWaves {
    /// r, per unit of the coordinates.
    pub radians: Positive,
}

impl CheckerScale {
    /// Cells per unit. A sine changes its sign where its argument is a multiple of π.
    pub fn get(self) -> f64 {
        match self {
            CheckerScale::Cells(cells) => cells.get(),
            CheckerScale::Waves(waves) => waves.radians.get() / std::f64::consts::PI,
        }
    }
}

/// A picture: PNG, JPEG, WebP or OpenEXR, its lower left corner at the texture coordinates (0, 0), its upper right one at (1, 1).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Image {
    /// A path from the scene file's folder, in which it lies (see `--allow-outside`).
    pub file: String,
    /// What its numbers mean.
    #[serde(default)]
    pub encoding: Encoding,
    /// One channel of it, as a grey. Default: its colours.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
    /// What lies beyond it.
    #[serde(default)]
    pub wrap: Wrap,
    /// What lies between its pixels.
    #[serde(default)]
    pub filter: TextureFilter,
    /// How often the picture goes into one unit of the texture coordinates; `[u, v]` for each of them.
    #[serde(default = "once")]
    pub scale: Size,
}

/// From one colour to another by noise, which is the same at every scale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Noise {
    /// The colour where the noise is least.
    #[serde(default = "Textured::black")]
    pub low: Textured,
    /// The colour where it is greatest.
    #[serde(default = "Textured::white")]
    pub high: Textured,
    /// Lumps per unit of the coordinates.
    #[serde(default = "one")]
    pub scale: Positive,
    /// Each more is half as large and half as strong.
    #[serde(default = "six")]
    pub octaves: Octaves,
    /// What it varies over.
    #[serde(default = "in_position")]
    pub on: TextureSpace,
    /// With `position`: places it in the world, steps applied in listed order.
    #[serde(default, skip_serializing_if = "Transform::is_identity")]
    pub transform: Transform,
}

/// Stone: layers across z, stirred.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Marble {
    /// The colour of the stone.
    #[serde(default = "Textured::white")]
    pub base: Textured,
    /// The colour of its veins.
    #[serde(default = "Textured::black")]
    pub veins: Textured,
    /// Radians of the layers' sine per unit along z.
    #[serde(default = "one")]
    pub scale: Positive,
    /// How seven octaves of noise n stir the layers: 10 times their turbulence is added to the phase. Default: `sum_of_absolutes`.
    #[serde(default, skip_serializing_if = "Turbulence::is_default")]
    pub turbulence: Turbulence,
    /// What it varies over.
    #[serde(default = "in_position")]
    pub on: TextureSpace,
    /// With `position`: places it in the world, steps applied in listed order.
    #[serde(default, skip_serializing_if = "Transform::is_identity")]
    pub transform: Transform,
}

/// How octaves of noise make up a turbulence.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Turbulence {
    /// Perlin's: the sum of the absolute values of 2⁻ᵏ n(2ᵏ p), from 0 to 2.
    #[default]
    SumOfAbsolutes,
    /// That of *Ray Tracing: The Next Week*: the absolute value of the sum of 2⁻ᵏ n(2ᵏ p) / √2, which is smaller and often nearly 0.
    AbsoluteOfSum,
}

impl Turbulence {
    fn is_default(&self) -> bool {
        *self == Turbulence::default()
    }
}

/// Two textures, one shining through the other: (1 − share) · a + share · b.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Mix {
    /// What shows where `share` is 0.
    pub a: Textured,
    /// What shows where it is 1.
    pub b: Textured,
    /// Of `b`.
    pub share: Textured,
}

/// Two textures, multiplied: a texture made darker or given a tint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Product {
    /// The one factor.
    pub a: Textured,
    /// The other.
    pub b: Textured,
}

/// White where a texture is at least so bright, black elsewhere: of each channel by itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Threshold {
    /// The texture.
    pub by: Textured,
    /// How bright.
    #[serde(default = "half")]
    pub at: Fraction,
}

/// The colours of a mesh's vertices (glTF, PLY), interpolated over its triangles; white on what has none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VertexColor {
    /// One channel of it, as a grey. Default: its colours.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
}

fn half() -> Fraction {
    Fraction::known(0.5)
}

fn one() -> Positive {
    Positive::known(1.0)
}

fn one_cell() -> CheckerScale {
    CheckerScale::Cells(one())
}

fn once() -> Size {
    Size::Square(one())
}

fn six() -> Octaves {
    Octaves::known(6)
}

fn in_position() -> TextureSpace {
    TextureSpace::Position
}

/// The coordinates that a texture varies over.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum TextureSpace {
    /// The surface's texture coordinates: squares.
    #[default]
    Uv,
    /// The position in world space: cubes.
    Position,
}

/// What the numbers in a picture mean.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Encoding {
    /// `srgb` for PNG, JPEG and WebP, `linear` for OpenEXR.
    #[default]
    Auto,
    /// Encoded with the sRGB curve: photographs, colours.
    Srgb,
    /// Shares of light as they are: roughness, masks.
    Linear,
}

/// A channel of a picture, or of the colours of vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Channel {
    /// Red.
    R,
    /// Green.
    G,
    /// Blue.
    B,
    /// Opacity, never encoded; 1 where the picture has none.
    A,
}

/// What lies beyond a picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Wrap {
    /// The picture again.
    #[default]
    Repeat,
    /// Its mirror image.
    Mirror,
    /// Its border.
    Clamp,
}

/// What lies between the pixels of a picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum TextureFilter {
    /// The four nearest pixels, by distance.
    #[default]
    Bilinear,
    /// The nearest pixel.
    Nearest,
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

    pub(crate) fn white() -> Textured {
        Textured::gray(1.0)
    }

    pub(crate) fn black() -> Textured {
        Textured::gray(0.0)
    }
}

impl From<Fraction> for Textured {
    fn from(gray: Fraction) -> Textured {
        Textured::Color(Color::Gray(gray))
    }
}

impl From<String> for Textured {
    fn from(name: String) -> Textured {
        Textured::Named(name)
    }
}

impl From<Box<Texture>> for Textured {
    fn from(texture: Box<Texture>) -> Textured {
        Textured::Texture(texture)
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
            TexturedForm::Object(TextureOrSrgb::Image(texture)) => Textured::Texture(Box::new(Texture::Image(texture))),
            TexturedForm::Object(TextureOrSrgb::Noise(texture)) => Textured::Texture(Box::new(Texture::Noise(texture))),
            TexturedForm::Object(TextureOrSrgb::Marble(texture)) => Textured::Texture(Box::new(Texture::Marble(texture))),
            TexturedForm::Object(TextureOrSrgb::Mix(texture)) => Textured::Texture(Box::new(Texture::Mix(texture))),
            TexturedForm::Object(TextureOrSrgb::Product(texture)) => Textured::Texture(Box::new(Texture::Product(texture))),
            TexturedForm::Object(TextureOrSrgb::Threshold(texture)) => Textured::Texture(Box::new(Texture::Threshold(texture))),
            TexturedForm::Object(TextureOrSrgb::VertexColor(texture)) => Textured::Texture(Box::new(Texture::VertexColor(texture))),
        }
    }
}

/// The objects among the forms of [`Textured`].
enum TextureOrSrgb {
    Constant(Constant),
    Checker(Checker),
    Image(Image),
    Noise(Noise),
    Marble(Marble),
    Mix(Mix),
    Product(Product),
    Threshold(Threshold),
    VertexColor(VertexColor),
    Srgb(Srgb),
}

by_type!(TextureOrSrgb {
    Constant(Constant),
    Checker(Checker),
    Image(Image),
    Noise(Noise),
    Marble(Marble),
    Mix(Mix),
    Product(Product),
    Threshold(Threshold),
    VertexColor(VertexColor),
} or Srgb(Srgb));
