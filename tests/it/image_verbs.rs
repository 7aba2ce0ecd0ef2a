//! The commands of `pt image`.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use glam::UVec2;
use pt::film::{Channel, Image};
use pt::output::{self, Attributes, Tonemap};
use tempfile::TempDir;

fn picture(size: [u32; 2], names: &[&str], value: impl Fn(usize, usize) -> f32) -> Image {
    let count = (size[0] * size[1]) as usize;
    let channel = |(c, name): (usize, &&str)| Channel { name: (*name).into(), values: (0..count).map(|i| value(c, i)).collect() };
    Image { full_size: size.into(), origin: UVec2::ZERO, size: size.into(), channels: names.iter().enumerate().map(channel).collect() }
}

const RGB: [&str; 3] = ["R", "G", "B"];

/// A folder of pictures: a.exr is 1 and b.exr is 2 everywhere, other.exr has another size, part.exr another crop, depth.exr one channel,
/// and nan.exr a NaN.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let a = picture([100, 20], &RGB, |_, _| 1.0);
    put(folder.path(), "a.exr", &a, &[]);
    put(folder.path(), "b.exr", &picture([100, 20], &RGB, |_, _| 2.0), &[]);
    put(folder.path(), "other.exr", &picture([20, 100], &RGB, |_, _| 1.0), &[]);
    put(folder.path(), "part.exr", &Image { full_size: UVec2::new(200, 20), ..a }, &[]);
    put(folder.path(), "depth.exr", &picture([100, 20], &["Z", "A"], |_, _| 1.0), &[]);
    put(folder.path(), "nan.exr", &picture([100, 20], &RGB, |c, i| if (c, i) == (1, 103) { f32::NAN } else { 1.0 }), &[]);
    folder
}

fn put(folder: &Path, name: &str, image: &Image, attributes: &[(&str, &str)]) {
    let attributes: Attributes = attributes.iter().map(|(name, value)| ((*name).into(), (*value).into())).collect();
    output::write(&folder.join(name), image, &attributes, &Tonemap::default()).unwrap_or_else(|e| panic!("{e}"));
}

/// Runs pt and returns the exit code, stdout and stderr.
fn pt(folder: &Path, call: &str) -> (i32, String, String) {
    let mut command = Command::cargo_bin("pt").expect("the binary");
    let output = command.current_dir(folder).arg("image").args(call.split_whitespace()).output().expect("it runs");
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("text");
    (output.status.code().expect("a code"), text(&output.stdout), text(&output.stderr))
}

#[track_caller]
fn said(folder: &Path, call: &str) -> String {
    let (code, stdout, stderr) = pt(folder, call);
    assert_eq!(code, 0, "{call}: {stderr}");
    stdout
}

#[test]
fn diff_prints_values_with_their_formulas() {
    let folder = folder();
    let text = said(folder.path(), "diff a.exr b.exr --metric mse --metric rmse:robust --metric relmse:eps=1");
    let expected = "a = a.exr, r = b.exr\n\
        mse           1.00000  mean over all pixels of (a − r)²\n\
        rmse:robust   1.00000  square root of the mean over all pixels but the worst 0.1 % of (a − r)²\n\
        relmse:eps=1  0.200000  mean over all pixels of (a − r)²/(r² + ε), ε = 1; a is the picture, r the reference\n";
    assert_eq!(text, expected);
    let default = said(folder.path(), "diff a.exr a.exr");
    assert!(default.contains("relmse  0  mean over all pixels of (a − r)²/(r² + ε), ε = 0.01·mean²(r)"), "{default}");
}

#[test]
fn a_tolerance_decides_the_exit_code() {
    let folder = folder();
    for (call, code) in [
        ("diff a.exr b.exr -m mse --tolerance 1", 0),
        ("diff a.exr b.exr -m mse --tolerance 0.99", 1),
        ("diff a.exr b.exr -m mse -m mae -m relmse --tolerance 0.99", 1),
        ("diff a.exr a.exr -m relmse --tolerance 0", 0),
    ] {
        let (found, text, _) = pt(folder.path(), call);
        assert_eq!((found, text.contains("ABOVE 0.99")), (code, code == 1), "{call}: {text}");
    }
}

