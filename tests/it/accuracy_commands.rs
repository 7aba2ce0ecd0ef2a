//! Output and exit codes of the commands about accuracy: targets, predicted times, comparisons, verdicts.

use std::path::Path;

use assert_cmd::Command;
use pt::film::Image;
use pt::output::{Attributes, Tonemap, exr, write};
use tempfile::TempDir;

const CORNELL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell-box.json");

/// stdout and stderr of a call that ends with this exit code.
#[track_caller]
fn said(folder: &Path, code: i32, args: &[&str]) -> String {
    let output = Command::cargo_bin("pt").expect("the binary").current_dir(folder).args(args).output().expect("a run");
    let text = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(code), "{args:?}\n{text}");
    text
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

#[test]
fn a_target_is_met_or_missed() {
    let folder = folder();
    let render = |code: i32, more: &[&str]| said(folder.path(), code, &[&[CORNELL, "--size", "48x48", "-o", "box.exr"], more].concat());
    let met = render(0, &["--target", "20%"]);
    assert!(met.contains("target 20 %: met (95 % sure)"), "{met}");
    let (_, attributes) = exr::read(&folder.path().join("box.exr")).expect("a picture");
    let high = attributes
        .iter()
        .find(|(name, _)| name == "pt/relativeErrorHigh")
        .expect("an error")
        .1
        .to_string()
        .parse::<f64>()
        .expect("a number");
    assert!(high <= 0.21, "the interval lies below the target: {high}");
    let missed = render(7, &["--target", "0.1%", "--spp", "16"]);
    assert!(missed.contains("target 0.1 %: not met") && missed.contains("would take about"), "{missed}");
    assert!(render(2, &["--target", "0"]).contains("above 0 and below 1"));
}

