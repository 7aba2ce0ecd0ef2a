//! The table of docs/import.md on scenes of dirt and darts: each construct is converted as its row says.

use std::fs;

use pt::build::Source;
use pt::describe;
use pt::import::import;

const PAGE: &str = include_str!("../../../../docs/import.md");

/// The rows of this section: construct and outcome.
fn rows() -> Vec<(&'static str, &'static str)> {
    let section = PAGE.split("\n## ").find(|section| section.starts_with("dirt and darts\n")).expect("the section");
    let cells = |line: &'static str| {
        let mut cells = line.trim_matches('|').split('|').map(str::trim);
        Some((cells.next()?, cells.next()?))
    };
    section.lines().filter(|line| line.starts_with('|')).skip(2).filter_map(cells).collect()
}

fn scene(key: &str, value: &str) -> String {
    let given = [
        ("camera", r#"{ "transform": { "from": [0, 0, 4] }, "vfov": 40, "resolution": 4 }"#),
        ("surfaces", r#"[{ "type": "sphere" }]"#),
        ("integrator", r#"{ "type": "path_tracer_mats" }"#),
        ("image_samples", "2"),
        ("background", "1"),
    ];
    let others = given.iter().filter(|(other, _)| *other != key).map(|(other, value)| format!("{other:?}: {value}"));
    let own = (!key.is_empty() && !value.is_empty()).then(|| format!("{key:?}: {value}"));
    format!("{{ {} }}", others.chain(own).collect::<Vec<_>>().join(", "))
}

/// A medium.
const FOG: &str = r#"{ "type": "homogeneous", "sigma_a": [0.1, 0.2, 0.3], "sigma_s": 1, "phase": { "type": "hg", "g": 0.5 } }"#;

/// The scene with an integrator that simulates media, and with a medium named fog, which has more members.
fn fog(members: &str, scene: &str) -> String {
    with_fog(members, &simulated(scene))
}

/// The scene with an integrator that simulates media.
fn simulated(scene: &str) -> String {
    scene.replace("path_tracer_mats", "volpath_tracer_uni")
}

/// The scene with a medium named fog, which has more members.
fn with_fog(members: &str, scene: &str) -> String {
    let kind = if members.contains("type") { "" } else { r#""type": "homogeneous", "# };
    scene.replacen('{', &format!(r#"{{ "media": [{{ {kind}"name": "fog", "sigma_s": 1, "phase": {{ "type": "hg" }}{members} }}], "#), 1)
}

fn material(value: &str) -> String {
    scene("surfaces", &format!(r#"[{{ "type": "sphere", "material": {value} }}]"#))
}

fn placed(value: &str) -> String {
    scene("surfaces", &format!(r#"[{{ "type": "sphere", "transform": {value} }}]"#))
}

fn color(value: &str) -> String {
    material(&format!(r#"{{ "type": "lambertian", "albedo": {value} }}"#))
}

fn camera(value: &str) -> String {
    scene("camera", &format!(r#"{{ "vfov": 40, "resolution": [4, 3], {value} }}"#))
}

fn integrators(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| scene("integrator", &format!(r#"{{ "type": "{name}" }}"#))).collect()
}

fn samplers(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| scene("sampler", &format!(r#"{{ "type": "{name}", "samples": 2 }}"#))).collect()
}

/// A checker over these coordinates.
fn over(vector: &str) -> String {
    color(&format!(r#"{{ "type": "checker", "color1": 0, "color2": 1, "vector": {vector} }}"#))
}

fn mapping(more: &str) -> String {
    format!(r#"{{ "type": "mapping", "transform": [{{ "scale": 2 }}], {more} }}"#)
}

/// One or more small files for each construct; none for an unknown construct.
fn files(construct: &str) -> Vec<String> {
    let red = r#"{ "type": "lambertian", "name": "red", "albedo": [1, 0, 0] }"#;
    let lamp = r#"{ "type": "diffuse light", "name": "lamp", "emit": 2 }"#;
    let mesh = |materials: &str, file: &str| {
        format!(
            r#"{{ "camera": {{ "vfov": 30 }}, "image_samples": 1, "materials": [{materials}],
                "surfaces": [{{ "type": "mesh", "filename": "{file}", "material": "red" }}] }}"#
        )
    };
    match construct {
        "`camera`" => vec![
            camera(r#""fdist": 2, "transform": { "from": [0, 0, 4], "at": [0, 0, 0] }"#),
            scene("camera", r#"{ "vertical fov": 30, "focus distance": 3 }"#),
        ],
        "`aperture`" => vec![camera(r#""aperture": 0.1"#)],
        "`aperture diameter`" => vec![camera(r#""aperture diameter": 0.1"#)],
        "a camera's transform that scales" => vec![camera(r#""aperture": 0.1, "transform": [{ "scale": 2 }, { "translate": [0, 0, 4] }]"#)],
        "a camera's transform that scales its axes differently" => vec![camera(r#""transform": { "scale": [1, 2, 1] }"#)],
        "`image_samples`, `samples`" => {
            vec![scene("image_samples", "3"), scene("sampler", r#"{ "type": "independent", "samples": 2 }"#), scene("image_samples", "")]
        }
        "`sampler` independent, stratified, halton, stochastic sobol" => {
            samplers(&["independent", "stratified", "halton", "stochastic sobol", "stochastic_sobol"])
        }
        "`sampler` cmj" => samplers(&["cmj"]),
        "`sampler` dimension" => vec![scene("sampler", r#"{ "type": "stratified", "dimension": 4 }"#)],
        "`accelerator`" => ["bbh", "bvh", "group"].map(|kind| scene("accelerator", &format!(r#"{{ "type": "{kind}" }}"#))).into(),
        "no `integrator`" => vec![scene("integrator", "")],
        "`normals`" => integrators(&["normals"]),
        "`ao`" => integrators(&["ao"]),
        "`path_tracer_simple`, `path_tracer_mats`, `direct_mats`" => {
            integrators(&["path_tracer_simple", "path_tracer_mats", "path tracer mats", "direct_mats"])
        }
        "`path_tracer_nee`, `direct_nee`" => integrators(&["path_tracer_nee", "path tracer nee", "direct_nee"]),
        "`path_tracer_mis`, `direct_mis`" => integrators(&["path_tracer_mis", "path tracer mis", "direct_mis"]),
        "`path_tracer_mixture`" => integrators(&["path_tracer_mixture"]),
        "`volpath_tracer_uni`, `volpath_tracer_nee`" => integrators(&["volpath_tracer_uni", "volpath_tracer_nee"]),
        "`max_bounces`, `max bounces`" => ["max_bounces", "max bounces"]
            .map(|key| scene("integrator", &format!(r#"{{ "type": "path_tracer_mats", "{key}": 1 }}"#)))
            .into(),
        "`background`" => {
            ["0.5", "[1]", "[0.1, 0.2, 0.3]", r#"{ "type": "constant", "color": 1 }"#, r#"{ "type": "background", "color": 1 }"#, ""]
                .map(|value| scene("background", value))
                .into()
        }
        "`background` of type image" => vec![scene("background", r#"{ "type": "image", "filename": "sky.png" }"#)],
        "`media` of type homogeneous, `medium` of the camera" => {
            vec![fog("", &camera(r#""medium": "fog""#)), simulated(&camera(&format!(r#""medium": {FOG}"#)))]
        }
        "`medium_interface` of spheres and meshes" => vec![
            fog("", &scene("surfaces", r#"[{ "type": "sphere", "medium_interface": { "inside": "fog" } }]"#)),
            simulated(&scene("surfaces", &format!(r#"[{{ "type": "sphere", "medium_interface": {{ "inside": {FOG} }} }}]"#))),
            fog("", &scene("surfaces", r#"[{ "type": "mesh", "filename": "red.obj", "medium_interface": { "inside": "fog" } }]"#)),
            fog(
                "",
                &camera(r#""medium": "fog""#).replace(r#""surfaces": [{"#, r#""surfaces": [{ "medium_interface": { "outside": "fog" }, "#),
            ),
            fog(
                "",
                &scene(
                    "surfaces",
                    r#"[{ "type": "quad", "medium_interface": {} }, { "type": "sphere", "medium_interface": { "inside": "fog" } }]"#,
                ),
            ),
        ],
        "media of type perlin" => vec![fog(
            r#", "type": "perlin", "spatial_scale": [1, 2, 3], "density_offset": 0.5"#,
            &scene("surfaces", r#"[{ "type": "sphere", "medium_interface": { "inside": "fog" } }]"#),
        )],
        "media of type perlin that have no end" => vec![fog(r#", "type": "perlin""#, &camera(r#""medium": "fog""#))],
        "a camera whose `medium` is neither outside of all surfaces nor inside of one" => vec![fog(
            "",
            &camera(r#""medium": "fog""#)
                .replace(r#""surfaces": [{"#, &format!(r#""surfaces": [{{ "medium_interface": {{ "inside": {FOG} }}, "#)),
        )],
        "media with `path_tracer_…` and `direct_…`" => vec![with_fog("", &camera(r#""medium": "fog""#))],
        "two media that are both outside of all surfaces" => vec![fog(
            "",
            &scene(
                "surfaces",
                &format!(
                    r#"[{{ "type": "sphere", "medium_interface": {{ "inside": {FOG}, "outside": "fog" }} }},
                        {{ "type": "sphere", "medium_interface": {{ "inside": {FOG} }} }}]"#
                ),
            ),
        )],
        "`medium_interface` of other surfaces, without a material" => {
            vec![fog("", &scene("surfaces", r#"[{ "type": "quad", "medium_interface": { "inside": "fog" } }]"#))]
        }
        "`medium_interface` of other surfaces, with a material" => vec![fog(
            "",
            &scene("surfaces", r#"[{ "type": "quad", "material": { "type": "lambertian" }, "medium_interface": { "inside": "fog" } }]"#),
        )],
        "a medium that nothing has" => vec![fog("", &scene("", ""))],
        "`sphere`, `quad`, `triangle`, `group`" => vec![
            scene("surfaces", r#"[{ "type": "sphere", "radius": 2, "name": "ball" }]"#),
            scene("surfaces", r#"[{ "type": "quad", "size": 2 }, { "type": "quad", "size": [1, 2] }]"#),
            scene(
                "surfaces",
                r#"[{ "type": "triangle", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "normals": [[0, 0, 1], [0, 0, 1], [0, 0, 1]], "uvs": [[0, 0], [1, 0], [0, 1]] }]"#,
            ),
            scene("surfaces", r#"[{ "type": "group", "transform": { "scale": 2 }, "children": [{ "type": "sphere" }] }]"#),
        ],
        "`mesh`" => vec![mesh(red, "red.obj")],
        "`mesh` of which a part shines" => vec![mesh(&format!("{red}, {lamp}"), "lamp.obj")],
        "no `material`" => vec![scene("", "")],
        "a name that two materials have" => vec![scene("materials", &format!("[{red}, {red}]"))],
        "`lambertian`, `diffuse`" => {
            vec![material(r#"{ "type": "lambertian", "albedo": 0.5 }"#), material(r#"{ "type": "diffuse", "color": [0.5] }"#)]
        }
        "`diffuse light`, `diffuse_light`, `emission`" => vec![
            material(r#"{ "type": "diffuse light", "emit": 3 }"#),
            material(r#"{ "type": "diffuse_light", "emit": [1, 2, 3] }"#),
            material(r#"{ "type": "emission", "color": 3 }"#),
        ],
        "light that varies over a surface" => {
            vec![material(r#"{ "type": "diffuse light", "emit": { "type": "checker", "even": 1, "odd": 2 } }"#)]
        }
        "a light within another material" => {
            vec![material(r#"{ "type": "blend", "a": { "type": "diffuse light" }, "b": { "type": "phong" } }"#)]
        }
        "`metal`" => vec![material(r#"{ "type": "metal", "albedo": 0.9, "roughness": 0.1 }"#)],
        "`dielectric`" => vec![material(r#"{ "type": "dielectric", "ior": 1.3 }"#)],
        "`phong`, `blinnphong`, `blinn_phong`, `blinn-phong`" => ["phong", "blinnphong", "blinn_phong", "blinn-phong"]
            .map(|kind| material(&format!(r#"{{ "type": "{kind}", "albedo": 0.8, "exponent": 5 }}"#)))
            .into(),
        "`beckmann`" => vec![
            material(r#"{ "type": "beckmann", "ab": 0.2, "ior": 0.05, "ext": 3.9 }"#),
            material(r#"{ "type": "beckmann", "albedo": 0.8 }"#),
        ],
        "`beckmann` in colour" => vec![material(r#"{ "type": "beckmann", "albedo": [0.8, 0.4, 0.2] }"#)],
        "`oren-nayar`" => vec![material(r#"{ "type": "oren-nayar", "albedo": 0.8, "sigma": 0.4 }"#)],
        "`blend`, `mix`, `fresnel_blend`" => {
            let parts = r#""a": { "type": "lambertian" }, "b": { "type": "phong" }"#;
            vec![
                material(&format!(r#"{{ "type": "blend", {parts}, "amount": 0.5 }}"#)),
                material(&format!(r#"{{ "type": "mix", {parts}, "factor": 0.5 }}"#)),
                material(&format!(r#"{{ "type": "mix", {parts}, "factor": {{ "type": "fresnel", "ior": 1.5 }} }}"#)),
                material(r#"{ "type": "fresnel_blend", "refr": { "type": "lambertian" }, "refl": { "type": "phong" }, "ior": 1.5 }"#),
            ]
        }
        "colours as `constant`, `checker`, `image`" => vec![
            color(r#"{ "type": "constant", "color": 0.5 }"#),
            color(r#"{ "type": "checker", "even": { "type": "checker", "even": 0, "odd": 1, "scale": 9 }, "odd": 1, "scale": 3 }"#),
            color(r#"{ "type": "image", "filename": "dot.png" }"#),
        ],
        "`checker` by `even` and `odd`" => {
            let checker = color(r#"{ "type": "checker", "even": 0, "odd": 1, "scale": 3 }"#);
            vec![checker.replace(r#""image_samples": 2"#, r#""sampler": { "type": "independent", "samples": 2 }"#), checker]
        }
        "`checker` by `even` and `odd` in a scene without a spelling that tells its dialect" => {
            vec![color(r#"{ "type": "checker", "even": 0, "odd": 1, "scale": 3 }"#).replace(r#""image_samples": 2, "#, "")]
        }
        "`checker` by `color1` and `color2`" => vec![color(r#"{ "type": "checker", "color1": 0, "color2": 1, "scale": 3 }"#)],
        "`marble`" => vec![color(r#"{ "type": "marble", "base": 0.5, "veins": [0, 0, 1], "scale": 3 }"#)],
        "a texture with a transform" => vec![color(r#"{ "type": "checker", "even": 0, "odd": 1, "transform": { "scale": 2 } }"#)],
        "a texture over the texture coordinates" => vec![over(r#""uv""#), over(r#"{ "type": "coord", "coordinate": "uv" }"#)],
        "a texture over the position in the world" => vec![over(r#"{ "type": "coord", "coordinate": "world" }"#)],
        "a texture over a `mapping`" => ["point", "texture"].map(|kind| over(&mapping(&format!(r#""vector type": "{kind}""#)))).into(),
        "a `mapping` without a vector type" => vec![over(&mapping(r#""name": "it""#))],
        "a `mapping` of texture coordinates" => vec![over(&mapping(r#""vector type": "point", "vector": "uv""#))],
        "a texture over other vectors" => vec![over(r#""normal""#), over(r#"{ "type": "coord", "coordinate": "normal" }"#)],
        "texture coordinates of a sphere" => vec![color(r#"{ "type": "image", "filename": "dot.png" }"#)],
        "transforms" => vec![
            placed(r#"{ "from": [0, 0, 1], "to": [0, 1, 0], "up": [0, 1, 0] }"#),
            placed(
                r#"[{ "o": 0, "x": [1, 0, 0] }, { "translate": 1 }, { "scale": [1, 2, 3] }, { "axis": [1, 0, 0], "angle": 9 }, { "rotate": [9, 1, 0, 0] }]"#,
            ),
            placed(r#"{ "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }"#),
            placed(r#"{ "matrix": 2 }"#),
        ],
        "a second command in one object" => vec![placed(r#"{ "scale": 2, "translate": [1, 0, 0] }"#)],
        "unknown keys at the top" => vec![scene("film", "{}")],
        "unknown keys elsewhere" => vec![material(r#"{ "type": "lambertian", "albdeo": 0.5 }"#)],
        "unknown types, names and commands" => vec![
            scene("surfaces", r#"[{ "type": "torus" }]"#),
            material(r#"{ "type": "velvet" }"#),
            material(r#""unnamed""#),
            color(r#"{ "type": "wood" }"#),
            placed(r#"{ "shear": 1 }"#),
            scene("integrator", r#"{ "type": "bdpt" }"#),
            scene("sampler", r#"{ "type": "random" }"#),
        ],
        "`normals` in a scene without a spelling that tells its dialect" => {
            vec![r#"{ "camera": { "resolution": 4 }, "surfaces": [{ "type": "sphere" }], "integrator": { "type": "normals" } }"#.into()]
        }
        _ => vec![],
    }
}

#[test]
fn each_construct_becomes_what_the_documentation_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let obj = |name: &str| format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl {name}\nf 1 2 3\n");
    for name in ["red", "lamp"] {
        fs::write(folder.path().join(format!("{name}.obj")), obj(name)).expect("a mesh");
    }
    let dot = image::RgbImage::from_pixel(1, 1, image::Rgb([90, 60, 30]));
    dot.save(folder.path().join("dot.png")).expect("a picture");
    let rows = rows();
    assert!(rows.len() > 40, "{rows:?}");
    for (construct, outcome) in rows {
        let files = files(construct);
        assert!(!files.is_empty(), "no file for {construct:?}");
        for file in files {
            let path = folder.path().join("scene.json");
            fs::write(&path, &file).expect("a scene");
            let found = import(&path, false).and_then(|found| {
                let described = describe::read(&found.root, &found.file)?;
                let source = Source { root: &found.root, file: &found.file, files: &found.files };
                pt::build::build(&described, source)?;
                Ok(found.notes)
            });
            let (is, said) = match found {
                Ok(notes) if notes.is_empty() => ("read", String::new()),
                Ok(notes) => ("noted", notes.iter().map(|note| format!("{note}\n")).collect()),
                Err(error) => ("refused", error.to_string()),
            };
            let noted = match outcome {
                "approximated" => said.contains("approximated") || said.contains("read as"),
                "left out" => said.contains("left out"),
                _ => false,
            };
            let holds = if is == "noted" { noted } else { is == outcome };
            assert!(holds, "{construct}: {outcome}, but {is}: {said}\n{file}");
            // The message gives the location: file, line, column, pointer.
            assert!(is == "read" || said.contains("scene.json:1:") || said.contains("scene.json:2:"), "{construct}: {said}");
        }
    }
}