/// Invalid input and invalid usage cause one line of text and an exit code, and nothing is written.
#[test]
fn what_cannot_be_done_is_refused() {
    let folder = folder();
    let before = files(folder.path());
    let table = [
        ("diff a.exr other.exr -o d.exr", 3, "other.exr: expected the window of a.exr, 100 × 20; found 20 × 100"),
        ("diff a.exr part.exr -o d.exr", 3, "part.exr: expected the window of a.exr, 100 × 20; found 100 × 20 at (0, 0) of 200 × 20"),
        ("diff a.exr depth.exr -o d.exr", 3, "depth.exr: expected R, G and B among the colours, found A, Z"),
        ("diff nan.exr a.exr -o d.exr", 3, "nan.exr: 1 pixel is not finite; the first: (3, 1) with 1, NaN, 1"),
        ("diff a.exr nan.exr -o d.exr", 3, "nan.exr: 1 pixel is not finite; the first: (3, 1) with 1, NaN, 1"),
        ("diff a.exr none.exr", 3, "none.exr: no such file"),
        ("diff a.exr b.exr -m flop", 2, "unknown metric \"flop\", did you mean \"flip\"?"),
        ("diff a.exr b.exr -o b.exr", 2, "b.exr: is one of the pictures, which would be overwritten"),
        ("diff a.exr b.exr -o d.gif", 2, "d.gif: expected a name that ends in .exr, .hdr, .png, .ppm or .pfm"),
        ("diff a.exr b.exr -o no/d.exr", 5, "no/d.exr: there is no folder no"),
        ("diff a.exr b.exr --layer StdErr", 3, "a.exr: unknown layer \"StdErr\", there are none"),
        ("convert a.exr -o a.exr", 2, "a.exr: is the input, which would be overwritten"),
        ("convert a.exr -o x.png -o x.png", 2, "x.png: given twice as an output"),
        ("convert depth.exr -o x.png", 3, "depth.exr: expected R, G and B among the colours, found A, Z"),
        ("average a.exr other.exr -o x.exr", 3, "other.exr: expected the window of a.exr, 100 × 20; found 20 × 100"),
        ("average a.exr depth.exr -o x.exr", 3, "depth.exr: expected the channels of a.exr, B, G, R; found A, Z"),
        ("falsecolor a.exr -o x.png --log --range 0,1", 2, "--log: expected a --range above 0"),
    ];
    for (call, code, message) in table {
        let (found, stdout, stderr) = pt(folder.path(), call);
        assert_eq!((found, stdout.as_str(), stderr.as_str()), (code, "", format!("error: {message}\n").as_str()), "{call}");
    }
    assert_eq!(files(folder.path()), before);
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).expect("list").map(|e| e.expect("entry").file_name().to_string_lossy().into()).collect();
    names.sort();
    names
}

fn read(folder: &Path, name: &str) -> Image {
    output::read(&folder.join(name)).unwrap_or_else(|e| panic!("{e}")).0
}

/// An error map contains the value of the formula at every pixel: as the channel `Y`, or as channels with the names of several measures, or
/// as colours above a scale.
#[test]
fn diff_writes_maps() {
    let folder = folder();
    said(folder.path(), "diff a.exr b.exr -m relmse:eps=1 -o one.exr");
    assert_eq!(read(folder.path(), "one.exr").channel("Y").expect("a map"), [0.2; 2000]);
    said(folder.path(), "diff a.exr b.exr -m mse -m mape:eps=2 -o two.exr");
    let two = read(folder.path(), "two.exr");
    assert_eq!((two.channel("mse.Y").expect("a map")[0], two.channel("mape:eps=2.Y").expect("a map")[0]), (1.0, 0.25));
    said(folder.path(), "diff a.exr b.exr -m mse -o one.pfm");
    assert_eq!(read(folder.path(), "one.pfm").rgb(7, 3), [1.0; 3]);
    let text = said(folder.path(), "diff a.exr b.exr -m mse -o one.png");
    assert!(text.contains("one.png: mse, colours from 0 to 1.00000; values from 1.00000 to 1.00000\n"), "{text}");
    assert_eq!(read(folder.path(), "one.png").size.x, 100);
}

