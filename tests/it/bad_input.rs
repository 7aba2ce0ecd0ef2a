//! The table of bad inputs: what `pt` is given, its exit code and its message.
//!
//! Every row is given to the program itself. It never panics, prints one line for each fault, and leaves every file as it was if it refuses
//! the input. More detailed tests of bad input are in `reader` (truncation at every byte, mutations), `scene_faults`, `overrides` and
//! `meshes`.

mod bench;
mod disk;
mod hostile;
mod memory;
mod outside;

use std::collections::BTreeSet;
use std::fs;

use crate::pictures::{bomb, large_jpeg, promising, with_palette};
use bench::{Bench, RIGHT, SQUARE, UNLIT, long_name};

/// Case of the table: the row's name, the input, the exit code, and a part of the message.
///
/// Where the given text has a mark `^`, the message begins there: `scene.json:line:column: `.
type Row = (&'static str, &'static str, i32, &'static str);

/// Names of the rows of the table.
const ROWS: &str = "B1 B2 B3 B4 B5 B6 B7 B8 B9 B10 B11 B12 B13 B14 B15 B17 B18 B19 B20 B21 B24 B25 B26 B27 B28 B29 B33 B34 B35 B37 \
                    B39 B40 B41 B42 B43 B44 B45 B47 B52 B53 B54 B55 B16";

/// Whole scene files.
const TEXTS: &[Row] = &[
    ("B3", "^", 3, "empty, expected an object"),
    ("B3", "^ \n\t ", 3, "empty"),
    ("B4", "{\"pt\": 1, \"camera\": ^", 3, "expected a value after the colon"),
    ("B4", "^{\"pt\": 1", 3, "this { is never closed"),
    ("B4", "{^\"pt", 3, "unterminated string"),
    ("B5", "\u{feff}{\"pt\": 1, \"camera\": {}, \"film\": {\"width\": 8, \"height\": 6}}", 0, "no light"),
    ("B7", r#"{"pt": 1, "camera": {}, ^"camera": {}}"#, 3, r#"/camera: duplicate key "camera""#),
    (
        "B25",
        r#"{"pt": 1, "camera": {"look_at": ^{"from": [1, 2, 3], "to": [1, 2, 3]}}}"#,
        3,
        "/camera/look_at: from and to are the same point",
    ),
    (
        "B25",
        r#"{"pt": 1, "camera": {"look_at": ^{"from": [0, 3, 0], "to": [0, 0, 0]}}}"#,
        3,
        "/camera/look_at: up is parallel to the view direction",
    ),
    // Parallel, but for the rounding of 0.1 and 0.3.
    (
        "B25",
        r#"{"pt": 1, "camera": {"look_at": ^{"from": [0, 0, 0], "to": [0.1, 0.1, 0.1], "up": [0.3, 0.3, 0.3]}}}"#,
        3,
        "/camera/look_at: up is parallel",
    ),
    ("B26", r#"{"pt": 1, "camera": {"fov": ^0}}"#, 3, "/camera/fov: expected an angle in degrees above 0 and below 180, found 0"),
    ("B26", r#"{"pt": 1, "camera": {"fov": ^-1}}"#, 3, "/camera/fov: expected an angle"),
    ("B26", r#"{"pt": 1, "camera": {"fov": ^180}}"#, 3, "/camera/fov: expected an angle"),
    ("B26", r#"{"pt": 1, "camera": {"fov": ^NaN}}"#, 3, "expected a value, found the word NaN"),
    ("B26", r#"{"pt": 1, "camera": {"lens_radius": ^-1}}"#, 3, "/camera/lens_radius: expected a number of at least 0, found -1"),
    ("B26", r#"{"pt": 1, "camera": {"focus_distance": ^0}}"#, 3, "/camera/focus_distance: expected a number above 0, found 0"),
    ("B26", r#"{"pt": 1, "camera": {"fov": 40, "focal_length": ^50}}"#, 3, "/camera/focal_length: give fov or focal_length, not both"),
    ("B26", r#"{"pt": 1, "camera": {"f_number": ^0}}"#, 3, "/camera/f_number: expected an f-number from 0.01"),
    ("B26", r#"{"pt": 1, "camera": {"aperture": {"blades": ^2}}}"#, 3, "/camera/aperture/blades: expected 0, for a round opening, or at"),
    ("B26", r#"{"pt": 1, "camera": {"tilt": [0, ^-90]}}"#, 3, "/camera/tilt/1: expected an angle in degrees above -90 and below 90"),
    ("B26", r#"{"pt": 1, "camera": {"shift": [0, ^1e999]}}"#, 3, "/camera/shift/1: the number 1e999 is too large"),
    ("B26", r#"{"pt": 1, "camera": {"type": "fisheye", "fov": ^400}}"#, 3, "/camera/fov: expected an angle in degrees above 0 and at most"),
    ("B26", r#"{"pt": 1, "camera": {"type": "realistic", "lens": ^[]}}"#, 3, "/camera/lens: expected 1 to 100 surfaces, found 0"),
    ("B26", r#"{"pt": 1, "camera": {"type": "realistic", "lens": ^"none.dat"}}"#, 3, "/camera/lens: none.dat: no such file"),
    ("B26", r#"{"pt": 1, "camera": ^{"type": "realistic"}}"#, 3, "/camera: missing key \"lens\""),
    ("B39", r#"^{"pt": 1}"#, 3, "missing key \"camera\""),
];

/// Keys added to a camera and a small film.
const DARK: &[Row] = &[
    ("B39", r#""shapes": [{"type": "sphere"}]"#, 0, "warning: scene.json: no light, the image will be black\n"),
    ("B39", r#""shapes": [{"type": "sphere", "emission": 0}]"#, 0, "warning: scene.json: no light, the image will be black\n"),
    ("B39", r#""background": {"radiance": 1}"#, 0, "warning: scene.json: no shapes, the image will show the background alone\n"),
    ("B39", r#""background": {"radiance": 0}"#, 0, "warning: scene.json: no light, the image will be black\n"),
    (
        "B39",
        r#""lights": [{"type": "point", "position": [0, 0, 0], "intensity": 1}]"#,
        0,
        "warning: scene.json: no shapes and no background, the image will be black\n",
    ),
    ("B39", r#""shapes": [{"type": "sphere", "center": [0, 0, 9], "emission": 1}]"#, 0, "warning: the image is black\n"),
];

/// Keys added to a valid scene, which has a background and five lines before these.
const SCENES: &[Row] = &[
    (
        "B8",
        r#""materials": {"g": {"type": "matte_cone", "color": 1, "mattness": 1, ^"matness": 1}}"#,
        3,
        r#"/materials/g/matness: unknown key "matness", did you mean "mattness"?"#,
    ),
    ("B16", r#""materials": {"m": {"type": "mirror", "color": ^"t"}}"#, 3, r#"/materials/m/color: unknown texture "t""#),
    ("B20", r#""shapes": ^[{"type": "sphere", "center": [1e30, 0, 0]}]"#, 3, "/shapes: the scene's extent 1.000e30 exceeds 1e18"),
    ("B20", r#""shapes": ^[{"type": "quad", "size": 3e38}]"#, 3, "/shapes: the scene's extent 1.500e38 exceeds 1e18"),
    (
        "B20",
        r#""shapes": [^{"type": "mesh", "positions": [[0, 0, 0], [3e38, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]]}]"#,
        3,
        "/shapes/0: extent 3e38 exceeds 1e18",
    ),
    (
        "B20",
        r#""shapes": [{"type": "mesh", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]], "subdivision_levels": ^11}]"#,
        3,
        "/shapes/0/subdivision_levels: expected a whole number from 0 to 10, found 11",
    ),
    (
        "B20",
        r#""shapes": [{"type": "mesh", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "subdivision_levels": ^2,
        "triangles": [[0, 1, 2], [0, 1, 3]]}]"#,
        3,
        "/shapes/0/subdivision_levels: the two triangles at the edge from [0.0, 0.0, 0.0] to [1.0, 0.0, 0.0] are wound in opposite ways",
    ),
    (
        "B20",
        r#""shapes": [{"type": "mesh", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]],
        "displacement": {"texture": ^{"type": "noise", "on": "uv"}, "scale": 1}}]"#,
        3,
        "/shapes/0/displacement/texture: the mesh has no texture coordinates, over which this texture varies",
    ),
    (
        "B20",
        r#""shapes": [{"type": "mesh", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]],
        "displacement": {"texture": 1, "scale": ^1e19}}]"#,
        3,
        "/shapes/0/displacement/scale: extent 1e19 exceeds 1e18",
    ),
    // The origin is at the sphere next to the camera: at 10⁹ m a step of f32 is 2⁶ m.
    (
        "B21",
        r#""shapes": [{"type": "sphere"}, {"type": "sphere", "center": [1e9, 0, 0]}]"#,
        0,
        "scene.json: /shapes/1, diffuse: 2.0e0 m large, 1.0e9 m away from where the scene is finest: f32 steps by 6.4e1 m there",
    ),
    // Where coordinates are 16 m, rays start 2⁻¹⁹ · 16 m off a surface.
    (
        "B21",
        r#""materials": {"g": {"type": "dielectric"}}, "shapes": [{"type": "quad", "size": 1e-5}, {"type": "quad", "size": 1e-5},
        {"type": "quad", "material": "g", "name": "pane", "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": 180}}, {"translate": [0, 0, 16]}]},
        {"type": "quad", "material": "g", "transform": [{"translate": [0, 0, 16.000030517578125]}]}]"#,
        0,
        "scene.json: \"pane\", dielectric: this body is about 3.1e-5 m thick, and rays start 3.1e-5 m off its surface",
    ),
    (
        "B24",
        r#""shapes": [{"type": "disk", "transform": [{"scale": ^0}]}]"#,
        3,
        "/shapes/0/transform/0/scale: the transform has no inverse, because its determinant is 0",
    ),
    (
        "B24",
        r#""shapes": [{"type": "disk", "transform": [{"scale": ^[1, 0, 1]}]}]"#,
        3,
        "/shapes/0/transform/0/scale: the transform has no inverse",
    ),
    (
        "B24",
        r#""shapes": [{"type": "disk", "transform": [{"scale": ^1e-30}]}]"#,
        3,
        "/shapes/0/transform/0/scale: the transform scales volumes by 1.0e-90",
    ),
    (
        "B24",
        r#""shapes": [{"type": "disk", "transform": [{"scale": ^1e20}]}]"#,
        3,
        "/shapes/0/transform/0/scale: the transform scales volumes by 1.0e60",
    ),
    ("B24", r#""shapes": [{"type": "disk", "transform": [{"scale": ^NaN}]}]"#, 3, "expected a value, found the word NaN"),
    (
        "B24",
        r#""shapes": [{"type": "disk", "transform": [{"matrix": ^[1,2,3,0, 4,5,6,0, 7,8,9,0, 0,0,0,1]}]}]"#,
        3,
        "/shapes/0/transform/0/matrix: the transform has no inverse, because its determinant is 0",
    ),
    // The matrix has rank 2 in exact arithmetic, but not after rounding. It is small, so that no absolute threshold would find it.
    (
        "B24",
        r#""shapes": [{"type": "disk", "transform": [{"matrix": ^[1e-9,2e-9,3e-9,0, 4e-9,5e-9,6e-9,0, 7e-9,8e-9,9e-9,0, 0,0,0,1]}]}]"#,
        3,
        "/shapes/0/transform/0/matrix: the transform has no inverse, because its determinant is 0",
    ),
    (
        "B24",
        r#""shapes": [{"type": "disk", "transform": [{"matrix": ^[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,1,1]}]}]"#,
        3,
        "/shapes/0/transform/0/matrix: the last row is 0, 0, 1, 1, expected 0, 0, 0, 1",
    ),
    // Each transform is invertible, but their product is not, across steps and across a group.
    (
        "B24",
        r#""shapes": [{"type": "disk", "transform": ^[{"scale": 1e-9}, {"scale": 1e-9}]}]"#,
        3,
        "/shapes/0/transform: all steps together: the transform scales volumes by 1.0e-54",
    ),
    (
        "B24",
        r#""shapes": [{"type": "group", "transform": [{"scale": 1e9}], "shapes": [{"type": "disk", "transform": ^[{"scale": 1e9}]}]}]"#,
        3,
        "/shapes/0/shapes/0/transform: all steps together: the transform scales volumes by 1.0e54",
    ),
    (
        "B28",
        r#""integrator": {"type": "nee", "max_depth": ^-1}"#,
        3,
        "/integrator/max_depth: expected a whole number from 0 to 65535, found -1",
    ),
    (
        "B28",
        r#""integrator": {"type": "nee", "max_depth": ^65536}"#,
        3,
        "/integrator/max_depth: expected a whole number from 0 to 65535, found 65536",
    ),
    (
        "B40",
        r#""materials": {"gold": {"type": "mirror"}}, "shapes": [{"type": "disk", "material": ^"glod"}]"#,
        3,
        r#"/shapes/0/material: unknown material "glod", did you mean "gold"?"#,
    ),
    ("B40", r#""shapes": [{"type": "disk", "material": ^"gold"}]"#, 3, r#"/shapes/0/material: unknown material "gold", there are none"#),
    ("B40", r#""textures": {"a": {"type": "checker", "even": ^"a"}}"#, 3, "/textures/a/even: the texture contains itself: a → a"),
    (
        "B40",
        r#""materials": {"a": {"type": "coated", "ground": "b"}, "b": {"type": "mix", "a": {"type": "mirror"}, "b": ^"a", "share": 0.5}}"#,
        3,
        "/materials/b/b: the material contains itself: a → b → a",
    ),
    (
        "B40",
        r#""materials": {"m": {"type": "sheen", "ground": ^"cloth"}}"#,
        3,
        "/materials/m/ground: unknown material \"cloth\", expected m",
    ),
    (
        "B40",
        r#""materials": {"m": {"type": "coated", "ground": ^{"type": "masked", "surface": {"type": "mirror"}, "opacity": 0.5}}}"#,
        3,
        "/materials/m/ground: \"masked\" and \"bumped\" cannot be a part of this material",
    ),
    (
        "B40",
        r#""materials": {"r": {"type": "bumped", "surface": {"type": "mirror"}, "bump_map": 0}, "m": {"type": "bumped", "surface": ^"r", "bump_map": 0}}"#,
        3,
        "/materials/m/surface: a surface can have only one \"bumped\"",
    ),
    (
        "B40",
        r#""materials": {"r": {"type": "bumped", "surface": {"type": "mirror"}, "bump_map": 0}, "m": {"type": "bumped", "surface": ^{"type": "masked", "surface": "r", "opacity": 1}, "bump_map": 0}}"#,
        3,
        "/materials/m/surface: a surface can have only one \"bumped\"",
    ),
    ("B40", r#""materials": {"m": ^{"type": "bumped", "surface": {"type": "mirror"}}}"#, 3, "/materials/m: a bumped material needs either"),
    ("B40", r#""materials": {"m": ^{"type": "two_sided"}}"#, 3, "/materials/m: a two-sided material needs"),
    (
        "B40",
        r#""shapes": [{"type": "disk", "material": {"type": "two_sided", "front": ^{"type": "dielectric"}}}]"#,
        3,
        "/shapes/0/material/front: transmits light",
    ),
    (
        "B40",
        r#""materials": {"m": {"type": "masked", "surface": {"type": "mirror"}, "opacity": 0.5}},
"shapes": [{"type": "disk", "emission": 1, "material": ^"m"}]"#,
        3,
        "/shapes/0/material: what emits can have no holes",
    ),
    (
        "B41",
        r#""materials": {"m": {"type": "mix", "a": {"type": "mirror"}, "b": {"type": "diffuse"}, "share": ^2}}"#,
        3,
        "/materials/m/share: expected a number from 0 to 1, found 2",
    ),
    (
        "B41",
        r#""materials": {"m": ^{"type": "mix", "a": {"type": "mirror"}, "b": {"type": "diffuse"}}}"#,
        3,
        "/materials/m: a mix needs either \"share\" or \"fresnel\"",
    ),
    (
        "B42",
        r#""materials": {"m": {"type": "coated", "ground": {"type": "mirror"}, "eta": ^0.5}}"#,
        3,
        "/materials/m/eta: expected an index of refraction from 1 to 100, found 0.5",
    ),
    (
        "B42",
        r#""materials": {"m": {"type": "conductor", "metal": "Au", "color": ^[1, 0.8, 0.3]}}"#,
        3,
        "/materials/m/color: give metal or color, not both",
    ),
    (
        "B41",
        r#""materials": {"m": {"type": "diffuse", "albedo": ^1.1}}"#,
        3,
        "/materials/m/albedo: expected a number from 0 to 1, found 1.1",
    ),
    (
        "B41",
        r#""materials": {"m": {"type": "diffuse", "albedo": [0, ^-0.1, 0]}}"#,
        3,
        "/materials/m/albedo/1: expected a number from 0 to 1, found -0.1",
    ),
    ("B41", r#""materials": {"m": {"type": "diffuse", "albedo": ^NaN}}"#, 3, "expected a value, found the word NaN"),
    (
        "B42",
        r#""materials": {"m": {"type": "dielectric", "eta": ^0}}"#,
        3,
        "/materials/m/eta: expected an index of refraction from 0.01 to 100, found 0",
    ),
    ("B42", r#""materials": {"m": {"type": "dielectric", "eta": ^-1.5}}"#, 3, "/materials/m/eta: expected an index of refraction"),
    ("B42", r#""materials": {"m": {"type": "dielectric", "eta": ^1e9}}"#, 3, "/materials/m/eta: expected an index of refraction"),
    ("B42", r#""materials": {"m": {"type": "dielectric", "eta": ^NaN}}"#, 3, "expected a value, found the word NaN"),
    (
        "B42",
        r#""materials": {"m": {"type": "conductor", "eta": 1, "k": ^-1}}"#,
        3,
        "/materials/m/k: expected an extinction coefficient from 0 to 1000, found -1",
    ),
    ("B42", r#""materials": {"m": ^{"type": "conductor"}}"#, 3, "/materials/m: a conductor needs \"metal\", or \"eta\" and \"k\""),
    ("B42", r#""materials": {"m": ^{"type": "conductor", "eta": 1}}"#, 3, "/materials/m: missing key \"k\""),
    (
        "B42",
        r#""materials": {"m": {"type": "conductor", "metal": "Au", "eta": ^1}}"#,
        3,
        "/materials/m/eta: give metal, or eta and k, not both",
    ),
    ("B43", r#""materials": {"m": {"type": "dielectric", "roughness": ^1.1}}"#, 3, "/materials/m/roughness: expected a number from 0 to 1"),
    (
        "B43",
        r#""materials": {"m": {"type": "dielectric", "roughness": ^-0.1}}"#,
        3,
        "/materials/m/roughness: expected a number from 0 to 1",
    ),
    (
        "B43",
        r#""materials": {"m": {"type": "dielectric", "roughness": 0.5, "alpha": ^0.1}}"#,
        3,
        "/materials/m/alpha: give alpha, or roughness and anisotropy, not both",
    ),
    (
        "B43",
        r#""materials": {"m": {"type": "matte_cone", "color": 1, "mattness": ^-0.1}}"#,
        3,
        "/materials/m/mattness: expected a number from 0 to 1",
    ),
    (
        "B43",
        r#""materials": {"m": {"type": "matte_cone", "color": 1, "mattness": ^1.1}}"#,
        3,
        "/materials/m/mattness: expected a number from 0 to 1",
    ),
    ("B43", r#""materials": {"m": {"type": "matte_cone", "color": 1, "mattness": ^NaN}}"#, 3, "expected a value, found the word NaN"),
    ("B43", r#""shapes": [{"type": "sphere", "material": {"type": "matte_cone", "color": 1, "mattness": 1e-9}}]"#, 0, "8×6"),
    ("B44", r#""shapes": [{"type": "disk", "emission": ^-1}]"#, 3, "/shapes/0/emission: expected a number from 0 to 1e30, found -1"),
    ("B44", r#""shapes": [{"type": "disk", "emission": ^1e38}]"#, 3, "/shapes/0/emission: expected a number from 0 to 1e30, found 1"),
    (
        "B44",
        r#""shapes": [{"type": "disk", "emission": {"radiance": [1, 2, ^1e39]}}]"#,
        3,
        "/shapes/0/emission/radiance/2: the number 1e39 is too large",
    ),
    ("B44", r#""shapes": [{"type": "disk", "emission": ^Infinity}]"#, 3, "expected a value, found the word Infinity"),
    ("B42", r#""materials": {"m": {"type": "dielectric", "abbe": ^0}}"#, 3, "/materials/m/abbe: expected a number above 0, found 0"),
    (
        "B42",
        r#""materials": {"m": {"type": "thin_film", "thickness": ^-1}}"#,
        3,
        "/materials/m/thickness: expected a thickness in nanometres from 0 to 2000, found -1",
    ),
    (
        "B45",
        r#""media": {"m": {"type": "homogeneous", "scattering": 1, "phase": {"type": "henyey_greenstein", "g": ^1}}}"#,
        3,
        "/media/m/phase/g: expected a number from -0.999 to 0.999, found 1",
    ),
    (
        "B45",
        r#""media": {"m": {"type": "homogeneous", "scattering": ^-1}}"#,
        3,
        "/media/m/scattering: expected a number from 0 to 1e30, found -1",
    ),
    ("B45", r#""media": {"m": {"type": "homogeneous", "absorption": ^1e38}}"#, 3, "/media/m/absorption: expected a number from 0 to 1e30"),
    (
        "B47",
        r#""shapes": [{"type": "disk", "transform": [{"keyframes": [{"time": 0}, {"time": ^0}]}]}]"#,
        3,
        "/shapes/0/transform/0/keyframes/1/time: expected a time after that of the keyframe before it, 0 s, found 0",
    ),
    (
        "B47",
        r#""shapes": [{"type": "disk", "transform": [{"keyframes": [{"time": 1}, {"time": ^0.5}]}]}]"#,
        3,
        "/shapes/0/transform/0/keyframes/1/time: expected a time after that of the keyframe before it, 1 s, found 0.5",
    ),
    ("B47", r#""shapes": [{"type": "disk", "transform": [{"keyframes": [{"time": ^NaN}]}]}]"#, 3, "expected a value, found the word NaN"),
    (
        "B47",
        r#""shapes": [{"type": "disk", "transform": [{"keyframes": ^[]}]}]"#,
        3,
        "/shapes/0/transform/0/keyframes: expected at least one keyframe",
    ),
    ("B47", r#""shutter": {"open": 1, "close": ^0}"#, 3, "/shutter/close: expected a time from 1 s on, when the shutter opens, found 0"),
    (
        "B47",
        r#""shapes": [{"type": "disk", "transform": [{"rotate": {"axis": ^[0, 0, 0], "degrees": 10}}]}]"#,
        3,
        "/shapes/0/transform/0/rotate/axis: expected a direction, found [0, 0, 0]",
    ),
    (
        "B47",
        r#""shapes": [{"type": "disk", "transform": ^[{"keyframes": [{"time": 0}, {"time": 1, "transform": [{"scale": -1}]}]}]}]"#,
        3,
        "/shapes/0/transform: keyframe 1 mirrors and keyframe 0 does not",
    ),
    ("B24", r#""shapes": [{"type": "cone", "radius": ^0, "height": 1}]"#, 3, "/shapes/0/radius: expected a number above 0, found 0"),
    (
        "B24",
        r#""shapes": [{"type": "cylinder", "radius": 1, "z_min": 1, "z_max": ^1}]"#,
        3,
        "/shapes/0/z_max: expected a number above 1, that of z_min, found 1",
    ),
    (
        "B24",
        r#""shapes": [{"type": "disk", "radius": 1, "inner_radius": ^1}]"#,
        3,
        "/shapes/0/inner_radius: expected a number below 1, that of radius, found 1",
    ),
    (
        "B24",
        r#""shapes": [{"type": "curves", "basis": "bspline", "points": [^[[0, 0, 0], [1, 0, 0]]], "radius": 0.1}]"#,
        3,
        "/shapes/0/points/0: expected at least four for a B-spline, found 2",
    ),
];

/// Names of mesh and picture files, as JSON. The files need not exist; there is no message about those that do.
const PATHS: &[Row] = &[
    ("B35", "\"../mesh.obj\"", 3, "../mesh.obj: leads out of the scene file's folder; if it may, say --allow-outside\n"),
    ("B35", "\"folder/../../mesh.obj\"", 3, "folder/../../mesh.obj: leads out of the scene file's folder"),
    ("B35", "\"../../../../../../../../etc/passwd\"", 3, "../../../../../../../../etc/passwd: leads out of the scene file's folder"),
    ("B35", "\"..\\\\mesh.obj\"", 3, "..\\mesh.obj: leads out of the scene file's folder"),
    ("B35", "\"/etc/passwd\"", 3, "/etc/passwd: is no path from the scene file's folder; if it may, say --allow-outside\n"),
    ("B35", "\"~/mesh.obj\"", 3, "~/mesh.obj: is no path from the scene file's folder"),
    ("B35", "\"\\\\\\\\server\\\\share\\\\mesh.obj\"", 3, "\\\\server\\share\\mesh.obj: is no path from the scene file's folder"),
    ("B35", "\"C:\\\\mesh.obj\"", 3, "C:\\mesh.obj: is no path from the scene file's folder"),
    ("B35", "\"mesh\\u0000.obj\"", 3, "a file name with control characters\n"),
    ("B35", "\"\"", 3, "an empty file name\n"),
    ("B35", "\"folder/../none.obj\"", 3, "folder/../none.obj: no such file\n"),
    #[cfg(unix)]
    ("B35", "\"link.obj\"", 3, "link.obj: is a link out of the scene file's folder; if it may, say --allow-outside\n"),
    ("B35", "\"folder\"", 3, "folder: not a regular file\n"),
];

/// A sphere's radius in place of `NUMBER`.
const NUMBERS: &[Row] = &[
    ("B9", "1e39", 3, "/shapes/0/radius: the number 1e39 is too large for a 32-bit float"),
    ("B9", "-1e39", 3, "/shapes/0/radius: the number -1e39 is too large"),
    ("B9", "1e400", 3, "/shapes/0/radius: the number 1e400 is too large"),
    ("B9", "3.4028236e38", 3, "/shapes/0/radius: the number 3.4028236e38 is too large"),
    ("B9", "1e-50", 3, "/shapes/0/radius: the number 1e-50 is too small"),
    ("B9", "1e-400", 3, "/shapes/0/radius: the number 1e-400 is too small"),
    ("B9", "\"1\"", 3, "/shapes/0/radius: expected a number, found the string \"1\": remove the quotes"),
    ("B9", "+1", 3, "a number may not start with +"),
    ("B9", ".5", 3, "a number needs digits on both sides of its point"),
    ("B9", "NaN", 3, "expected a value, found the word NaN"),
    ("B9", "Infinity", 3, "expected a value, found the word Infinity"),
    ("B9", "-Infinity", 3, "expected a number, found -Infinity"),
];

/// The film, or its sampler.
const FILMS: &[Row] = &[
    ("B9", r#""film": {"width": 0^1}"#, 3, "a number may not start with 0"),
    ("B27", r#""film": {"width": ^0}"#, 3, "/film/width: expected a whole number from 1 to 65536, found 0"),
    ("B27", r#""film": {"width": ^-1}"#, 3, "/film/width: expected a whole number from 1 to 65536, found -1"),
    ("B27", r#""film": {"width": ^1.5}"#, 3, "/film/width: expected a whole number, found 1.5"),
    ("B27", r#""film": {"height": ^65537}"#, 3, "/film/height: expected a whole number from 1 to 65536, found 65537"),
    ("B27", r#""film": {"height": ^4294967295}"#, 3, "/film/height: expected a whole number from 1 to 65536"),
    // 65536² pixels of 64 + 196 bytes are 1040 · 2³⁰ bytes.
    ("B27", r#""film": ^{"width": 65536, "height": 65536}"#, 4, "/film: the picture needs 1808 GiB of memory, "),
    ("B28", r#""sampler": {"spp": ^0}"#, 3, "/sampler/spp: expected a whole number from 1 to 4294967295, found 0"),
    ("B28", r#""sampler": {"spp": ^4294967296}"#, 3, "/sampler/spp: expected a whole number from 1 to 4294967295"),
    ("B29", r#""film": {"crop": ^[0, 0, 0, 10]}"#, 3, "/film/crop: the crop [x0, x1, y0, y1] is empty"),
    ("B29", r#""film": {"crop": ^[20, 10, 0, 10]}"#, 3, "/film/crop: the crop [x0, x1, y0, y1] is empty"),
    ("B29", r#""film": {"crop": ^[0, 513, 0, 10]}"#, 3, "/film/crop: the crop reaches to 513, 10, beyond the image of 512 × 512"),
    ("B29", r#""film": {"crop": [^-1, 5, 0, 10]}"#, 3, "/film/crop/0: expected a whole number from 0 to 4294967295, found -1"),
];

/// Text after the four vertices in `mesh.obj`, from line 5 on.
const MESHES: &[Row] = &[
    ("B10", "f 0 1 2", 3, "mesh.obj:5: vertex index 0, but indices count from 1"),
    ("B10", "f 1 2 5", 3, "mesh.obj:5: vertex index 5, but only 4 vertices so far"),
    ("B10", "# a comment\n\nf 1 2 -5", 3, "mesh.obj:7: vertex index -5, but only 4 vertices so far"),
    ("B10", "f 1 2 999999999999", 3, "mesh.obj:5: vertex index 999999999999, but only 4 vertices"),
    ("B11", "v 0 nan 0", 3, "mesh.obj:5: y: nan is not a finite number"),
    ("B11", "v 0 inf 0", 3, "mesh.obj:5: y: inf is not a finite number"),
    ("B11", "v 0 -1.#IND00 0", 3, "mesh.obj:5: y: -1.#IND00 is not a finite number"),
    ("B11", "v 0 0 1e39", 3, "mesh.obj:5: z: 1e39 is beyond the range of f32"),
    ("B11", "v 1,5 0 0", 3, "mesh.obj:5: x: expected a number, found 1,5"),
    ("B12", "v 1 2", 3, "mesh.obj:5: a vertex needs x, y and z, but z is missing"),
    ("B12", "f 1/1 2/1 3/1", 3, "mesh.obj:5: texture coordinate index 1, but only 0 texture coordinates so far"),
    ("B12", "f 1//1 2//1 3//1", 3, "mesh.obj:5: normal index 1, but only 0 normals so far"),
    ("B13", "f 1", 3, "mesh.obj:5: a face with 1 corner, at least 3 are needed"),
    ("B13", "f 1 2", 3, "mesh.obj:5: a face with 2 corners, at least 3 are needed"),
    ("B13", "f 1 2 2 3 4", 0, "mesh.obj: 1 degenerate triangle dropped"),
    ("B13", "f 1 3 2 4", 0, "8×6"),
    ("B14", "", 3, "/shapes/0/file: mesh.obj: no faces"),
    ("B14", "# a comment", 3, "/shapes/0/file: mesh.obj: no faces"),
    ("B14", "f 1 2 3\r\nf 1 3 4\r\n", 0, "8×6"),
    ("B14", "f 1 2 \\\n3", 0, "8×6"),
    ("B15", "f 1 2 3\nf 1 2", 3, "mesh.obj:6: a face with 2 corners"),
    ("B15", "f 1 2 3\nv 1 2 3e", 3, "mesh.obj:6: z: expected a number, found 3e"),
    ("B17", "vn 0 0 0\nvn 0 0 1\nf 1//1 2//2 3//2", 0, "mesh.obj: 1 normal without direction replaced by the face normal"),
    ("B17", "vn nan 0 1\nvn 0 0 1\nf 1//1 2//2 3//2", 0, "mesh.obj: 1 normal without direction replaced by the face normal"),
    ("B18", "f 1 1 2\nf 3 3 4", 3, "/shapes/0/file: mesh.obj: no usable triangles (all 2 are degenerate)"),
    ("B20", "v -1e30 0 0\nv 1e30 0 0\nf 1 5 6\n", 3, "/shapes/0/file: mesh.obj: extent 2e30 exceeds 1e18"),
    ("B20", "v 3e38 0 0\nf 1 2 5\nf 2 3 5", 3, "/shapes/0/file: mesh.obj: extent 3e38 exceeds 1e18"),
    // The vertices are one metre apart, but round to one point in f32, because they are so far from the origin.
    ("B20", "v 1e30 0 0\nv 1000000000000000000000000000001 0 0\nv 1e30 1 0\nf 5 6 7", 3, "mesh.obj: extent 1e30 exceeds 1e18"),
    // At 1.6·10⁷, just below 2²⁴, f32 steps by 1.
    (
        "B21",
        "f 1 2 3\nv 16000000 0 0\nv 16000000 1 0\nf 5 6 1",
        0,
        "mesh.obj: extent 1.6e7 is 1.6e7 times the finest detail 1e0; f32 steps by 1e0 out there (one ulp)",
    ),
];

/// Arguments, with spaces between them.
const CALLS: &[Row] = &[
    ("B1", "missing.json", 3, "error: missing.json: no such file"),
    ("B1", "right.json/scene.json", 3, "error: right.json/scene.json: no such file"),
    ("B1", "check missing.json", 3, "error: missing.json: no such file"),
    ("B2", "folder", 3, "error: folder: not a regular file"),
    ("B28", "right.json --spp 0", 2, "'0' for '--spp <SPP>': expected a whole number from 1 to 4294967295"),
    ("B28", "right.json --spp 4294967296", 2, "expected a whole number from 1 to 4294967295"),
    ("B28", "right.json --spp 1.5", 2, "expected a whole number from 1 to 4294967295"),
    ("B28", "right.json --spp -1", 2, "'-1' for '--spp <SPP>': expected a whole number from 1 to 4294967295"),
    ("B28", "right.json --seed -1", 2, "'-1' for '--seed <SEED>': expected a whole number from 0 to 18446744073709551615"),
    ("B28", "right.json -t -1", 2, "'-1' for '--threads <THREADS>': expected a whole number from 1 to 1024"),
    ("B28", "right.json -t 0", 2, "'0' for '--threads <THREADS>': expected a whole number from 1 to 1024"),
    ("B28", "right.json -t 1000000", 2, "expected a whole number from 1 to 1024"),
    ("B27", "right.json --size 0x4", 2, "'0x4' for '--size <WxH>': expected a size from 1x1 to 65536x65536"),
    ("B27", "right.json --size 65537x1", 2, "expected a size from 1x1 to 65536x65536"),
    ("B27", "right.json --size -1x5", 2, "'-1x5' for '--size <WxH>': expected a size such as 640x480"),
    ("B27", "right.json --size 65536x65536", 4, "error: --size 65536x65536: /film/width: the picture needs 1040 GiB of memory, "),
    ("B55", "right.json --resume=scene.exr -o x.exr", 3, "error: scene.exr: expected a part of a render (.ptc)"),
    ("B55", "right.json --resume=none.ptc -o x.exr", 3, "error: none.ptc: no such file"),
    ("B55", "right.json --resume=folder -o x.exr", 3, "error: folder: not a regular file"),
    ("B55", "right.json --resume none.ptc -o x.exr", 2, "--resume none.ptc: expected --resume=none.ptc"),
    ("B55", "merge right.json -o x.exr", 3, "error: right.json: expected a part of a render (.ptc)"),
    ("B55", "merge pipe -o x.exr", 3, "error: pipe: not a regular file"),
    ("B55", "merge -o x.exr", 2, "<PART>"),
    ("B55", "right.json --shard 2/2 -o x.ptc", 2, "--shard 2/2: there are only 1 samples per pixel to share out"),
    ("B29", "right.json --crop 5,2,0,1", 2, "error: --crop 5,2,0,1: /film/crop: the crop [x0, x1, y0, y1] is empty"),
    ("B29", "right.json --crop 0,9,0,1", 2, "error: --crop 0,9,0,1: /film/crop: the crop reaches to 9, 1, beyond the image of 8 × 6"),
    ("B29", "right.json --crop -1,9,0,1", 2, "'-1,9,0,1' for '--crop <X0,X1,Y0,Y1>': expected 4 whole numbers"),
    (
        "B29",
        "right.json --size 4x4 --crop 0,8,0,6",
        2,
        "error: --crop 0,8,0,6: /film/crop: the crop reaches to 8, 6, beyond the image of 4 × 4",
    ),
    ("B37", "right.json -o no/such/x.exr", 5, "error: no/such/x.exr: there is no folder no/such\n"),
    ("B37", "right.json -o right.json/x.exr", 5, "error: right.json/x.exr: Not a directory (os error 20)\n"),
    ("B37", "scene.exr -o scene.exr", 2, "error: scene.exr: is the scene file, which would be overwritten"),
    ("B37", "right.json -o folder.exr", 2, "error: folder.exr: is a folder, expected a file"),
    ("B37", "right.json -o x.jpg", 2, "error: x.jpg: expected a name that ends in .exr, .hdr, .png, .ppm or .pfm"),
    ("B37", "right.json -o folder/.exr", 2, "expected a name that ends in"),
    ("B37", "right.json -o x.exr -o ./x.exr", 2, "error: ./x.exr: given twice as an output"),
    ("B52", "", 2, "expected a scene"),
    ("B52", "right.json -D /camera/fov", 2, "expected /POINTER=VALUE"),
    ("B52", "right.json -D camera/fov=1", 2, "-D camera/fov=1: expected a JSON pointer such as /camera/fov"),
    ("B52", "right.json -D /camra/fov=40", 2, "unknown key"),
    ("B52", "right.json -D /camera/fov=400", 2, "-D /camera/fov=400: /camera/fov: expected an angle"),
    ("B52", "right.json -D /camera/fov=\"x\"", 2, "/camera/fov: expected a number, found the string \"x\""),
    ("B52", "right.json -D /integrator={\"type\":\"nee\",\"max_dept\":1}", 2, "did you mean \"max_depth\"?"),
    ("B52", "right.json --nonsense", 2, "unexpected argument '--nonsense' found"),
    ("B52", "right.json --nonsense", 2, "Usage: pt"),
    (
        "B52",
        "right.json --json-errors --nonsense",
        2,
        "{\"errors\":[{\"message\":\"unexpected argument '--nonsense' found\"}],\"exit_code\":2}\n",
    ),
    ("B52", "right.json --json-errors --sample 1", 2, "required arguments were not provided: --pixel <X,Y>\"}],\"exit_code\":2}\n"),
    (
        "B52",
        "right.json -- --json-errors",
        2,
        "error: unexpected \"--json-errors\": one scene at a time, and options before a --; see pt --help\n",
    ),
    ("B52", "farm slurm right.json", 2, "error: unexpected \"right.json\": one scene at a time"),
    ("B52", "right.json right.json", 2, "error: unexpected \"right.json\": one scene at a time"),
    ("B52", "right.json check", 2, "error: check: a command comes first, as in pt check scene.json; see pt --help\n"),
    ("B52", "chek right.json", 2, "error: unknown command \"chek\", did you mean \"check\"? See pt --help\n"),
    ("B52", "right.json --stats json", 2, "error: --stats json: expected --stats=json\n"),
    (
        "B52",
        "right.json --json-errors --stats json",
        2,
        "{\"errors\":[{\"message\":\"--stats json: expected --stats=json\"}],\"exit_code\":2}\n",
    ),
    (
        "B52",
        "right.json --json-errors -D /camera/fov=0 -D /film/width=0",
        2,
        "{\"errors\":[{\"message\":\"-D /camera/fov=0: /camera/fov: expected an angle in degrees above 0 and below 180, found 0\"},\
         {\"message\":\"-D /film/width=0: /film/width: expected a whole number from 1 to 65536, found 0\"}],\"exit_code\":2}\n",
    ),
    // The message is about the fault of the file, not about the override that has no place in it.
    ("B52", "list.json --spp 1", 3, "error: list.json:1:1: expected an object, found an array of 0\n"),
    ("B52", "list.json -D /camera/fov=60", 3, "error: list.json:1:1: expected an object, found an array of 0\n"),
    ("B52", "right.json --pixel 8,0", 2, "the picture is 8 × 6"),
    ("B52", "right.json --pixel 1", 2, "expected 2 whole numbers"),
    ("B52", "right.json --time soon", 2, "expected a duration such as 30s"),
    ("B52", "right.json -i pathh", 2, "unknown integrator \"pathh\", did you mean \"path\"?"),
    ("B52", "right.json --sampler sobel", 2, "unknown sampler \"sobel\", did you mean \"sobol\"?"),
    ("B52", "list everything", 2, "everything"),
    ("B54", "szene-ä-🫖.json -o x.exr", 0, "8×6"),
    ("B54", "-o x.exr -- -dash.json", 0, "8×6"),
    // Inputs that are devices.
    #[cfg(unix)]
    ("B2", "pipe", 3, "error: pipe: not a regular file"),
    #[cfg(unix)]
    ("B2", "/dev/zero", 3, "error: /dev/zero: not a regular file"),
];

/// A table: the function that gives an input to the program, and its rows.
struct Table(fn(&mut Bench, &Row), &'static [Row]);

const TABLES: &[Table] = &[
    Table(|bench, &(row, text, code, phrase)| bench.scene(row, text, code, phrase), TEXTS),
    Table(|bench, &(row, keys, code, phrase)| bench.scene(row, &format!("{RIGHT},\n{keys}}}"), code, phrase), SCENES),
    Table(|bench, &(row, keys, code, phrase)| bench.scene(row, &format!("{UNLIT}, {keys}}}"), code, phrase), DARK),
    Table(|bench, &(row, keys, code, phrase)| bench.scene(row, &format!("{{\"pt\": 1, \"camera\": {{}},\n{keys}}}"), code, phrase), FILMS),
    Table(|bench, &(row, statements, code, phrase)| bench.mesh(row, statements, code, phrase), MESHES),
    Table(
        |bench, &(row, number, code, phrase)| {
            bench.scene(row, &format!("{RIGHT}, \"shapes\": [{{\"type\": \"sphere\", \"radius\": ^{number}}}]}}"), code, phrase);
        },
        NUMBERS,
    ),
    Table(|bench, &(row, name, code, phrase)| bench.file(row, name, code, phrase), PATHS),
    Table(|bench, &(row, args, code, phrase)| bench.call(row, &args.split_whitespace().collect::<Vec<_>>(), code, phrase), CALLS),
];

#[test]
fn every_row_of_the_table_is_refused_or_warned_of_as_it_says() {
    let mut bench = Bench::new();
    for Table(feed, rows) in TABLES {
        rows.iter().for_each(|row| feed(&mut bench, row));
    }
    generated(&mut bench);

    let wanted: BTreeSet<&str> = ROWS.split_whitespace().collect();
    assert_eq!(bench.met, wanted, "the rows of the table");
    assert!(bench.wrong.is_empty(), "{}", bench.wrong.join("\n"));
}

/// Inputs that are too long or too binary for a line of the table.
fn generated(bench: &mut Bench) {
    bench.file("B35", &format!("\"{}\"", "x".repeat(5000)), 3, "a file name of 5000 bytes, expected at most 4096\n");
    let mut png = std::io::Cursor::new(vec![]);
    image::RgbImage::new(8, 8).write_to(&mut png, image::ImageFormat::Png).expect("encoded");
    let png = png.into_inner();
    for (row, bytes, code, phrase) in [
        ("B33", &png[..png.len() / 2], 3, "/shapes/0/material/albedo/file: p.jpg: not a usable PNG picture"),
        ("B33", &bomb(png.clone()), 4, "p.jpg: the picture would take more than 4 GiB"),
        // The picture has 2.7 GB as bytes, and four times that as floats.
        ("B33", &promising(png.clone(), 30000, 8), 4, "p.jpg: the picture would take more than 4 GiB"),
        // The palette has one and a third colours.
        ("B33", &with_palette(4), 3, "/shapes/0/material/albedo/file: p.jpg: not a usable PNG picture: "),
        ("B33", &with_palette(3), 0, "warning: p.jpg: read as PNG"),
        ("B33", &*large_jpeg(), 3, "p.jpg: not a usable JPEG picture: "),
        ("B34", &png, 0, "warning: p.jpg: read as PNG, which its first bytes say it is\n"),
    ] {
        fs::write(bench.folder.path().join("p.jpg"), bytes).expect("write");
        let matte = r#""shapes": [{"type": "disk", "material": {"type": "diffuse", "albedo": {"type": "image", "file": "p.jpg"}}}]"#;
        bench.scene(row, &format!("{RIGHT},\n{matte}}}"), code, phrase);
        if code != 0 {
            let unreadable = if bytes.starts_with(b"\xff\xd8") {
                "bytes cannot hold 15855 × 15625 pixels"
            } else {
                "p.jpg: not a readable PNG picture: "
            };
            let phrase = if code == 4 { phrase } else { unreadable };
            bench.call(row, &["image", "info", "p.jpg"], code, phrase);
        }
    }
    bench.bytes("B5", b"{\n \"\xFF\": 1}", 3, "scene.json:2:3: byte 4: not UTF-8");
    let utf16: Vec<u8> = "{\"pt\": 1}".encode_utf16().flat_map(u16::to_le_bytes).collect();
    bench.bytes("B5", &utf16, 3, "scene.json:1:1: byte 0: this is UTF-16 or UTF-32, expected UTF-8");
    for depth in [129, 1_000_000] {
        let text = format!("{}^{}", "[".repeat(128), "[".repeat(depth - 128));
        bench.scene("B6", &text, 3, "lists and objects nest deeper than 128");
    }
    bench.mesh("B14", &format!("# {}\nf 1 2 3", "x".repeat(10_000_000)), 0, "8×6");
    bench.mesh("B19", &"f 1 2 3\n".repeat(100_000), 0, "mesh.obj: 99999 duplicate triangles dropped");
    let lamp = r#", "shapes": [{"type": "mesh", "file": "mesh.obj", "emission": 1}]}"#;
    for (faces, code, phrase) in
        [("f 1 1 2", 3, "no usable triangles (all 1 are degenerate)"), ("f 1 1 2\nf 1 2 3", 0, "1 degenerate triangle dropped")]
    {
        fs::write(bench.folder.path().join("mesh.obj"), format!("{SQUARE}{faces}")).expect("write");
        bench.scene("B18", &format!("{RIGHT}{lamp}"), code, phrase);
    }
    let link = |i: usize| format!("\"t{i}\": {{\"type\": \"checker\", \"even\": \"t{}\", \"odd\": \"t{}\"}},", i + 1, i + 1);
    let links: String = (1..10_000).map(link).collect();
    let deep = format!("{RIGHT}, \"textures\": {{{links} \"t10000\": {{\"type\": \"constant\", \"color\": 1}}}}}}");
    bench.scene("B40", &deep, 3, "textures lie within each other deeper than 64");
    bench.call("B54", &["with space.json", "-o", "x.exr"], 0, "8×6");
    bench.call("B54", &[&long_name(), "-o", "x.exr"], 0, "8×6");

    let mut command = bench.command();
    command.arg("right.json").env("PT_THREADS", "abc");
    bench.judge(
        "B53",
        "PT_THREADS=abc",
        command,
        2,
        "'abc' for '--threads <THREADS>': expected a whole number from 1 to 1024 (in --threads or PT_THREADS)",
    );
}
