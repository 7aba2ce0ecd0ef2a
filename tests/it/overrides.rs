//! Overrides from the command line, and options that are read later than the rest of the scene.

use pt::Error;
use pt::describe::{self, Scene};
use pt::reader::{self, Faults, UnknownKeys};
use serde::Deserialize;

use crate::marked::{scene, unmark};
use crate::scene_format::EVERYTHING;

fn read_with(overrides: &[(&str, &str)]) -> Result<Scene, Error> {
    let mut root = describe::root(EVERYTHING.as_bytes(), "s")?;
    for (pointer, value) in overrides {
        root.set(pointer, value)?;
    }
    describe::read(&root, "s")
}

#[test]
fn overrides_replace_and_add() {
    let scene =
        read_with(&[("/sampler/spp", "7"), ("/film/width", "700"), ("/materials/diffuse/albedo", "white"), ("/shapes/0/name", "\"7\"")]);
    let scene = scene.unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(scene.sampler.spp.get(), 7);
    assert_eq!(scene.film.width.get(), 700);
    assert_eq!(scene.shapes[0].name(), Some("7"));
    let Some(describe::Material::Diffuse(diffuse)) = scene.materials.get("diffuse") else { panic!("{:?}", scene.materials) };
    assert_eq!(diffuse.albedo, describe::Textured::Named("white".into()));

    let mut minimal = describe::root(br#"{"pt": 1, "camera": {}}"#, "s").unwrap();
    minimal.set("/film/filter/type", "tent").expect_err("only the last key and the section are made");
    minimal.set("/film/width", "9").unwrap();
    assert_eq!(describe::read(&minimal, "s").unwrap().film.width.get(), 9);
}

#[test]
fn overrides_with_unknown_pointers_report_the_known_part() {
    let cases = [
        ("", "1", "-D =1: expected a JSON pointer"),
        ("/materials/glas/eta", "1", "-D /materials/glas/eta=1: /materials has no \"glas\", did you mean \"glass\"?"),
        (
            "/materials/xyzzy/eta",
            "1",
            "-D /materials/xyzzy/eta=1: /materials has no \"xyzzy\", only boundary, diffuse, mirror, gold, glass",
        ),
        ("/shapes/9/name", "x", "-D /shapes/9/name=x: /shapes is a list of 9: expected a number below 9, found \"9\""),
        ("/shapes/00/name", "x", "-D /shapes/00/name=x: /shapes is a list of 9"),
        ("/camera/fov/x", "1", "-D /camera/fov/x=1: /camera/fov is 50.5: it has no \"x\""),
        ("/camera", "{\"fov\": }", "-D /camera={\"fov\": }: unexpected close brace"),
    ];
    for (pointer, value, expected) in cases {
        let error = read_with(&[(pointer, value)]).expect_err(pointer);
        assert_eq!(error.exit_code(), 2, "{error}");
        assert!(error.to_string().starts_with(expected), "expected {expected}\n found    {error}");
    }
}

#[test]
fn faults_of_overrides_name_the_override() {
    let cases = [
        ("/camera/fov", "x", "-D /camera/fov=x: /camera/fov: expected a number, found the string \"x\""),
        ("/camera/fov", "\"60\"", "-D /camera/fov=\"60\": /camera/fov: expected a number, found the string \"60\""),
        ("/camera/foov", "60", "-D /camera/foov=60: /camera/foov: unknown key \"foov\", did you mean \"fov\"?"),
        ("/camra", "{}", "-D /camra={}: /camra: unknown key \"camra\", did you mean \"camera\"?"),
        (
            "/shapes/0/transform",
            "[{\"scale\": 0}]",
            "-D /shapes/0/transform=[{\"scale\": 0}]: /shapes/0/transform/0/scale: the transform has no inverse",
        ),
    ];
    for (pointer, value, expected) in cases {
        let error = read_with(&[(pointer, value)]).expect_err(pointer);
        assert_eq!(error.exit_code(), 2, "{error}");
        assert!(error.to_string().starts_with(expected), "expected {expected}\n found    {error}");
    }
    let mut root = describe::root(b"{\"pt\": 1, \"camera\": {\"fov\": 0}}", "s").unwrap();
    root.set("/sampler/spp", "0").unwrap();
    let both = describe::read(&root, "s").expect_err("both are wrong");
    assert_eq!((both.exit_code(), both.faults().len()), (3, 2), "the file is wrong too: {both}");
}

#[derive(Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Options {
    max_depth: u32,
    #[serde(default)]
    clamp: Option<f32>,
}

#[test]
fn options_are_read_later_with_their_positions() {
    let (text, places) = unmark(&scene(r#""integrator": {"type": "path", "max_depth": 3, ^"clmp": 1}"#));
    let scene = describe::parse(text.as_bytes(), "s").unwrap();
    let node = scene.integrator.0.as_ref().expect("given");
    let read = |keys| {
        let faults = Faults::default();
        let options: Option<Options> = reader::read_options(node, "/integrator", keys, &faults);
        (options, faults.into_result("s").map_err(|e| e.to_string()))
    };
    let expected = Options { max_depth: 3, clamp: None };
    assert_eq!(read(UnknownKeys::Ignore), (Some(expected), Ok(())));
    let fault = format!("s:{}/integrator/clmp: unknown key \"clmp\", did you mean \"clamp\"?", places[0]);
    assert_eq!(read(UnknownKeys::Refuse).1, Err(fault));
}
