//! Participating media: absorption, scattering and emission between surfaces.

use std::sync::Arc;

use glam::{DVec3, UVec3, Vec3};

use super::radiance::{Depth, KnownRadiance, at, black, facing, glow, gray, picture, probe, room};
use super::{Answer, Row};
use crate::bsdf::{Material, textured};
use crate::film::FilmSpec;
use crate::integrators::nee::Nee;
use crate::light::{Directional, Environment, Light, Point};
use crate::math::float::ROUNDING;
use crate::math::{Rgb, Spectrum, Transform};
use crate::medium::{ColorGrid, Density, Grid, Medium, Phase, Places, Varying};
use crate::sampler::{Kind, SamplerSpec};
use crate::shape::{Cuboid, Quad, Sphere};
use crate::world::{World, WorldBuilder};

/// The rows.
pub fn rows() -> Vec<Row> {
    let mean = |id, what, scenes: Vec<KnownRadiance>| {
        scenes.into_iter().fold(Row::new(id, what, "confidence interval of the mean"), Row::radiance)
    };
    vec![
        mean("V1", "light through a medium that only absorbs: e^-τ", absorption()),
        mean("V2", "light that a slab scatters once", single_scattering()),
        mean("V3", "light of a lamp in thin fog, scattered once along a ray", airlight()),
        mean("V4", "albedo of a half space: 1 - H(μ) √(1 - ω)", half_spaces()),
        mean("V5", "radiance reflected by a half space of albedo 0.9 in parallel light", reflected_radiance()),
        mean("V6", "media in a field of uniform light, and media that make one", uniform_fields()),
        henyey_greenstein(),
        rayleigh(),
        mean("V9", "media within each other, and by priority", nested()),
        mean("V10", "light that slabs reflect and transmit in all", slabs()),
        slices(),
        mean("V12", "media that vary: ramps of density, albedo and emission, slabs, and media that vanish or glow", densities()),
    ]
}

/// Paths as long as media ask for.
const LONG: Depth = Depth { max: 65_535, roulette: 16 };

/// A medium, the same for all wavelengths.
///
/// - `extinction`: σa + σs
/// - `albedo`: σs / (σa + σs)
fn medium(extinction: f64, albedo: f64, phase: Phase) -> Medium {
    Medium::new(gray(extinction * (1.0 - albedo)), gray(extinction * albedo), phase)
}

/// The boundary of a medium, without a surface.
fn interface() -> Material {
    textured::Interface.into()
}

/// A direction with this cosine to +z.
fn towards(cosine: f64) -> DVec3 {
    DVec3::new(0.0, (1.0 - cosine * cosine).sqrt(), cosine)
}

/// Width of slabs: so wide that no light comes from their rims.
const WIDE: f64 = 4096.0;

/// A slab below the plane z = 0, seen from above under an angle with this cosine.
fn slab(thickness: f64, cosine: f64, material: Material, medium: Medium) -> WorldBuilder {
    let mut world = World::builder(probe(towards(cosine) * 4.0, DVec3::ZERO));
    add_slab(&mut world, thickness, material, medium);
    world
}

fn add_slab(world: &mut WorldBuilder, thickness: f64, material: Material, medium: Medium) {
    let (material, medium) = (world.material(material), world.medium(medium));
    world.shape(Cuboid { size: [WIDE, WIDE, thickness] }, at(DVec3::Z * (-0.5 * thickness)), material, None);
    world.fill(medium);
}

/// Light of radiance 1 from all around.
fn surround(mut world: WorldBuilder) -> WorldBuilder {
    world.light(Light::Environment(Environment { radiance: Rgb::WHITE }));
    world
}

/// Parallel light with an irradiance of 1 on a plane that it meets at a right angle.
///
/// - `cosine`: cosine to the normal of the slab
fn parallel(mut world: WorldBuilder, cosine: f64) -> WorldBuilder {
    world.light(Light::Directional(Directional {
        direction: (towards(cosine) * DVec3::new(1.0, -1.0, -1.0)).as_vec3(),
        irradiance: Rgb::WHITE,
    }));
    world
}

