//! The options `--trace`, `--worst`, `--ledger` and `--clamp` on the command line.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

/// A glass ball over a matte floor, a small lamp, and a mirror behind.
const SCENE: &str = r#"{
  "pt": 1,
  "camera": { "look_at": { "from": [0, 1, 4], "to": [0, 1, 0] } },
  "film": { "width": 16, "height": 16 },
  "sampler": { "spp": 16, "seed": 3 },
  "materials": { "glass": { "type": "dielectric", "eta": 1.5 }, "floor": { "type": "diffuse", "albedo": 0.8 } },
  "shapes": [
    { "type": "sphere", "name": "ball", "radius": 0.8, "center": [0, 1, 0], "material": "glass" },
    { "type": "quad", "size": 8, "material": "floor", "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": -90 } }] },
    { "type": "sphere", "name": "lamp", "radius": 0.1, "center": [1, 3, 1], "emission": 50 }
  ]
}"#;

fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("my scene.json"), SCENE).expect("write");
    folder
}

/// Runs pt and returns its stdout and stderr.
#[track_caller]
fn pt(folder: &Path, args: &[&str]) -> (String, String) {
    let output = Command::cargo_bin("pt").expect("the binary").current_dir(folder).args(args).assert().success().get_output().clone();
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("text");
    (text(&output.stdout), text(&output.stderr))
}

/// The numbers of the line that begins with a word.
fn numbers(text: &str, word: &str) -> Vec<f32> {
    let line = text.lines().find_map(|line| line.trim_start().strip_prefix(word)).unwrap_or_else(|| panic!("{word:?} in\n{text}"));
    line.split_whitespace().map_while(|word| word.parse().ok()).collect()
}

#[test]
fn a_trace_lists_every_vertex() {
    let folder = folder();
    for integrator in ["path", "nee", "whitted"] {
        let asked = ["my scene.json", "--integrator", integrator, "--pixel", "13,13", "--sample", "5"];
        let (plain, _) = pt(folder.path(), &asked);
        let (text, _) = pt(folder.path(), &[&asked[..], &["--trace"]].concat());
        let [sum, sample] = ["sum ", "sample "].map(|word| numbers(&text, word));
        assert_eq!(sum, sample, "{text}");
        assert_eq!(sample, numbers(&plain, "pixel 13,13 sample 5:"), "{text}");
        // The lines that begin with + are all contributions, in their order.
        let mut total = [0.0f32; 3];
        for line in text.lines().filter_map(|line| line.trim_start().strip_prefix("+ ")) {
            let value: Vec<f32> = line.split_whitespace().take(3).map(|x| x.parse().expect("a number")).collect();
            (0..3).for_each(|c| total[c] += value[c]);
        }
        assert_eq!(total.to_vec(), sample, "{text}");
        assert!(text.contains("end: "), "{text}");
        assert!(text.contains("floor (diffuse)") && text.contains("lamp") || integrator == "path", "{text}");

        let (json, _) = pt(folder.path(), &[&asked[..], &["--trace=json"]].concat());
        let json: Value = serde_json::from_str(&json).expect("JSON");
        let told = |key: &str| json[key].as_array().expect(key).iter().map(|x| x.as_f64().expect("a number") as f32).collect::<Vec<_>>();
        assert_eq!((told("value"), told("sum")), (sample.clone(), sample), "{json}");
        assert_eq!(json["events"][0]["event"], "vertex");
        let lines = text
            .lines()
            .filter(|line| line.trim_start().starts_with(['+', '→']) || line.contains(", throughput ") || line.contains("end: "));
        assert_eq!(json["events"].as_array().map(Vec::len), Some(lines.count()), "{text}");
    }
}

/// At the ball the path of `whitted` branches. Both branches are indented further than the ball, and start at the same indentation.
#[test]
fn branches_are_indented() {
    let folder = folder();
    let (text, _) = pt(folder.path(), &["my scene.json", "--integrator", "whitted", "--pixel", "8,8", "--sample", "0", "--trace"]);
    let vertices: Vec<&str> = text.lines().filter(|line| line.contains(", throughput ")).collect();
    assert!(vertices[0].starts_with("0    ball, glass (dielectric)"), "{text}");
    let indent = |line: &str| line.len() - line.trim_start().len();
    for line in &vertices {
        let depth: usize = line.split_whitespace().next().and_then(|word| word.parse().ok()).expect("a depth");
        // Every vertex branches up to the fourth interface.
        assert!(depth > 4 || indent(line) == 4 * depth, "{text}");
    }
    let seconds: Vec<usize> = text.lines().filter(|line| line.trim_start().starts_with("→ transmission")).map(indent).collect();
    assert!(seconds.len() > 2 && seconds[0] == 5, "{text}");
}

