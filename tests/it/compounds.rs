//! Materials made of other materials, normal and bump maps, and holes: each compared with the formula for its parts.

use std::f32::consts::FRAC_1_PI;
use std::sync::Arc;

use glam::{DVec3, UVec2, Vec2, Vec3};
use proptest::prelude::*;
use pt::bsdf::microfacet::Distribution;
use pt::bsdf::microfacet::roughness::{Alpha, Roughness};
use pt::bsdf::{
    Bsdf, BsdfSample, Coat, Coated, Compound, Diffuse, Element, FilmLayer, HitContext, Material, Metallic, Mirror, Mix, NormalModifier,
    Plastic, Principled, Share, Sheen, SurfaceMaterial, TransportMode, TwoSided, textured,
};
use pt::camera::Camera;
use pt::light::Emitter;
use pt::math::fresnel::dielectric;
use pt::math::{Local, Ray, Rgb, Spectrum, Transform};
use pt::proof::at;
use pt::proof::strategies::{color, fraction, sphere};
use pt::scene::{Scene, Surface};
use pt::shape::{MeshData, Quad, Sphere, SurfacePoint, TriangleMesh, VertexColor};
use pt::texture::image::{Filter, Pixels, Wrap};
use pt::texture::{Checker, Image, Space, Texture};
use pt::world::World;

use crate::random::{Random, cases};
use crate::scenes::probe;
use crate::scenes::stored;

const MODE: TransportMode = TransportMode::Radiance;

fn eye() -> Camera {
    probe(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO)
}

fn point(uv: Vec2) -> SurfacePoint {
    SurfacePoint { p: Vec3::ZERO, offset: 0.0, ng: Vec3::Z, ns: Vec3::Z, uv, color: VertexColor::WHITE }
}

fn center(material: &Material) -> Bsdf<'_> {
    material.bsdf_at(&HitContext::from_outside(point(Vec2::ZERO)))
}

fn round(alpha: f32) -> Roughness {
    Roughness { alpha: Alpha::Constant(Vec2::splat(alpha)), distribution: Distribution::Ggx }
}

fn coated(base: Material, coat: Coat) -> Material {
    Compound::Coated(Coated { base, coat }).into()
}

fn near(a: Spectrum, b: Spectrum, relative: f32) -> bool {
    a.zip(b, |a, b| f32::from(u8::from((a - b).abs() > relative * (a.abs() + b.abs()) + f32::MIN_POSITIVE))).is_black()
}

/// ∫ f·|cos| dwi over the side of `wo`, and its delta lobes, by the midpoint rule in the square of the sine, which is exact for
/// Lambert.
pub fn albedo(model: &Bsdf, wo: Local) -> Spectrum {
    const N: usize = 128;
    let smooth: Spectrum = (0..N * N)
        .map(|k| {
            let (i, j) = ((k / N) as f64 + 0.5, (k % N) as f64 + 0.5);
            let wi = at((1.0 - i / N as f64).sqrt(), std::f64::consts::TAU * j / N as f64);
            model.eval(wo, wi, MODE) / (wi.cos() * FRAC_1_PI)
        })
        .sum();
    smooth * (1.0 / (N * N) as f32) + model.delta_lobes(wo, MODE).map(|lobe| lobe.weight).sum()
}

