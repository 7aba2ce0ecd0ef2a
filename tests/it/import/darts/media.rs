//! Media of dirt's scenes, by the radiance of one ray.

use std::fs;

use super::{imported, picture};

/// Mean of the pixels, and its standard error, of a scene in a view so narrow that all rays are parallel to z and meet the centre of the scene.
///
/// - `camera`: more members of the camera
fn radiance(camera: &str, parts: &str) -> (f64, f64) {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = format!(
        r#"{{ "camera": {{ "transform": {{ "from": [0, 0, 4] }}, "vfov": 0.01, "resolution": 8 {camera} }},
            "background": 1, "integrator": {{ "type": "volpath_tracer_uni" }}, {parts} }}"#
    );
    fs::write(folder.path().join("scene.json"), scene).expect("a scene");
    fs::write(folder.path().join("cube.obj"), CUBE).expect("a mesh");
    let image = picture(folder.path(), "scene.json", SAMPLES, 7);
    let pixels: Vec<f64> = image.pixels().map(|[_, green, _]| green.into()).collect();
    let count = pixels.len() as f64;
    let mean = pixels.iter().sum::<f64>() / count;
    let variance = pixels.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}

const IN_FOG: &str = r#", "medium": "fog""#;

const SAMPLES: u64 = 256;

/// A cube from −1 to 1 along each axis.
const CUBE: &str = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n\
    f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

fn expect(camera: &str, parts: &str, expected: f64) {
    let (mean, error) = radiance(camera, parts);
    // Roundings of f32 add up over a few operations.
    assert!((mean - expected).abs() <= 4.5 * error + 1e-5, "{parts}: {mean} ± {error}, expected {expected}");
}

const PHASE: &str = r#""phase": { "type": "hg", "g": 0.3 }"#;

