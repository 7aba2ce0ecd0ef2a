//! The reader of scene files: it reports all faults of a file at once, each with its position, its pointer and what was expected, and no
//! text causes a panic.

use pt::MAX_FAULTS;
use pt::describe;

use crate::marked::{assert_fault, assert_fault_in_scene, assert_faults, read, scene};
use crate::scene_format::EVERYTHING;

#[test]
fn text_that_is_not_json() {
    assert_fault(&[
        ("^// only a comment", "empty"),
        ("^{", "this { is never closed"),
        ("^[[1, 2]", "this [ is never closed"),
        ("{\n \"pt\": 1 ^/* open", "this /* is never closed"),
        ("{^\"pt: 1}", "unterminated string"),
        ("{\"pt^\n\": 1}", "a string holds the control character '\\n'"),
        ("{\"pt\": 1^,}", "a comma may not follow the last value"),
        ("{\"pt\": 1^ \"camera\": {}}", "expected a comma"),
        ("{^pt: 1}", "expected a key in double quotes"),
        ("{^'pt': 1}", "strings stand in double quotes"),
        ("{\"pt\" ^1}", "expected a colon after the key"),
        ("{\"pt\": ^}", "unexpected close brace"),
        ("{\"pt\": \"^\\q\"}", "invalid escape"),
        ("{\"pt\": \"^\\ud800\"}", "invalid unicode escape"),
        ("{} ^x", "expected the end of the file"),
        ("{} ^{}", "expected the end of the file"),
        ("^42", "expected an object, found 42"),
        ("^[]", "expected an object, found an array of 0"),
        ("{\"é\": ^tru}", "expected a value, found the word tru"),
    ]);
}

#[test]
fn text_that_is_not_utf8() {
    let mark = b"\xEF\xBB\xBF".as_slice();
    let minimal = br#"{"pt": 1, "camera": {}}"#.as_slice();
    assert!(read([mark, minimal].concat()).is_ok(), "a byte order mark is accepted");
    let fault = |bytes: &[u8]| read(bytes).expect_err("not UTF-8")[0].clone();
    assert_eq!(fault(b"{\n \"\xFF\": 1}"), "2:3: byte 4: not UTF-8");
    assert_eq!(fault(&[mark, b"\xC3"].concat()), "1:1: byte 3: not UTF-8");
    let utf16 = |to_bytes: fn(u16) -> [u8; 2]| "{\"pt\": 1}".encode_utf16().flat_map(to_bytes).collect::<Vec<u8>>();
    for bytes in [utf16(u16::to_le_bytes), utf16(u16::to_be_bytes), [b"\xFF\xFE", &utf16(u16::to_le_bytes)[..]].concat()] {
        assert_eq!(fault(&bytes), "1:1: byte 0: this is UTF-16 or UTF-32, expected UTF-8");
    }
}

#[test]
fn nesting_is_limited_before_it_is_parsed() {
    assert_fault(&[(&format!("{}^{}", "[".repeat(128), "[".repeat(1_000_000)), "lists and objects nest deeper than 128")]);
    assert_fault(&[(&format!("^{}{}", "[".repeat(128), "]".repeat(128)), "expected an object, found an array of 1")]);
    // Brackets in strings and comments do not count.
    let brackets = "[{".repeat(200);
    assert_fault_in_scene(&[(&format!("^\"{brackets}\": 1 /* {brackets} */ // {brackets}\n"), "/[{[{")]);
}