/// V1. The transmittance over the optical depth τ is e^−τ, here of a slab with a thickness of 1, of its three wavelengths together.
fn absorption() -> Vec<KnownRadiance> {
    let depths = [(1.0, 0.367_879_441_2), (1.5, 0.223_130_160_2), (20.0, 2.061_153_6e-9), (80.0, 1.804_851_4e-35)];
    let known = |(depth, radiance): (f64, f64)| {
        let world = surround(slab(1.0, 1.0, interface(), medium(depth, 0.0, Phase::Isotropic)));
        KnownRadiance::new(format!("optical depth {depth}"), world, radiance, LONG).by_chance(1e-3)
    };
    depths.into_iter().map(known).collect()
}

/// V2. L = ω/4π · μ₀/(μ + μ₀) · (1 − e^(−τ (1/μ + 1/μ₀))) for parallel light with an irradiance of 1, and an albedo ω = 0.5.
fn single_scattering() -> Vec<KnownRadiance> {
    let table = [(1.0, 1.0, 1.0, 0.017_201_958_0), (1.0, 0.5, 1.0, 0.025_205_180_8), (0.1, 1.0, 1.0, 0.003_606_237_1)];
    let known = |(depth, cosine, light, radiance)| {
        let world = parallel(slab(depth, cosine, interface(), medium(1.0, 0.5, Phase::Isotropic)), light);
        let name = format!("optical depth {depth}, seen at {cosine}, lit at {light}");
        KnownRadiance::new(name, world, radiance, Depth::exactly(1)).resolution(1e-3, 4e-3)
    };
    table.into_iter().map(known).collect()
}

/// V3. A lamp of 1 W/sr, 1 m beside the middle of a ray of 10 m through a medium that scatters a tenth per metre. The number is the
/// integral of σs/4π e^(−σ (s + r))/r² along the ray.
fn airlight() -> Vec<KnownRadiance> {
    let mut world = World::builder(probe(DVec3::X * -5.0, DVec3::ZERO));
    let fog = world.medium(medium(0.1, 1.0, Phase::Isotropic));
    world.surround(fog);
    let wall = world.material(black());
    world.shape(Quad { size: [1.0; 2] }, facing(DVec3::X * 5.0, -DVec3::X), wall, None);
    world.light(Light::Point(Point { position: DVec3::Y, intensity: Rgb::WHITE }));
    vec![KnownRadiance::new("a point light 1 m beside the ray", world, 0.011_375_223_1, Depth::exactly(1)).resolution(1e-3, 4e-3)]
}

/// V4. The albedo of a half space that scatters isotropically, with Chandrasekhar's H function. By reciprocity it is the radiance of the
/// half space in uniform light of radiance 1.
fn half_spaces() -> Vec<KnownRadiance> {
    let table = [(0.5, 1.0, 0.115_225_877_7), (0.9, 1.0, 0.414_947_479_1), (0.99, 0.5, 0.815_139_898_4), (0.999, 1.0, 0.912_845_334_8)];
    let known = |(albedo, cosine, radiance)| {
        let world = surround(slab(1024.0, cosine, interface(), medium(1.0, albedo, Phase::Isotropic)));
        KnownRadiance::new(format!("albedo {albedo}, seen at {cosine}"), world, radiance, LONG).resolution(1e-3, 1e-2).by_chance(1e-2)
    };
    table.into_iter().map(known).collect()
}

/// V5. L = ω/4π · μ₀/(μ + μ₀) · H(μ) H(μ₀) for ω = 0.9 and μ = μ₀ = 1, where H(1) = 1.8500985.
fn reflected_radiance() -> Vec<KnownRadiance> {
    let world = parallel(slab(1024.0, 1.0, interface(), medium(1.0, 0.9, Phase::Isotropic)), 1.0);
    vec![KnownRadiance::new("lit and seen at right angles", world, 0.122_572_306_84, LONG).resolution(1e-3, 5e-3)]
}

