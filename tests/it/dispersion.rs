//! Dispersion: glass bends light of each wavelength by its own index, and everything else keeps its colour.
//!
//! The angles of prisms and rainbows are rows O12 and O13 of `pt torture`.

use std::sync::Arc;

use glam::{DVec2, DVec3, UVec2, Vec2, Vec3};
use pt::bsdf::microfacet::Distribution;
use pt::bsdf::microfacet::roughness::{Alpha, Roughness};
use pt::bsdf::{Bsdf, Coat, Coated, Compound, Dispersion, Glass, HitContext, Material, TransportMode, textured};
use pt::camera::{Camera, Orthographic, Pose};
use pt::effects::Effects;
use pt::film::{FilmSpec, Filter, Image};
use pt::integrator::Integrator;
use pt::integrators::card::Card;
use pt::integrators::light::LightTracer;
use pt::integrators::nee::Nee;
use pt::integrators::path::Path;
use pt::integrators::whitted::Whitted;
use pt::light::{Environment, Light};
use pt::math::{Local, Rgb, Transform, Wavelength};
use pt::measure::{SampledImage, agreement, critical_z, sidak};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene as _;
use pt::shape::{Quad, Sphere, SurfacePoint, TriangleMesh, VertexColor};
use pt::torture::everything::bits;
use pt::torture::meshes::mesh;
use pt::world::{World, WorldBuilder};
use serde_json::{Value, json};

use crate::absorption::{daylight, observer};
use crate::light_tracer::built;
use crate::marked::assert_fault_in_scene;
use crate::random::Random;
use crate::scenes::{Depth, Effort, KnownRadiance, black, confirm, facing, glow, picture, probe};

/// Each named glass has the index at the line d and the Abbe number of its catalogue, which are rounded to their last digit.
#[test]
fn glasses_have_the_index_of_their_catalogue() {
    let catalogue = [
        (Glass::Bk7, 1.51680, 64.17),
        (Glass::Baf10, 1.67003, 47.11),
        (Glass::F2, 1.62004, 36.37),
        (Glass::Fk51a, 1.48656, 84.47),
        (Glass::Lasf9, 1.85025, 32.17),
        (Glass::Sf5, 1.67271, 32.25),
        (Glass::Sf10, 1.72828, 28.53),
        (Glass::Sf11, 1.78472, 25.68),
        (Glass::FusedSilica, 1.45846, 67.82),
    ];
    let [d, f, c] = [Wavelength::D_LINE, Wavelength::F_LINE, Wavelength::C_LINE];
    let abbe = |of: &Dispersion| (of.index(d) - 1.0) / (of.index(f) - of.index(c));
    for (glass, index, number) in catalogue {
        let dispersion = glass.dispersion();
        assert!((dispersion.index(d) - index).abs() < 6e-6, "{glass:?}: {}, not {index}", dispersion.index(d));
        assert!((abbe(&dispersion) - number).abs() < 6e-3, "{glass:?}: {}, not {number}", abbe(&dispersion));
    }
    // Tables of crystals and liquids state fewer digits.
    for (glass, index, number) in [(Glass::Diamond, 2.4175, 55.3), (Glass::Sapphire, 1.7682, 72.3), (Glass::Water, 1.3334, 55.8)] {
        let dispersion = glass.dispersion();
        assert!((dispersion.index(d) - index).abs() < 6e-5 && (abbe(&dispersion) - number).abs() < 6e-2, "{glass:?}");
    }
    for (index, number) in [(1.5, 60.0), (2.4, 20.0), (1.3, 1e6)] {
        let dispersion = Dispersion::of_abbe_number(index, number);
        assert!((dispersion.index(d) - index).abs() < 1e-12 && (abbe(&dispersion) / number - 1.0).abs() < 1e-6, "{index}, {number}");
    }
}

