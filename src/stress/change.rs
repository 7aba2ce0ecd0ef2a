//! Changes of a scene that must not change its picture: each edits the scene file as a user would.

use glam::{DMat3, DVec3};
use serde_json::{Value, json};

use super::mesh;
use crate::describe::{self, Files, Light, Scene, Shape};
use crate::error::{Error, Result};
use crate::format::{Coefficient, Color, TextureSpace};
use crate::reader::{Node, from_json};

/// A change of a scene after which its picture must be the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// What is changed, in a few words.
    pub name: String,
    /// What a range of changes of this kind is stated for, and the place of this change in it.
    pub range: Option<(Range, f64)>,
    /// Whether the picture must have the same bits.
    pub keeps_bits: bool,
    /// The edit.
    pub edit: Edit,
}

/// Kind of changes for which a safe range is stated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// Factor of all lengths.
    Size,
    /// Distance from the origin, in diameters of the scene.
    Distance,
    /// Distance of a far object, in diameters of the scene.
    FarObject,
}

/// How the scene file is edited.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edit {
    /// Nothing: the scene as it is.
    None,
    /// Everything is placed elsewhere, the camera included.
    Place(Similarity),
    /// A small black ball is added, behind the camera.
    FarObject {
        /// Centre (m).
        center: DVec3,
        /// Radius (m).
        radius: f64,
    },
    /// Shapes are listed in reverse order, and so are the triangles of their meshes.
    Reverse,
    /// The largest triangle of each mesh is divided into thousands that lie in its plane.
    Refine,
}

/// A transform x → scale · turn · x + shift that keeps angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Similarity {
    /// Factor of all lengths, above 0.
    pub scale: f64,
    /// Orthogonal matrix; a determinant of −1 mirrors.
    pub turn: DMat3,
    /// Displacement (m).
    pub shift: DVec3,
}

impl Similarity {
    /// No change.
    pub const IDENTITY: Similarity = Similarity { scale: 1.0, turn: DMat3::IDENTITY, shift: DVec3::ZERO };

    /// Image of a point.
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.scale * (self.turn * p) + self.shift
    }

    /// The change that undoes this one.
    fn inverse(&self) -> Similarity {
        let (scale, turn) = (1.0 / self.scale, self.turn.transpose());
        Similarity { scale, turn, shift: -scale * (turn * self.shift) }
    }

    /// The step of a transform in a scene file.
    fn step(&self) -> Value {
        let rows = (self.turn * self.scale).transpose();
        let row = |v: DVec3, last: f64| [v.x, v.y, v.z, last];
        let s = self.shift;
        let matrix = [row(rows.x_axis, s.x), row(rows.y_axis, s.y), row(rows.z_axis, s.z), [0.0, 0.0, 0.0, 1.0]];
        json!({ "matrix": matrix.concat() })
    }

    /// The rotation or reflection alone: how directions change.
    fn turned(&self) -> Similarity {
        Similarity { scale: 1.0, shift: DVec3::ZERO, ..*self }
    }
}

