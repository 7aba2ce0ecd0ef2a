//! Scenes of the Aalto path tracer, a student's work: z up, meshes placed by their bounding boxes, a mirrored picture.
//!
//! ```text
//! camera     right = z × direction, up = direction × right: left and right are swapped, and stay so
//! placement  rotate about x, y, z → centre of the box to 0 → scale until the box is `height` high in z → midpoint
//! paths      follow chance until they meet a light or nothing
//! surfaces   luminous: radiance = colour, both sides, paths end · specular: mirror · diffuse: matte_cone · transparent: dielectric
//! ```

use std::cell::RefCell;
use std::collections::BTreeMap;

use glam::{DVec3, Vec3};

use super::Dialect;
use super::foreign::{Content, Foreign};
use super::view::View;
use crate::error::Result;
use crate::math::Transform;
use crate::math::transform::unit;
use crate::reader::{Node, Value, unknown};

pub const DIALECT: Dialect =
    Dialect { name: "aalto", about: "the Aalto path tracer's: focalPoint, mattness, meshes by midpoint and height", is, read };

fn is(content: &Content) -> bool {
    let Some(root) = content.tree() else { return false };
    let has_eye = root.child("camera").is_some_and(|camera| camera.child("focalPoint").is_some());
    let has_list = |key| matches!(root.child(key).map(|list| &list.value), Some(Value::Array(_)));
    root.child("pt").is_none() && (has_eye || has_list("materials") && has_list("objects"))
}

fn read(content: &Content, foreign: &Foreign) -> Result<Option<Node>> {
    let root = View::root(content.json(foreign)?, foreign);
    Ok(scene(&root))
}

fn scene(root: &View) -> Option<Node> {
    root.leave_out_others(&["camera", "materials", "objects"]);
    let camera = root.need(&["camera"]).and_then(|view| Some((camera(&view), film(&view)?)));
    let materials = root.need(&["materials"]).and_then(|list| materials(&list));
    let meshes = Meshes::default();
    let shapes = root.need(&["objects"]).and_then(|list| {
        let shapes = list.items()?.into_iter().map(|view| object(&view, materials.as_deref()?, &meshes));
        Some(list.make_array(shapes.collect::<Vec<_>>().into_iter().flatten()))
    });
    let ((camera, film), materials, shapes) = (camera?, materials?, shapes?);
    let described = root.make_object(materials.into_iter().flatten().map(|surface| (surface.name, surface.material)));
    Some(root.make_object([
        ("pt", root.make_whole(1)),
        ("camera", camera?),
        ("film", film),
        ("integrator", integrator(root)),
        ("materials", described),
        ("shapes", shapes),
    ]))
}

/// Light is found by chance, as there: lights are large in these scenes, and surfaces reflect into narrow cones. A path ends where it
/// meets a light; the limits are for those that find none.
fn integrator(root: &View) -> Node {
    let limits = [("max_depth", root.make_whole(512)), ("roulette_depth", root.make_whole(16))];
    root.make_object([("type", root.make_text("path"))].into_iter().chain(limits))
}

fn film(camera: &View) -> Option<Node> {
    let [width, height] = [camera.need(&["xReso"]), camera.need(&["yReso"])];
    Some(camera.make_object([("width", width?.same()), ("height", height?.same())]))
}

fn camera(view: &View) -> Option<Node> {
    let corners = ["tlCorner", "brCorner"];
    let has_corners = !view.has("direction") && corners.iter().any(|key| view.has(key));
    let own = if has_corners { &corners[..] } else { &["direction", "xAngle", "yAngle"] };
    view.leave_out_others(&[&["focalPoint", "xReso", "yReso"], own].concat());
    let eye = view.need(&["focalPoint"]).and_then(|eye| Some((xyz(&eye)?, eye)));
    let window = if has_corners { between_corners(view, eye.as_ref()?.0) } else { by_angles(view) };
    let ((eye, eye_view), window) = (eye?, window?);
    let [x, y] = window.signs;
    let look_at = [
        ("from", eye_view.make_numbers([0.0; 3])),
        ("to", window.view.make_numbers(window.direction.to_array())),
        ("up", window.view.make_numbers([0.0, 0.0, 1.0])),
    ];
    let steps = [
        step(&window.view, "scale", window.view.make_numbers([x, y, 1.0])),
        step(&window.view, "look_at", window.view.make_object(look_at)),
        step(&eye_view, "translate", eye_view.make_numbers(eye.to_array())),
    ];
    let [horizontal, vertical] = window.angles;
    Some(view.make_object([("fov", vertical), ("horizontal_fov", horizontal), ("transform", view.make_array(steps))]))
}

