//! Picture files: formats, layers, hashes, averages and colour maps.

use std::path::{Path, PathBuf};

use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image as ExrImage, Layer};
use exr::meta::header::{ImageAttributes, LayerAttributes};
use exr::prelude::{Compression, IntegerBounds, WritableImage, f16};
use glam::UVec2;
use pt::film::{Channel, Image};
use pt::measure::average;
use pt::measure::metric::Named;
use pt::output::{self, Attributes, Colormap, Pick, Tonemap, hash};
use tempfile::TempDir;

use crate::random::Random;

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

fn channel(name: &str, values: &[f32]) -> Channel {
    Channel { name: name.into(), values: values.to_vec() }
}

fn whole(size: [u32; 2], channels: Vec<Channel>) -> Image {
    Image { full_size: size.into(), origin: UVec2::ZERO, size: size.into(), channels }
}

/// A picture of random values of every magnitude, infinities and NaN.
fn wild(size: [u32; 2], names: &[&str]) -> Image {
    let mut random = Random::new(11);
    let mut value = |_| match random.below(20) {
        0 => f32::NAN,
        1 => f32::INFINITY,
        2 => -0.0,
        _ => f32::from_bits(random.bits() as u32 & 0xbf7f_ffff),
    };
    let count = (size[0] * size[1]) as usize;
    whole(size, names.iter().map(|name| Channel { name: (*name).into(), values: (0..count).map(&mut value).collect() }).collect())
}

fn write(folder: &Path, name: &str, image: &Image, attributes: &Attributes) -> PathBuf {
    let path = folder.join(name);
    output::write(&path, image, attributes, &Tonemap::default()).unwrap_or_else(|e| panic!("{e}"));
    path
}

fn opened(path: &Path) -> Image {
    output::read(path).unwrap_or_else(|e| panic!("{e}")).0
}

fn refusal(path: &Path) -> (u8, String) {
    match output::read(path) {
        Ok(_) => panic!("{} is accepted", path.display()),
        Err(error) => (error.exit_code(), error.to_string()),
    }
}

/// Asserts that two pictures have the same bits, so that NaN equals NaN and −0 differs from 0. Channels are compared by name.
fn assert_same(found: &Image, expected: &Image) {
    let bits = |image: &Image| {
        let mut channels: Vec<(String, Vec<u32>)> =
            image.channels.iter().map(|c| (c.name.clone(), c.values.iter().map(|v| v.to_bits()).collect())).collect();
        channels.sort();
        (image.full_size, image.origin, image.size, channels)
    };
    assert_eq!(bits(found), bits(expected));
}

#[test]
fn float_formats_keep_every_bit() {
    let folder = folder();
    let colours = wild([7, 5], &["R", "G", "B"]);
    assert_same(&opened(&write(folder.path(), "a.pfm", &colours, &vec![])), &colours);
    let part = Image { full_size: UVec2::new(20, 10), origin: UVec2::new(3, 4), ..wild([7, 5], &["R", "G", "B", "StdErr.R", "Z"]) };
    let attributes = vec![("pt/a".to_owned(), "1".into()), ("pt/b".to_owned(), "zwei".into())];
    let path = write(folder.path(), "a.exr", &part, &attributes);
    assert_same(&opened(&path), &part);
    assert_eq!(output::read(&path).expect("readable").1, attributes);
}

/// All levels of 8 bits survive writing and reading in each format, and with any extension of the name.
#[test]
fn levels_of_8_bits_survive() {
    let folder = folder();
    let levels: Vec<f32> = (0..256).map(|level| output::tonemap::linear(f64::from(level) / 255.0) as f32).collect();
    let turned: Vec<f32> = levels.iter().rev().copied().collect();
    let image = whole([16, 16], vec![channel("R", &levels), channel("G", &turned), channel("B", &levels)]);
    for name in ["a.png", "a.ppm"] {
        let path = write(folder.path(), name, &image, &vec![]);
        assert_same(&opened(&path), &image);
        // The content determines the format, not the name.
        let other = folder.path().join("a.exr");
        std::fs::copy(&path, &other).expect("copied");
        assert_same(&opened(&other), &image);
    }
}