/// A render that only its target would end gives up where the target will never be established: in a picture of so few pixels that a few
/// always have all the noise, and in a black one. With another limit, that limit ends it.
#[test]
fn a_target_out_of_reach_is_given_up() {
    let folder = folder();
    let render = |more: &[&str]| said(folder.path(), 7, &[&["-o", "x.exr", "--target", "1%"], more].concat());
    let few = render(&[CORNELL, "--size", "4x4"]);
    assert!(few.contains("16384 spp") && few.contains("target 1 %: cannot be established (heavy tail"), "{few}");
    let few = render(&[CORNELL, "--size", "4x4", "--spp", "20000"]);
    assert!(few.contains("20000 spp") && few.contains("target 1 %: cannot be established (heavy tail"), "{few}");
    // A small ball, lit by a lamp, in the dark: with --adaptive pixels take different numbers of samples, as the closing line says.
    let ball = r#"{"type": "sphere", "radius": 0.25, "material": {"type": "diffuse"}}"#;
    let lamp = r#"{"type": "sphere", "radius": 0.5, "center": [3, 0, 3], "emission": 5}"#;
    let camera = r#""camera": {"type": "perspective", "look_at": {"from": [0, 0, 5], "to": [0, 0, 0], "up": [0, 1, 0]}, "fov": 40}"#;
    std::fs::write(folder.path().join("ball.json"), format!(r#"{{"pt": 1, {camera}, "shapes": [{ball}, {lamp}]}}"#)).expect("a scene");
    let ball = render(&["ball.json", "--size", "16x16", "--adaptive"]);
    assert!(ball.contains(" spp (") && ball.contains("given up") && ball.contains("cannot be established (heavy tail"), "{ball}");
    // An error from 64 scramblings takes two samples of each.
    let early = render(&[CORNELL, "--size", "8x8", "--scramblings", "64", "--spp", "64"]);
    assert!(early.contains("target 1 %: not met"), "{early}");
    let scene = format!(r#"{{"pt": 1, {camera}, "shapes": [{{"type": "sphere", "material": {{"type": "diffuse"}}}}]}}"#);
    std::fs::write(folder.path().join("black.json"), scene).expect("a scene");
    for more in [&["black.json", "--size", "8x8"] as &[&str], &["black.json", "--size", "16x16", "--region", "0,8,0,8"]] {
        let black = render(more);
        assert!(black.contains("16384 spp") && black.contains("cannot be established (no light was found)"), "{black}");
    }
}

/// If a few bright dots make all the noise, no error and no verdict are given, in the closing line and in the file alike. What is said of
/// most pixels is a lower bound. The path of the brightest dot is shown instead.
#[test]
fn noise_of_rare_bright_samples_gives_no_error_estimate() {
    let (folder, caustic) = (folder(), CORNELL.replace("cornell-box", "caustic"));
    for seed in ["1", "2"] {
        let args = [&caustic, "--size", "240x180", "--spp", "128", "--seed", seed, "-o", "dots.exr"];
        let text = said(folder.path(), 0, &args);
        assert!(text.contains("relative error cannot be established (heavy tail)") && text.contains("--trace"), "{text}");
        let (_, attributes) = exr::read(&folder.path().join("dots.exr")).expect("a picture");
        let value = |name: &str| attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.to_string());
        assert_eq!(value("pt/relativeErrorRefused").as_deref(), Some("heavy tail: a few pixels hold all the noise"));
        assert_eq!((value("pt/relativeError"), value("pt/relativeErrorHigh")), (None, None));
        assert_eq!(value("pt/mostPixelsErrorAtLeast").is_some(), text.contains(" % of the pixels at least "), "{text}");
        let text = said(folder.path(), 7, &["verify", &caustic, "dots.exr", "dots.exr", "--size", "240x180"]);
        assert!(text.contains("inconclusive"), "{text}");
    }
    // Most pictures of so few samples have no dot. Those of seed 3 have some.
    let seed = ["-D", "/sampler/seed=3"];
    let args = [&caustic, "--size", "96x72", "--target", "5%", "--spp", "64", "-o", "dots.exr"];
    let text = said(folder.path(), 7, &[&args[..], &seed].concat());
    assert!(text.contains("target 5 %: cannot be established"), "{text}");
    let args = ["verify", &caustic, "nee", "path", "--size", "96x72", "--spp", "64"];
    let text = said(folder.path(), 7, &[&args[..], &seed].concat());
    assert!(
        text.contains("inconclusive") && text.contains("nee: 64 spp in ") && text.contains("relative error cannot be established"),
        "{text}"
    );
}

/// Sides whose own error cannot be established are not called the same picture, though their tests accept.
#[test]
fn sides_without_an_error_are_not_called_the_same() {
    let (folder, plates) = (folder(), CORNELL.replace("cornell-box", "mis-plates"));
    let text = said(folder.path(), 7, &["verify", &plates, "nee", "path", "--size", "48x36", "--spp", "256"]);
    assert!(text.contains("relative error cannot be established (heavy tail"), "{text}");
    assert!(text.contains("inconclusive") && !text.contains("the same picture"), "{text}");
}

/// An adaptive render prints the range of samples per pixel.
#[test]
fn adaptive_renders_report_their_sample_counts() {
    let folder = folder();
    let adaptive = |code: i32, more: &[&str]| said(folder.path(), code, &[&[CORNELL, "--size", "32x32", "--adaptive"], more].concat());
    let text = adaptive(0, &["--spp", "64", "-o", "box.exr"]);
    assert!(text.contains(" spp (") && text.contains(" to 128)"), "{text}");
    let (image, _) = exr::read(&folder.path().join("box.exr")).expect("a picture");
    let counts = image.channel("SampleCount.Y").expect("counts");
    assert!(counts.iter().any(|n| *n != counts[0]) && counts.iter().all(|n| n.log2().fract() == 0.0));
}

/// The pilot prints four predicted times for each integrator, each with an interval, or a line that a longer pilot is needed. A longer
/// pilot has the four times, on a machine of any speed.
#[test]
fn a_pilot_predicts_render_times_of_each_integrator() {
    let folder = folder();
    let listed = |seconds: u32| {
        let seconds = seconds.to_string();
        said(folder.path(), 0, &[CORNELL, "--size", "32x32", "--spp", "4", "--pilot", &seconds, "--integrators", "nee,path"])
    };
    let has_prices = |text: &str, name: &str| {
        let first = text.lines().position(|line| line.trim_start().starts_with(&format!("{name} "))).expect("a line");
        let lines: Vec<&str> = text.lines().skip(first).take(4).collect();
        let priced = lines.iter().all(|line| line.contains(" % ") && line.contains('('));
        assert!(
            priced || lines[0].contains("cannot be established: too noisy: more samples are needed; a longer --pilot may help"),
            "{text}"
        );
        assert!(lines.iter().all(|line| line.chars().count() <= 80), "{text}");
        priced
    };
    let all_have = |text: &str| ["nee", "path"].map(|name| has_prices(text, name)) == [true; 2];
    assert!((0..12).any(|doublings| all_have(&listed(1 << doublings))));
    assert!(said(folder.path(), 2, &[CORNELL, "--pilot", "1s", "--integrators", "nea"]).contains("did you mean \"nee\""));
}

/// A render that will take more than a minute prints its predicted time after five seconds, or as soon as the error is known.
#[test]
fn a_long_render_predicts_its_time_unasked() {
    let folder = folder();
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("pt"))
        .current_dir(folder.path())
        .args([CORNELL, "--size", "32x32", "--time", "10m", "--progress", "none"])
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("it starts");
    let stderr = std::io::BufReader::new(child.stderr.take().expect("a pipe"));
    let lines: Vec<String> = std::io::BufRead::lines(stderr).take(1).collect::<Result<_, _>>().expect("lines");
    child.kill().expect("killed");
    child.wait().expect("it ends");
    assert!(lines[0].contains(" % would take about ") && lines[0].ends_with(')'), "{lines:?}");
}

/// A single scrambling gives no error estimate, so that no target is ever met: it is refused at once. Too few samples say why they tell none.
#[test]
fn samples_that_tell_no_error_say_why() {
    let folder = folder();
    let render = |code: i32, more: &[&str]| said(folder.path(), code, &[&[CORNELL, "--size", "16x16", "-o", "box.exr"], more].concat());
    for flag in [["--target", "2%"], ["--pilot", "1s"]] {
        let text = render(2, &[&flag[..], &["--scramblings", "1"]].concat());
        assert!(text.contains(&format!("{}: a single scrambling gives no error estimate", flag[0])), "{text}");
    }
    assert!(render(0, &["--spp", "3"]).contains("no error is told: that takes 4 samples per pixel"));
    assert!(render(0, &["--spp", "64", "--scramblings", "1"]).contains("no error is told: that takes two scramblings"));
    let adaptive = said(folder.path(), 0, &[CORNELL, "--size", "48x48", "-o", "box.exr", "--spp", "8", "--adaptive"]);
    assert!(adaptive.contains("no error is told: that takes 4 samples in each pixel"), "{adaptive}");
}

/// The pictures of every sampler contain error estimates and their degrees of freedom. A single scrambling gives no error estimate.
#[test]
fn pictures_contain_their_error_estimates() {
    let folder = folder();
    for (kind, name, _) in pt::sampler::Kind::ALL {
        for (k, freedom) in [("1", 0.0), ("2", 1.0), ("8", 7.0)] {
            let args = [CORNELL, "--size", "16x16", "--spp", "32", "--sampler", name, "--scramblings", k, "-q", "-o", "a.exr"];
            said(folder.path(), 0, &args);
            let (image, attributes) = exr::read(&folder.path().join("a.exr")).expect("a picture");
            let freedom = if *kind == pt::sampler::Kind::Independent { 31.0 } else { freedom };
            assert_eq!(image.channel("StdErr.G").is_some(), freedom > 0.0, "{name} {k}");
            assert!(image.channel("SampleCount.Y").is_some_and(|counts| counts.iter().all(|n| *n == 32.0)), "{name} {k}");
            assert!(attributes.contains(&("pt/standardErrorFreedom".into(), freedom.to_string().into())), "{name} {k}: {attributes:?}");
        }
    }
    assert!(said(folder.path(), 2, &[CORNELL, "--scramblings", "3"]).contains("expected a power of two"));
}

/// A picture by another integrator passes. One with 3 % more light, or with a corner that is 30 % brighter, does not.
#[test]
fn verify_finds_planted_bias() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    said(folder.path(), 0, &[CORNELL, "--size", "64x64", "--spp", "1024", "--scramblings", "16", "--seed", "77", "-q", "-o", "good.exr"]);
    let (good, attributes) = exr::read(&at("good.exr")).expect("a picture");
    let planted = |name: &str, factor: &dyn Fn(usize) -> f32| {
        let mut image: Image = good.clone();
        for channel in image.channels.iter_mut().filter(|channel| channel.name != "SampleCount.Y") {
            channel.values.iter_mut().enumerate().for_each(|(i, value)| *value *= factor(i));
        }
        write(&at(name), &image, &attributes, &Tonemap::default()).expect("written");
    };
    planted("bright.exr", &|_| 1.03);
    planted("corner.exr", &|i| if i % 64 >= 56 && i / 64 >= 56 { 1.3 } else { 1.0 });
    let verify = |code: i32, side: &str| said(folder.path(), code, &["verify", CORNELL, "nee", side, "--size", "64x64", "--spp", "1024"]);
    assert!(verify(0, "good.exr").contains("the same picture"));
    assert!(verify(1, "bright.exr").contains("different pictures"));
    assert!(verify(1, "corner.exr").contains("block: DIFFER"));
    let mut bare = good.clone();
    bare.channels.retain(|channel| !channel.name.starts_with("StdErr"));
    write(&at("bare.exr"), &bare, &Attributes::new(), &Tonemap::default()).expect("written");
    assert!(verify(3, "bare.exr").contains("has no channel StdErr.R"));
    assert!(said(folder.path(), 3, &["verify", CORNELL, "nee", "good.exr", "--size", "32x32"]).contains("expected 32 × 32 pixels"));
}