/// What the camera sees.
struct Window<'a> {
    view: View<'a>,
    direction: DVec3,
    /// −1 where the picture is mirrored, across and up, as an upright and unmirrored one would be.
    signs: [f64; 2],
    /// Horizontal and vertical, full, in degrees.
    angles: [Node; 2],
}

fn by_angles<'a>(camera: &View<'a>) -> Option<Window<'a>> {
    let direction = camera.need(&["direction"]).and_then(|view| Some((xyz(&view)?, view)));
    let [horizontal, vertical] = [camera.need(&["xAngle"]), camera.need(&["yAngle"])];
    let (direction, view) = direction?;
    is_level(direction, &view)?;
    Some(Window { view, direction, signs: [-1.0, 1.0], angles: [horizontal?.same(), vertical?.same()] })
}

/// Older files: the upper left and the lower right corner of what is seen, on a plane before the eye.
fn between_corners<'a>(camera: &View<'a>, eye: DVec3) -> Option<Window<'a>> {
    let [top_left, bottom_right] = ["tlCorner", "brCorner"].map(|key| camera.need(&[key]).and_then(|view| Some((xyz(&view)?, view))));
    let ((top_left, view), (bottom_right, _)) = (top_left?, bottom_right?);
    let (direction, diagonal) = (0.5 * (top_left + bottom_right) - eye, bottom_right - top_left);
    is_level(direction, &view)?;
    let ahead = unit(direction)?;
    let left = unit(DVec3::Z.cross(ahead))?;
    let (across, down) = (-diagonal.dot(left), -diagonal.dot(ahead.cross(DVec3::Z.cross(ahead)).normalize()));
    // Decimals of a file; with six digits the corners are told to a millionth.
    if diagonal.dot(ahead).abs() > 1e-5 * diagonal.length() {
        view.fault("the corners are not equally far from the focal point: pt has no oblique pictures");
        return None;
    }
    if across == 0.0 || down == 0.0 {
        view.fault("the corners have no area between them");
        return None;
    }
    let angle = |side: f64| view.make_number(2.0 * (0.5 * side.abs()).atan2(direction.length()).to_degrees());
    let angles = [angle(across), angle(down)];
    Some(Window { view, direction, signs: [across.signum(), down.signum()], angles })
}

/// Up is z, and no picture has it along its axis.
fn is_level(direction: DVec3, view: &View) -> Option<()> {
    let level = direction.truncate() != glam::DVec2::ZERO;
    if !level {
        view.fault("expected a direction that is not along z, which is up");
    }
    level.then_some(())
}

/// A material of the scene, and the light of what wears it.
struct Surface {
    name: String,
    material: Node,
    emission: Option<Node>,
}

fn materials(list: &View) -> Option<Vec<Option<Surface>>> {
    let items = list.items()?;
    if items.is_empty() {
        list.fault("expected at least one material");
    }
    let mut found: Vec<Option<Surface>> = vec![];
    for (i, item) in items.iter().enumerate() {
        let taken = |name: &str| found.iter().flatten().any(|other| other.name == name);
        let comment = item.get(&["comment"]).and_then(|comment| comment.is_text().then(|| comment.text()).flatten());
        let mut name = comment.filter(|text| !text.is_empty()).map_or_else(|| format!("material {i}"), str::to_owned);
        while taken(&name) {
            name = format!("{name} ({i})");
        }
        let surface = surface(item, i, name);
        found.push(surface);
    }
    Some(found)
}