/// Radiance HDR keeps values with 8 bits and a common exponent, and rounds others to the nearest.
#[test]
fn hdr_rounds_to_the_nearest() {
    let folder = folder();
    let [tiny, huge] = [2f32.powi(-100), 2f32.powi(120)];
    let kept = [0.0, 1.0, 255.0, 3.0, 0.5, 0.0625, 128.0, 2.0, 0.0, huge, 0.0, 0.0, tiny, 3.0 * tiny, 0.0];
    let colours = |values: &[f32]| {
        let of = |c: usize| values.iter().skip(c).step_by(3).copied().collect::<Vec<f32>>();
        whole([values.len() as u32 / 3, 1], vec![channel("R", &of(0)), channel("G", &of(1)), channel("B", &of(2))])
    };
    assert_same(&opened(&write(folder.path(), "a.hdr", &colours(&kept), &vec![])), &colours(&kept));
    // Units of 1, 1/2 and 2: 63.9 is nearer to 64 than to 63.75, which is the largest value with units of 1/4.
    let [from, to] = [[128.4, 3.6, 0.49, 63.9, 0.24, 0.1, 255.75, 5.0, 2.9], [128.0, 4.0, 0.0, 64.0, 0.0, 0.0, 256.0, 6.0, 2.0]];
    let found = opened(&write(folder.path(), "a.hdr", &colours(&from), &vec![]));
    assert_same(&found, &colours(&to));
    // The largest value 10³⁸ is 2¹²⁶ times 1.1755, or 150.5 units of 2¹¹⁹.
    let (without, largest) = ([-0.5, f32::NAN, 1.0, f32::INFINITY, 1e38, 0.0], 150.0 * 2f32.powi(119));
    let found = opened(&write(folder.path(), "a.hdr", &colours(&without), &vec![]));
    assert_same(&found, &colours(&[0.0, 0.0, 1.0, largest, largest, 0.0]));
}

/// PFM files in both byte orders, grey and coloured, with rows from the bottom. Of the scale only the sign counts.
#[test]
fn pfm_by_hand() {
    let folder = folder();
    let file = |header: &str, values: &[f32], bytes: fn(f32) -> [u8; 4]| {
        let path = folder.path().join("a.pfm");
        let data = values.iter().flat_map(|v| bytes(*v));
        std::fs::write(&path, header.bytes().chain(data).collect::<Vec<u8>>()).expect("written");
        path
    };
    let grey = opened(&file("Pf\n1 2\n1.0\n", &[0.25, 4.0], f32::to_be_bytes));
    assert_eq!((grey.rgb(0, 0), grey.rgb(0, 1)), ([4.0; 3], [0.25; 3]));
    let colours = opened(&file("PF 2  1\n-7\n", &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], f32::to_le_bytes));
    assert_eq!((colours.rgb(0, 0), colours.rgb(1, 0)), ([1.0, 2.0, 3.0], [4.0, 5.0, 6.0]));
    let refused = [
        ("PF\n2 1\n-1\n", 5, "expected 24 bytes of pixels, found 20"),
        ("PF\n2 1\n-1\n", 7, "expected 24 bytes of pixels, found 28"),
        ("PF\n65536 65536\n-1\n", 1, "expected 51539607552 bytes of pixels, found 4"),
        ("PF\n0 1\n-1\n", 0, "its header is not PF or Pf, width, height and scale"),
        ("PF\n1 1\n0\n", 3, "its header is not PF or Pf, width, height and scale"),
        ("PF\n1 -1\n1\n", 3, "its header is not PF or Pf, width, height and scale"),
    ];
    for (header, values, said) in refused {
        let (code, message) = refusal(&file(header, &vec![1.0; values], f32::to_le_bytes));
        assert!(code == 3 && message.ends_with(&format!("a.pfm: not a readable PFM picture: {said}")), "{message}");
    }
}

