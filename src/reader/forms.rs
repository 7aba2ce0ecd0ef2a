//! Macros for two forms of enums that serde's own attributes could read only by buffering, and so without positions.
//!
//! Each macro derives a plain enum beside the public one. Its serde name, `by type` or `by kind`, tells the reader how the variant
//! is chosen. An enum of any other name is a string.

/// Reads `{"type": "sphere", …}` into the variant `Sphere(Sphere)`: `by_type!(Shape { Sphere(Sphere), Quad(Quad) })`.
///
/// The enum itself is serde's internally tagged one for writing and for the schema
/// (`#[serde(tag = "type", rename_all = "snake_case")]`).
/// `or Perspective(Perspective)` reads an object without `type`.
macro_rules! by_type {
    ($name:ident { $($variant:ident($content:ty)),+ $(,)? } $(or $default:ident($default_content:ty))?) => {
        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
                #[derive(serde::Deserialize)]
                #[serde(rename = "by type", rename_all = "snake_case")]
                enum Form {
                    $($variant($content),)+
                    $(#[serde(rename = "")] Untyped($default_content),)?
                }
                Ok(match Form::deserialize(d)? {
                    $(Form::$variant(form) => $name::$variant(form),)+
                    $(Form::Untyped(form) => $name::$default(form),)?
                })
            }
        }
        // A variant that is missing above does not compile.
        #[allow(unreachable_patterns)]
        const _: fn(&$name) = |form| match form {
            $($name::$variant(_) => (),)+
            $($name::$default(_) => (),)?
        };
    };
}

/// Reads a variant chosen by the kind of the JSON value: `by_kind!(Scale { Number => Uniform(f64), Array => PerAxis([f64; 3]) })`.
///
/// Kinds: `Boolean`, `Number`, `String`, `Array`, `Object`. The enum itself is serde's untagged one.
macro_rules! by_kind {
    ($name:ident $(<$param:ident>)? { $($kind:ident => $variant:ident($content:ty)),+ $(,)? }) => {
        impl<'de $(, $param: serde::Deserialize<'de>)?> serde::Deserialize<'de> for $name $(<$param>)? {
            fn deserialize<D: serde::Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
                #[derive(serde::Deserialize)]
                #[serde(rename = "by kind", rename_all = "snake_case")]
                enum Form $(<$param>)? {
                    $($kind($content),)+
                }
                let form: Form $(<$param>)? = Form::deserialize(d)?;
                Ok(match form {
                    $(Form::$kind(form) => $name::$variant(form.into()),)+
                })
            }
        }
    };
}

/// Schema of `by_type!(… or Variant(Variant))`: `type` may be left out for the first variant.
pub(crate) fn first_needs_no_type(schema: &mut schemars::Schema) {
    let first = schema.get_mut("oneOf").and_then(|forms| forms.get_mut(0));
    if let Some(serde_json::Value::Array(required)) = first.and_then(|form| form.get_mut("required")) {
        required.retain(|key| key != "type");
    }
}

pub(crate) use {by_kind, by_type};