/// All changes, for a scene of this size.
///
/// - `center`, `radius`: a sphere around the scene (m)
/// - `ahead`: direction in which the camera looks
/// - `mirrors`: whether the scene can be mirrored, see [`can_be_mirrored`]
pub fn all(center: DVec3, radius: f64, ahead: DVec3, mirrors: bool) -> Vec<Change> {
    let identity = Similarity::IDENTITY;
    let placed = |name: String, range, keeps_bits, place| Change { name, range, keeps_bits, edit: Edit::Place(place) };
    let mut changes = vec![Change { name: "as it is".into(), range: None, keeps_bits: true, edit: Edit::None }];
    for k in (-6..=6).filter(|k| *k != 0) {
        let scale = 10f64.powi(k);
        changes.push(placed(format!("size x 1e{k}"), Some((Range::Size, scale)), false, Similarity { scale, ..identity }));
    }
    for k in [-20, -7, 7, 20] {
        let scale = 2f64.powi(k);
        changes.push(placed(format!("size x 2^{k}"), Some((Range::Size, scale)), true, Similarity { scale, ..identity }));
    }
    // A direction without equal or zero coordinates, so that all are rounded, each in its own way.
    let away = DVec3::new(0.813, 0.466, -0.349).normalize();
    for k in 0..=7 {
        let distance = 10f64.powi(k);
        let shift = away * (2.0 * radius * distance);
        changes.push(placed(format!("1e{k} diameters away"), Some((Range::Distance, distance)), false, Similarity { shift, ..identity }));
    }
    let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -0.7).normalize(), 1.0);
    changes.push(placed("turned by 57 degrees".into(), None, false, Similarity { turn, ..identity }));
    let mirror = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
    changes.extend(mirrors.then(|| placed("mirrored".into(), None, false, Similarity { turn: mirror, ..identity })));
    let cycle = DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X);
    changes.push(placed("axes x y z become y z x".into(), None, false, Similarity { turn: cycle, ..identity }));
    changes.push(placed("axes x y z become z x y".into(), None, false, Similarity { turn: cycle.transpose(), ..identity }));
    for k in 1..=6 {
        let distance = 10f64.powi(k);
        for (word, size) in [("an object", 0.1), ("a tiny object", 1e-5)] {
            let edit = Edit::FarObject { center: center - ahead * (2.0 * radius * distance), radius: size * radius };
            changes.push(Change {
                name: format!("{word} 1e{k} diameters away"),
                range: Some((Range::FarObject, distance)),
                keeps_bits: false,
                edit,
            });
        }
    }
    changes.push(Change { name: "shapes and triangles in reverse order".into(), range: None, keeps_bits: false, edit: Edit::Reverse });
    changes.push(Change { name: "largest triangles divided into thousands".into(), range: None, keeps_bits: false, edit: Edit::Refine });
    changes
}

/// Whether a mirrored scene can be written: no lamp may have a measured profile or a picture, which show one way round only.
pub fn can_be_mirrored(scene: &Scene) -> bool {
    !scene.lights.iter().any(|light| match light {
        Light::Point(point) => point.profile.is_some(),
        Light::Spot(spot) => spot.image.is_some(),
        Light::Directional(_) => false,
    })
}

impl Edit {
    /// The transform from the scene as it is to the changed one.
    pub fn place(&self) -> Similarity {
        if let Edit::Place(place) = self { *place } else { Similarity::IDENTITY }
    }

    /// The changed scene as JSON in pt's format.
    ///
    /// - `root`: the scene's JSON tree, which has the options of its integrator
    ///
    /// # Errors
    /// The errors of reading mesh files; `Internal` if the scene cannot be written as JSON.
    pub fn apply(&self, scene: &Scene, root: &Node, files: &Files) -> Result<Value> {
        let internal = |error| Error::Internal(format!("scene as JSON: {error}"));
        let mut changed = serde_json::to_value(scene).map_err(internal)?;
        if let Some(options) = root.child("integrator") {
            changed["integrator"] = serde_json::to_value(options).map_err(internal)?;
        }
        name_shapes(&mut changed, scene);
        match *self {
            Edit::None => {}
            Edit::Place(place) => place_all(&mut changed, scene, &place),
            Edit::FarObject { center, radius } => {
                let black = json!({ "type": "diffuse", "albedo": 0 });
                let ball =
                    json!({ "type": "sphere", "name": "far object", "center": center.to_array(), "radius": radius, "material": black });
                list(&mut changed, "shapes").push(ball);
            }
            Edit::Reverse => {
                mesh::edit_all(&mut changed, scene, files, mesh::reversed)?;
                list(&mut changed, "shapes").reverse();
            }
            Edit::Refine => mesh::edit_all(&mut changed, scene, files, mesh::refined)?,
        }
        Ok(changed)
    }
}

/// Gives every shape without a name the one that messages use for it, which depends on its place in the list.
fn name_shapes(changed: &mut Value, scene: &Scene) {
    name_list(&mut changed["shapes"], "/shapes", &scene.shapes);
    for (name, shapes) in &scene.groups {
        name_list(&mut changed["groups"][name.as_str()], &format!("/groups/{name}"), shapes);
    }
}

