//! Scenes of the Dartmouth courses' ray tracers, dirt and darts: three dialects, one reader.
//!
//! What a thing is called differs from year to year, what it means hardly does: every spelling is understood in all three.
//! By its spellings a scene is told to be of one of them (`spelling.rs`), for the few things that changed their meaning.

mod camera;
mod integrator;
mod material;
mod spelling;
mod surface;
pub mod tests;
mod texture;
mod transform;
mod value;

use std::collections::BTreeMap;

use super::Dialect;
use super::foreign::{Content, Foreign};
use super::view::View;
use crate::error::Result;
use crate::reader::{Node, unknown};
use spelling::{Course, Evidence};

pub const DIRT: Dialect = Dialect {
    name: "dirt",
    about: "dirt, the ray tracer of Dartmouth's courses until 2020",
    is: |content| is(content, Course::Dirt),
    read,
};

pub const DARTS_2021: Dialect =
    Dialect { name: "darts 2021", about: "its successor darts, as of 2021", is: |content| is(content, Course::Darts2021), read };

pub const DARTS: Dialect = Dialect { name: "darts", about: "darts of 2024 and later", is: |content| is(content, Course::Darts), read };

const KEYS: &[&str] = &["camera", "surfaces", "materials", "background", "accelerator", "integrator", "sampler", "image_samples", "media"];

const NO_MEDIA: &str = "participating media are not supported";

fn is(content: &Content, course: Course) -> bool {
    content.tree().is_some_and(|root| spelling::is_of_the_course(root) && Evidence::of(root).course() == course)
}

fn read(content: &Content, foreign: &Foreign) -> Result<Option<Node>> {
    let node = content.json(foreign)?;
    let root = View::root(node, foreign);
    if spelling::is_tests(node) {
        root.fault("a file of tests and no scene: `pt sample` runs it");
        return Ok(None);
    }
    let Some(reader) = Reader::new(&root) else { return Ok(None) };
    Ok(reader.scene(&root))
}

/// What is known while a scene is read.
struct Reader<'a> {
    /// By which its dialect is told.
    spellings: Evidence,
    /// Those that have names.
    materials: BTreeMap<&'a str, View<'a>>,
}

impl<'a> Reader<'a> {
    fn new(root: &View<'a>) -> Option<Reader<'a>> {
        let mut materials: BTreeMap<&'a str, View<'a>> = BTreeMap::new();
        for view in root.get(&["materials"]).map_or(Some(vec![]), |list| list.items())? {
            let name = view.need(&["name"])?;
            if let Some(before) = materials.insert(name.text()?, view) {
                before.note(format!("left out: {} is the material {:?} too, and the last is the one", name.pointer, name.text()?));
            }
        }
        Some(Reader { spellings: Evidence::of(root.node()), materials })
    }

    /// pt's scene.
    fn scene(&self, root: &View<'a>) -> Option<Node> {
        root.only(KEYS);
        refuse_media(root, "media");
        // All of it, so that all faults are told at once.
        let camera = root.need(&["camera"]).and_then(|camera| camera::camera_and_film(&camera));
        let parts = [
            Some(("pt", Some(root.make_whole(1)))),
            Some(("sampler", self.sampler(root))),
            Some(("integrator", self.integrator(root))),
            root.get(&["materials"]).map(|list| ("materials", self.named_materials(&list))),
            root.get(&["surfaces"]).map(|list| ("shapes", self.surfaces(&list))),
            background(root).map(|node| ("background", node)),
        ];
        let [camera, film] = camera?;
        let parts: Option<Vec<_>> = parts.into_iter().flatten().map(|(key, node)| Some((key, node?))).collect();
        Some(root.make_object(parts?.into_iter().chain([("camera", camera), ("film", film)])))
    }
}

/// Nothing where it is black.
fn background(root: &View) -> Option<Option<Node>> {
    let radiance = match root.get(&["background"]) {
        None => Some(root.make_number(BACKGROUND)),
        Some(view) if view.is_object() => of_type(&view),
        Some(view) => match value::numbers::<3>(&view) {
            Some([0.0, 0.0, 0.0]) => return None,
            Some(_) => value::color(&view),
            None => None,
        },
    };
    Some(radiance.map(|radiance| root.make_object([("radiance", radiance)])))
}

/// Of a scene that says nothing.
const BACKGROUND: f64 = 0.2;

fn of_type(view: &View) -> Option<Node> {
    let kind = view.need(&["type"])?;
    match kind.text()? {
        "constant" | "background" => {
            view.leave_out_others(&["type", "color"]);
            value::color(&view.need(&["color"])?)
        }
        "image" => {
            kind.fault("backgrounds that are pictures are not supported");
            None
        }
        other => {
            kind.fault(unknown("background", other, &["constant", "background", "image"]));
            None
        }
    }
}

/// A scene without its media would be another scene.
fn refuse_media(view: &View, key: &str) {
    if let Some(media) = view.get(&[key]) {
        let is_empty = media.is_array() && media.items().is_some_and(|items| items.is_empty());
        if !is_empty {
            media.fault(NO_MEDIA);
        }
    }
}
