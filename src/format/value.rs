//! Number types with a range, and points, vectors and directions.

use std::borrow::Cow;
use std::fmt;
use std::ops::Bound::{self, Excluded, Included, Unbounded};
use std::ops::RangeBounds;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::json;

/// The range of a number. The reader checks it, error messages name it and the schema states it.
#[derive(Debug, Clone, Copy)]
pub struct Range {
    /// The lower bound.
    pub low: Bound<f64>,
    /// The upper bound.
    pub high: Bound<f64>,
}

impl Range {
    /// Whether `x` is finite and within the bounds.
    pub fn contains(&self, x: f64) -> bool {
        x.is_finite() && (self.low, self.high).contains(&x)
    }

    /// Adds the bounds to a JSON schema.
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

/// A JSON number, without a decimal point where `x` is whole: `65536`, not `65536.0`.
fn number(x: f64) -> serde_json::Value {
    if x.fract() == 0.0 && x.abs() < 1e15 { json!(x as i64) } else { json!(x) }
}

/// Writes the range as a phrase: `above 0`, `from 0 to 1`, `above 0 and below 180`, `of at least 0`.
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

/// Defines number types with a range. Each line gives a type, its range check, its error message and its schema.
macro_rules! ranged {
    ($($(#[$doc:meta])* $name:ident: $repr:ident read as $wide:ident ($what:literal, $json:literal) in $low:expr, $high:expr;)+) => { $(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Serialize)]
        #[serde(transparent)]
        pub struct $name($repr);

        impl $name {
            /// The allowed values.
            pub const RANGE: Range = Range { low: $low, high: $high };

            /// The number `x`, or `None` if it lies outside [`Self::RANGE`].
            pub fn new(x: $repr) -> Option<$name> {
                Self::RANGE.contains(x as f64).then_some($name(x))
            }

            #[allow(dead_code, reason = "not every range has a default")]
            /// The number `x`, unchecked: for defaults, which are known to lie in range.
            pub(crate) const fn known(x: $repr) -> $name {
                $name(x)
            }

            /// The number as a primitive type.
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

/// The largest radiometric value: sums of its squares fit a 64-bit float, and its product with a few factors fits a 32-bit float.
const BRIGHTEST: f64 = 1e30;

ranged! {
    /// Any finite number.
    Real: f64 read as f64 ("a number", "number") in Unbounded, Unbounded;
    /// A length in metres, or a factor, above 0.
    Positive: f64 read as f64 ("a number", "number") in Excluded(0.0), Unbounded;
    /// A length in metres, or a factor, of 0 or more.
    NonNegative: f64 read as f64 ("a number", "number") in Included(0.0), Unbounded;
    /// A share from 0 to 1, for example of the reflected energy.
    Fraction: f64 read as f64 ("a number", "number") in Included(0.0), Included(1.0);
    /// A radiometric quantity of a light, from 0 to 1e30 in the unit of its key.
    Radiometric: f64 read as f64 ("a number", "number") in Included(0.0), Included(BRIGHTEST);
    /// An index of refraction. Real materials lie between 1 and 4, metals go down to 0.05.
    Index: f64 read as f64 ("an index of refraction", "number") in Included(0.01), Included(100.0);
    /// The index of refraction of a coat, at least 1, so that total internal reflection occurs only inside the coat.
    CoatIndex: f64 read as f64 ("an index of refraction", "number") in Included(1.0), Included(100.0);
    /// The thickness of a film in nanometres.
    FilmThickness: f64 read as f64 ("a thickness in nanometres", "number") in Included(0.0), Included(2000.0);
    /// The index of refraction of a film, from that of air to that of silicon.
    FilmIndex: f64 read as f64 ("an index of refraction", "number") in Included(1.0), Included(4.0);
    /// The exponent of a cosine lobe.
    Exponent: f64 read as f64 ("a number", "number") in Included(0.0), Included(1e8);
    /// The imaginary part of a metal's index of refraction.
    Extinction: f64 read as f64 ("an extinction coefficient", "number") in Included(0.0), Included(1000.0);
    /// The share of light that is lost on a unit of length, per metre.
    Coefficient: f64 read as f64 ("a number", "number") in Included(0.0), Included(BRIGHTEST);
    /// The mean cosine of the angle by which light is scattered.
    Asymmetry: f64 read as f64 ("a number", "number") in Included(-0.999), Included(0.999);
    /// The full angle of a view, in degrees.
    FieldOfView: f64 read as f64 ("an angle in degrees", "number") in Excluded(0.0), Excluded(180.0);
    /// The focal length of a lens over the diameter of its opening.
    FNumber: f64 read as f64 ("an f-number", "number") in Included(0.01), Included(1e6);
    /// The full angle of the view of a fisheye lens, in degrees.
    WideAngle: f64 read as f64 ("an angle in degrees", "number") in Excluded(0.0), Included(360.0);
    /// The angle by which the plane of focus is turned, in degrees.
    TiltAngle: f64 read as f64 ("an angle in degrees", "number") in Excluded(-90.0), Excluded(90.0);
    /// The half angle of a cone, in degrees.
    ConeAngle: f64 read as f64 ("an angle in degrees", "number") in Included(0.0), Included(180.0);
    /// Half the angle under which something flat is seen, in degrees.
    HalfAngle: f64 read as f64 ("an angle in degrees", "number") in Excluded(0.0), Excluded(90.0);
    /// The full angle under which a disk in the sky is seen, in degrees.
    DiskAngle: f64 read as f64 ("an angle in degrees", "number") in Included(0.0), Included(180.0);
    /// A part of a full turn, in degrees.
    Turn: f64 read as f64 ("an angle in degrees", "number") in Excluded(0.0), Included(360.0);
    /// The angle of the sun above the horizon, in degrees.
    Elevation: f64 read as f64 ("an angle in degrees", "number") in Included(-18.0), Included(90.0);
    /// A latitude on the earth, in degrees.
    Latitude: f64 read as f64 ("an angle in degrees", "number") in Included(-90.0), Included(90.0);
    /// A longitude on the earth, in degrees.
    Longitude: f64 read as f64 ("an angle in degrees", "number") in Included(-180.0), Included(180.0);
    /// The ratio of the extinction by air and aerosols to that by air alone.
    Turbidity: f64 read as f64 ("a number", "number") in Included(1.0), Included(10.0);
    /// The height of an observer above the ground, in metres.
    Altitude: f64 read as f64 ("a number", "number") in Included(0.0), Included(3000.0);
    /// A number of pixels along one side of an image.
    Side: u32 read as i128 ("a whole number", "integer") in Included(1.0), Included(65536.0);
    /// A number of samples in each pixel.
    SamplesPerPixel: u32 read as i128 ("a whole number", "integer") in Included(1.0), Included(u32::MAX as f64);
    /// A number of values along one side of a grid that is computed.
    Resolution: u32 read as i128 ("a whole number", "integer") in Included(1.0), Included(256.0);
    /// The number of octaves of noise that are summed.
    Octaves: u32 read as i128 ("a whole number", "integer") in Included(1.0), Included(16.0);
    /// A number of blades of an iris; 0 is a round opening.
    BladeCount: u32 read as i128 ("a whole number", "integer") in Included(0.0), Included(64.0);
    /// How often the triangles of a mesh are divided into four.
    SubdivisionLevels: u32 read as i128 ("a whole number", "integer") in Included(0.0), Included(10.0);
    /// The version of the scene format.
    Version: u32 read as i128 ("a version", "integer") in Included(1.0), Included(1.0);
}

impl Default for Real {
    /// 0.
    fn default() -> Real {
        Real::known(0.0)
    }
}

impl Default for BladeCount {
    /// A round opening.
    fn default() -> BladeCount {
        BladeCount::known(0)
    }
}

impl Default for SubdivisionLevels {
    /// The mesh as it is.
    fn default() -> SubdivisionLevels {
        SubdivisionLevels::known(0)
    }
}

impl SubdivisionLevels {
    /// Whether the mesh stays as it is.
    pub fn is_none(&self) -> bool {
        self.get() == 0
    }
}

impl Default for DiskAngle {
    /// No size.
    fn default() -> DiskAngle {
        DiskAngle::known(0.0)
    }
}

impl Turn {
    /// Whether it is all of a turn.
    pub fn is_full(&self) -> bool {
        self.get() == 360.0
    }
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
