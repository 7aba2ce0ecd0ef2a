//! The command line as users see it: its files, messages and exit codes.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use tempfile::TempDir;

const SCENE: &str = r#"{
  "pt": 1,
  "camera": { "look_at": { "from": [0, 0, 3], "to": [0, 0, 0] } },
  "film": { "width": 8, "height": 6 },
  "sampler": { "spp": 2 },
  "shapes": [{ "type": "sphere" }],
  "background": { "radiance": 1 }
}"#;

/// A folder with `scene.json` in it.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("scene.json"), SCENE).expect("write");
    folder
}

fn pt(folder: &Path, args: &[&str]) -> assert_cmd::assert::Assert {
    Command::cargo_bin("pt").expect("the binary").current_dir(folder).args(args).assert()
}

/// Asserts that a call fails with this exit code and with this phrase on stderr.
#[track_caller]
fn refused(folder: &Path, args: &[&str], code: i32, phrase: &str) {
    let output = pt(folder, args).code(code).get_output().clone();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(stderr.contains(phrase), "{args:?}: expected {phrase:?} in\n{stderr}");
    assert!(!stderr.contains("panicked"), "{args:?}: {stderr}");
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).expect("list").map(|e| e.expect("entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn a_scene_becomes_an_exr_and_a_png_named_after_it() {
    let folder = folder();
    pt(folder.path(), &["scene.json"]).success();
    assert_eq!(files(folder.path()), ["scene.exr", "scene.json", "scene.png"]);
    let (image, attributes) = pt::output::exr::read(&folder.path().join("scene.exr")).expect("a readable picture");
    assert_eq!(image.size, glam::UVec2::new(8, 6));
    // The corner shows only the background, of radiance 1.
    assert_eq!(image.rgb(0, 0), [1.0; 3]);
    assert!(attributes.contains(&("pt/integrator".into(), "nee".into())), "{attributes:?}");
}

/// Options given with -D to a scene without an integrator are those of the integrator that renders.
#[test]
fn options_on_the_command_line_need_no_type() {
    let folder = folder();
    for (integrator, name) in [(&["-i", "light"][..], "light"), (&[], "nee")] {
        pt(folder.path(), &[&["scene.json", "-D", "/integrator/max_depth=1", "-o", "x.exr"][..], integrator].concat()).success();
        let (_, attributes) = pt::output::exr::read(&folder.path().join("x.exr")).expect("a readable picture");
        assert!(attributes.contains(&("pt/integrator".into(), name.into())), "{attributes:?}");
    }
    refused(folder.path(), &["scene.json", "-i", "light", "-D", "/integrator/max_dept=1"], 2, "did you mean \"max_depth\"");
    refused(folder.path(), &["scene.json", "-D", "/integrator=5"], 2, "expected an object with a \"type\"");
}

/// Paths from the lights are divided among 8 scramblings unless a number is given, and options that need the samples of each pixel apart
/// are refused.
#[test]
fn light_tracing_has_scramblings_and_refuses_what_it_cannot_do() {
    let folder = folder();
    let scene = folder.path().join("scene.json");
    for (args, scramblings) in [(&["-i", "light"][..], "8"), (&["-i", "light", "--scramblings", "4"], "4"), (&["-i", "nee"], "2")] {
        pt(folder.path(), &[&["scene.json", "-o", "x.exr"][..], args].concat()).success();
        let (_, attributes) = pt::output::exr::read(&folder.path().join("x.exr")).expect("a readable picture");
        assert!(attributes.contains(&("pt/scramblings".into(), scramblings.into())), "{args:?}: {attributes:?}");
    }
    for option in [&["--adaptive"][..], &["--clamp", "2"], &["--worst", "3"], &["--clamp", "2", "--pixel", "1,1"]] {
        let args = [&["scene.json", "-i", "light"][..], option].concat();
        refused(folder.path(), &args, 2, &format!("{}: not with light", option[0]));
    }
    // A number in the scene counts as well.
    fs::write(&scene, SCENE.replace(r#""spp": 2"#, r#""spp": 2, "scramblings": 16"#)).expect("write");
    pt(folder.path(), &["scene.json", "-i", "light", "-o", "x.exr"]).success();
    let (_, attributes) = pt::output::exr::read(&folder.path().join("x.exr")).expect("a readable picture");
    assert!(attributes.contains(&("pt/scramblings".into(), "16".into())), "{attributes:?}");
}

#[test]
fn every_integrator_is_chosen_by_name_and_keeps_the_options_it_has() {
    let folder = folder();
    for entry in pt::integrators::ALL {
        pt(
            folder.path(),
            &["--integrator", entry.name, "scene.json", "-o", "x.exr", "-D", "/integrator={\"type\":\"nee\",\"max_depth\":3}"],
        )
        .success();
        let (_, attributes) = pt::output::exr::read(&folder.path().join("x.exr")).expect("a readable picture");
        assert!(attributes.contains(&("pt/integrator".into(), entry.name.into())));
    }
}

#[test]
fn several_outputs_each_by_its_extension() {
    let folder = folder();
    pt(folder.path(), &["scene.json", "-o", "a.exr", "-o", "b.png", "-o", "c.ppm", "-o", "d.pfm", "-o", "e.hdr"]).success();
    let start = |name: &str| fs::read(folder.path().join(name)).expect("written")[..3].to_vec();
    assert_eq!(start("a.exr"), [0x76, 0x2f, 0x31]);
    assert_eq!(start("b.png"), [0x89, b'P', b'N']);
    assert_eq!(start("c.ppm"), *b"P6\n");
    assert_eq!(start("d.pfm"), *b"PF\n");
    assert_eq!(start("e.hdr"), *b"#?R");
}

#[test]
fn flags_override_the_scene() {
    let folder = folder();
    let flags = ["scene.json", "-o", "x.exr", "--size", "10x4", "--spp", "3", "--seed", "7", "--sampler", "halton", "--crop", "1,5,0,2"];
    pt(folder.path(), &flags).success();
    let (image, attributes) = pt::output::exr::read(&folder.path().join("x.exr")).expect("a readable picture");
    assert_eq!((image.full_size, image.origin, image.size), (glam::UVec2::new(10, 4), glam::UVec2::new(1, 0), glam::UVec2::new(4, 2)));
    for (name, value) in [("pt/spp", "3"), ("pt/seed", "7"), ("pt/sampler", "halton")] {
        assert!(attributes.contains(&(name.into(), value.into())), "{name}: {attributes:?}");
    }
}

/// `pt scene.json 3` is `pt scene.json --spp 3`.
#[test]
fn a_number_after_the_scene_is_samples_per_pixel() {
    let folder = folder();
    pt(folder.path(), &["scene.json", "3", "-o", "a.pfm"]).success();
    pt(folder.path(), &["scene.json", "--spp", "3", "-o", "b.pfm"]).success();
    pt(folder.path(), &["-o", "c.pfm", "scene.json"]).success();
    let [a, b, c] = ["a.pfm", "b.pfm", "c.pfm"].map(|name| fs::read(folder.path().join(name)).expect("a picture"));
    assert!(a == b && a != c, "3 samples, and the scene's own 2");
    for (args, phrase) in [
        (&["scene.json", "0"][..], "expected a whole number from 1 to 4294967295"),
        (&["scene.json", "-4"], "expected a whole number from 1"),
        (&["scene.json", "1.5"], "expected a whole number from 1"),
        (&["scene.json", "3", "--spp", "4"], "cannot be used with"),
        (&["scene.json", "3", "4"], "unexpected"),
        (&["scene.json", "three"], "unexpected \"three\": one scene at a time"),
    ] {
        refused(folder.path(), args, 2, phrase);
    }
}

/// The name is YY_MM_DD-hh_mm_ss in local time, here three hours ahead of UTC.
#[test]
fn a_picture_named_by_the_clock() {
    let folder = folder();
    let now = || std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).expect("after 1970").as_secs() + 3 * 3600;
    let before = now();
    let mut command = Command::cargo_bin("pt").expect("the binary");
    command.current_dir(folder.path()).env("TZ", "AHEAD-3").args(["scene.json", "--clock-name"]).assert().success();
    let expected: Vec<String> = (before..=now()).map(by_the_clock).collect();
    let mut found: Vec<String> = files(folder.path()).into_iter().filter(|name| name != "scene.json").collect();
    found.sort();
    assert!(expected.iter().any(|name| found == [format!("{name}.exr"), format!("{name}.png")]), "{found:?}, expected {expected:?}");
    refused(folder.path(), &["scene.json", "--clock-name", "-o", "a.png"], 2, "cannot be used with");
}

/// Source: Hinnant, *chrono-Compatible Low-Level Date Algorithms* (2014), civil_from_days.
fn by_the_clock(seconds: u64) -> String {
    let (days, rest) = (seconds / 86_400 + 719_468, seconds % 86_400);
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * of_year + 2) / 153;
    let (day, month) = (of_year - (153 * from_march + 2) / 5 + 1, (from_march + 2) % 12 + 1);
    let year = year_of_era + 400 * era + u64::from(month <= 2);
    format!("{:02}_{month:02}_{day:02}-{:02}_{:02}_{:02}", year % 100, rest / 3600, rest / 60 % 60, rest % 60)
}

#[test]
fn a_single_sample_equals_that_of_the_picture() {
    let folder = folder();
    pt(folder.path(), &["scene.json", "-o", "x.exr", "--spp", "1"]).success();
    let (image, _) = pt::output::exr::read(&folder.path().join("x.exr")).expect("a readable picture");
    let output = pt(folder.path(), &["scene.json", "--pixel", "4,3", "--sample", "0"]).success().get_output().clone();
    let [r, g, b] = image.rgb(4, 3);
    assert_eq!(String::from_utf8_lossy(&output.stdout), format!("pixel 4,3 sample 0: {r:?} {g:?} {b:?}\n"));
}

#[test]
fn a_scene_from_stdin() {
    let folder = folder();
    Command::cargo_bin("pt").expect("the binary").current_dir(folder.path()).arg("-").write_stdin(SCENE).assert().success();
    assert_eq!(files(folder.path()), ["scene.json", "stdin.exr", "stdin.png"]);
    let check = Command::cargo_bin("pt").expect("the binary").args(["check", "-"]).write_stdin(SCENE).assert().success();
    assert!(check.get_output().stdout.starts_with(b"stdin: valid\n"));
}

#[test]
fn time_ends_a_render() {
    let folder = folder();
    // The render ends because of the time limit. 2³² samples would take hours.
    pt(folder.path(), &["scene.json", "--time", "0.2"]).success();
    let (image, _) = pt::output::exr::read(&folder.path().join("scene.exr")).expect("a readable picture");
    let samples = image.channel("SampleCount.Y").expect("counts")[0];
    assert!((1.0..4e9).contains(&samples), "{samples}");
}

#[test]
fn progress_and_statistics_as_json_can_be_parsed() {
    let folder = folder();
    let output = pt(folder.path(), &["scene.json", "--progress", "json", "--stats=json"]).success().get_output().clone();
    let stats: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(stats["camera_samples"], 8 * 6 * 2);
    assert!(stats["rays"].as_u64().expect("a count") >= 8 * 6 * 2);
    let lines = String::from_utf8_lossy(&output.stderr).into_owned();
    let last = lines.lines().rfind(|line| line.starts_with('{')).expect("progress");
    assert_eq!(serde_json::from_str::<serde_json::Value>(last).expect("JSON")["share"], 1.0);
}

#[test]
fn quiet_prints_nothing() {
    let folder = folder();
    let output = pt(folder.path(), &["scene.json", "-q"]).success().get_output().clone();
    assert!(output.stderr.is_empty() && output.stdout.is_empty());
}

#[test]
fn missing_effects_are_reported_in_one_line() {
    let folder = folder();
    let output = pt(folder.path(), &["scene.json", "-i", "whitted"]).success().get_output().clone();
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(stderr.contains("whitted does not simulate what this scene calls for: diffuse interreflection"), "{stderr}");
}

#[test]
fn check_lists_contents_and_required_effects() {
    let folder = folder();
    let output = pt(folder.path(), &["check", "scene.json"]).success().get_output().clone();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    for phrase in ["scene.json: valid", "environment", "\"background\"", "not called for, and off"] {
        assert!(text.contains(phrase) || phrase == "\"background\"" && text.contains("background"), "{phrase}: {text}");
    }
    assert_eq!(files(folder.path()), ["scene.json"]);
}

/// Counting rays changes no picture, with media either.
#[test]
fn statistics_change_no_picture() {
    let folder = folder();
    for scene in ["cornell-box", "fog", "media"] {
        let file = format!("{}/scenes/{scene}.json", env!("CARGO_MANIFEST_DIR"));
        let picture = |name: &str, more: &[&str]| {
            let render = [&[file.as_str(), "--size", "16x12", "--spp", "2", "-q", "-o", name], more].concat();
            pt(folder.path(), &render).success();
            std::fs::read(folder.path().join(name)).expect("a picture")
        };
        assert!(picture("plain.pfm", &[]) == picture("counted.pfm", &["--stats"]), "{scene}");
    }
}

#[test]
fn list_shows_everything_with_a_line_each() {
    let folder = folder();
    let output = pt(folder.path(), &["list"]).success().get_output().clone();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    for name in ["whitted", "halton", "mesh", "dielectric", "checker", "spot", "orthographic", "mitchell"] {
        let line = text.lines().find(|line| line.trim_start().starts_with(name)).unwrap_or_else(|| panic!("{name} in\n{text}"));
        assert!(line.split_whitespace().count() >= 4, "{line}");
    }
    // Descriptions from the scene format are cut to one line, but not within a sentence.
    let families = text.lines().skip_while(|line| *line != "samplers").take_while(|line| *line != "metrics");
    for line in families.filter(|line| line.starts_with(' ')) {
        assert!(line.ends_with('.'), "{line}");
    }
}

#[test]
fn verbose_prints_what_check_prints() {
    let folder = folder();
    let check = pt(folder.path(), &["check", "scene.json"]).success().get_output().clone();
    let verbose = pt(folder.path(), &["scene.json", "-v"]).success().get_output().clone();
    let check = String::from_utf8_lossy(&check.stdout).into_owned();
    let (valid, contents) = check.split_once("\n\n").expect("a first line by itself");
    assert_eq!(valid, "scene.json: valid");
    let verbose = String::from_utf8_lossy(&verbose.stderr).into_owned();
    assert!(verbose.starts_with(contents), "{verbose}");
}

#[test]
fn errors_as_json() {
    let folder = folder();
    fs::write(folder.path().join("bad.json"), SCENE.replace("\"spp\": 2", "\"sp\": 2, \"seed\": -1")).expect("write");
    let output = pt(folder.path(), &["bad.json", "--json-errors"]).code(3).get_output().clone();
    let object: serde_json::Value = serde_json::from_slice(&output.stderr).expect("one JSON object");
    assert_eq!(object["exit_code"], 3);
    let errors = object["errors"].as_array().expect("a list");
    assert_eq!((errors.len(), &errors[0]["pointer"], &errors[0]["line"]), (2, &"/sampler/sp".into(), &5.into()));
}

#[test]
fn a_failed_render_leaves_the_old_picture() {
    let folder = folder();
    let old = folder.path().join("scene.exr");
    fs::write(&old, "old").expect("write");
    refused(folder.path(), &["scene.json", "-D", "/shapes/0/radius=-1"], 2, "above 0");
    assert_eq!(fs::read(&old).expect("still there"), b"old");
}

#[test]
fn version_names_the_build() {
    let folder = folder();
    let output = pt(folder.path(), &["--version"]).success().get_output().clone();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.starts_with("pt 0.") && text.contains('('), "{text}");
}

