//! The picture does not depend on the number of threads, the tiles, the crop or the waves.

use glam::UVec2;
use proptest::prelude::*;
use pt::film::{Crop, Film, FilmSpec, MomentFilm, Moments, PixelSums, Tree, Wave};
use pt::integrators::ALL;
use pt::math::Spectrum;
use pt::sampler::{Kind, SamplerSpec};

use super::new;
use crate::random::{Random, cases};
use pt::torture::everything::{Everything, Lens, Shot, picture, render_on};

#[test]
fn threads_and_tiles_do_not_matter() {
    for (entry, (kind, ..)) in ALL.iter().flat_map(|e| Kind::ALL.iter().map(move |k| (e, k))) {
        let scene = Everything { moves: *kind == Kind::Sobol, ..Everything::default() };
        let shot = Shot { scene, sampler: SamplerSpec { kind: *kind, spp: 7, seed: 3, ..SamplerSpec::default() }, ..Shot::default() };
        let wanted = render_on(1, &*new(entry), &shot);
        for (threads, tile) in [(2, 16), (3, 5), (7, 1), (2, 64), (7, 0), (1, u32::MAX)] {
            let found = render_on(threads, &*new(entry), &Shot { tile, ..shot.clone() });
            assert!(found == wanted, "{} {kind:?} {threads} threads, tiles of {tile}", entry.name);
        }
    }
}

#[test]
fn crops_are_parts_of_the_full_picture() {
    for (entry, (kind, ..)) in ALL.iter().flat_map(|e| Kind::ALL.iter().map(move |k| (e, k))) {
        let shot = Shot { sampler: SamplerSpec { kind: *kind, spp: 4, seed: 3, ..SamplerSpec::default() }, ..Shot::default() };
        let full = picture(shot.scene.build(), &*new(entry), &shot);
        let crop = Crop { min: UVec2::new(7, 11), max: UVec2::new(30, 13) };
        let film = FilmSpec { crop, ..shot.film.clone() };
        let part = picture(shot.scene.build(), &*new(entry), &Shot { film, ..shot });
        for (x, y) in (0..23).flat_map(|x| (0..2).map(move |y| (x, y))) {
            assert_eq!(part.rgb(x, y).map(f32::to_bits), full.rgb(x + 7, y + 11).map(f32::to_bits), "{} {kind:?} {x} {y}", entry.name);
        }
    }
}

/// No sample is invalid with any camera and filter. `picture` asserts it.
#[test]
fn no_sample_is_invalid() {
    use pt::film::Filter;
    let filters = [Filter::default(), Filter::tent(1.0), Filter::gaussian(1.5, 0.5), Filter::mitchell(2.0, 1.0 / 3.0, 1.0 / 3.0)];
    for (camera, filter) in Lens::ALL.into_iter().flat_map(|c| filters.clone().map(|f| (c, f))) {
        for entry in ALL {
            let scene = Everything { camera, moves: camera == Lens::Realistic, lens_radius: 0.1, ..Everything::default() };
            let film = FilmSpec { filter: filter.clone(), ..FilmSpec::new(40, 30) };
            picture(scene.build(), &*new(entry), &Shot { scene, film, ..Shot::default() });
        }
    }
}

/// Samples whose magnitudes span sixty binary digits, so that another order of summation changes the sum.
fn sample(random: &mut Random) -> Moments {
    let mut value = || (random.unit() * random.decade(-9.0, 9.0)) as f32;
    Moments::of(Spectrum::rgb(value(), value(), value()))
}

/// Moments of the samples `first` … `first + 2^level − 1`, added up as in a tile.
fn wave(samples: &[Moments], wave: Wave) -> Moments {
    let mut tree = Tree::default();
    let range = wave.first as usize..(wave.first + wave.samples()) as usize;
    samples[range].iter().for_each(|m| tree.push(0, *m, Moments::join));
    tree.total(Moments::join).expect("a wave is not empty")
}

proptest! {
    #![proptest_config(cases(2000))]

    /// Every division into aligned blocks gives the same bits as adding one sample after the other.
    #[test]
    fn any_aligned_split_gives_the_same_bits(count in 1u64..300, seed in any::<u64>()) {
        let mut random = Random::new(seed);
        let samples: Vec<Moments> = (0..count).map(|_| sample(&mut random)).collect();
        // The comparison is of the sums in f64, because a picture in f32 would hide their last bits.
        let sums = |next: &mut dyn FnMut(u64) -> Wave| {
            let (mut tree, mut done) = (Tree::default(), 0);
            while done < count {
                let part = next(done);
                tree.push(part.level, wave(&samples, part), Moments::join);
                done += part.samples();
            }
            tree.total(Moments::join).map(|m| [m.sum, m.square].map(|sums| sums.map(f64::to_bits)))
        };
        let one_by_one = sums(&mut |first| Wave { first, level: 0 });
        let split = sums(&mut |first| Wave::next(first, count, random.below(7) as u32).expect("some are left"));
        prop_assert_eq!(split, one_by_one);
    }

    /// Samples that are 2^k times as large give exactly 2^k times the mean and its error.
    #[test]
    fn sums_scale_exactly(count in 1u64..100, seed in any::<u64>(), k in -30i32..30) {
        let film = |factor: f32| {
            let mut random = Random::new(seed);
            let mut film = MomentFilm::new(FilmSpec::new(1, 1));
            for first in 0..count {
                let value = Spectrum::gray((random.unit() * random.decade(-3.0, 3.0)) as f32 * factor);
                film.add(Wave { first, level: 0 }, PixelSums::of_samples(&[Moments::of(value)]));
            }
            film.image().channels.iter().filter(|c| c.name != "SampleCount.Y").map(|c| c.values[0]).collect::<Vec<f32>>()
        };
        let factor = 2f32.powi(k);
        let wanted: Vec<f32> = film(1.0).iter().map(|v| v * factor).collect();
        prop_assert_eq!(film(factor), wanted);
    }
}