/// V6. A medium that scatters all light and absorbs none vanishes in uniform light, and one that absorbs and emits makes such light of its
/// own.
fn uniform_fields() -> Vec<KnownRadiance> {
    let mut scenes = vec![];
    let phases = [("isotropic", 0.0), ("g = 0.9", 0.9), ("g = -0.9", -0.9)];
    for ((name, g), (surface, material)) in phases.into_iter().flat_map(|phase| {
        let surfaces = [("in a ball of air", interface()), ("in a ball of glass", Material::glass(1.5))];
        surfaces.map(|surface| (phase, surface))
    }) {
        let mut world = World::builder(probe(DVec3::Z * 4.0, DVec3::new(0.2, 0.3, 0.0)));
        let (material, medium) = (world.material(material), world.medium(medium(2.0, 1.0, Phase::henyey_greenstein(g))));
        world.shape(Sphere { radius: 1.0 }, Transform::IDENTITY, material, None);
        world.fill(medium);
        scenes.push(KnownRadiance::new(format!("{name}, {surface}"), surround(world), 1.0, LONG).resolution(1e-3, 4e-3).by_chance(4e-3));
    }
    let colored = |albedo| {
        let scattering = [0.5, 0.1, 2.0].map(|s| s * albedo);
        let absorption = [0.5, 0.1, 2.0].map(|s| s * (1.0 - albedo));
        let of = |[r, g, b]: [f64; 3]| Spectrum::rgb(r as f32, g as f32, b as f32);
        Medium::new(of(absorption), of(scattering), Phase::Rayleigh)
    };
    let mut world = World::builder(probe(DVec3::Z * 4.0, DVec3::new(0.2, 0.3, 0.0)));
    let (material, medium) = (world.material(interface()), world.medium(colored(1.0)));
    world.shape(Sphere { radius: 1.0 }, Transform::IDENTITY, material, None);
    world.fill(medium);
    let vanishing = KnownRadiance::new("another extinction for each wavelength", surround(world), 1.0, LONG);
    scenes.push(vanishing.resolution(1e-3, 4e-3).by_chance(4e-3));
    for albedo in [0.0, 0.5, 0.9] {
        let mut world = World::builder(probe(DVec3::Z * 4.0, DVec3::ZERO));
        let medium = world.medium(colored(albedo).emitting(Spectrum::ONE));
        world.surround(medium);
        let name = format!("a medium without end of albedo {albedo} that emits");
        scenes.push(KnownRadiance::new(name, world, 1.0, LONG).resolution(1e-3, 4e-3).by_chance(4e-3));
    }
    // Walls that emit 0.5 and reflect half of the light: 0.5/(1 − 0.5), whatever is between them.
    let mut world = World::builder(probe(DVec3::new(0.1, 0.2, 0.0), DVec3::Z));
    let walls = world.material(Material::diffuse(Rgb::gray(0.5)));
    room(&mut world, DVec3::ZERO, DVec3::ONE, |_, _| (walls, glow(0.5)));
    let medium = world.medium(self::medium(1.0, 1.0, Phase::henyey_greenstein(0.5)));
    world.surround(medium);
    scenes.push(KnownRadiance::new("a room full of fog", world, 1.0, LONG).resolution(1e-3, 4e-3).by_chance(4e-3));
    scenes
}

