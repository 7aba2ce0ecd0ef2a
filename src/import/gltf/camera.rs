//! Cameras of glTF. A camera looks along −z of its node, as in pt.

use glam::{DMat4, DVec3};
use gltf::json::camera::Type;
use gltf::json::validation::Checked;

use super::document::Document;
use super::scene::transform;
use crate::import::json_cursor::JsonCursor;
use crate::import::view::ASPECT;
use crate::reader::Node;

impl Document<'_> {
    /// Camera, and the ratio of width to height of its picture; `None` with a fault noted.
    ///
    /// - `moments`: times and transforms of the node
    pub fn camera(&self, camera: &gltf::Camera, node: &gltf::Node, moments: &[(f64, DMat4)]) -> Option<(Node, f64)> {
        let at = self.item("cameras", camera.index());
        let location = self.item("nodes", node.index());
        let look_at = match moments {
            [(_, to_world)] => ("look_at", look_at(&location, to_world)),
            _ => ("transform", transform(&location, moments, |to_world| location.make_object([("look_at", look_at(&location, to_world))]))),
        };
        let json = self.gltf.as_json().cameras.get(camera.index())?;
        let is_orthographic = matches!(json.type_, Checked::Valid(Type::Orthographic));
        let lens_at = at.need(&[if is_orthographic { "orthographic" } else { "perspective" }])?;
        let (members, aspect) = if is_orthographic {
            let lens = json.orthographic.as_ref()?;
            let height = lens_at.make_number(2.0 * f64::from(lens.ymag));
            let kind = lens_at.make_text("orthographic");
            (vec![("type", kind), ("height", height), look_at], f64::from(lens.xmag) / f64::from(lens.ymag))
        } else {
            let lens = json.perspective.as_ref()?;
            let fov = lens_at.make_number(f64::from(lens.yfov).to_degrees());
            (vec![("fov", fov), look_at], lens.aspect_ratio.map_or(ASPECT, f64::from))
        };
        if !(aspect > 0.0 && aspect.is_finite()) {
            lens_at.fault("a picture without width or height");
            return None;
        }
        Some((location.make_object(members), aspect))
    }
}

/// Position and direction of a camera or light. They have no size, so only the directions of the node's transform count.
pub fn look_at(location: &JsonCursor, to_world: &DMat4) -> Node {
    let from = to_world.transform_point3(DVec3::ZERO);
    let towards = |axis: DVec3| to_world.transform_vector3(axis).normalize_or(axis);
    location.make_object([
        ("from", location.make_numbers(from.to_array())),
        ("to", location.make_numbers((from + towards(DVec3::NEG_Z)).to_array())),
        ("up", location.make_numbers(towards(DVec3::Y).to_array())),
    ])
}
