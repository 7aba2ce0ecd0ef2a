//! Splats: where light counts on the film that arrives anywhere on it.

use std::sync::Arc;

use glam::Vec2;
use pt::film::{Crop, FilmSpec, Filter, Layer, Splat, SplatSums};
use pt::integrator::{CameraSample, Context, Estimator, Integrator};
use pt::math::Spectrum;
use pt::render::{Render, SampleId, Settings, Silent, render};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene;

use super::{CAMERAS, K, LIGHTS, built, film, sampled, scene};
use crate::random::Random;

fn filters() -> [(&'static str, Filter); 6] {
    [
        ("box", Filter::default()),
        ("wide box", Filter::pixel_box(1.25)),
        ("tent", Filter::tent(1.0)),
        ("gaussian", Filter::gaussian(1.5, 0.5)),
        ("mitchell", Filter::mitchell(2.0, 1.0 / 3.0, 1.0 / 3.0)),
        ("sharp mitchell", Filter::mitchell(1.5, 0.0, 0.6)),
    ]
}

/// The weight of light at an offset from a pixel is the density of the pixel's samples there, times their weight: in each cell of a
/// grid the integral of `eval` is the sum of the weights of evenly distributed samples.
#[test]
fn the_filter_is_the_density_of_its_samples() {
    const SIDE: u32 = 1 << 10;
    const CELLS: usize = 12;
    for (name, filter) in filters() {
        let radius = filter.radius();
        let cell = |x: f32| (((x / radius + 1.0) * 0.5 * CELLS as f32) as usize).min(CELLS - 1);
        let middle = |i: u32| (i as f32 + 0.5) / SIDE as f32;
        let (mut found, mut expected) = (vec![0.0; CELLS * CELLS], vec![0.0; CELLS * CELLS]);
        for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (middle(x), middle(y)))) {
            let (offset, weight) = filter.sample(Vec2::new(x, y));
            found[CELLS * cell(offset.y) + cell(offset.x)] += f64::from(weight) / f64::from(SIDE * SIDE);
            let place = (Vec2::new(x, y) * 2.0 - 1.0) * radius;
            expected[CELLS * cell(place.y) + cell(place.x)] += filter.eval(place) * f64::from((2.0 * radius / SIDE as f32).powi(2));
        }
        // A border between cells may fall between other samples than the border of the density: 2⁻¹⁰ of the samples of a cell's edge.
        for (i, (a, b)) in found.iter().zip(&expected).enumerate() {
            assert!((a - b).abs() < 2e-3, "{name}, cell {i}: {a}, expected {b}");
        }
        let total: f64 = expected.iter().sum();
        assert!((total - 1.0).abs() < 1e-4, "{name}: the integral is {total}");
        let outside = [Vec2::new(radius * 1.001, 0.0), Vec2::new(0.0, -radius * 1.001)];
        assert!(outside.iter().all(|offset| filter.eval(*offset) == 0.0), "{name}");
    }
}

fn spec(filter: Filter, crop: Crop) -> FilmSpec {
    FilmSpec { filter, crop, layers: vec![Layer::Depth, Layer::Direct, Layer::Indirect], ..FilmSpec::new(9, 7) }
}