/// V7. p = (1 − g²) / (4π (1 + g² − 2 g cos θ)^(3/2)) forwards, backwards and sideways, and the mean cosine g of sampled directions.
fn henyey_greenstein() -> Row {
    let table = [
        (0.9, [15.119_719_594, 0.002_204_362_1, 0.006_209_060_3]),
        (-0.9, [0.002_204_362_1, 15.119_719_594, 0.006_209_060_3]),
        (0.5, [0.477_464_829_3, 0.017_683_882_6, 0.042_705_752_6]),
        (0.99, [1_583.591_683_8, 2.009_481_4e-4, 5.0e-4]),
        (1e-6, [0.079_577_71, 0.079_577_233, 0.079_577_471_5]),
    ];
    let row = Row::new("V7", "phase function of Henyey and Greenstein", "2e-6: roundings, that of 1 - g twice; means: 5 standard errors");
    let row = table.into_iter().fold(row, |row, (g, exact)| {
        let angles = [("forwards", Vec3::Z), ("backwards", -Vec3::Z), ("sideways", Vec3::X)];
        angles.into_iter().zip(exact).filter(|((name, _), _)| !(g == 0.99 && *name == "sideways")).fold(row, |row, ((name, wi), exact)| {
            row.number(format!("g = {g}, {name}"), exact, 2e-6 * exact, move || f64::from(Phase::henyey_greenstein(g).eval(-Vec3::Z, wi)))
        })
    });
    [0.9, -0.9, 0.3, 0.99, 0.0].into_iter().fold(row, |row, g| {
        row.answered(format!("g = {g}, mean cosine"), g, move |effort| {
            let tries = effort.tries(1_000_000);
            mean_cosine(&Phase::henyey_greenstein(g), tries)
        })
    })
}

/// V8. p = 3/(16π) (1 + cos² θ).
fn rayleigh() -> Row {
    let row = Row::new("V8", "Rayleigh's phase function", "1e-6: roundings; means: 5 standard errors");
    let table = [("forwards", Vec3::Z, 0.119_366_207_3), ("backwards", -Vec3::Z, 0.119_366_207_3), ("sideways", Vec3::X, 0.059_683_103_7)];
    let row = table
        .into_iter()
        .fold(row, |row, (name, wi, exact)| row.number(name, exact, 1e-6 * exact, move || f64::from(Phase::Rayleigh.eval(-Vec3::Z, wi))));
    let row = row.answered("mean cosine".into(), 0.0, |effort| mean_cosine(&Phase::Rayleigh, effort.tries(1_000_000)));
    // The integral of cos² θ times p over all directions is 2/5.
    row.answered("mean squared cosine".into(), 0.4, |effort| {
        mean_of_cosine(&Phase::Rayleigh, effort.tries(1_000_000), |cosine| cosine * cosine)
    })
}

fn mean_cosine(phase: &Phase, tries: u64) -> Answer {
    mean_of_cosine(phase, tries, |cosine| cosine)
}

/// Mean of a function of the cosine of the angle by which light is scattered.
fn mean_of_cosine(phase: &Phase, tries: u64, of: impl Fn(f64) -> f64) -> Answer {
    let mut random = super::Random::new(7);
    let wo = Vec3::new(0.48, -0.6, 0.64);
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..tries {
        let (choice, u) = (random.uniform_square().x, random.uniform_square());
        let value = of(f64::from(-wo.dot(phase.sample(wo, choice, u))));
        sum += value;
        squares += value * value;
    }
    let n = tries as f64;
    let mean = sum / n;
    let error = ((squares / n - mean * mean).max(0.0) / n).sqrt();
    Answer { found: mean, tolerance: 5.0 * error + 1e-6, tries, note: String::new() }
}

