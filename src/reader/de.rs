//! serde deserialiser over the tree: reads any `Deserialize` type from a [`Cursor`].

use std::{slice, vec};

use serde::de::value::StrDeserializer;
use serde::de::{Deserialize, DeserializeSeed, Deserializer, EnumAccess, IntoDeserializer, MapAccess, SeqAccess, VariantAccess, Visitor};

use super::cursor::{Cursor, Segment};
use super::node::{Member, Node, Value};
use super::placeholder::Placeholder;
use super::read_error::ReadError;
use super::suggest::{choice, unknown};

macro_rules! whole_numbers {
    ($($ask:ident $answer:ident $type:ty),+ $(,)?) => {
        $(fn $ask<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
            visitor.$answer(self.whole(<$type>::MIN, <$type>::MAX)?)
        })+
    };
}

impl<'de> Deserializer<'de> for Cursor<'de> {
    type Error = ReadError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        match &self.node.value {
            Value::Null => visitor.visit_unit(),
            Value::Bool(b) => visitor.visit_bool(*b),
            Value::Number(_) => visitor.visit_f64(self.real()?),
            Value::String(text) => visitor.visit_str(text),
            Value::Array(_) => self.deserialize_seq(visitor),
            Value::Object(_) => self.deserialize_map(visitor),
        }
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        match self.node.value {
            Value::Bool(b) => visitor.visit_bool(b),
            _ => Err(self.expected("true or false")),
        }
    }

    fn deserialize_f32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_f64(self.real()?)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_f64(self.real()?)
    }

    whole_numbers! {
        deserialize_u8 visit_u8 u8, deserialize_u16 visit_u16 u16, deserialize_u32 visit_u32 u32, deserialize_u64 visit_u64 u64,
        deserialize_i8 visit_i8 i8, deserialize_i16 visit_i16 i16, deserialize_i32 visit_i32 i32, deserialize_i64 visit_i64 i64,
        deserialize_i128 visit_i128 i128,
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        match &self.node.value {
            Value::String(text) => visitor.visit_str(text),
            _ => Err(self.expected("a string")),
        }
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        self.deserialize_str(visitor)
    }

    /// No key of the format accepts `null`; an absent value is left out.
    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        match &self.node.value {
            Value::Array(items) => visitor.visit_seq(Items { cursor: self, items: items.iter(), index: 0 }),
            _ => Err(self.expected("an array")),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, ReadError> {
        match &self.node.value {
            Value::Array(items) if items.len() == len => self.deserialize_seq(visitor),
            _ => Err(self.expected(format_args!("an array of {len}"))),
        }
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_map(Members::new(self, None)?)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        keys: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        visitor.visit_map(Members::new(self, Some(keys))?)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        form: &'static str,
        names: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        match form {
            "by kind" => self.variant_by_kind(names, visitor),
            "by type" => self.variant_by_type(names, visitor),
            _ => self.variant_by_name(names, visitor),
        }
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_unit()
    }

    serde::forward_to_deserialize_any! { u128 char bytes byte_buf unit unit_struct tuple_struct identifier }
}

/// Kinds of values that [`by_kind!`](macro@super::by_kind) distinguishes, with their names in messages.
const KINDS: [(&str, &str); 5] =
    [("boolean", "true or false"), ("number", "a number"), ("string", "a string"), ("array", "an array"), ("object", "an object")];

impl<'n> Cursor<'n> {
    /// Reads an enum whose variants are named after kinds of JSON values.
    fn variant_by_kind<V: Visitor<'n>>(self, names: &[&str], visitor: V) -> Result<V::Value, ReadError> {
        let kind = self.node.kind();
        if names.contains(&kind) {
            return visitor.visit_enum(Variant { name: kind, content: self });
        }
        let words: Vec<&str> = KINDS.iter().filter(|(kind, _)| names.contains(kind)).map(|(_, words)| *words).collect();
        Err(self.expected(words.join(" or ")))
    }

    /// Reads `{"type": "sphere", …}`; a variant named "" is an object without `type`.
    fn variant_by_type<V: Visitor<'n>>(self, names: &[&str], visitor: V) -> Result<V::Value, ReadError> {
        let named: Vec<&str> = names.iter().copied().filter(|name| !name.is_empty()).collect();
        if !matches!(self.node.value, Value::Object(_)) {
            return Err(self.expected("an object with a \"type\""));
        }
        match self.node.child("type") {
            Some(tag) => {
                let tag = Cursor { node: tag, ..self };
                let name = self.context.within(Segment::Key("type"), || tag.known_name("type", &named))?;
                visitor.visit_enum(Variant { name, content: Cursor { tagged: true, ..self } })
            }
            None if names.contains(&"") => visitor.visit_enum(Variant { name: "", content: self }),
            None => Err(ReadError::Because(format!("missing key \"type\", expected {}", choice(&named)))),
        }
    }

    /// Reads a unit variant, such as `"linear"`.
    fn variant_by_name<V: Visitor<'n>>(self, names: &[&str], visitor: V) -> Result<V::Value, ReadError> {
        let name = self.known_name("name", names)?;
        visitor.visit_enum(Variant { name, content: self })
    }

    /// Returns the one of `names` that this string is, and reports a fault otherwise.
    fn known_name<'k>(self, what: &str, names: &[&'k str]) -> Result<&'k str, ReadError> {
        let Value::String(text) = &self.node.value else {
            return Err(self.reported(self.expected(choice(names))));
        };
        let name = names.iter().copied().find(|name| name == text);
        name.ok_or_else(|| self.reported(ReadError::Because(unknown(what, text, names))))
    }
}

