//! The bias report: the light that settings remove, compared with closed forms and with exact sums.

use std::sync::Arc;
use std::time::Duration;

use glam::DVec3;
use pt::bsdf::Material;
use pt::film::{FilmSpec, MomentFilm};
use pt::integrator::Integrator;
use pt::integrators::nee::Nee;
use pt::integrators::path::Path;
use pt::integrators::whitted::Whitted;
use pt::math::ExactSum;
use pt::measure::bias_report::BiasBudget;
use pt::measure::{BiasEstimate, bias_report, critical_z};
use pt::render::{RenderReport, Settings, Silent, render};
use pt::sampler::SamplerSpec;
use pt::scene::Scene;
use pt::shape::Sphere;
use pt::world::World;

use crate::recorder::load;
use crate::scenes::{at, glow, gray, probe, room, stored, two_sided};

const HOUR: Duration = Duration::from_secs(3600);

/// 1 + ρ + … + ρ^depth
fn terms(albedo: f64, depth: u32) -> f64 {
    (1.0 - albedo.powi(depth as i32 + 1)) / (1.0 - albedo)
}

/// A closed room whose walls all emit and reflect: L = Σ ρᵏ.
fn glowing(albedo: f64) -> Arc<dyn Scene> {
    let mut world = World::builder(probe(DVec3::new(0.3, -0.2, 0.4), DVec3::new(1.0, 0.4, 0.1)));
    let wall = world.material(Material::diffuse(stored(gray(albedo))));
    room(&mut world, DVec3::ZERO, DVec3::new(1.0, 1.5, 1.0), |_, _| (wall, glow(1.0)));
    Arc::new(world.build().expect("a room"))
}

fn only(scene: &Arc<dyn Scene>, integrator: &dyn Integrator, mean: f64, samples: u64) -> BiasEstimate {
    let all = bias_report(scene, integrator, &FilmSpec::new(8, 8), 5, mean, BiasBudget { samples, per_pixel: samples, time: HOUR });
    let [removed] = <[BiasEstimate; 1]>::try_from(all).expect("one bias");
    removed
}

/// The share ρ^(d+1) of all light lies beyond depth d. The bias report finds it within its own error, in 18 estimates at a significance of
/// 10⁻³ for all together. The error is not overstated either: z² has the mean 1, and the mean of 18 is above 0.3 except with a probability
/// of 10⁻⁴.
#[test]
fn the_depth_limit_removes_what_the_series_says() {
    let mut squares = vec![];
    for albedo in [0.3, 0.6, 0.9] {
        let scene = glowing(albedo);
        for depth in [0, 2, 5] {
            let methods: [Box<dyn Integrator>; 2] = [
                Box::new(Path { max_depth: depth, roulette_depth: 4 }),
                Box::new(Nee { max_depth: depth, roulette_depth: 4, ..Nee::default() }),
            ];
            for method in methods {
                let removed = only(&scene, &*method, terms(albedo, depth), 4096);
                assert_eq!(removed.setting, format!("max_depth {depth}"));
                let z = (removed.share - albedo.powi(depth as i32 + 1)) / removed.error;
                assert!(z.abs() < critical_z(1e-3, 18), "albedo {albedo}, depth {depth}: {removed:?}, z {z}");
                squares.push(z * z);
            }
        }
    }
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    assert!(mean > 0.3, "{mean}");
}

/// A closed room of mirrors has the series of [`the_depth_limit_removes_what_the_series_says`] without any noise: paths end only when their
/// weight is 0 (ρ^65536 = 0).
#[test]
fn the_depth_limit_of_a_branching_method_is_counted() {
    let mut world = World::builder(probe(DVec3::new(0.3, -0.2, 0.4), DVec3::new(1.0, 0.4, 0.1)));
    let wall = world.material(Material::mirror(stored(gray(0.5))));
    world.shape(Sphere { radius: 1.5 }, at(DVec3::ZERO), wall, two_sided(1.0));
    let scene: Arc<dyn Scene> = Arc::new(world.build().expect("a sphere"));
    let removed = only(&scene, &Whitted { max_depth: 3, branch_depth: 4 }, terms(0.5, 3), 32);
    assert!((removed.share - 0.0625).abs() < 1e-6 && removed.error < 1e-9, "{removed:?}");
}

/// A depth limit that no path reaches removes no light.
#[test]
fn a_limit_that_no_path_reaches_removes_nothing() {
    let removed = only(&glowing(0.1), &Path { max_depth: 64, roulette_depth: 2 }, terms(0.1, 64), 256);
    assert_eq!((removed.share, removed.error, removed.samples), (0.0, 0.0, 256));
}

fn taken(clamp: Option<f32>, tile: u32) -> (MomentFilm, RenderReport) {
    let built = load(std::path::Path::new("scenes/cornell-box.json"), [24, 24]);
    let sampler = SamplerSpec { seed: 2, spp: 24, ..SamplerSpec::default() };
    let mut film = MomentFilm::new(built.film);
    let settings = Settings { clamp, tile, ..Settings::new(sampler) };
    let report = render(Arc::new(built.world), &Nee::default(), &mut film, &settings, &Silent);
    (film, report)
}

/// A clamped picture and the removed light add up to the picture without clamping. Sums in f64 have a relative error of 2⁻⁵³ for each
/// addition, and there are 2¹⁵ samples.
#[test]
fn clamping_is_counted() {
    let sum = |film: &MomentFilm| film.total().sums().flatten().sum::<f64>();
    let (whole, none) = taken(None, 16);
    let (clamped, report) = taken(Some(0.5), 16);
    let removed = report.clamped.get();
    assert!(removed > 0.001 * sum(&whole), "{removed}");
    assert!((sum(&clamped) + removed - sum(&whole)).abs() < 1e-11 * sum(&whole), "{removed}");
    assert_eq!(none.clamped, ExactSum::default());
    // The numbers do not depend on threads and tiles.
    assert_eq!(taken(Some(0.5), 5).1.clamped, report.clamped);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    assert_eq!(pool.install(|| taken(Some(0.5), 24).1.clamped), report.clamped);
    // A clamp that no sample exceeds removes no light.
    let (high, report) = taken(Some(1e6), 16);
    assert_eq!((high.image(), report.clamped), (whole.image(), ExactSum::default()));
}