/// The responses are never negative, their integrals are 1, and they are those of another table of the observer, whose curves are fitted to
/// 1 % before they are subtracted from each other.
#[test]
fn responses_are_those_of_the_observer() {
    const RGB: [[f64; 3]; 3] = [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]];
    let fitted = |c: usize, nanometres: f64| {
        let seen = observer(nanometres);
        (daylight(nanometres) * (0..3).map(|i| RGB[c][i] * seen[i]).sum::<f64>()).max(0.0)
    };
    let all: Vec<f64> = (0..=3200).map(|k| 380.0 + f64::from(k) * 0.1).collect();
    for c in 0..3 {
        let total: f64 = all.iter().map(|w| fitted(c, *w)).sum::<f64>() * 0.1;
        let responses: Vec<f64> = all.iter().map(|w| Wavelength::new(*w as f32).responses()[c]).collect();
        let greatest = responses.iter().copied().fold(0.0, f64::max);
        let sum = responses.iter().sum::<f64>() - 0.5 * (responses[0] + responses[3200]);
        assert!((sum * 0.1 - 1.0).abs() < 1e-5, "coefficient {c}: the integral is {}", sum * 0.1);
        assert!(responses.iter().all(|response| *response >= 0.0));
        // The other table of daylight has a number at every 20 nm.
        for (w, response) in all.iter().zip(&responses).step_by(200) {
            let other = fitted(c, *w) / total;
            assert!((response - other).abs() < 0.04 * greatest, "coefficient {c} at {w} nm: {response}, not {other}");
        }
        let mean = |of: &dyn Fn(usize) -> f64| all.iter().enumerate().map(|(i, w)| w * of(i)).sum::<f64>() * 0.1;
        let (found, wanted) = (mean(&|i| responses[i]), mean(&|i| fitted(c, all[i]) / total));
        assert!((found - wanted).abs() < 2.0, "coefficient {c}: the mean wavelength is {found} nm, not {wanted}");
    }
}

/// Wavelengths are drawn with the mean of the responses as density, and their factors have the sum 3 and the expected value 1 each.
#[test]
fn wavelengths_have_their_density() {
    const COUNT: u32 = 1 << 20;
    let drawn: Vec<_> = (0..COUNT).map(|k| Wavelength::sample((k as f32 + 0.5) / COUNT as f32)).collect();
    assert!(drawn.is_sorted_by(|a, b| a.0 <= b.0), "a greater number gives a longer wavelength");
    let (mut below, mut integral) = (0, 0.0);
    for k in 0..3200 {
        let nanometres = 380.0 + (f64::from(k) + 1.0) * 0.1;
        let p: f64 = Wavelength::new((nanometres - 0.05) as f32).responses().iter().sum::<f64>() / 3.0;
        integral += 0.1 * p;
        below += drawn[below..].iter().take_while(|(w, _)| f64::from(w.nanometres()) < nanometres).count();
        // The rounding of a wavelength is 3·10⁻⁵ nm, and p is at most 0.006.
        let share = below as f64 / f64::from(COUNT);
        assert!((share - integral).abs() < 2e-5, "below {nanometres} nm: {share}, not {integral}");
    }
    let sum = drawn.iter().fold([0.0; 3], |sum: [f64; 3], (_, factors)| {
        let factors = factors.to_rgb().map(f64::from);
        assert!(factors.iter().all(|x| *x >= 0.0) && (factors.iter().sum::<f64>() - 3.0).abs() < 1e-5);
        [0, 1, 2].map(|c| sum[c] + factors[c])
    });
    for mean in sum.map(|sum| sum / f64::from(COUNT)) {
        assert!((mean - 1.0).abs() < 1e-4, "{mean}");
    }
    assert_eq!(Wavelength::sample(0.0).0, Wavelength::SHORTEST);
}

fn flint() -> Material {
    Material::dispersive(textured::Dielectric::smooth(1.5, Rgb::WHITE), Glass::Sf11.dispersion())
}