/// V9. The camera in the middle of three balls, in media that absorb 1, 0.5 and 0.25 per metre.
fn nested() -> Vec<KnownRadiance> {
    let balls = |priority, material: fn() -> Material| {
        let mut world = World::builder(probe(DVec3::new(0.01, 0.02, 0.03), DVec3::Z));
        for (radius, absorption) in [(2.0, 0.5), (1.0, 1.0), (3.0, 0.25)] {
            let outer = if radius == 3.0 { priority } else { 0 };
            let (material, medium) =
                (world.material(material()), world.medium(medium(absorption, 0.0, Phase::Isotropic).with_priority(outer)));
            world.shape(Sphere { radius }, Transform::IDENTITY, material, None);
            world.fill(medium);
        }
        surround(world)
    };
    // The length to the inmost ball along the camera's ray; the others are 1 m longer each.
    let (eye, direction) = (DVec3::new(0.01, 0.02, 0.03), (DVec3::Z - DVec3::new(0.01, 0.02, 0.03)).normalize());
    let exit = |radius: f64| {
        let along = eye.dot(direction);
        (along * along + radius * radius - eye.length_squared()).sqrt() - along
    };
    let (a, b, c) = (exit(1.0), exit(2.0), exit(3.0));
    let inner = (-(a + 0.5 * (b - a) + 0.25 * (c - b))).exp();
    let outer = (-0.25 * c).exp();
    let mut overlapping = World::builder(probe(DVec3::Z * 4.0, DVec3::ZERO));
    for (z, absorption, priority) in [(0.5, 1.0, 2), (-0.5, 0.25, 1)] {
        let (material, medium) =
            (overlapping.material(interface()), overlapping.medium(medium(absorption, 0.0, Phase::Isotropic).with_priority(priority)));
        overlapping.shape(Cuboid { size: [4.0, 4.0, 2.0] }, at(DVec3::Z * z), material, None);
        overlapping.fill(medium);
    }
    vec![
        KnownRadiance::new("the camera in three balls", balls(0, interface), inner, LONG).by_chance(1e-3),
        KnownRadiance::new("the outer ball has priority", balls(-1, interface), outer, LONG).by_chance(1e-3),
        KnownRadiance::new("two boxes that overlap by half", surround(overlapping), (-1.0f64 - 0.5).exp(), LONG).by_chance(1e-3),
    ]
}

/// V11. A slab cut into slices that touch each other is the whole slab.
fn slices() -> Row {
    let reason = "one rounding of the throughput for each slice, half a unit in the last place";
    let row = Row::new("V11", "a slab of optical depth 1, cut into slices that touch", reason);
    [1u32, 10, 100, 1000, 10_000].into_iter().fold(row, |row, count| {
        let exact = (-1f64).exp();
        let tolerance = exact * (1e-6 + f64::from(count) * f64::from(ROUNDING));
        row.number(format!("{count} slices"), exact, tolerance, move || {
            let mut world = World::builder(probe(towards(1.0) * 4.0, DVec3::ZERO));
            let thickness = 1.0 / f64::from(count);
            let (material, medium) = (world.material(interface()), world.medium(medium(1.0, 0.0, Phase::Isotropic)));
            for slice in 0..count {
                let z = -(f64::from(slice) + 0.5) * thickness;
                world.shape(Cuboid { size: [4.0, 4.0, thickness] }, at(DVec3::Z * z), material, None);
                world.fill(medium);
            }
            let scene = Arc::new(surround(world).build().expect("slices"));
            let sampler = SamplerSpec { kind: Kind::Independent, spp: 1, ..SamplerSpec::default() };
            let image = picture(scene, &Nee::default(), FilmSpec::new(2, 2), sampler);
            image.rgb(0, 0)[0].into()
        })
    })
}

/// A grid of two values along z.
fn pair(values: [f32; 2]) -> Grid {
    Grid::new(UVec3::new(1, 1, 2), values.into(), Places::Corners)
}

/// A density of two values along z in a box of width [`WIDE`] below the plane z = 0.
fn ramp(thickness: f64, values: [f32; 2], places: Places) -> Density {
    let size = DVec3::new(WIDE, WIDE, thickness);
    let placed = Transform::translate(DVec3::new(-0.5, -0.5, -1.0)).and_then(|below| Ok(below.then(&Transform::scale(size)?)));
    Density::new(Grid::new(UVec3::new(1, 1, 2), values.into(), places), &placed.expect("a box"))
}