fn name_list(values: &mut Value, pointer: &str, shapes: &[Shape]) {
    for (i, (value, shape)) in values.as_array_mut().into_iter().flatten().zip(shapes).enumerate() {
        let pointer = format!("{pointer}/{i}");
        if let Shape::Group(group) = shape {
            name_list(&mut value["shapes"], &format!("{pointer}/shapes"), &group.shapes);
        }
        if shape.name().is_none() {
            value["name"] = json!(pointer);
        }
    }
}

/// The list of an object, created if it is missing.
fn list<'v>(object: &'v mut Value, key: &str) -> &'v mut Vec<Value> {
    let entry = &mut object[key];
    if !entry.is_array() {
        *entry = json!([]);
    }
    entry.as_array_mut().expect("just made")
}

/// Multiplies a number, or each number of a list.
fn multiply(object: &mut Value, key: &str, factor: f64) {
    match object.get_mut(key) {
        Some(Value::Array(numbers)) => numbers.iter_mut().for_each(|number| *number = json!(number.as_f64().map(|x| x * factor))),
        Some(value) => {
            if let Some(number) = value.as_f64() {
                *value = json!(number * factor);
            }
        }
        None => {}
    }
}

fn place_all(changed: &mut Value, scene: &Scene, place: &Similarity) {
    let camera = &mut changed["camera"];
    place_camera(camera, place);
    for key in ["lens_radius", "focus_distance", "height", "focal_length", "sensor", "aperture_diameter"] {
        multiply(camera, key, place.scale);
    }
    // The size of a sensor that is not mentioned, where it counts.
    let sensor = match &scene.camera {
        describe::Camera::Perspective(c) if c.focal_length.is_some() || c.f_number.is_some() => Some((c.sensor, c.sensor())),
        describe::Camera::Realistic(c) => Some((c.sensor, c.sensor())),
        _ => None,
    };
    if let Some((None, sensor)) = sensor {
        camera["sensor"] = json!(sensor.height() * place.scale);
    }
    if let describe::Camera::Realistic(described) = &scene.camera {
        camera["scale"] = json!(described.scale.get() * place.scale);
    }
    for shape in list(changed, "shapes") {
        list(shape, "transform").push(place.step());
    }
    let lights = list(changed, "lights");
    lights.iter_mut().zip(&scene.lights).for_each(|(light, described)| place_light(light, described, place));
    if scene.background.as_ref().is_some_and(|background| background.radiance.is_none()) {
        list(&mut changed["background"], "transform").push(place.turned().step());
    }
    if let Some(options) = changed.get_mut("integrator") {
        ["max_distance", "step_off"].into_iter().for_each(|key| multiply(options, key, place.scale));
        change_vector(options, "sun_direction", |v| place.turn * v);
    }
    // Densities of groups are placed by the instances. Media that are used in and outside of groups become two.
    let groups = changed.get_mut("groups").map(Value::take);
    place_materials(changed, place, true);
    if let Some(mut groups) = groups {
        let media = serde_json::to_value(&scene.media).unwrap_or_default();
        describe_in_place(&mut groups, &media);
        place_materials(&mut groups, place, false);
        changed["groups"] = groups;
    }
}

/// Replaces names of media by their descriptions.
fn describe_in_place(value: &mut Value, media: &Value) {
    match value {
        Value::Array(items) => items.iter_mut().for_each(|item| describe_in_place(item, media)),
        Value::Object(members) => {
            for (key, member) in members {
                let described = member.as_str().filter(|_| key == "medium").and_then(|name| media.get(name));
                match described.cloned() {
                    Some(described) => *member = described,
                    None => describe_in_place(member, media),
                }
            }
        }
        _ => {}
    }
}

/// Replaces `look_at` by a step of a transform, since a mirrored camera has no `look_at`.
fn place_camera(camera: &mut Value, place: &Similarity) {
    let look_at = camera.as_object_mut().expect("a camera").remove("look_at");
    let steps = list(camera, "transform");
    steps.extend(look_at.filter(|at| !at.is_null()).map(|at| json!({ "look_at": at })));
    steps.push(place.step());
}