/// For light of a wavelength, dispersive glass is plain glass of its index, to the bit; without one, glass of the index at the line d.
/// This also holds for rough glass, up to the table for further reflections, and for glass within other materials.
#[test]
fn dispersive_glass_is_plain_glass_at_each_wavelength() {
    let point =
        SurfacePoint { p: Vec2::ZERO.extend(0.0), offset: 0.0, ng: Vec3::Z, ns: Vec3::Z, uv: Vec2::ZERO, color: VertexColor::WHITE };
    let at = HitContext::from_outside(point);
    let within = |glass: Material| Material::mix(Material::diffuse(Rgb::gray(0.5)), glass, Rgb::gray(0.25));
    let coated = |glass: Material| Material::from(Compound::Coated(Coated { base: glass, coat: Coat::new(1.3, 1.0, None) }));
    let rough = || Some(Roughness { alpha: Alpha::Constant(Vec2::splat(0.3)), distribution: Distribution::Ggx });
    let frosted = Material::dispersive(textured::Dielectric::new(1.5, Rgb::WHITE, rough(), false), Glass::Sf11.dispersion());
    let mut random = Random::new(11);
    for _ in 0..1000 {
        let (wavelength, _) = Wavelength::sample(random.unit() as f32);
        let index = Glass::Sf11.dispersion().index(wavelength) as f32;
        let wo = Local(random.direction().as_vec3());
        let (choice, u) = (random.unit() as f32, random.square());
        let sample = |bsdf: Bsdf| bsdf.sample(wo, choice, u, TransportMode::Radiance);
        let (flint, plain, mixed, mixed_plain) = (flint(), Material::glass(index), within(self::flint()), within(Material::glass(index)));
        assert_eq!(flint.bsdf_at(&at).at_wavelength(wavelength), plain.bsdf_at(&at));
        assert_eq!(sample(mixed.bsdf_at(&at).at_wavelength(wavelength)), sample(mixed_plain.bsdf_at(&at)));
        let (over, over_plain) = (coated(self::flint()), coated(Material::glass(index)));
        assert_eq!(sample(over.bsdf_at(&at).at_wavelength(wavelength)), sample(over_plain.bsdf_at(&at)));
        let (frosted, plain) =
            (frosted.bsdf_at(&at).at_wavelength(wavelength), Material::rough_glass(index, Rgb::WHITE, rough().expect("rough"), false));
        let (plain, wi) = (plain.bsdf_at(&at), Local(random.direction().as_vec3()));
        assert_eq!(
            (frosted.eval(wo, wi, TransportMode::Radiance), frosted.pdf(wo, wi)),
            (plain.eval(wo, wi, TransportMode::Radiance), plain.pdf(wo, wi))
        );
        let middle = Material::glass(Glass::Sf11.dispersion().index(Wavelength::D_LINE) as f32);
        assert_eq!(sample(flint.bsdf_at(&at)), sample(middle.bsdf_at(&at)));
    }
    assert!(flint().effects().contains(Effects::DISPERSION) && within(flint()).effects().contains(Effects::DISPERSION));
    assert!(!Material::glass(1.5).effects().contains(Effects::DISPERSION));
}

/// Clear dispersive glass in light from all sides sends out as much as arrives.
#[test]
fn dispersive_glass_keeps_all_light() {
    let law = |name: &str, material: Material, standard: f64| {
        let mut world = World::builder(probe(DVec3::Z * 3.0, DVec3::new(0.3, 0.2, 0.0)));
        let glass = world.material(material);
        world.shape(Sphere { radius: 1.0 }, Transform::IDENTITY, glass, None);
        world.light(Light::Environment(Environment { radiance: Rgb::WHITE }));
        KnownRadiance::new(name, world, 1.0, Depth { max: 256, roulette: 64 }).resolution(1e-3, standard)
    };
    confirm(vec![law("flint", flint(), 4e-3)], Effort::Standard);
}

/// A line of light seen through a prism: the orthographic camera looks along −z at a strip behind the prism.
fn line_behind_prism() -> WorldBuilder {
    let pose = Pose::new(&Transform::translate(DVec3::new(0.0, 0.0, 4.0)).expect("finite"));
    let mut world = World::builder(Camera::Orthographic(Orthographic { pose, height: HEIGHT }));
    let (glass, dark) = (world.material(flint()), world.material(black()));
    // The front face is the plane z = x/4, the back face z = −x/4 − 1: both end far beyond the picture.
    let corner = |x: f32, z: f32| [-4.0f32, 4.0].map(|y| Vec3::new(x, y, z));
    let corners = [corner(-0.6, -0.15), corner(-0.6, -0.85), corner(1.4, 0.35), corner(1.4, -1.35)].concat();
    let side = |a: u32, b: u32| [[2 * a, 2 * a + 1, 2 * b], [2 * b, 2 * a + 1, 2 * b + 1]];
    let sides = [side(0, 1), side(1, 3), side(3, 2), side(2, 0)].concat();
    let ends = vec![[0, 2, 4], [4, 2, 6], [1, 5, 3], [5, 7, 3]];
    world.shape(TriangleMesh::new(mesh(corners, [sides, ends].concat())), Transform::IDENTITY, glass, None);
    world.shape(Quad { size: [STRIP, 8.0] }, facing(DVec3::new(LINE, 0.0, -DISTANCE), DVec3::Z), dark, glow(1.0));
    world
}

