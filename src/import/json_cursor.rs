//! Cursor over a JSON scene of another program. It reads values, and makes nodes of pt's own tree with their locations.

use super::context::ImportContext;
use crate::error::Fault;
use crate::reader::{Location, Member, Node, Value, escaped, locate, unknown};

/// A value with its pointer in the file.
#[derive(Clone)]
pub struct JsonCursor<'a> {
    node: &'a Node,
    /// JSON pointer of the value.
    pub pointer: String,
    context: &'a ImportContext<'a>,
}

/// Reading. Where the result is `None` although a value exists, the reason is noted as a fault.
impl<'a> JsonCursor<'a> {
    /// Cursor at the root of a scene.
    pub fn root(node: &'a Node, context: &'a ImportContext<'a>) -> JsonCursor<'a> {
        JsonCursor { node, pointer: String::new(), context }
    }

    /// Context of the import.
    pub fn context(&self) -> &'a ImportContext<'a> {
        self.context
    }

    /// Node of the value.
    pub fn node(&self) -> &'a Node {
        self.node
    }

    /// Value of an object's key; the first existing key of several spellings.
    pub fn get(&self, keys: &[&str]) -> Option<JsonCursor<'a>> {
        keys.iter().find_map(|key| self.child(key))
    }

    /// Value of a required key; messages use the first of several spellings.
    pub fn need(&self, keys: &[&str]) -> Option<JsonCursor<'a>> {
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

    /// Returns whether the value is an object with this key.
    pub fn has(&self, key: &str) -> bool {
        self.node.child(key).is_some()
    }

    fn child(&self, key: &str) -> Option<JsonCursor<'a>> {
        Some(JsonCursor { node: self.node.child(key)?, pointer: format!("{}{}", self.pointer, escaped(key)), context: self.context })
    }

    /// Reports keys of an object that are not among these, repeated keys, and a value that is not an object.
    pub fn only(&self, keys: &[&str]) {
        let Value::Object(members) = &self.node.value else { return self.expected("an object") };
        for (i, member) in members.iter().enumerate() {
            let pointer = format!("{}{}", self.pointer, escaped(&member.key));
            if !keys.contains(&member.key.as_str()) {
                self.context.faults.add(&member.key_location, pointer, unknown("key", &member.key, keys));
            } else if members[..i].iter().any(|before| before.key == member.key) {
                self.context.faults.add(&member.key_location, pointer, format!("repeated key {:?}", member.key));
            }
        }
    }

    /// Notes that keys of an object that are not among these are left out; repeated keys are faults.
    pub fn leave_out_others(&self, keys: &[&str]) {
        let Value::Object(members) = &self.node.value else { return self.expected("an object") };
        for (i, member) in members.iter().enumerate() {
            let pointer = format!("{}{}", self.pointer, escaped(&member.key));
            if members[..i].iter().any(|before| before.key == member.key) {
                self.context.faults.add(&member.key_location, pointer, format!("repeated key {:?}", member.key));
            } else if !keys.contains(&member.key.as_str()) {
                let message = format!("left out: {}", unknown("key", &member.key, keys));
                let placed = locate(self.node, self.context.file, "", message);
                let location = if let Location::Text { line, column } = member.key_location {
                    placed.at(line as usize, column as usize)
                } else {
                    placed
                };
                self.context.note(location.pointing(pointer));
            }
        }
    }

    /// Keys and values of an object.
    pub fn members(&self) -> Option<Vec<(&'a str, JsonCursor<'a>)>> {
        match &self.node.value {
            Value::Object(members) => Some(members.iter().filter_map(|m| Some((m.key.as_str(), self.child(&m.key)?))).collect()),
            _ => self.expects("an object"),
        }
    }

    /// Elements of an array.
    pub fn items(&self) -> Option<Vec<JsonCursor<'a>>> {
        match &self.node.value {
            Value::Array(items) => Some((0..items.len()).filter_map(|i| self.child(&i.to_string())).collect()),
            _ => self.expects("an array"),
        }
    }

    /// Finite number.
    pub fn number(&self) -> Option<f64> {
        match &self.node.value {
            Value::Number(text) => text.parse().ok().filter(|x: &f64| x.is_finite()).or_else(|| self.expects("a finite number")),
            _ => self.expects("a number"),
        }
    }

    /// Whole number that is not negative.
    pub fn whole(&self) -> Option<u64> {
        let number = self.number()?;
        let is_whole = number >= 0.0 && number.fract() == 0.0 && number < 9e15;
        if is_whole { Some(number as u64) } else { self.expects("a whole number, 0 or more") }
    }

    /// String.
    pub fn text(&self) -> Option<&'a str> {
        self.node.as_str().or_else(|| self.expects("a string"))
    }

    /// Boolean.
    pub fn flag(&self) -> Option<bool> {
        match self.node.value {
            Value::Bool(flag) => Some(flag),
            _ => self.expects("true or false"),
        }
    }

    /// Returns whether the value is a string.
    pub fn is_text(&self) -> bool {
        matches!(self.node.value, Value::String(_))
    }

    /// Returns whether the value is a number.
    pub fn is_number(&self) -> bool {
        matches!(self.node.value, Value::Number(_))
    }

    /// Returns whether the value is an array.
    pub fn is_array(&self) -> bool {
        matches!(self.node.value, Value::Array(_))
    }

    /// Returns whether the value is an object.
    pub fn is_object(&self) -> bool {
        matches!(self.node.value, Value::Object(_))
    }

    fn expects<T>(&self, what: &str) -> Option<T> {
        self.expected(what);
        None
    }

    /// Reports that another value was expected here.
    pub fn expected(&self, what: &str) {
        self.fault(format!("expected {what}, found {}", self.node.found()));
    }

    /// Reports a fault of this value.
    pub fn fault(&self, message: impl Into<String>) {
        self.context.faults.add(&self.node.location, self.pointer.clone(), message);
    }

    /// Notes that something is left out or done in another way.
    pub fn note(&self, message: impl Into<String>) {
        self.context.note(self.fault_here(message));
    }

    /// Sentence about this value, with its location.
    fn fault_here(&self, message: impl Into<String>) -> Fault {
        let placed = locate(self.node, self.context.file, "", message);
        placed.pointing(self.pointer.clone())
    }
}

