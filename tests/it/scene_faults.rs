//! What each part of the scene format refuses, and in which words.

use pt::{Error, describe};

use crate::marked::{assert_fault, assert_fault_in_scene, read, scene};

#[test]
fn cameras_and_films() {
    assert_fault(&[
        (r#"{"pt": 1, "camera": {"fov": ^0}}"#, "/camera/fov: expected an angle in degrees above 0 and below 180, found 0"),
        (r#"{"pt": 1, "camera": {"fov": ^180}}"#, "/camera/fov: expected"),
        (r#"{"pt": 1, "camera": {"lens_radius": ^-1}}"#, "/camera/lens_radius: expected a number of at least 0, found -1"),
        (r#"{"pt": 1, "camera": {"focus_distance": ^0}}"#, "/camera/focus_distance: expected a number above 0, found 0"),
        (r#"{"pt": 1, "camera": {"look_at": ^{"from": [1, 2, 3], "to": [1, 2, 3]}}}"#, "/camera/look_at: from and to are the same point"),
        (
            r#"{"pt": 1, "camera": {"look_at": ^{"from": [0, 3, 0], "to": [0, 0, 0]}}}"#,
            "/camera/look_at: up is parallel to the view direction",
        ),
        (
            // Parallel, but for the rounding of 0.1 and 0.3.
            r#"{"pt": 1, "camera": {"look_at": ^{"from": [0, 0, 0], "to": [0.1, 0.1, 0.1], "up": [0.3, 0.3, 0.3]}}}"#,
            "/camera/look_at: up is parallel",
        ),
        (
            r#"{"pt": 1, "camera": {"look_at": {"from": [0, 0, 1], "to": [0, 0, 0]}, "transform": ^[]}}"#,
            "/camera/transform: give look_at or transform, not both",
        ),
    ]);
    assert_fault_in_scene(&[
        (r#""film": {"width": ^0}"#, "/film/width: expected a whole number from 1 to 65536, found 0"),
        (r#""film": {"width": ^-1}"#, "/film/width: expected a whole number from 1 to 65536, found -1"),
        (r#""film": {"width": ^1.5}"#, "/film/width: expected a whole number, found 1.5"),
        (r#""film": {"height": ^65537}"#, "/film/height: expected a whole number from 1 to 65536, found 65537"),
        (r#""film": {"height": ^4294967295}"#, "/film/height: expected a whole number from 1 to 65536"),
        (r#""film": {"crop": ^[0, 0, 0, 10]}"#, "/film/crop: the crop [x0, x1, y0, y1] is empty"),
        (r#""film": {"crop": ^[20, 10, 0, 10]}"#, "/film/crop: the crop [x0, x1, y0, y1] is empty"),
        (r#""film": {"crop": ^[0, 513, 0, 10]}"#, "/film/crop: the crop reaches to 513, 10, beyond the image of 512 × 512"),
        (r#""film": {"crop": [^-1, 5, 0, 10]}"#, "/film/crop/0: expected a whole number from 0 to 4294967295, found -1"),
        (r#""sampler": {"spp": ^0}"#, "/sampler/spp: expected a whole number from 1 to 4294967295, found 0"),
        (r#""sampler": {"spp": ^4294967296}"#, "/sampler/spp: expected a whole number from 1 to 4294967295"),
    ]);
}

#[test]
fn images_that_no_memory_holds_are_a_limit() {
    let film = |film: &str| describe::parse(scene(&format!("\"film\": {film}")).as_bytes(), "s");
    // 65536² pixels of 192 bytes are 768 · 2³⁰ bytes.
    match film(r#"{"width": 65536, "height": 65536}"#) {
        Err(error @ Error::Limit(_)) => {
            assert_eq!(error.exit_code(), 4);
            assert_eq!(error.to_string(), "s:2:9: /film: the image needs 768 GiB, the limit is 16");
        }
        other => panic!("{other:?}"),
    }
    assert!(film(r#"{"width": 65536, "height": 65536, "crop": [0, 100, 0, 100]}"#).is_ok(), "only the crop is held");
}

#[test]
fn transforms() {
    let step = |step: &str| scene(&format!(r#""shapes": [{{"type": "quad", "transform": [{step}]}}]"#));
    let scale_singular = "/shapes/0/transform/0/scale: the transform is singular: det 0";
    let matrix_singular = "/shapes/0/transform/0/matrix: the transform is singular: det 0";
    let cases = [
        (r#"{"scale": ^0}"#, scale_singular),
        (r#"{"scale": ^[1, 0, 1]}"#, scale_singular),
        (r#"{"matrix": ^[1,2,3,0, 4,5,6,0, 7,8,9,0, 0,0,0,1]}"#, matrix_singular),
        // Rank 2 in exact numbers, not in rounded ones; small, so that no absolute threshold would do.
        (r#"{"matrix": ^[1e-9,2e-9,3e-9,0, 4e-9,5e-9,6e-9,0, 7e-9,8e-9,9e-9,0, 0,0,0,1]}"#, matrix_singular),
        (r#"{"matrix": ^[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,1,1]}"#, "/shapes/0/transform/0/matrix: the last row is 0, 0, 1, 1"),
        (r#"{"scale": ^1e-30}"#, "/shapes/0/transform/0/scale: the transform's det 1.0e-90"),
        (r#"{"scale": ^1e20}"#, "/shapes/0/transform/0/scale: the transform's det 1.0e60"),
        (r#"{"rotate": {"axis": ^[0, 0, 0], "degrees": 1}}"#, "/shapes/0/transform/0/rotate/axis: expected a direction, found [0, 0, 0]"),
        (r#"{"look_at": ^{"from": [0, 0, 0], "to": [0, 0, 0]}}"#, "/shapes/0/transform/0/look_at: from and to"),
        (r#"{^"scal": 1}"#, r#"/shapes/0/transform/0/scal: unknown key "scal", did you mean "scale"?"#),
        (r#"^{"scale": 1, "translate": [1, 2, 3]}"#, "/shapes/0/transform/0: expected exactly one of translate, scale"),
        ("^{}", "/shapes/0/transform/0: expected exactly one of translate, scale"),
        (r#"{"translate": ^[1, 2]}"#, "/shapes/0/transform/0/translate: expected an array of 3, found an array of 2"),
    ];
    for (text, expected) in cases {
        assert_fault(&[(&step(text), expected)]);
    }
    for text in [r#"{"scale": 1e-9}"#, r#"{"scale": [1e6, 1, 1e-6]}"#, r#"{"scale": -1}"#] {
        assert!(read(step(text)).is_ok(), "{text} can be undone");
    }
}

#[test]
fn materials_and_lights() {
    assert_fault_in_scene(&[
        (r#""materials": {"m": {"type": "diffuse", "albedo": ^1.1}}"#, "/materials/m/albedo: expected a number from 0 to 1, found 1.1"),
        (
            r#""materials": {"m": {"type": "diffuse", "albedo": [0, ^-0.1, 0]}}"#,
            "/materials/m/albedo/1: expected a number from 0 to 1, found -0.1",
        ),
        (
            r##""materials": {"m": {"type": "diffuse", "albedo": {"srgb": ^"#12345"}}}"##,
            "/materials/m/albedo/srgb: expected a colour such as",
        ),
        (r##""materials": {"m": {"type": "diffuse", "albedo": {"srgb": ^"#12345é"}}}"##, "/materials/m/albedo/srgb: expected a colour"),
        (
            r#""materials": {"m": {"type": "diffuse", "albedo": ^true}}"#,
            "/materials/m/albedo: expected a number or a string or an array or an object, found true",
        ),
        (
            r#""materials": {"m": {"type": "dielectric", "eta": ^0}}"#,
            "/materials/m/eta: expected an index of refraction from 0.01 to 100, found 0",
        ),
        (r#""materials": {"m": {"type": "dielectric", "eta": ^-1.5}}"#, "/materials/m/eta: expected an index of refraction"),
        (r#""materials": {"m": {"type": "dielectric", "eta": ^1e9}}"#, "/materials/m/eta: expected an index of refraction"),
        (
            r#""materials": {"m": {"type": "conductor", "eta": 1, "k": ^-1}}"#,
            "/materials/m/k: expected an extinction coefficient from 0 to 1000, found -1",
        ),
        (
            r#""materials": {"m": {"type": "matte_cone", "color": 1, "mattness": ^1.5}}"#,
            "/materials/m/mattness: expected a number from 0 to 1",
        ),
        (r#""materials": {"m": ^"n"}"#, "/materials/m: expected an object with a \"type\", found the string \"n\""),
        (r#""shapes": [{"type": "disk", "emission": ^-1}]"#, "/shapes/0/emission: expected a number from 0 to 1e30, found -1"),
        (r#""shapes": [{"type": "disk", "emission": ^1e38}]"#, "/shapes/0/emission: expected a number from 0 to 1e30, found 1"),
        (
            r#""shapes": [{"type": "disk", "emission": {"radiance": [1, 2, ^1e39]}}]"#,
            "/shapes/0/emission/radiance/2: the number 1e39 is too large",
        ),
        (r#""lights": [^{"type": "spot", "position": [0,0,0], "intensity": 1}]"#, "/lights/0: a spot needs either \"direction\" or \"to\""),
        (r#""lights": [{"type": "spot", "position": [0,0,0], "to": ^[0,0,0], "intensity": 1}]"#, "/lights/0/to: the spot points at itself"),
        (
            r#""lights": [^{"type": "spot", "position": [0,0,0], "to": [0,1,0], "intensity": 1, "outer_angle": 5}]"#,
            "/lights/0/inner_angle: inner_angle 25 is larger than outer_angle 5",
        ),
        (r#""lights": [{"type": "directional", "direction": ^[0,0,0], "irradiance": 1}]"#, "/lights/0/direction: expected a direction"),
    ]);
}

#[test]
fn meshes() {
    let either = "/shapes/0: a mesh needs either \"file\", or \"positions\" and \"triangles\"";
    let vertices = r#""positions": [[0,0,0], [1,0,0], [0,1,0]]"#;
    let cases = [
        (r#"^{"type": "mesh", "name": "m"}"#.to_owned(), either),
        (r#"^{"type": "mesh", "triangles": []}"#.to_owned(), either),
        (format!(r#"^{{"type": "mesh", {vertices}, "triangles": [[0, 1, 2]], "file": "a.obj"}}"#), either),
        (r#"{"type": "mesh", "file": "a.obj", "uvs": ^[]}"#.to_owned(), "/shapes/0/uvs: a mesh from a file has its own uvs"),
        (
            format!(r#"{{"type": "mesh", {vertices}, "triangles": [[0, 1, ^3]]}}"#),
            "/shapes/0/triangles/0/2: vertex 3 does not exist, the last of 3 positions is 2",
        ),
        (format!(r#"{{"type": "mesh", {vertices}, "triangles": ^[]}}"#), "/shapes/0/triangles: a mesh needs at least one triangle"),
        (
            format!(r#"{{"type": "mesh", {vertices}, "triangles": [[0, 1, 2]], "normals": ^[[0, 0, 1]]}}"#),
            "/shapes/0/normals: expected one for each of 3 positions, found 1",
        ),
    ];
    for (mesh, expected) in cases {
        assert_fault_in_scene(&[(&format!("\"shapes\": [{mesh}]"), expected)]);
    }
}

#[test]
fn names() {
    assert_fault_in_scene(&[
        (
            r#""materials": {"gold": {"type": "mirror"}}, "shapes": [{"type": "disk", "material": ^"glod"}]"#,
            r#"/shapes/0/material: unknown material "glod", did you mean "gold"?"#,
        ),
        (r#""shapes": [{"type": "disk", "material": ^"gold"}]"#, r#"/shapes/0/material: unknown material "gold", there are none"#),
        (
            r#""shapes": [{"type": "group", "shapes": [{"type": "disk", "material": {"type": "diffuse", "albedo": ^"t"}}]}]"#,
            r#"/shapes/0/shapes/0/material/albedo: unknown texture "t""#,
        ),
        (
            r#""textures": {"a": {"type": "checker", "even": "b"}, "b": {"type": "checker", "odd": {"type": "checker", "even": ^"a"}}}"#,
            "/textures/b/odd/even: the texture contains itself: a → b → a",
        ),
        (r#""textures": {"a": {"type": "checker", "even": ^"a"}}"#, "/textures/a/even: the texture contains itself: a → a"),
    ]);
}

/// A chain of `length` checkers, each naming the next twice: 2^length paths.
fn chain(length: usize) -> String {
    let link = |i: usize| format!(r#""t{i}": {{"type": "checker", "even": "t{}", "odd": "t{}"}},"#, i + 1, i + 1);
    let links: String = (1..length).map(link).collect();
    scene(&format!(r#""textures": {{{links} "t{length}": {{"type": "constant", "color": 1}}}}"#))
}

#[test]
fn textures_within_textures_are_limited() {
    assert!(read(chain(64)).is_ok());
    let faults = read(chain(10_000)).expect_err("too deep");
    assert_eq!(faults.len(), 1);
    assert!(faults[0].contains("/textures/t9936: textures lie within each other deeper than 64"), "{}", faults[0]);
}