/// An interrupted render writes the picture so far, and ends with the exit code of the signal.
#[cfg(unix)]
#[test]
fn an_interrupted_render_keeps_its_picture() {
    // Two signals within a second count as one, because `timeout` signals a process and its group.
    for (signals, code) in [(&["INT"][..], 130), (&["TERM"], 143), (&["HUP"], 129), (&["INT", "INT"], 130), (&["TERM"; 3], 143)] {
        let folder = folder();
        let mut child = rendering(folder.path(), "x.exr");
        let id = child.id().to_string();
        let kills = signals.iter().map(|signal| format!("kill -{signal} {id}")).collect::<Vec<_>>().join("; ");
        std::process::Command::new("sh").args(["-c", &kills]).status().expect("kill");
        assert_eq!(child.wait().expect("it ends").code(), Some(code), "{signals:?}");
        assert!(folder.path().join("x.exr").exists(), "{signals:?}");
    }
}

/// Starts a render of `scene.json` that would take hours, and waits until it has begun.
#[cfg(unix)]
fn rendering(folder: &Path, output: &str) -> std::process::Child {
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("pt"))
        .current_dir(folder)
        .args(["scene.json", "-o", output, "--spp", "4294967295", "--progress", "json"])
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("it starts");
    // After the first line of progress the render has begun.
    let mut first = String::new();
    let stderr = child.stderr.take().expect("a pipe");
    std::io::BufRead::read_line(&mut std::io::BufReader::new(stderr), &mut first).expect("a line");
    child
}