const HEIGHT: f32 = 0.5;
const STRIP: f64 = 0.1;
const DISTANCE: f64 = 5.0;
/// Place x of the line on the wall.
const LINE: f64 = 1.95;

/// Snell's law for a unit direction in the plane, by the angles to a unit normal that points against it. Returns the direction and
/// the transmitted share by Fresnel's equations.
fn snell([dx, dz]: [f64; 2], [nx, nz]: [f64; 2], ratio: f64) -> ([f64; 2], f64) {
    let cos = -(dx * nx + dz * nz);
    let sin_t = ratio * (1.0 - cos * cos).sqrt();
    let cos_t = (1.0 - sin_t * sin_t).sqrt();
    let bent = [ratio * dx + (ratio * cos - cos_t) * nx, ratio * dz + (ratio * cos - cos_t) * nz];
    // ratio = n_before / n_after.
    let (s, p) = ((ratio * cos - cos_t) / (ratio * cos + cos_t), (cos - ratio * cos_t) / (cos + ratio * cos_t));
    (bent, 1.0 - 0.5 * (s * s + p * p))
}

/// Place on the wall of the light that a ray at x follows, and the share of it that passes both faces.
fn behind(x: f64, index: f64) -> (f64, f64) {
    let unit = |[x, z]: [f64; 2]| [x / x.hypot(z), z / x.hypot(z)];
    let (within, first) = snell([0.0, -1.0], unit([-0.25, 1.0]), 1.0 / index);
    let z = 0.25 * x;
    // The back face: z + x/4 + 1 = 0. The normal against the ray points inwards.
    let t = -(z + 0.25 * x + 1.0) / (within[1] + 0.25 * within[0]);
    let (x, z) = (x + t * within[0], z + t * within[1]);
    let (out, second) = snell(within, unit([0.25, 1.0]), index);
    let t = (-DISTANCE - z) / out[1];
    (x + t * out[0], first * second)
}

/// Light that each colour sees in each column of pixels: the mean over many places and wavelengths.
///
/// - `pixels`, `size`: the film in pixels and in metres
/// - `[wavelengths, across, along]`: number of wavelengths from 380 to 700 nm, and of places in a column, side by side and one above the other
/// - `seen`: radiance at a place of the film for an index of refraction
fn seen_in_columns(pixels: UVec2, size: DVec2, [wavelengths, across, along]: [u32; 3], seen: impl Fn(DVec2, f64) -> f64) -> Vec<[f64; 3]> {
    let middle = |k: u32, count: u32| (f64::from(k) + 0.5) / f64::from(count);
    let mut wanted = vec![[0.0; 3]; pixels.x as usize];
    for k in 0..wavelengths {
        let wavelength = Wavelength::new((380.0 + 320.0 * middle(k, wavelengths)) as f32);
        let (index, responses) = (Glass::Sf11.dispersion().index(wavelength), wavelength.responses());
        for (column, wanted) in wanted.iter_mut().enumerate() {
            let places = (0..across).flat_map(|i| (0..along).map(move |j| [i, j]));
            let light = places.map(|[i, j]| {
                let place = DVec2::new((column as f64 + middle(i, across)) / f64::from(pixels.x), middle(j, along));
                seen((place - 0.5) * size, index)
            });
            let share = light.sum::<f64>() / f64::from(across * along) * 320.0 / f64::from(wavelengths);
            *wanted = [0, 1, 2].map(|c| wanted[c] + responses[c] * share);
        }
    }
    wanted
}