#[test]
fn integrators_without_recording_are_reported() {
    let folder = folder();
    let (text, _) = pt(folder.path(), &["my scene.json", "--integrator", "normals", "--pixel", "8,8", "--sample", "0", "--trace"]);
    assert!(text.ends_with("normals tells nothing of its paths\n"), "{text}");
    for (args, phrase) in [
        (&["my scene.json", "--trace"][..], "--sample"),
        (&["my scene.json", "--pixel", "1,1", "--sample", "0", "--trace=xml"], "xml"),
        (&["my scene.json", "--worst", "0"], "expected a whole number from 1 to 1000"),
        (&["my scene.json", "--clamp", "-1"], "expected a number above 0"),
        (&["my scene.json", "--clamp", "NaN"], "expected a number above 0"),
        (&["my scene.json", "--pixel", "1,1", "--ledger"], "--ledger"),
    ] {
        let output =
            Command::cargo_bin("pt").expect("the binary").current_dir(folder.path()).args(args).assert().code(2).get_output().clone();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(stderr.contains(phrase) && !stderr.contains("panicked"), "{args:?}: {stderr}");
    }
}

/// The printed commands reproduce the listed samples, with all flags and quotes.
#[test]
fn the_worst_samples_can_be_replayed() {
    let folder = folder();
    let flags = ["--integrator", "path", "--seed", "8", "--size", "20x14", "--sampler", "sobol", "--spp", "128", "-D", "/camera/fov=50"];
    let args = [&["my scene.json", "-o", "x.exr", "--worst", "4"][..], &flags].concat();
    let (text, stderr) = pt(folder.path(), &args);
    let listed: Vec<&str> = text.lines().skip(1).filter(|line| line.contains("pt 'my scene.json'")).collect();
    assert_eq!(listed.len(), 4, "{text}");
    for line in listed {
        let (told, command) = line.split_once("  pt ").expect("a command");
        let value: Vec<&str> = told.split_once("%  ").expect("a value").1.split(' ').collect();
        let words = command.replace("'my scene.json'", "my\u{a0}scene.json");
        let words: Vec<String> = words.split(' ').map(|word| word.replace('\u{a0}', " ")).collect();
        let (trace, _) = pt(folder.path(), &words.iter().map(String::as_str).collect::<Vec<_>>());
        assert!(trace.contains(&format!("sample {}\n", value.join(" "))), "{line}\n{trace}");
    }
    // Only a few paths hit the lamp by chance, so the noisiest sample is reported without being asked for.
    assert!(stderr.contains("cannot be established"), "{stderr}");
    let (_, stderr) = pt(folder.path(), &args.iter().copied().filter(|word| !["--worst", "4"].contains(word)).collect::<Vec<_>>());
    assert!(
        stderr.contains("one sample makes ") && stderr.contains(" (--worst 10 lists more)") && stderr.contains(" --trace\n"),
        "{stderr}"
    );
}

#[test]
fn biases_are_reported() {
    let folder = folder();
    let base = ["my scene.json", "-o", "x.exr", "--integrator", "nee"];
    let told = |more: &[&str]| pt(folder.path(), &[&base[..], more].concat()).1;
    // With default settings no light is removed and nothing is printed, except with `--ledger`.
    assert!(!told(&[]).contains("bias"), "{}", told(&[]));
    assert!(told(&["--ledger"]).contains("bias: max_depth 64 removes nothing that "));
    let short = told(&["--ledger", "--spp", "512", "-D", "/integrator={\"type\":\"nee\",\"max_depth\":1}"]);
    assert!(short.contains("bias: max_depth 1 removes ") && short.contains(" % of the energy") && short.contains(" ± "), "{short}");
    let smooth = r#"/shapes/1={"type": "mesh", "positions": [[-4, 0, 4], [4, 0, 4], [0, 1, -4]], "triangles": [[0, 1, 2]],
        "normals": [[-0.6, 0.8, 0], [0.6, 0.8, 0], [0, 0.8, -0.6]], "smooth_shadows": true}"#;
    let facets = told(&["--ledger", "-D", smooth]);
    assert!(facets.contains("bias: smooth_shadows (meshes: 1) ") && facets.contains(" % of the energy"), "{facets}");
    let clamped = told(&["--clamp", "0.01"]);
    assert!(clamped.contains("bias: clamp 0.01 removes ") && clamped.contains(" % of the energy"), "{clamped}");
    let attributes = || pt::output::exr::read(&folder.path().join("x.exr")).expect("a picture").1;
    assert!(attributes().contains(&("pt/bias".into(), "clamp 0.01".into())), "{:?}", attributes());
    let removed =
        attributes().into_iter().find(|(name, _)| name == "pt/biasRemoved").and_then(|(_, value)| value.to_string().parse::<f64>().ok());
    assert!(removed.is_some_and(|share| share > 0.001 && share < 1.0), "{:?}", attributes());
    told(&[]);
    assert!(!attributes().iter().any(|(name, _)| name.starts_with("pt/bias")), "{:?}", attributes());
}