#[test]
fn compare_writes_a_report_and_says_which_is_cheapest() {
    let folder = folder();
    // The checkpoints are numbers of samples, so that only the seconds in the report depend on the machine.
    said(folder.path(), 0, &[CORNELL, "--size", "32x32", "--spp", "2048", "--seed", "9", "-q", "-o", "truth.exr"]);
    let given = ["compare", CORNELL, "--size", "32x32", "--spp", "64", "--reference", "truth.exr"];
    let text = said(folder.path(), 0, &[&given[..], &["-o", "report", "-m", "flip", "-m", "mse:robust"]].concat());
    assert!(text.contains(&format!("{} is the cheapest", cheapest(folder.path()))) && text.contains("that is bias"), "{text}");
    assert!(text.contains("whitted does not simulate diffuse interreflection"), "{text}");
    for file in ["index.html", "convergence.csv", "convergence.json", "reference.exr"] {
        assert!(folder.path().join("report").join(file).is_file(), "{file}");
    }
    let csv = std::fs::read_to_string(folder.path().join("report/convergence.csv")).expect("a table");
    assert!(csv.contains("trimmed,flip,mse:robust,mse_stderr") && csv.contains("# flip = "), "{csv}");
    assert!(said(folder.path(), 2, &["compare", CORNELL, "--metric", "flop"]).contains("did you mean \"flip\""));
    let again = ["compare", CORNELL, "--size", "24x24", "--spp", "64", "--reference", "report/reference.exr"];
    assert!(said(folder.path(), 3, &again).contains("expected 24 × 24 pixels"));
}

