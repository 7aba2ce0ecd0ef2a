//! Pictures as textures, and textures made of textures.

use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DVec3, UVec2, Vec2, Vec3};
use image::{self, DynamicImage, ImageBuffer, ImageFormat, Luma, LumaA, Rgb32FImage, Rgba};
use pt::Error;
use pt::build::Source;
use pt::describe::{self, Encoding, Files, picture};
use pt::math::Rgb;
use pt::scene::Scene as _;
use pt::shape::{SurfacePoint, VertexColor};
use pt::texture::image::{Filter, Pixels, Wrap};
use pt::texture::noise::{fbm, perlin, turbulence};
use pt::texture::{Image, Mix, Product, Texture, TextureContext, Threshold};
use tempfile::TempDir;

use crate::random::Random;

fn at(texture: &Texture, u: f32, v: f32) -> Rgb {
    let point = SurfacePoint { p: Vec3::ZERO, offset: 0.0, ng: Vec3::Z, ns: Vec3::Z, uv: Vec2::new(u, v), color: VertexColor::WHITE };
    texture.at(&TextureContext::exact(&point))
}

fn gray(levels: &[f32], width: u32) -> Arc<Pixels> {
    let size = UVec2::new(width, levels.len() as u32 / width);
    Arc::new(Pixels::new(size, levels.iter().map(|&level| [level; 3]).collect()).expect("as many as the size says"))
}

fn texture(pixels: &Arc<Pixels>, wrap: Wrap, filter: Filter) -> Texture {
    Texture::Image(Image { pixels: pixels.clone(), pyramid: None, scale: Vec2::ONE, wrap, filter })
}

/// Rows of a picture run from the top, and v from the bottom. At a pixel's centre both filters give its exact value.
#[test]
fn pixel_centres_show_their_pixel() {
    let pixels = gray(&[0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 1.0], 4);
    for filter in [Filter::Nearest, Filter::Bilinear] {
        let picture = texture(&pixels, Wrap::Repeat, filter);
        for (k, level) in [0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 1.0].into_iter().enumerate() {
            let (x, y) = (k % 4, k / 4);
            let uv = ((x as f32 + 0.5) / 4.0, 1.0 - (y as f32 + 0.5) / 2.0);
            assert_eq!(at(&picture, uv.0, uv.1), Rgb::gray(level));
        }
    }
}

/// A linear ramp is interpolated linearly between the outermost pixel centres. Beyond them each wrap mode follows its definition.
#[test]
fn pixels_are_interpolated_and_wrapped() {
    let pixels = gray(&[0.0, 0.25, 0.5, 0.75], 4);
    let show = |wrap, u| at(&texture(&pixels, wrap, Filter::Bilinear), u, 0.3).max();
    let mut random = Random::new(3);
    for _ in 0..1000 {
        let u = random.range(0.125, 0.875) as f32;
        assert!((show(Wrap::Clamp, u) - (u - 0.125)).abs() < 1e-6, "{u}");
        // u is a whole number of eighths, so that adding periods to it is exact.
        let u = random.below(8) as f32 / 8.0 + 1.0 / 16.0;
        let far = random.below(1000) as f32 - 500.0;
        assert_eq!(show(Wrap::Repeat, u + far), show(Wrap::Repeat, u));
        assert_eq!(show(Wrap::Mirror, u + 2.0 * far), show(Wrap::Mirror, u));
        assert_eq!(show(Wrap::Mirror, -u), show(Wrap::Mirror, u));
        assert_eq!((show(Wrap::Clamp, -u), show(Wrap::Clamp, 1.0 + u)), (0.0, 0.75));
    }
    // This point is half way between the last pixel and the first of the next period.
    assert_eq!((show(Wrap::Repeat, 0.0), show(Wrap::Mirror, 0.0)), (0.375, 0.0));
}

struct Folder(TempDir);

impl Folder {
    fn new() -> Folder {
        Folder(tempfile::tempdir().expect("a folder"))
    }

    fn with(&self, name: &str, picture: impl Into<DynamicImage>, format: ImageFormat) -> PathBuf {
        let mut bytes = Cursor::new(vec![]);
        picture.into().write_to(&mut bytes, format).expect("encodes");
        self.write(name, bytes.get_ref())
    }

    fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).expect("written");
        path
    }
}

fn shown(path: &Path, encoding: Encoding) -> [f32; 3] {
    let name = path.file_name().and_then(|name| name.to_str()).expect("a name");
    let (pixels, warnings) = picture::load(path, name, encoding, None).unwrap_or_else(|e| panic!("{e}"));
    assert!(warnings.is_empty(), "{warnings:?}");
    at(&texture(&Arc::new(pixels), Wrap::Clamp, Filter::Nearest), 0.5, 0.5).to_array()
}

/// The curve as given in the sRGB standard.
fn iec_61966(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Every kind of PNG, a WebP, a JPEG and an OpenEXR of one colour give the same colour. Formats that are encoded in sRGB are decoded.
#[test]
fn formats_agree() {
    let folder = Folder::new();
    let (level, level16) = (188u8, 188 * 257u16);
    let pngs: [(&str, DynamicImage); 6] = [
        ("l.png", ImageBuffer::from_pixel(8, 8, Luma([level])).into()),
        ("la.png", ImageBuffer::from_pixel(8, 8, LumaA([level, 9])).into()),
        ("rgb.png", ImageBuffer::from_pixel(8, 8, image::Rgb([level; 3])).into()),
        ("rgba.png", ImageBuffer::from_pixel(8, 8, Rgba([level, level, level, 0])).into()),
        ("l16.png", ImageBuffer::from_pixel(8, 8, Luma([level16])).into()),
        ("rgba16.png", ImageBuffer::from_pixel(8, 8, Rgba([level16, level16, level16, 7])).into()),
    ];
    let share = 188.0 / 255.0;
    for (name, picture) in pngs {
        let path = folder.with(name, picture, ImageFormat::Png);
        for (encoding, expected) in [(Encoding::Auto, iec_61966(share)), (Encoding::Srgb, iec_61966(share)), (Encoding::Linear, share)] {
            for value in shown(&path, encoding) {
                assert!((value as f64 - expected).abs() < 1e-7, "{name}, {encoding:?}: {value} for {expected}");
            }
        }
    }
    let webp = folder.with("p.webp", ImageBuffer::from_pixel(8, 8, image::Rgb([level; 3])), ImageFormat::WebP);
    assert!(shown(&webp, Encoding::Auto).iter().all(|v| (*v as f64 - iec_61966(share)).abs() < 1e-7));
    let jpeg = folder.with("p.jpg", ImageBuffer::from_pixel(8, 8, image::Rgb([level; 3])), ImageFormat::Jpeg);
    // JPEG's cosine transform may have an error of one level.
    assert!(shown(&jpeg, Encoding::Linear).iter().all(|v| (*v as f64 - share).abs() <= 1.5 / 255.0));
    let exr = folder.with("p.exr", Rgb32FImage::from_pixel(8, 8, image::Rgb([0.25, 0.5, 1.0])), ImageFormat::OpenExr);
    assert_eq!(shown(&exr, Encoding::Auto), [0.25, 0.5, 1.0]);
}

fn refusal(path: &Path) -> (u8, String) {
    match picture::load(path, "p", Encoding::Auto, None) {
        Ok(_) => panic!("{} is accepted", path.display()),
        Err(error) => (error.exit_code(), error.to_string()),
    }
}

#[test]
fn unusable_pictures_are_refused() {
    let folder = Folder::new();
    for (wrong, said) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (-0.5, "-0.5")] {
        let mut picture = Rgb32FImage::from_pixel(4, 3, image::Rgb([0.5; 3]));
        picture.put_pixel(2, 1, image::Rgb([0.5, wrong, 0.5]));
        let (code, message) = refusal(&folder.with("p.exr", picture, ImageFormat::OpenExr));
        assert_eq!(code, 3);
        assert!(message.contains(&format!("pixel (2, 1): expected finite amounts of light, from 0, found 0.5, {said}, 0.5")), "{message}");
    }
    let right = folder.with("right.png", ImageBuffer::from_pixel(8, 8, image::Rgb([1u8; 3])), ImageFormat::Png);
    let bytes = std::fs::read(&right).expect("written");
    for end in [0, 4, 8, 20, bytes.len() / 2, bytes.len() - 13] {
        let (code, message) = refusal(&folder.write("cut.png", &bytes[..end]));
        assert!(code == 3 && message.contains("p: ") && !message.contains('\n'), "{code} {message} at {end}");
    }
    assert_eq!(refusal(&folder.write("bomb.png", &bomb(bytes))).0, 4);
    let expected = "p: expected a picture in PNG, JPEG, WebP, OpenEXR or Radiance HDR, found";
    assert_eq!(refusal(&folder.write("p.gif", b"GIF89a...")), (3, format!("{expected} GIF")));
    assert_eq!(refusal(&folder.write("p.png", b"no picture")), (3, format!("{expected} an unknown format")));
    assert_eq!(refusal(&folder.0.path().join("none.png")).0, 3);
    assert_eq!(refusal(folder.0.path()).0, 3);
}