/// A ray that passes the length s of a medium which absorbs σ keeps e^(−σ s).
#[test]
fn media_absorb_between_their_boundaries() {
    let fog = format!(r#""media": [{{ "type": "homogeneous", "name": "fog", "sigma_a": [0.1, 0.5, 2], {PHASE} }}]"#);
    let ball =
        |radius: f64, interface: &str| format!(r#"{{ "type": "sphere", "radius": {radius}, "medium_interface": {{ {interface} }} }}"#);
    let body = ball(1.0, r#""inside": "fog""#);
    expect("", &format!(r#"{fog}, "surfaces": [{body}]"#), (-1.0f64).exp());
    // A smaller body without a medium within it, and one that a group scales by 2 and by 3.
    let hole = ball(0.25, r#""outside": "fog""#);
    expect("", &format!(r#"{fog}, "surfaces": [{body}, {hole}]"#), (-0.75f64).exp());
    let grown = format!(r#"{{ "type": "group", "transform": {{ "scale": [3, 1, 2] }}, "children": [{body}] }}"#);
    expect("", &format!(r#"{fog}, "surfaces": [{grown}]"#), (-2.0f64).exp());
    let mesh = r#"{ "type": "mesh", "filename": "cube.obj", "medium_interface": { "inside": "fog" } }"#;
    expect("", &format!(r#"{fog}, "surfaces": [{mesh}]"#), (-1.0f64).exp());
    // Surfaces with the same on both sides are not there.
    let unseen = r#"{ "type": "quad", "medium_interface": {} }"#;
    expect("", &format!(r#"{fog}, "surfaces": [{unseen}, {body}]"#), (-1.0f64).exp());
}

/// Around a lamp of radiance 3 whose front is 1.5 away from the camera, and of which a ball of 0.5 without a medium is in the way.
#[test]
fn the_medium_outside_of_all_surfaces_is_around_the_camera() {
    let fog = format!(r#""media": [{{ "type": "homogeneous", "name": "fog", "sigma_a": 0.5, {PHASE} }}]"#);
    let lamp =
        r#"{ "type": "quad", "size": 1, "transform": { "translate": [0, 0, 2.5] }, "material": { "type": "diffuse light", "emit": 3 } }"#;
    expect(IN_FOG, &format!(r#"{fog}, "surfaces": [{lamp}]"#), 3.0 * (-0.75f64).exp());
    let bubble =
        r#"{ "type": "sphere", "radius": 0.25, "transform": { "translate": [0, 0, 3.25] }, "medium_interface": { "outside": "fog" } }"#;
    expect(IN_FOG, &format!(r#"{fog}, "surfaces": [{lamp}, {bubble}]"#), 3.0 * (-0.5f64).exp());
    expect("", &format!(r#"{fog}, "surfaces": [{lamp}, {bubble}]"#), 3.0 * (-0.5f64).exp());
}

/// A bubble without a medium does not make the medium of the camera that of the whole scene: beyond the dome of fog the background is seen. Fog
/// around everything stays, also if the camera is in such a bubble.
#[test]
fn bubbles_do_not_change_what_is_outside() {
    let fog = format!(r#""media": [{{ "type": "homogeneous", "name": "fog", "sigma_a": 0.5, {PHASE} }}]"#);
    let ball = |radius: f64, z: f64, interface: &str| {
        let placed = format!(r#""radius": {radius}, "transform": {{ "translate": [0, 0, {z}] }}"#);
        format!(r#"{{ "type": "sphere", {placed}, "medium_interface": {{ {interface} }} }}"#)
    };
    let (dome, hole) = (ball(6.0, 0.0, r#""inside": "fog""#), ball(0.5, 0.0, r#""outside": "fog""#));
    expect(IN_FOG, &format!(r#"{fog}, "surfaces": [{hole}, {dome}]"#), (-4.5f64).exp());
    let lamp = r#"{ "type": "quad", "size": 1, "material": { "type": "diffuse light", "emit": 3 } }"#;
    let (bubble, drop) = (ball(1.5, 4.0, r#""outside": "fog""#), ball(0.25, 3.5, r#""inside": "fog""#));
    expect("", &format!(r#"{fog}, "surfaces": [{lamp}, {drop}, {bubble}]"#), 3.0 * (-1.5f64).exp());
}

/// Noise of no amplitude leaves a constant density, wherever the box of its grid is: everywhere in the body, if the box is large enough.
#[test]
fn noise_fills_the_bodies_that_have_it_inside() {
    let noise = |scale: f64, offset: f64| {
        format!(
            r#""media": [{{ "type": "perlin", "name": "smoke", "sigma_a": 0.5, "sigma_s": 0, "spatial_scale": [2, 3, 0.5],
                "density_scale": {scale}, "density_offset": {offset}, {PHASE} }}]"#
        )
    };
    let group = |child: &str| {
        let far = r#""transform": [{ "scale": [1, 1, 1.5] }, { "translate": [0, 0, -2] }]"#;
        format!(r#""surfaces": [{{ "type": "group", {far}, "children": [{{ {child}, "medium_interface": {{ "inside": "smoke" }} }}] }}]"#)
    };
    let ball = group(r#""type": "sphere", "radius": 2"#);
    expect("", &format!("{}, {ball}", noise(0.0, 2.0)), (-6.0f64).exp());
    expect("", &format!("{}, {ball}", noise(0.0, 0.25)), (-0.75f64).exp());
    expect("", &format!("{}, {}", noise(0.0, 0.25), group(r#""type": "mesh", "filename": "cube.obj""#)), (-0.375f64).exp());
    // pt's density is at most 1, so the coefficients contain its maximum: their product is that of the original.
    let folder = tempfile::tempdir().expect("a folder");
    let camera = r#""camera": { "resolution": 8, "vfov": 30 }"#;
    fs::write(folder.path().join("scene.json"), format!("{{ {camera}, {}, {ball} }}", noise(-0.25, 0.5))).expect("a scene");
    let root = imported(folder.path(), "scene.json").root;
    let number = |key: &str| root.get(&format!("/media/smoke/{key}")).expect("a number").to_string().parse::<f64>().expect("a number");
    let absorption = number("absorption/0");
    assert_eq!([absorption * number("density/amplitude"), absorption * number("density/offset")], [0.5 * 0.25, 0.5 * 0.5]);
}
