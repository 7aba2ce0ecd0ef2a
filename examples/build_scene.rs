//! Builds and renders a scene in Rust, without a scene file: `cargo run --release --example build_scene [-- SPP]`.
//!
//! The scene is a room of 2 m with a red and a green wall, and in it a ball of plaster and a ball of glass.

use std::path::Path;
use std::sync::Arc;

use pt::bsdf::Material;
use pt::camera::{Camera, Perspective, Pose};
use pt::film::{FilmSpec, MomentFilm};
use pt::glam::DVec3;
use pt::integrators::nee::Nee;
use pt::light::Emitter;
use pt::math::{Rgb, Transform};
use pt::output::{self, Tonemap};
use pt::render::{Settings, Silent, render};
use pt::sampler::SamplerSpec;
use pt::shape::{Quad, Sphere};
use pt::world::World;

fn main() -> pt::Result<()> {
    let spp = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(64);

    // Nothing fails from here on, because a built world can always be rendered.
    let world = Arc::new(world()?);
    let mut film = MomentFilm::new(FilmSpec::new(256, 256));
    let settings = Settings::new(SamplerSpec { spp, ..SamplerSpec::default() });
    let report = render(world, &Nee { max_depth: 16, ..Nee::default() }, &mut film, &settings, &Silent);

    // A name that ends in `.exr` would store the radiance itself.
    let picture = Path::new("build_scene.png");
    output::write(picture, &film.image(), &vec![], &Tonemap::default())?;
    println!("{} samples per pixel in {:.2} s: {}", report.samples, report.elapsed.as_secs_f64(), picture.display());
    Ok(())
}

fn world() -> pt::Result<World> {
    // A camera looks along −z of its pose; the field of view is vertical, in degrees. Without a lens everything is sharp.
    let pose = Pose::look_at(DVec3::new(0.0, 1.0, 6.8), DVec3::new(0.0, 1.0, 0.0), DVec3::Y)?;
    let (fov, lens_radius, focus_distance) = (20.0, 0.0, 1.0);
    let mut world = World::builder(Camera::Perspective(Perspective::new(pose, fov, lens_radius, focus_distance)));

    // Colours are linear, with the primaries of Rec. 709.
    let white = world.material(Material::diffuse(Rgb::gray(0.73)));
    let red = world.material(Material::diffuse(Rgb::new(0.63, 0.06, 0.05)));
    let green = world.material(Material::diffuse(Rgb::new(0.14, 0.45, 0.09)));
    let glass = world.material(Material::glass(1.5));

    // A quad lies about the origin and faces +z: it is turned into the room, then moved.
    let wall = Quad { size: [2.0, 2.0] };
    world.shape(wall, at(0.0, 1.0, -1.0)?, white, None);
    world.shape(wall, turned(DVec3::X, -90.0, at(0.0, 0.0, 0.0)?)?, white, None);
    world.shape(wall, turned(DVec3::X, 90.0, at(0.0, 2.0, 0.0)?)?, white, None);
    world.shape(wall, turned(DVec3::Y, 90.0, at(-1.0, 1.0, 0.0)?)?, red, None);
    world.shape(wall, turned(DVec3::Y, -90.0, at(1.0, 1.0, 0.0)?)?, green, None);

    world.shape(Sphere { radius: 0.35 }, at(-0.4, 0.35, -0.3)?, white, None);
    world.shape(Sphere { radius: 0.35 }, at(0.4, 0.35, 0.3)?, glass, None);

    // A shape with an emission is a light. Its radiance is in W·m⁻²·sr⁻¹.
    let lamp = Emitter::new(Rgb::new(17.0, 14.0, 10.0));
    world.shape(Quad { size: [0.6, 0.6] }, turned(DVec3::X, 90.0, at(0.0, 1.998, 0.0)?)?, white, Some(lamp));
    world.build()
}

/// Translation (m). Fails for numbers that are not finite.
fn at(x: f64, y: f64, z: f64) -> pt::Result<Transform> {
    Transform::translate(DVec3::new(x, y, z))
}

/// Rotation, counter-clockwise about an axis that points at the viewer, followed by `to`.
fn turned(axis: DVec3, degrees: f64, to: Transform) -> pt::Result<Transform> {
    Ok(Transform::rotate(axis, degrees)?.then(&to))
}