/// The report's reference is a reference for other commands: it states its error, and how sure its standard errors are.
#[test]
fn the_reference_of_a_report_serves_other_commands() {
    let folder = folder();
    let size = ["--size", "32x32"];
    let compare = [&["compare", CORNELL, "--spp", "16", "--integrators", "nee", "--progress", "none"], &size[..]].concat();
    said(folder.path(), 0, &[&compare[..], &["--reference-time", "0.2s", "--cache", "cache", "-o", "first"]].concat());
    let verify = ["verify", CORNELL, "nee", "first/reference.exr", "--size", "32x32", "--spp", "256", "--alpha", "0.01%"];
    let output = Command::cargo_bin("pt").expect("the binary").current_dir(folder.path()).args(verify).output().expect("a run");
    assert!(matches!(output.status.code(), Some(0 | 7)), "{}", String::from_utf8_lossy(&output.stderr));
    // A given reference keeps its attributes.
    said(folder.path(), 0, &[&compare[..], &["--reference", "first/reference.exr", "-o", "second"]].concat());
    let attributes = ["first", "second"].map(|report| exr::read(&folder.path().join(report).join("reference.exr")).expect("a picture").1);
    assert!(attributes[0].iter().any(|(name, _)| name == "pt/relativeErrorHigh"), "{:?}", attributes[0]);
    assert_eq!(attributes[0], attributes[1]);
    assert!(!folder.path().join("first/reference.ptc").exists(), "nothing else is left behind");
}

