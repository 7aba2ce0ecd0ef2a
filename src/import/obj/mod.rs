//! Wavefront OBJ with its library of materials (MTL). A camera and light are added.

mod library;
mod material;

use std::collections::BTreeMap;

use super::json_cursor::JsonCursor;
use super::model;
use super::view::Up;
use super::{Content, Dialect, ImportContext};
use crate::error::{Error, Fault, Result};
use crate::reader::{Location, Node, Value};
use crate::shape::MeshData;
use crate::shape::mesh_data::MeshPart;
use library::Entry;

/// Dialect `obj`.
pub const DIALECT: Dialect = Dialect { name: "obj", about: "Wavefront OBJ with its MTL: a model by itself", is, read };

/// Statements that an OBJ may begin with.
const KEYWORDS: &[&str] = &["v", "vn", "vt", "vp", "f", "l", "p", "o", "g", "s", "mtllib", "usemtl"];

/// Number of bytes that are examined to recognise a file.
const LOOK: usize = 1 << 16;

/// Returns whether the first line that is not a comment is a statement of an OBJ.
fn is(content: &Content) -> bool {
    let start = &content.bytes[..content.bytes.len().min(LOOK)];
    let mut words = start.split(|&b| b == b'\n').filter_map(|line| {
        let line = line.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(line);
        line.split(u8::is_ascii_whitespace).find(|word| !word.is_empty())
    });
    words.find(|word| !word.starts_with(b"#")).is_some_and(|word| KEYWORDS.iter().any(|keyword| keyword.as_bytes() == word))
}

fn read(content: &Content, context: &ImportContext) -> Result<Option<Node>> {
    let whole = Node { value: Value::Object(vec![]), location: Location::Whole("".into()) };
    let at = JsonCursor::root(&whole, context);
    let name = model::file_name(content, context, "obj");
    let (mesh, _) = crate::describe::mesh::read(std::io::Cursor::new(&*content.bytes), context.file)?;
    let library = libraries(content, context)?;
    let used: BTreeMap<&str, &Entry> =
        parts_of(&mesh).into_iter().filter_map(|name| library.get_key_value(name)).map(|(k, e)| (&**k, e)).collect();
    let unknown: Vec<&str> = parts_of(&mesh).into_iter().filter(|name| !library.contains_key(*name)).collect();
    if !unknown.is_empty() {
        at.note(format!("materials that no library has, taken as matte, albedo 0.8: {}", quoted_list(&unknown)));
    }
    let lamps: Vec<&str> = used.iter().filter(|(_, entry)| entry.emits()).map(|(name, _)| *name).collect();
    let shapes = shapes(&at, &mesh, &name, &used, &lamps)?;
    let materials = used.iter().map(|(name, entry)| (*name, material::material(&at, name, entry))).collect();
    Ok(Some(model::scene(&at, model::bounds(&mesh, context, Up::Y), materials, shapes, !lamps.is_empty())))
}

/// Materials of all libraries that the file names; a missing library is noted.
fn libraries(content: &Content, context: &ImportContext) -> Result<BTreeMap<String, Entry>> {
    let text = String::from_utf8_lossy(&content.bytes);
    let mut entries = BTreeMap::new();
    for (i, line) in text.lines().enumerate() {
        let Some(files) = line.trim().strip_prefix("mtllib").filter(|rest| rest.starts_with(char::is_whitespace)) else { continue };
        let location = |message: String| Fault::new(message).in_file(context.file).at_line(i + 1);
        for file in file_names(files.trim(), context) {
            if let Some(why) = context.files.why_not(&file) {
                return Err(Error::invalid(location(why)));
            }
            match context.files.bytes(&file) {
                Ok(bytes) => entries.extend(library::read(&bytes, &file, context)?),
                Err(Error::Invalid(faults)) => {
                    let why = faults.first().map(|fault| fault.message.clone()).unwrap_or_default();
                    context.note(location(format!("material library {file}: {why}; its materials are left out")));
                }
                Err(other) => return Err(other),
            }
        }
    }
    Ok(entries)
}

