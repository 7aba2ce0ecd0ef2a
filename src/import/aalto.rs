//! Scenes of the Aalto path tracer, a student's work: z up, meshes placed by their bounding boxes, a mirrored picture.
//!
//! ```text
//! camera     right = z × direction, up = direction × right: left and right are swapped, and stay so
//! placement  rotate about x, y, z → centre of the box to 0 → scale until the box is `height` high in z → midpoint
//! paths      end where they meet a light or nothing; lights are not sampled
//! surfaces   luminous: radiance = colour, both sides, paths end · specular: mirror · diffuse: matte_cone · transparent: dielectric
//! ```

use std::cell::RefCell;
use std::collections::BTreeMap;

use glam::{DVec3, Vec3};

use super::Dialect;
use super::context::{Content, ImportContext};
use super::json_cursor::JsonCursor;
use crate::error::Result;
use crate::math::Transform;
use crate::math::transform::unit;
use crate::reader::{Node, Value, unknown};

/// Dialect `aalto`.
pub const DIALECT: Dialect =
    Dialect { name: "aalto", about: "the Aalto path tracer's: focalPoint, mattness, meshes by midpoint and height", is, read };

fn is(content: &Content) -> bool {
    let Some(root) = content.tree() else { return false };
    let has_eye = root.child("camera").is_some_and(|camera| camera.child("focalPoint").is_some());
    let has_list = |key| matches!(root.child(key).map(|list| &list.value), Some(Value::Array(_)));
    root.child("pt").is_none() && (has_eye || has_list("materials") && has_list("objects"))
}

fn read(content: &Content, context: &ImportContext) -> Result<Option<Node>> {
    let root = JsonCursor::root(content.json(context)?, context);
    Ok(scene(&root))
}

fn scene(root: &JsonCursor) -> Option<Node> {
    root.leave_out_others(&["camera", "materials", "objects"]);
    let camera = root.need(&["camera"]).and_then(|cursor| Some((camera(&cursor), film(&cursor)?)));
    let materials = root.need(&["materials"]).and_then(|list| materials(&list));
    let meshes = Meshes::default();
    let shapes = root.need(&["objects"]).and_then(|list| {
        let shapes = list.items()?.into_iter().map(|cursor| object(&cursor, materials.as_deref()?, &meshes));
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

/// Integrator without light sampling, as in that program: lights are large in these scenes, and surfaces reflect into narrow cones.
/// A path ends where it meets a light; the depth limit is for paths that meet none.
fn integrator(root: &JsonCursor) -> Node {
    let limits = [("max_depth", root.make_whole(512)), ("roulette_depth", root.make_whole(16))];
    root.make_object([("type", root.make_text("path"))].into_iter().chain(limits))
}

fn film(camera: &JsonCursor) -> Option<Node> {
    let [width, height] = [camera.need(&["xReso"]), camera.need(&["yReso"])];
    Some(camera.make_object([("width", width?.same()), ("height", height?.same())]))
}

fn camera(cursor: &JsonCursor) -> Option<Node> {
    let corners = ["tlCorner", "brCorner"];
    let has_corners = !cursor.has("direction") && corners.iter().any(|key| cursor.has(key));
    let own = if has_corners { &corners[..] } else { &["direction", "xAngle", "yAngle"] };
    cursor.leave_out_others(&[&["focalPoint", "xReso", "yReso"], own].concat());
    let eye = cursor.need(&["focalPoint"]).and_then(|eye| Some((xyz(&eye)?, eye)));
    let window = if has_corners { between_corners(cursor, eye.as_ref()?.0) } else { by_angles(cursor) };
    let ((eye, eye_view), window) = (eye?, window?);
    let [x, y] = window.signs;
    let look_at = [
        ("from", eye_view.make_numbers([0.0; 3])),
        ("to", window.cursor.make_numbers(window.direction.to_array())),
        ("up", window.cursor.make_numbers([0.0, 0.0, 1.0])),
    ];
    let steps = [
        step(&window.cursor, "scale", window.cursor.make_numbers([x, y, 1.0])),
        step(&window.cursor, "look_at", window.cursor.make_object(look_at)),
        step(&eye_view, "translate", eye_view.make_numbers(eye.to_array())),
    ];
    let [horizontal, vertical] = window.angles;
    Some(cursor.make_object([("fov", vertical), ("horizontal_fov", horizontal), ("transform", cursor.make_array(steps))]))
}

/// View of the camera.
struct Window<'a> {
    cursor: JsonCursor<'a>,
    direction: DVec3,
    /// Signs of the horizontal and the vertical axis of the picture: −1 if it is mirrored along that axis, compared with an upright view.
    signs: [f64; 2],
    /// Full horizontal and vertical angle (degrees).
    angles: [Node; 2],
}

fn by_angles<'a>(camera: &JsonCursor<'a>) -> Option<Window<'a>> {
    let direction = camera.need(&["direction"]).and_then(|cursor| Some((xyz(&cursor)?, cursor)));
    let [horizontal, vertical] = [camera.need(&["xAngle"]), camera.need(&["yAngle"])];
    let (direction, cursor) = direction?;
    is_level(direction, &cursor)?;
    Some(Window { cursor, direction, signs: [-1.0, 1.0], angles: [horizontal?.same(), vertical?.same()] })
}

