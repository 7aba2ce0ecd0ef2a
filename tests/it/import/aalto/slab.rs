//! The glass panel of the Aalto path tracer, which magnified because of a bug. In pt it does not.

use std::sync::Arc;

use pt::film::FilmSpec;
use pt::sampler::{Kind, SamplerSpec};

use crate::import::dialect::{built, folder};
use crate::scenes::{Depth, integrator, picture};

const WIDTH: u32 = 512;

/// The panel as in its file: two square faces of edge 1 that are 0.005 apart, with normals that point away from each other. The scene
/// scales it by 10.
const PANEL: &str = "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 1 0 1\n\nv 0 0.005 0\nv 0 0.005 1\nv 1 0.005 0\nv 1 0.005 1\n\n\
    f 1 3 2\nf 4 2 3\n\nf 5 6 7\nf 8 7 6\n";
const STRIP: &str = "v 0 -1 -1\nv 0 1 -1\nv 0 1 1\nv 0 -1 1\nf 1 2 3\nf 1 3 4\n";

/// Position of the edge of a lit wall in the picture, from the middle (pixels). The wall is 10 in front of the eye, its edge is 0.1 beside
/// the middle, and the panel stands half way.
fn edge(panel: bool) -> f64 {
    let glass = r#", { "type": "mesh", "path": "panel.obj", "materialIndex": 1, "midpoint": { "x": 5, "y": 0, "z": 0 },
        "height": 10, "xrot": 0, "yrot": 0, "zrot": 90 }"#;
    let scene = format!(
        r#"{{ "camera": {{ "focalPoint": {{ "x": 0, "y": 0, "z": 0 }}, "direction": {{ "x": 1, "y": 0, "z": 0 }},
            "xAngle": 2.2918311, "yAngle": 0.01, "xReso": {WIDTH}, "yReso": 1 }},
          "materials": [{{ "isLuminous": true, "color": {{ "r": 1, "g": 1, "b": 1 }} }},
            {{ "type": "transparent", "refIndex": 1.5, "isLuminous": false, "color": {{ "r": 1, "g": 1, "b": 1 }} }}],
          "objects": [{{ "type": "mesh", "path": "strip.obj", "materialIndex": 0, "midpoint": {{ "x": 10, "y": -1.9, "z": 0 }},
            "height": 4, "xrot": 0, "yrot": 0, "zrot": 0 }}{}] }}"#,
        if panel { glass } else { "" }
    );
    let folder = folder(&[("scene.json", &scene), ("panel.obj", PANEL), ("strip.obj", STRIP)]);
    let (_, built) = built(&folder.path().join("scene.json")).unwrap_or_else(|error| panic!("{error}"));
    // The depth allows only two interfaces, and both branches are followed, so that the only noise is that of positions in the pixel.
    let entry = pt::integrators::ALL.iter().find(|entry| entry.name == "whitted").expect("an integrator");
    let whitted = integrator(entry, Depth { max: 2, roulette: 2 }).expect("an integrator");
    let sampler = SamplerSpec { kind: Kind::Stratified, spp: 64, seed: 1, ..SamplerSpec::default() };
    let image = picture(Arc::new(built.world), &*whitted, FilmSpec::new(WIDTH, 1), sampler);
    let row: Vec<f64> = image.pixels().map(|[r, _, _]| f64::from(r)).collect();
    // The picture is mirrored, with −y on the left.
    row.iter().sum::<f64>() / row[0] - 0.5 * f64::from(WIDTH)
}

/// The magnification is M = D/(D − t(1 − 1/n)) = 1.0017 for the panel. With the bug it was 4/3.
#[test]
fn the_glass_panel_does_not_magnify() {
    let (bare, through) = (edge(false), edge(true));
    assert!((bare - 0.25 * f64::from(WIDTH)).abs() < 0.5, "the edge is half way to the right: {bare}");
    let expected = 10.0 / (10.0 - 0.05 * (1.0 - 1.0 / 1.5));
    let m = through / bare;
    assert!((m / expected - 1.0).abs() < 1e-3, "{m} for {expected}");
}
