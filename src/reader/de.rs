//! serde deserialiser over the tree: reads any `Deserialize` type from a [`Cursor`].

use std::{slice, vec};

use serde::de::value::StrDeserializer;
use serde::de::{Deserialize, DeserializeSeed, Deserializer, EnumAccess, IntoDeserializer, MapAccess, SeqAccess, VariantAccess, Visitor};

use super::cursor::{Cursor, Segment};
use super::node::{Member, Node, Value};
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
        match self.value() {
            Some(Value::Null) => visitor.visit_unit(),
            Some(Value::Bool(b)) => visitor.visit_bool(*b),
            Some(Value::Number(_)) | None => visitor.visit_f64(self.real()?),
            Some(Value::String(text)) => visitor.visit_str(text),
            Some(Value::Array(_)) => self.deserialize_seq(visitor),
            Some(Value::Object(_)) => self.deserialize_map(visitor),
        }
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_bool(self.boolean()?)
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
        visitor.visit_str(self.text()?)
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_str(self.text()?)
    }

    /// No key of the format accepts `null`; an absent value is left out.
    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        if self.is_placeholder() { visitor.visit_none() } else { visitor.visit_some(self) }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_newtype_struct(self.content()?)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_seq(Items::new(self, None)?)
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_seq(Items::new(self, Some(len))?)
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
        visitor.visit_enum(Variant::new(self, form, names)?)
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_unit()
    }

    serde::forward_to_deserialize_any! { u128 char bytes byte_buf unit unit_struct tuple_struct identifier }
}

struct Items<'n> {
    cursor: Cursor<'n>,
    items: slice::Iter<'n, Node>,
    index: usize,
    /// Number of placeholders that are left, where there are no items.
    placeholders: usize,
}

impl<'n> Items<'n> {
    /// The items of an array, which has `len` of them if that is given.
    fn new(cursor: Cursor<'n>, len: Option<usize>) -> Result<Items<'n>, ReadError> {
        let items = match cursor.value() {
            None => {
                let (cursor, placeholders) = len.map_or(Ok((cursor, 0)), |len| cursor.content().map(|content| (content, len)))?;
                return Ok(Items { cursor, items: [].iter(), index: 0, placeholders });
            }
            Some(Value::Array(items)) if len.is_none_or(|len| len == items.len()) => items.iter(),
            Some(_) => return Err(cursor.expected(len.map_or("an array".into(), |len| format!("an array of {len}")))),
        };
        Ok(Items { cursor, items, index: 0, placeholders: 0 })
    }

    fn advance(&mut self) -> Option<(Segment<'n>, Cursor<'n>)> {
        let child = match self.items.next() {
            Some(node) => self.cursor.child(node),
            None => {
                self.placeholders = self.placeholders.checked_sub(1)?;
                self.cursor
            }
        };
        self.index += 1;
        Some((Segment::Index(self.index - 1), child))
    }
}

impl<'n> SeqAccess<'n> for Items<'n> {
    type Error = ReadError;

    fn next_element_seed<T: DeserializeSeed<'n>>(&mut self, seed: T) -> Result<Option<T::Value>, ReadError> {
        let Some((segment, child)) = self.advance() else { return Ok(None) };
        child.seed_at(segment, seed).map(Some)
    }

    /// A faulty element does not end the list.
    fn next_element<T: Deserialize<'n>>(&mut self) -> Result<Option<T>, ReadError> {
        let Some((segment, child)) = self.advance() else { return Ok(None) };
        child.read_at(segment).map(Some)
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.items.len() + self.placeholders)
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
    /// The members of an object. `known` are the keys that the type has; without it, any key is a member.
    fn new(cursor: Cursor<'n>, known: Option<&'static [&'static str]>) -> Result<Members<'n>, ReadError> {
        let (members, placeholder_keys) = match cursor.value() {
            Some(_) => (cursor.members(known)?, cursor.placeholder_keys()),
            None => (vec![], known.unwrap_or_default().to_vec()),
        };
        let cursor = if known.is_some() { cursor.content()? } else { cursor };
        Ok(Members { cursor, members: members.into_iter(), placeholder_keys: placeholder_keys.into_iter(), current: None })
    }

    fn next_name(&mut self) -> Option<&'n str> {
        self.current = self.members.next();
        self.current.map(|member| member.key.as_str()).or_else(|| self.placeholder_keys.next())
    }

    /// The value of the key that was last read, and its segment; that of a placeholder is never shown.
    fn current(&self) -> (Segment<'n>, Cursor<'n>) {
        match self.current {
            Some(member) => (Segment::Key(&member.key), self.cursor.child(&member.node)),
            None if self.cursor.is_placeholder() => (Segment::Key(""), self.cursor),
            None => (Segment::Key(""), self.cursor.placeholder()),
        }
    }
}