/// A file that is truncated at any byte is refused with one sentence.
#[test]
fn truncated_pictures_are_refused() {
    let folder = folder();
    let image = whole([5, 4], ["R", "G", "B"].map(|name| channel(name, &[0.25; 20])).into());
    for name in ["a.exr", "a.hdr", "a.png", "a.ppm", "a.pfm"] {
        let bytes = std::fs::read(write(folder.path(), name, &image, &vec![])).expect("written");
        let cut = folder.path().join("cut");
        // The last twelve bytes of a PNG only say that it ends.
        let needed = if name == "a.png" { bytes.len() - 12 } else { bytes.len() };
        for end in 0..needed {
            std::fs::write(&cut, &bytes[..end]).expect("written");
            let (code, message) = refusal(&cut);
            assert!(code == 3 && message.contains("cut: ") && !message.contains('\n'), "{name} cut at {end}: {code} {message}");
        }
    }
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("text"), "hello").expect("written");
    assert!(refusal(&path("text")).1.ends_with("text: unknown picture format: expected EXR, HDR, PNG, JPEG, PPM or PFM"));
    assert!(refusal(&path("none.exr")).1.ends_with("none.exr: no such file"));
    assert!(refusal(folder.path()).1.ends_with(": not a regular file"));
}

/// An EXR whose header states 2³¹ pixels along each side.
#[test]
fn an_exr_that_would_not_fit_is_refused_before_it_is_decoded() {
    let folder = folder();
    let path = write(folder.path(), "a.exr", &whole([2, 1], vec![channel("Y", &[1.0, 2.0])]), &vec![]);
    let mut bytes = std::fs::read(&path).expect("written");
    // xMax and yMax of both windows, which are boxes of four i32 after `box2i` and a size of 16.
    let boxes: Vec<usize> = (0..bytes.len() - 6).filter(|&i| bytes[i..].starts_with(b"box2i\0")).map(|i| i + 6 + 4).collect();
    assert_eq!(boxes.len(), 2);
    for start in boxes {
        bytes[start + 8..start + 16].copy_from_slice(&[0xff, 0xff, 0, 0, 0xff, 0xff, 0, 0]);
    }
    std::fs::write(&path, bytes).expect("written");
    let (code, message) = refusal(&path);
    assert!([3, 4].contains(&code) && message.contains("a.exr: "), "{code} {message}");
}

/// Windows in files of other programs: the display window does not begin at 0, or the data window extends beyond it.
#[test]
fn data_lie_within_the_display_window() {
    let folder = folder();
    let path = folder.path().join("a.exr");
    let file = |position: (i32, i32), display: IntegerBounds| {
        let samples = AnyChannel::new("Y", FlatSamples::F32(vec![1.0, 2.0]));
        let about = LayerAttributes { layer_position: position.into(), ..LayerAttributes::default() };
        let layer = Layer::new((2, 1), about, Encoding::UNCOMPRESSED, AnyChannels::sort([samples].into_iter().collect()));
        ExrImage::empty(ImageAttributes::new(display)).with_layer(layer).write().to_file(&path).expect("written");
    };
    file((-3, 7), IntegerBounds::new((-5, 6), (4, 2)));
    let image = opened(&path);
    assert_eq!((image.full_size, image.origin, image.size), (UVec2::new(4, 2), UVec2::new(2, 1), UVec2::new(2, 1)));
    for position in [(-6, 6), (-5, 5), (-2, 6), (-5, 8)] {
        file(position, IntegerBounds::new((-5, 6), (4, 2)));
        assert!(refusal(&path).1.contains("reaches beyond the display window"), "{position:?}");
    }
}

