//! Metals by name, thin panes, coloured glass and brushed metal; and rough bodies in uniform light, with every integrator.

use glam::{DVec3, Vec2, Vec3};
use pt::bsdf::microfacet::Distribution;
use pt::bsdf::microfacet::roughness::{Alpha, Roughness, alpha};
use pt::bsdf::{Bsdf, Element, Lobe, Material, ThinDielectric, TransportMode, textured};
use pt::light::{Environment, Light};
use pt::math::fresnel::{conductor, dielectric};
use pt::math::{Local, Ray, Rgb, Spectrum, Transform};
use pt::medium::{Medium, Phase};
use pt::scene::Scene;
use pt::shape::{Disk, MeshData, Quad, Sphere, TriangleMesh};
use pt::world::World;

use crate::scenes::{Depth, Effort, KnownRadiance, at, confirm, gray, probe, stored};

/// The CIE 1931 observer by a method other than the library's table: a fit of a few bell curves with an error of 1 %.
///
/// Source: Wyman, Sloan, Shirley, *Simple Analytic Approximations to the CIE XYZ Color Matching Functions* (2013).
pub fn observer(wavelength: f64) -> [f64; 3] {
    let bell = |height: f64, middle: f64, left: f64, right: f64| {
        let t = (wavelength - middle) * if wavelength < middle { left } else { right };
        height * (-0.5 * t * t).exp()
    };
    let x = bell(0.362, 442.0, 0.0624, 0.0374) + bell(1.056, 599.8, 0.0264, 0.0323) - bell(0.065, 501.1, 0.0490, 0.0382);
    let y = bell(0.821, 568.8, 0.0213, 0.0247) + bell(0.286, 530.9, 0.0613, 0.0322);
    let z = bell(1.217, 437.0, 0.0845, 0.0278) + bell(0.681, 459.0, 0.0385, 0.0725);
    [x, y, z]
}

/// The illuminant D65 at every 20 nm from 380 to 700 (CIE 15, 2004).
const D65: [f64; 17] =
    [49.98, 82.75, 93.43, 104.87, 117.81, 115.92, 109.35, 104.79, 104.41, 100.0, 95.79, 90.01, 87.70, 83.70, 80.21, 78.28, 71.61];

pub fn daylight(wavelength: f64) -> f64 {
    let x = ((wavelength - 380.0) / 20.0).clamp(0.0, 15.999);
    let (k, part) = (x as usize, x.fract());
    D65[k] + (D65[k + 1] - D65[k]) * part
}

/// Published n and k of a metal, linearly interpolated between the tabulated wavelengths.
fn published(metal: Element, wavelength: f64) -> (f64, f64) {
    let table = metal.published();
    let after = table.iter().position(|row| row.0 > wavelength).unwrap_or(table.len() - 1).max(1);
    let (a, b) = (table[after - 1], table[after]);
    let part = ((wavelength - a.0) / (b.0 - a.0)).clamp(0.0, 1.0);
    (a.1 + part * (b.1 - a.1), a.2 + part * (b.2 - a.2))
}

/// A named metal has the colour at normal incidence that its published spectrum has under daylight: each coefficient agrees to 1 %. The fit
/// of the observer alone has an error of up to 0.3 %.
///
/// One coefficient, the red of gold, would be 1.04, outside of Rec. 709. The library uses the greatest reflectance of any wavelength for
/// it, 0.97.
#[test]
fn metals_have_the_colour_of_their_spectrum() {
    const RGB: [[f64; 3]; 3] = [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]];
    for metal in Element::ALL {
        let reflectance = |wavelength| {
            let (n, k) = published(metal, wavelength);
            ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k)
        };
        let (eta, k) = metal.index();
        let (eta, k) = (Spectrum::from_coefficients(eta), Spectrum::from_coefficients(k));
        let found = eta.zip_all(k, |eta, k| conductor(1.0, eta, k)).to_rgb();
        let greatest = (380..=700).map(|w| reflectance(f64::from(w))).fold(0.0, f64::max);
        for (c, row) in RGB.iter().enumerate() {
            let (mut sum, mut white) = (0.0, 0.0);
            for wavelength in (380..=700).map(f64::from) {
                let seen = observer(wavelength);
                let weight = daylight(wavelength) * (0..3).map(|i| row[i] * seen[i]).sum::<f64>();
                (sum, white) = (sum + weight * reflectance(wavelength), white + weight);
            }
            let exact = sum / white;
            let beyond = (metal, c) == (Element::Au, 0);
            assert_eq!(exact > greatest, beyond, "{metal:?}, coefficient {c}: {exact}, and at most {greatest}");
            let expected = if beyond { greatest } else { exact };
            assert!((f64::from(found[c]) / expected - 1.0).abs() < 0.01, "{metal:?}, coefficient {c}: {} but {expected}", found[c]);
        }
    }
}

