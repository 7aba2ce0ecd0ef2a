//! Surfaces.

use super::material::{SurfaceAppearance, is_light};
use super::media::Interior;
use super::spelling::word;
use super::value::{scalar, vector};
use super::{Reader, transform};
use crate::import::json_cursor::JsonCursor;
use crate::reader::{Node, unknown};

const TYPES: &[&str] = &["sphere", "quad", "triangle", "mesh", "group"];
const COMMON: &[&str] = &["type", "name", "transform", "material", "medium_interface"];

impl<'a> Reader<'a> {
    /// Converts a surface to a shape.
    pub fn surface(&self, cursor: &JsonCursor<'a>) -> Option<Node> {
        let kind = cursor.need(&["type"])?;
        let own = match word(kind.text()?).as_str() {
            "sphere" => self.sphere(cursor),
            "quad" => self.quad(cursor),
            "triangle" => self.triangle(cursor),
            "mesh" => self.mesh(cursor),
            "group" => self.group(cursor),
            _ => {
                kind.fault(unknown("surface", kind.text()?, TYPES));
                None
            }
        };
        let mut members = vec![];
        if let Some(name) = cursor.get(&["name"]) {
            name.text()?;
            members.push(("name", name.same()));
        }
        let reflected = self.reflection(cursor);
        match cursor.get(&["transform"]) {
            Some(placed) => members.push(("transform", transform::steps_after(reflected, &placed)?)),
            None => members.extend(reflected.map(|step| ("transform", cursor.make_array([step])))),
        }
        Some(cursor.make_object(own?.into_iter().chain(members)))
    }

    /// Point reflection of a sphere, if its material varies over texture coordinates.
    ///
    /// In those programs u = φ/2π + ½ and v = 1 − θ/π, in pt φ/2π and θ/π: those of the opposite point.
    fn reflection(&self, cursor: &JsonCursor<'a>) -> Option<Node> {
        let is_sphere = cursor.node().child("type").and_then(Node::as_str) == Some("sphere");
        let material = cursor.get(&["material"])?;
        (is_sphere && self.varies_over_uv(&material)).then(|| cursor.make_object([("scale", cursor.make_number(-1.0))]))
    }

    fn sphere(&self, cursor: &JsonCursor<'a>) -> Option<Members> {
        known(cursor, &["radius"]);
        let mut members = self.members_with_material(cursor, "sphere")?;
        if let Some(radius) = cursor.get(&["radius"]) {
            members.push(("radius", scalar(&radius)?));
        }
        Some(members)
    }

    fn quad(&self, cursor: &JsonCursor<'a>) -> Option<Members> {
        known(cursor, &["size"]);
        let mut members = self.members_with_material(cursor, "quad")?;
        if let Some(size) = cursor.get(&["size"]) {
            members.push(("size", vector(&size, 2)?));
        }
        Some(members)
    }

    /// Mesh of one triangle.
    fn triangle(&self, cursor: &JsonCursor<'a>) -> Option<Members> {
        known(cursor, &["positions", "normals", "uvs"]);
        let mut members = self.members_with_material(cursor, "mesh")?;
        members.push(("positions", corners(&cursor.need(&["positions"])?, 3)?));
        members.push(("triangles", cursor.make_array([cursor.make_array([0, 1, 2].map(|corner| cursor.make_whole(corner)))])));
        for (key, length) in [("normals", 3), ("uvs", 2)] {
            if let Some(given) = cursor.get(&[key]) {
                members.push((key, corners(&given, length)?));
            }
        }
        Some(members)
    }

    fn mesh(&self, cursor: &JsonCursor<'a>) -> Option<Members> {
        known(cursor, &["filename"]);
        let mut members = self.members_with_material(cursor, "mesh")?;
        let file = cursor.need(&["filename"])?;
        let names = self.named_in(&file)?;
        members.push(("file", file.same()));
        if !names.is_empty() {
            members.push(("materials", file.make_object(names.into_iter().map(|name| (name.clone(), file.make_text(name))))));
        }
        Some(members)
    }

    /// The scene's materials that a mesh file names. They replace the file's own.
    ///
    /// What is wrong with the file is reported when it is read as a mesh.
    fn named_in(&self, file: &JsonCursor<'a>) -> Option<Vec<String>> {
        let (name, files) = (file.text()?, &file.context().files);
        if self.materials.is_empty() {
            return Some(vec![]);
        }
        let text = files.bytes(name).unwrap_or_default();
        let mut names: Vec<String> = text
            .split(|byte| *byte == b'\n')
            .filter_map(|line| std::str::from_utf8(line).ok()?.trim().strip_prefix("usemtl")?.trim().to_owned().into())
            .filter(|name| self.materials.contains_key(name.as_str()))
            .collect();
        names.sort_unstable();
        names.dedup();
        if let Some(light) = names.iter().find(|name| self.materials.get(name.as_str()).is_some_and(is_light)) {
            file.fault(format!("its part {light:?} is a light: parts of a mesh that shine are not supported, the whole mesh may"));
            return None;
        }
        Some(names)
    }

    fn group(&self, cursor: &JsonCursor<'a>) -> Option<Members> {
        cursor.leave_out_others(&["type", "name", "transform", "children"]);
        let children = cursor.need(&["children"])?;
        let shapes = self.surfaces(&children)?;
        Some(vec![("type", cursor.make_text("group")), ("shapes", shapes)])
    }

    /// Converts a list of surfaces.
    pub fn surfaces(&self, list: &JsonCursor<'a>) -> Option<Node> {
        let made: Vec<Option<Node>> = list.items()?.iter().map(|cursor| self.surface(cursor)).collect();
        Some(list.make_array(made.into_iter().collect::<Option<Vec<_>>>()?))
    }

    fn members_with_material(&self, cursor: &JsonCursor<'a>, kind: &str) -> Option<Members> {
        let mut members = vec![("type", cursor.make_text(kind))];
        match self.media.interior(cursor)? {
            Interior::Nothing => {}
            Interior::IndexMatched => {
                members.push(("material", cursor.make_object([("type", cursor.make_text("interface"))])));
                return Some(members);
            }
            Interior::Medium(medium) => {
                members.push(("medium", medium));
                // Without a material it is the boundary of a medium and no surface.
                if !cursor.has("material") {
                    return Some(members);
                }
            }
        }
        let SurfaceAppearance { material, emission } = self.appearance(cursor)?;
        members.push(("material", material));
        members.extend(emission.map(|emission| ("emission", emission)));
        Some(members)
    }
}

type Members = Vec<(&'static str, Node)>;

fn known(cursor: &JsonCursor, own: &[&str]) {
    cursor.leave_out_others(&[COMMON, own].concat());
}

/// Three vectors, one for each corner of a triangle.
fn corners(cursor: &JsonCursor, length: usize) -> Option<Node> {
    let items = cursor.items()?;
    if items.len() != 3 {
        cursor.expected("an array of 3, one for each corner");
        return None;
    }
    let vectors: Option<Vec<Node>> = items.iter().map(|item| vector(item, length)).collect();
    Some(cursor.make_array(vectors?))
}