#[test]
fn keys() {
    assert_fault(&[
        (r#"{"pt": 1, ^"camra": {}, "camera": {}}"#, r#"/camra: unknown key "camra", did you mean "camera"?"#),
        (r#"{"pt": ^2, "camera": {}}"#, "/pt: expected a version equal to 1, found 2"),
    ]);
    assert_fault_in_scene(&[
        (r#""materials": {"a": {"type": "diffuse"}, ^"a": {"type": "mirror"}}"#, r#"/materials/a: duplicate key "a""#),
        (r#""materials": {"g": {"type": "dielectric", ^"ete": 1}}"#, r#"/materials/g/ete: unknown key "ete", did you mean "eta"?"#),
        (r#""materials": {"a/b~": {"type": "mirror", ^"x": 1}}"#, r#"/materials/a~1b~0/x: unknown key "x", expected color"#),
        (r#""shapes": [{"type": ^"spere"}]"#, r#"/shapes/0/type: unknown type "spere", did you mean "sphere"?"#),
        (
            r#""shapes": [^{"radius": 1}]"#,
            r#"/shapes/0: missing key "type", expected one of mesh, sphere, quad, disk, cylinder, cone, bilinear_patch, curves, box, sdf, group, instances"#,
        ),
        (
            r#""shapes": [{"type": ^5}]"#,
            "/shapes/0/type: expected one of mesh, sphere, quad, disk, cylinder, cone, bilinear_patch, curves, box, sdf, group, instances, found 5",
        ),
        (r#""shapes": [^"sphere"]"#, "/shapes/0: expected an object with a \"type\", found the string \"sphere\""),
        (r#""shapes": ^{"type": "sphere"}"#, "/shapes: expected an array, found an object"),
        (r#""background": ^null"#, "/background: expected an object, found null"),
        (r#""sampler": {"type": ^"sobel"}"#, r#"/sampler/type: unknown name "sobel", did you mean "sobol"?"#),
        (r#""integrator": ^"path""#, "/integrator: expected an object with a \"type\""),
    ]);
}

#[test]
fn numbers() {
    let radius = |number: &str| scene(&format!(r#""shapes": [{{"type": "sphere", "radius": {number}}}]"#));
    let cases = [
        ("^0", "/shapes/0/radius: expected a number above 0, found 0"),
        ("^0e9", "/shapes/0/radius: expected a number above 0, found 0"),
        ("^-1.5", "/shapes/0/radius: expected a number above 0, found -1.5"),
        ("^true", "/shapes/0/radius: expected a number, found true"),
        ("^[1]", "/shapes/0/radius: expected a number, found an array of 1"),
        ("^5.", "a number needs digits on both sides of its point"),
        ("^0x1F", "expected a decimal number"),
    ];
    for (number, expected) in cases {
        assert_fault(&[(&radius(number), expected)]);
    }
    for number in ["3.4028235e38", "1.1754944e-38", "1E+3", "0.1e1"] {
        assert!(read(radius(number)).is_ok(), "{number} fits");
    }
}

#[test]
fn all_faults_of_a_file_come_at_once_and_in_order() {
    let text = r#"^{
  "camera": {"fov": ^180, ^"fovv": 3, "look_at": {"from": [0, 0, ^"1"], "to": ^[0, 0]}},
  "film": {"width": ^0, "height": ^1.5},
  "shapes": [
    {"type": "sphere", ^"radiu": 1, "center": [0, ^"x", ^1e39], "material": {"type": ^"glas", "eta": 1}},
    {"type": "disk", "radius": ^-1, "material": ^"iron"},
    {"type": "mesh", "file": ^7, "materials": {"a": ^"steel"}},
    ^{"type": "group"}, ^5
  ],
  "lights": [^^{"type": "point"}]
}"#;
    assert_faults(
        text,
        &[
            "missing key \"pt\"",
            "/camera/fov: expected an angle",
            "/camera/fovv: unknown key",
            "/camera/look_at/from/2: expected a number",
            "/camera/look_at/to: expected an array of 3",
            "/film/width: expected",
            "/film/height: expected",
            "/shapes/0/radiu: unknown key",
            "/shapes/0/center/1: expected",
            "/shapes/0/center/2: the number 1e39",
            "/shapes/0/material/type: unknown type \"glas\"",
            "/shapes/1/radius: expected",
            "/shapes/1/material: unknown material \"iron\"",
            "/shapes/2/file: expected a string",
            "/shapes/2/materials/a: unknown material \"steel\"",
            "/shapes/3: missing key \"shapes\"",
            "/shapes/4: expected an object with a \"type\", found 5",
            "/lights/0: missing key \"intensity\"",
            "/lights/0: missing key \"position\"",
        ],
    );
}

#[test]
fn at_most_twenty_faults_are_listed() {
    let bad = r#"{"type": "sphere", "radius": -1}"#;
    let many = |count: usize| scene(&format!("\"shapes\": [{}]", vec![bad; count].join(",\n")));
    assert_eq!(read(many(MAX_FAULTS - 1)).expect_err("faults").len(), MAX_FAULTS - 1);
    let faults = read(many(100_000)).expect_err("faults");
    assert_eq!(faults.len(), MAX_FAULTS);
    assert!(faults[MAX_FAULTS - 1].starts_with("21:30: /shapes/19/radius:"), "the first twenty: {}", faults[MAX_FAULTS - 1]);
}

/// Objects are read again to find missing keys. The time for that must not grow exponentially with the depth.
#[test]
fn missing_keys_in_nested_lists_take_no_longer() {
    let open = r#"{"type": "group", "shapes": [{"type": "mesh", "materials": {"m": {"type": "conductor"}}}, "#;
    let text = format!("{{\"shapes\": [{}5{}]}}", open.repeat(60), "]}".repeat(60));
    assert_eq!(read(text).expect_err("faults").len(), MAX_FAULTS);
}

#[test]
fn truncation_anywhere_is_a_fault_with_a_position() {
    let end = EVERYTHING.rfind('}').expect("an object");
    for length in 0..=end {
        let error = describe::parse(&EVERYTHING.as_bytes()[..length], "s").expect_err("truncated");
        assert_eq!(error.exit_code(), 3, "at byte {length}: {error}");
        let faults = error.faults();
        assert!(faults[0].line.is_some() && faults[0].column.is_some(), "at byte {length}: {error}");
    }
}

/// Random numbers to mutate text: a linear congruential generator.
struct Noise(u64);

impl Noise {
    fn below(&mut self, n: usize) -> usize {
        // Knuth's MMIX constants.
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) as usize % n.max(1)
    }
}

#[test]
fn mutated_scenes_never_panic() {
    const WORDS: [&str; 16] = ["", "{", "}", "[", "]", ",", ":", "\"", "0", "-1", "1e39", "null", "\"type\"", "\"pt\"", "/*", "\u{1f431}"];
    let mut noise = Noise(1);
    let mut survivors = 0;
    for _ in 0..20_000 {
        let mut bytes = EVERYTHING.as_bytes().to_vec();
        for _ in 0..1 + noise.below(3) {
            let (start, other) = (noise.below(bytes.len()), noise.below(bytes.len()));
            let removed = noise.below(8).min(bytes.len() - start);
            let inserted = match noise.below(3) {
                0 => WORDS[noise.below(WORDS.len())].as_bytes().to_vec(),
                1 => bytes[other..(other + noise.below(30)).min(bytes.len())].to_vec(),
                _ => vec![noise.below(256) as u8],
            };
            bytes.splice(start..start + removed, inserted);
        }
        match describe::parse(&bytes, "s") {
            Ok(_) => survivors += 1,
            Err(error) => assert!(matches!(error.exit_code(), 3 | 4) && !error.to_string().is_empty(), "{error:?}"),
        }
    }
    assert!(survivors > 100, "some mutations leave a scene, else only the parser is tested: {survivors}");
}

/// A tree of escapes, numbers as they are written, and empty and nested lists equals the tree that is read from its text.
#[test]
fn a_tree_reads_back_from_its_text() {
    let scenes = [EVERYTHING, r#"{"a": [], "b": {}, "c": [[1.50, -2e-300], [], ["\u0007\"\\é"]], "d": null, "e": [true, {}]}"#];
    for scene in scenes {
        let tree = pt::reader::parse(scene.as_bytes()).expect("JSON");
        let again = pt::reader::parse(tree.to_string().as_bytes()).unwrap_or_else(|e| panic!("{e}\nin\n{tree}"));
        assert_eq!(tree, again, "{tree}");
    }
    assert_eq!(pt::reader::parse(b"[{\"a\": 1.50}]").expect("JSON").to_string(), "[\n  {\n    \"a\": 1.50\n  }\n]");
}