proptest! {
    #![proptest_config(cases(10_000))]

    /// f = (1 − t) f_a + t f_b, and the same for the density.
    #[test]
    fn mixes_are_sums(a in color(), b in color(), t in fraction(), alpha in prop::sample::select(vec![0.1f32, 0.3, 1.0]), wo in sphere(), wi in sphere()) {
        // The share is rounded like a texture value, because 1 − t may be small.
        let t = Spectrum::gray(t).average();
        let (first, second) = (Material::diffuse(stored(a)), Material::metal(Texture::from(stored(b)), Some(round(alpha)), true));
        let mix = Material::from(Compound::Mix(Mix { a: first.clone(), b: second.clone(), share: Share::Texture(t.into()) }));
        let (mix, first, second) = (center(&mix), center(&first), center(&second));
        let sum = first.eval(wo, wi, MODE) * (1.0 - t) + second.eval(wo, wi, MODE) * t;
        prop_assert!(near(mix.eval(wo, wi, MODE), sum, 1e-5));
        let density = first.pdf(wo, wi).get() * (1.0 - t) + second.pdf(wo, wi).get() * t;
        prop_assert!((mix.pdf(wo, wi).get() - density).abs() <= 1e-5 * density);
    }

    /// Delta lobes of a mix are the weighted sums of its parts: where glass and a mirror share a direction, the weights are added up.
    #[test]
    fn mixed_lobes_are_sums(a in color(), b in color(), t in fraction(), wo in sphere()) {
        // The share is rounded like a texture value, because 1 − t may be small.
        let t = Spectrum::gray(t).average();
        let (first, second) = (Material::from(textured::Dielectric::smooth(1.5, stored(a))), Material::mirror(stored(b)));
        let mix = Material::from(Compound::Mix(Mix { a: first.clone(), b: second.clone(), share: Share::Texture(t.into()) }));
        let lobes = |material: &Material| center(material).delta_lobes(wo, MODE).collect::<Vec<_>>();
        let parts = [(lobes(&first), 1.0 - t), (lobes(&second), t)];
        for lobe in lobes(&mix) {
            let share = |(lobes, share): &(Vec<BsdfSample>, f32)| {
                lobes.iter().filter(|part| part.wi == lobe.wi).map(|part| part.weight * *share).sum::<Spectrum>()
            };
            prop_assert!(near(lobe.weight, parts.iter().map(share).sum(), 1e-5), "{lobe:?}");
        }
        let total = |lobes: &[BsdfSample]| lobes.iter().map(|lobe| lobe.weight).sum::<Spectrum>();
        let sum = parts.iter().map(|(lobes, share)| total(lobes) * *share).sum();
        prop_assert!(near(total(&lobes(&mix)), sum, 1e-5));
    }

    /// A mix by Fresnel's reflectance is f = (1 − max(F(θo), F(θi))) f_a + min(F(θo), F(θi)) f_b.
    #[test]
    fn fresnel_mixes_are_sums(a in color(), b in color(), eta in 1f32..3.0, wo in sphere(), wi in sphere()) {
        let (first, second) = (Material::diffuse(stored(a)), Material::metal(Texture::from(stored(b)), Some(round(0.3)), true));
        let mix = Material::from(Compound::Mix(Mix { a: first.clone(), b: second.clone(), share: Share::Fresnel { eta: eta.into() } }));
        let [o, i] = [wo, wi].map(|w| dielectric(w.abs_cos(), eta));
        let sum = center(&first).eval(wo, wi, MODE) * (1.0 - o.max(i)) + center(&second).eval(wo, wi, MODE) * o.min(i);
        prop_assert!(near(center(&mix).eval(wo, wi, MODE), sum, 1e-5));
    }

    /// A smooth coat over a Lambertian base equals `plastic`, including its delta lobes.
    #[test]
    fn a_coat_over_matte_is_plastic(albedo in color(), eta in 1f32..3.0, wo in sphere(), wi in sphere()) {
        let coat = coated(Material::diffuse(stored(albedo)), Coat::new(eta, Rgb::WHITE, None));
        let plastic = Bsdf::Plastic(Plastic { albedo, eta, internal: Plastic::internal(eta) });
        let coat = center(&coat);
        prop_assert!(near(coat.eval(wo, wi, MODE), plastic.eval(wo, wi, MODE), 2e-5));
        let lobes = |model: &Bsdf| model.delta_lobes(wo, MODE).map(|lobe| (lobe.wi, lobe.lobe)).collect::<Vec<_>>();
        prop_assert_eq!(lobes(&coat), lobes(&plastic));
        let weight = |model: &Bsdf| model.delta_lobes(wo, MODE).map(|lobe| lobe.weight).sum::<Spectrum>();
        prop_assert_eq!(weight(&coat), weight(&plastic));
    }

    /// Each side of the surface behaves as its own material, and no light is transmitted.
    #[test]
    fn two_sided_materials_keep_their_sides_apart(front in color(), back in color(), wo in sphere(), wi in sphere()) {
        let sides = Compound::TwoSided(TwoSided { front: Some(Material::diffuse(stored(front))), back: Some(Material::diffuse(stored(back))) });
        let sides = Material::from(sides);
        let expected = Bsdf::Diffuse(Diffuse { albedo: if wo.cos() > 0.0 { front } else { back } });
        prop_assert_eq!(center(&sides).eval(wo, wi, MODE), expected.eval(wo, wi, MODE));
        prop_assert_eq!(center(&sides).pdf(wo, wi), expected.pdf(wo, wi));
    }
}

/// Importance is radiance with the directions exchanged, with geometric normals: f*(wo, wi) / |ng·wi| = f(wi, wo) / |ng·wo| for a
/// reciprocal model, whatever the shading normal.
#[test]
fn importance_is_adjoint() {
    let mut random = Random::new(13);
    let mut direction = |least: f64| at(random.range(least, 1.0), random.range(0.0, 6.3)).0;
    for _ in 0..10_000 {
        let (ns, a, b) = (direction(0.7), direction(0.05), direction(0.05));
        let surface = Surface::new(SurfacePoint { ns, ..point(Vec2::ZERO) }, Bsdf::Diffuse(Diffuse { albedo: Spectrum::ONE }), None);
        let forward = surface.eval(a, b, TransportMode::Importance).average() / b.z;
        let backward = surface.eval(b, a, TransportMode::Radiance).average() / a.z;
        assert!((forward - backward).abs() <= 1e-5 * forward.max(backward), "{forward} {backward}");
    }
}