#[test]
fn info_says_what_is_in_a_picture() {
    let folder = folder();
    let part = Image {
        full_size: UVec2::new(9, 9),
        origin: UVec2::new(2, 3),
        ..picture([2, 2], &["R", "StdErr.R"], |c, i| if c == 1 { [f32::NAN, f32::INFINITY, -0.5, 1.5][i] } else { i as f32 })
    };
    put(folder.path(), "part.exr", &part, &[("pt/seed", "7")]);
    let text = said(folder.path(), "info part.exr a.exr");
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>().join(" ");
    let lines: Vec<String> = text.lines().map(words).collect();
    for line in [
        "part.exr: 2 × 2 at (2, 3) of 9 × 9",
        "compression ZIP16",
        "samples f32",
        "software pt",
        "pt/seed 7",
        "channel min mean max NaN infinite",
        "R 0 1.50000 3.00000 0 0",
        "StdErr.R -0.500000 0.500000 1.50000 1 1",
        "a.exr: 100 × 20",
        "B 1.00000 1.00000 1.00000 0 0",
    ] {
        assert!(lines.iter().any(|l| l == line), "{line:?} in\n{text}");
    }
}

#[test]
fn hash_is_the_same_for_the_same_pixels() {
    let folder = folder();
    put(folder.path(), "again.exr", &read(folder.path(), "a.exr"), &[("pt/seed", "9")]);
    let text = said(folder.path(), "hash a.exr again.exr b.exr");
    let lines: Vec<(&str, &str)> = text.lines().map(|line| line.split_once("  ").expect("hash and name")).collect();
    assert_eq!(lines.iter().map(|line| line.1).collect::<Vec<_>>(), ["a.exr", "again.exr", "b.exr"]);
    assert!(lines[0].0 == lines[1].0 && lines[0].0 != lines[2].0 && lines[0].0.len() == 32, "{text}");
    assert_eq!(lines[0].0, output::hash(&read(folder.path(), "a.exr")).to_string());
}

#[test]
fn convert_keeps_what_the_format_has_room_for() {
    let folder = folder();
    let names = ["R", "G", "B", "StdErr.R", "StdErr.G", "StdErr.B", "SampleCount.Y"];
    let image = picture([4, 3], &names, |c, i| (c * 12 + i) as f32 / 64.0);
    put(folder.path(), "all.exr", &image, &[("pt/seed", "7")]);
    said(folder.path(), "convert all.exr -o copy.exr -o copy.pfm -o copy.png");
    let (copy, attributes) = output::read(&folder.path().join("copy.exr")).expect("readable");
    assert_eq!(output::hash(&copy), output::hash(&image));
    assert_eq!(attributes, [("pt/seed".to_owned(), "7".into())]);
    assert_eq!(read(folder.path(), "copy.pfm").rgb(3, 2), image.rgb(3, 2));
    assert_eq!(
        fs::read(folder.path().join("copy.png")).expect("written"),
        output::png::encode(&image, &Tonemap::default()).expect("encodes")
    );
    said(folder.path(), "convert all.exr -o error.exr --layer StdErr");
    assert_eq!(read(folder.path(), "error.exr").channels.len(), 3);
    assert_eq!(read(folder.path(), "error.exr").rgb(1, 1), [3, 4, 5].map(|c| image.channels[c].values[5]));
    said(folder.path(), "convert all.exr -o count.pfm --channel SampleCount.Y");
    assert_eq!(read(folder.path(), "count.pfm").rgb(1, 1), [image.channels[6].values[5]; 3]);
    // The exposure of two stops multiplies the radiance by four before it is converted to 8 bits.
    said(folder.path(), "convert all.exr -o bright.ppm --exposure 2 --tonemap filmic");
    let tonemap = Tonemap { exposure: 2.0, curve: pt::output::Curve::Filmic };
    assert_eq!(fs::read(folder.path().join("bright.ppm")).expect("written"), output::png::encode_ppm(&image, &tonemap));
    // A camera's exposure: 683 lm/W · 0.65 · 100/78 · t/N² [m²·sr/W], which is 4 for t/N² = 4 · 78/(683 · 65).
    said(folder.path(), "convert all.exr -o camera.ppm --iso 100 --shutter 0.0281112738 --f-number 2 --tonemap filmic");
    let [camera, bright] = ["camera.ppm", "bright.ppm"].map(|name| fs::read(folder.path().join(name)).expect("written"));
    assert!(camera.len() == bright.len() && camera.iter().zip(&bright).all(|(a, b)| a.abs_diff(*b) <= 1));
    said(folder.path(), "convert all.exr -o camera.exr --iso 100 --shutter 1/30 --f-number 2");
    assert_eq!(output::hash(&read(folder.path(), "camera.exr")), output::hash(&image), "linear files keep their values");
    said(folder.path(), "convert copy.png -o from.exr");
    said(folder.path(), "convert from.exr -o again.png");
    assert_eq!(fs::read(folder.path().join("again.png")).expect("written"), fs::read(folder.path().join("copy.png")).expect("written"));
}