/// Every pixel gets the light of a splat times the filter there, and so do the layers that show it. A crop gets what the whole has.
#[test]
fn splats_count_with_the_filter() {
    let mut random = Random::new(3);
    let whole = Crop { min: glam::UVec2::ZERO, max: glam::UVec2::new(9, 7) };
    let part = Crop { min: glam::UVec2::new(2, 1), max: glam::UVec2::new(5, 6) };
    for (name, filter) in filters() {
        let splats: Vec<Splat> = (0..200)
            .map(|i| Splat {
                raster: Vec2::new(random.range(-2.0, 11.0) as f32, random.range(-2.0, 9.0) as f32),
                value: Spectrum::rgb(random.unit() as f32, 1.0, 0.0),
                depth: 1 + i % 3,
                light: 0,
            })
            .collect();
        let numbers = |crop| {
            let mut sums = SplatSums::new(&spec(filter.clone(), crop));
            sums.add(&[&splats[..77], &[], &splats[77..]]);
            sums.numbers().to_vec()
        };
        let (all, cropped) = (numbers(whole), numbers(part));
        // Three colours; two sums of the depth, which is no light; the direct and the indirect light.
        let width = 3 + 2 + 3 + 3;
        for (x, y) in (0..7).flat_map(|y| (0..9).map(move |x| (x, y))) {
            let mut expected = [0.0; 6];
            for splat in &splats {
                let weight = filter.eval(splat.raster - Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
                let [r, g, _] = splat.value.to_rgb().map(|c| weight * f64::from(c));
                let of = |shown: bool| if shown { [r, g] } else { [0.0; 2] };
                let terms = [of(true), of(splat.depth == 1), of(splat.depth > 1)].concat();
                expected.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
            }
            let pixel = &all[width * (9 * y + x)..][..width];
            let found = [pixel[0], pixel[1], pixel[5], pixel[6], pixel[8], pixel[9]];
            assert_eq!((found, pixel[2], pixel[3], pixel[4]), (expected, 0.0, 0.0, 0.0), "{name}, pixel {x}, {y}");
            if part.contains(glam::UVec2::new(x as u32, y as u32)) {
                assert_eq!(&cropped[width * (3 * (y - 1) + x - 2)..][..width], pixel, "{name}, pixel {x}, {y} of the crop");
            }
        }
    }
}

/// With wide filters, at the edges of the film too, light tracing gives the picture that samples of the filter give: also where a
/// panorama goes on beyond its edges and its poles.
#[test]
fn splats_at_the_edges_of_the_film() {
    for (camera, filter) in [(0, Filter::gaussian(2.0, 1.0)), (3, Filter::gaussian(2.0, 1.0)), (3, Filter::mitchell(2.0, 0.3, 0.3))] {
        let built = built(&scene(CAMERAS[camera].1, &LIGHTS[9]));
        let world: Arc<dyn Scene> = Arc::new(built.world);
        let spec = FilmSpec { filter, ..FilmSpec::new(8, 6) };
        let sampler = |seed| SamplerSpec { kind: Kind::Sobol, seed, spp: 2048, scramblings: K };
        let [a, b] = [("light", 1), ("nee", 2)].map(|(name, seed)| film(world.clone(), name, "", spec.clone(), sampler(seed)).image());
        let found = pt::measure::agreement(sampled(&a), sampled(&b), 0.003).expect("error bars");
        assert!(found.accepts(), "{}: {found}", CAMERAS[camera].0);
    }
}

/// Estimator whose light paths bring light of a given value to one place.
struct Lamp(f32);

impl Integrator for Lamp {
    fn prepare(&self, _: Arc<dyn Scene>, _: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(Lamp(self.0))
    }

    fn splats(&self) -> bool {
        true
    }
}

impl Estimator for Lamp {
    fn li(&self, camera: &CameraSample, cx: &mut Context) -> Spectrum {
        if let Some(path) = &mut cx.light_path {
            let value = if camera.pixel == glam::UVec2::new(3, 2) { self.0 } else { 1.0 };
            path.splat(Vec2::new(0.55, 0.5), Spectrum::gray(value), 1, 0);
        }
        Spectrum::gray(0.5)
    }
}

/// The light of all paths of a sample arrives at its place, also in a crop that has only that place; a value that is not finite or is
/// negative is not added but reported with the sample that it belongs to, which is replayed.
#[test]
fn wrong_splats_are_reported() {
    let world: Arc<dyn Scene> = Arc::new(built(&scene(CAMERAS[0].1, &LIGHTS[0])).world);
    for wrong in [f32::NAN, f32::INFINITY, -1.0] {
        let whole = FilmSpec::new(8, 6);
        let pixel = Crop { min: glam::UVec2::new(4, 3), max: glam::UVec2::new(5, 4) };
        for spec in [whole.clone(), FilmSpec { crop: pixel, ..whole }] {
            let sampler = SamplerSpec { spp: 4, ..SamplerSpec::default() };
            let mut film = pt::film::MomentFilm::new(spec.clone());
            let report = render(world.clone(), &Lamp(wrong), &mut film, &Settings::new(sampler), &Silent);
            assert_eq!(report.invalid, 4, "{wrong}");
            let ids: Vec<SampleId> = (0..4).map(|index| SampleId { pixel: (3, 2), index }).collect();
            assert_eq!(report.first_invalid, ids);
            let image = film.image();
            let at = pixel.min - spec.crop.min;
            // 47 of the 48 paths, and the sample's own light.
            assert_eq!(image.rgb(at.x, at.y), [47.5; 3], "{wrong}");
            let replayed = Render::new(world.clone(), &Lamp(wrong), &spec, &Settings::new(sampler)).replay(ids[0], None);
            assert!(!replayed.is_finite());
        }
    }
}

/// Layers of light add up to the picture of a light tracer as well: emission, direct and indirect, and the lights.
#[test]
fn layers_of_splats_add_up() {
    let text = scene(CAMERAS[0].1, &LIGHTS[0]).replace(
        r#""height": 14"#,
        r#""height": 14, "filter": { "type": "gaussian" }, "layers": ["emission", "direct", "indirect", "lights"]"#,
    );
    let text = text.replace(r#""radiance": 0 }"#, r#""radiance": 0.2 }"#);
    let built = built(&text);
    let sampler = SamplerSpec { kind: Kind::Sobol, spp: 64, scramblings: 8, ..SamplerSpec::default() };
    let image = film(Arc::new(built.world), "light", "", built.film, sampler).image();
    let layer = |name: &str| image.channel(name).unwrap_or_else(|| panic!("no {name}"));
    let lights: Vec<&str> =
        image.channels.iter().map(|c| c.name.as_str()).filter(|name| name.starts_with("Light.") && name.ends_with("G")).collect();
    assert_eq!(lights.len(), 2, "{lights:?}");
    for (i, whole) in layer("G").iter().enumerate() {
        let by_depth: f32 = ["Emission.G", "Direct.G", "Indirect.G"].map(|name| layer(name)[i]).iter().sum();
        let by_light: f32 = lights.iter().map(|name| layer(name)[i]).sum();
        // Each layer is rounded to f32 once.
        assert!((by_depth - whole).abs() <= 4.0 * f32::EPSILON * whole, "pixel {i}: {by_depth}, {whole}");
        assert!((by_light - whole).abs() <= 4.0 * f32::EPSILON * whole, "pixel {i}: {by_light}, {whole}");
    }
    assert!(["Emission.G", "Direct.G", "Indirect.G"].iter().all(|name| layer(name).iter().sum::<f32>() > 0.1));
}
