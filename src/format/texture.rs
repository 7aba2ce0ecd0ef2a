//! Descriptions of textures: colours that vary over a surface.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::color::{Color, Srgb};
use super::size::Size;
use super::transform::Transform;
use super::value::{Fraction, Octaves, Positive};
use crate::reader::{by_kind, by_type};

/// A colour that varies over a surface.
#[allow(missing_docs, reason = "a variant's meaning is that of its struct, whose text the schema takes")]
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
    /// Returns the parameters that may be textures themselves, with their keys.
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
    /// Returns the coordinates that the texture varies over and its transform in them; `None` for types without the key `on`.
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

/// One colour everywhere. Listed under `textures`, it gives the colour a name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Constant {
    /// The colour, with components from 0 to 1.
    pub color: Color<Fraction>,
}

/// A checkerboard: squares (or cubes) that alternate between two colours.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Checker {
    /// The colour of the square from 0 to 1 cell along each axis, and of every second one from there.
    #[serde(default = "Textured::white")]
    pub even: Textured,
    /// The colour of the other squares.
    #[serde(default = "Textured::black")]
    pub odd: Textured,
    /// Squares per unit of the texture coordinates, or cubes per metre. `{"radians": r}` gives it as the frequency of sines instead.
    #[serde(default = "one_cell")]
    pub scale: CheckerScale,
    #[serde(default)]
    /// The coordinates that the texture varies over.
    pub on: TextureSpace,
    /// Places the cubes in the world, for `position` only. Steps are applied in listed order.
    #[serde(default, skip_serializing_if = "Transform::is_identity")]
    pub transform: Transform,
}

/// Cells per unit of the coordinates: one number, or the frequency of sines, `{"radians": r}`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum CheckerScale {
    /// Cells per unit of the coordinates.
    Cells(Positive),
    /// The frequency of the sines whose signs make the cells.
    Waves(CheckerWaves),
}

by_kind!(CheckerScale { Number => Cells(Positive), Object => Waves(CheckerWaves) });

/// A checkerboard by the sign of sin(r x) sin(r y) sin(r z), with `odd` where it is negative. Its cells are π/r wide. A coordinate
/// of exactly 0 counts as slightly positive, so that a floor at 0 has a pattern.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CheckerWaves {
    /// The frequency r, in radians per unit of the coordinates.
    pub radians: Positive,
}

impl CheckerScale {
    /// Cells per unit of the coordinates. (A sine changes its sign at the multiples of π.)
    pub fn get(self) -> f64 {
        match self {
            CheckerScale::Cells(cells) => cells.get(),
            CheckerScale::Waves(waves) => waves.radians.get() / std::f64::consts::PI,
        }
    }
}

/// A picture: PNG, JPEG, WebP, OpenEXR or Radiance HDR. Its lower left corner is at the texture coordinates (0, 0), its upper right corner at (1, 1).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Image {
    /// The path, relative to the scene file's folder. The file must lie in that folder (see `--allow-outside`).
    pub file: String,
    /// How colours are encoded in the file.
    #[serde(default)]
    pub encoding: Encoding,
    /// A single channel of the picture, used as a grey. Default: the picture's colours.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
    /// How the picture continues beyond its borders.
    #[serde(default)]
    pub wrap: Wrap,
    /// How values between the centres of pixels are found.
    #[serde(default)]
    pub filter: TextureFilter,
    /// How often the picture repeats in one unit of the texture coordinates; `[u, v]` for each coordinate.
    #[serde(default = "once")]
    pub scale: Size,
}

/// Fractal noise that blends from one colour to another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Noise {
    /// The colour where the noise is least.
    #[serde(default = "Textured::black")]
    pub low: Textured,
    /// The colour where the noise is greatest.
    #[serde(default = "Textured::white")]
    pub high: Textured,
    /// The frequency of the first octave: noise cells per unit of the coordinates.
    #[serde(default = "one")]
    pub scale: Positive,
    /// The number of octaves. Each further octave has twice the frequency and half the amplitude.
    #[serde(default = "six")]
    pub octaves: Octaves,
    /// The coordinates that the noise varies over.
    #[serde(default = "in_position")]
    pub on: TextureSpace,
    /// Places the noise in the world, for `position` only. Steps are applied in listed order.
    #[serde(default, skip_serializing_if = "Transform::is_identity")]
    pub transform: Transform,
}