/// View of older files: the upper left and the lower right corner of the picture, on a plane in front of the eye.
fn between_corners<'a>(camera: &JsonCursor<'a>, eye: DVec3) -> Option<Window<'a>> {
    let [top_left, bottom_right] = ["tlCorner", "brCorner"].map(|key| camera.need(&[key]).and_then(|cursor| Some((xyz(&cursor)?, cursor))));
    let ((top_left, cursor), (bottom_right, _)) = (top_left?, bottom_right?);
    let (direction, diagonal) = (0.5 * (top_left + bottom_right) - eye, bottom_right - top_left);
    is_level(direction, &cursor)?;
    let ahead = unit(direction)?;
    let left = unit(DVec3::Z.cross(ahead))?;
    let (across, down) = (-diagonal.dot(left), -diagonal.dot(ahead.cross(DVec3::Z.cross(ahead)).normalize()));
    // Tolerance for the decimals of a file: six digits give the corners to a millionth.
    if diagonal.dot(ahead).abs() > 1e-5 * diagonal.length() {
        cursor.fault("the corners are not equally far from the focal point: off-axis views of this format are not imported");
        return None;
    }
    if across == 0.0 || down == 0.0 {
        cursor.fault("the corners have no area between them");
        return None;
    }
    let angle = |side: f64| cursor.make_number(2.0 * (0.5 * side.abs()).atan2(direction.length()).to_degrees());
    let angles = [angle(across), angle(down)];
    Some(Window { cursor, direction, signs: [across.signum(), down.signum()], angles })
}

/// Checks that the direction is not along z, which is up.
fn is_level(direction: DVec3, cursor: &JsonCursor) -> Option<()> {
    let level = direction.truncate() != glam::DVec2::ZERO;
    if !level {
        cursor.fault("expected a direction that is not along z, which is up");
    }
    level.then_some(())
}

/// A material of the scene, with the emission of its surfaces.
struct Surface {
    name: String,
    material: Node,
    emission: Option<Node>,
}

