//! Pictures of scenes of the Aalto path tracer, compared with quadrature (ten rotated triangles) and with the program's own pictures.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, UVec2};
use pt::film::{FilmSpec, Image};
use pt::integrator::choose;
use pt::measure::critical_z;
use pt::sampler::{Kind, SamplerSpec};

use crate::import::dialect::{built, folder};
use crate::scenes::{critical, picture};
use crate::shared::shared;

/// Renders a scene with independent samples, by the scene's integrator, with `finer` times the pixels along each side.
fn taken(path: &Path, finer: u32, spp: u64) -> Image {
    let (imported, built) = built(path).unwrap_or_else(|error| panic!("{error}"));
    let (_, integrator) = choose(&[pt::integrators::ALL], imported.root.child("integrator"), None, &imported.file).expect("an integrator");
    let sampler = SamplerSpec { kind: Kind::Independent, spp, seed: 7, ..SamplerSpec::default() };
    picture(Arc::new(built.world), &*integrator, FilmSpec::new(built.film.size.x * finer, built.film.size.y * finer), sampler)
}

/// A wall of light and a stack of ten triangles, each rotated by 10° more about z than the one below, and so far apart that they do not
/// light each other. The picture is one pixel that looks along x at the middle of the triangle `looks_at`.
fn stack(material: &str, light: f64, looks_at: u32) -> tempfile::TempDir {
    let object = |path: &str, material: u32, [x, z]: [f64; 2], height: f64, turn: u32| {
        format!(
            r#"{{ "type": "mesh", "path": "{path}", "materialIndex": {material}, "midpoint": {{ "x": {x:?}, "y": 0, "z": {z:?} }},
                "height": {height:?}, "xrot": 0, "yrot": 0, "zrot": {turn} }}"#
        )
    };
    let triangles = (0..10).map(|k| object("./triangle.obj", 1, [0.0, 1e3 * f64::from(k)], 1.0, 10 * k));
    let objects: Vec<String> = [object("./light.obj", 0, [light, 0.0], 1e9, 0)].into_iter().chain(triangles).collect();
    // Height of a point on the half of the triangle with its axis of rotation.
    let z = 1e3 * f64::from(looks_at) - 0.25;
    let scene = format!(
        r#"{{ "camera": {{ "focalPoint": {{ "x": -8, "y": 0, "z": {z:?} }}, "direction": {{ "x": 1, "y": 0, "z": 0 }},
            "xAngle": 1e-4, "yAngle": 1e-4, "xReso": 1, "yReso": 1 }},
          "materials": [{{ "isLuminous": true, "color": {{ "r": 1, "g": 1, "b": 1 }} }},
            {{ "isLuminous": false, "color": {{ "r": 1, "g": 0.5, "b": 0 }}, {material} }}],
          "objects": [{}] }}"#,
        objects.join(",\n")
    );
    let light = "v 0 -1 -1\nv 0 1 -1\nv 0 1 1\nv 0 -1 1\nf 1 2 3\nf 1 3 4\n";
    folder(&[("scene.json", &scene), ("light.obj", light), ("triangle.obj", "v 0 0 1\nv 0 0 0\nv -1 0 0\nf 1 2 3\n")])
}

/// The share of a cone of directions that have a positive x. The cone has the half angle 90° · m about the mirror direction; its part below
/// the surface is mirrored above it. The surface contains the z axis and is rotated by `degrees` from the plane y = 0.
fn share_towards_x(m: f64, degrees: f64) -> f64 {
    const STEPS: usize = 600;
    let (sin, cos) = degrees.to_radians().sin_cos();
    let normal = DVec3::new(-sin, cos, 0.0);
    let reflect = |d: DVec3| d - 2.0 * d.dot(normal) * normal;
    let mirror = reflect(DVec3::X);
    let (u, v) = (mirror.cross(DVec3::Z), DVec3::Z);
    let least = (FRAC_PI_2 * m).cos();
    // The normal of the side that the camera sees, from which the ray along x comes.
    let outside = -normal.x.signum();
    let hits = (0..STEPS * STEPS).filter(|i| {
        let [a, b] = [i % STEPS, i / STEPS].map(|k| (k as f64 + 0.5) / STEPS as f64);
        let cos = 1.0 - a * (1.0 - least);
        let (sin_phi, cos_phi) = (TAU * b).sin_cos();
        let w = mirror * cos + (u * cos_phi + v * sin_phi) * (1.0 - cos * cos).sqrt();
        let above = if w.dot(normal) * outside < 0.0 { reflect(w) } else { w };
        above.x > 0.0
    });
    hits.count() as f64 / (STEPS * STEPS) as f64
}