/// Files of a statement: one whose name may contain spaces, or several separated by spaces.
fn file_names(files: &str, context: &ImportContext) -> Vec<String> {
    let is_one = !files.contains(char::is_whitespace) || (context.files.why_not(files).is_none() && context.files.bytes(files).is_ok());
    if is_one { vec![files.to_owned()] } else { files.split_whitespace().map(str::to_owned).collect() }
}

/// Names of the materials of the mesh's faces.
fn parts_of(mesh: &MeshData) -> Vec<&str> {
    let mut names: Vec<&str> = mesh.parts.iter().filter_map(|part| part.material.as_deref()).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// The file as it is if nothing in it emits; otherwise a mesh for each lamp, and one for all else.
fn shapes(at: &JsonCursor, mesh: &MeshData, name: &str, used: &BTreeMap<&str, &Entry>, lamps: &[&str]) -> Result<Vec<Node>> {
    let mesh_shape = |file: &str| vec![("type", at.make_text("mesh")), ("file", at.make_text(file))];
    let white = at.make_object([("type", at.make_text("diffuse")), ("albedo", at.make_number(model::DIFFUSE))]);
    let all = |file: &str| {
        let plain = used.keys().filter(|name| !lamps.contains(name)).map(|name| (*name, at.make_text(*name)));
        at.make_object([mesh_shape(file), vec![("material", white.clone()), ("materials", at.make_object(plain))]].concat())
    };
    if lamps.is_empty() {
        return Ok(vec![all(name)]);
    }
    let mut shapes = vec![];
    let is_lamp = |part: &MeshPart| part.material.as_deref().is_some_and(|name| lamps.contains(&name));
    if let Some(bytes) = obj_bytes(mesh, |part| !is_lamp(part))? {
        at.context().make("rest.obj", bytes);
        shapes.push(all("rest.obj"));
    }
    for (i, lamp) in lamps.iter().enumerate() {
        let Some(bytes) = obj_bytes(mesh, |part| part.material.as_deref() == Some(lamp))? else { continue };
        let file = format!("lamp-{i}.obj");
        at.context().make(&*file, bytes);
        let emission = [("radiance", at.make_numbers(used[lamp].emission)), ("two_sided", at.make_flag(true))];
        let more = vec![("name", at.make_text(*lamp)), ("material", at.make_text(*lamp)), ("emission", at.make_object(emission))];
        shapes.push(at.make_object([mesh_shape(&file), more].concat()));
    }
    Ok(shapes)
}

/// The wanted parts of a mesh as an OBJ file; `None` if there are none.
fn obj_bytes(mesh: &MeshData, wanted: impl Fn(&MeshPart) -> bool) -> Result<Option<Vec<u8>>> {
    let mut chosen = MeshData { triangles: vec![], parts: vec![], ..mesh.clone() };
    for part in mesh.parts.iter().filter(|part| wanted(part)) {
        let start = chosen.triangles.len() as u32;
        chosen.triangles.extend(&mesh.triangles[part.triangles.start as usize..part.triangles.end as usize]);
        chosen.parts.push(MeshPart { triangles: start..chosen.triangles.len() as u32, ..part.clone() });
    }
    let (chosen, _) = chosen.clean();
    let mut bytes = vec![];
    chosen.write_obj(&mut bytes).map_err(|e| Error::io("memory", e))?;
    Ok(if chosen.triangles.is_empty() { None } else { Some(bytes) })
}

fn quoted_list(names: &[&str]) -> String {
    const SHOWN: usize = 5;
    let more = names.len().saturating_sub(SHOWN);
    let shown: Vec<String> = names.iter().take(SHOWN).map(|name| format!("{name:?}")).collect();
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    shown.join(", ") + &rest
}