/// A picture of emission may have any finite values, whether it is named or given in place. A picture of reflectance is limited to 1.
#[test]
fn only_what_is_emitted_exceeds_one() {
    let folder = Folder::new();
    folder.with("p.exr", Rgb32FImage::from_pixel(1, 1, image::Rgb([13.5, 0.5, 2.0])), ImageFormat::OpenExr);
    let picture = r#"{ "type": "image", "file": "p.exr" }"#;
    let scene = |albedo: &str, emission: &str| {
        format!(
            r#"{{ "pt": 1, "camera": {{}}, "textures": {{ "t": {picture} }}, "shapes": [{{ "type": "quad",
                "material": {{ "type": "diffuse", "albedo": {albedo} }}, "emission": {{ "radiance": 2, "texture": {emission} }} }}] }}"#
        )
    };
    let product = format!(r#"{{ "type": "product", "a": 0.5, "b": {picture} }}"#);
    for (emission, factor) in [(picture, 1.0), ("\"t\"", 1.0), (&product, 0.5)] {
        let built = built(&scene("0.5", emission), &folder).unwrap_or_else(|e| panic!("{e}"));
        let ray = pt::math::Ray::new(Vec3::Z, -Vec3::Z);
        let hit = built.world.intersect(&ray).expect("the quad");
        let emitted = built.world.surface(&ray, &hit).emitted(Vec3::Z).to_rgb();
        assert_eq!(emitted, [27.0, 1.0, 4.0].map(|radiance| radiance * factor), "{emission}");
    }
    let mix = format!(r#"{{ "type": "mix", "a": 0, "b": 1, "share": {picture} }}"#);
    for (scene, pointer) in [
        (scene(picture, "1"), "/shapes/0/material/albedo/file"),
        (scene("\"t\"", "1"), "/textures/t/file"),
        (scene("0.5", &mix), "/shapes/0/emission/texture/share/file"),
    ] {
        let said = built(&scene, &folder).err().map(|error| error.to_string()).unwrap_or_default();
        let expected = format!("{pointer}: p.exr: pixel (0, 0): expected shares of light from 0 to 1, found 13.5, 0.5, 2;");
        assert!(said.contains(&expected), "{said}");
    }
}

fn built(scene: &str, folder: &Folder) -> pt::Result<pt::build::Built> {
    let root = describe::root(scene.as_bytes(), "s.json").expect("JSON");
    let described = describe::read(&root, "s.json").expect("a scene");
    pt::build::build(&described, Source { root: &root, file: "s.json", files: &Files::within(folder.0.path()) })
}

/// The PNG with a header that states 65,535² pixels of 16 bits, with a correct checksum.
pub fn bomb(png: Vec<u8>) -> Vec<u8> {
    promising(png, 65535, 16)
}

/// The PNG with a header that states `side` pixels along each side and `bits` bits for each colour, with a correct checksum.
pub fn promising(mut png: Vec<u8>, side: u32, bits: u8) -> Vec<u8> {
    png[16..20].copy_from_slice(&side.to_be_bytes());
    png[20..24].copy_from_slice(&side.to_be_bytes());
    png[24..26].copy_from_slice(&[bits, if bits == 16 { 6 } else { 2 }]);
    let sum = crc32(&png[12..29]);
    png[29..33].copy_from_slice(&sum.to_be_bytes());
    png
}

/// A JPEG of 8 × 8 pixels that claims to have 15855 × 15625.
pub fn large_jpeg() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(vec![]);
    image::RgbImage::new(8, 8).write_to(&mut bytes, image::ImageFormat::Jpeg).expect("encoded");
    let mut bytes = bytes.into_inner();
    // The frame header begins with its mark, its length and the number of bits, and goes on with height and width.
    let frame = bytes.windows(2).position(|mark| mark == [0xff, 0xc0]).expect("a frame");
    bytes[frame + 5..][..4].copy_from_slice(&[15625u16.to_be_bytes(), 15855u16.to_be_bytes()].concat());
    bytes
}

