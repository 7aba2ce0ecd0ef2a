//! Generates the reference of the scene format from its schema: one table of keys for each object.

use std::collections::VecDeque;
use std::fmt::Write;
use std::ops::Bound::{Excluded, Included, Unbounded};

use serde_json::{Map, Value};

use super::schema::schema;
use crate::format::Range;
use crate::integrator::Entry;

type Object = Map<String, Value>;

/// Returns the reference of the scene format in Markdown: every key with its type, range, default and meaning.
///
/// - `tables`: the integrators whose options are listed
pub fn reference(tables: &[&[Entry]]) -> String {
    let schema = schema(tables);
    let root = schema.as_object().cloned().unwrap_or_default();
    let definitions = object(root.get("$defs"));
    let mut page = Page { definitions, text: String::new(), listed: vec![], waiting: VecDeque::new() };
    page.section("Scene", &root);
    while let Some(name) = page.waiting.pop_front() {
        let definition = object(page.definitions.get(&name));
        page.section(&name, &definition);
    }
    page.text
}

struct Page {
    definitions: Object,
    text: String,
    /// Names of the definitions that were referred to so far, written or waiting.
    listed: Vec<String>,
    waiting: VecDeque<String>,
}

impl Page {
    fn section(&mut self, name: &str, schema: &Object) {
        self.line(&format!("## {name}\n"));
        self.paragraph(schema);
        match ["oneOf", "anyOf"].iter().find_map(|key| schema.get(*key)?.as_array()) {
            Some(forms) => forms.iter().for_each(|form| self.form(name, &object(Some(form)))),
            None if schema.contains_key("properties") => self.table(schema),
            None => {
                let words = self.type_words(schema);
                self.line(&format!("{words}\n"));
            }
        }
    }

    /// Writes one of several forms of a value: a `type`, a key, or a kind of JSON value.
    fn form(&mut self, name: &str, form: &Object) {
        let tag = object(form.get("properties")).get("type").and_then(|t| t.get("const").cloned());
        match (tag, form.contains_key("properties")) {
            (Some(tag), _) => {
                let optional = if required(form).contains(&"type") { "" } else { " (or no type)" };
                self.line(&format!("### {name} of type {tag}{optional}\n"));
                self.paragraph(form);
                self.table(form);
            }
            (None, true) => {
                let title = match &required(form)[..] {
                    [only] if object(form.get("properties")).len() == 1 => format!("{name} `{only}`"),
                    _ => format!("{name} as an object"),
                };
                self.line(&format!("### {title}\n"));
                self.paragraph(form);
                self.table(form);
            }
            (None, false) => {
                let words = self.type_words(form);
                let meaning = description(form);
                let colon = if meaning.is_empty() { "" } else { ": " };
                self.line(&format!("- {words}{colon}{meaning}\n"));
            }
        }
    }

    fn table(&mut self, schema: &Object) {
        let required = required(schema);
        let mut properties: Vec<(String, Object)> = object(schema.get("properties"))
            .into_iter()
            .filter(|(_, p)| p.get("const").is_none())
            .map(|(k, p)| (k, object(Some(&p))))
            .collect();
        if properties.is_empty() {
            return self.line("No further keys.\n");
        }
        properties.sort_by_key(|(key, _)| !required.contains(&key.as_str()));
        self.line("| key | value | default | meaning |\n|---|---|---|---|");
        for (key, property) in properties {
            let default = match property.get("default") {
                Some(_) if self.has_own_defaults(&property) => "its defaults".into(),
                Some(value) => format!("`{}`", tidy_default(value)),
                None if required.contains(&key.as_str()) => "required".into(),
                None => "–".into(),
            };
            let words = self.type_words(&property);
            let meaning = description(&property);
            self.line(&format!("| `{key}` | {words} | {default} | {meaning} |"));
        }
        self.line("");
    }

    fn paragraph(&mut self, schema: &Object) {
        let text = description(schema);
        if !text.is_empty() {
            self.line(&format!("{text}\n"));
        }
    }

