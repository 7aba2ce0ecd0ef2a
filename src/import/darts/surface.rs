//! Surfaces.

use super::Reader;
use super::material::{Dress, is_light};
use super::spelling::word;
use super::value::{scalar, vector};
use super::{refuse_media, transform};
use crate::import::view::View;
use crate::reader::{Node, unknown};

const TYPES: &[&str] = &["sphere", "quad", "triangle", "mesh", "group"];
const COMMON: &[&str] = &["type", "name", "transform", "material", "medium_interface"];

impl<'a> Reader<'a> {
    /// pt's shape.
    pub fn surface(&self, view: &View<'a>) -> Option<Node> {
        refuse_media(view, "medium_interface");
        let kind = view.need(&["type"])?;
        let own = match word(kind.text()?).as_str() {
            "sphere" => self.sphere(view),
            "quad" => self.quad(view),
            "triangle" => self.triangle(view),
            "mesh" => self.mesh(view),
            "group" => self.group(view),
            _ => {
                kind.fault(unknown("surface", kind.text()?, TYPES));
                None
            }
        };
        let mut members = vec![];
        if let Some(name) = view.get(&["name"]) {
            name.text()?;
            members.push(("name", name.same()));
        }
        let reflected = self.reflection(view);
        match view.get(&["transform"]) {
            Some(placed) => members.push(("transform", transform::steps_after(reflected, &placed)?)),
            None => members.extend(reflected.map(|step| ("transform", view.make_array([step])))),
        }
        Some(view.make_object(own?.into_iter().chain(members)))
    }

    /// The reflection about its centre that gives a sphere their texture coordinates, where it wears what varies over them.
    ///
    /// Theirs are u = φ/2π + ½ and v = 1 − θ/π, pt's φ/2π and θ/π: those of the opposite point.
    fn reflection(&self, view: &View<'a>) -> Option<Node> {
        let is_sphere = view.node().child("type").and_then(Node::as_str) == Some("sphere");
        let material = view.get(&["material"])?;
        (is_sphere && self.varies_over_uv(&material)).then(|| view.make_object([("scale", view.make_number(-1.0))]))
    }

    fn sphere(&self, view: &View<'a>) -> Option<Members> {
        known(view, &["radius"]);
        let mut members = self.dressed(view, "sphere")?;
        if let Some(radius) = view.get(&["radius"]) {
            members.push(("radius", scalar(&radius)?));
        }
        Some(members)
    }

    fn quad(&self, view: &View<'a>) -> Option<Members> {
        known(view, &["size"]);
        let mut members = self.dressed(view, "quad")?;
        if let Some(size) = view.get(&["size"]) {
            members.push(("size", vector(&size, 2)?));
        }
        Some(members)
    }

    /// A mesh of one triangle.
    fn triangle(&self, view: &View<'a>) -> Option<Members> {
        known(view, &["positions", "normals", "uvs"]);
        let mut members = self.dressed(view, "mesh")?;
        members.push(("positions", corners(&view.need(&["positions"])?, 3)?));
        members.push(("triangles", view.make_array([view.make_array([0, 1, 2].map(|corner| view.make_whole(corner)))])));
        for (key, length) in [("normals", 3), ("uvs", 2)] {
            if let Some(given) = view.get(&[key]) {
                members.push((key, corners(&given, length)?));
            }
        }
        Some(members)
    }

    fn mesh(&self, view: &View<'a>) -> Option<Members> {
        known(view, &["filename"]);
        let mut members = self.dressed(view, "mesh")?;
        let file = view.need(&["filename"])?;
        let names = self.named_in(&file)?;
        members.push(("file", file.same()));
        if !names.is_empty() {
            members.push(("materials", file.make_object(names.into_iter().map(|name| (name.clone(), file.make_text(name))))));
        }
        Some(members)
    }

    /// The scene's materials that a mesh file asks for: they go before the mesh's own.
    ///
    /// What is wrong with the file itself is told when it is read as a mesh.
    fn named_in(&self, file: &View<'a>) -> Option<Vec<String>> {
        let (name, files) = (file.text()?, &file.foreign().files);
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

    fn group(&self, view: &View<'a>) -> Option<Members> {
        view.leave_out_others(&["type", "name", "transform", "children", "medium_interface"]);
        let children = view.need(&["children"])?;
        let shapes = self.surfaces(&children)?;
        Some(vec![("type", view.make_text("group")), ("shapes", shapes)])
    }

    pub fn surfaces(&self, list: &View<'a>) -> Option<Node> {
        let made: Vec<Option<Node>> = list.items()?.iter().map(|view| self.surface(view)).collect();
        Some(list.make_array(made.into_iter().collect::<Option<Vec<_>>>()?))
    }

    fn dressed(&self, view: &View<'a>, kind: &str) -> Option<Members> {
        let Dress { material, emission } = self.dress(view)?;
        let mut members = vec![("type", view.make_text(kind)), ("material", material)];
        members.extend(emission.map(|emission| ("emission", emission)));
        Some(members)
    }
}

type Members = Vec<(&'static str, Node)>;

fn known(view: &View, own: &[&str]) {
    view.leave_out_others(&[COMMON, own].concat());
}

/// One vector for each corner of a triangle.
fn corners(view: &View, length: usize) -> Option<Node> {
    let items = view.items()?;
    if items.len() != 3 {
        view.expected("an array of 3, one for each corner");
        return None;
    }
    let vectors: Option<Vec<Node>> = items.iter().map(|item| vector(item, length)).collect();
    Some(view.make_array(vectors?))
}