/// A reference with an error of about 16 % is coarser than what 128 samples give: that is noted with a command that can be copied, no time
/// is stated for a smaller error, and what the reference lacks is not called a bias of the method.
#[test]
fn a_coarse_reference_is_noted_with_a_command_that_works() {
    let folder = folder();
    let scene = "my box's copy.json";
    std::fs::copy(CORNELL, folder.path().join(scene)).expect("copied");
    let wider = ["-D", "/camera/fov=40", "--size", "24x24"];
    said(folder.path(), 0, &[&[scene, "--spp", "32", "--seed", "3", "-q", "-o", "coarse.exr"], &wider[..]].concat());
    let given = ["compare", scene, "--spp", "128", "--integrators", "nee", "--reference", "coarse.exr", "--cache", "kept"];
    let text = said(folder.path(), 0, &[&given[..], &wider, &["--progress", "none", "-o", "report"]].concat());
    assert!(
        text.contains("the reference is too coarse to tell the time of nee") && text.contains("against coarse.exr, relative error "),
        "{text}"
    );
    assert!(!text.contains("nee settles") && !text.contains("nee never"), "{text}");

    let command = text.lines().find_map(|line| line.strip_prefix("  pt reference ")).unwrap_or_else(|| panic!("no command in {text}"));
    assert!(command.contains("-D /camera/fov=40") && command.contains("--cache kept --size 24x24 --error "), "{command}");
    let program = assert_cmd::cargo::cargo_bin("pt");
    let line = format!("'{}' reference {command} --spp 1", program.display());
    let run = std::process::Command::new("sh").arg("-c").arg(&line).current_dir(folder.path()).output().expect("a shell");
    assert!(matches!(run.status.code(), Some(0 | 7)), "{line}: {}", String::from_utf8_lossy(&run.stderr));
}

/// Where a few pixels hold all the noise of the reference, no method is the cheapest.
#[test]
fn of_a_caustic_no_time_is_stated() {
    let folder = folder();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/caustic.json");
    said(folder.path(), 0, &[scene, "--size", "120x90", "--spp", "64", "--seed", "1", "-q", "-o", "truth.exr"]);
    let given = ["compare", scene, "--size", "120x90", "--spp", "32", "--integrators", "nee", "--reference", "truth.exr", "-o", "report"];
    let text = said(folder.path(), 0, &given);
    let nothing = "For 10 %, 3 % and 1 %, the reference is too coarse to tell the time of nee.";
    assert!(text.contains(nothing) && !text.contains("cheapest"), "{text}");
    assert!(text.contains(" · error unknown, as is that of the reference\n") && !text.contains("slope"), "{text}");
    let page = std::fs::read_to_string(folder.path().join("report/index.html")).expect("a page");
    assert!(page.contains("unknown, as is that of the reference"));
}

