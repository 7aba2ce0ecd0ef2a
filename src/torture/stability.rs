//! What must not change a picture: the scale of a scene, its brightness, the place in the world, threads and tiles; and no sample may be
//! anything but a number.

use std::sync::Arc;

use glam::DVec3;

use super::everything::{Everything, Lens, Shot, Which, bits, picture, with_threads};
use super::radiance::{Depth, KnownRadiance, glow, gray, probe, room, stored};
use super::{Failures, Row, radiometry};
use crate::bsdf::Material;
use crate::film::{FilmSpec, Image, MomentFilm};
use crate::integrator::{Entry, Integrator, choose};
use crate::integrators::ALL;
use crate::render::{Settings, Silent, render};
use crate::sampler::{Kind, SamplerSpec};
use crate::world::World;

/// The rows.
pub fn rows() -> Vec<Row> {
    vec![scale(), place(), brightness(), permuted(), division(), Row::not_yet("D2", "another architecture gives the same bits"), numbers()]
}

/// Computes the tables of the materials of [`Everything`].
fn tables() {
    drop(Everything::default().build());
}

fn integrator(entry: &Entry) -> Box<dyn Integrator> {
    choose(&[&[*entry]], None, Some(entry.name), "").expect("defaults are valid").1
}

fn taken(scene: Everything, entry: &Entry) -> Image {
    picture(scene.build(), &*integrator(entry), &Shot { scene, ..Shot::default() })
}

/// Number of values that differ, of all values of two pictures.
fn differing(a: &Image, b: &Image, same: impl Fn(f32, f32) -> bool) -> Failures {
    let mut failures = Failures::default();
    for (a, b) in a.channels.iter().zip(&b.channels).filter(|(channel, _)| channel.name != "SampleCount.Y") {
        for (k, (x, y)) in a.values.iter().zip(&b.values).enumerate() {
            failures.record((!same(*x, *y)).then(|| format!("channel {}, value {k}: {x:?} and {y:?}", a.name)));
        }
    }
    failures
}

fn scale() -> Row {
    let row = Row::new("S1", "values that change when all lengths are multiplied by a power of two", "bit by bit");
    let row = row.peers("no other program tests it; any absolute epsilon breaks it").prepared_by(tables);
    ALL.iter().flat_map(|entry| Lens::ALL.map(|camera| (entry, camera))).fold(row, |row, (entry, camera)| {
        row.never(format!("{}, {camera:?}, 2^-20 to 2^20", entry.name), 1, move |_| {
            // Two of the five cameras see what moves, so that rays with a time and rays without are both tested.
            let moves = matches!(camera, Lens::Orthographic | Lens::Realistic);
            let scene = Everything { camera, moves, lens_radius: 0.05, ..Everything::default() };
            let plain = taken(scene, entry);
            let scaled = |k: i32| taken(Everything { scale: 2f64.powi(k), ..scene }, entry);
            let same = |x: f32, y: f32| x.to_bits() == y.to_bits();
            [-20, -3, 1, 20].map(|k| differing(&plain, &scaled(k), same)).into_iter().fold(Failures::default(), Failures::join)
        })
    })
}

/// The scene is moved so that its finest part is at the origin before it is rounded.
fn place() -> Row {
    let row = Row::new("S2", "radiance in a closed room far from the origin", "confidence interval of the mean");
    let row = row.peers("without it rays leak and surfaces shadow themselves from 1e4 diameters on");
    [2f64.powi(20), 1e6, -1e9].into_iter().fold(row, |row, far| {
        let center = DVec3::splat(far);
        let mut world = World::builder(probe(center + DVec3::new(0.3, -0.2, 0.4), center + DVec3::new(1.0, 0.4, 0.1)));
        let wall = world.material(Material::diffuse(stored(gray(0.5))));
        room(&mut world, center, DVec3::new(1.0, 1.5, 1.0), |_, _| (wall, glow(1.0)));
        row.radiance(KnownRadiance::new(format!("{far:e} m away"), world, 2.0, Depth { max: 64, roulette: 4 }).resolution(1e-3, 6e-3))
    })
}