/// A PNG of 4 × 4 pixels, all of the palette's first colour. The palette has `bytes` bytes, three for each colour.
pub fn with_palette(bytes: usize) -> Vec<u8> {
    let chunk = |name: &[u8; 4], data: &[u8]| {
        let named = [&name[..], data].concat();
        [&(data.len() as u32).to_be_bytes()[..], &named, &crc32(&named).to_be_bytes()].concat()
    };
    // Four rows, each of a filter's number and four pixels, not compressed; and the Adler-32 checksum of 20 zeros.
    let rows = [&[0x78, 0x01, 0x01, 20, 0, !20, !0][..], &[0; 20], &[0, 20, 0, 1]].concat();
    let header = [0, 0, 0, 4, 0, 0, 0, 4, 8, 3, 0, 0, 0];
    let chunks = [chunk(b"IHDR", &header), chunk(b"PLTE", &vec![9; bytes]), chunk(b"IDAT", &rows), chunk(b"IEND", &[])];
    [&b"\x89PNG\r\n\x1a\n"[..], &chunks.concat()].concat()
}

/// Checksum of PNG chunks, computed bit by bit. Source: ISO 3309.
fn crc32(bytes: &[u8]) -> u32 {
    let byte = |sum: u32, byte: &u8| (0..8).fold(sum ^ u32::from(*byte), |s, _| if s & 1 == 1 { (s >> 1) ^ 0xedb8_8320 } else { s >> 1 });
    !bytes.iter().fold(!0, byte)
}

/// The first bytes of a file determine its format. A name with another extension causes a warning.
#[test]
fn content_takes_precedence_over_the_file_name() {
    let folder = Folder::new();
    let path = folder.with("p.jpg", ImageBuffer::from_pixel(2, 2, image::Rgb([9u8; 3])), ImageFormat::Png);
    let (_, warnings) = picture::load(&path, "p.jpg", Encoding::Auto, None).expect("a PNG");
    assert_eq!(warnings, ["p.jpg: read as PNG, which its first bytes say it is"]);
}

/// A missing picture is reported with its position in the scene, within a material or as a named texture.
#[test]
fn missing_pictures_are_reported_with_their_position() {
    let scene = r#"{ "pt": 1, "camera": {}, "textures": { "t": { "type": "image", "file": "a.png" } }, "shapes": [
        { "type": "sphere", "material": { "type": "diffuse", "albedo": { "type": "product", "a": 0.5, "b": { "type": "image", "file": "b.png" } } } },
        { "type": "sphere", "material": { "type": "mirror", "color": "t" } } ] }"#;
    let root = describe::root(scene.as_bytes(), "s.json").expect("JSON");
    let described = describe::read(&root, "s.json").expect("a scene");
    let Err(Error::Invalid(faults)) =
        pt::build::build(&described, Source { root: &root, file: "s.json", files: &Files::within("nowhere") })
    else {
        panic!("it is built without its pictures")
    };
    let said: Vec<(String, String)> = faults.iter().map(|f| (f.pointer.clone(), f.message.clone())).collect();
    let expected = [("/shapes/0/material/albedo/b/file", "b.png: no such file"), ("/textures/t/file", "a.png: no such file")];
    assert_eq!(said, expected.map(|(pointer, message)| (pointer.to_owned(), message.to_owned())));
}