#[test]
fn average_combines_attributes_and_warns_of_copies() {
    let folder = folder();
    let put = |name: &str, value: f32, seed: &str, spp: &str| {
        let image = picture([2, 2], &["R", "G", "B", "StdErr.R"], |c, _| if c == 3 { 0.5 } else { value });
        put(folder.path(), name, &image, &[("pt/seed", seed), ("pt/spp", spp), ("pt/integrator", "nee")]);
    };
    put("one.exr", 1.0, "1", "16");
    put("two.exr", 4.0, "2", "48");
    put("again.exr", 4.0, "2", "48");
    let (_, _, stderr) = pt(folder.path(), "average one.exr two.exr -o mean.exr");
    assert_eq!(stderr, "");
    let (mean, attributes) = output::read(&folder.path().join("mean.exr")).expect("readable");
    assert_eq!((mean.rgb(0, 0), mean.channel("StdErr.R").expect("there")[0]), ([2.5; 3], (0.5f64.sqrt() / 2.0) as f32));
    let expected = [("pt/integrator", "nee"), ("pt/spp", "64")].map(|(name, value)| (name.to_owned(), value.into()));
    assert_eq!(attributes, expected);
    let (code, _, stderr) = pt(folder.path(), "average one.exr two.exr again.exr -o mean.exr");
    assert_eq!(
        (code, stderr.as_str()),
        (0, "warning: two.exr and again.exr are made of the same random numbers (pt/seed): their mean is no more accurate\n")
    );
    let (_, _, stderr) = pt(folder.path(), "average nan.exr a.exr -o mean.exr");
    assert_eq!(stderr, "warning: nan.exr: values that are not finite, here and in the mean: 1\n");
}

/// Values from 0 to 1 along the rows become the colours of the map in order. The bar below always has the colours in order.
#[test]
fn falsecolor_paints_values_and_a_scale() {
    let folder = folder();
    let ramp = picture([100, 20], &RGB, |_, i| if i == 150 { f32::NAN } else { (i % 100) as f32 / 99.0 });
    put(folder.path(), "ramp.exr", &ramp, &[]);
    let text = said(folder.path(), "falsecolor ramp.exr -o x.png --range 0,1 --map viridis");
    assert_eq!(
        text,
        "luminance of R, G, B of ramp.exr\ncolours from 0 to 1.00000; values from 0 to 1.00000; in cyan what is NaN, pixels: 1\n"
    );
    let image = read(folder.path(), "x.png");
    let byte = |x: u32, y: u32| image.rgb(x, y).map(|v| (output::tonemap::srgb(v) * 255.0).round() as u8);
    for x in [0, 30, 99] {
        assert_eq!(byte(x, 3), output::Colormap::Viridis.color(f64::from(ramp.rgb(x, 3)[0])), "{x}");
        assert_eq!(byte(x, 26), output::Colormap::Viridis.color((f64::from(x) + 0.5) / 100.0), "the bar at {x}");
    }
    assert_eq!(byte(50, 1), [0, 255, 255]);
    // The label of the left end is a 0, of dots two pixels wide.
    assert_eq!([byte(0, 36), byte(2, 38), byte(4, 36)], [[255; 3], [0; 3], [255; 3]]);
    let text = said(folder.path(), "falsecolor a.exr b.exr -m mape:eps=0 -o y.png --log --range 0.25,1");
    assert!(text.ends_with("colours from 0.250000 to 1.00000, logarithmic; values from 0.500000 to 0.500000\n"), "{text}");
    let image = read(folder.path(), "y.png");
    let byte = image.rgb(9, 9).map(|v| (output::tonemap::srgb(v) * 255.0).round() as u8);
    assert_eq!(byte, output::Colormap::Magma.color(0.5));
}

#[test]
fn metrics_are_listed() {
    let mut command = Command::cargo_bin("pt").expect("the binary");
    let output = command.args(["list", "metrics"]).output().expect("it runs");
    let text = String::from_utf8(output.stdout).expect("text");
    assert_eq!(text.lines().count(), pt::measure::metric::ALL.len());
    assert!(text.contains("  mrse-tungsten    (a − r)²/(a² + 0.001); a: reference, r: picture\n"), "{text}");
}