/// A white base under a clear coat, smooth or rough, returns all light: the light that does not pass the coat is reflected by it.
///
/// The quadrature and the tables of the coat each have an error of 1e-3 for these widths.
#[test]
fn coated_white_is_white() {
    let white = || Material::diffuse(Rgb::WHITE);
    for eta in [1.2, 1.5, 2.4] {
        for roughness in [None, Some(round(0.25)), Some(round(0.6)), Some(round(1.0))] {
            for cos in [1.0, 0.7, 0.3] {
                let material = coated(white(), Coat::new(eta, Rgb::WHITE, roughness.clone()));
                let found = albedo(&center(&material), at(cos, 0.4)).average();
                assert!((found - 1.0).abs() < 2e-3, "eta {eta}, {roughness:?}, cos {cos}: {found}");
            }
        }
    }
}

/// A white coated surface is white at grazing angles too, and under a coat that is almost smooth, where its reflectance varies fast. This
/// is checked by sampling. The mean of 10⁵ weights is known to 5e-4; the table is good to 3e-3.
#[test]
fn coated_white_is_white_along_the_surface() {
    const SAMPLES: u32 = 100_000;
    let mut random = Random::new(31);
    for eta in [1.05, 1.5, 3.0] {
        for alpha in [1e-6, 1e-4, 1e-2, 0.05, 0.25] {
            let material = coated(Material::diffuse(Rgb::WHITE), Coat::new(eta, Rgb::WHITE, Some(round(alpha))));
            let model = center(&material);
            for cos in [0.3, 0.05, 0.0087, 1e-3] {
                let wo = at(cos, 0.4);
                let mut weight = |_| {
                    let sample = model.sample(wo, random.unit() as f32, random.uniform_square(), MODE);
                    f64::from(sample.map_or(0.0, |sample| sample.weight.average()))
                };
                let found = (0..SAMPLES).map(&mut weight).sum::<f64>() / f64::from(SAMPLES);
                assert!((found - 1.0).abs() < 5e-3, "eta {eta}, alpha {alpha}, cos {cos}: {found}");
            }
        }
    }
}

/// Material under sheen of a gray colour.
fn velvet(base: Material, color: f32, roughness: f32) -> Material {
    Compound::Sheen(Sheen::new(base, color, roughness)).into()
}

/// A principled material in which everything is white, with facets of width `alpha`.
fn white(alpha: f32) -> Principled {
    Principled {
        base_color: 1.0.into(),
        metallic: 0.0.into(),
        transmission: 0.0.into(),
        specular: 1.0.into(),
        roughness: Some(round(alpha)),
        eta: 1.5.into(),
        coat: 0.0.into(),
        coat_eta: 1.5.into(),
        coat_color: 1.0.into(),
        coat_roughness: None,
        sheen_color: 0.0.into(),
        sheen_roughness: 0.5.into(),
        iridescence: 0.0.into(),
        film: FilmLayer { eta: 1.3, thickness: 400.0.into() },
        multiscatter: true,
    }
}

/// The largest and the smallest 1 − albedo, for light from straight above to nearly along the surface. A negative value is a gain of light.
fn extremes(material: &Material) -> [f32; 2] {
    let albedos = [1.0, 0.7, 0.3, 0.1].map(|cos| albedo(&center(material), at(cos, 0.4)));
    // What the colours lose on average, and what one of them gains.
    [
        albedos.iter().fold(0.0, |most, albedo| (1.0 - albedo.average()).max(most)),
        albedos.iter().fold(0.0, |least, albedo| (1.0 - albedo.max()).min(least)),
    ]
}

