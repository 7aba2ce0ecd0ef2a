//! Generated scenes in which several rarer effects and shapes meet: motion, lenses and other cameras, dispersion, thin films and media; meshes that
//! change their form, are subdivided or displaced, ribbons and tubes, open shapes, and instances of a group.

use std::sync::Arc;

use glam::{DVec3, Vec3Swizzles};
use serde_json::{Value, json};

use super::{Dice, agree};
use crate::light_tracer::built;

/// Number of scenes: two with each camera.
pub const SCENES: u64 = 2 * CAMERAS;
const CAMERAS: u64 = 6;

#[test]
fn methods_agree_where_rare_effects_meet() {
    for scene in 0..SCENES {
        let world = built(&combined(scene).to_string()).world;
        agree(&format!("combined scene {scene}"), &Arc::new(world), 2);
    }
}

/// A room that is open towards the camera, with a lamp, two clear bodies and a matte one, of which some move.
fn combined(scene: u64) -> Value {
    let mut dice = Dice::new(3000 + scene);
    let mut shapes: Vec<Value> =
        [DVec3::NEG_X, DVec3::X, DVec3::NEG_Y, DVec3::Y, DVec3::NEG_Z].map(|outwards| wall(outwards, &mut dice)).into();
    let lamp = json!({ "type": "quad", "size": [1.2, 1], "emission": color(&mut dice, 1.0, 4.0) });
    let down = json!([{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 0.8, 0] }]);
    shapes.push(placed(lamp, down, scene.is_multiple_of(3), &mut dice));
    for (thing, place) in [[-0.5, -0.5, -0.2], [0.45, -0.4, 0.0], [0.0, -0.6, 0.4]].into_iter().enumerate() {
        let mut body = match thing {
            2 => matte_body(scene as u32 + 2, &mut dice),
            _ => json!({ "type": "sphere", "radius": dice.within(0.2, 0.4), "material": clear(&mut dice) }),
        };
        if dice.of(3) == 0 && body["material"]["type"] == "dielectric" {
            body["medium"] = medium(&mut dice);
        }
        // What contains a medium cannot move.
        let moves = dice.of(2) == 0 && body.get("medium").is_none();
        shapes.push(placed(body, json!([{ "translate": place }]), moves, &mut dice));
    }
    if dice.of(2) == 0 {
        shapes.push(json!({ "type": "box", "size": 0.7, "center": [0.2, 0.2, -0.4], "medium": medium(&mut dice) }));
    }
    let pair = [-0.12, 0.12].map(|x| json!({ "transform": [{ "scale": 0.5 }, { "translate": [x, 0, 0] }] }));
    let group = matte_body(scene as u32, &mut dice);
    let moves = dice.of(2) == 0;
    shapes.push(placed(
        json!({ "type": "instances", "group": "thing", "placements": pair }),
        json!([{ "translate": [-0.4, 0.3, -0.5] }]),
        moves,
        &mut dice,
    ));
    let mut scene = json!({ "pt": 1, "camera": camera(scene % CAMERAS, &mut dice), "shutter": { "open": 0.1, "close": 0.9 },
        "groups": { "thing": [group] }, "shapes": shapes });
    if dice.of(2) == 0 {
        scene["background"] = json!({ "radiance": color(&mut dice, 0.2, 0.8) });
    }
    scene
}

fn color(dice: &mut Dice, from: f64, to: f64) -> Value {
    json!([0; 3].map(|_| dice.within(from, to)))
}

/// A side of the cube from −1 to 1.
fn wall(outwards: DVec3, dice: &mut Dice) -> Value {
    let up = outwards.zxy().abs().to_array();
    let turned = json!({ "look_at": { "from": outwards.to_array(), "to": (2.0 * outwards).to_array(), "up": up } });
    json!({ "type": "quad", "size": 2, "transform": [turned], "material": { "type": "diffuse", "albedo": color(dice, 0.2, 0.8) } })
}

/// A shape with a place, which turns and goes somewhere near while the shutter is open if it moves.
fn placed(mut shape: Value, place: Value, moves: bool, dice: &mut Dice) -> Value {
    let mut steps = place;
    if moves {
        let axis = (dice.point(1.0) + DVec3::Y).to_array();
        let turn = json!([{ "rotate": { "axis": axis, "degrees": dice.within(10.0, 60.0) } }, { "translate": dice.point(0.1).to_array() }]);
        let keyframes = json!({ "keyframes": [{ "time": 0 }, { "time": 1, "transform": turn }] });
        steps.as_array_mut().expect("steps").insert(0, keyframes);
    }
    shape["transform"] = steps;
    shape
}