/// Equal pixels have the same hash, however they are stored. Another bit, channel name or window gives another hash.
#[test]
fn hashes_are_of_pixels() {
    let folder = folder();
    // Every value is exact as a 16-bit float.
    let values = [0.5, -2.0, 0.0, 1024.0, 0.125, 3.0];
    let image = whole([3, 2], vec![channel("B", &values), channel("Z", &[1.0; 6]), channel("R", &values)]);
    let expected = hash(&image);
    assert_eq!(hash(&opened(&write(folder.path(), "a.exr", &image, &vec![("pt/seed".into(), "7".into())]))), expected);
    let path = folder.path().join("b.exr");
    for compression in [Compression::Uncompressed, Compression::RLE, Compression::PIZ, Compression::ZIP1] {
        for half in [false, true] {
            let samples = |values: &[f32]| match half {
                true => FlatSamples::F16(values.iter().map(|&v| f16::from_f32(v)).collect()),
                false => FlatSamples::F32(values.to_vec()),
            };
            let channels = image.channels.iter().map(|c| AnyChannel::new(&*c.name, samples(&c.values))).collect();
            let encoding = Encoding { compression, ..Encoding::UNCOMPRESSED };
            let layer = Layer::new((3, 2), LayerAttributes::default(), encoding, AnyChannels::sort(channels));
            ExrImage::from_layer(layer).write().to_file(&path).expect("written");
            assert_eq!(hash(&opened(&path)), expected, "{compression:?}, half: {half}");
        }
    }
    let mut seen = vec![expected];
    let mut other = |change: &dyn Fn(&mut Image)| {
        let mut image = image.clone();
        change(&mut image);
        let hash = hash(&image);
        assert!(!seen.contains(&hash), "{image:?}");
        seen.push(hash);
    };
    other(&|image| image.channels[1].values[5] = 1.0f32.next_up());
    other(&|image| image.channels[0].values[2] = -0.0);
    other(&|image| image.channels[1].name = "z".into());
    other(&|image| image.channels.truncate(2));
    other(&|image| image.full_size.x = 4);
    other(&|image| (image.full_size, image.origin) = (UVec2::new(4, 2), UVec2::X));
    other(&|image| (image.full_size, image.size) = (UVec2::new(2, 3), UVec2::new(2, 3)));
}

#[test]
fn channels_are_selected_by_layer_name() {
    let names = [
        "B",
        "G",
        "R",
        "StdErr.B",
        "StdErr.G",
        "StdErr.R",
        "N.X",
        "N.Y",
        "N.Z",
        "SampleCount.Y",
        "a.b.r",
        "a.b.g",
        "a.b.b",
        "uv.U",
        "uv.V",
        "pair.A",
        "pair.B",
        "Z",
    ];
    let image = whole([1, 1], names.iter().enumerate().map(|(i, name)| channel(name, &[i as f32])).collect());
    let layer = |name: &str| Pick::Layer(name.into()).of(&image).map(|image| image.rgb(0, 0));
    let one = |name: &str| Pick::Channel(name.into()).of(&image).map(|image| image.rgb(0, 0));
    assert_eq!(Pick::Colour.of(&image).expect("colours").rgb(0, 0), [2.0, 1.0, 0.0]);
    assert_eq!(layer("StdErr"), Ok([5.0, 4.0, 3.0]));
    assert_eq!(layer("N"), Ok([6.0, 7.0, 8.0]));
    assert_eq!(layer("SampleCount"), Ok([9.0; 3]));
    assert_eq!(layer("a.b"), Ok([10.0, 11.0, 12.0]));
    assert_eq!(one("N.Y"), Ok([7.0; 3]));
    assert_eq!(layer("StdEr"), Err("unknown layer \"StdEr\", did you mean \"StdErr\"?".into()));
    assert_eq!(one("std"), Err(format!("unknown channel \"std\", expected one of {}", names.join(", "))));
    assert_eq!(layer("uv"), Ok([13.0, 14.0, 0.0]), "no blue");
    assert_eq!((layer("Z"), one("Z")), (Ok([17.0; 3]), Ok([17.0; 3])));
    assert!(layer("pair").expect_err("two channels").starts_with("expected R, G and B among the layer, found "));
    let depth = whole([1, 1], vec![channel("depth.Z", &[7.0])]);
    assert_eq!(Pick::Colour.of(&depth).expect("the only one").rgb(0, 0), [7.0; 3]);
    let two = whole([1, 1], vec![channel("A", &[7.0]), channel("Z", &[8.0])]);
    assert_eq!(Pick::Colour.of(&two), Err("expected R, G and B among the colours, found A, Z".into()));
}

fn averaged(pictures: &[&Image]) -> pt::Result<Image> {
    let names: Vec<String> = (0..pictures.len()).map(|i| format!("{i}.exr")).collect();
    average(&pictures.iter().zip(&names).map(|(image, name)| Named { name, image }).collect::<Vec<_>>())
}