/// A replay from another folder and with other threads finds the same bits. What the recorded run had otherwise is told, and a changed
/// error ends with exit code 1.
#[test]
fn a_replay_says_what_changed() {
    let folder = folder();
    let compare = ["compare", CORNELL, "--size", "24x24", "--spp", "16", "--integrators", "nee,path", "--progress", "none"];
    said(folder.path(), 0, &[&compare[..], &["--reference-time", "1s", "-o", "report"]].concat());
    let file = folder.path().join("report/convergence.json");
    let data: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&file).expect("data")).expect("JSON");
    let made = &data["provenance"];
    let seeds: Vec<u64> = serde_json::from_value(made["seeds"].clone()).expect("seeds");
    assert!(seeds.len() == 4 && seeds.windows(2).all(|pair| pair[1] == pair[0] + 1), "{seeds:?}");
    assert!(made["command"].as_str().is_some_and(|text| text.starts_with("pt compare ") && text.ends_with("-o report")), "{made}");
    assert!(made["version"].as_str().is_some_and(|text| text.starts_with(env!("CARGO_PKG_VERSION"))), "{made}");
    assert!(data["conclusions"][0]["command"].as_str().is_some_and(|text| text.starts_with("pt ")), "{data}");

    let elsewhere = tempfile::tempdir().expect("a temporary folder");
    let path = file.display().to_string();
    let replay =
        |code: i32, path: &str| said(elsewhere.path(), code, &["compare", "--replay", path, "--threads", "1", "--progress", "none"]);
    let text = replay(0, &path);
    for name in ["nee", "path"] {
        let line = text.lines().find(|line| line.starts_with(&format!("{name}: 16 spp · error "))).unwrap_or_else(|| panic!("{text}"));
        assert!(line.contains("the same picture bit for bit"), "{text}");
    }
    assert!(text.contains("Threads: 1, was ") || made["threads"] == 1, "{text}");
    assert!(text.ends_with("no error changed beyond chance\n"), "{text}");

    // As if the recorded run had been of another version, with twice the errors.
    let mut other = data.clone();
    other["provenance"]["version"] = "0.0.1 (old)".into();
    other["methods"][0]["hash"] = "0".into();
    for measurement in other["methods"][0]["measurements"].as_array_mut().expect("measurements") {
        measurement["relmse"] = (4.0 * measurement["relmse"].as_f64().expect("a number")).into();
    }
    let changed = folder.path().join("report/changed.json");
    std::fs::write(&changed, other.to_string()).expect("written");
    let text = replay(1, &changed.display().to_string());
    assert!(text.contains(", was 0.0.1 (old)") && text.contains("changed beyond chance (p = "), "{text}");
    assert!(text.ends_with("an error changed beyond chance\n"), "{text}");
    assert_eq!(std::fs::read_dir(elsewhere.path()).expect("a folder").count(), 0, "nothing is written");
}

/// Several scenes are measured against the reference of the first: a copy has the bits of the original, a brighter lamp is told as what the
/// scenes differ by, with commands that name its file, and a replay renders all of them again.
#[test]
fn versions_of_a_scene_are_compared() {
    let folder = folder();
    let scene = std::fs::read_to_string(CORNELL).expect("a scene");
    let write = |name: &str, scene: &str| std::fs::write(folder.path().join(name), scene).expect("written");
    std::fs::create_dir(folder.path().join("copy")).expect("a folder");
    write("box.json", &scene);
    write("copy/box.json", &scene);
    // The film of the first scene counts.
    let bright = scene.replace("\"width\": 512", "\"width\": 50").replace("[34, 28, 19]", "[41, 34, 23]");
    assert!(bright.len() + 1 == scene.len(), "the lamp and the film are changed");
    write("bright.json", &bright);
    let compare = ["compare", "box.json", "copy/box.json", "bright.json", "--integrators", "nee", "--progress", "none"];
    let text =
        said(folder.path(), 0, &[&compare[..], &["--size", "24x24", "--spp", "256", "--reference-time", "1s", "-o", "report"]].concat());
    for name in ["nee · box.json: 256 spp", "nee · copy/box.json: 256 spp", "nee · bright: 256 spp"] {
        assert!(text.contains(name), "{name}: {text}");
    }
    let file = folder.path().join("report/convergence.json");
    let data: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&file).expect("data")).expect("JSON");
    let hash = |k: usize| data["methods"][k]["hash"].as_str().expect("a hash").to_owned();
    assert!(hash(0) == hash(1) && hash(0) != hash(2), "{data}");
    let conclusions = data["conclusions"].as_array().expect("conclusions");
    let differs = |one: &&serde_json::Value| one["text"].as_str().is_some_and(|text| text.contains("so much the scenes differ"));
    let differing: Vec<&serde_json::Value> = conclusions.iter().filter(differs).collect();
    assert!(differing.len() == 1 && differing[0]["text"].as_str().is_some_and(|text| text.starts_with("nee · bright settles ")), "{text}");
    assert_eq!(differing[0]["command"], "pt verify bright.json nee report/reference.exr --size 24x24");
    assert!(data["methods"][0]["spectrum"].as_array().is_some_and(|rings| rings.len() > 4), "{data}");

    let path = file.display().to_string();
    let replay = said(folder.path(), 0, &["compare", "--replay", &path, "--progress", "none"]);
    assert_eq!(replay.matches("the same picture bit for bit").count(), 3, "{replay}");
    assert!(said(folder.path(), 2, &["compare", "box.json", "box.json"]).contains("expected different scenes"));
    assert!(said(folder.path(), 2, &["compare", "box.json", "-"]).contains("only the first is read from stdin"));
    assert!(said(folder.path(), 3, &["compare", "box.json", "nowhere.json"]).contains("nowhere.json: no such file"));
}

