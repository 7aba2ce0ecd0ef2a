//! The table of docs/import.md: each row is tested with a scene.

use super::{SCENE, TETRAHEDRON, files};
use crate::import::dialect::{Outcome, folder, table};

/// Each construct of the page, with changes to [`SCENE`] that each contain the construct.
const ROWS: &[(&str, &[(&str, &str)])] = &[
    ("`camera.focalPoint`", &[]),
    ("`camera.direction`, of any length, with `xAngle` and `yAngle`", &[("\"x\": 2, ", "\"x\": 2e9, ")]),
    ("`camera.direction` along z, which is up", &[("\"x\": 2, ", "\"x\": 0, ")]),
    ("`camera.tlCorner`, `brCorner` instead, of older files", &[(ANGLES, CORNERS)]),
    ("corners that are not equally far from the focal point", &[(ANGLES, OBLIQUE)]),
    ("`camera.xReso`, `yReso`", &[("\"xReso\": 12", "\"xReso\": 1")]),
    ("`materials`, an empty list", &[("\"materials\": [", "\"materials\": [], \"old\": [")]),
    ("`color`", &[("\"r\": 0,", "\"r\": 0.5,")]),
    ("`color` below 0 or above 1", &[("\"r\": 0,", "\"r\": -0.5,"), ("\"r\": 0,", "\"r\": 1.5,")]),
    ("`isLuminous`: true", &[("\"isLuminous\": true", "\"type\": \"any\", \"isLuminous\": true")]),
    ("`isLuminous`: \"true\" or \"false\", in quotes", &[("\"isLuminous\": true", "\"isLuminous\": \"true\"")]),
    ("`type`: specular", &[]),
    ("`type`: diffuse, with `mattness`", &[("\"mattness\": 0.4", "\"mattness\": 0"), ("\"mattness\": 0.4", "\"mattness\": 1")]),
    ("`mattness` below 0 or above 1", &[("\"mattness\": 0.4", "\"mattness\": -0.4"), ("\"mattness\": 0.4", "\"mattness\": 1.4")]),
    ("`type`: transparent, with `refIndex` or `reflIndex`", &[("refIndex", "reflIndex")]),
    ("`type`: any other", &[("specular", "shiny")]),
    ("an object in the list of materials", &[("\"comment\": \"Light\",", "\"path\": \"./tetrahedron.obj\" }, {")]),
    ("`comment`", &[("\"Lamp\"", "\"\"")]),
    (
        "`index`, `colorRem` that say what holds",
        &[("\"Light\",", "\"Light\", \"index\": 0, \"colorRem\": { \"r\": 1, \"g\": 0.75, \"b\": 0.5 },")],
    ),
    (
        "`index`, `colorRem` that say something else",
        &[("\"Light\",", "\"Light\", \"index\": 1,"), ("\"Light\",", "\"Light\", \"colorRem\": { \"r\": 1, \"g\": 0, \"b\": 0 },")],
    ),
    ("`objects[].type`: mesh", &[]),
    ("`objects[].type`: any other", &[("\"type\": \"mesh\"", "\"type\": \"sphere\"")]),
    ("`path`", &[("./tetrahedron", "tetrahedron")]),
    ("`path` to no file, or out of the scene's folder", &[("./tetra", "./ultra"), ("./tetra", "../tetra")]),
    ("`materialIndex`", &[("\"materialIndex\": 0", "\"materialIndex\": 1")]),
    ("`materialIndex` of no material", &[("\"materialIndex\": 0", "\"materialIndex\": 7")]),
    ("`midpoint` or `midPoint`, `height`, `xrot`, `yrot`, `zrot`", &[("midpoint", "midPoint"), ("\"height\": 4", "\"height\": 1e3")]),
    ("`height` of 0 or less", &[("\"height\": 4", "\"height\": 0"), ("\"height\": 4", "\"height\": -4")]),
    ("a mesh that is flat in z as it is turned", &[("./tetrahedron.obj", "flat.obj"), (UPRIGHT, LYING)]),
    ("a missing key", &[("\"zrot\": 0 ", ""), ("\"focalPoint\"", "\"focal\""), ("\"camera\"", "\"kamera\""), ("\"color\"", "\"colour\"")]),
    ("a key that is there twice", &[("\"height\": 4", "\"height\": 4, \"height\": 4")]),
    ("any other key", &[("\"height\": 4", "\"height\": 4, \"width\": 3"), ("\"xReso\"", "\"aperture\": 1, \"xReso\"")]),
];

const ANGLES: &str = "\"direction\": { \"x\": 2, \"y\": 0, \"z\": -0.25 },\n    \"xAngle\": 20, \"yAngle\": 35,";
const CORNERS: &str = "\"tlCorner\": { \"x\": -7, \"y\": 0, \"z\": 2 }, \"brCorner\": { \"x\": -7, \"y\": 1, \"z\": 0 },";
const OBLIQUE: &str = "\"tlCorner\": { \"x\": -7, \"y\": 0, \"z\": 3 }, \"brCorner\": { \"x\": -7, \"y\": 1, \"z\": 0 },";

/// Object of the scene. [`LYING`] replaces it by an upright triangle that is flat once it is rotated by 90° about x.
const UPRIGHT: &str = "\"path\": \"./tetrahedron.obj\", \"materialIndex\": 0,\n      \
    \"midpoint\": { \"x\": 4, \"y\": 3, \"z\": 2 }, \"height\": 4, \"xrot\": 0,";
const LYING: &str = "\"path\": \"upright.obj\", \"materialIndex\": 0,\n      \
    \"midpoint\": { \"x\": 4, \"y\": 3, \"z\": 2 }, \"height\": 4, \"xrot\": 90,";

#[test]
fn every_row_of_the_page_holds() {
    let rows = table("aalto");
    for (construct, outcome) in &rows {
        let (_, changes) = ROWS.iter().find(|row| row.0 == construct).unwrap_or_else(|| panic!("no scene for {construct}"));
        let unchanged: &[(&str, &str)] = &[("", "")];
        for (from, to) in if changes.is_empty() { unchanged } else { changes } {
            let scene = SCENE.replacen(from, to, 1);
            assert!(from.is_empty() || scene != SCENE, "{construct}: {from}");
            let folder = folder(&[
                ("scene.json", &scene),
                ("tetrahedron.obj", TETRAHEDRON),
                ("flat.obj", "v 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\n"),
                ("upright.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n"),
            ]);
            assert_eq!(Outcome::of(&folder.path().join("scene.json")), *outcome, "{construct}: {to}");
        }
    }
    let unsaid: Vec<&str> = ROWS.iter().map(|row| row.0).filter(|row| rows.iter().all(|said| said.0 != *row)).collect();
    assert!(unsaid.is_empty(), "not on the page: {unsaid:?}");
}

/// The unchanged scene is read without a note.
#[test]
fn the_scene_is_read() {
    assert_eq!(Outcome::of(&files(SCENE).path().join("scene.json")), Outcome::Read);
}