fn surface(view: &View, i: usize, name: String) -> Option<Surface> {
    if view.has("path") && !view.has("color") {
        view.fault("expected a material, found an object: those are listed in /objects");
        return None;
    }
    let color = view.need(&["color"]).and_then(|color| self::color(&color));
    let luminous = view.need(&["isLuminous"]).and_then(|view| flag(&view));
    let every = ["color", "isLuminous", "type", "comment", "index", "colorRem"];
    remark_old_keys(view, i);
    if luminous? {
        view.leave_out_others(&every);
        let emission = [("radiance", color?), ("two_sided", view.make_flag(true))];
        let black = view.make_object([("type", view.make_text("diffuse")), ("albedo", view.make_whole(0))]);
        return Some(Surface { name, material: black, emission: Some(view.make_object(emission)) });
    }
    let kind = view.need(&["type"])?;
    let (model, own): (_, Option<(_, &[&str])>) = match kind.text()? {
        "specular" => ("mirror", None),
        "diffuse" => ("matte_cone", Some(("mattness", &["mattness"]))),
        "transparent" => ("dielectric", Some(("eta", &["refIndex", "reflIndex"]))),
        other => {
            kind.fault(unknown("material type", other, &["specular", "diffuse", "transparent"]));
            return None;
        }
    };
    view.leave_out_others(&[&every[..], own.map_or(&[], |(_, keys)| keys)].concat());
    let mut members = vec![("type", kind.make_text(model)), ("color", color?)];
    if let Some((key, keys)) = own {
        members.push((key, view.need(keys)?.same()));
    }
    Some(Surface { name, material: view.make_object(members), emission: None })
}

/// Keys of older files that change nothing; it is told where they say something else than what holds.
fn remark_old_keys(view: &View, i: usize) {
    let color = view.get(&["color"]).map(|color| color.same().to_string());
    if let Some(old) = view.get(&["colorRem"]).filter(|old| color.is_some_and(|color| color != old.same().to_string())) {
        old.note("left out: the colour of a surface is \"color\"");
    }
    if let Some(index) = view.get(&["index"]).filter(|index| index.same().to_string() != i.to_string()) {
        index.note("left out: materials are counted in their order, from 0");
    }
}

/// Within 0 and 1, as all of them are taken.
fn color(view: &View) -> Option<Node> {
    view.leave_out_others(&["r", "g", "b"]);
    let channels = ["r", "g", "b"].map(|key| {
        let channel = view.need(&[key])?;
        let (found, taken) = (channel.number()?, channel.number()?.clamp(0.0, 1.0));
        if found != taken {
            channel.note(format!("{found} is taken as {taken}: colours lie between 0 and 1"));
        }
        Some(channel.make_number(taken))
    });
    let [r, g, b] = channels;
    Some(view.make_array([r?, g?, b?]))
}

/// As JSON has it, or in quotes, as the dialect's description shows it.
fn flag(view: &View) -> Option<bool> {
    match view.is_text().then(|| view.text()).flatten() {
        Some("true") => Some(true),
        Some("false") => Some(false),
        _ => view.flag(),
    }
}

fn object(view: &View, materials: &[Option<Surface>], meshes: &Meshes) -> Option<Node> {
    let keys = ["type", "path", "materialIndex", "midpoint", "midPoint", "height", "xrot", "yrot", "zrot", "comment"];
    view.leave_out_others(&keys);
    let kind = view.need(&["type"]).and_then(|kind| match kind.text()? {
        "mesh" => Some(()),
        other => {
            kind.fault(unknown("object type", other, &["mesh"]));
            None
        }
    });
    let path = view.need(&["path"]).and_then(|path| path.text().map(|text| (text, path)));
    let surface = view.need(&["materialIndex"]).and_then(|index| chosen(&index, materials));
    let place = Place::of(view);
    let ((path, path_view), surface, place) = (path?, surface?, place?);
    kind?;
    let steps = match meshes.positions(view, path) {
        // Whoever builds the scene says what is wrong with the file.
        None => vec![],
        Some(positions) => place.steps(view, path, &positions)?,
    };
    let mut members = vec![
        ("type", view.make_text("mesh")),
        ("file", path_view.same()),
        ("material", view.make_text(&surface.name)),
        ("transform", view.make_array(steps)),
    ];
    let comment = view.get(&["comment"]).filter(|comment| comment.is_text());
    members.extend(comment.map(|comment| ("name", comment.same())));
    members.extend(surface.emission.clone().map(|emission| ("emission", emission)));
    Some(view.make_object(members))
}