/// A thin pane reflects the sum of all reflections between its two faces, and transmits the rest straight on.
#[test]
fn thin_plate() {
    for eta in [1.0f32, 1.33, 1.5, 2.42, 1.0 / 1.5] {
        for cos in [1.0f32, 0.7, 0.3, 0.01] {
            let wo = Local::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            let pane = Bsdf::ThinDielectric(ThinDielectric { eta, color: Spectrum::ONE });
            let once = f64::from(dielectric(cos, eta));
            let series: f64 = (0..10_000).map(|n| (1.0 - once) * (1.0 - once) * once.powi(2 * n + 1)).sum();
            let mut shares = [0.0, 0.0];
            for side in [wo, Local(-wo.0)] {
                for lobe in pane.delta_lobes(side, TransportMode::Radiance) {
                    shares[usize::from(lobe.lobe == Lobe::Transmission)] = f64::from(lobe.weight.average());
                    assert!(lobe.lobe == Lobe::Reflection || (lobe.wi.0 == -side.0 && lobe.eta == 1.0));
                }
                let expected = once + if once < 1.0 { series } else { 0.0 };
                assert!((shares[0] - expected).abs() < 2e-6, "{shares:?} but {expected}: η = {eta}, cos {cos}");
                assert!((shares[0] + shares[1] - 1.0).abs() < 2e-7);
            }
        }
    }
}

/// A ball of radius 1 in uniform light of radiance 1, seen from outside through its middle.
fn in_white_light(name: String, material: Material, radiance: f64) -> KnownRadiance {
    ball_in_white_light(name, 4.0, material, None, radiance)
}

/// A ball of radius 1 in uniform light of radiance 1, seen along a line through its middle.
///
/// - `distance`: of the camera from the middle (m)
/// - `medium`: what fills the ball
fn ball_in_white_light(name: String, distance: f64, material: Material, medium: Option<Medium>, radiance: f64) -> KnownRadiance {
    let mut world = World::builder(probe(DVec3::Z * distance, DVec3::Z * (distance - 1.0)));
    let material = world.material(material);
    world.shape(Sphere { radius: 1.0 }, at(DVec3::ZERO), material, None);
    if let Some(medium) = medium {
        let medium = world.medium(medium);
        world.fill(medium);
    }
    world.light(Light::Environment(Environment { radiance: Rgb::WHITE }));
    KnownRadiance::new(name, world, radiance, Depth { max: 1000, roulette: 8 })
}

/// A ball of glass with the transmittance A along its diameter has L = R + (1 − R)² A / (1 − R A), including inner reflections, and seen from
/// its middle √A η² (1 − R) / (1 − R A), whether the glass absorbs or a medium in it.
#[test]
fn glass_absorbs_along_the_path() {
    let rows = |(eta, left): (f32, f64)| {
        let absorption = gray(-left.ln() / 2.0);
        let clear = || textured::Dielectric::smooth(eta, Rgb::WHITE);
        let tinted = || Material::from(clear().absorbing(stored(absorption)));
        let medium = || Some(Medium::new(absorption, Spectrum::BLACK, Phase::Isotropic));
        let r = f64::from(dielectric(1.0, eta));
        let outside = r + (1.0 - r) * (1.0 - r) * left / (1.0 - r * left);
        let inside = left.sqrt() * f64::from(eta).powi(2) * (1.0 - r) / (1.0 - r * left);
        let name = |how: &str| format!("glass {eta} that leaves {left}, {how}");
        let mut known = vec![
            ball_in_white_light(name("seen from outside"), 4.0, tinted(), None, outside),
            ball_in_white_light(name("seen from its middle"), 0.0, tinted(), None, inside),
        ];
        if (eta, left) == (1.5, 0.5) {
            known.push(ball_in_white_light(name("by a medium, seen from outside"), 4.0, clear().into(), medium(), outside));
            known.push(ball_in_white_light(name("by a medium, seen from its middle"), 0.0, clear().into(), medium(), inside));
        }
        known.into_iter().map(|known| known.resolution(1e-3, 2e-3))
    };
    confirm([(1.0, 0.5), (1.5, 0.5), (1.5, 0.05), (2.42, 0.9)].into_iter().flat_map(rows).collect(), Effort::Standard);
}

fn round(alpha: f32, distribution: Distribution) -> Roughness {
    Roughness { alpha: Alpha::Constant(Vec2::splat(alpha)), distribution }
}