/// Marble: layers across the z axis, disturbed by turbulence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Marble {
    /// The colour of the stone.
    #[serde(default = "Textured::white")]
    pub base: Textured,
    /// The colour of the veins.
    #[serde(default = "Textured::black")]
    pub veins: Textured,
    /// The frequency of the layers' sine, in radians per unit along z.
    #[serde(default = "one")]
    pub scale: Positive,
    /// The turbulence made of seven octaves of noise n; 10 times its value is added to the phase of the sine. Default: `sum_of_absolutes`.
    #[serde(default, skip_serializing_if = "Turbulence::is_default")]
    pub turbulence: Turbulence,
    /// The coordinates that the marble varies over.
    #[serde(default = "in_position")]
    pub on: TextureSpace,
    /// Places the marble in the world, for `position` only. Steps are applied in listed order.
    #[serde(default, skip_serializing_if = "Transform::is_identity")]
    pub transform: Transform,
}

/// How octaves of noise are combined into a turbulence.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Turbulence {
    /// Perlin's turbulence: the sum of the absolute values of 2⁻ᵏ n(2ᵏ p), from 0 to 2.
    #[default]
    SumOfAbsolutes,
    /// The turbulence of *Ray Tracing: The Next Week*: the absolute value of the sum of 2⁻ᵏ n(2ᵏ p) / √2. It is smaller and often
    /// nearly 0.
    AbsoluteOfSum,
}

impl Turbulence {
    fn is_default(&self) -> bool {
        *self == Turbulence::default()
    }
}

/// A blend of two textures: (1 − share) · a + share · b.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Mix {
    /// The texture that shows where `share` is 0.
    pub a: Textured,
    /// The texture that shows where `share` is 1.
    pub b: Textured,
    /// The share of `b`, from 0 to 1.
    pub share: Textured,
}

/// The product of two textures: one texture darkened or tinted by another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Product {
    /// The first factor.
    pub a: Textured,
    /// The second factor.
    pub b: Textured,
}

/// White where a texture reaches a threshold, black elsewhere; red, green and blue are compared each by itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Threshold {
    /// The texture that is compared.
    pub by: Textured,
    /// The threshold: values of at least this become 1, lower ones 0.
    #[serde(default = "half")]
    pub at: Fraction,
}

/// The colours of a mesh's vertices (glTF, PLY), interpolated over its triangles. Shapes without such colours are white.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VertexColor {
    /// A single channel, used as a grey. Default: the colours.
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
    /// The surface's texture coordinates; a checkerboard has squares.
    #[default]
    Uv,
    /// The position in world space, in metres; a checkerboard has cubes.
    Position,
}

/// How the values of a picture are encoded.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Encoding {
    /// `srgb` for PNG, JPEG and WebP, `linear` for OpenEXR and Radiance HDR.
    #[default]
    Auto,
    /// Encoded with the sRGB curve, as photographs and colours are.
    Srgb,
    /// Linear values, such as roughness or masks.
    Linear,
}

impl Encoding {
    pub(crate) fn is_auto(&self) -> bool {
        *self == Encoding::Auto
    }
}

/// A channel of a picture or of vertex colours.
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
    /// Opacity, which is always linear; 1 where the picture has none.
    A,
}

/// How a picture continues beyond its borders.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum Wrap {
    /// The picture is repeated.
    #[default]
    Repeat,
    /// The picture is repeated, mirrored every second time.
    Mirror,
    /// The pixels of the border continue.
    Clamp,
}

/// How values between the centres of pixels are found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum TextureFilter {
    /// Bilinear interpolation of the four nearest pixels.
    #[default]
    Bilinear,
    /// The value of the nearest pixel.
    Nearest,
}

/// A reflected colour: a colour (components from 0 to 1), the name of a texture, or a texture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, from = "TexturedForm")]
#[schemars(!from)]
pub enum Textured {
    /// One colour everywhere, with components from 0 to 1.
    Color(Color<Fraction>),
    /// The name of a texture under `textures`.
    Named(String),
    /// A texture described in place.
    Texture(Box<Texture>),
}

impl Textured {
    /// A constant grey from 0 to 1.
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

/// The forms of [`Textured`] that are JSON objects.
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