struct Items<'n> {
    cursor: Cursor<'n>,
    items: slice::Iter<'n, Node>,
    index: usize,
}

impl<'n> Items<'n> {
    fn advance(&mut self) -> Option<(Segment<'n>, &'n Node)> {
        let node = self.items.next()?;
        self.index += 1;
        Some((Segment::Index(self.index - 1), node))
    }
}

impl<'n> SeqAccess<'n> for Items<'n> {
    type Error = ReadError;

    fn next_element_seed<T: DeserializeSeed<'n>>(&mut self, seed: T) -> Result<Option<T::Value>, ReadError> {
        let Some((segment, node)) = self.advance() else { return Ok(None) };
        self.cursor.seed_child(segment, node, seed).map(Some)
    }

    /// A faulty element does not end the list.
    fn next_element<T: Deserialize<'n>>(&mut self) -> Result<Option<T>, ReadError> {
        let Some((segment, node)) = self.advance() else { return Ok(None) };
        self.cursor.read_child(segment, node).map(Some)
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.items.len())
    }
}

struct Members<'n> {
    cursor: Cursor<'n>,
    members: vec::IntoIter<&'n Member>,
    /// Keys that placeholders replace, after the existing ones.
    placeholder_keys: vec::IntoIter<&'static str>,
    /// Member whose key was last read; `None` for a placeholder.
    current: Option<&'n Member>,
}

impl<'n> Members<'n> {
    fn new(cursor: Cursor<'n>, known: Option<&[&str]>) -> Result<Members<'n>, ReadError> {
        let members = cursor.members(known)?.into_iter();
        Ok(Members { cursor, members, placeholder_keys: cursor.placeholder_keys().into_iter(), current: None })
    }
}

impl<'n> MapAccess<'n> for Members<'n> {
    type Error = ReadError;

    fn next_key_seed<K: DeserializeSeed<'n>>(&mut self, seed: K) -> Result<Option<K::Value>, ReadError> {
        self.current = self.members.next();
        match self.current.map(|member| member.key.as_str()).or_else(|| self.placeholder_keys.next()) {
            Some(key) => seed.deserialize(key_deserializer(key)).map(Some),
            None => Ok(None),
        }
    }

    fn next_value_seed<T: DeserializeSeed<'n>>(&mut self, seed: T) -> Result<T::Value, ReadError> {
        match self.current {
            Some(member) => self.cursor.seed_child(Segment::Key(&member.key), &member.node, seed),
            None => seed.deserialize(Placeholder::NEW),
        }
    }

    /// A faulty value does not end the object.
    fn next_value<T: Deserialize<'n>>(&mut self) -> Result<T, ReadError> {
        match self.current {
            Some(member) => self.cursor.read_child(Segment::Key(&member.key), &member.node),
            None => T::deserialize(Placeholder::NEW),
        }
    }

    fn next_entry<K: Deserialize<'n>, T: Deserialize<'n>>(&mut self) -> Result<Option<(K, T)>, ReadError> {
        match self.next_key()? {
            Some(key) => Ok(Some((key, self.next_value()?))),
            None => Ok(None),
        }
    }
}

struct Variant<'n, 'k> {
    name: &'k str,
    content: Cursor<'n>,
}

impl<'n> EnumAccess<'n> for Variant<'n, '_> {
    type Error = ReadError;
    type Variant = Cursor<'n>;

    fn variant_seed<T: DeserializeSeed<'n>>(self, seed: T) -> Result<(T::Value, Cursor<'n>), ReadError> {
        Ok((seed.deserialize(key_deserializer(self.name))?, self.content))
    }
}

impl<'n> VariantAccess<'n> for Cursor<'n> {
    type Error = ReadError;

    fn unit_variant(self) -> Result<(), ReadError> {
        match self.node.value {
            Value::String(_) => Ok(()),
            _ => self.members(Some(&[])).map(drop),
        }
    }

    fn newtype_variant_seed<T: DeserializeSeed<'n>>(self, seed: T) -> Result<T::Value, ReadError> {
        seed.deserialize(self)
    }

    fn tuple_variant<V: Visitor<'n>>(self, len: usize, visitor: V) -> Result<V::Value, ReadError> {
        self.deserialize_tuple(len, visitor)
    }

    fn struct_variant<V: Visitor<'n>>(self, keys: &'static [&'static str], visitor: V) -> Result<V::Value, ReadError> {
        self.deserialize_struct("", keys, visitor)
    }
}

fn key_deserializer(key: &str) -> StrDeserializer<'_, ReadError> {
    key.into_deserializer()
}
