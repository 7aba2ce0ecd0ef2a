//! Faults in each part of the scene format, and their messages. More of them are in the table of `bad_input`.

use pt::build::Source;
use pt::describe::{self, Files};

use crate::marked::{assert_fault, assert_fault_in_scene, read, scene};

fn build(text: &str) -> pt::Result<()> {
    let root = describe::root(text.as_bytes(), "scene.json")?;
    let source = Source { root: &root, file: "scene.json", files: &Files::within("") };
    pt::build::build(&describe::read(&root, "scene.json")?, source).map(drop)
}

#[test]
fn cameras() {
    let camera = |keys: &str| format!(r#"{{"pt": 1, "camera": {{{keys}}}}}"#);
    let cases = [
        (r#""look_at": {"from": [0, 0, 1], "to": [0, 0, 0]}, "transform": ^[]"#, "/camera/transform: give look_at or transform, not both"),
        (r#""fov": 40, "focal_length": ^50"#, "/camera/focal_length: give fov or focal_length, not both"),
        (r#""horizontal_fov": 40, "focal_length": ^50"#, "/camera/focal_length: give horizontal_fov or focal_length, not both"),
        (r#""lens_radius": 0.1, "f_number": ^2"#, "/camera/f_number: give lens_radius or f_number, not both"),
        (r#""sensor": ^24"#, "/camera/sensor: the size of the sensor counts only with focal_length or f_number"),
        (r#""focal_length": ^1e-9"#, "/camera/focal_length: expected between 1e-8 and 1e8 times the size of the sensor, 2.4e1 mm"),
        (r#""focal_length": ^0"#, "/camera/focal_length: expected a number above 0, found 0"),
        (r#""f_number": ^0"#, "/camera/f_number: expected an f-number from 0.01 to 1000000, found 0"),
        (r#""focal_length": 50, "sensor": ^"35mm""#, "/camera/sensor: expected a number or an array, found"),
        (r#""focal_length": 50, "sensor": [36, ^-24]"#, "/camera/sensor/1: expected a number above 0, found -24"),
        (r#""aperture": {"blades": ^2}"#, "/camera/aperture/blades: expected 0, for a round opening, or at least 3 blades"),
        (r#""aperture": {"blades": ^65}"#, "/camera/aperture/blades: expected a whole number from 0 to 64, found 65"),
        (r#""aperture": {"rotation": ^null}"#, "/camera/aperture/rotation: expected a number, found null"),
        (r#""shift": ^0.5"#, "/camera/shift: expected an array"),
        (r#""tilt": [^90, 0]"#, "/camera/tilt/0: expected an angle in degrees above -90 and below 90, found 90"),
        (r#""type": "fisheye", "fov": ^361"#, "/camera/fov: expected an angle in degrees above 0 and at most 360, found 361"),
        (
            r#""type": "fisheye", "mapping": "stereographic", "fov": ^360"#,
            "/camera/fov: expected an angle below 360 degrees for a stereographic",
        ),
        (
            r#""type": "fisheye", "mapping": "orthographic", "fov": ^181"#,
            "/camera/fov: expected an angle at most 180 degrees for an orthographic",
        ),
        (r#""type": "fisheye", "mapping": ^"fish""#, "/camera/mapping: "),
        (r#""type": "fisheye", ^"lens_radius": 1"#, "/camera/lens_radius: unknown key"),
        (r#""type": "realistic", "lens": ^[]"#, "/camera/lens: expected 1 to 100 surfaces, found 0"),
        (r#""type": "realistic", "lens": ^5"#, "/camera/lens: expected a string or an array, found 5"),
        (
            r#""type": "realistic", "lens": [[50, 1, 1.5, 9], ^[50, -1, 1, 9]]"#,
            "/camera/lens/1: expected a thickness of at least 0, found -1",
        ),
        (
            r#""type": "realistic", "lens": [^[50, 1, 0.5, 9]]"#,
            "/camera/lens/0: expected an index of refraction from 1 to 10, or 0 for air",
        ),
        (r#""type": "realistic", "lens": [^[50, 1, 1.5, 0]]"#, "/camera/lens/0: expected a diameter above 0, found 0"),
        (
            r#""type": "realistic", "lens": [^[4, 1, 1.5, 9]]"#,
            "/camera/lens/0: expected a diameter of at most 8, that of the sphere, found 9",
        ),
        (r#""type": "realistic", "lens": [[50, 1, 1, 9], ^[-50, 1, 1.5, 9]]"#, "/camera/lens/1: expected air behind the last surface"),
        (r#""type": "realistic", "lens": [[50, 1, ^"glass", 9]]"#, "/camera/lens/0/2: expected a number"),
    ];
    for (text, expected) in cases {
        assert_fault(&[(&camera(text), expected)]);
    }
    for sound in [
        r#""lens_radius": 0, "f_number": 2"#,
        r#""type": "fisheye", "fov": 360"#,
        r#""type": "fisheye", "fov": 359, "mapping": "stereographic""#,
    ] {
        assert!(read(camera(sound)).is_ok(), "{sound}");
    }
}

/// What is wrong with a lens as a whole is found when it is built: faults of its focus, its stop and its file.
#[test]
fn lenses_that_cannot_be_used() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
    file("good.dat", "# a magnifying glass\n\n50 3 1.5 20 # front\n-50\t0 1 20\n");
    file("short.dat", "50 3 1.5 20\n-50 0 1\n");
    file("words.dat", "# glass\n50 3 BK7 20\n");
    file("narrow.dat", "50 3 1.5 20\n\n-5 0 1 20\n");
    let build = |keys: &str| {
        let text = format!(r#"{{"pt": 1, "camera": {{"type": "realistic", {keys}}}}}"#);
        let root = describe::root(text.as_bytes(), "s").expect("JSON");
        let files = Files::within(folder.path());
        let scene = describe::read_with(&root, "s", &files)?;
        pt::build::build(&scene, Source { root: &root, file: "s", files: &files }).map(drop)
    };
    assert!(build(r#""lens": "good.dat""#).is_ok());
    let glass = r#""lens": [[50, 3, 1.5, 20], [-50, 1, 1, 20], [0, 0, 1, 12]]"#;
    for (keys, expected) in [
        (r#""lens": "short.dat""#.to_owned(), "/camera/lens: short.dat: line 2: expected four numbers: radius of curvature, thickness"),
        (r#""lens": "words.dat""#.to_owned(), "/camera/lens: words.dat: line 2: expected four numbers"),
        (r#""lens": "narrow.dat""#.to_owned(), "/camera/lens: narrow.dat: line 3: expected a diameter of at most 10, that of the sphere"),
        (r#""lens": "none.dat""#.to_owned(), "/camera/lens: none.dat: no such file"),
        (r#""lens": "../good.dat""#.to_owned(), "/camera/lens: ../good.dat: leads out of the scene file's folder"),
        (r#""lens": [[-50, 3, 1.5, 20], [50, 0, 1, 20]]"#.to_owned(), "/camera/lens: this lens does not bring parallel light together"),
        (r#""lens": [[0, 1, 1, 20]]"#.to_owned(), "/camera/lens: this lens does not bring parallel light together"),
        (format!(r#"{glass}, "focus_distance": 0.1"#), "/camera/focus_distance: a lens with the focal length 50."),
        (
            format!(r#"{glass}, "aperture_diameter": 12.1"#),
            "/camera/aperture_diameter: expected at most the diameter of the stop in the table",
        ),
        (r#""lens": "good.dat", "aperture_diameter": 1"#.to_owned(), "/camera/aperture_diameter: the lens has no stop"),
    ] {
        let said = build(&keys).expect_err(&keys).to_string();
        assert!(said.lines().count() == 1 && said.contains(expected), "{keys}: {said}");
    }
}

#[test]
fn only_the_crop_of_a_picture_needs_memory() {
    assert!(read(scene(r#""film": {"width": 65536, "height": 65536, "crop": [0, 100, 0, 100]}"#)).is_ok());
}

#[test]
fn transforms() {
    let step = |step: &str| scene(&format!(r#""shapes": [{{"type": "quad", "transform": [{step}]}}]"#));
    let cases = [
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
        (
            r##""materials": {"m": {"type": "diffuse", "albedo": {"srgb": ^"#12345"}}}"##,
            "/materials/m/albedo/srgb: expected a colour such as",
        ),
        (r##""materials": {"m": {"type": "diffuse", "albedo": {"srgb": ^"#12345é"}}}"##, "/materials/m/albedo/srgb: expected a colour"),
        (
            r#""materials": {"m": {"type": "diffuse", "albedo": ^true}}"#,
            "/materials/m/albedo: expected a number or a string or an array or an object, found true",
        ),
        (r#""materials": {"m": ^"n"}"#, "/materials/m: expected an object with a \"type\", found the string \"n\""),
        (r#""lights": [^{"type": "spot", "position": [0,0,0], "intensity": 1}]"#, "/lights/0: a spot needs either \"direction\" or \"to\""),
        (r#""lights": [{"type": "spot", "position": [0,0,0], "to": ^[0,0,0], "intensity": 1}]"#, "/lights/0/to: the spot points at itself"),
        (
            r#""lights": [^{"type": "spot", "position": [0,0,0], "to": [0,1,0], "intensity": 1, "outer_angle": 5}]"#,
            "/lights/0/inner_angle: inner_angle 25 is larger than outer_angle 5",
        ),
        (
            r#""lights": [{"type": "point", "position": [0,0,0], "intensity": 1, "across": ^[1,0,0]}]"#,
            "/lights/0/across: only a point with a \"profile\" has this",
        ),
        (
            r#""lights": [{"type": "point", "position": [0,0,0], "intensity": 1, "profile": "lamp.ies", "across": ^[0,2,0]}]"#,
            "/lights/0/across: expected a direction that is not along that of the vertical angle 0",
        ),
        (
            r#""lights": [{"type": "spot", "position": [0,0,0], "to": [0,1,0], "intensity": 1, "image_angle": ^20}]"#,
            "/lights/0/image_angle: only a spot with an \"image\" has this",
        ),
        (
            r#""lights": [{"type": "spot", "position": [0,0,0], "to": [0,1,0], "intensity": 1, "image": "a.png", "up": ^[0,-3,0]}]"#,
            "/lights/0/up: expected a direction that is not along that of the light",
        ),
        (
            r#""lights": [{"type": "spot", "position": [0,0,0], "to": [0,1,0], "intensity": 1, "image": "a.png", "outer_angle": ^95}]"#,
            "/lights/0/outer_angle: with an \"outer_angle\" of 90 or more the width of the picture is needed",
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
fn parts_of_shapes() {
    let shape = |text: &str| format!(r#""shapes": [{text}]"#);
    let cases = [
        (r#"{"type": "cylinder", "radius": ^-1}"#, "/shapes/0/radius: expected a number above 0, found -1"),
        (r#"{"type": "cylinder", "z_min": 1, "z_max": ^1}"#, "/shapes/0/z_max: expected a number above 1, that of z_min, found 1"),
        (r#"^{"type": "cylinder", "z_min": 2}"#, "/shapes/0/z_max: expected a number above 2, that of z_min, found 1"),
        (r#"{"type": "cylinder", "phi_max": ^0}"#, "/shapes/0/phi_max: expected an angle in degrees above 0 and at most 360, found 0"),
        (r#"{"type": "cylinder", "phi_max": ^361}"#, "/shapes/0/phi_max: expected an angle in degrees above 0 and at most 360, found 361"),
        (r#"{"type": "cylinder", ^"height": 1}"#, r#"/shapes/0/height: unknown key "height""#),
        (r#"{"type": "cylinder", ^"medium": {"type": "homogeneous"}}"#, r#"/shapes/0/medium: unknown key "medium""#),
        (r#"{"type": "cone", "height": ^0}"#, "/shapes/0/height: expected a number above 0, found 0"),
        (r#"{"type": "cone", "radius": ^0}"#, "/shapes/0/radius: expected a number above 0, found 0"),
        (r#"{"type": "sphere", "z_min": 0.5, "z_max": ^0.5}"#, "/shapes/0/z_max: expected a number above 0.5, that of z_min, found 0.5"),
        (
            r#"{"type": "sphere", "z_min": ^1}"#,
            "/shapes/0/z_min: expected a number below 1, the radius, found 1: nothing of the sphere is left",
        ),
        (
            r#"{"type": "sphere", "radius": 2, "z_max": ^-2}"#,
            "/shapes/0/z_max: expected a number above -2, minus the radius, found -2: nothing of the sphere is left",
        ),
        (r#"{"type": "sphere", "phi_max": ^-90}"#, "/shapes/0/phi_max: expected an angle in degrees above 0 and at most 360, found -90"),
        (
            r#"{"type": "sphere", "z_max": 0, "medium": ^{"type": "homogeneous", "absorption": 1}}"#,
            "/shapes/0/medium: a part of a sphere is open and contains nothing: leave out \"medium\", or the cuts",
        ),
        (
            r#"{"type": "sphere", "phi_max": 180, "medium": ^{"type": "homogeneous", "absorption": 1}}"#,
            "/shapes/0/medium: a part of a sphere is open",
        ),
        (r#"{"type": "disk", "inner_radius": ^1}"#, "/shapes/0/inner_radius: expected a number below 1, that of radius, found 1"),
        (r#"{"type": "disk", "inner_radius": ^-0.1}"#, "/shapes/0/inner_radius: expected a number of at least 0, found -0.1"),
        (r#"^{"type": "bilinear_patch"}"#, "/shapes/0: missing key \"corners\""),
        (
            r#"{"type": "bilinear_patch", "corners": ^[[0,0,0], [1,0,0], [0,1,0]]}"#,
            "/shapes/0/corners: expected an array of 4, found an array of 3",
        ),
        (
            r#"{"type": "bilinear_patch", "corners": ^[[0,0,0], [1,1,1], [2,2,2], [5,5,5]]}"#,
            "/shapes/0/corners: the corners lie on one line",
        ),
        (
            r#"{"type": "bilinear_patch", "corners": ^[[1,2,3], [1,2,3], [1,2,3], [1,2,3]]}"#,
            "/shapes/0/corners: the corners lie on one line",
        ),
        (
            r#"{"type": "bilinear_patch", "corners": ^[[0,0,0], [1,0,0], [1,1,0], [0,1,0]]}"#,
            "/shapes/0/corners: the sides cross: expected the corners at [u, v] = [0, 0], [1, 0], [0, 1] and [1, 1], in this order",
        ),
        (r#"^{"type": "curves", "radius": 1}"#, "/shapes/0: curves need either \"file\" or \"points\""),
        (r#"^{"type": "curves", "points": [[[0,0,0], [1,0,0]]]}"#, "/shapes/0: curves with \"points\" need a \"radius\""),
        (r#"{"type": "curves", "points": ^[], "radius": 1}"#, "/shapes/0/points: expected at least one curve"),
        (r#"{"type": "curves", "points": [^[[0,0,0]]], "radius": 1}"#, "/shapes/0/points/0: expected at least two, found 1"),
        (
            r#"{"type": "curves", "basis": "bezier", "points": [^[[0,0,0], [1,0,0], [1,1,0], [2,0,0], [3,0,0]]], "radius": 1}"#,
            "/shapes/0/points/0: expected 4, 7, 10 and so on for a Bézier curve, found 5",
        ),
        (
            r#"{"type": "curves", "basis": "bspline", "points": [^[[0,0,0], [1,0,0], [1,1,0]]], "radius": 1}"#,
            "/shapes/0/points/0: expected at least four for a B-spline, found 3",
        ),
        (
            r#"{"type": "curves", "points": [[[0,0,0], [1,0,0]]], "radius": ^[0, 0]}"#,
            "/shapes/0/radius: expected a number above 0 at one end at least",
        ),
        (
            r#"{"type": "curves", "points": [[[0,0,0], [1,0,0]]], "radius": 1, "normals": [^[[0,0,1]]]}"#,
            "/shapes/0/normals/0: expected one for each of 2 points, found 1",
        ),
        (
            r#"{"type": "curves", "points": [[[0,0,0], [1,0,0]]], "radius": 1, "normals": ^[]}"#,
            "/shapes/0/normals: expected a list for each of 1 curves, found 0",
        ),
    ];
    for (text, expected) in cases {
        assert_fault_in_scene(&[(&shape(text), expected)]);
    }
    let fine = [
        r#"{"type": "sphere", "z_min": -1, "z_max": 3, "medium": {"type": "homogeneous", "absorption": 1}}"#,
        r#"{"type": "sphere", "z_min": -7, "z_max": 0.1, "phi_max": 1e-3}"#,
        r#"{"type": "disk", "inner_radius": 0, "phi_max": 360}"#,
        // Three corners, a trapezium, and a quadrilateral that is twisted by more than a right angle.
        r#"{"type": "bilinear_patch", "corners": [[0,0,0], [1,0,0], [0,0,0], [1,1,0]]}"#,
        r#"{"type": "bilinear_patch", "corners": [[0,0,0], [3,0,0], [1,1,0], [2,1,0]]}"#,
        r#"{"type": "bilinear_patch", "corners": [[0,0,0], [1,0,0], [1,1,1], [0,1,0]]}"#,
        // Coincident points, a mirrored curve, and a tip without a radius.
        r#"{"type": "curves", "points": [[[0,0,0], [0,0,0], [1,0,0], [1,0,0]]], "radius": 1}"#,
        r#"{"type": "curves", "points": [[[1,1,1], [1,1,1]]], "radius": 1}"#,
        r#"{"type": "curves", "points": [[[0,0,0], [1,0,0]]], "radius": [1, 0], "transform": [{"scale": [-2, 2, 2]}, {"rotate": {"axis": [1, 2, 3], "degrees": 77}}]}"#,
    ];
    for text in fine {
        assert!(read(scene(&shape(text))).is_ok(), "{text}");
        assert!(build(&scene(&shape(text))).is_ok(), "{text}");
    }
}

#[test]
fn names() {
    assert_fault_in_scene(&[
        (
            r#""shapes": [{"type": "group", "shapes": [{"type": "disk", "material": {"type": "diffuse", "albedo": ^"t"}}]}]"#,
            r#"/shapes/0/shapes/0/material/albedo: unknown texture "t""#,
        ),
        (
            r#""textures": {"a": {"type": "checker", "even": "b"}, "b": {"type": "checker", "odd": {"type": "checker", "even": ^"a"}}}"#,
            "/textures/b/odd/even: the texture contains itself: a → b → a",
        ),
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

/// A chain of `length` materials, each a mix of the next with itself: 2^length paths.
fn mixes(length: usize, shapes: &str) -> String {
    let link = |i: usize| format!(r#""m{i}": {{"type": "mix", "a": "m{}", "b": "m{}", "share": 0.5}},"#, i + 1, i + 1);
    let links: String = (1..length).map(link).collect();
    scene(&format!(r#""materials": {{{links} "m{length}": {{"type": "diffuse"}}}}, "shapes": [{shapes}]"#))
}

#[test]
fn materials_within_materials_are_limited() {
    assert!(read(mixes(8, "")).is_ok());
    let faults = read(mixes(10_000, "")).expect_err("too deep");
    assert_eq!(faults.len(), 1);
    assert!(faults[0].contains("/materials/m9992: materials lie within each other deeper than 8"), "{}", faults[0]);
}

/// Nested mixes that refer to other nested mixes by name are refused because of their number, without taking long.
#[test]
fn the_number_of_nested_materials_is_limited() {
    let wide = |of: &str| {
        let mix = |a: String| format!(r#"{{"type": "mix", "a": {a}, "b": {a}, "share": 0.5}}"#);
        (0..5).fold(format!("{of:?}"), |inner, _| mix(inner))
    };
    let links: Vec<String> = (1..7).map(|i| format!(r#""m{i}": {}"#, wide(&format!("m{}", i + 1)))).collect();
    let text = scene(&format!(
        r#""materials": {{{}, "m7": {{"type": "diffuse"}}}}, "shapes": [{{"type": "disk", "material": "m1"}}]"#,
        links.join(", ")
    ));
    let error = build(&text).expect_err("32^6 materials");
    assert!(error.to_string().contains("/materials: materials within materials make more than 4096 of them"), "{error}");
}

/// Nine kinds of glass in one surface refract light in nine directions and reflect it: more than the limit of branches.
#[test]
fn the_number_of_glasses_in_one_surface_is_limited() {
    let glass = |i: usize| format!(r#"{{"type": "dielectric", "eta": 1.{i}}}"#);
    let mixed = |count: usize| {
        let more = |inner: String, i: usize| format!(r#"{{"type": "mix", "a": {inner}, "b": {}, "share": 0.5}}"#, glass(i));
        scene(&format!(r#""shapes": [{{"type": "disk", "material": {}}}]"#, (2..=count).fold(glass(1), more)))
    };
    assert!(build(&mixed(7)).is_ok());
    let error = build(&mixed(8)).expect_err("nine directions");
    assert!(error.to_string().contains("/shapes/0/material: sends light into more than 8 single directions"), "{error}");
}

/// Curves stay round: a transform that stretches them, or a group that does, is refused.
#[test]
fn curves_are_not_stretched() {
    let curves = r#"{"type": "curves", "points": [[[0,0,0], [1,0,0]]], "radius": 1"#;
    let message = |shape: &str| match build(&scene(&format!(r#""shapes": [{shape}]"#))) {
        Err(pt::Error::Invalid(faults)) => faults[0].to_string(),
        _ => panic!("{shape} is built"),
    };
    let own = message(&format!(r#"{curves}, "transform": [{{"scale": [1, 2, 1]}}]}}"#));
    assert!(own.contains("/shapes/0/transform: curves stay round"), "{own}");
    let of_group = message(&format!(r#"{{"type": "group", "transform": [{{"scale": [1, 2, 1]}}], "shapes": [{curves}}}]}}"#));
    assert!(of_group.contains("/shapes/0/shapes/0/transform: curves stay round"), "{of_group}");
}