/// Intensities grow with the square of lengths, so that irradiances stay.
fn place_light(light: &mut Value, described: &Light, place: &Similarity) {
    if !described.transform().is_identity() {
        // The light's own position and directions are changed below, in its own space, which must stay as it is.
        let steps = list(light, "transform");
        steps.insert(0, place.inverse().step());
        steps.push(place.step());
    }
    for key in ["position", "to"] {
        change_vector(light, key, |p| place.point(p));
    }
    for key in ["direction", "across", "up"] {
        change_vector(light, key, |v| place.turn * v);
    }
    // What has a default direction gets it written out, since the default would not turn with the scene.
    let mut turn_default = |key: &str, default: Option<DVec3>| {
        if let Some(default) = default.filter(|_| light.get(key).is_none()) {
            light[key] = json!((place.turn * default).to_array());
        }
    };
    let intensity = match described {
        Light::Point(point) => {
            let [axis, across] = point.axes();
            turn_default("direction", point.profile.as_ref().map(|_| axis));
            turn_default("across", point.profile.as_ref().map(|_| across));
            &point.intensity
        }
        Light::Spot(spot) => {
            turn_default("up", spot.image.as_ref().map(|_| spot.image_up()));
            &spot.intensity
        }
        Light::Directional(_) => return,
    };
    light["intensity"] = json!(intensity.linear().map(|i| i * place.scale * place.scale));
}

/// Divides a colour by a number.
fn divide_color(object: &mut serde_json::Map<String, Value>, key: &str, divisor: f64) {
    if let Some(color) = object.get(key).and_then(from_json::<Color<Coefficient>>) {
        object.insert(key.to_owned(), json!(color.linear().map(|c| c / divisor)));
    }
}

fn change_vector(object: &mut Value, key: &str, change: impl Fn(DVec3) -> DVec3) {
    let vector = object.get(key).cloned().and_then(|value| serde_json::from_value::<[f64; 3]>(value).ok());
    if let Some(vector) = vector {
        object[key] = json!(change(DVec3::from(vector)).to_array());
    }
}

/// Textures that vary over the position in the world, heights of bump maps, lengths of absorption and coefficients of media, wherever they
/// stand.
///
/// - `has_densities`: whether densities of media are moved, too
fn place_materials(value: &mut Value, place: &Similarity, has_densities: bool) {
    match value {
        Value::Array(items) => items.iter_mut().for_each(|item| place_materials(item, place, has_densities)),
        Value::Object(members) => {
            if members.get("on").is_some_and(|on| on == &json!(TextureSpace::Position)) {
                let steps = members.entry("transform").or_insert_with(|| json!([]));
                steps.as_array_mut().expect("a transform").push(place.step());
            }
            // The height of a bump map is a length, the factor of a normal map is none.
            if members.get("bump_map").is_some_and(|map| !map.is_null()) {
                let height = members.entry("scale").or_insert_with(|| json!(1.0));
                match height.as_f64() {
                    Some(number) => *height = json!(number * place.scale),
                    None => ["from", "to"].into_iter().for_each(|key| multiply(height, key, place.scale)),
                }
            }
            if members.get("type").is_some_and(|kind| kind == "homogeneous" || kind == "heterogeneous") {
                ["absorption", "scattering"].into_iter().for_each(|key| divide_color(members, key, place.scale));
            }
            if members.get("type").is_some_and(|kind| kind == "subsurface") {
                let scale = members.get("scale").and_then(Value::as_f64).unwrap_or(1.0);
                members.insert("scale".to_owned(), json!(scale * place.scale));
            }
            if let Some(Value::Object(density)) = members.get_mut("density").filter(|_| has_densities) {
                let steps = density.entry("transform").or_insert_with(|| json!([]));
                steps.as_array_mut().expect("a transform").push(place.step());
            }
            if let Some(absorption) = members.get_mut("absorption").filter(|absorption| absorption.is_object()) {
                multiply(absorption, "distance", place.scale);
            }
            members.values_mut().for_each(|member| place_materials(member, place, has_densities));
        }
        _ => {}
    }
}