/// Glass with dispersion, or a thin film: on metal, plastic, a pane, or alone.
fn clear(dice: &mut Dice) -> Value {
    match dice.of(7) {
        0 => json!({ "type": "dielectric", "glass": "SF11" }),
        1 => json!({ "type": "dielectric", "eta": dice.within(1.3, 1.8), "abbe": dice.within(10.0, 40.0), "roughness": 0.5 }),
        2 => json!({ "type": "conductor", "metal": "Fe", "film": { "eta": 2.2, "thickness": dice.within(30.0, 200.0) }, "roughness": 0.5 }),
        3 => json!({ "type": "thin_film", "pane": dice.within(1.3, 1.8), "eta": 1.4, "thickness": dice.within(100.0, 600.0) }),
        4 => json!({ "type": "conductor", "color": color(dice, 0.1, 0.9), "film": { "eta": 1.6, "thickness": 250 }, "roughness": 0.5 }),
        5 => json!({ "type": "principled", "metallic": 0.3, "iridescence": 0.7, "iridescence_thickness": dice.within(100.0, 600.0) }),
        _ => json!({ "type": "thin_film", "thickness": dice.within(100.0, 600.0) }),
    }
}

/// A matte body with about the radius 0.3, of each kind in turn.
fn matte_body(kind: u32, dice: &mut Dice) -> Value {
    let mut corners = || {
        let regular = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
        json!(regular.map(|corner| (DVec3::from(corner) * 0.2 + dice.point(0.1)).to_array()))
    };
    let tetrahedron = json!({ "type": "mesh", "positions": corners(), "triangles": [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]] });
    let bend = json!([[[-0.3, -0.1, 0.1], [-0.1, 0.2, -0.1], [0.1, -0.2, 0.1], [0.3, 0.1, 0]]]);
    let mut body = match kind % 10 {
        0 => {
            let mut deforming = tetrahedron;
            deforming["keyframes"] = json!([{ "time": 0 }, { "time": 1, "positions": corners() }]);
            deforming
        }
        1 => {
            let mut rounded = tetrahedron;
            rounded["subdivision_levels"] = json!(2);
            rounded
        }
        2 => {
            let mut displaced = tetrahedron;
            displaced["subdivision_levels"] = json!(3);
            displaced["displacement"] = json!({ "texture": { "type": "noise", "scale": 6 }, "scale": 0.1 });
            displaced
        }
        3 => {
            json!({ "type": "curves", "points": bend, "normals": [[[0, 0.2, 1], [0, 1, 1], [0.3, 0, 1], [0, 0, 1]]], "radius": [0.15, 0.05] })
        }
        4 => json!({ "type": "curves", "basis": "bezier", "points": bend, "radius": [0.05, 0.15] }),
        5 => json!({ "type": "cylinder", "radius": 0.2, "z_min": -0.2, "z_max": 0.25, "phi_max": 250 }),
        6 => json!({ "type": "cone", "radius": 0.3, "height": 0.4, "phi_max": 300 }),
        7 => json!({ "type": "sphere", "radius": 0.3, "z_min": -0.2, "z_max": 0.1, "phi_max": 200 }),
        8 => json!({ "type": "disk", "radius": 0.35, "inner_radius": 0.15, "phi_max": 270 }),
        _ => json!({ "type": "bilinear_patch", "corners": [[-0.3, -0.3, 0.1], [0.3, -0.2, -0.1], [-0.2, 0.3, -0.1], [0.3, 0.3, 0.1]] }),
    };
    body["material"] = json!({ "type": "diffuse", "albedo": color(dice, 0.2, 0.8) });
    body
}

fn medium(dice: &mut Dice) -> Value {
    json!({ "type": "homogeneous", "absorption": color(dice, 0.0, 1.0), "scattering": color(dice, 0.5, 3.0),
        "phase": { "type": "henyey_greenstein", "g": dice.within(-0.5, 0.8) } })
}

/// A camera in front of the room, of each type in turn.
fn camera(kind: u64, dice: &mut Dice) -> Value {
    let mut camera = match kind {
        0 => {
            json!({ "fov": 40, "lens_radius": 0.05, "focus_distance": 3, "aperture": { "blades": 5 }, "tilt": [20, -10], "shift": [0.1, 0.05] })
        }
        1 => json!({ "type": "orthographic", "height": 1.9 }),
        2 => json!({ "type": "fisheye", "fov": 80, "mapping": "equisolid" }),
        3 => json!({ "type": "spherical" }),
        4 => json!({ "type": "realistic", "lens": [[50, 2, 1.5, 20], [-50, 0, 1, 20]], "focus_distance": 3, "sensor": 36 }),
        _ => json!({ "focal_length": 30, "f_number": 1, "focus_distance": 3 }),
    };
    let look_at = json!({ "look_at": { "from": [0.1, 0.1, if kind == 3 { 0.7 } else { 3.4 }], "to": [0, 0, 0] } });
    let moving =
        json!([look_at, { "keyframes": [{ "time": 0 }, { "time": 1, "transform": [{ "translate": dice.point(0.1).to_array() }] }] }]);
    camera["transform"] = if dice.of(2) == 0 { moving } else { json!([look_at]) };
    camera
}