/// Mirrors and cones of all widths, seen at ten angles and lit from behind and from the front: each colour equals the quadrature of the
/// cone.
///
/// A large distant wall of light is hit by every path that leaves towards +x, or −x. The first triangle is seen from its edge.
#[test]
fn stacks_of_ten_triangles() {
    const SPP: u64 = 4096;
    // The tolerance is because the wall covers a hemisphere except for an angle of 10⁻⁵, and because of the finite grid of the quadrature.
    const RIM: f64 = 2e-3;
    for (material, m) in [
        (r#""type": "specular""#, 0.0),
        (r#""type": "diffuse", "mattness": 0"#, 0.0),
        (r#""type": "diffuse", "mattness": 0.3"#, 0.3),
        (r#""type": "diffuse", "mattness": 0.7"#, 0.7),
        (r#""type": "diffuse", "mattness": 1"#, 1.0),
    ] {
        for (light, k) in [20.0, -2000.0].into_iter().flat_map(|light| (1..10).map(move |k| (light, k))) {
            let towards_x = share_towards_x(m, 10.0 * f64::from(k));
            let expected = if light > 0.0 { towards_x } else { 1.0 - towards_x };
            let image = taken(&stack(material, light, k).path().join("scene.json"), 1, SPP);
            let [r, g, b] = image.rgb(0, 0).map(f64::from);
            let error = (expected * (1.0 - expected) / SPP as f64).sqrt();
            assert!((r - expected).abs() <= critical() * error + RIM, "{material}, light at {light}, {k}: {r} for {expected} ± {error}");
            assert!((g - 0.5 * r).abs() < 1e-6 && b == 0.0, "{material}, light at {light}, {k}: {r} {g} {b}");
        }
    }
}

/// A picture of the original program: its scene, its samples per pixel, and by how much it may be darker than it should be (relative).
struct Reference {
    scene: &'static str,
    picture: &'static str,
    spp: u64,
    lost: f64,
}

/// In rooms the program's walls are darker by 2.2 ± 0.2 % where they are seen at grazing angles. They are also noisier, as if one path in
/// fifty ended without light, although every path leaves the room towards the light. A simulation of the same room by formulas agrees with
/// pt to 0.2 %. It agrees with the program if rays that leave a wall at less than 1° pass through the wall.
const LEAK: f64 = 0.03;

const REFERENCES: [Reference; 4] = [
    Reference { scene: "small_specular_test", picture: "specular_test", spp: 64, lost: 0.0 },
    Reference { scene: "small_diffuse_test", picture: "diffuse_test", spp: 256, lost: 0.0 },
    Reference { scene: "small_mattness", picture: "mattness", spp: 16, lost: LEAK },
    Reference { scene: "small_glass_panel", picture: "glass_panel_fixed", spp: 8, lost: LEAK },
];

/// The picture of the glass panel with the magnification bug.
const BUGGY: Reference = Reference { scene: "small_glass_panel", picture: "glass_panel_buggy", spp: 12, lost: LEAK };

/// Edge of a block of pixels that are compared by their mean (pixels).
const BLOCK: u32 = 16;
const CHANNELS: [&str; 3] = ["R", "G", "B"];
/// Our picture has `FINE` times the pixels along each side, and `SPP` samples in each of them.
const FINE: u32 = 6;
const SPP: u64 = 2;
/// Significance of all comparisons together: 1 % of the seeds would give a false alarm.
const ALPHA: f64 = 0.01;

/// Expected value and variance of a sample in one of the program's pixels.
///
/// The program places samples in a pixel's square as it lies in the plane of the picture, at a distance of 1 along the axis, but begins at
/// the pixel's corner as it lies on a unit sphere: the square is |d| times as wide as the pixel, with d = (x, y, 1) on that plane.
fn expected(fine: &[[f64; 2]], width: u32, [x, y]: [u32; 2], distance: f64) -> [f64; 2] {
    let height = fine.len() as u32 / width;
    let range = |k: u32, side: u32| {
        let (low, high) = (f64::from(k * FINE), f64::from(k * FINE) + distance * f64::from(FINE));
        let overlap = move |i: u32| (high.min(f64::from(i + 1)) - low.max(f64::from(i)), i);
        (k * FINE..(high.ceil() as u32).min(side)).map(overlap)
    };
    let [mut weights, mut first, mut second] = [0.0; 3];
    for ((v, j), (u, i)) in range(y, height).flat_map(|row| range(x, width).map(move |column| (row, column))) {
        let [mean, square] = fine[(j * width + i) as usize];
        weights += u * v;
        first += u * v * mean;
        second += u * v * square;
    }
    let mean = first / weights;
    [mean, (second / weights - mean * mean).max(0.0)]
}

/// The largest difference between block means, relative to the allowed difference. Above 1 the pictures differ.
///
/// |pt − theirs| ≤ z √(s²/spp + s²/spp′) (+ lost · pt where theirs is darker), z of all blocks and channels together (Šidák)
///
/// - s²: the variance of a sample, as pt's own samples have it
fn worst(reference: &Reference, ours: &Ours, folder: &Path) -> f64 {
    let (theirs, _) = pt::output::read(&folder.join(format!("refs-linear/{}.pfm", reference.picture))).expect("a picture");
    let size = theirs.size;
    assert_eq!(ours.image.size, size * FINE);
    let blocks = size.map(|side| side.div_ceil(BLOCK));
    let z = critical_z(ALPHA, (blocks.element_product() as usize * CHANNELS.len()) * REFERENCES.len());
    let spp = (FINE * FINE) as f64 * SPP as f64;
    let mut worst = 0.0_f64;
    for channel in CHANNELS {
        let values = |image: &'_ Image, name: &str| image.channel(name).unwrap_or_else(|| panic!("{name}")).to_vec();
        let (means, errors) = (values(&ours.image, channel), values(&ours.image, &format!("StdErr.{channel}")));
        // The mean of two squares is the square of their mean plus the square of half their difference, which is due to noise.
        let moments =
            means.iter().zip(errors).map(|(&m, e)| [f64::from(m), f64::from(m).powi(2) + (SPP - 1) as f64 * f64::from(e).powi(2)]);
        let (moments, theirs): (Vec<[f64; 2]>, _) = (moments.collect(), values(&theirs, channel));
        for corner in (0..blocks.element_product()).map(|i| UVec2::new(i % blocks.x, i / blocks.x) * BLOCK) {
            let end = (corner + BLOCK).min(size);
            let [mut expected, mut found, mut variance] = [0.0; 3];
            for [x, y] in (corner.y..end.y).flat_map(|y| (corner.x..end.x).map(move |x| [x, y])) {
                let [mean, of_sample] = self::expected(&moments, size.x * FINE, [x, y], ours.distance([x, y], size));
                expected += mean;
                variance += of_sample * (1.0 / spp + 1.0 / reference.spp as f64);
                found += f64::from(theirs[(y * size.x + x) as usize]);
            }
            let pixels = f64::from((end - corner).element_product());
            // The program sums in 32-bit floats, with rounding errors relative to the largest value.
            let rounding = 1e-6 * pixels;
            let allowed = z * variance.sqrt() + rounding + if found < expected { reference.lost * expected } else { 0.0 };
            worst = worst.max((expected - found).abs() / allowed);
        }
    }
    worst
}

/// pt's picture of a scene, with more pixels than the program's.
struct Ours {
    image: Image,
    /// Tangents of the half angles, across and up.
    tangents: [f64; 2],
}

impl Ours {
    fn of(scene: &Path) -> Ours {
        let camera: serde_json::Value = serde_json::from_slice(&std::fs::read(scene).expect("a scene")).expect("JSON");
        let tangents = ["xAngle", "yAngle"].map(|key| (0.5 * camera["camera"][key].as_f64().expect("an angle")).to_radians().tan());
        Ours { image: taken(scene, FINE, SPP), tangents }
    }

    /// Distance from the eye to a pixel's corner on the plane at a distance of 1.
    fn distance(&self, [x, y]: [u32; 2], size: UVec2) -> f64 {
        let [right, down] = [(x, size.x), (y, size.y)].map(|(k, side)| 2.0 * f64::from(k) / f64::from(side) - 1.0);
        (1.0 + (right * self.tangents[0]).powi(2) + (down * self.tangents[1]).powi(2)).sqrt()
    }
}

/// If the program's own scenes and pictures are available, pt's pictures equal them within the noise. The picture of the magnifying panel
/// differs.
#[test]
fn pictures_are_those_of_the_program() {
    let Some(folder) = shared("aalto") else { return };
    for reference in &REFERENCES {
        let ours = Ours::of(&folder.join(format!("{}.json", reference.scene)));
        let found = worst(reference, &ours, &folder);
        assert!(found <= 1.0, "{}: a block is {found:.2} times as far off as noise may bring", reference.picture);
        if reference.scene == BUGGY.scene {
            let found = worst(&BUGGY, &ours, &folder);
            assert!(found > 2.0, "the panel that magnifies is {found:.2} times as far off as noise may bring");
        }
    }
}

/// All scenes of the program are read; the one that is malformed is reported in one line.
#[test]
fn scenes_of_the_program_are_read() {
    let Some(folder) = shared("aalto") else { return };
    let mut count = 0;
    for entry in std::fs::read_dir(&folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        match built(&path) {
            _ if !name.ends_with(".json") => continue,
            Ok((imported, _)) => assert_eq!(imported.dialect.name, "aalto", "{name}"),
            Err(error) => {
                let expected = "transparent_test.json:20:4: /materials/0: expected a material, found an object";
                assert!(name == "transparent_test.json" && error.to_string().contains(expected), "{name}: {error}");
                assert_eq!((error.faults().len(), error.exit_code()), (1, 3), "{error}");
            }
        }
        count += 1;
    }
    assert!(count > 5, "{count} scenes");
}
