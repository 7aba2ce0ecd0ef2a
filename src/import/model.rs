//! Single models, one mesh without materials: PLY and STL. A camera and light are added. In an STL z is up, as in programs for 3D
//! printing.

use std::path::Path;

use super::auto_camera;
use super::json_cursor::JsonCursor;
use super::view::{ASPECT, AutoCamera, Bounds, MissingParts, Up};
use super::{Content, Dialect, ImportContext};
use crate::describe::mesh::{self, Format};
use crate::error::Result;
use crate::reader::{Location, Node, Value};
use crate::shape::MeshData;

/// Dialect `ply`.
pub const PLY: Dialect = Dialect {
    name: "ply",
    about: "PLY: a model by itself",
    is: |content| format(content) == Format::Ply,
    read: |content, context| read(content, context, "ply", Up::Y),
};

/// Dialect `stl`.
pub const STL: Dialect = Dialect {
    name: "stl",
    about: "STL, binary or ASCII: a model by itself",
    is: |content| format(content) == Format::Stl,
    read: |content, context| read(content, context, "stl", Up::Z),
};

/// Albedo of a surface without material.
pub const DIFFUSE: f64 = 0.8;

fn format(content: &Content) -> Format {
    mesh::format_of(&content.bytes, content.bytes.len() as u64)
}

/// Reads a model.
///
/// - `up`: axis that points up in files of this kind
fn read(content: &Content, context: &ImportContext, extension: &str, up: Up) -> Result<Option<Node>> {
    let whole = Node { value: Value::Object(vec![]), location: Location::Whole("".into()) };
    let at = JsonCursor::root(&whole, context);
    let (data, _) = mesh::read(std::io::Cursor::new(&*content.bytes), context.file)?;
    let vertices = at.make_object([("type", at.make_text("vertex_color"))]);
    let albedo = if data.colors.is_empty() { at.make_number(DIFFUSE) } else { vertices };
    let material = at.make_object([("type", at.make_text("diffuse")), ("albedo", albedo)]);
    let file = at.make_text(file_name(content, context, extension));
    let shape = at.make_object([("type", at.make_text("mesh")), ("file", file), ("material", material)]);
    Ok(Some(scene(&at, bounds(&data, context, up), vec![], vec![shape], false)))
}

/// Name of the file itself in the scene that shows it. A file that was read from standard input comes with the scene.
pub fn file_name(content: &Content, context: &ImportContext, extension: &str) -> String {
    let has_extension = |name: &&str| Path::new(name).extension().is_some_and(|e| e.eq_ignore_ascii_case(extension));
    let own = content.path.file_name().and_then(|name| name.to_str()).filter(|_| content.path != Path::new("-"));
    own.filter(has_extension).map(str::to_owned).unwrap_or_else(|| {
        let name = format!("model.{extension}");
        context.make(&*name, content.bytes.clone());
        name
    })
}

/// Bounds of the vertices.
pub fn bounds(mesh: &MeshData, context: &ImportContext, up: Up) -> Bounds {
    let mut bounds = Bounds::empty(&AutoCamera { up: context.auto_camera.up.or(Some(up)), ..context.auto_camera });
    mesh.positions.iter().for_each(|p| bounds.add(p.as_dvec3()));
    bounds
}

/// Scene that shows `shapes`, with a camera, and with light unless a shape emits.
pub fn scene(at: &JsonCursor, bounds: Bounds, materials: Vec<(&str, Node)>, shapes: Vec<Node>, is_lit: bool) -> Node {
    let camera = auto_camera::camera(at, &bounds);
    at.context().set_missing(MissingParts { bounds, placed: camera.child("look_at").cloned(), light: !is_lit });
    at.make_object([
        ("pt", at.make_number(1.0)),
        ("camera", camera),
        ("film", auto_camera::film(at, ASPECT)),
        ("materials", at.make_object(materials)),
        ("shapes", at.make_array(shapes)),
    ])
}
