//! The report of a comparison: the content of its files, and its page in a browser.

pub mod browser;
mod page;
mod synthetic;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use pt::compare::{Comparison, CostKind, NoPrice, TARGETS, report};
use pt::output::exr;
use serde_json::Value;
use synthetic::comparison;
use tempfile::TempDir;

fn written(comparison: &Comparison, jeri: bool) -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    report::write(comparison, &folder.path().join("new/report"), jeri).expect("a report");
    folder
}

fn text(folder: &TempDir, name: &str) -> String {
    fs::read_to_string(folder.path().join("new/report").join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Names of the plots.
const PLOTS: [&str; 6] = ["error-against-time", "time-to-error", "error-against-samples", "pareto-front", "error-spectrum", "error-spread"];

fn files(folder: &Path) -> BTreeSet<PathBuf> {
    let mut found = BTreeSet::new();
    for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        if entry.is_dir() {
            found.extend(files(&entry).into_iter().map(|path| Path::new(entry.file_name().expect("a name")).join(path)));
        } else {
            found.insert(entry.file_name().expect("a name").into());
        }
    }
    found
}

#[test]
fn all_files_are_there_and_no_other() {
    let folder = written(&comparison(), false);
    let plots = PLOTS.iter().flat_map(|name| ["svg", "png"].map(|kind| PathBuf::from(format!("plots/{name}.{kind}"))));
    let others = ["convergence.csv", "convergence.json", "index.html"].map(PathBuf::from);
    assert_eq!(files(&folder.path().join("new/report")), plots.chain(others).collect());
}

/// Every measurement is stored bit for bit, and the means and standard errors are those of the measurements.
#[test]
fn csv_holds_what_was_measured() {
    let comparison = comparison();
    let csv = text(&written(&comparison, false), "convergence.csv");
    for formula in ["# mse = 1/3P Σ", "# relmse = 1/3P Σ", "ε = 0.01 · mean(r)²", "# trimmed = "] {
        assert!(csv.contains(formula), "{formula} is missing");
    }
    let mut rows = csv.lines().skip_while(|line| line.starts_with('#')).map(|line| line.split(',').collect::<Vec<_>>());
    let header = rows.next().expect("a header");
    assert_eq!(header[..7], ["method", "replicate", "spp", "seconds", "mse", "relmse", "trimmed"]);
    // A name with a comma is in quotes.
    assert_eq!(
        header[7..].join(","),
        "\"mape:eps=0.5,robust\",flip,mse_stderr,relmse_stderr,trimmed_stderr,\"mape:eps=0.5,robust_stderr\",flip_stderr"
    );
    assert!(csv.contains("# flip = mean over all pixels of LDR-FLIP"), "the formula of what was asked for");
    let rows: Vec<Vec<&str>> = rows.collect();
    let number = |cell: &str| cell.parse::<f64>().unwrap_or_else(|e| panic!("{cell}: {e}"));
    for method in &comparison.methods {
        let mut own = rows.iter().filter(|row| row[0] == method.name);
        for m in &method.measurements {
            let row = own.next().expect("a row for each measurement");
            assert_eq!(row[1..3], [m.replicate.to_string(), m.samples.to_string()]);
            let wanted = [m.seconds, m.mse, m.relmse, m.trimmed, m.others[0], m.others[1]];
            assert_eq!([3, 4, 5, 6, 7, 8].map(|i| number(row[i])), wanted);
            assert_eq!(row[9..], ["", "", "", "", ""]);
        }
        for p in &method.curve {
            let row = own.next().expect("a row for each point");
            assert_eq!(row[1..3], ["mean", &p.samples.to_string()]);
            let all = [p.mse, p.relmse, p.trimmed, p.others[0], p.others[1]];
            assert_eq!([4, 5, 6, 7, 8].map(|i| number(row[i])), all.map(|value| value.0));
            assert_eq!([9, 10, 11, 12, 13].map(|i| number(row[i])), all.map(|value| value.1));
        }
        assert!(own.next().is_none(), "{} has rows that nobody measured", method.name);
    }
}

#[test]
fn json_holds_what_was_measured() {
    let comparison = comparison();
    let document: Value = serde_json::from_str(&text(&written(&comparison, false), "convergence.json")).expect("JSON");
    assert_eq!(document["scene"], "cornell-box");
    assert_eq!(document["reference"]["error"], 0.0007);
    assert_eq!(document["reference"]["established"], true);
    assert!(document["formulas"]["relmse"].as_str().expect("a formula").contains("(r² + ε)"));
    for (method, found) in comparison.methods.iter().zip(document["methods"].as_array().expect("methods")) {
        assert_eq!(found["name"], method.name);
        assert_eq!(found["measurements"].as_array().expect("a list").len(), method.measurements.len());
        // The parser of these tests rounds to within one unit in the last place.
        let same = |found: &Value, value: Option<f64>| match (found.as_f64(), value) {
            (Some(found), Some(value)) => assert!((found / value - 1.0).abs() <= 2.0 * f64::EPSILON, "{found} for {value}"),
            (found, value) => assert_eq!(found, value),
        };
        same(&found["measurements"][5]["relmse"], Some(method.measurements[5].relmse));
        same(&found["points"][3]["relmse"]["stderr"], Some(method.curve[3].relmse.1));
        same(&found["measurements"][5]["flip"], Some(method.measurements[5].others[1]));
        same(&found["points"][3]["mape:eps=0.5,robust"]["stderr"], Some(method.curve[3].others[0].1));
        for (i, target) in TARGETS.into_iter().enumerate() {
            assert_eq!(found["prices"][i]["error"], target);
            let price = method.prices[i];
            same(&found["prices"][i]["seconds"], price.ok().map(|cost| cost.seconds));
            assert_eq!(found["prices"][i]["extrapolated"].as_bool(), price.ok().map(|cost| cost.kind == CostKind::Extrapolated));
            assert_eq!(found["prices"][i]["at_most"].as_bool(), price.ok().map(|cost| cost.kind == CostKind::AtMost));
            assert_eq!(found["prices"][i]["reason"].as_str(), price.err().map(NoPrice::name));
        }
    }
    assert!(document["methods"][3]["prices"][1]["seconds"].is_null(), "a biased method never reaches 3 %");
    assert_eq!(document["provenance"], serde_json::to_value(&comparison.provenance).expect("JSON"));
    assert_eq!(document["methods"][1]["hash"], pt::output::hash(&comparison.methods[1].image).to_string());
    assert_eq!(document["conclusions"][0]["command"].as_str(), comparison.conclusions[0].command.as_deref());
}

/// With NaN, names that contain markup, and methods without a curve, the report is still valid.
#[test]
fn reports_of_extreme_comparisons_are_valid() {
    let mut hostile = comparison();
    hostile.scene = "</script><script>alert('scene')</script> & \"more\"".into();
    hostile.conclusions = vec!["a < b & {{style}} <img src=x onerror=alert(1)>".into()];
    hostile.methods[0].name = "a,\"b\"\n<svg onload=alert(2)>".into();
    hostile.methods[0].lacks = "<b>light</b>".into();
    hostile.methods[1].name = "Reference".into();
    hostile.methods[1].curve[2].relmse = (-1e-9, f64::NAN);
    hostile.methods[2].curve.clear();
    hostile.methods[2].measurements.clear();
    hostile.methods[2].prices.clear();
    hostile.methods[3].curve[0].seconds = f64::INFINITY;
    hostile.reference.image.channels[0].values[7] = f32::NAN;
    let folder = written(&hostile, true);
    let page = text(&folder, "index.html");
    for injected in ["<img", "<svg onload", "<script>alert", "<b>light"] {
        assert!(!page.contains(injected), "{injected}");
    }
    assert!(page.contains("a &lt; b &amp; {{style}}"), "values are not templates");
    serde_json::from_str::<Value>(&text(&folder, "convergence.json")).expect("JSON");
    serde_json::from_str::<Value>(&text(&folder, "jeri/data.json")).expect("JSON");
    let csv = text(&folder, "convergence.csv");
    assert!(csv.contains("\"a,\"\"b\"\"\n<svg onload=alert(2)>\",0,1,"), "the name is quoted");
    for name in PLOTS {
        let plot = text(&folder, &format!("plots/{name}.svg"));
        assert!(!plot.contains("NaN") && !plot.contains("inf\"") && !plot.contains("<svg onload"), "{name}");
    }

    let empty = Comparison { methods: vec![], conclusions: vec![], ..comparison() };
    written(&empty, true);
}

#[test]
fn pictures_of_another_size_are_refused() {
    let mut comparison = comparison();
    comparison.methods[0].sample.size.x -= 1;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let refusal = report::write(&comparison, &folder.path().join("report"), false).expect_err("no report");
    assert!(refusal.to_string().contains("path"), "{refusal}");
    assert!(!folder.path().join("report").exists(), "nothing is left behind");
}

/// The plots have the bias with its name, and the curve and the slope of every method.
#[test]
fn plots_contain_every_curve_and_bias() {
    let folder = written(&comparison(), false);
    for name in ["error-against-time", "error-against-samples"] {
        let plot = text(&folder, &format!("plots/{name}.svg"));
        assert!(plot.contains("bias of whitted: 11 %"), "{name}");
        assert!(plot.contains("nee · sobol: slope −0.65 ± 0.01"), "{name}");
        assert_eq!(plot.matches("<title>nee: ").count(), 9, "a hint for each checkpoint");
    }
    let bars = text(&folder, "plots/time-to-error.svg");
    assert_eq!(bars.matches("never: bias").count(), 2 * 4, "drawn and described: no target is reached");
    for name in PLOTS {
        let path = folder.path().join(format!("new/report/plots/{name}.png"));
        let picture = image::open(&path).expect("PNG").to_rgb8();
        assert!(picture.width() == 2 * (640 + 2 * 16) && picture.height() > 450, "{name}");
        let colors: BTreeSet<[u8; 3]> = picture.pixels().map(|p| p.0).collect();
        assert!(colors.contains(&[0x1a, 0x1d, 0x21]) && colors.contains(&[0, 0x72, 0xb2]), "{name}: letters and the first method's colour");
    }
}

/// The rules of the viewer's data: titles unique among siblings, children in every node, leaves of one of two kinds.
fn check_tree(node: &Value, images: &mut BTreeSet<PathBuf>) {
    if let Some(children) = node["children"].as_array() {
        assert!(!children.is_empty(), "{node}");
        let titles: BTreeSet<&str> = children.iter().map(|child| child["title"].as_str().expect("a title")).collect();
        assert_eq!(titles.len(), children.len(), "{titles:?}");
        children.iter().for_each(|child| check_tree(child, images));
    } else if let Some(image) = node["image"].as_str() {
        images.insert(image.into());
    } else {
        let loss = &node["lossMap"];
        assert!(["L1", "L2", "MAPE", "MRSE", "SMAPE", "SSIM"].contains(&loss["function"].as_str().expect("a function")), "{node}");
        images.extend(["imageA", "imageB"].map(|key| PathBuf::from(loss[key].as_str().expect("an image"))));
        assert_eq!(loss["imageB"], "reference.exr");
    }
}

#[test]
fn the_jeri_export_is_valid() {
    let comparison = comparison();
    let folder = written(&comparison, true);
    let tree: Value = serde_json::from_str(&text(&folder, "jeri/data.json")).expect("JSON");
    let script = text(&folder, "jeri/data.js");
    let inside = script.strip_prefix("const data = ").and_then(|rest| rest.strip_suffix(";\n")).expect("an assignment");
    assert_eq!(serde_json::from_str::<Value>(inside).expect("JSON"), tree);

    let mut named = BTreeSet::new();
    check_tree(&tree, &mut named);
    let there = files(&folder.path().join("new/report/jeri"));
    let data = ["data.js", "data.json"].map(PathBuf::from);
    assert_eq!(named.into_iter().chain(data).collect::<BTreeSet<_>>(), there);

    let scene = &tree["children"][0];
    assert_eq!(scene["title"], "cornell-box");
    let titles = |branch: &Value| -> Vec<String> {
        branch["children"].as_array().expect("leaves").iter().map(|leaf| leaf["title"].as_str().expect("a title").to_owned()).collect()
    };
    assert_eq!(titles(&scene["children"][0]), ["Reference", "path", "nee", "nee · sobol", "whitted"]);
    assert_eq!(titles(&scene["children"][2]), ["path", "nee", "nee · sobol", "whitted"]);

    for path in there.iter().filter(|path| path.extension().is_some_and(|e| e == "exr")) {
        let (image, _) = exr::read(&folder.path().join("new/report/jeri").join(path)).expect("EXR");
        let mut names: Vec<&str> = image.channels.iter().map(|c| c.name.as_str()).collect();
        names.sort_unstable();
        assert!(names == ["B", "G", "R"] || names == ["Y"], "{}: {names:?}", path.display());
        assert_eq!(image.size, synthetic::SIZE);
    }
    let (image, _) = exr::read(&folder.path().join("new/report/jeri/nee-sobol.render.exr")).expect("EXR");
    assert_eq!(image.channel("G"), comparison.methods[2].sample.channel("G"));
}
