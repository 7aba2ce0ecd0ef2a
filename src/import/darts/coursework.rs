//! Test files of the courses of dirt and darts: sampling of materials and surfaces, and intersections of rays with surfaces.

use std::path::Path;

use glam::DVec3;

use super::Reader;
use super::material::{SurfaceAppearance, is_light};
use super::spelling::{self, word};
use super::value::numbers;
use crate::describe::{self, Files};
use crate::error::{Error, Fault, Result};
use crate::import::context::{Content, ImportContext};
use crate::import::json_cursor::JsonCursor;
use crate::import::view::AutoCamera;
use crate::math::transform::unit;
use crate::reader::{Node, unknown};

/// Content of a file of tests.
pub struct Tests {
    /// Name of the file in messages.
    pub file: String,
    /// Files that the tests name.
    pub files: Files,
    /// The tests.
    pub tests: Vec<Test>,
    /// Notes about what was left out or done in another way.
    pub notes: Vec<Fault>,
}

/// One test.
pub struct Test {
    /// Name of the test.
    pub name: String,
    /// Kind of the test, with its parameters.
    pub what: TestKind,
    /// Scene of the test: a unit sphere of the material, or the surfaces.
    pub scene: Node,
}

/// Kind of a test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TestKind {
    /// Scattering by a material of light from `incoming`, a unit direction that leads to the surface. `normal` is a unit vector
    /// too.
    Material {
        /// Normal of the surface.
        normal: DVec3,
        /// Direction of the incoming light, towards the surface.
        incoming: DVec3,
        /// Whether the density is tested too, or only the directions.
        density: bool,
    },
    /// Sampling of points of surfaces, as seen from the origin.
    Surface,
    /// Intersection of a ray with surfaces.
    Intersection {
        /// Origin of the ray.
        origin: DVec3,
        /// Direction of the ray, of any length.
        direction: DVec3,
        /// Expected hit; `None` if the ray must miss.
        expected: Option<ExpectedHit>,
        /// Tolerance for each number.
        threshold: f64,
    },
}

/// Expected intersection of a ray and a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedHit {
    /// Ray parameter of the hit: its distance divided by the length of the ray's direction.
    pub t: f64,
    /// Point of the intersection.
    pub p: DVec3,
    /// Geometric normal.
    pub gn: DVec3,
    /// Shading normal.
    pub sn: DVec3,
}

const TYPES: &[&str] = &["sample material", "scatter material", "sample surface", "intersection"];

/// Reads the tests of the file at `path`, or of standard input if that is `-`.
///
/// - `allow_outside`: whether they may name files that lie outside of their own folder
///
/// # Errors
/// `Invalid`: the faults of the file; `Io`.
pub fn read(path: &Path, allow_outside: bool) -> Result<Tests> {
    let file = describe::name(path);
    let content = Content::new(path, describe::bytes(path)?);
    let files = Files { allow_outside, ..Files::within(path.parent().unwrap_or(Path::new(""))) };
    let context = ImportContext::new(&file, files, AutoCamera::default());
    let node = content.json(&context)?;
    let root = JsonCursor::root(node, &context);
    let tests = if spelling::is_tests(node) {
        tests(&root)
    } else {
        root.expected("a file of tests: an object of type \"tests\"");
        None
    };
    let (files, notes) = context.finish()?;
    let tests = tests.ok_or_else(|| Error::Internal(format!("{file}: no tests and no fault")))?;
    Ok(Tests { file, files, tests, notes })
}

fn tests(root: &JsonCursor) -> Option<Vec<Test>> {
    root.leave_out_others(&["type", "tests", "materials"]);
    let reader = Reader::new(root)?;
    let list = root.need(&["tests"])?.items()?;
    // All tests are read, so that all faults are reported at once.
    let made: Vec<Option<Test>> = list.iter().map(|cursor| reader.test(cursor)).collect();
    made.into_iter().collect()
}