fn materials(list: &JsonCursor) -> Option<Vec<Option<Surface>>> {
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

fn surface(cursor: &JsonCursor, i: usize, name: String) -> Option<Surface> {
    if cursor.has("path") && !cursor.has("color") {
        cursor.fault("expected a material, found an object: those are listed in /objects");
        return None;
    }
    let color = cursor.need(&["color"]).and_then(|color| self::color(&color));
    let luminous = cursor.need(&["isLuminous"]).and_then(|cursor| flag(&cursor));
    let every = ["color", "isLuminous", "type", "comment", "index", "colorRem"];
    remark_old_keys(cursor, i);
    if luminous? {
        cursor.leave_out_others(&every);
        let emission = [("radiance", color?), ("two_sided", cursor.make_flag(true))];
        let black = cursor.make_object([("type", cursor.make_text("diffuse")), ("albedo", cursor.make_whole(0))]);
        return Some(Surface { name, material: black, emission: Some(cursor.make_object(emission)) });
    }
    let kind = cursor.need(&["type"])?;
    let (model, own): (_, Option<(_, &[&str])>) = match kind.text()? {
        "specular" => ("mirror", None),
        "diffuse" => ("matte_cone", Some(("mattness", &["mattness"]))),
        "transparent" => ("dielectric", Some(("eta", &["refIndex", "reflIndex"]))),
        other => {
            kind.fault(unknown("material type", other, &["specular", "diffuse", "transparent"]));
            return None;
        }
    };
    cursor.leave_out_others(&[&every[..], own.map_or(&[], |(_, keys)| keys)].concat());
    let mut members = vec![("type", kind.make_text(model)), ("color", color?)];
    if let Some((key, keys)) = own {
        members.push((key, cursor.need(keys)?.same()));
    }
    Some(Surface { name, material: cursor.make_object(members), emission: None })
}

/// Notes keys of older files that have no effect, if they disagree with the keys that have.
fn remark_old_keys(cursor: &JsonCursor, i: usize) {
    let color = cursor.get(&["color"]).map(|color| color.same().to_string());
    if let Some(old) = cursor.get(&["colorRem"]).filter(|old| color.is_some_and(|color| color != old.same().to_string())) {
        old.note("left out: the colour of a surface is \"color\"");
    }
    if let Some(index) = cursor.get(&["index"]).filter(|index| index.same().to_string() != i.to_string()) {
        index.note("left out: materials are counted in their order, from 0");
    }
}

/// Colour, clamped to 0 … 1 as that program does.
fn color(cursor: &JsonCursor) -> Option<Node> {
    cursor.leave_out_others(&["r", "g", "b"]);
    let channels = ["r", "g", "b"].map(|key| {
        let channel = cursor.need(&[key])?;
        let (found, taken) = (channel.number()?, channel.number()?.clamp(0.0, 1.0));
        if found != taken {
            channel.note(format!("{found} is taken as {taken}: colours lie between 0 and 1"));
        }
        Some(channel.make_number(taken))
    });
    let [r, g, b] = channels;
    Some(cursor.make_array([r?, g?, b?]))
}

/// A boolean of JSON, or one in quotes, as the dialect's description shows it.
fn flag(cursor: &JsonCursor) -> Option<bool> {
    match cursor.is_text().then(|| cursor.text()).flatten() {
        Some("true") => Some(true),
        Some("false") => Some(false),
        _ => cursor.flag(),
    }
}

fn object(cursor: &JsonCursor, materials: &[Option<Surface>], meshes: &Meshes) -> Option<Node> {
    let keys = ["type", "path", "materialIndex", "midpoint", "midPoint", "height", "xrot", "yrot", "zrot", "comment"];
    cursor.leave_out_others(&keys);
    let kind = cursor.need(&["type"]).and_then(|kind| match kind.text()? {
        "mesh" => Some(()),
        other => {
            kind.fault(unknown("object type", other, &["mesh"]));
            None
        }
    });
    let path = cursor.need(&["path"]).and_then(|path| path.text().map(|text| (text, path)));
    let surface = cursor.need(&["materialIndex"]).and_then(|index| material_at(&index, materials));
    let placement = MeshPlacement::of(cursor);
    let ((path, path_view), surface, placement) = (path?, surface?, placement?);
    kind?;
    let steps = match meshes.positions(cursor, path) {
        // The builder of the scene reports what is wrong with the file.
        None => vec![],
        Some(positions) => placement.steps(cursor, path, &positions)?,
    };
    let mut members = vec![
        ("type", cursor.make_text("mesh")),
        ("file", path_view.same()),
        ("material", cursor.make_text(&surface.name)),
        ("transform", cursor.make_array(steps)),
    ];
    let comment = cursor.get(&["comment"]).filter(|comment| comment.is_text());
    members.extend(comment.map(|comment| ("name", comment.same())));
    members.extend(surface.emission.clone().map(|emission| ("emission", emission)));
    Some(cursor.make_object(members))
}

/// Material of an index; `None` also if the material itself has a fault, which is reported there.
fn material_at<'m>(index: &JsonCursor, materials: &'m [Option<Surface>]) -> Option<&'m Surface> {
    let i = index.whole()?;
    if i >= materials.len() as u64 {
        index.fault(format!("expected the number of a material, below {}, found {i}", materials.len()));
    }
    materials.get(i as usize)?.as_ref()
}