#[test]
fn mixes_and_products_are_arithmetic() {
    let [a, b] = [Rgb::new(1.0, 0.5, 0.0), Rgb::new(0.25, 0.5, 1.0)];
    let share = Rgb::new(0.25, 0.5, 1.0);
    let mix = Texture::Mix(Box::new(Mix { a: a.into(), b: b.into(), share: share.into() }));
    assert_eq!(at(&mix, 0.0, 0.0), Rgb::new(0.8125, 0.5, 1.0));
    let product = Texture::Product(Box::new(Product { a: a.into(), b: b.into() }));
    assert_eq!(at(&product, 0.0, 0.0), Rgb::new(0.25, 0.25, 0.0));
}

/// Noise is zero on the lattice, within ±1, and continuous. Its slope at a lattice point is one of the twelve gradients.
#[test]
fn noise_is_smooth_and_centred() {
    let mut random = Random::new(5);
    let mut mean = 0.0;
    const N: usize = 100_000;
    for _ in 0..N {
        let cell = DVec3::new(random.range(-1e6, 1e6), random.range(-1e6, 1e6), random.range(-1e6, 1e6)).floor();
        assert_eq!(perlin(cell), 0.0);
        const H: f64 = 1e-5;
        let slope = DVec3::from(DVec3::AXES.map(|axis| perlin(cell + H * axis) / H));
        let mut sizes = slope.abs().to_array();
        sizes.sort_by(f64::total_cmp);
        assert!(sizes[0].abs() < 1e-3 && (sizes[1] - 1.0).abs() < 1e-3 && (sizes[2] - 1.0).abs() < 1e-3, "{slope}");
        let p = cell + DVec3::new(random.unit(), random.unit(), random.unit());
        let n = perlin(p);
        assert!(n.abs() <= 1.0);
        // With gradients of length √2 and a fade of slope 15/8 the slope of the noise is below 8.
        assert!((perlin(p + H * DVec3::ONE) - n).abs() < 8.0 * 3f64.sqrt() * H + 1e-9);
        assert!(fbm(p, 6).abs() <= 2.0 && (0.0..=2.0).contains(&turbulence(p, 6)));
        assert_eq!(fbm(p, 1), n);
        mean += n / N as f64;
    }
    // The standard deviation of the noise is near 1/4, and the tolerance is five standard errors of the mean.
    assert!(mean.abs() < 5.0 * 0.25 / (N as f64).sqrt(), "{mean}");
}

/// The red, green, blue and opacity channels of a picture can be used separately. Opacity is linear for every encoding, and 1 if the
/// picture has none.
#[test]
fn channels_of_pictures() {
    let folder = Folder::new();
    let rgba = ImageBuffer::from_pixel(1, 1, Rgba([0u8, 51, 102, 153]));
    let with_alpha = folder.with("a.png", DynamicImage::ImageRgba8(rgba), ImageFormat::Png);
    let without =
        folder.with("b.png", DynamicImage::ImageRgb8(ImageBuffer::from_pixel(1, 1, image::Rgb([0u8, 51, 102]))), ImageFormat::Png);
    use describe::Channel::{A, B, G, R};
    for (path, channel, expected) in
        [(&with_alpha, R, 0.0), (&with_alpha, G, 0.2), (&with_alpha, B, 0.4), (&with_alpha, A, 0.6), (&without, A, 1.0)]
    {
        for encoding in [Encoding::Linear, Encoding::Srgb] {
            let (pixels, _) = picture::load(path, "p", encoding, Some(channel)).expect("a picture");
            let expected = if encoding == Encoding::Srgb && channel != A { pt::output::tonemap::linear(expected) } else { expected };
            let [r, g, b] = pixels.values()[0];
            assert!((f64::from(r) - expected).abs() < 1e-7 && r == g && g == b, "{channel:?}: {r}, expected {expected}");
        }
    }
}

/// The threshold texture is 1 from the threshold on, for each channel separately.
#[test]
fn thresholds_are_black_and_white() {
    let by = |level| Texture::Constant(Rgb::new(level, 0.5, 0.25));
    for (level, expected) in [(0.0, 0.0), (0.375f32.next_down(), 0.0), (0.375, 1.0), (1.0, 1.0)] {
        let threshold = Texture::Threshold(Box::new(Threshold { by: by(level), at: 0.375 }));
        assert_eq!(at(&threshold, 0.5, 0.5), Rgb::new(expected, 1.0, 0.0), "{level}");
    }
}