impl<'a> Reader<'a> {
    fn test(&self, cursor: &JsonCursor<'a>) -> Option<Test> {
        let kind = cursor.need(&["type"])?;
        let (what, scene) = match word(kind.text()?).as_str() {
            "sample_material" => self.of_material(cursor, [0.25, 0.0, -1.0], true)?,
            "scatter_material" => self.of_material(cursor, [0.0, 0.25, -1.0], false)?,
            "sample_surface" => {
                cursor.leave_out_others(&["type", "name", "surface", "surfaces"]);
                (TestKind::Surface, self.surfaces_of(cursor)?)
            }
            "intersection" => self.intersection(cursor)?,
            _ => {
                kind.fault(unknown("test", kind.text()?, TYPES));
                return None;
            }
        };
        let name = match cursor.get(&["name"]) {
            Some(name) => name.text()?.to_owned(),
            None if matches!(what, TestKind::Intersection { .. }) => cursor.pointer.clone(),
            None => cursor.need(&["name"])?.text()?.to_owned(),
        };
        Some(Test { name, what, scene })
    }

    fn of_material(&self, cursor: &JsonCursor<'a>, incoming: [f64; 3], density: bool) -> Option<(TestKind, Node)> {
        cursor.leave_out_others(&["type", "name", "material", "normal", "incoming"]);
        let given = cursor.need(&["material"])?;
        if is_light(&given) {
            given.fault("a light scatters nothing");
            return None;
        }
        let SurfaceAppearance { material, .. } = self.appearance(cursor)?;
        let normal = direction(&cursor.need(&["normal"])?)?;
        let incoming = match cursor.get(&["incoming"]) {
            Some(incoming) => direction(&incoming)?,
            None => DVec3::from(incoming).normalize(),
        };
        let sphere = cursor.make_object([("type", cursor.make_text("sphere")), ("material", material)]);
        Some((TestKind::Material { normal, incoming, density }, scene(cursor, cursor.make_array([sphere]))))
    }

    /// Scene of `surface`, or of a group of surfaces.
    fn surfaces_of(&self, cursor: &JsonCursor<'a>) -> Option<Node> {
        let shapes = match cursor.get(&["surface"]) {
            Some(surface) => cursor.make_array([self.surface(&surface)?]),
            None => {
                let surfaces = cursor.need(&["surfaces"])?;
                self.surfaces(&if surfaces.is_object() { surfaces.need(&["children"])? } else { surfaces })?
            }
        };
        Some(scene(cursor, shapes))
    }

    fn intersection(&self, cursor: &JsonCursor<'a>) -> Option<(TestKind, Node)> {
        let keys = ["type", "name", "surface", "surfaces", "ray", "t", "p", "gn", "sn", "should_hit", "should hit", "threshold"];
        cursor.leave_out_others(&keys);
        let ray = cursor.need(&["ray"])?;
        ray.leave_out_others(&["origin", "direction"]);
        let origin = point(&ray.need(&["origin"])?)?;
        let direction = point(&ray.need(&["direction"])?)?;
        if direction == DVec3::ZERO {
            ray.fault("expected a direction, found 0");
            return None;
        }
        let hits = cursor.get(&["should_hit", "should hit"]).map_or(Some(true), |flag| flag.flag())?;
        let meeting = || {
            let part = |key: &str| point(&cursor.need(&[key])?);
            let t = cursor.need(&["t"])?.number()?;
            Some(ExpectedHit { t, p: part("p")?, gn: part("gn")?, sn: part("sn")? })
        };
        let expected = if hits { Some(meeting()?) } else { None };
        let threshold = cursor.get(&["threshold"]).map_or(Some(1e-5), |threshold| threshold.number())?;
        Some((TestKind::Intersection { origin, direction, expected, threshold }, self.surfaces_of(cursor)?))
    }
}

fn point(cursor: &JsonCursor) -> Option<DVec3> {
    numbers::<3>(cursor).map(DVec3::from)
}

fn direction(cursor: &JsonCursor) -> Option<DVec3> {
    let found = unit(point(cursor)?);
    if found.is_none() {
        cursor.fault("expected a direction, found 0");
    }
    found
}

/// Scene that holds these shapes.
fn scene(cursor: &JsonCursor, shapes: Node) -> Node {
    cursor.make_object([("pt", cursor.make_whole(1)), ("camera", cursor.make_object::<&str>([])), ("shapes", shapes)])
}