/// V12. With a density, the same laws hold for its integral.
///
/// The lower half of a ramp from 0 to 1 over a thickness of d has the optical depth σ d/8 with values in the corners of the grid, σ d/16 with
/// values in its centres (and 0 without interpolation).
fn densities() -> Vec<KnownRadiance> {
    let mut scenes = vec![];
    for (places, name, share) in [(Places::Corners, "corners", 8.0), (Places::Centers, "centres", 16.0)] {
        let mut world = World::builder(probe(DVec3::Z * 4.0, DVec3::ZERO));
        let ramp = medium(4.0, 0.0, Phase::Isotropic).with_density(ramp(2.0, [1.0, 0.0], places));
        let (material, medium) = (world.material(interface()), world.medium(ramp));
        world.shape(Cuboid { size: [4.0, 4.0, 1.0] }, at(DVec3::Z * -0.5), material, None);
        world.fill(medium);
        let name = format!("half a ramp with values in the {name}");
        scenes.push(KnownRadiance::new(name, surround(world), (-8.0f64 / share).exp(), LONG).resolution(1e-3, 4e-3).by_chance(4e-3));
    }
    // The slab of V10 as one of even density.
    let even = |albedo, g| medium(1.0, albedo, Phase::henyey_greenstein(g)).with_density(ramp(2.0, [1.0; 2], Places::Corners));
    let mut world = slab(2.0, 1.0, interface(), even(0.9, 0.75));
    let screen = world.material(black());
    world.shape(Quad { size: [4.0 * WIDE; 2] }, facing(DVec3::Z * -66.0, DVec3::Z), screen, None);
    let known = KnownRadiance::new("R: albedo 0.9, g = 0.75, optical depth 2", surround(world), 0.097_39, LONG);
    scenes.push(known.resolution(2e-3, 1e-2).by_chance(1e-2));
    // A medium that scatters all light vanishes in uniform light, whatever its density.
    for (name, scattering) in [("gray", [3.0; 3]), ("of another extinction for each wavelength", [0.5, 3.0, 8.0])] {
        let [r, g, b] = scattering;
        let fog = Medium::new(Spectrum::BLACK, Spectrum::rgb(r, g, b), Phase::henyey_greenstein(0.5));
        let world = surround(slab(2.0, 0.5, interface(), fog.with_density(ramp(2.0, [0.25, 1.0], Places::Centers))));
        scenes.push(
            KnownRadiance::new(format!("a slab that scatters all light, {name}"), world, 1.0, LONG).resolution(1e-3, 4e-3).by_chance(4e-3),
        );
    }
    // One that only absorbs and emits has the radiance 1 − e^−τ, here with τ = 1.25.
    let flame = medium(1.0, 0.0, Phase::Isotropic).emitting(Spectrum::ONE).with_density(ramp(2.0, [0.25, 1.0], Places::Centers));
    let world = slab(2.0, 1.0, interface(), flame);
    let glowing = KnownRadiance::new("a slab that glows", world, 1.0 - (-1.25f64).exp(), LONG);
    scenes.push(glowing.resolution(1e-3, 4e-3).by_chance(4e-3));
    scenes.extend(ramps_of_color());
    scenes
}