/// Placement of a mesh.
struct MeshPlacement<'a> {
    /// Rotations about x, y and z, in this order (degrees).
    turns: [(f64, JsonCursor<'a>); 3],
    height: (f64, JsonCursor<'a>),
    midpoint: (DVec3, JsonCursor<'a>),
}

impl<'a> MeshPlacement<'a> {
    fn of(object: &JsonCursor<'a>) -> Option<MeshPlacement<'a>> {
        let number = |key: &str| object.need(&[key]).and_then(|cursor| Some((cursor.number()?, cursor)));
        let turns = ["xrot", "yrot", "zrot"].map(number);
        let midpoint = object.need(&["midpoint", "midPoint"]).and_then(|cursor| Some((xyz(&cursor)?, cursor)));
        let height = number("height").and_then(|(height, cursor)| {
            if height <= 0.0 {
                cursor.fault(format!("expected a number above 0, found {height}"));
            }
            (height > 0.0).then_some((height, cursor))
        });
        let [x, y, z] = turns;
        Some(MeshPlacement { turns: [x?, y?, z?], height: height?, midpoint: midpoint? })
    }

    /// Steps of the transform that places a mesh.
    fn steps(&self, object: &JsonCursor, path: &str, positions: &[Vec3]) -> Option<Vec<Node>> {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let (mut rotation, mut steps) = (Transform::IDENTITY, vec![]);
        for (axis, (degrees, cursor)) in axes.into_iter().zip(&self.turns).filter(|(_, (degrees, _))| *degrees != 0.0) {
            rotation = rotation.then(&Transform::rotate(axis, *degrees).ok()?);
            let turn = [("axis", cursor.make_numbers(axis.to_array())), ("degrees", cursor.make_number(*degrees))];
            steps.push(step(cursor, "rotate", cursor.make_object(turn)));
        }
        let rotated = positions.iter().map(|p| rotation.point(p.as_dvec3()));
        let (low, high) = rotated.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let (height, height_view) = &self.height;
        // Height that the rounding of the file's numbers may leave of a height of zero.
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

/// Vertices of the meshes read so far, by path; `None` for files that cannot be read.
#[derive(Default)]
struct Meshes(RefCell<BTreeMap<String, Option<Vec<Vec3>>>>);

impl Meshes {
    fn positions(&self, object: &JsonCursor, path: &str) -> Option<Vec<Vec3>> {
        let files = &object.context().files;
        let read = || if files.why_not(path).is_none() { files.mesh(path).ok() } else { None };
        let mut all = self.0.borrow_mut();
        all.entry(path.to_owned()).or_insert_with(|| read().map(|(mesh, _)| mesh.positions)).clone()
    }
}

fn step(cursor: &JsonCursor, key: &str, value: Node) -> Node {
    cursor.make_object([(key, value)])
}

fn xyz(cursor: &JsonCursor) -> Option<DVec3> {
    cursor.leave_out_others(&["x", "y", "z"]);
    let [x, y, z] = ["x", "y", "z"].map(|key| cursor.need(&[key]).and_then(|number| number.number()));
    Some(DVec3::new(x?, y?, z?))
}
