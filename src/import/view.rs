//! A value of a foreign JSON scene: asked by its readers, and copied into pt's own tree with its place.

use super::foreign::Foreign;
use crate::error::Fault;
use crate::reader::{Member, Node, Place, Value, escaped, locate, unknown};

/// A value, and what it is called in its file.
#[derive(Clone)]
pub struct View<'a> {
    node: &'a Node,
    /// JSON pointer.
    pub pointer: String,
    foreign: &'a Foreign<'a>,
}

/// Asking. Where an answer is `None` for any other reason than that nothing is there, the reason is noted as a fault.
impl<'a> View<'a> {
    /// The scene as a whole.
    pub fn root(node: &'a Node, foreign: &'a Foreign<'a>) -> View<'a> {
        View { node, pointer: String::new(), foreign }
    }

    pub fn foreign(&self) -> &'a Foreign<'a> {
        self.foreign
    }

    pub fn node(&self) -> &'a Node {
        self.node
    }

    /// The value of an object's key; the first key that is there of several spellings.
    pub fn get(&self, keys: &[&str]) -> Option<View<'a>> {
        keys.iter().find_map(|key| self.child(key))
    }

    /// The value of an object's key, which must be there; by the first of several spellings in messages.
    pub fn need(&self, keys: &[&str]) -> Option<View<'a>> {
        if !matches!(self.node.value, Value::Object(_)) {
            self.expected("an object");
            return None;
        }
        let found = self.get(keys);
        if found.is_none() {
            self.fault(format!("missing key {:?}", keys.first().copied().unwrap_or_default()));
        }
        found
    }

    /// Whether it is an object with this key.
    pub fn has(&self, key: &str) -> bool {
        self.node.child(key).is_some()
    }

    fn child(&self, key: &str) -> Option<View<'a>> {
        Some(View { node: self.node.child(key)?, pointer: format!("{}{}", self.pointer, escaped(key)), foreign: self.foreign })
    }

    /// Notes the keys of an object that are none of these, and those that are there twice; and whatever is no object.
    pub fn only(&self, keys: &[&str]) {
        let Value::Object(members) = &self.node.value else { return self.expected("an object") };
        for (i, member) in members.iter().enumerate() {
            let pointer = format!("{}{}", self.pointer, escaped(&member.key));
            if !keys.contains(&member.key.as_str()) {
                self.foreign.faults.add(&member.key_place, pointer, unknown("key", &member.key, keys));
            } else if members[..i].iter().any(|before| before.key == member.key) {
                self.foreign.faults.add(&member.key_place, pointer, format!("repeated key {:?}", member.key));
            }
        }
    }

    /// Notes that the keys of an object that are none of these are left out; those that are there twice are faults.
    pub fn leave_out_others(&self, keys: &[&str]) {
        let Value::Object(members) = &self.node.value else { return self.expected("an object") };
        for (i, member) in members.iter().enumerate() {
            let pointer = format!("{}{}", self.pointer, escaped(&member.key));
            if members[..i].iter().any(|before| before.key == member.key) {
                self.foreign.faults.add(&member.key_place, pointer, format!("repeated key {:?}", member.key));
            } else if !keys.contains(&member.key.as_str()) {
                let message = format!("left out: {}", unknown("key", &member.key, keys));
                let placed = locate(self.node, self.foreign.file, "", message);
                let place =
                    if let Place::Text { line, column } = member.key_place { placed.at(line as usize, column as usize) } else { placed };
                self.foreign.note(place.pointing(pointer));
            }
        }
    }

    /// An object's keys and values.
    pub fn members(&self) -> Option<Vec<(&'a str, View<'a>)>> {
        match &self.node.value {
            Value::Object(members) => Some(members.iter().filter_map(|m| Some((m.key.as_str(), self.child(&m.key)?))).collect()),
            _ => self.expects("an object"),
        }
    }

    /// An array's elements.
    pub fn items(&self) -> Option<Vec<View<'a>>> {
        match &self.node.value {
            Value::Array(items) => Some((0..items.len()).filter_map(|i| self.child(&i.to_string())).collect()),
            _ => self.expects("an array"),
        }
    }

    pub fn number(&self) -> Option<f64> {
        match &self.node.value {
            Value::Number(text) => text.parse().ok().filter(|x: &f64| x.is_finite()).or_else(|| self.expects("a finite number")),
            _ => self.expects("a number"),
        }
    }

    /// A whole number that is not negative.
    pub fn whole(&self) -> Option<u64> {
        let number = self.number()?;
        let is_whole = number >= 0.0 && number.fract() == 0.0 && number < 9e15;
        if is_whole { Some(number as u64) } else { self.expects("a whole number, 0 or more") }
    }

    pub fn text(&self) -> Option<&'a str> {
        self.node.as_str().or_else(|| self.expects("a string"))
    }

    pub fn flag(&self) -> Option<bool> {
        match self.node.value {
            Value::Bool(flag) => Some(flag),
            _ => self.expects("true or false"),
        }
    }

    pub fn is_text(&self) -> bool {
        matches!(self.node.value, Value::String(_))
    }

    pub fn is_number(&self) -> bool {
        matches!(self.node.value, Value::Number(_))
    }

    pub fn is_array(&self) -> bool {
        matches!(self.node.value, Value::Array(_))
    }

    pub fn is_object(&self) -> bool {
        matches!(self.node.value, Value::Object(_))
    }

    fn expects<T>(&self, what: &str) -> Option<T> {
        self.expected(what);
        None
    }

    /// Notes that something else was to be here.
    pub fn expected(&self, what: &str) {
        self.fault(format!("expected {what}, found {}", self.node.found()));
    }

    /// Notes what is wrong here.
    pub fn fault(&self, message: impl Into<String>) {
        self.foreign.faults.add(&self.node.place, self.pointer.clone(), message);
    }

    /// Notes what is left out or done in another way.
    pub fn note(&self, message: impl Into<String>) {
        self.foreign.note(self.told(message));
    }

    /// A sentence about this value, with its place.
    fn told(&self, message: impl Into<String>) -> Fault {
        let placed = locate(self.node, self.foreign.file, "", message);
        placed.pointing(self.pointer.clone())
    }
}