/// Asserts that every integrator which follows camera rays through glass sees this light in each column of pixels and each colour, after at
/// most two surfaces.
fn assert_columns(world: WorldBuilder, pixels: UVec2, wanted: &[[f64; 3]]) {
    let scene = Arc::new(world.build().expect("glass"));
    let of_two: [(&str, Box<dyn Integrator>); 3] = [
        ("path", Box::new(Path { max_depth: 2, ..Path::default() })),
        ("nee", Box::new(Nee { max_depth: 2, ..Nee::default() })),
        ("whitted", Box::new(Whitted { max_depth: 2, ..Whitted::default() })),
    ];
    for (name, integrator) in of_two {
        let samples = 12_288 / u64::from(pixels.y);
        let sampler = SamplerSpec { kind: Kind::Independent, spp: samples, seed: 5, ..SamplerSpec::default() };
        let spec = FilmSpec { filter: Filter::pixel_box(0.5), ..FilmSpec::new(pixels.x, pixels.y) };
        let image = picture(scene.clone(), &*integrator, spec, sampler);
        let channels =
            ["R", "G", "B"].map(|c| (image.channel(c).expect("a channel"), image.channel(&format!("StdErr.{c}")).expect("errors")));
        for (column, wanted) in wanted.iter().enumerate() {
            for (c, (values, errors)) in channels.iter().enumerate() {
                let rows = (0..pixels.y as usize).map(|row| row * pixels.x as usize + column);
                let (sum, square) = rows.fold((0.0, 0.0), |(sum, square), i| {
                    (sum + f64::from(values[i]), square + f64::from(errors[i]) * f64::from(errors[i]))
                });
                let (found, error) = (sum / f64::from(pixels.y), square.sqrt() / f64::from(pixels.y));
                // Columns in which hardly any light arrives have no estimate of the error, and steps of place and wavelength 2e-4.
                let (wanted, error) = (wanted[c], error.hypot(2e-4));
                let z = (found - wanted) / error;
                let critical = critical_z(0.01, 9 * pixels.x as usize);
                assert!(z.abs() < critical, "{name}, column {column}, colour {c}: {found}, not {wanted} ± {error}");
            }
        }
    }
}

/// A white line through a prism is the spectrum that Snell's law and Fresnel's equations give for each wavelength.
#[test]
fn a_line_through_a_prism_is_its_spectrum() {
    let pixels = UVec2::splat(24);
    let wanted = seen_in_columns(pixels, DVec2::splat(HEIGHT.into()), [3200, 400, 1], |p, index| {
        let (place, share) = behind(p.x, index);
        if (place - LINE).abs() < 0.5 * STRIP { share } else { 0.0 }
    });
    let red: f64 = wanted.iter().map(|column| column[0]).sum();
    assert!(red > 0.5, "the line is in the picture: {red}, {:?} to {:?}", behind(-0.25, 1.78), behind(0.25, 1.78));
    assert_columns(line_behind_prism(), pixels, &wanted);
}

/// Distance from the centre of a lens to the line behind it.
const BEHIND_LENS: f64 = 8.0;
/// Place x of that line.
const LINE_BEHIND_LENS: f64 = -1.6;

/// Place x of the light behind a ball of glass that a ray along −z at `p` follows, and the share of it that passes both faces.
fn behind_ball(p: DVec2, index: f64) -> (f64, f64) {
    /// Snell's law for a unit direction and a unit normal against it, and the transmitted share by Fresnel's equations.
    fn refract(d: DVec3, normal: DVec3, ratio: f64) -> (DVec3, f64) {
        let cos = -d.dot(normal);
        let cos_t = (1.0 - ratio * ratio * (1.0 - cos * cos)).sqrt();
        let (s, p) = ((ratio * cos - cos_t) / (ratio * cos + cos_t), (cos - ratio * cos_t) / (cos + ratio * cos_t));
        (ratio * d + (ratio * cos - cos_t) * normal, 1.0 - 0.5 * (s * s + p * p))
    }
    let first = p.extend((1.0 - p.length_squared()).sqrt());
    let (within, share) = refract(DVec3::NEG_Z, first, 1.0 / index);
    let second = first - 2.0 * first.dot(within) * within;
    let (out, passed) = refract(within, -second, index);
    let t = (-BEHIND_LENS - second.z) / out.z;
    (second.x + t * out.x, share * passed)
}