#[test]
fn a_replay_of_anything_else_is_refused() {
    let folder = folder();
    let refused = |code: i32, text: &str| {
        std::fs::write(folder.path().join("data.json"), text).expect("written");
        let told = said(folder.path(), code, &["compare", "--replay", "data.json", "--progress", "none"]);
        assert_eq!(told.lines().count(), 1, "{told}");
        told
    };
    let expected = "expected the convergence.json of a report of pt compare";
    assert!(refused(3, "no JSON").contains(expected));
    assert!(refused(3, "{\"methods\": []}").contains("missing field `provenance`"));
    let recorded = |arguments: &str| {
        format!(
            "{{\"methods\": [], \"provenance\": {{\"version\": \"\", \"command\": \"pt {arguments}\", \"arguments\": {}, \"folder\": \"\", \
             \"cpu\": \"\", \"threads\": 1, \"seeds\": [], \"scene_hash\": \"\", \"reference_hash\": \"\"}}}}",
            serde_json::json!(arguments.split(' ').collect::<Vec<_>>())
        )
    };
    assert!(refused(3, &recorded("check scene.json")).contains("found the command \"pt check scene.json\""));
    assert!(refused(3, &recorded("compare -")).contains("its scene was read from stdin"));
    let told = said(folder.path(), 5, &["compare", "--replay", "nowhere.json"]);
    assert!(told.contains("nowhere.json"), "{told}");
    let told = said(folder.path(), 2, &["compare", CORNELL, "--replay", "data.json"]);
    assert!(told.contains("cannot be used with"), "{told}");
    // Another picture in the place of the report's reference.
    let compare = ["compare", CORNELL, "--size", "8x8", "--spp", "2", "--integrators", "nee", "--reference-time", "0.1s", "-o", "report"];
    said(folder.path(), 0, &compare);
    said(folder.path(), 0, &[CORNELL, "--size", "8x8", "--spp", "1", "--seed", "5", "-q", "-o", "report/reference.exr"]);
    let told = said(folder.path(), 3, &["compare", "--replay", "report/convergence.json", "--progress", "none"]);
    assert!(told.contains("expected the reference of the report, hash "), "{told}");
}