/// `None` also where the material itself is at fault, which is told there.
fn chosen<'m>(index: &View, materials: &'m [Option<Surface>]) -> Option<&'m Surface> {
    let i = index.whole()?;
    if i >= materials.len() as u64 {
        index.fault(format!("expected the number of a material, below {}, found {i}", materials.len()));
    }
    materials.get(i as usize)?.as_ref()
}

/// Where a mesh goes.
struct Place<'a> {
    /// About x, y and z, in this order (degrees).
    turns: [(f64, View<'a>); 3],
    height: (f64, View<'a>),
    midpoint: (DVec3, View<'a>),
}

impl<'a> Place<'a> {
    fn of(object: &View<'a>) -> Option<Place<'a>> {
        let number = |key: &str| object.need(&[key]).and_then(|view| Some((view.number()?, view)));
        let turns = ["xrot", "yrot", "zrot"].map(number);
        let midpoint = object.need(&["midpoint", "midPoint"]).and_then(|view| Some((xyz(&view)?, view)));
        let height = number("height").and_then(|(height, view)| {
            if height <= 0.0 {
                view.fault(format!("expected a number above 0, found {height}"));
            }
            (height > 0.0).then_some((height, view))
        });
        let [x, y, z] = turns;
        Some(Place { turns: [x?, y?, z?], height: height?, midpoint: midpoint? })
    }

    /// The steps that bring a mesh there.
    fn steps(&self, object: &View, path: &str, positions: &[Vec3]) -> Option<Vec<Node>> {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let (mut rotation, mut steps) = (Transform::IDENTITY, vec![]);
        for (axis, (degrees, view)) in axes.into_iter().zip(&self.turns).filter(|(_, (degrees, _))| *degrees != 0.0) {
            rotation = rotation.then(&Transform::rotate(axis, *degrees).ok()?);
            let turn = [("axis", view.make_numbers(axis.to_array())), ("degrees", view.make_number(*degrees))];
            steps.push(step(view, "rotate", view.make_object(turn)));
        }
        let rotated = positions.iter().map(|p| rotation.point(p.as_dvec3()));
        let (low, high) = rotated.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let (height, height_view) = &self.height;
        // What the rounding of the file's numbers may leave of a height of zero.
        let noise = f64::from(f32::EPSILON) * low.abs().max(high.abs()).max_element();
        if high.z - low.z <= noise {
            height_view.fault(format!("{path} is flat in z as it is turned: no scale makes it {height} high"));
            return None;
        }
        let (midpoint, midpoint_view) = &self.midpoint;
        steps.extend([
            step(object, "translate", object.make_numbers((-0.5 * (low + high)).to_array())),
            step(height_view, "scale", height_view.make_number(height / (high.z - low.z))),
            step(midpoint_view, "translate", midpoint_view.make_numbers(midpoint.to_array())),
        ]);
        Some(steps)
    }
}

/// The vertices of the meshes read so far, by their paths; `None` for what cannot be read.
#[derive(Default)]
struct Meshes(RefCell<BTreeMap<String, Option<Vec<Vec3>>>>);

impl Meshes {
    fn positions(&self, object: &View, path: &str) -> Option<Vec<Vec3>> {
        let files = &object.foreign().files;
        let read = || if files.why_not(path).is_none() { files.mesh(path).ok() } else { None };
        let mut all = self.0.borrow_mut();
        all.entry(path.to_owned()).or_insert_with(|| read().map(|(mesh, _)| mesh.positions)).clone()
    }
}

fn step(view: &View, key: &str, value: Node) -> Node {
    view.make_object([(key, value)])
}

fn xyz(view: &View) -> Option<DVec3> {
    view.leave_out_others(&["x", "y", "z"]);
    let [x, y, z] = ["x", "y", "z"].map(|key| view.need(&[key]).and_then(|number| number.number()));
    Some(DVec3::new(x?, y?, z?))
}
