//! Layers of light, compared with pictures that have no other light.

use std::sync::Arc;

use pt::build::{Built, Source};
use pt::describe::{self, Files};
use pt::film::{FilmSpec, Filter, Image, Layer, MomentFilm};
use pt::integrator::choose;
use pt::integrators::ALL;
use pt::render::{Render, Settings, Silent};
use pt::sampler::SamplerSpec;

/// A matte ball and a mirror ball between two lamps, one of which is two triangles, under a dim sky.
const SCENE: &str = r#"{ "pt": 1,
    "camera": { "look_at": { "from": [0, 1, 6], "to": [0, 0, 0] } },
    "film": { "width": 24, "height": 16, "layers": ["emission", "direct", "indirect", "lights"] },
    "shapes": [
        { "type": "sphere", "center": [-1, 0, 0], "material": { "type": "diffuse", "albedo": [0.8, 0.5, 0.2] } },
        { "type": "sphere", "center": [1.2, 0, 0], "material": { "type": "mirror", "color": 0.9 } },
        { "type": "quad", "size": 8, "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": -90 } }, { "translate": [0, -1, 0] }] },
        { "type": "mesh", "name": "panel", "emission": { "radiance": [3, 2, 1], "two_sided": true },
          "positions": [[-2, 2, -1], [2, 2, -1], [2, 3.5, -1], [-2, 3.5, -1]], "triangles": [[0, 1, 2], [0, 2, 3]] },
        { "type": "sphere", "center": [0, 2, 2], "radius": 0.8, "name": "ball", "emission": 4 }
    ],
    "background": { "radiance": 0.1 } }"#;

fn built(scene: &str) -> Built {
    let root = describe::root(scene.as_bytes(), "s.json").expect("JSON");
    let described = describe::read(&root, "s.json").unwrap_or_else(|e| panic!("{e}"));
    pt::build::build(&described, Source { root: &root, file: "s.json", files: &Files::within("") }).unwrap_or_else(|e| panic!("{e}"))
}

/// - `options`: options of the integrator
fn picture(scene: &str, name: &str, options: &str, filter: Filter) -> Image {
    let Built { world, film, .. } = built(scene);
    let spec = FilmSpec { filter, ..film };
    let root = describe::root(format!(r#"{{ "type": "{name}"{options} }}"#).as_bytes(), "i").expect("JSON");
    let (_, integrator) = choose(&[ALL], Some(&root), Some(name), "i").unwrap_or_else(|e| panic!("{e}"));
    let sampler = SamplerSpec { spp: 9, seed: 7, ..SamplerSpec::default() };
    let mut film = MomentFilm::new(spec.clone());
    Render::new(Arc::new(world), &*integrator, &spec, &Settings::new(sampler)).advance(9, &mut film, &Silent);
    film.image()
}

/// Red, green and blue of a layer.
fn layer(image: &Image, name: &str) -> Vec<[f32; 3]> {
    let [r, g, b] = ["R", "G", "B"].map(|c| image.channel(&format!("{name}.{c}")).unwrap_or_else(|| panic!("no {name}.{c}")));
    r.iter().zip(g).zip(b).map(|((r, g), b)| [*r, *g, *b]).collect()
}

fn sum(layers: &[Vec<[f32; 3]>]) -> Vec<[f64; 3]> {
    (0..layers[0].len()).map(|i| std::array::from_fn(|c| layers.iter().map(|layer| f64::from(layer[i][c])).sum())).collect()
}

/// Asserts equality up to rounding: of a sample's sum of a few tens of f32, of layers to f32, and of their sum. Each is 2⁻²⁴ of the
/// largest sample of the pixel, which is below 16 times its weight here.
fn close(found: &[[f64; 3]], wanted: &[[f64; 3]], about: &str) {
    assert!(wanted.iter().flatten().any(|x| *x > 0.1), "{about}: black");
    for (i, (a, b)) in found.iter().zip(wanted).enumerate() {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 16.0 * 32.0 * 6e-8), "{about}, pixel {i}: {a:?}, wanted {b:?}");
    }
}

fn colors(image: &Image) -> Vec<[f64; 3]> {
    image.pixels().map(|rgb| rgb.map(f64::from)).collect()
}

const TELLING: [&str; 3] = ["path", "nee", "whitted"];

/// The layers by depth and by light add up to the picture, also with a filter that has negative weights.
#[test]
fn layers_of_light_add_up_to_the_picture() {
    for name in TELLING {
        for filter in [Filter::default(), Filter::mitchell(2.0, 1.0 / 3.0, 1.0 / 3.0)] {
            let image = picture(SCENE, name, "", filter);
            let by = |names: &[&str]| sum(&names.iter().map(|name| layer(&image, name)).collect::<Vec<_>>());
            close(&by(&["Emission", "Direct", "Indirect"]), &colors(&image), name);
            close(&by(&["Light.panel", "Light.ball", "Light.background"]), &colors(&image), name);
        }
    }
}

/// The layers by depth match pictures with a depth limit on the same random numbers.
#[test]
fn depth_layers_match_pictures_with_a_depth_limit() {
    for name in TELLING {
        let whole = picture(SCENE, name, "", Filter::default());
        let limited = |depth: u32| colors(&picture(SCENE, name, &format!(r#", "max_depth": {depth}"#), Filter::default()));
        close(&sum(&[layer(&whole, "Emission")]), &limited(0), name);
        close(&sum(&[layer(&whole, "Emission"), layer(&whole, "Direct")]), &limited(1), name);
    }
}

/// The layer of a light equals the picture without all other lights.
#[test]
fn a_lights_layer_is_the_picture_without_the_others() {
    let whole = picture(SCENE, "path", "", Filter::default());
    let (panel, ball, sky) = (r#""radiance": [3, 2, 1]"#, r#""emission": 4"#, r#""radiance": 0.1 }"#);
    let out = |light: &str| light.replace("[3, 2, 1]", "0").replace(": 4", ": 0").replace("0.1", "0");
    for (name, others) in [("panel", [ball, sky]), ("ball", [panel, sky]), ("background", [panel, ball])] {
        let alone = others.iter().fold(SCENE.to_owned(), |scene, light| scene.replace(light, &out(light)));
        let alone = alone.replace(r#", "layers": ["emission", "direct", "indirect", "lights"]"#, "");
        close(&sum(&[layer(&whole, &format!("Light.{name}"))]), &colors(&picture(&alone, "path", "", Filter::default())), name);
    }
}

/// Each name is listed once, in the order of the lights. Lights without a name are listed by their pointer.
#[test]
fn every_light_has_its_name() {
    let film = built(&SCENE.replace(r#""name": "ball", "#, "")).film;
    assert_eq!(film.lights.names, ["background", "panel", "/shapes/4"]);
    assert_eq!(film.lights.of[..], [0, 1, 1, 2], "a panel of two triangles");
    assert_eq!(film.layers.last(), Some(&Layer::Light(2)));
}