/// The picture is written into a pipe that nobody reads, so that the first signal does not end the program.
#[cfg(unix)]
#[test]
fn a_signal_more_than_a_second_after_the_first_ends_at_once() {
    let folder = folder();
    assert!(std::process::Command::new("mkfifo").arg(folder.path().join("x.exr")).status().expect("mkfifo runs").success());
    let mut child = rendering(folder.path(), "x.exr");
    let id = child.id().to_string();
    let kill = || std::process::Command::new("kill").args(["-INT", &id]).status().expect("kill");
    kill();
    let ended = loop {
        std::thread::sleep(std::time::Duration::from_millis(600));
        match child.try_wait().expect("it can be asked") {
            Some(ended) => break ended,
            None => kill(),
        };
    };
    assert_eq!(ended.code(), Some(130));
}

/// Under `nohup` pt continues when the terminal closes.
#[cfg(target_os = "linux")]
#[test]
fn an_ignored_hangup_signal_stays_ignored() {
    let folder = folder();
    let pt = assert_cmd::cargo::cargo_bin("pt");
    let script = format!("trap '' HUP; exec {} scene.json -o x.exr --time 60 --progress json", pt.display());
    let mut child = std::process::Command::new("sh")
        .args(["-c", &script])
        .current_dir(folder.path())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("it starts");
    let id = child.id().to_string();
    let kill = |signal: &str| std::process::Command::new("kill").args([signal, &id]).status().expect("kill");
    let mut lines = std::io::BufRead::lines(std::io::BufReader::new(child.stderr.take().expect("a pipe"))).map(|line| line.expect("text"));
    lines.next().expect("it renders");
    kill("-HUP");
    // A render that ends prints one more line of progress.
    assert!(lines.by_ref().take(4).all(|line| line.starts_with('{')), "it ended");
    kill("-INT");
    assert!(lines.last().is_some_and(|line| line == "error: interrupted"));
    assert_eq!(child.wait().expect("it ended").code(), Some(130));
}