/// White metal and clear frosted glass have the radiance of the uniform light around them. This tests whole paths, on which radiance is
/// scaled by η² on the way in and scaled back on the way out. The tolerance is the error of the tables.
#[test]
fn rough_bodies_are_invisible_in_uniform_light() {
    let white = |alpha, distribution| {
        let metal = Material::metal((Rgb::WHITE, Rgb::gray(1e4)), Some(round(alpha, distribution)), true);
        in_white_light(format!("metal {alpha} {distribution:?}"), metal, 1.0).resolution(2e-3, 4e-3)
    };
    let clear = |eta, alpha, distribution| {
        let glass = Material::rough_glass(eta, Rgb::WHITE, round(alpha, distribution), true);
        in_white_light(format!("glass {eta} {alpha} {distribution:?}"), glass, 1.0).resolution(3e-3, 6e-3).by_chance(6e-3)
    };
    let laws = vec![
        white(0.1, Distribution::Ggx),
        white(0.8, Distribution::Beckmann),
        clear(1.5, 0.05, Distribution::Ggx),
        clear(1.5, 0.5, Distribution::Beckmann),
        clear(1.0 / 1.33, 0.3, Distribution::Ggx),
    ];
    confirm(laws, Effort::Standard);
}

/// The grain of brushed metal runs along the first texture coordinate, for shapes of any orientation.
#[test]
fn anisotropy_follows_the_texture_coordinates() {
    let roughness = Roughness { alpha: Alpha::Constant(alpha(0.5, 0.8)), distribution: Distribution::Ggx };
    let (eta, k) = Element::Fe.index();
    let brushed = || Material::metal((eta, k), Some(roughness.clone()), false);
    let turn = Transform::rotate(DVec3::Z, 30.0).expect("an axis");
    let x = Vec3::new(0.75f32.sqrt(), 0.5, 0.0);
    let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| Vec3::new(x - 0.3, y - 0.3, 0.0));
    let flipped = MeshData {
        positions: corners.into(),
        // u grows along +y, v along −x.
        uvs: corners.map(|p| Vec2::new(p.y, -p.x)).into(),
        triangles: vec![[0, 1, 2]],
        ..MeshData::default()
    };
    let plain = MeshData { positions: corners.into(), triangles: vec![[0, 1, 2]], ..MeshData::default() };
    let look = |world: pt::world::WorldBuilder| {
        let world = world.build().expect("sound");
        let ray = Ray::new((DVec3::new(0.05, 0.05, 5.0) - world.origin()).as_vec3(), -Vec3::Z);
        let hit = world.intersect(&ray).expect("it is there");
        world.surface(&ray, &hit).frame
    };
    let seen = |add: &dyn Fn(&mut pt::world::WorldBuilder, pt::bsdf::MaterialId)| {
        let mut world = World::builder(probe(DVec3::Z, DVec3::ZERO));
        let material = world.material(brushed());
        add(&mut world, material);
        look(world)
    };
    let frames = [
        (seen(&|world, material| world.shape(Quad { size: [2.0, 3.0] }, turn, material, None)), x),
        (seen(&|world, material| world.shape(Disk { radius: 1.0 }, turn, material, None)), x),
        (seen(&|world, material| world.shape(TriangleMesh::new(plain.clone()), turn, material, None)), x),
        (seen(&|world, material| world.shape(TriangleMesh::new(flipped.clone()), turn, material, None)), Vec3::Z.cross(x)),
    ];
    for (frame, grain) in frames {
        assert!((frame.x - grain).length() < 1e-6 && frame.z == Vec3::Z, "{frame:?} but {grain}");
    }
    // On a sphere, circles of latitude about its z axis.
    let standing = Transform::rotate(DVec3::X, -90.0).expect("an axis");
    let frame = seen(&|world, material| world.shape(Sphere { radius: 1.0 }, standing, material, None));
    assert!(frame.x.y.abs() < 1e-6 && (frame.x.length() - 1.0).abs() < 1e-6 && frame.x.dot(frame.z).abs() < 1e-6, "{frame:?}");
}

/// The parameters that users set: α = r², and an anisotropy of 1 makes highlights ten times as long as wide.
#[test]
fn roughness_is_the_root_of_alpha() {
    assert_eq!(alpha(0.5, 0.0), Vec2::splat(0.25));
    let stretched = alpha(0.5, 1.0);
    assert!((stretched.x / stretched.y - 10.0).abs() < 1e-4 && (stretched.x * stretched.y - 0.0625).abs() < 1e-6);
}

/// A BSDF is plain data that is written at every hit, so it is small: ten words, one of them the colour of a mesh's vertices. Large data is
/// referenced.
#[test]
fn a_model_at_a_point_is_small() {
    assert!(size_of::<Bsdf>() <= 80, "{}", size_of::<Bsdf>());
}
