//! Scenes of dirt and darts, the ray tracers of Dartmouth's courses: three dialects, one reader.
//!
//! Names differ from year to year, but their meaning hardly does, so every spelling is understood in all three dialects. The
//! spellings in a scene tell its dialect (`spelling.rs`), for the few things whose meaning has changed.

mod camera;
pub mod coursework;
mod integrator;
mod material;
mod media;
mod spelling;
mod surface;
mod texture;
mod transform;
mod value;

use std::collections::BTreeMap;

use super::Dialect;
use super::context::{Content, ImportContext};
use super::json_cursor::JsonCursor;
use crate::error::Result;
use crate::reader::{Node, unknown};
use media::Media;
use spelling::{DartsVersion, Evidence};

/// Dialect `dirt`.
pub const DIRT: Dialect = Dialect {
    name: "dirt",
    about: "dirt, the ray tracer of Dartmouth's courses until 2020",
    is: |content| is(content, DartsVersion::Dirt),
    read,
};

/// Dialect `darts 2021`.
pub const DARTS_2021: Dialect =
    Dialect { name: "darts 2021", about: "its successor darts, as of 2021", is: |content| is(content, DartsVersion::Darts2021), read };

/// Dialect `darts`.
pub const DARTS: Dialect =
    Dialect { name: "darts", about: "darts of 2024 and later", is: |content| is(content, DartsVersion::Darts), read };

const KEYS: &[&str] = &["camera", "surfaces", "materials", "background", "accelerator", "integrator", "sampler", "image_samples", "media"];

fn is(content: &Content, version: DartsVersion) -> bool {
    content.tree().is_some_and(|root| spelling::is_darts(root) && Evidence::of(root).version() == version)
}

fn read(content: &Content, context: &ImportContext) -> Result<Option<Node>> {
    let node = content.json(context)?;
    let root = JsonCursor::root(node, context);
    if spelling::is_tests(node) {
        root.fault("a file of tests and no scene: `pt sample` runs it");
        return Ok(None);
    }
    let Some(reader) = Reader::new(&root) else { return Ok(None) };
    Ok(reader.scene(&root))
}

/// State while a scene is read.
struct Reader<'a> {
    /// Spellings, which tell the dialect.
    spellings: Evidence,
    /// Materials with names.
    materials: BTreeMap<&'a str, JsonCursor<'a>>,
    /// Participating media.
    media: Media<'a>,
}

impl<'a> Reader<'a> {
    fn new(root: &JsonCursor<'a>) -> Option<Reader<'a>> {
        let materials = by_name(root, "materials", "material")?;
        Some(Reader { spellings: Evidence::of(root.node()), materials, media: Media::new(root)? })
    }

    /// Converts a scene.
    fn scene(&self, root: &JsonCursor<'a>) -> Option<Node> {
        root.only(KEYS);
        // All parts are converted, so that all faults are reported at once.
        let camera = root.need(&["camera"]).and_then(|camera| camera::camera_and_film(&camera));
        let parts = [
            Some(("pt", Some(root.make_whole(1)))),
            Some(("sampler", self.sampler(root))),
            Some(("integrator", self.integrator(root))),
            root.get(&["materials"]).map(|list| ("materials", self.named_materials(&list))),
            self.media.named_media(root).map(|node| ("media", node)),
            self.media.exterior().map(|node| ("medium", node)),
            root.get(&["surfaces"]).map(|list| ("shapes", self.surfaces(&list))),
            background(root).map(|node| ("background", node)),
        ];
        let [camera, film] = camera?;
        let parts: Option<Vec<_>> = parts.into_iter().flatten().map(|(key, node)| Some((key, node?))).collect();
        Some(root.make_object(parts?.into_iter().chain([("camera", camera), ("film", film)])))
    }
}

/// Members of a list at the top, by their names; of several with one name the last counts.
fn by_name<'a>(root: &JsonCursor<'a>, list: &str, kind: &str) -> Option<BTreeMap<&'a str, JsonCursor<'a>>> {
    let mut named: BTreeMap<&'a str, JsonCursor<'a>> = BTreeMap::new();
    for cursor in root.get(&[list]).map_or(Some(vec![]), |list| list.items())? {
        let name = cursor.need(&["name"])?;
        if let Some(before) = named.insert(name.text()?, cursor) {
            before.note(format!("left out: {} is the {kind} {:?} too, and the last is the one", name.pointer, name.text()?));
        }
    }
    Some(named)
}

/// Converts the background; `None` if it is black.
fn background(root: &JsonCursor) -> Option<Option<Node>> {
    let radiance = match root.get(&["background"]) {
        None => Some(root.make_number(BACKGROUND)),
        Some(cursor) if cursor.is_object() => of_type(&cursor),
        Some(cursor) => match value::numbers::<3>(&cursor) {
            Some([0.0, 0.0, 0.0]) => return None,
            Some(_) => value::color(&cursor),
            None => None,
        },
    };
    Some(radiance.map(|radiance| root.make_object([("radiance", radiance)])))
}

/// Default radiance of the background.
const BACKGROUND: f64 = 0.2;

fn of_type(cursor: &JsonCursor) -> Option<Node> {
    let kind = cursor.need(&["type"])?;
    match kind.text()? {
        "constant" | "background" => {
            cursor.leave_out_others(&["type", "color"]);
            value::color(&cursor.need(&["color"])?)
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
