//! Lights without a surface (KHR_lights_punctual). They shine down −z of their node; its scale does not affect them.
//!
//! The file has photometric units: candela and lux. pt has radiometric ones. All light is converted with 683 lm = 1 W, whatever its
//! colour, as the importers of other programs do, so that a scene is as bright after a detour through glTF as before. Emission of
//! surfaces is not converted, for the same reason.

use glam::{DMat4, DVec3};

use super::camera::look_at;
use super::document::Document;
use super::scene::transform;
use super::texture::numbers;
use crate::import::json_cursor::JsonCursor;
use crate::math::photometry::LUMENS_PER_WATT;
use crate::reader::Node;

impl<'a> Document<'a> {
    /// Light of a node, if it has one; a fault is noted if it is invalid.
    ///
    /// - `moments`: times and transforms of the node
    pub fn light(&self, node: &gltf::Node, moments: &[(f64, DMat4)]) -> Option<Node> {
        let reference = self.item("nodes", node.index()).get(&["extensions"])?.get(&["KHR_lights_punctual"])?.need(&["light"])?;
        let index = reference.whole()?;
        let all = self.root.get(&["extensions"]).and_then(|all| all.get(&["KHR_lights_punctual"]));
        let Some(light) = all.as_ref().and_then(|all| all.get(&["lights"])).and_then(|lights| lights.get(&[&index.to_string()])) else {
            reference.fault(format!("light {index}, which is not there"));
            return None;
        };
        self.note(&all?, format!("light in candela and lux becomes watts: {LUMENS_PER_WATT} lm = 1 W"));
        self.described(&light, node, moments)
    }

    fn described(&self, light: &JsonCursor<'a>, node: &gltf::Node, moments: &[(f64, DMat4)]) -> Option<Node> {
        let color = light.get(&["color"]).and_then(|color| numbers(&color)).unwrap_or([1.0; 3]);
        let intensity = light.get(&["intensity"]).map_or(Some(1.0), |at| at.number())?;
        let watts = light.make_numbers(color.map(|c| c * intensity / LUMENS_PER_WATT));
        // A light that moves is placed by its transform alone.
        let to_world = if let [(_, to_world)] = moments { *to_world } else { DMat4::IDENTITY };
        let from = to_world.transform_point3(DVec3::ZERO);
        let axis = to_world.transform_vector3(DVec3::NEG_Z).normalize_or(DVec3::NEG_Z);
        let position = ("position", light.make_numbers(from.to_array()));
        let direction = ("direction", light.make_numbers(axis.to_array()));
        if light.has("range") {
            self.note(light, "the range of a light is left out: it falls off with the square of the distance, and never ends");
        }
        let kind = light.need(&["type"])?;
        let name = light.get(&["name"]).and_then(|name| name.text()).or(node.name());
        let mut members: Vec<(&str, Node)> = name.map(|name| ("name", light.make_text(name))).into_iter().collect();
        members.push(("type", kind.same()));
        match kind.text()? {
            "directional" => members.extend([direction, ("irradiance", watts)]),
            "point" => members.extend([position, ("intensity", watts)]),
            "spot" => {
                let cone = light.get(&["spot"]);
                let angle = |key| cone.as_ref().and_then(|cone| cone.get(&[key])).and_then(|at| at.number());
                let outer = angle("outerConeAngle").unwrap_or(std::f64::consts::FRAC_PI_4);
                let inner = angle("innerConeAngle").unwrap_or(0.0);
                let cone = cone.as_ref().unwrap_or(light);
                let degrees = |angle: f64| cone.make_number(angle.to_degrees());
                members.extend([position, direction, ("intensity", watts)]);
                members.extend([("inner_angle", degrees(inner)), ("outer_angle", degrees(outer)), ("falloff", light.make_text("squared"))]);
            }
            _ => {
                kind.expected("\"directional\", \"point\" or \"spot\"");
                return None;
            }
        }
        if moments.len() > 1 {
            let step = |to_world: &DMat4| light.make_object([("look_at", look_at(light, to_world))]);
            members.push(("transform", transform(light, moments, step)));
        }
        Some(light.make_object(members))
    }
}