/// One sample of 8 and three of mean 4: the mean is 5. Errors 3 and 4 become √(1²·3² + 3²·4²)/4.
#[test]
fn averages_by_hand() {
    let picture = |red: f32, error: f32, count: Option<f32>| {
        let mut channels = vec![channel("R", &[red]), channel("StdErr.R", &[error]), channel("Time.Y", &[0.5])];
        channels.extend(count.map(|count| channel("SampleCount.Y", &[count])));
        whole([1, 1], channels)
    };
    let value = |image: &Image, name: &str| image.channel(name).expect("there")[0];
    let weighted = averaged(&[&picture(8.0, 3.0, Some(1.0)), &picture(4.0, 4.0, Some(3.0))]).expect("alike");
    assert_eq!((value(&weighted, "R"), value(&weighted, "SampleCount.Y"), value(&weighted, "Time.Y")), (5.0, 4.0, 1.0));
    assert_eq!(value(&weighted, "StdErr.R"), (153f64.sqrt() / 4.0) as f32);
    let equal = averaged(&[&picture(8.0, 3.0, None), &picture(4.0, 4.0, None)]).expect("alike");
    assert_eq!((value(&equal, "R"), value(&equal, "StdErr.R")), (6.0, 2.5));
    // No picture has a sample here.
    let empty = averaged(&[&picture(8.0, 3.0, Some(0.0)), &picture(4.0, 4.0, Some(0.0))]).expect("alike");
    assert_eq!((value(&empty, "R"), value(&empty, "SampleCount.Y")), (6.0, 0.0));
}

/// A picture averaged with itself is unchanged, including NaN. Channels may have any order.
#[test]
fn the_average_of_equals_is_their_value() {
    let image = wild([6, 5], &["R", "G", "B", "Z"]);
    let mut turned = image.clone();
    turned.channels.reverse();
    for pictures in [&[&image][..], &[&image, &turned], &[&image, &turned, &image]] {
        let mean = averaged(pictures).expect("alike");
        for (found, expected) in mean.channels.iter().zip(&image.channels) {
            let same = |(a, b): (&f32, &f32)| a == b || a.is_nan() && b.is_nan();
            assert!(found.name == expected.name && found.values.iter().zip(&expected.values).all(same));
        }
    }
}

#[test]
fn averages_of_different_kinds_of_pictures_are_refused() {
    let image = wild([2, 2], &["R", "G", "B"]);
    let crop = Image { full_size: UVec2::new(9, 9), ..image.clone() };
    let more = wild([2, 2], &["R", "G", "B", "Z"]);
    for (other, said) in [
        (&crop, "1.exr: expected the window of 0.exr, 2 × 2; found 2 × 2 at (0, 0) of 9 × 9"),
        (&more, "1.exr: expected the channels of 0.exr, B, G, R; found B, G, R, Z"),
    ] {
        let error = averaged(&[&image, other]).expect_err("unlike");
        assert_eq!((error.exit_code(), error.to_string()), (3, said.into()));
    }
    assert_eq!(averaged(&[]).expect_err("nothing").exit_code(), 3);
}

/// Each map has its published first and last colour, and gets brighter throughout, which makes it readable.
#[test]
fn colour_maps_get_brighter_throughout() {
    let ends = [
        (Colormap::Magma, [0x00, 0x00, 0x04], [0xfc, 0xfd, 0xbf]),
        (Colormap::Inferno, [0x00, 0x00, 0x04], [0xfc, 0xff, 0xa4]),
        (Colormap::Plasma, [0x0d, 0x08, 0x87], [0xf0, 0xf9, 0x21]),
        (Colormap::Viridis, [0x44, 0x01, 0x54], [0xfd, 0xe7, 0x25]),
    ];
    for (map, first, last) in ends {
        let is_near = |a: [u8; 3], b: [u8; 3]| a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 1);
        assert!(is_near(map.color(-3.0), first) && is_near(map.color(7.0), last), "{map:?}");
    }
    for map in [Colormap::Magma, Colormap::Inferno, Colormap::Plasma, Colormap::Viridis, Colormap::Cividis] {
        let brightness = |x: f64| {
            let [r, g, b] = map.color(x).map(|byte| output::tonemap::linear(f64::from(byte) / 255.0));
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        assert!((1..=64).all(|i| brightness(f64::from(i) / 64.0) > brightness(f64::from(i - 1) / 64.0)), "{map:?}");
    }
}
