//! Error and time of a picture of a checkered plane that reaches to the horizon, with textures averaged over footprints and looked up at
//! points; the checkerboard once as a formula and once as a picture. The plane is seen directly and in a mirror ball.
//!
//! `cargo bench --bench footprints`

use std::sync::Arc;
use std::time::Instant;

use glam::{DVec3, UVec2, Vec2, Vec3};
use pt::bsdf::Material;
use pt::camera::{Camera, Perspective, Pose};
use pt::film::{FilmSpec, MomentFilm, TextureFootprint};
use pt::integrators::nee::Nee;
use pt::light::{Environment, Light};
use pt::math::{Rgb, Transform};
use pt::render::{Settings, Silent, render};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene;
use pt::shape::{Quad, Sphere};
use pt::texture::image::{Filter, Pixels, Wrap};
use pt::texture::pyramid::Pyramid;
use pt::texture::{Checker, Image, Space, Texture};
use pt::world::World;

const SIZE: [u32; 2] = [192, 144];

/// Samples per pixel of the reference.
const REFERENCE: u64 = 4096;

/// Number of renders of each setting. Errors are root mean squares over them, times the least of them.
const SEEDS: u64 = 3;

fn main() {
    println!("{} x {} pixels, root mean square error to {REFERENCE} samples per pixel at points", SIZE[0], SIZE[1]);
    let textures = [("formula", formula()), ("picture", picture())];
    for (name, texture) in textures {
        let scene: Arc<dyn Scene> = Arc::new(plane(texture));
        let (truth, _) = values(&scene, TextureFootprint::Fixed(0.0), REFERENCE, 99);
        println!("{name}:\n  spp   error over footprints   at points   ratio   time over footprints / at points");
        for spp in [1, 4, 16, 64, 256] {
            let [(filtered, slow), (exact, fast)] = [TextureFootprint::Shrinking, TextureFootprint::Fixed(0.0)].map(|footprint| {
                let (mut square, mut seconds) = (0.0, f64::INFINITY);
                for seed in 0..SEEDS {
                    let (found, taken) = values(&scene, footprint, spp, seed);
                    square += found.iter().zip(&truth).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / truth.len() as f64;
                    seconds = seconds.min(taken);
                }
                ((square / SEEDS as f64).sqrt(), seconds)
            });
            println!("  {spp:>3}   {filtered:>21.4}   {exact:>9.4}   {:>5.2}   {:>31.3}", filtered / exact, slow / fast);
        }
    }
}

/// Mean of the colours of each pixel, and the time of the render (s).
fn values(scene: &Arc<dyn Scene>, texture_footprint: TextureFootprint, samples: u64, seed: u64) -> (Vec<f64>, f64) {
    let spec = FilmSpec { texture_footprint, ..FilmSpec::new(SIZE[0], SIZE[1]) };
    let settings = Settings { samples, ..Settings::new(SamplerSpec { kind: Kind::Sobol, seed, ..SamplerSpec::default() }) };
    let mut film = MomentFilm::new(spec);
    let start = Instant::now();
    render(scene.clone(), &Nee::default(), &mut film, &settings, &Silent);
    let seconds = start.elapsed().as_secs_f64();
    let mean = |(i, sum): (usize, [f64; 3])| sum.iter().sum::<f64>() / (3.0 * film.samples_of(i) as f64);
    (film.total().sums().enumerate().map(mean).collect(), seconds)
}

/// A checkered plane to the horizon with a mirror ball, under a sky of one colour.
fn plane(checkered: Texture) -> World {
    let pose = Pose::look_at(DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.3, 0.8, -1.0), DVec3::Y).expect("y is not the axis");
    let mut builder = World::builder(Camera::Perspective(Perspective::new(pose, 50.0, 0.0, 1.0)));
    let (checkered, mirror) = (builder.material(Material::diffuse(checkered)), builder.material(Material::mirror(0.9)));
    let flat = Transform::rotate(DVec3::X, -90.0).expect("x is an axis");
    builder.shape(Quad { size: [2048.0; 2] }, flat, checkered, None);
    builder.shape(Sphere { radius: 0.7 }, Transform::translate(DVec3::new(1.4, 0.7, -3.0)).expect("finite"), mirror, None);
    builder.light(Light::Environment(Environment { radiance: Rgb::WHITE }));
    builder.build().expect("a sound scene")
}

fn formula() -> Texture {
    let (even, odd) = (Rgb::gray(0.9).into(), Rgb::gray(0.1).into());
    Texture::Checker(Box::new(Checker { even, odd, scale: Vec3::splat(2048.0), space: Space::Uv }))
}

/// The same checkerboard as a picture that is repeated: it shows two by two cells, each 64 pixels wide and high.
fn picture() -> Texture {
    let value = |i: u32| if (i % 128 / 64 + i / 128 / 64) % 2 == 1 { 0.9 } else { 0.1 };
    let values = (0..128 * 128).map(|i| [value(i); 3]).collect();
    let pixels = Pixels::new(UVec2::splat(128), values).expect("as many values as pixels");
    let pyramid = Some(Arc::new(Pyramid::new(&pixels)));
    Texture::Image(Image { pixels: Arc::new(pixels), pyramid, scale: Vec2::splat(1024.0), wrap: Wrap::Repeat, filter: Filter::Bilinear })
}