/// A white line behind a lens, a ball of flint, has the coloured fringes that Snell's law and Fresnel's equations give for each wavelength.
#[test]
fn a_line_behind_a_lens_has_coloured_fringes() {
    let pixels = UVec2::new(32, 4);
    let height = 0.08;
    let width = height * f64::from(pixels.x) / f64::from(pixels.y);
    let wanted = seen_in_columns(pixels, DVec2::new(width, height), [640, 100, 8], |p, index| {
        let (place, share) = behind_ball(p, index);
        if (place - LINE_BEHIND_LENS).abs() < STRIP { share } else { 0.0 }
    });
    // One side of the line is blue and the other red.
    let excess = |column: &[f64; 3]| column[0] - column[2];
    let (least, greatest) = wanted.iter().map(excess).fold((0.0, 0.0), |(a, b), x| (f64::min(a, x), f64::max(b, x)));
    assert!(least < -0.1 && greatest > 0.1, "{least} to {greatest}");
    let pose = Pose::new(&Transform::translate(DVec3::new(0.0, 0.0, 4.0)).expect("finite"));
    let mut world = World::builder(Camera::Orthographic(Orthographic { pose, height: height as f32 }));
    let (glass, dark) = (world.material(flint()), world.material(black()));
    world.shape(Sphere { radius: 1.0 }, Transform::IDENTITY, glass, None);
    let place = facing(DVec3::new(LINE_BEHIND_LENS, 0.0, -BEHIND_LENS), DVec3::Z);
    world.shape(Quad { size: [2.0 * STRIP, 8.0] }, place, dark, glow(1.0));
    assert_columns(world, pixels, &wanted);
}

const EDGE: u32 = 16;

/// A floor with a lamp above it, and a body of glass between: the camera sees the floor alone, or the glass too.
fn cast_on_floor(glass: &Value, shows_glass: bool) -> Value {
    let from = if shows_glass { [0.0, 1.5, 4.0] } else { [0.0, 0.4, 3.0] };
    let to = if shows_glass { [0.0, 0.8, 0.0] } else { [0.0, 0.0, 0.2] };
    json!({
        "pt": 1,
        "camera": { "look_at": { "from": from, "to": to }, "fov": 25 },
        "materials": { "glass": glass, "white": { "type": "diffuse", "albedo": 0.7 } },
        "background": { "radiance": 0.1 },
        "shapes": [
            { "type": "quad", "size": 6, "material": "white", "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": -90 } }] },
            { "type": "sphere", "radius": 0.4, "center": [0, 1.1, 0], "material": "glass" },
            { "type": "quad", "size": 1.2, "emission": [4, 3, 2],
              "transform": [{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0.6, 2.5, 0] }] },
        ],
    })
}

fn shot(scene: &Value, integrator: &dyn Integrator, seed: u64, spp: u64) -> Image {
    let scene = Arc::new(built(&scene.to_string()).world);
    picture(scene, integrator, FilmSpec::new(EDGE, EDGE), SamplerSpec { kind: Kind::Independent, spp, seed, ..SamplerSpec::default() })
}

/// Paths that meet lamps through dispersive glass by chance, paths that sample them, and paths from them converge to the same pictures: of
/// frosted glass, also with bumps, whose normals paths from the lights look up again, and of the floor under clear glass. With its default
/// settings `card` has the picture of `path`.
#[test]
fn integrators_agree_on_dispersion() {
    let frosted = json!({ "type": "dielectric", "glass": "SF11", "roughness": 0.4 });
    let relief = json!({ "type": "noise", "scale": 8 });
    let bumpy = json!({ "type": "bumped", "surface": frosted, "bump_map": relief, "scale": 0.02 });
    let clear = json!({ "type": "dielectric", "eta": 1.6, "abbe": 10 });
    let level = sidak(0.01, 6);
    for (name, glass, shows_glass) in [("frosted", &frosted, true), ("bumpy", &bumpy, true), ("clear", &clear, false)] {
        let scene = cast_on_floor(glass, shows_glass);
        let by_samples = shot(&scene, &Nee::default(), 1, 1024);
        let by_chance = shot(&scene, &Path::default(), 2, 1024);
        assert_eq!(shot(&scene, &Card::default(), 2, 1024).pixels().collect::<Vec<_>>(), by_chance.pixels().collect::<Vec<_>>(), "{name}");
        for (other, image) in [("path", by_chance), ("light", shot(&scene, &LightTracer::default(), 3, 1024))] {
            let of = |image| SampledImage { image, samples: 1024 };
            let found = agreement(of(&image), of(&by_samples), level).expect("two pictures");
            assert!(found.accepts(), "{name}, {other} and nee: {found}");
        }
    }
}