/// Pictures from files have rows, curves and verdicts: their times are those given, repeats share a checkpoint, the bias of pictures
/// without interreflection is told, and a single picture gets no time. Samples that nobody knows are not stated.
#[test]
fn pictures_of_others_are_contestants() {
    let folder = folder();
    let size = ["--size", "24x24"];
    let render = |file: &str, integrator: &str, spp: &str, seed: &str| {
        let given = [CORNELL, "--integrator", integrator, "--spp", spp, "--seed", seed, "-q", "-o", file];
        said(folder.path(), 0, &[&given[..], &size].concat());
    };
    render("truth.exr", "nee", "2048", "9");
    for (file, integrator, spp, seed) in [
        ("a.exr", "nee", "16", "21"),
        ("b.exr", "nee", "16", "22"),
        ("c=@.exr", "nee", "256", "23"),
        ("d.exr", "nee", "256", "24"),
        ("e.exr", "whitted", "64", "25"),
        ("f.exr", "whitted", "64", "26"),
    ] {
        render(file, integrator, spp, seed);
    }
    let compare =
        ["compare", CORNELL, "--spp", "8", "--integrators", "nee", "--reference", "truth.exr", "--progress", "none", "-o", "report"];
    let pictures =
        ["far=a.exr@1s", "far=b.exr@1.1s", "far=c=@.exr@16s", "far=d.exr@16s", "dark=e.exr@3s", "dark=f.exr@3s", "lone=d.exr@2s"];
    let pictures: Vec<&str> = pictures.iter().flat_map(|picture| ["--picture", picture]).collect();
    let text = said(folder.path(), 0, &[&compare[..], &size, &pictures].concat());
    assert!(text.contains("far: 16 s · error ") && text.contains("lone: 2 s · error "), "{text}");
    assert!(text.contains("dark settles ") && text.contains("There is one picture of lone;") && !text.contains("far settles"), "{text}");

    let data = std::fs::read_to_string(folder.path().join("report/convergence.json")).expect("data");
    let data: serde_json::Value = serde_json::from_str(&data).expect("JSON");
    let names: Vec<&str> = data["methods"].as_array().expect("methods").iter().filter_map(|method| method["name"].as_str()).collect();
    assert_eq!(names, ["nee", "far", "dark", "lone"]);
    let far = &data["methods"][1];
    let measured: Vec<(f64, u64, bool)> = far["measurements"]
        .as_array()
        .expect("measurements")
        .iter()
        .map(|m| (m["seconds"].as_f64().expect("s"), m["replicate"].as_u64().expect("r"), m["spp"].is_null()))
        .collect();
    assert_eq!(measured, [(1.0, 0, true), (1.1, 1, true), (16.0, 0, true), (16.0, 1, true)]);
    // `lone` is one of the pictures of `far`, with the same error.
    assert_eq!(data["methods"][3]["measurements"][0]["relmse"], far["measurements"][3]["relmse"]);
    assert!(data["methods"][3]["prices"][0]["seconds"].is_null() && data["methods"][3]["bias_bound"].is_null(), "{data}");
    let conclusions = data["conclusions"].as_array().expect("conclusions");
    let bias = conclusions.iter().find(|one| one["text"].as_str().is_some_and(|text| text.starts_with("dark settles"))).expect("a bias");
    assert_eq!(bias["command"], "pt image diff e.exr report/reference.exr");
    let csv = std::fs::read_to_string(folder.path().join("report/convergence.csv")).expect("a table");
    assert!(csv.contains("\nfar,0,,1,") && csv.contains("\nfar,mean,,16,"), "{csv}");

    // Pictures are not rendered again.
    let text = said(folder.path(), 0, &["compare", "--replay", "report/convergence.json", "--progress", "none"]);
    assert!(text.contains("nee: 8 spp · ") && !text.contains("far"), "{text}");
}

#[test]
fn pictures_that_cannot_be_contestants_are_refused() {
    let folder = folder();
    said(folder.path(), 0, &[CORNELL, "--size", "8x8", "--spp", "1", "-q", "-o", "small.exr"]);
    let refused = |code: i32, picture: &str, expected: &str| {
        let given = ["compare", CORNELL, "--size", "9x9", "--spp", "1", "--integrators", "nee", "--progress", "none", "--picture", picture];
        let told = said(folder.path(), code, &[&given[..], &["-o", "report"]].concat());
        assert!(told.contains(expected), "{told}");
        assert!(!folder.path().join("report").exists(), "nothing is written");
    };
    for text in ["small.exr", "x=small.exr", "=small.exr@1s", "x=@1s"] {
        refused(2, text, "expected NAME=FILE@DURATION");
    }
    refused(2, "x=small.exr@soon", "\"soon\" after @");
    refused(2, "x=small.exr@0s", "\"0s\" after @");
    refused(2, "nee=small.exr@1s", "nee is a method that is rendered");
    refused(3, "x=small.exr@1s", "expected 9 × 9 pixels as the scene has, found 8 × 8");
    refused(3, "x=missing.exr@1s", "missing.exr");
}

/// The method with the least time for the largest error in the report's data.
fn cheapest(folder: &Path) -> String {
    let text = std::fs::read_to_string(folder.join("report/convergence.json")).expect("data");
    let data: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let priced = |method: &serde_json::Value| Some((method["prices"][0]["seconds"].as_f64()?, method["name"].as_str()?.to_owned()));
    let prices = data["methods"].as_array().expect("methods").iter().filter_map(priced);
    prices.min_by(|a, b| a.0.total_cmp(&b.0)).expect("a price").1
}
