//! Colours, and other values that differ by colour channel, as scene files write them.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::value::Fraction;
use crate::math::float::{exp_f64, ln_f64};
use crate::reader::by_kind;

/// A colour: a linear grey, linear Rec. 709 red, green and blue, or an sRGB colour.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum Color<T> {
    /// A grey: one linear value for red, green and blue.
    Gray(T),
    /// Linear `[red, green, blue]`.
    Rgb([T; 3]),
    /// A colour encoded with the sRGB curve.
    Srgb(Srgb),
}

by_kind!(Color<T> { Number => Gray(T), Array => Rgb([T; 3]), Object => Srgb(Srgb) });

/// A colour as image editors show it, encoded with the sRGB curve: `{"srgb": "#ff8000"}`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Srgb {
    /// The encoded colour.
    pub srgb: Encoded,
}

/// `[red, green, blue]` from 0 to 1, or `"#rrggbb"`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum Encoded {
    /// Encoded red, green and blue, each from 0 to 1.
    Rgb([Fraction; 3]),
    /// Two hexadecimal digits for each of red, green and blue.
    Hex(Hex),
}

by_kind!(Encoded { Array => Rgb([Fraction; 3]), String => Hex(Hex) });

/// An encoded colour as the string `"#rrggbb"`, two hexadecimal digits for each of red, green and blue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hex(pub [u8; 3]);

/// A value for each of red, green and blue, or one for all.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum PerChannel<T> {
    /// One value for red, green and blue.
    Equal(T),
    /// The values for red, green and blue.
    Each([T; 3]),
}

by_kind!(PerChannel<T> { Number => Equal(T), Array => Each([T; 3]) });

impl Hex {
    /// Parses `"#rrggbb"`; returns `None` for any other text.
    pub(crate) fn parse(text: &str) -> Option<Hex> {
        let digits = text.strip_prefix('#').filter(|d| d.len() == 6 && d.bytes().all(|b| b.is_ascii_hexdigit()))?;
        let byte = |i: usize| u8::from_str_radix(&digits[2 * i..2 * i + 2], 16).ok();
        Some(Hex([byte(0)?, byte(1)?, byte(2)?]))
    }
}

impl<'de> Deserialize<'de> for Hex {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Hex, D::Error> {
        let text = String::deserialize(d)?;
        Hex::parse(&text).ok_or_else(|| D::Error::custom(format!("expected a colour such as \"#ff8000\", found the string {text:?}")))
    }
}

impl Serialize for Hex {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        let [r, g, b] = self.0;
        s.serialize_str(&format!("#{r:02x}{g:02x}{b:02x}"))
    }
}

impl JsonSchema for Hex {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Hex".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({ "type": "string", "pattern": "^#[0-9a-fA-F]{6}$" })
    }
}

impl<T: Copy + Into<f64>> Color<T> {
    /// Linear red, green and blue.
    pub fn linear(&self) -> [f64; 3] {
        match self {
            Color::Gray(value) => [(*value).into(); 3],
            Color::Rgb(rgb) => rgb.map(Into::into),
            Color::Srgb(Srgb { srgb: Encoded::Rgb(rgb) }) => rgb.map(|c| decoded(c.get())),
            Color::Srgb(Srgb { srgb: Encoded::Hex(Hex(bytes)) }) => bytes.map(|b| decoded(f64::from(b) / 255.0)),
        }
    }
}

impl<T: Copy + Into<f64>> PerChannel<T> {
    /// The values for red, green and blue.
    pub fn each(&self) -> [f64; 3] {
        match self {
            PerChannel::Equal(value) => [(*value).into(); 3],
            PerChannel::Each(values) => values.map(Into::into),
        }
    }
}

/// The inverse of the sRGB transfer function.
///
/// c ≤ 0.04045: c / 12.92; else ((c + 0.055) / 1.055)^2.4
///
/// It uses pt's own exp and ln, so that colours have the same bits on every platform. Their error is far below f32 precision.
///
/// Source: IEC 61966-2-1 (1999).
pub(crate) fn decoded(c: f64) -> f64 {
    if c <= 0.04045 { c / 12.92 } else { exp_f64(2.4 * ln_f64((c + 0.055) / 1.055)) }
}
