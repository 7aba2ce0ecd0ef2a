//! Placeholder values of any type, so that reading can go on after a fault.

use serde::de::value::StrDeserializer;
use serde::de::{DeserializeSeed, Deserializer, EnumAccess, IntoDeserializer, MapAccess, SeqAccess, VariantAccess, Visitor};

use super::read_error::ReadError;

/// Deserialiser that makes a value of any type: ½, 1, "", empty lists, the first variant.
///
/// ½ lies within the range of every number in the scene format. If no value can be made (for a type that refuses "" or contains
/// itself), the fault also ends the enclosing value.
#[derive(Clone, Copy)]
pub(super) struct Placeholder {
    depth: u32,
}

/// Largest depth of nested values. Types of the scene format are less deep unless they contain themselves.
const DEEPEST: u32 = 16;

impl Placeholder {
    pub(super) const NEW: Placeholder = Placeholder { depth: 0 };

    fn deeper(self) -> Result<Placeholder, ReadError> {
        if self.depth < DEEPEST { Ok(Placeholder { depth: self.depth + 1 }) } else { Err(ReadError::Reported) }
    }
}

macro_rules! give {
    ($($ask:ident $answer:ident $value:expr),+ $(,)?) => {
        $(fn $ask<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
            visitor.$answer($value)
        })+
    };
}

impl<'de> Deserializer<'de> for Placeholder {
    type Error = ReadError;

    give! {
        deserialize_any visit_f64 0.5, deserialize_f32 visit_f32 0.5, deserialize_f64 visit_f64 0.5,
        deserialize_u8 visit_u8 1, deserialize_u16 visit_u16 1, deserialize_u32 visit_u32 1, deserialize_u64 visit_u64 1,
        deserialize_i8 visit_i8 1, deserialize_i16 visit_i16 1, deserialize_i32 visit_i32 1, deserialize_i64 visit_i64 1,
        deserialize_i128 visit_i128 1, deserialize_u128 visit_u128 1,
        deserialize_bool visit_bool false, deserialize_str visit_str "", deserialize_string visit_str "",
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_unit()
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_none()
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_seq(Repeated { item: self, left: 0 })
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_seq(Repeated { item: self.deeper()?, left: len })
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_map(Fields { value: self, names: &[] })
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        names: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        visitor.visit_map(Fields { value: self.deeper()?, names })
    }

    fn deserialize_enum<V: Visitor<'de>>(self, _: &'static str, names: &'static [&'static str], visitor: V) -> Result<V::Value, ReadError> {
        let first = names.first().copied().ok_or(ReadError::Reported)?;
        visitor.visit_enum(First { name: first, content: self.deeper()? })
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_newtype_struct(self.deeper()?)
    }

    serde::forward_to_deserialize_any! { char bytes byte_buf unit unit_struct tuple_struct identifier }
}

struct Repeated {
    item: Placeholder,
    left: usize,
}

impl<'de> SeqAccess<'de> for Repeated {
    type Error = ReadError;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, ReadError> {
        match self.left.checked_sub(1) {
            Some(left) => {
                self.left = left;
                seed.deserialize(self.item).map(Some)
            }
            None => Ok(None),
        }
    }
}

struct Fields {
    value: Placeholder,
    names: &'static [&'static str],
}

impl<'de> MapAccess<'de> for Fields {
    type Error = ReadError;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, ReadError> {
        let Some((first, rest)) = self.names.split_first() else { return Ok(None) };
        self.names = rest;
        seed.deserialize(key(first)).map(Some)
    }

    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, ReadError> {
        seed.deserialize(self.value)
    }
}

struct First {
    name: &'static str,
    content: Placeholder,
}

impl<'de> EnumAccess<'de> for First {
    type Error = ReadError;
    type Variant = Placeholder;

    fn variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<(T::Value, Placeholder), ReadError> {
        Ok((seed.deserialize(key(self.name))?, self.content))
    }
}

impl<'de> VariantAccess<'de> for Placeholder {
    type Error = ReadError;

    fn unit_variant(self) -> Result<(), ReadError> {
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, ReadError> {
        seed.deserialize(self)
    }

    fn tuple_variant<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, ReadError> {
        self.deserialize_tuple(len, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(self, names: &'static [&'static str], visitor: V) -> Result<V::Value, ReadError> {
        self.deserialize_struct("", names, visitor)
    }
}

fn key(name: &str) -> StrDeserializer<'_, ReadError> {
    name.into_deserializer()
}