/// A distant light with 10⁹ times the power does not prevent that a near light is sampled.
#[test]
fn a_strong_distant_light_does_not_hide_a_near_one() {
    let folder = folder();
    let floor = r#""shapes": [{"type": "quad", "size": 4, "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": -90}}]}]"#;
    let near = r#"{"type": "point", "position": [0, 1, 0], "intensity": 1}"#;
    let far = r#"{"type": "point", "position": [0, 1e5, 0], "intensity": 1e9}"#;
    let mean = |lights: &str| {
        let camera = r#""camera": {"look_at": {"from": [0, 1, 4], "to": [0, 0, 0]}}"#;
        let film = r#""film": {"width": 8, "height": 8}, "sampler": {"type": "independent", "spp": 4096}"#;
        let scene = format!(r#"{{"pt": 1, {camera}, {film}, {floor}, "lights": [{lights}]}}"#);
        fs::write(folder.path().join("lights.json"), scene).expect("write");
        pt(folder.path(), &["lights.json", "-q", "-o", "x.exr"]).success();
        let (image, _) = pt::output::exr::read(&folder.path().join("x.exr")).expect("a readable picture");
        image.pixels().flatten().map(f64::from).sum::<f64>() / 192.0
    };
    let (sum, both) = (mean(near) + mean(far), mean(&format!("{near}, {far}")));
    // 1/16 of the 262,144 samples choose the near light, which gives a standard error of ¾ %.
    assert!((both / sum - 1.0).abs() < 0.04, "{both} of {sum}");
}

const FLOOR: &str = r#"{"type": "quad", "size": 4, "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": -90}}]}"#;

fn floor_scene(shapes: &str, lights: &str) -> String {
    let camera = r#""camera": {"look_at": {"from": [0, 1, 4], "to": [0, 0, 0]}}"#;
    format!(r#"{{"pt": 1, {camera}, "film": {{"width": 8, "height": 8}}, "shapes": [{shapes}], "lights": [{lights}]}}"#)
}

/// L = ρ/π · I/d². A cone of 0.01° at 10 km lights a disk of 1.7 m around the origin. The cosines of its angles round to 1 in f32.
#[test]
fn a_narrow_spot_far_away_lights_what_it_points_at() {
    let folder = folder();
    let spot = r#"{"type": "spot", "position": [0, 1e4, 0], "to": [0, 0, 0], "intensity": 1e8, "inner_angle": 0.01, "outer_angle": 0.01}"#;
    fs::write(folder.path().join("spot.json"), floor_scene(FLOOR, spot)).expect("write");
    let output = pt(folder.path(), &["spot.json", "--pixel", "4,4", "--sample", "0"]).success().get_output().clone();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let value: f64 = text.split_whitespace().nth(4).and_then(|v| v.parse().ok()).unwrap_or_else(|| panic!("{text}"));
    // Rounding of the position, 2⁻²⁴ of 10 km at worst, changes d² by 10⁻⁷.
    assert!((value * std::f64::consts::PI / 0.5 - 1.0).abs() < 1e-5, "{text}");
}

/// Far from the origin, which is at the finest detail, the four corners of the quad are one point in f32. Such a lamp could be sampled but
/// never hit.
#[test]
fn a_quad_whose_corners_round_to_one_point_is_refused() {
    let folder = folder();
    let lamp = r#"{"type": "quad", "size": 0.1, "emission": 1000, "transform": [{"translate": [1e7, 1, 0.3]}]}"#;
    let fine = [r#"{"type": "quad", "size": 1e-3}"#; 3].join(", ");
    fs::write(folder.path().join("far.json"), floor_scene(&format!("{FLOOR}, {fine}, {lamp}"), "")).expect("write");
    refused(folder.path(), &["far.json"], 3, "too small to be hit in a scene this large");
}

/// A lamp whose area is too small for f32 still emits light. The warning of a black picture is given only if the picture is black.
#[test]
fn the_warning_of_a_black_picture_is_given_only_without_light() {
    let folder = folder();
    for (scale, emission) in [1.0, 1e-10, 1e-20, 1e-30].into_iter().flat_map(|scale| [(scale, 0), (scale, 1)]) {
        let scene = format!(
            r#"{{"pt": 1, "camera": {{"look_at": {{"from": [0, 0, {}], "to": [0, 0, 0]}}}}, "film": {{"width": 8, "height": 6}},
                "shapes": [{{"type": "sphere", "radius": {scale}, "emission": {emission}}}]}}"#,
            3.0 * scale
        );
        fs::write(folder.path().join("lamp.json"), scene).expect("write");
        let output = pt(folder.path(), &["lamp.json", "--spp", "1", "-o", "x.exr"]).success().get_output().clone();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let (image, _) = pt::output::exr::read(&folder.path().join("x.exr")).expect("a readable picture");
        let is_black = image.pixels().flatten().all(|x| x == 0.0);
        assert_eq!(is_black, emission == 0, "{scale}");
        assert_eq!(said.contains("will be black"), is_black, "{scale}: {said}");
    }
}

/// Words that are no Unicode are refused with a message, as others are.
#[cfg(unix)]
#[test]
fn words_that_are_no_unicode_are_refused() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;

    for words in [&[&b"--\xff\xffc"[..]][..], &[b"check", b"\xff.json", b"--\xfe"], &[b"a", b"b", b"\xff"]] {
        let output =
            Command::cargo_bin("pt").expect("pt").args(words.iter().map(|word| OsStr::from_bytes(word))).output().expect("it runs");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.starts_with("error: ") && !said.contains("panicked"), "{words:?}: {said}");
    }
}