/// Glass whose formula is the same at each wavelength gives the picture of plain glass in the mean; glass with dispersion does not.
#[test]
fn no_dispersion_is_plain_glass() {
    let plain = cast_on_floor(&json!({ "type": "dielectric", "eta": 1.6 }), true);
    let level = sidak(0.01, 3);
    let differ = |[a, b]: [&Image; 2]| {
        let of = |image| SampledImage { image, samples: 1024 };
        agreement(of(a), of(b), level).expect("two pictures")
    };
    let constant = cast_on_floor(&json!({ "type": "dielectric", "cauchy": [1.6, 0] }), true);
    for (name, integrator) in [("nee", &Nee::default() as &dyn Integrator), ("whitted", &Whitted::default())] {
        let [plain, constant] = [(&plain, 1), (&constant, 2)].map(|(scene, seed)| shot(scene, integrator, seed, 1024));
        let found = differ([&plain, &constant]);
        assert!(found.accepts(), "{name}: {found}");
    }
    let strong = cast_on_floor(&json!({ "type": "dielectric", "eta": 1.6, "abbe": 1 }), true);
    let found = differ([&shot(&plain, &Whitted::default(), 1, 1024), &shot(&strong, &Whitted::default(), 2, 1024)]);
    assert!(!found.accepts(), "glass with much dispersion: {found}");
}

/// Dispersive glass that no path meets changes no bit, although paths of such a scene have a wavelength to take.
#[test]
fn dispersive_glass_that_is_not_met_changes_no_bit() {
    let below = |glass: Value| {
        let mut scene = cast_on_floor(&glass, true);
        scene["shapes"][1]["center"] = json!([0, -2, 0]);
        scene
    };
    let [plain, dispersive] = [json!({ "type": "dielectric", "eta": 1.6 }), json!({ "type": "dielectric", "glass": "SF11" })].map(below);
    assert!(built(&dispersive.to_string()).world.effects().contains(Effects::DISPERSION));
    for (name, integrator) in [
        ("nee", &Nee::default() as &dyn Integrator),
        ("path", &Path::default()),
        ("whitted", &Whitted::default()),
        ("card", &Card::default()),
    ] {
        let [plain, dispersive] = [&plain, &dispersive].map(|scene| bits(&shot(scene, integrator, 1, 16)));
        assert!(plain == dispersive, "{name}");
    }
}

/// Descriptions of an index from more than one source, or of one that is no number for some visible light, are refused.
#[test]
fn impossible_glass_is_refused() {
    let refused = [
        (r#"{"type": "dielectric", "eta": 1.5, "glass": ^"BK7"}"#, "/materials/m/glass: give one of eta, glass, cauchy and sellmeier"),
        (r#"{"type": "dielectric", "cauchy": ^[1.5, 0.01], "eta": 1.5}"#, "/materials/m/cauchy: give one of"),
        (r#"{"type": "dielectric", "glass": "BK7", "abbe": ^50}"#, "/materials/m/abbe: an Abbe number belongs to eta"),
        (
            r#"{"type": "dielectric", "eta": {"from": 1.3, "to": 1.5, "by": 0.5}, "abbe": ^50}"#,
            "/materials/m/abbe: an Abbe number needs an eta that is one number",
        ),
        (r#"{"type": "dielectric", "abbe": ^-1}"#, "/materials/m/abbe: expected a number above 0, found -1"),
        (r#"{"type": "dielectric", "glass": ^"BK8"}"#, "/materials/m/glass: unknown name \"BK8\", did you mean \"BK7\"?"),
        (r#"{"type": "dielectric", "sellmeier": ^[]}"#, "/materials/m/sellmeier: expected from 1 to 6 pairs"),
        (r#"{"type": "dielectric", "sellmeier": ^[[1, 0.3]]}"#, "/materials/m/sellmeier: the index of refraction leaves the range"),
        (r#"{"type": "dielectric", "cauchy": ^[0.5, -0.3]}"#, "/materials/m/cauchy: the index of refraction leaves the range"),
        (r#"{"type": "dielectric", "abbe": ^0.0001}"#, "/materials/m/abbe: the index of refraction leaves the range"),
    ];
    let cases: Vec<(String, &str)> =
        refused.into_iter().map(|(material, message)| (format!(r#""materials": {{"m": {material}}}"#), message)).collect();
    assert_fault_in_scene(&cases.iter().map(|(scene, message)| (scene.as_str(), *message)).collect::<Vec<_>>());
}