/// Making nodes of pt's own tree, which get the location of this value.
impl JsonCursor<'_> {
    fn location(&self) -> Location {
        imported_location(&self.node.location, &self.pointer)
    }

    fn made(&self, value: Value) -> Node {
        Node { value, location: self.location() }
    }

    /// Copy of the value; all its parts keep their locations.
    pub fn same(&self) -> Node {
        let value = match &self.node.value {
            Value::Array(_) => Value::Array(self.items().unwrap_or_default().iter().map(JsonCursor::same).collect()),
            Value::Object(_) => {
                let members = self.members().unwrap_or_default();
                Value::Object(members.into_iter().map(|(key, value)| self.member(key, value.same())).collect())
            }
            scalar => scalar.clone(),
        };
        self.made(value)
    }

    /// String node.
    pub fn make_text(&self, text: impl Into<String>) -> Node {
        self.made(Value::String(text.into()))
    }

    /// Number node with the shortest decimal that reads back as the same number; whole ones have no point.
    pub fn make_number(&self, number: f64) -> Node {
        let text = format!("{number:?}");
        let whole = text.strip_suffix(".0").filter(|whole| *whole != "-0").map(str::to_owned);
        self.made(Value::Number(whole.unwrap_or(text).into()))
    }

    /// Node of a whole number.
    pub fn make_whole(&self, number: u64) -> Node {
        self.made(Value::Number(number.to_string().into()))
    }

    /// Boolean node.
    pub fn make_flag(&self, flag: bool) -> Node {
        self.made(Value::Bool(flag))
    }

    /// Array of numbers.
    pub fn make_numbers(&self, numbers: impl IntoIterator<Item = f64>) -> Node {
        self.make_array(numbers.into_iter().map(|number| self.make_number(number)))
    }

    /// Array of nodes.
    pub fn make_array(&self, items: impl IntoIterator<Item = Node>) -> Node {
        self.made(Value::Array(items.into_iter().collect()))
    }

    /// Object with these members.
    pub fn make_object<K: Into<String>>(&self, members: impl IntoIterator<Item = (K, Node)>) -> Node {
        self.made(Value::Object(members.into_iter().map(|(key, node)| self.member(key, node)).collect()))
    }

    fn member(&self, key: impl Into<String>, node: Node) -> Member {
        Member { key: key.into(), key_location: self.location(), node }
    }
}

fn imported_location(location: &Location, pointer: &str) -> Location {
    match location {
        Location::Text { line, column } => Location::Imported { line: *line, column: *column, pointer: pointer.into() },
        other => other.clone(),
    }
}
