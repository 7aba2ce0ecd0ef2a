//! Numbers that carry their range, and the vectors made of them.

use std::borrow::Cow;
use std::fmt;
use std::ops::Bound::{self, Excluded, Included, Unbounded};
use std::ops::RangeBounds;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::json;

/// The range of a number: what reading checks, what a fault says, what the schema states.
#[derive(Debug, Clone, Copy)]
pub struct Range {
    pub low: Bound<f64>,
    pub high: Bound<f64>,
}

impl Range {
    /// NaN and infinity lie in no range.
    pub fn contains(&self, x: f64) -> bool {
        x.is_finite() && (self.low, self.high).contains(&x)
    }

    /// The range as JSON Schema says it.
    fn constrain(&self, schema: &mut Schema) {
        match self.low {
            Included(low) => drop(schema.insert("minimum".into(), number(low))),
            Excluded(low) => drop(schema.insert("exclusiveMinimum".into(), number(low))),
            Unbounded => {}
        }
        match self.high {
            Included(high) => drop(schema.insert("maximum".into(), number(high))),
            Excluded(high) => drop(schema.insert("exclusiveMaximum".into(), number(high))),
            Unbounded => {}
        }
    }
}

/// A whole number is written as one: `65536`, not `65536.0`.
fn number(x: f64) -> serde_json::Value {
    if x.fract() == 0.0 && x.abs() < 1e15 { json!(x as i64) } else { json!(x) }
}

/// `above 0`, `from 0 to 1`, `above 0 and below 180`, `of at least 0`.
impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let exact = |x: f64| if x.abs() < 1e15 { x.to_string() } else { format!("{x:e}") };
        match (self.low, self.high) {
            (Included(low), Included(high)) if low == high => write!(f, "equal to {}", exact(low)),
            (Included(low), Included(high)) => write!(f, "from {} to {}", exact(low), exact(high)),
            (Included(low), Unbounded) => write!(f, "of at least {}", exact(low)),
            (Included(low), Excluded(high)) => write!(f, "of at least {} and below {}", exact(low), exact(high)),
            (Excluded(low), Unbounded) => write!(f, "above {}", exact(low)),
            (Excluded(low), Included(high)) => write!(f, "above {} and at most {}", exact(low), exact(high)),
            (Excluded(low), Excluded(high)) => write!(f, "above {} and below {}", exact(low), exact(high)),
            (Unbounded, Included(high)) => write!(f, "of at most {}", exact(high)),
            (Unbounded, Excluded(high)) => write!(f, "below {}", exact(high)),
            (Unbounded, Unbounded) => f.write_str("of any size"),
        }
    }
}

/// A number with a range: one line for the type, its check, its fault and its schema.
macro_rules! ranged {
    ($($(#[$doc:meta])* $name:ident: $repr:ident read as $wide:ident ($what:literal, $json:literal) in $low:expr, $high:expr;)+) => { $(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Serialize)]
        #[serde(transparent)]
        pub struct $name($repr);

        impl $name {
            pub const RANGE: Range = Range { low: $low, high: $high };

            /// `None` if `x` lies outside [`Self::RANGE`].
            pub fn new(x: $repr) -> Option<$name> {
                Self::RANGE.contains(x as f64).then_some($name(x))
            }

            #[allow(dead_code, reason = "not every range has a default")]
            /// A value known to lie in range: our own defaults.
            pub(crate) const fn known(x: $repr) -> $name {
                $name(x)
            }

            pub const fn get(self) -> $repr {
                self.0
            }
        }

        impl From<$name> for $repr {
            fn from(x: $name) -> $repr {
                x.0
            }
        }

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(d: D) -> Result<$name, D::Error> {
                let x = $wide::deserialize(d)?;
                match $name::RANGE.contains(x as f64) {
                    true => Ok($name(x as $repr)),
                    false => Err(D::Error::custom(format!("expected {} {}, found {x}", $what, $name::RANGE))),
                }
            }
        }

        impl JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                let mut schema = schemars::json_schema!({ "type": $json });
                $name::RANGE.constrain(&mut schema);
                schema
            }
        }
    )+ };
}

/// Where sums of squares of radiance still fit a 64-bit float, and products of a few a 32-bit one.
const BRIGHTEST: f64 = 1e30;

ranged! {
    /// Any finite number.
    Real: f64 read as f64 ("a number", "number") in Unbounded, Unbounded;
    /// A length, or a factor, above 0.
    Positive: f64 read as f64 ("a number", "number") in Excluded(0.0), Unbounded;
    /// A length, or a factor, of 0 or more.
    NonNegative: f64 read as f64 ("a number", "number") in Included(0.0), Unbounded;
    /// A share: of reflected energy, of a range.
    Fraction: f64 read as f64 ("a number", "number") in Included(0.0), Included(1.0);
    /// A radiometric quantity of a light.
    Radiometric: f64 read as f64 ("a number", "number") in Included(0.0), Included(BRIGHTEST);
    /// An index of refraction. Real materials lie between 1 and 4, metals go down to 0.05.
    Index: f64 read as f64 ("an index of refraction", "number") in Included(0.01), Included(100.0);
    /// An index of refraction of a coat, which reflects totally from within only.
    CoatIndex: f64 read as f64 ("an index of refraction", "number") in Included(1.0), Included(100.0);
    /// The power of a cosine.
    Exponent: f64 read as f64 ("a number", "number") in Included(0.0), Included(1e8);
    /// The imaginary part of a metal's index of refraction.
    Extinction: f64 read as f64 ("an extinction coefficient", "number") in Included(0.0), Included(1000.0);
    /// The full angle of a view, in degrees.
    FieldOfView: f64 read as f64 ("an angle in degrees", "number") in Excluded(0.0), Excluded(180.0);
    /// The half angle of a cone, in degrees.
    ConeAngle: f64 read as f64 ("an angle in degrees", "number") in Included(0.0), Included(180.0);
    /// A number of pixels along one side of an image.
    Side: u32 read as i128 ("a whole number", "integer") in Included(1.0), Included(65536.0);
    /// A number of samples in each pixel.
    SamplesPerPixel: u32 read as i128 ("a whole number", "integer") in Included(1.0), Included(u32::MAX as f64);
    /// How many octaves of noise are added up.
    Octaves: u32 read as i128 ("a whole number", "integer") in Included(1.0), Included(16.0);
    /// The version of the scene format.
    Version: u32 read as i128 ("a version", "integer") in Included(1.0), Included(1.0);
}

/// A position, in metres: `[x, y, z]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(inline)]
pub struct Point(pub [f64; 3]);

/// A displacement, in metres: `[x, y, z]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(inline)]
pub struct Vector(pub [f64; 3]);

/// A direction `[x, y, z]` of any length except 0.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[schemars(inline)]
pub struct Direction(pub [f64; 3]);

impl<'de> Deserialize<'de> for Direction {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Direction, D::Error> {
        match <[f64; 3]>::deserialize(d)? {
            [0.0, 0.0, 0.0] => Err(D::Error::custom("expected a direction, found [0, 0, 0]")),
            xyz => Ok(Direction(xyz)),
        }
    }
}
