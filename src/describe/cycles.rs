//! Finds textures, materials and groups that contain themselves by name, or that are nested too deeply.

use std::collections::BTreeMap;
use std::slice;

use super::{Material, MaterialRef, Shape};
use crate::format::{Texture, Textured};
use crate::primitive::MAX_NESTING;
use crate::reader::escaped;

/// A kind of description that may refer to others of its kind by name.
#[derive(Clone, Copy)]
struct Kind {
    name: &'static str,
    /// The JSON pointer of the scene's object that contains the named descriptions of this kind.
    folder: &'static str,
    /// The largest depth of nesting. There is a limit because evaluation recurses.
    max_depth: usize,
}

const TEXTURES: Kind = Kind { name: "texture", folder: "/textures", max_depth: 64 };
const MATERIALS: Kind = Kind { name: "material", folder: "/materials", max_depth: 8 };
const GROUPS: Kind = Kind { name: "group", folder: "/groups", max_depth: MAX_NESTING };

/// A fault: the JSON pointer it is about, and what is wrong.
pub(super) type Finding = (String, String);

/// A reference to a texture, material or group by its name.
struct Mention<'s> {
    /// The JSON pointer of the reference.
    pointer: String,
    name: &'s str,
}

/// Finds every reference by which a texture contains itself, and each texture at which nesting first becomes too deep.
pub(super) fn textures(textures: &BTreeMap<String, Texture>) -> Vec<Finding> {
    find(TEXTURES, textures, of_texture)
}

/// Finds every reference by which a material contains itself, and each material at which nesting first becomes too deep.
pub(super) fn materials(materials: &BTreeMap<String, Material>) -> Vec<Finding> {
    find(MATERIALS, materials, of_material)
}

/// Finds every reference by which a group contains itself, and each group at which nesting first becomes too deep.
pub(super) fn groups(groups: &BTreeMap<String, Vec<Shape>>) -> Vec<Finding> {
    find(GROUPS, groups, |pointer, shapes, found| of_shapes(&pointer, shapes, found))
}

/// Searches all names depth first, with a stack of its own; each name is entered once.
fn find<'s, T>(kind: Kind, all: &'s BTreeMap<String, T>, mentions: impl Fn(String, &'s T, &mut Vec<Mention<'s>>)) -> Vec<Finding> {
    let of = |(name, one): (&'s String, &'s T)| {
        let mut found = vec![];
        mentions(format!("{}{}", kind.folder, escaped(name)), one, &mut found);
        (name.as_str(), found)
    };
    let graph: BTreeMap<&str, Vec<Mention>> = all.iter().map(of).collect();
    let mut walk = Walk { kind, graph: &graph, open: vec![], depths: BTreeMap::new(), findings: vec![] };
    for name in graph.keys() {
        walk.from(name);
    }
    walk.findings
}

struct Walk<'g, 's> {
    kind: Kind,
    graph: &'g BTreeMap<&'s str, Vec<Mention<'s>>>,
    /// The names on the current path, each within the one before, with the references that are left.
    open: Vec<(&'s str, slice::Iter<'g, Mention<'s>>)>,
    /// The depth of nesting below each name that was entered; 0 until the search has left that name.
    depths: BTreeMap<&'s str, usize>,
    findings: Vec<Finding>,
}

impl<'s> Walk<'_, 's> {
    fn from(&mut self, start: &'s str) {
        self.enter(start);
        while let Some((name, rest)) = self.open.last_mut() {
            match rest.next() {
                Some(mention) if self.depths.get(mention.name) == Some(&0) => {
                    let path: Vec<&str> = self.open.iter().map(|(n, _)| *n).skip_while(|n| *n != mention.name).collect();
                    let message = format!("the {} contains itself: {} → {}", self.kind.name, path.join(" → "), mention.name);
                    self.findings.push((mention.pointer.clone(), message));
                }
                Some(mention) => {
                    let name = mention.name;
                    self.enter(name);
                }
                None => {
                    let name = *name;
                    self.leave(name);
                }
            }
        }
    }

    fn enter(&mut self, name: &'s str) {
        if let Some((name, mentions)) = self.graph.get_key_value(name).filter(|_| !self.depths.contains_key(name)) {
            self.depths.insert(name, 0);
            self.open.push((name, mentions.iter()));
        }
    }

    fn leave(&mut self, name: &'s str) {
        let below = self.graph[name].iter().filter_map(|m| self.depths.get(m.name)).max();
        let depth = 1 + below.copied().unwrap_or(0);
        let Kind { name: kind, folder, max_depth } = self.kind;
        if depth == max_depth + 1 {
            let message = format!("{kind}s lie within each other deeper than {max_depth}");
            self.findings.push((format!("{folder}{}", escaped(name)), message));
        }
        self.depths.insert(name, depth);
        self.open.pop();
    }
}

/// Collects the references of a texture. It recurses only into inline textures, whose nesting the file's own nesting bounds.
fn of_texture<'s>(pointer: String, texture: &'s Texture, found: &mut Vec<Mention<'s>>) {
    for (key, part) in texture.parts() {
        match part {
            Textured::Color(_) => {}
            Textured::Named(name) => found.push(Mention { pointer: format!("{pointer}/{key}"), name }),
            Textured::Texture(inner) => of_texture(format!("{pointer}/{key}"), inner, found),
        }
    }
}

/// Collects the references of a material. It recurses only into inline materials.
fn of_material<'s>(pointer: String, material: &'s Material, found: &mut Vec<Mention<'s>>) {
    for (key, part) in material.description().parts() {
        match part {
            MaterialRef::Named(name) => found.push(Mention { pointer: format!("{pointer}/{key}"), name }),
            MaterialRef::Inline(inner) => of_material(format!("{pointer}/{key}"), inner, found),
        }
    }
}

/// Collects the groups of which some shapes are instances.
fn of_shapes<'s>(pointer: &str, shapes: &'s [Shape], found: &mut Vec<Mention<'s>>) {
    for (i, shape) in shapes.iter().enumerate() {
        match shape {
            Shape::Group(group) => of_shapes(&format!("{pointer}/{i}/shapes"), &group.shapes, found),
            Shape::Instances(instances) => found.push(Mention { pointer: format!("{pointer}/{i}/group"), name: &instances.group }),
            _ => {}
        }
    }
}