fn permuted() -> Row {
    let row = Row::new("S4", "radiance of a tile under a lamp, axes permuted and mirrored", "confidence interval of the mean");
    radiometry::permuted().into_iter().fold(row, Row::radiance)
}

fn brightness() -> Row {
    let row = Row::new("S3", "values that are not multiplied when all lamps are, by a power of two", "bit by bit").prepared_by(tables);
    let lights = [Which::All, Which::AreaOnly, Which::DirectionalOnly, Which::EnvironmentOnly];
    ALL.iter().filter(|entry| !entry.simulates.is_empty()).flat_map(|entry| lights.map(|lights| (entry, lights))).fold(
        row,
        |row, (entry, lights)| {
            row.never(format!("{}, {lights:?}, 2^-20 to 2^20", entry.name), 1, move |_| {
                let scene = Everything { lights, moves: lights == Which::AreaOnly, ..Everything::default() };
                let dim = taken(scene, entry);
                let compare = |k: i32| {
                    let factor = 2f32.powi(k);
                    let bright = taken(Everything { emission: factor, ..scene }, entry);
                    differing(&dim, &bright, |x, y| (x * factor).to_bits() == y.to_bits())
                };
                [-20, 7, 20].map(compare).into_iter().fold(Failures::default(), Failures::join)
            })
        },
    )
}

fn division() -> Row {
    let row = Row::new("D1", "pictures that change with threads and tiles", "bit by bit").peers("pbrt's splats and Mitsuba 0.6 change");
    let row = row.prepared_by(tables);
    ALL.iter().flat_map(|entry| Kind::ALL.iter().map(move |kind| (entry, kind.0))).fold(row, |row, (entry, kind)| {
        row.never(format!("{}, {kind:?}, 1 to 16 threads", entry.name), 1, move |_| {
            let sampler = SamplerSpec { kind, spp: 7, seed: 3, ..SamplerSpec::default() };
            let scene = Everything { moves: kind == Kind::Sobol, ..Everything::default() };
            let shot = Shot { scene, sampler, ..Shot::default() };
            let integrator = integrator(entry);
            let build = |threads| with_threads(threads, || scene.build());
            let drawn = |world: &Arc<World>, threads: usize, tile: u32| {
                with_threads(threads, || bits(&picture(world.clone(), &*integrator, &Shot { tile, ..shot.clone() })))
            };
            let world = build(1);
            let alone = drawn(&world, 1, shot.tile);
            let mut failures = Failures::default();
            // Pictures of one build on several threads; then the same scene, built on 16 threads. Tables of materials are made before.
            let again = build(16);
            for (world, built_on, threads, tile) in [(&world, 1, 2, 8), (&world, 1, 7, 16), (&world, 1, 16, 5), (&again, 16, 3, 64)] {
                let same = drawn(world, threads, tile) == alone;
                failures.record((!same).then(|| format!("built on {built_on} threads, rendered on {threads}, tiles of {tile}")));
            }
            failures
        })
    })
}

fn numbers() -> Row {
    let row =
        Row::new("K1", "samples that are infinite, negative or not a number", "none").peers("pbrt stops with an error").prepared_by(tables);
    let lenses = [Lens::Perspective, Lens::Spherical, Lens::Fisheye, Lens::Realistic];
    ALL.iter().flat_map(|entry| lenses.map(|camera| (entry, camera))).fold(row, |row, (entry, camera)| {
        // 64² pixels at 256 samples each.
        row.never(format!("{}, {camera:?}, 64²", entry.name), 256 << 12, move |tries| {
            let scene = Everything { camera, moves: camera == Lens::Realistic, lens_radius: 0.1, ..Everything::default() };
            let mut film = MomentFilm::new(FilmSpec::new(64, 64));
            let spp = tries.div_ceil(1 << 12);
            let report = render(
                scene.build(),
                &*integrator(entry),
                &mut film,
                &Settings::new(SamplerSpec { spp, ..SamplerSpec::default() }),
                &Silent,
            );
            let first = report.first_invalid.first().map(|invalid| format!("{invalid:?}"));
            let black = bits(&film.image()).iter().any(|(_, values)| values.iter().any(|v| !f32::from_bits(*v).is_finite()));
            Failures { tries: spp << 12, failures: report.invalid + u64::from(black), first }
        })
    })
}