/// Layers on a white matte base, and on a white mirror, return all light. Over other bases the loss is at most the documented one, and at
/// least 7 tenths of that. No material gains light.
///
/// The tables and the quadrature have an error of 2e-3. For three layers with tables of their own, and for the narrow lobes of straight
/// fibres, it is 3e-3.
#[test]
fn layers_on_white_are_white() {
    const TABLES: f32 = 2e-3;
    let matte = || Material::diffuse(Rgb::WHITE);
    let mirror = || Material::mirror(Rgb::WHITE);
    let clay = || Material::OrenNayar(textured::OrenNayar { albedo: 1.0.into(), roughness: 1.0.into() });
    let metal = |alpha: f32| Material::metal(Texture::from(Rgb::WHITE), Some(round(alpha)), true);
    let coat = |eta: f32, alpha: f32| Coat::new(eta, Rgb::WHITE, (alpha > 0.0).then(|| round(alpha)));
    let paper = || Material::DiffuseTransmission(textured::DiffuseTransmission { reflectance: 1.0.into(), transmittance: 0.0.into() });
    let with_coat = || Principled { coat: 1.0.into(), ..white(0.25) };
    let rough_coat = || Principled { coat_roughness: Some(round(0.3)), ..with_coat() };
    let with_both = Principled { sheen_color: 1.0.into(), ..with_coat() };
    let filmed = |eta: f32, thickness: f32, alpha: f32| {
        let film = FilmLayer { eta, thickness: thickness.into() };
        Principled { iridescence: 1.0.into(), film, roughness: (alpha > 0.0).then(|| round(alpha)), ..white(0.25) }
    };
    let cases: [(&str, Material, f32); 31] = [
        ("sheen over matte", velvet(matte(), 1.0, 0.5), TABLES),
        ("straight fibres over matte", velvet(matte(), 1.0, 0.2), 3e-3),
        ("fibres that lie, over matte", velvet(matte(), 1.0, 1.0), TABLES),
        ("sheen over a mirror", velvet(mirror(), 1.0, 0.5), TABLES),
        ("two coats over matte", coated(coated(matte(), coat(1.3, 0.0)), coat(1.6, 0.0)), TABLES),
        ("three", coated(coated(coated(matte(), coat(1.3, 0.4)), coat(2.4, 0.0)), coat(1.5, 0.6)), 3e-3),
        ("two coats over a mirror", coated(coated(mirror(), coat(1.3, 0.0)), coat(1.6, 0.0)), TABLES),
        ("coat over plastic", coated(Material::plastic(Rgb::WHITE, 1.4), coat(1.5, 0.0)), TABLES),
        ("coat over a mix", coated(Material::mix(matte(), Material::plastic(Rgb::WHITE, 1.4), 0.5), coat(1.5, 0.4)), TABLES),
        ("coat over paper", coated(paper(), coat(1.5, 0.0)), TABLES),
        ("principled", white(0.25).into(), TABLES),
        ("principled, rough coat", rough_coat().into(), TABLES),
        ("principled, dull, rough coat", Principled { roughness: Some(round(1.0)), ..rough_coat() }.into(), TABLES),
        ("principled, coat", with_coat().into(), 0.007),
        ("principled, half a coat", Principled { coat: 0.5.into(), ..with_coat() }.into(), 0.0035),
        ("principled, sheen", Principled { sheen_color: 1.0.into(), ..white(0.25) }.into(), 0.006),
        ("principled, both", with_both.into(), 0.026),
        ("principled, film of water", filmed(1.3, 400.0, 0.25).into(), 0.05),
        ("principled, thin film of water", filmed(1.3, 150.0, 0.0).into(), 0.095),
        ("principled, film of an oxide", filmed(2.0, 400.0, 0.25).into(), 0.06),
        ("principled, saturated film of an oxide", filmed(2.0, 377.0, 0.0).into(), 0.1),
        ("principled, thin film of an oxide", filmed(2.0, 10.0, 0.0).into(), 0.17),
        ("principled, film of diamond", filmed(4.0, 190.0, 0.0).into(), 0.2),
        ("sheen over coat over matte", velvet(coated(matte(), coat(1.5, 0.3)), 1.0, 0.4), 0.006),
        ("coat over clay", coated(clay(), coat(1.5, 0.0)), 0.05),
        ("sheen over clay", velvet(clay(), 1.0, 0.5), 0.13),
        ("coat over polished metal", coated(metal(0.09), coat(1.5, 0.0)), 0.06),
        ("coat over dull metal", coated(metal(0.25), coat(1.5, 0.0)), 0.05),
        ("coat over rough metal", coated(metal(1.0), coat(1.5, 0.0)), 0.05),
        ("sheen over dull metal", velvet(metal(0.25), 1.0, 0.5), 0.08),
        ("sheen over rough metal", velvet(metal(1.0), 1.0, 0.5), 0.13),
    ];
    let is_right = |[lost, made]: [f32; 2], most: f32| made > -TABLES && lost < most && (most < 3.1e-3 || lost > 0.7 * most);
    let found = cases.iter().map(|(name, material, most)| (name, extremes(material), *most));
    let wrong: Vec<String> = found
        .filter(|(_, extremes, most)| !is_right(*extremes, *most))
        .map(|(name, [lost, made], most)| format!("{name}: loses {lost}, at most {most}; makes {}", -made))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Colours are deeper under a coat: the share ρ (1 − K)/(1 − ρ K) of the light that enters comes out again, where K is the internal
/// reflectance of the coat for diffuse light.
#[test]
fn coats_deepen_colors() {
    let (eta, rho) = (1.5f32, 0.5f32);
    let internal = Plastic::internal(eta);
    let deep = rho * (1.0 - internal) / (1.0 - rho * internal);
    let wo = at(0.8, 0.0);
    let coat = || Coat::new(eta, Rgb::WHITE, None);
    let shares = [(coat(), deep), (coat().keep_base_color(), rho)].map(|(coat, expected)| {
        let material = coated(Material::diffuse(Rgb::gray(rho)), coat);
        let model = center(&material);
        let reflected: Spectrum = model.delta_lobes(wo, MODE).map(|lobe| lobe.weight).sum();
        ((albedo(&model, wo) - reflected).average() / (1.0 - reflected.average()), expected)
    });
    for (found, expected) in shares {
        assert!((found - expected).abs() < 1e-3, "{found}, expected {expected}");
    }
    assert!(deep < 0.3, "{deep}");
}

/// The tabulated albedo E of the fibres is correct: a white mirror under them loses exactly the light that they reflect.
#[test]
fn sheen_reflects_its_tabulated_albedo() {
    for roughness in [0.22, 0.45, 0.77, 1.0] {
        let sheen = Material::from(Compound::Sheen(Sheen::new(Material::mirror(Rgb::WHITE), Rgb::WHITE, roughness)));
        for cos in [1.0, 0.6, 0.25] {
            let found = albedo(&center(&sheen), at(cos, 0.0)).average();
            assert!((found - 1.0).abs() < 5e-3, "roughness {roughness}, cos {cos}: {found}");
        }
    }
}

/// A parameter of 0 or 1 gives the material that the parameter names, and values between give a mix.
#[test]
fn principled_extremes_are_the_named_materials() {
    let (base, tint) = (Spectrum::rgb(0.9, 0.5, 0.2), Spectrum::rgb(0.3, 0.8, 0.9));
    let principled = || Principled {
        base_color: stored(base).into(),
        metallic: 0.0.into(),
        transmission: 0.0.into(),
        specular: 1.0.into(),
        roughness: Some(round(0.3)),
        eta: 1.4.into(),
        coat: 0.0.into(),
        coat_eta: 1.7.into(),
        coat_color: stored(tint).into(),
        coat_roughness: Some(round(0.1)),
        sheen_color: 0.0.into(),
        sheen_roughness: 0.55.into(),
        iridescence: 0.0.into(),
        film: FilmLayer { eta: 1.3, thickness: 400.0.into() },
        multiscatter: true,
    };
    let matte = || Material::diffuse(stored(base));
    let plastic = || coated(matte(), Coat::new(1.4, Rgb::WHITE, Some(round(0.3))).keep_base_color());
    let metal = |multiscatter| Material::metal(Texture::from(stored(base)), Some(round(0.3)), multiscatter);
    let glass = |multiscatter| Material::rough_glass(1.4, stored(base), round(0.3), multiscatter);
    let velvet = |ground| Material::from(Compound::Sheen(Sheen::new(ground, stored(tint), 0.55)));
    let lacquer = || Coat::new(1.7, stored(tint), Some(round(0.1)));
    let blend = Material::mix(Material::mix(Material::mix(matte(), plastic(), 0.7), glass(true), 0.4), metal(true), 0.3);
    let (metallic, clear) = (Principled { metallic: 1.0.into(), ..principled() }, Principled { transmission: 1.0.into(), ..principled() });
    let film = || FilmLayer { eta: 1.3, thickness: 400.0.into() };
    let filmed_plastic = || coated(matte(), Coat::under_film(1.4, Rgb::WHITE, Some(round(0.3)), Some(film())).keep_base_color());
    let filmed_metal = || Material::metal(Metallic::from(Texture::from(stored(base))).under_film(film()), Some(round(0.3)), true);
    let filmed_glass = || textured::Dielectric::new(1.4, stored(base), Some(round(0.3)), false).under_film(film()).into();
    let cases: [(Principled, Material); 16] = [
        (Principled { iridescence: 1.0.into(), ..principled() }, filmed_plastic()),
        (Principled { iridescence: 0.5.into(), ..principled() }, Material::mix(plastic(), filmed_plastic(), 0.5)),
        (Principled { iridescence: 1.0.into(), ..metallic.clone() }, filmed_metal()),
        (Principled { iridescence: 1.0.into(), ..clear.clone() }, filmed_glass()),
        (Principled { iridescence: 0.5.into(), ..clear.clone() }, Material::mix(glass(true), filmed_glass(), 0.5)),
        (principled(), plastic()),
        (Principled { specular: 0.0.into(), ..principled() }, matte()),
        (metallic.clone(), metal(true)),
        (Principled { transmission: 1.0.into(), ..metallic.clone() }, metal(true)),
        (Principled { multiscatter: false, ..metallic }, metal(false)),
        (clear.clone(), glass(true)),
        (Principled { multiscatter: false, ..clear.clone() }, glass(false)),
        (Principled { roughness: None, ..clear }, Material::from(textured::Dielectric::smooth(1.4, stored(base)))),
        (Principled { metallic: 0.3.into(), transmission: 0.4.into(), specular: 0.7.into(), ..principled() }, blend),
        (Principled { sheen_color: stored(tint).into(), ..principled() }, velvet(plastic())),
        (
            Principled { coat: 0.6.into(), sheen_color: stored(tint).into(), ..principled() },
            Material::mix(velvet(plastic()), coated(velvet(plastic()), lacquer()), 0.6),
        ),
    ];
    let mut random = Random::new(5);
    for (principled, expected) in cases {
        let material = Material::from(principled);
        assert_eq!(material, expected);
        let (wo, wi) = (at(random.range(0.1, 1.0), random.range(0.0, 6.0)), at(random.range(0.1, 1.0), random.range(0.0, 6.0)));
        assert_eq!(center(&material).eval(wo, wi, MODE), center(&expected).eval(wo, wi, MODE));
    }
    // At normal incidence metal has its base colour.
    let metal = Material::from(Principled { metallic: 1.0.into(), roughness: None, ..principled() });
    let lobe = center(&metal).sample(Local::NORMAL, 0.5, Vec2::splat(0.5), MODE).expect("a mirror");
    assert_eq!(lobe.weight, base);
}

/// A texture as the share of a mix applies point by point. Where it is 0 or 1, only one material is left.
#[test]
fn a_texture_controls_a_mix() {
    let squares = Checker { even: 0.0.into(), odd: 1.0.into(), scale: Vec3::ONE, space: Space::Uv };
    let share = Texture::Checker(Box::new(squares));
    let material = Material::mix(Material::diffuse(Rgb::WHITE), Material::mirror(Rgb::WHITE), share);
    assert_eq!(material.bsdf_at(&HitContext::from_outside(point(Vec2::new(0.5, 0.5)))), Bsdf::Diffuse(Diffuse { albedo: Spectrum::ONE }));
    assert_eq!(material.bsdf_at(&HitContext::from_outside(point(Vec2::new(1.5, 0.5)))), Bsdf::Mirror(Mirror { color: Spectrum::ONE }));
}

/// A picture whose bilinear interpolation is `low` + (`high` − `low`) · u near the middle, the same for all v.
pub fn ramp(low: f32, high: f32) -> Texture {
    let pixels = Pixels::new(UVec2::new(2, 1), vec![[low; 3], [high; 3]]).expect("two pixels");
    // Pixel centres lie at 1/4 and 3/4: half of the range is between them.
    Texture::Image(Image { pixels: Arc::new(pixels), pyramid: None, scale: Vec2::ONE, wrap: Wrap::Clamp, filter: Filter::Bilinear })
}

/// A quad in the plane z = 0 with corners ±1, seen from above.
fn quad(material: impl Into<SurfaceMaterial>, to_world: Transform) -> World {
    let mut world = World::builder(eye());
    let material = world.material(material);
    world.shape(Quad { size: [2.0; 2] }, to_world, material, None);
    world.build().expect("a quad")
}

fn seen(world: &World, direction: Vec3) -> Vec3 {
    let ray = Ray::new(-5.0 * direction - world.origin().as_vec3(), direction);
    let hit = world.intersect(&ray).expect("the quad");
    world.surface(&ray, &hit).frame.z
}

/// A bump map with a constant slope is a tilted plane: dz/dx = s gives n ∝ (−s, 0, 1).
#[test]
fn a_constant_slope_of_a_bump_map_tilts_the_normal() {
    // The slope between the pixels of the ramp is twice as large: it rises from 0 to 1 over half of the two metres.
    for scale in [0.1f32, -0.3, 1.0] {
        let normal_modifier = NormalModifier::BumpMap { map: ramp(0.0, 1.0), scale: scale.into() };
        let world =
            quad(SurfaceMaterial { normal_modifier: Some(normal_modifier), ..Material::diffuse(Rgb::WHITE).into() }, Transform::IDENTITY);
        let normal = seen(&world, Vec3::NEG_Z);
        let expected = Vec3::new(-scale, 0.0, 1.0).normalize();
        assert!((normal - expected).length() < 1e-3, "{normal} {expected}");
    }
}

/// Steep slopes tilt the normal as far as the viewer allows. The normal does not become flat again.
#[test]
fn steep_bump_maps_tilt_the_normal_up_to_the_limit() {
    for scale in [1e4f32, 1e18, 1e30, 3e38, -1e30] {
        let normal_modifier = NormalModifier::BumpMap { map: ramp(0.0, 1.0), scale: scale.into() };
        let world =
            quad(SurfaceMaterial { normal_modifier: Some(normal_modifier), ..Material::diffuse(Rgb::WHITE).into() }, Transform::IDENTITY);
        let normal = seen(&world, Vec3::NEG_Z);
        assert!((normal - Vec3::new(-scale.signum(), 0.0, 0.0)).length() < 0.02, "{scale}: {normal}");
    }
}

/// A normal map of a single normal tilts every surface along the surface's own axes, for any orientation. (½, ½, 1) changes nothing.
#[test]
fn normal_maps_turn_normals() {
    let n = Vec3::new(0.36, 0.48, 0.8);
    let constant = |n: Vec3| {
        let [r, g, b] = (0.5 * n + 0.5).to_array();
        Texture::Constant(Rgb::new(r, g, b))
    };
    let material = |n: Vec3| SurfaceMaterial {
        normal_modifier: Some(NormalModifier::NormalMap { map: constant(n), strength: 1.0.into() }),
        ..Material::diffuse(Rgb::WHITE).into()
    };
    let turned = seen(&quad(material(n), Transform::IDENTITY), Vec3::NEG_Z);
    assert!((turned - n).length() < 1e-6, "{turned}");
    let rotation = Transform::rotate(DVec3::new(1.0, 2.0, 0.5), 40.0).expect("an axis");
    let axis = |v: Vec3| rotation.vector(v.as_dvec3()).as_vec3();
    let turned = seen(&quad(material(n), rotation), -axis(Vec3::Z));
    assert!((turned - axis(n)).length() < 1e-5, "{turned} {}", axis(n));
    let mirrored = Transform::scale(DVec3::new(1.0, -1.0, 1.0)).expect("not zero");
    let turned = seen(&quad(material(n), mirrored), Vec3::NEG_Z);
    assert!((turned - Vec3::new(n.x, -n.y, n.z)).length() < 1e-5, "{turned}");
    assert_eq!(seen(&quad(material(Vec3::Z), Transform::IDENTITY), Vec3::NEG_Z), Vec3::Z);
}

/// Normals that a map or heights modify face the viewer and stay on the viewer's side of the surface.
#[test]
fn modified_normals_face_the_viewer() {
    let mut random = Random::new(8);
    for _ in 0..10_000 {
        let [x, y] = [random.range(-1.0, 1.0), random.range(-1.0, 1.0)].map(|x| x as f32);
        let map = Texture::Constant(Rgb::new(0.5 + 0.5 * x, 0.5 + 0.5 * y, random.range(0.5, 1.0) as f32));
        let normal_modifier = NormalModifier::NormalMap { map, strength: 3.0.into() };
        let wo = at(random.range(1e-3, 1.0), random.range(0.0, 6.3)).0;
        for wo in [wo, -wo] {
            let n = normal_modifier.normal(&point(Vec2::ZERO), [Vec3::X, Vec3::Y], wo);
            assert!(n.is_normalized() && n.z > 0.0 && n.dot(wo) * wo.z > 0.0, "{n} {wo}");
        }
    }
}

/// Camera rays and shadow rays pass where the opacity is 0, also through several holes in a row. A partial opacity is the share of rays
/// that hit the surface.
#[test]
fn holes_let_light_through() {
    let squares = |even: f32, odd: f32| {
        Texture::Checker(Box::new(Checker { even: even.into(), odd: odd.into(), scale: Vec3::splat(2.0), space: Space::Uv }))
    };
    let world = |opacity: Texture| {
        let mut world = World::builder(eye());
        let wall = world.material(Material::diffuse(Rgb::WHITE));
        let lace = world.material(SurfaceMaterial { opacity: Some(opacity), ..Material::diffuse(Rgb::WHITE).into() });
        for z in [1.0, 2.0, 3.0] {
            let up = Transform::translate(DVec3::new(0.0, 0.0, z)).expect("near");
            world.shape(Quad { size: [2.0; 2] }, up, lace, None);
        }
        world.shape(Quad { size: [4.0; 2] }, Transform::IDENTITY, wall, Some(Emitter::new(Rgb::WHITE)));
        world.build().expect("quads")
    };
    let look = |world: &World, x: f32, y: f32| {
        let ray = Ray::new(Vec3::new(x, y, 5.0) - world.origin().as_vec3(), Vec3::NEG_Z);
        let hit = world.intersect(&ray).expect("the wall at least");
        let before = Ray { t_max: hit.t * 0.999, ..ray };
        assert!(!world.occluded(&before));
        assert!(world.occluded(&Ray { t_max: hit.t * 1.001, ..ray }));
        let p = world.surface(&ray, &hit).point.p + world.origin().as_vec3();
        assert!((p - Vec3::new(x, y, 5.0 - hit.t)).length() < 1e-5);
        5.0 - hit.t
    };
    let lace = world(squares(0.0, 1.0));
    assert!(look(&lace, -0.5, -0.5).abs() < 1e-5);
    assert!((look(&lace, 0.5, -0.5) - 3.0).abs() < 1e-5);
    // Three surfaces of opacity 0.3 stop 30, 21 and 14.7 % of the rays, and 34.3 % pass.
    let veil = world(squares(0.3, 0.3));
    const RAYS: u32 = 100_000;
    let mut counts = [0u32; 4];
    let mut random = Random::new(3);
    for _ in 0..RAYS {
        let z = look(&veil, random.range(-0.9, 0.9) as f32, random.range(-0.9, 0.9) as f32);
        counts[(3.0 - z).round() as usize] += 1;
    }
    for (count, share) in counts.into_iter().zip([0.3, 0.21, 0.147, 0.343]) {
        let (mean, sigma) = (f64::from(RAYS) * share, (f64::from(RAYS) * share * (1.0 - share)).sqrt());
        // One of the four shares is more than 4.5 σ off with a probability of 3e-5.
        assert!((f64::from(count) - mean).abs() < 4.5 * sigma, "{counts:?}");
    }
}

/// A ray through a ball of opacity o meets its surface twice, and passes both with the probability (1 − o)².
#[test]
fn a_partly_transparent_ball_is_hit_twice() {
    const RAYS: u32 = 100_000;
    let mut world = World::builder(eye());
    let veil = world.material(SurfaceMaterial { opacity: Some(0.3.into()), ..Material::diffuse(Rgb::WHITE).into() });
    world.shape(Sphere { radius: 1.0 }, Transform::IDENTITY, veil, None);
    let world = world.build().expect("a ball");
    let mut random = Random::new(5);
    let mut counts = [0u32; 3];
    for _ in 0..RAYS {
        let from = Vec3::new(random.range(-0.5, 0.5) as f32, random.range(-0.5, 0.5) as f32, 5.0);
        let met = world.intersect(&Ray::new(from, Vec3::NEG_Z));
        counts[met.map_or(2, |hit| usize::from(hit.t > 5.0))] += 1;
    }
    for (count, share) in counts.into_iter().zip([0.3, 0.21, 0.49]) {
        let (mean, sigma) = (f64::from(RAYS) * share, (f64::from(RAYS) * share * (1.0 - share)).sqrt());
        // One of the three shares is more than 4.5 σ off with a probability of 2e-5.
        assert!((f64::from(count) - mean).abs() < 4.5 * sigma, "{counts:?}");
    }
}

/// ∂p/∂u and ∂p/∂v are the derivatives of the position by the texture coordinates, on spheres, disks and meshes.
#[test]
fn tangents_are_derivatives() {
    let to_world = Transform::scale(DVec3::new(2.0, 1.0, 0.5)).expect("not zero");
    let mut builder = World::builder(eye());
    let material = builder.material(Material::diffuse(Rgb::WHITE));
    let mesh = MeshData {
        positions: vec![Vec3::ZERO, Vec3::new(3.0, 0.5, 0.0), Vec3::new(1.0, 2.0, 0.3)],
        uvs: vec![Vec2::new(0.1, 0.2), Vec2::new(0.9, 0.3), Vec2::new(0.4, 0.8)],
        triangles: vec![[0, 1, 2]],
        ..MeshData::default()
    };
    builder.shape(Sphere { radius: 1.0 }, to_world, material, None);
    builder.shape(TriangleMesh::new(mesh), to_world, material, None);
    builder.shape(pt::shape::Disk { radius: 1.5 }, to_world, material, None);
    let world = builder.build().expect("shapes");
    let mut random = Random::new(21);
    for (k, shape) in world.shapes().iter().enumerate() {
        for _ in 0..200 {
            let u = Vec2::new(random.range(0.05, 0.95) as f32, random.range(0.1, 0.9) as f32);
            let (a, _) = shape.sample_area(0, u);
            let Some([du, dv]) = shape.tangents(0, &a, 0.0) else { panic!("shape {k} has none") };
            let (b, _) = shape.sample_area(0, u + Vec2::new(3e-4, 2e-4));
            let moved = b.uv - a.uv;
            if moved.length() > 0.1 {
                continue; // across the seam
            }
            let (found, expected) = (du * moved.x + dv * moved.y, b.p - a.p);
            assert!((found - expected).length() < 0.02 * expected.length() + 2e-6, "shape {k}: {found} {expected}");
        }
    }
}

/// Gold defined by its index of refraction and gold defined by its colour look the same at normal incidence.
#[test]
fn metal_by_color_equals_metal_by_name() {
    let (eta, k) = Element::Au.index();
    let by_index = Material::metal((eta, k), None, true);
    let sample = |material: &Material| center(material).sample(Local::NORMAL, 0.5, Vec2::splat(0.5), MODE).expect("a mirror").weight;
    let color = sample(&by_index);
    assert_eq!(sample(&Material::metal(Texture::from(stored(color)), None, true)), color);
}