/// Making: nodes of pt's own tree that stand where this value stands.
impl View<'_> {
    fn place(&self) -> Place {
        foreign_place(&self.node.place, &self.pointer)
    }

    fn made(&self, value: Value) -> Node {
        Node { value, place: self.place() }
    }

    /// The value itself, all its parts with their places.
    pub fn same(&self) -> Node {
        let value = match &self.node.value {
            Value::Array(_) => Value::Array(self.items().unwrap_or_default().iter().map(View::same).collect()),
            Value::Object(_) => {
                let members = self.members().unwrap_or_default();
                Value::Object(members.into_iter().map(|(key, value)| self.member(key, value.same())).collect())
            }
            scalar => scalar.clone(),
        };
        self.made(value)
    }

    pub fn make_text(&self, text: impl Into<String>) -> Node {
        self.made(Value::String(text.into()))
    }

    /// The shortest decimal that reads back as the same number: whole ones without a point.
    pub fn make_number(&self, number: f64) -> Node {
        let text = format!("{number:?}");
        let whole = text.strip_suffix(".0").filter(|whole| *whole != "-0").map(str::to_owned);
        self.made(Value::Number(whole.unwrap_or(text).into()))
    }

    pub fn make_whole(&self, number: u64) -> Node {
        self.made(Value::Number(number.to_string().into()))
    }

    pub fn make_flag(&self, flag: bool) -> Node {
        self.made(Value::Bool(flag))
    }

    pub fn make_numbers(&self, numbers: impl IntoIterator<Item = f64>) -> Node {
        self.make_array(numbers.into_iter().map(|number| self.make_number(number)))
    }

    pub fn make_array(&self, items: impl IntoIterator<Item = Node>) -> Node {
        self.made(Value::Array(items.into_iter().collect()))
    }

    pub fn make_object<K: Into<String>>(&self, members: impl IntoIterator<Item = (K, Node)>) -> Node {
        self.made(Value::Object(members.into_iter().map(|(key, node)| self.member(key, node)).collect()))
    }

    fn member(&self, key: impl Into<String>, node: Node) -> Member {
        Member { key: key.into(), key_place: self.place(), node }
    }
}

fn foreign_place(place: &Place, pointer: &str) -> Place {
    match place {
        Place::Text { line, column } => Place::Foreign { line: *line, column: *column, pointer: pointer.into() },
        other => other.clone(),
    }
}
