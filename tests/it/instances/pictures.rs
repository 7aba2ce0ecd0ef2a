//! Pictures of instances are those of copies, with the same lights.

use std::sync::Arc;

use pt::film::Image;
use pt::measure::{agreement, sidak};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene;
use serde_json::{Value, json};

use super::{octahedron, scene, transform};
use crate::light_tracer::{K, built, film, sampled};
use crate::random::Random;

/// A group with textures in the world and on the surface, holes, a relief, glass, smooth shadows and a lamp.
fn things() -> Value {
    let mut smooth = octahedron();
    smooth["material"] =
        json!({ "type": "plastic", "albedo": { "type": "checker", "scale": 4, "even": 0.8, "odd": [0.1, 0.3, 0.6] }, "roughness": 0.3 });
    json!([
        smooth,
        { "type": "sphere", "radius": 0.7, "center": [2, 0, 0], "material": { "type": "bumped", "surface": { "type": "diffuse", "albedo": 0.7 },
            "bump_map": { "type": "noise", "scale": 3, "on": "position" }, "scale": 0.2 } },
        { "type": "quad", "size": 2, "transform": [{ "translate": [0, 0, 2] }], "material": { "type": "masked", "surface": { "type": "diffuse",
            "albedo": { "type": "noise", "scale": 2, "on": "position" } }, "opacity": { "type": "checker", "scale": 5, "even": 1, "odd": 0 } } },
        { "type": "box", "size": [1, 1.5, 0.5], "center": [-2, 0, 0], "material": { "type": "dielectric", "roughness": 0.4 } },
        { "type": "disk", "name": "lamp", "radius": 0.5, "emission": { "radiance": [4, 3, 2], "two_sided": true }, "transform": [{ "translate": [0, 2.2, 0] }] },
        { "type": "sdf", "field": { "type": "torus", "radius": 0.6, "tube": 0.2 }, "transform": [{ "translate": [0, -2, 0] }],
            "material": { "type": "conductor", "metal": "Cu", "roughness": 0.4 } },
    ])
}

/// The scene with instances, and the one with copies. Every second instance has `material`, if it is given, instead of its shapes' own.
fn pair(seed: u64, material: Option<&Value>) -> [Value; 2] {
    let mut random = Random::new(seed);
    let places: Vec<Value> = (0..5).map(|_| transform(&mut random, 4.0)).collect();
    let floor = json!({ "type": "quad", "size": 30, "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": -90 } }, { "translate": [0, -4, 0] }] });
    let mut with_material = things();
    if let Some(material) = material {
        with_material.as_array_mut().expect("a list").iter_mut().for_each(|shape| shape["material"] = material.clone());
    }
    let instance = |(i, place): (usize, &Value)| match (i % 2, material) {
        (1, Some(material)) => json!({ "transform": place, "material": material }),
        _ => json!({ "transform": place }),
    };
    let copy = |(i, place): (usize, &Value)| {
        let shapes = if i % 2 == 1 { with_material.clone() } else { things() };
        json!({ "type": "group", "shapes": shapes, "transform": place })
    };
    let instances =
        json!({ "type": "instances", "group": "things", "placements": places.iter().enumerate().map(instance).collect::<Vec<_>>() });
    let copies: Vec<Value> = std::iter::once(floor.clone()).chain(places.iter().enumerate().map(copy)).collect();
    [scene(json!({ "things": things() }), json!([floor, instances])), scene(json!({}), json!(copies))]
}

/// Instances and copies give the same picture by nee, path and light, with the shapes' own materials and with others.
#[test]
fn instances_and_copies_give_the_same_pictures() {
    let matte = json!({ "type": "oren_nayar", "albedo": [0.3, 0.6, 0.2], "roughness": 0.5 });
    let cases = [("nee", None, 256), ("nee", Some(&matte), 256), ("path", None, 256), ("light", None, 1024)];
    let mut wrong = vec![];
    for (i, (integrator, material, spp)) in cases.into_iter().enumerate() {
        let images: Vec<_> = pair(i as u64, material)
            .iter()
            .zip(1..)
            .map(|(text, seed)| {
                let made = built(&text.to_string());
                assert_eq!(made.world.lights().len(), 5 + 1, "five lamps and the background");
                let world: Arc<dyn Scene> = Arc::new(made.world);
                film(world, integrator, "", made.film, SamplerSpec { kind: Kind::Sobol, seed, spp, scramblings: K }).image()
            })
            .collect();
        let found = agreement(sampled(&images[0]), sampled(&images[1]), sidak(0.01, cases.len())).expect("error bars");
        if !found.accepts() {
            wrong.push(format!("{integrator}, other materials: {}: {found}", material.is_some()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The light tracer and nee agree on a scene of instances.
#[test]
fn light_paths_meet_instances() {
    let [text, _] = pair(7, None);
    let made = built(&text.to_string());
    let world: Arc<dyn Scene> = Arc::new(made.world);
    let sampler = |seed| SamplerSpec { kind: Kind::Sobol, seed, spp: 1024, scramblings: K };
    let [a, b] = [("light", 1), ("nee", 2)].map(|(name, seed)| film(world.clone(), name, "", made.film.clone(), sampler(seed)).image());
    let found = agreement(sampled(&a), sampled(&b), 0.01).expect("error bars");
    assert!(found.accepts(), "{found}");
}

/// A mirrored instance of glass is right side out: a tetrahedron absorbs and refracts as one that is not mirrored, and its picture is the mirror
/// image.
#[test]
fn mirrored_instances_are_right_side_out() {
    let glass = json!({ "type": "dielectric", "eta": 1.5, "absorption": { "color": [0.3, 0.6, 0.9], "distance": 1 } });
    let body = json!({ "type": "mesh", "material": glass, "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.1, 1]],
        "triangles": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] });
    let lamp = json!({ "type": "sphere", "radius": 0.4, "center": [0.3, 2, 0.4], "emission": 4 });
    let view = |x: i32| {
        let place = json!([{ "scale": [x, 1, 1] }]);
        let groups = json!({ "body": [body, lamp] });
        let mut text = scene(groups, json!([{ "type": "instances", "group": "body", "transform": place }]));
        text["camera"] = json!({ "look_at": { "from": [1.5 * f64::from(x), 1.2, 3], "to": [0.3 * f64::from(x), 0.4, 0.4] }, "fov": 40 });
        text
    };
    let [mut image, mirrored] = [(1, 5), (-1, 6)].map(|(x, seed)| {
        let made = built(&view(x).to_string());
        let world: Arc<dyn Scene> = Arc::new(made.world);
        film(world, "nee", "", made.film, SamplerSpec { kind: Kind::Sobol, seed, spp: 512, scramblings: K }).image()
    });
    mirror(&mut image);
    let found = agreement(sampled(&image), sampled(&mirrored), 0.01).expect("error bars");
    assert!(found.accepts(), "{found}");
}

/// Swaps left and right.
fn mirror(image: &mut Image) {
    let width = image.size.x as usize;
    for channel in &mut image.channels {
        channel.values.chunks_mut(width).for_each(<[f32]>::reverse);
    }
}
