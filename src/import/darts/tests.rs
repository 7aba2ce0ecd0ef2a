//! Files of tests: of what materials and surfaces draw, and of where rays meet surfaces.

use std::path::Path;

use glam::DVec3;

use super::Reader;
use super::material::{Dress, is_light};
use super::spelling::{self, word};
use super::value::numbers;
use crate::describe::{self, Files};
use crate::error::{Error, Fault, Result};
use crate::import::foreign::{Content, Foreign};
use crate::import::framing::Framing;
use crate::import::view::View;
use crate::math::transform::unit;
use crate::reader::{Node, unknown};

/// A file of tests, read.
pub struct Tests {
    /// What messages call it.
    pub file: String,
    pub files: Files,
    pub tests: Vec<Test>,
    /// What was left out or done in another way.
    pub notes: Vec<Fault>,
}

pub struct Test {
    pub name: String,
    pub what: What,
    /// pt's scene of what is tested: a unit sphere of the material, or the surfaces.
    pub scene: Node,
}

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum What {
    /// How a material scatters what comes from `incoming`, a direction that leads to the surface; both unit.
    Material {
        normal: DVec3,
        incoming: DVec3,
        /// Whether its density is on trial too, and not only where its directions lead.
        density: bool,
    },
    /// How points of surfaces are drawn, as seen from the origin.
    Surface,
    /// Where a ray meets surfaces.
    Intersection {
        origin: DVec3,
        direction: DVec3,
        /// `None` where it is to meet nothing.
        expected: Option<Meeting>,
        /// How far each number may be off.
        threshold: f64,
    },
}

/// A ray and a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// In lengths of the ray's direction.
    pub t: f64,
    pub p: DVec3,
    /// Geometric and shading normal.
    pub gn: DVec3,
    pub sn: DVec3,
}

const TYPES: &[&str] = &["sample material", "scatter material", "sample surface", "intersection"];

/// The tests of the file at `path`, or of standard input if that is `-`.
///
/// - `allow_outside`: whether they may name files that lie outside of their own folder
///
/// # Errors
/// `Invalid`: what is wrong with them; `Io`.
pub fn read(path: &Path, allow_outside: bool) -> Result<Tests> {
    let file = describe::name(path);
    let content = Content::new(path, describe::bytes(path)?);
    let files = Files { allow_outside, ..Files::within(path.parent().unwrap_or(Path::new(""))) };
    let foreign = Foreign::new(&file, files, Framing::default());
    let node = content.json(&foreign)?;
    let root = View::root(node, &foreign);
    let tests = if spelling::is_tests(node) {
        tests(&root)
    } else {
        root.expected("a file of tests: an object of type \"tests\"");
        None
    };
    let (files, notes) = foreign.finish()?;
    let tests = tests.ok_or_else(|| Error::Internal(format!("{file}: no tests and no fault")))?;
    Ok(Tests { file, files, tests, notes })
}

fn tests(root: &View) -> Option<Vec<Test>> {
    root.leave_out_others(&["type", "tests", "materials"]);
    let reader = Reader::new(root)?;
    let list = root.need(&["tests"])?.items()?;
    // All of them, so that all faults are told at once.
    let made: Vec<Option<Test>> = list.iter().map(|view| reader.test(view)).collect();
    made.into_iter().collect()
}

impl<'a> Reader<'a> {
    fn test(&self, view: &View<'a>) -> Option<Test> {
        let kind = view.need(&["type"])?;
        let (what, scene) = match word(kind.text()?).as_str() {
            "sample_material" => self.of_material(view, [0.25, 0.0, -1.0], true)?,
            "scatter_material" => self.of_material(view, [0.0, 0.25, -1.0], false)?,
            "sample_surface" => {
                view.leave_out_others(&["type", "name", "surface", "surfaces"]);
                (What::Surface, self.surfaces_of(view)?)
            }
            "intersection" => self.intersection(view)?,
            _ => {
                kind.fault(unknown("test", kind.text()?, TYPES));
                return None;
            }
        };
        let name = match view.get(&["name"]) {
            Some(name) => name.text()?.to_owned(),
            None if matches!(what, What::Intersection { .. }) => view.pointer.clone(),
            None => view.need(&["name"])?.text()?.to_owned(),
        };
        Some(Test { name, what, scene })
    }

    fn of_material(&self, view: &View<'a>, incoming: [f64; 3], density: bool) -> Option<(What, Node)> {
        view.leave_out_others(&["type", "name", "material", "normal", "incoming"]);
        let given = view.need(&["material"])?;
        if is_light(&given) {
            given.fault("a light scatters nothing");
            return None;
        }
        let Dress { material, .. } = self.dress(view)?;
        let normal = direction(&view.need(&["normal"])?)?;
        let incoming = match view.get(&["incoming"]) {
            Some(incoming) => direction(&incoming)?,
            None => DVec3::from(incoming).normalize(),
        };
        let sphere = view.make_object([("type", view.make_text("sphere")), ("material", material)]);
        Some((What::Material { normal, incoming, density }, scene(view, view.make_array([sphere]))))
    }

    /// `surface`, or a group of them.
    fn surfaces_of(&self, view: &View<'a>) -> Option<Node> {
        let shapes = match view.get(&["surface"]) {
            Some(surface) => view.make_array([self.surface(&surface)?]),
            None => {
                let surfaces = view.need(&["surfaces"])?;
                self.surfaces(&if surfaces.is_object() { surfaces.need(&["children"])? } else { surfaces })?
            }
        };
        Some(scene(view, shapes))
    }

    fn intersection(&self, view: &View<'a>) -> Option<(What, Node)> {
        let keys = ["type", "name", "surface", "surfaces", "ray", "t", "p", "gn", "sn", "should_hit", "should hit", "threshold"];
        view.leave_out_others(&keys);
        let ray = view.need(&["ray"])?;
        ray.leave_out_others(&["origin", "direction"]);
        let origin = point(&ray.need(&["origin"])?)?;
        let direction = point(&ray.need(&["direction"])?)?;
        if direction == DVec3::ZERO {
            ray.fault("expected a direction, found 0");
            return None;
        }
        let hits = view.get(&["should_hit", "should hit"]).map_or(Some(true), |flag| flag.flag())?;
        let meeting = || {
            let part = |key: &str| point(&view.need(&[key])?);
            let t = view.need(&["t"])?.number()?;
            Some(Meeting { t, p: part("p")?, gn: part("gn")?, sn: part("sn")? })
        };
        let expected = if hits { Some(meeting()?) } else { None };
        let threshold = view.get(&["threshold"]).map_or(Some(1e-5), |threshold| threshold.number())?;
        Some((What::Intersection { origin, direction, expected, threshold }, self.surfaces_of(view)?))
    }
}

fn point(view: &View) -> Option<DVec3> {
    numbers::<3>(view).map(DVec3::from)
}

fn direction(view: &View) -> Option<DVec3> {
    let found = unit(point(view)?);
    if found.is_none() {
        view.fault("expected a direction, found 0");
    }
    found
}

/// pt's scene that holds these shapes.
fn scene(view: &View, shapes: Node) -> Node {
    view.make_object([("pt", view.make_whole(1)), ("camera", view.make_object::<&str>([])), ("shapes", shapes)])
}