impl<'n> MapAccess<'n> for Members<'n> {
    type Error = ReadError;

    fn next_key_seed<K: DeserializeSeed<'n>>(&mut self, seed: K) -> Result<Option<K::Value>, ReadError> {
        match self.next_name() {
            Some(name) => seed.deserialize(key_deserializer(name)).map(Some),
            None => Ok(None),
        }
    }

    fn next_value_seed<T: DeserializeSeed<'n>>(&mut self, seed: T) -> Result<T::Value, ReadError> {
        let (segment, child) = self.current();
        child.seed_at(segment, seed)
    }

    /// A faulty value does not end the object.
    fn next_value<T: Deserialize<'n>>(&mut self) -> Result<T, ReadError> {
        let (segment, child) = self.current();
        child.read_at(segment)
    }

    fn next_entry<K: Deserialize<'n>, T: Deserialize<'n>>(&mut self) -> Result<Option<(K, T)>, ReadError> {
        match self.next_key()? {
            Some(key) => Ok(Some((key, self.next_value()?))),
            None => Ok(None),
        }
    }
}

/// A variant of an enum, and what its content is read from.
struct Variant<'n> {
    name: &'static str,
    content: Cursor<'n>,
}

impl<'n> Variant<'n> {
    fn new(cursor: Cursor<'n>, form: &str, names: &'static [&'static str]) -> Result<Variant<'n>, ReadError> {
        let content = cursor.content()?;
        if cursor.is_placeholder() {
            let name = names.first().copied().ok_or(ReadError::Reported)?;
            return Ok(Variant { name, content });
        }
        match form {
            "by kind" => Ok(Variant { name: cursor.kind_among(names)?, content }),
            "by type" => {
                Ok(Variant { name: cursor.type_among(names)?, content: Cursor { tagged: cursor.node.child("type").is_some(), ..content } })
            }
            _ => Ok(Variant { name: cursor.name_among("name", names)?, content }),
        }
    }
}

/// Kinds of values that [`by_kind!`](macro@super::by_kind) distinguishes, with their names in messages.
const KINDS: [(&str, &str); 5] =
    [("boolean", "true or false"), ("number", "a number"), ("string", "a string"), ("array", "an array"), ("object", "an object")];

impl<'n> Cursor<'n> {
    /// The variant of an enum whose variants are named after kinds of JSON values.
    fn kind_among(self, names: &[&'static str]) -> Result<&'static str, ReadError> {
        let kind = self.node.kind();
        let words = || KINDS.iter().filter(|(kind, _)| names.contains(kind)).map(|(_, words)| *words).collect::<Vec<_>>().join(" or ");
        names.iter().copied().find(|name| *name == kind).ok_or_else(|| self.expected(words()))
    }

    /// The variant of `{"type": "sphere", …}`; one named "" is an object without `type`.
    fn type_among(self, names: &[&'static str]) -> Result<&'static str, ReadError> {
        let named: Vec<&str> = names.iter().copied().filter(|name| !name.is_empty()).collect();
        if !matches!(self.node.value, Value::Object(_)) {
            return Err(self.expected("an object with a \"type\""));
        }
        match self.node.child("type") {
            Some(tag) => self.context.within(Segment::Key("type"), || self.child(tag).name_among("type", &named)),
            None if names.contains(&"") => Ok(""),
            None => Err(ReadError::Because(format!("missing key \"type\", expected {}", choice(&named)))),
        }
    }

    /// The one of `names` that this string is; otherwise a fault is reported.
    fn name_among(self, what: &str, names: &[&'static str]) -> Result<&'static str, ReadError> {
        let Value::String(text) = &self.node.value else {
            return Err(self.reported(self.expected(choice(names))));
        };
        let name = names.iter().copied().find(|name| name == text);
        name.ok_or_else(|| self.reported(ReadError::Because(unknown(what, text, names))))
    }
}

impl<'n> EnumAccess<'n> for Variant<'n> {
    type Error = ReadError;
    type Variant = Cursor<'n>;

    fn variant_seed<T: DeserializeSeed<'n>>(self, seed: T) -> Result<(T::Value, Cursor<'n>), ReadError> {
        Ok((seed.deserialize(key_deserializer(self.name))?, self.content))
    }
}

impl<'n> VariantAccess<'n> for Cursor<'n> {
    type Error = ReadError;

    fn unit_variant(self) -> Result<(), ReadError> {
        match self.value() {
            None | Some(Value::String(_)) => Ok(()),
            Some(_) => self.members(Some(&[])).map(drop),
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