    fn line(&mut self, text: &str) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "{text}");
    }

    /// The type of a value as a phrase: `number above 0`, `3 numbers from 0 to 1`, `[Shape](#shape)`, …
    fn type_words(&mut self, schema: &Object) -> String {
        if let Some(name) = target(schema) {
            return self.link(name);
        }
        if let Some(value) = schema.get("const") {
            return format!("`{value}`");
        }
        if let Some(forms) = ["oneOf", "anyOf"].iter().find_map(|key| schema.get(*key)?.as_array()) {
            return self.choice(forms);
        }
        if let Some(values) = schema.get("enum").and_then(Value::as_array) {
            return values.iter().map(|value| format!("`{value}`")).collect::<Vec<_>>().join(", ");
        }
        let kind = schema.get("type").and_then(Value::as_str).unwrap_or("anything");
        match kind {
            "array" => self.array_words(schema),
            "object" if schema.contains_key("additionalProperties") && !schema.contains_key("properties") => {
                let values = object(schema.get("additionalProperties"));
                format!("object of names, each with {}", self.type_words(&values))
            }
            "number" => format!("number{}", range_words(schema)),
            "integer" => format!("whole number{}", range_words(schema)),
            "string" if schema.contains_key("pattern") => "string `\"#rrggbb\"`".into(),
            "boolean" => "`true` or `false`".into(),
            other => other.into(),
        }
    }

    fn choice(&mut self, forms: &[Value]) -> String {
        let mut words: Vec<String> = vec![];
        for form in forms {
            let form = object(Some(form));
            let meaning = if form.contains_key("const") { description(&form) } else { String::new() };
            let form = self.type_words(&form);
            words.push(if meaning.is_empty() { form } else { format!("{form} ({})", meaning.trim_end_matches('.')) });
        }
        words.join(", or ")
    }

    fn array_words(&mut self, schema: &Object) -> String {
        let items = object(schema.get("items"));
        let item = self.type_words(&items);
        match (schema.get("minItems"), schema.get("maxItems")) {
            (Some(min), Some(max)) if min == max => {
                // What is itself an array already has the plural.
                let several = if item.contains("numbers") { item } else { item.replacen("number", "numbers", 1) };
                format!("`[…]` of {min} {several}")
            }
            _ => format!("list of {item}"),
        }
    }

    /// Whether a property's value is described in a table of its own that shows the same defaults.
    fn has_own_defaults(&self, property: &Object) -> bool {
        target(property).and_then(|name| self.definitions.get(name)).is_some_and(|definition| definition.get("properties").is_some())
    }

    fn link(&mut self, name: &str) -> String {
        if !self.listed.iter().any(|listed| listed == name) {
            self.listed.push(name.into());
            self.waiting.push_back(name.into());
        }
        format!("[{name}](#{})", name.to_lowercase())
    }
}

/// The name of the definition that a schema refers to.
fn target(schema: &Object) -> Option<&str> {
    schema.get("$ref")?.as_str()?.strip_prefix("#/$defs/")
}

fn object(value: Option<&Value>) -> Object {
    value.and_then(Value::as_object).cloned().unwrap_or_default()
}

fn required(schema: &Object) -> Vec<&str> {
    schema.get("required").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str).collect()
}

/// The description of a schema, on one line.
fn description(schema: &Object) -> String {
    schema.get("description").and_then(Value::as_str).unwrap_or_default().replace("\n\n", "\n").replace('\n', " ")
}

/// A default value without needless decimals: `1`, not `1.0`.
fn tidy_default(value: &Value) -> String {
    value.to_string().replace(".0,", ",").replace(".0]", "]").replace(".0}", "}").trim_end_matches(".0").to_owned()
}

fn range_words(schema: &Object) -> String {
    let bound = |key: &str| schema.get(key).and_then(Value::as_f64);
    let range = Range {
        low: bound("minimum").map(Included).or(bound("exclusiveMinimum").map(Excluded)).unwrap_or(Unbounded),
        high: bound("maximum").map(Included).or(bound("exclusiveMaximum").map(Excluded)).unwrap_or(Unbounded),
    };
    match (range.low, range.high) {
        (Unbounded, Unbounded) => String::new(),
        _ => format!(" {range}"),
    }
}
