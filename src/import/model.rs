//! Models by themselves, one mesh without materials: PLY and STL, with a camera and light chosen for them. In an STL z is up,
//! as programs for printing have it.

use std::path::Path;

use super::framing::{self, Bounds, Framing, Lacking, Up};
use super::view::View;
use super::{Content, Dialect, Foreign};
use crate::describe::mesh::{self, Format};
use crate::error::Result;
use crate::reader::{Node, Place, Value};
use crate::shape::MeshData;

pub const PLY: Dialect = Dialect {
    name: "ply",
    about: "PLY: a model by itself",
    is: |content| format(content) == Format::Ply,
    read: |content, foreign| read(content, foreign, "ply", Up::Y),
};

pub const STL: Dialect = Dialect {
    name: "stl",
    about: "STL, binary or ASCII: a model by itself",
    is: |content| format(content) == Format::Stl,
    read: |content, foreign| read(content, foreign, "stl", Up::Z),
};

/// What a surface without material reflects.
pub const DIFFUSE: f64 = 0.8;

fn format(content: &Content) -> Format {
    mesh::format_of(&content.bytes, content.bytes.len() as u64)
}

/// - `up`: what points up in files of this kind
fn read(content: &Content, foreign: &Foreign, extension: &str, up: Up) -> Result<Option<Node>> {
    let whole = Node { value: Value::Object(vec![]), place: Place::Whole("".into()) };
    let at = View::root(&whole, foreign);
    let (data, _) = mesh::read(std::io::Cursor::new(&content.bytes), foreign.file)?;
    let vertices = at.make_object([("type", at.make_text("vertex_color"))]);
    let albedo = if data.colors.is_empty() { at.make_number(DIFFUSE) } else { vertices };
    let material = at.make_object([("type", at.make_text("diffuse")), ("albedo", albedo)]);
    let file = at.make_text(file_name(content, foreign, extension));
    let shape = at.make_object([("type", at.make_text("mesh")), ("file", file), ("material", material)]);
    Ok(Some(scene(&at, bounds(&data, foreign, up), vec![], vec![shape], false)))
}

/// The file itself, as the scene that shows it calls it; what lies in no folder comes with the scene.
pub fn file_name(content: &Content, foreign: &Foreign, extension: &str) -> String {
    let has_extension = |name: &&str| Path::new(name).extension().is_some_and(|e| e.eq_ignore_ascii_case(extension));
    let own = content.path.file_name().and_then(|name| name.to_str()).filter(|_| content.path != Path::new("-"));
    own.filter(has_extension).map(str::to_owned).unwrap_or_else(|| {
        let name = format!("model.{extension}");
        foreign.make(&*name, content.bytes.clone());
        name
    })
}

/// How far the vertices reach.
pub fn bounds(mesh: &MeshData, foreign: &Foreign, up: Up) -> Bounds {
    let mut bounds = Bounds::empty(&Framing { up: foreign.framing.up.or(Some(up)), ..foreign.framing });
    mesh.positions.iter().for_each(|p| bounds.add(p.as_dvec3()));
    bounds
}

/// The scene that shows `shapes`, with a camera, and with light where nothing of it shines.
pub fn scene(at: &View, bounds: Bounds, materials: Vec<(&str, Node)>, shapes: Vec<Node>, is_lit: bool) -> Node {
    let camera = framing::camera(at, &bounds);
    at.foreign().lacks(Lacking { bounds, placed: camera.child("look_at").cloned(), light: !is_lit });
    at.make_object([
        ("pt", at.make_number(1.0)),
        ("camera", camera),
        ("film", framing::film(at, framing::ASPECT)),
        ("materials", at.make_object(materials)),
        ("shapes", at.make_array(shapes)),
    ])
}
