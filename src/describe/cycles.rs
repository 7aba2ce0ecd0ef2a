//! Textures that contain themselves, by name.

use std::collections::BTreeMap;
use std::slice;

use super::texture::{Texture, Textured};
use crate::reader::escaped;

/// How many named textures may lie within each other: evaluating them recurses.
const MAX_DEPTH: usize = 64;

/// A fault: the JSON pointer it is about, and what is wrong.
pub(super) type Finding = (String, String);

/// What one texture mentions: where, and the name.
struct Mention<'s> {
    pointer: String,
    name: &'s str,
}

/// Every reference by which a texture contains itself, and the first texture that lies too deep.
///
/// A depth-first walk with its own stack, each texture entered once.
pub(super) fn find(textures: &BTreeMap<String, Texture>) -> Vec<Finding> {
    let graph: BTreeMap<&str, Vec<Mention>> = textures.iter().map(|(name, texture)| (name.as_str(), mentions(name, texture))).collect();
    let mut walk = Walk { graph: &graph, open: vec![], depths: BTreeMap::new(), findings: vec![] };
    for name in graph.keys() {
        walk.from(name);
    }
    walk.findings
}

struct Walk<'g, 's> {
    graph: &'g BTreeMap<&'s str, Vec<Mention<'s>>>,
    /// The textures being walked, each within the one before.
    open: Vec<(&'s str, slice::Iter<'g, Mention<'s>>)>,
    /// The textures entered; 0 until all they mention is walked, then how deep they reach.
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
                    let message = format!("the texture contains itself: {} → {}", path.join(" → "), mention.name);
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
        if depth == MAX_DEPTH + 1 {
            self.findings.push((format!("/textures{}", escaped(name)), format!("textures lie within each other deeper than {MAX_DEPTH}")));
        }
        self.depths.insert(name, depth);
        self.open.pop();
    }
}

fn mentions<'s>(name: &str, texture: &'s Texture) -> Vec<Mention<'s>> {
    let mut found = vec![];
    collect(format!("/textures{}", escaped(name)), texture, &mut found);
    found
}

/// Recurses only into textures written within each other, which nest no deeper than the file.
fn collect<'s>(pointer: String, texture: &'s Texture, found: &mut Vec<Mention<'s>>) {
    for (key, part) in texture.parts() {
        match part {
            Textured::Color(_) => {}
            Textured::Named(name) => found.push(Mention { pointer: format!("{pointer}/{key}"), name }),
            Textured::Texture(inner) => collect(format!("{pointer}/{key}"), inner, found),
        }
    }
}