/// Slabs of the optical depth τ = 2, in which something falls from 1 at the upper side to 0 at the lower one: by 1 − t/2 in the optical depth t.
///
/// - the emission of a slab that only absorbs: ∫ e^(−t) (1 − t/2) dt = (1 + e^−2)/2
/// - the albedo of a slab that scatters parallel light once: 1/4π ∫ e^(−2t) (1 − t/2) dt = (3 + e^−4)/(32π)
/// - the albedo of a slab that glows and scatters no light: there the emission of a point is (1 − ω) Le, and rises
fn ramps_of_color() -> [KnownRadiance; 3] {
    let even = |medium: Medium, varying| medium.with_density(ramp(2.0, [1.0; 2], Places::Corners)).with_varying(varying);
    let falls = || Some(ColorGrid::Gray(pair([0.0, 1.0])));
    let known = |name, world, radiance, depth| KnownRadiance::new(name, world, radiance, depth).resolution(1e-3, 4e-3);

    let flame = medium(1.0, 0.0, Phase::Isotropic).emitting(Spectrum::ONE);
    let flame = even(flame, Varying { emission: falls(), ..Varying::default() });
    let glow = known("a slab whose glow falls", slab(2.0, 1.0, interface(), flame), 0.5 + 0.5 * (-2f64).exp(), LONG);

    let scattered = (3.0 + (-4f64).exp()) / (32.0 * std::f64::consts::PI);
    let fog = Medium::new(Spectrum::BLACK, Spectrum::rgb(1.0, 2.0, 0.25), Phase::Isotropic);
    let fog = even(fog, Varying { albedo: falls(), ..Varying::default() });
    let lit = parallel(slab(2.0, 1.0, interface(), fog), 1.0);

    let coal = Medium::new(Spectrum::BLACK, Spectrum::ONE, Phase::Isotropic).emitting(Spectrum::ONE);
    let coal = even(coal, Varying { albedo: falls(), ..Varying::default() });
    let absorbed = 0.5 - 1.5 * (-2f64).exp();
    let rises = known("a slab whose albedo falls and which glows", slab(2.0, 1.0, interface(), coal), absorbed, Depth::exactly(0));
    [
        glow.by_chance(4e-3),
        known("a slab whose albedo falls, of another extinction for each wavelength", lit, scattered, Depth::exactly(1)),
        rises.by_chance(4e-3),
    ]
}

/// V10. Light that a slab reflects (R) and lets pass (T) in all, in uniform light from above. Surfaces reflect by Fresnel.
///
/// Source: van de Hulst, *Multiple Light Scattering* (1980); Giovanelli, *Reflection by semi-infinite diffusers* (1955), as tables for
/// MCML by Wang and Jacques (1995); the others by a program of its own with 4·10⁶ photons, to 2·10⁻⁴ to 3·10⁻⁴.
fn slabs() -> Vec<KnownRadiance> {
    // Albedo, g, optical depth, cosine, index of refraction, R, T, where known to be exact.
    let table = [
        (0.9, 0.75, 2.0, 1.0, 1.0, 0.097_39, Some(0.660_96)),
        (0.9, 0.0, 1024.0, 1.0, 1.5, 0.2600, None),
        (0.9, 0.0, 1.0, 1.0, 1.0, 0.267_55, Some(0.591_49)),
        (0.99, 0.0, 4.0, 0.5, 1.0, 0.742_03, Some(0.187_06)),
        (1.0, 0.0, 1.0, 1.0, 1.0, 0.341_05, Some(1.0 - 0.341_05)),
        (0.95, 0.9, 10.0, 1.0, 1.33, 0.081_24 + 0.020_06, Some(0.248_94)),
    ];
    let mut scenes = vec![];
    for (albedo, g, depth, cosine, index, reflected, transmitted) in table {
        let material = || if index == 1.0 { interface() } else { Material::glass(index as f32) };
        let name = format!("albedo {albedo}, g = {g}, optical depth {depth}, at {cosine}, index {index}");
        // Light from the other side is shut out by a black surface.
        let scene = |below: bool| {
            let mut world = World::builder(match below {
                false => probe(towards(cosine) * 4.0, DVec3::ZERO),
                true => probe(DVec3::Z * -depth - towards(cosine) * 4.0, DVec3::Z * -depth),
            });
            add_slab(&mut world, depth, material(), medium(1.0, albedo, Phase::henyey_greenstein(g)));
            let screen = world.material(black());
            world.shape(Quad { size: [4.0 * WIDE; 2] }, facing(DVec3::Z * (-depth - 64.0), DVec3::Z), screen, None);
            surround(world)
        };
        // The published numbers have four digits.
        let known = |name, world, radiance| KnownRadiance::new(name, world, radiance, LONG).resolution(2e-3, 1e-2).by_chance(1e-2);
        scenes.push(known(format!("R: {name}"), scene(false), reflected));
        if let Some(transmitted) = transmitted {
            scenes.push(known(format!("T: {name}"), scene(true), transmitted));
        }
    }
    scenes
}
