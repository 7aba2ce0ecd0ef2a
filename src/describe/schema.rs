//! The scene format as JSON Schema, for editors and validators.

use schemars::Schema;
use schemars::generate::SchemaSettings;
use schemars::transform::{RecursiveTransform, Transform as _};
use serde_json::{Value, json};

use super::scene::Scene;
use crate::integrator::Entry;

/// Returns the JSON Schema (draft 2020-12) of a scene file that may name any integrator of `tables`.
pub fn schema(tables: &[&[Entry]]) -> Schema {
    let settings = SchemaSettings::draft2020_12().with_transform(RecursiveTransform(tidy));
    let mut schema = settings.into_generator().into_root_schema_for::<Scene>();
    let forms: Vec<Value> = tables.iter().copied().flatten().map(integrator).collect();
    if let Some(Value::Object(definitions)) = schema.get_mut("$defs") {
        let about = "How light transport is simulated.";
        definitions.insert("Integrator".into(), json!({ "description": about, "oneOf": forms }));
    }
    schema
}

/// The schema of an integrator's options, with its name as `type`.
fn integrator(entry: &Entry) -> Value {
    let mut form = (entry.schema)();
    RecursiveTransform(tidy).transform(&mut form);
    form.remove("$schema");
    form.remove("title");
    form.insert("type".into(), "object".into());
    form.insert("description".into(), entry.about.into());
    form.insert("required".into(), json!(["type"]));
    let properties = form.ensure_object().entry("properties").or_insert(json!({}));
    properties["type"] = json!({ "type": "string", "const": entry.name });
    form.to_value()
}

/// Returns the members of a family such as `Shape`: the value of `type`, and one line about each.
pub fn members(family: &str) -> Vec<(String, String)> {
    let schema = schema(&[]).to_value();
    let forms = schema["$defs"][family]["oneOf"].as_array().cloned().unwrap_or_default();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    forms.iter().map(|form| (text(&form["properties"]["type"]["const"]), first_line(&text(&form["description"])))).collect()
}

/// The first line of a text, up to the end of the last complete sentence in it.
fn first_line(text: &str) -> String {
    let line = text.lines().next().unwrap_or_default();
    let whole = if line.ends_with('.') { line } else { line.rsplit_once(". ").map_or(line, |(sentences, _)| &line[..=sentences.len()]) };
    whole.to_owned()
}

/// Makes a schema agree with the reader: optional keys are left out, never `null`, and numbers have ranges instead of machine formats.
fn tidy(schema: &mut Schema) {
    schema.remove("format");
    if let Some(Value::Array(types)) = schema.get_mut("type") {
        types.retain(|t| t != "null");
        if let [one] = &mut types[..] {
            let one = one.take();
            schema.insert("type".into(), one);
        }
    }
    if let Some(Value::Array(forms)) = schema.get_mut("anyOf") {
        forms.retain(|form| form["type"] != "null");
        if let [Value::Object(only)] = &mut forms[..] {
            let only = std::mem::take(only);
            schema.remove("anyOf");
            for (key, value) in only {
                // The description of a key takes precedence over that of its type.
                if key != "description" || schema.get("description").is_none() {
                    schema.insert(key, value);
                }
            }
        }
    }
}
