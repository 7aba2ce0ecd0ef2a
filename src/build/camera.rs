//! Builds the camera, the film and the sampler from their descriptions.

use std::collections::BTreeSet;

use glam::UVec2;

use super::transform;
use crate::camera::realistic::{LensTable, Sensor, ThickLens};
use crate::camera::{self, Blades, Camera, Fisheye, FisheyeMapping, Orthographic, Perspective, Pose, Realistic, Spherical};
use crate::describe::{self, Contents, Files, Lens};
use crate::error::{Error, Fault};
use crate::film::layer::with_lights;
use crate::film::memory;
use crate::film::{Allocation, Crop, FilmSpec, Filter, Layer, LightNames, TextureFootprint};
use crate::format::{Real, TiltAngle};
use crate::math::{AnimatedTransform, Transform};
use crate::sampler::{Kind, SamplerSpec};

/// Builds the camera, and tells the hash of the file that its lens is in.
///
/// # Errors
/// Faults: steps that together have no inverse, a lens that cannot be used; `Io` where its file cannot be read.
pub(super) fn camera(scene: &describe::Scene, files: &Files) -> Result<(Camera, Contents), Failure> {
    let to_world = match scene.camera.placement() {
        (Some(at), _) => transform::look_at(at).map(AnimatedTransform::Still),
        (None, Some(steps)) => Some(
            transform::animated(steps, &Transform::IDENTITY, &scene.shutter)
                .map_err(|message| Failure::at("/camera/transform", message))?,
        ),
        (None, None) => None,
    };
    let pose = Pose::animated(&to_world.unwrap_or(Transform::IDENTITY.into()));
    let mut contents = Contents::new();
    let camera = match &scene.camera {
        describe::Camera::Perspective(c) => Camera::Perspective(perspective(pose, c)),
        describe::Camera::Orthographic(c) => Camera::Orthographic(Orthographic { pose, height: c.height.get() as f32 }),
        describe::Camera::Fisheye(c) => Camera::Fisheye(Fisheye::new(pose, c.fov.get(), mapping(c.mapping))),
        describe::Camera::Spherical(_) => Camera::Spherical(Spherical { pose }),
        describe::Camera::Realistic(c) => {
            let aspect = f64::from(scene.film.width.get()) / f64::from(scene.film.height.get());
            Camera::Realistic(realistic(pose, c, aspect, files, &mut contents)?)
        }
    };
    Ok((camera, contents))
}

/// Why a camera cannot be built.
pub(super) enum Failure {
    /// A fault of the description, with its JSON pointer.
    Fault(&'static str, String),
    /// Another error.
    Error(Error),
}

impl Failure {
    fn at(pointer: &'static str, message: String) -> Failure {
        Failure::Fault(pointer, message)
    }
}

/// The mapping of a fisheye lens that the description names.
fn mapping(described: describe::FisheyeMapping) -> FisheyeMapping {
    match described {
        describe::FisheyeMapping::Equidistant => FisheyeMapping::Equidistant,
        describe::FisheyeMapping::Equisolid => FisheyeMapping::Equisolid,
        describe::FisheyeMapping::Stereographic => FisheyeMapping::Stereographic,
        describe::FisheyeMapping::Orthographic => FisheyeMapping::Orthographic,
    }
}

/// Metres in a millimetre.
const MILLIMETRE: f64 = 1e-3;

fn perspective(pose: Pose, described: &describe::Perspective) -> Perspective {
    let sensor = described.sensor();
    let focal_length = match described.focal_length {
        Some(given) => given.get(),
        None => camera::focal_length(described.fov(), sensor.height()),
    };
    let lens_radius = match described.f_number {
        Some(number) => 0.5 * focal_length / number.get() * MILLIMETRE,
        None => described.lens_radius.get(),
    };
    let mut camera = Perspective::new(pose, described.fov(), lens_radius as f32, described.focus_distance.get() as f32);
    if let Some(across) = described.horizontal_fov {
        camera = camera.across(described.fov(), across.get());
    }
    if described.focal_length.is_some() {
        camera = camera.with_sensor(focal_length, sensor.height(), sensor.width());
    }
    let camera = camera.shifted(described.shift.map(Real::get)).tilted(described.tilt.map(TiltAngle::get));
    match described.aperture.as_ref().filter(|iris| iris.blades.get() > 0) {
        Some(iris) => camera.with_blades(Blades::new(iris.blades.get(), iris.rotation.get())),
        None => camera,
    }
}

/// Warnings about keys of a pinhole that count only with a lens.
pub(super) fn of_no_lens(camera: &describe::Camera) -> Vec<String> {
    let describe::Camera::Perspective(camera) = camera else { return vec![] };
    if camera.f_number.is_some() || camera.lens_radius.get() > 0.0 {
        return vec![];
    }
    let has_blades = camera.aperture.as_ref().is_some_and(|iris| iris.blades.get() > 0);
    let is_tilted = camera.tilt.iter().any(|angle| angle.get() != 0.0);
    let without_effect = [("aperture", has_blades), ("tilt", is_tilted)].into_iter().filter(|(_, is_given)| *is_given);
    let message =
        |key| format!("/camera/{key}: it has no effect, because the camera is a pinhole: give f_number, or a lens_radius above 0");
    without_effect.map(|(key, _)| message(key)).collect()
}

/// Builds a camera with a lens table, which may be in a file.
///
/// - `aspect`: width / height of the picture
/// - `contents`: gets the hash of the lens's file
fn realistic(
    pose: Pose,
    described: &describe::Realistic,
    aspect: f64,
    files: &Files,
    contents: &mut Contents,
) -> Result<Realistic, Failure> {
    const LENS: &str = "/camera/lens";
    let table = match &described.lens {
        Lens::Rows(rows) => {
            let rows: Vec<[f64; 4]> = rows.iter().map(|row| row.map(Real::get)).collect();
            LensTable::new(&rows).map_err(|fault| Failure::at(LENS, fault.message))?
        }
        Lens::File(file) => {
            let (table, hash) = files.lens(file).map_err(|error| match error {
                Error::Invalid(faults) => {
                    let said = |fault: &Fault| fault.line.map_or(fault.message.clone(), |line| format!("line {line}: {}", fault.message));
                    let all: Vec<String> = faults.iter().map(said).collect();
                    Failure::at(LENS, format!("{file}: {}", all.join("; ")))
                }
                other => Failure::Error(other),
            })?;
            contents.insert(file.clone(), hash);
            table
        }
    };
    let mut table = table.scaled(described.scale.get() * MILLIMETRE);
    if let Some(diameter) = described.aperture_diameter {
        table = table.stopped_down(diameter.get() * MILLIMETRE).map_err(|message| Failure::at("/camera/aperture_diameter", message))?;
    }
    let (height, width) = (described.sensor().height() * MILLIMETRE, described.sensor().width().map(|width| width * MILLIMETRE));
    let thick = ThickLens::new(&table).map_err(|message| Failure::at(LENS, message))?;
    let focus_distance = described.focus_distance.get();
    if thick.film_distance(focus_distance).is_none() {
        let (f, least) = (thick.focal_length / MILLIMETRE, thick.least_distance());
        let message = format!("a lens with the focal length {f:.4} mm focuses on distances from {least:.4} m, found {focus_distance} m");
        return Err(Failure::at("/camera/focus_distance", message));
    }
    Realistic::new(pose, &table, focus_distance, Sensor { height, width }, aspect)
        .ok_or_else(|| Failure::at(LENS, "no light gets through this lens to the middle of the film".to_owned()))
}

pub(super) fn film(described: &describe::Film) -> FilmSpec {
    let [x0, x1, y0, y1] = described.bounds();
    let filter = match &described.filter {
        describe::Filter::Box(f) => Filter::pixel_box(f.radius.get() as f32),
        describe::Filter::Tent(f) => Filter::tent(f.radius.get() as f32),
        describe::Filter::Gaussian(f) => Filter::gaussian(f.radius.get() as f32, f.sigma.get() as f32),
        describe::Filter::Mitchell(f) => Filter::mitchell(f.radius.get() as f32, f.b.get() as f32, f.c.get() as f32),
    };
    let size = UVec2::new(described.width.get(), described.height.get());
    let layers = described.layers.iter().copied().map(layer).collect::<BTreeSet<_>>().into_iter().collect();
    let crop = Crop { min: UVec2::new(x0, y0), max: UVec2::new(x1, y1) };
    let texture_footprint =
        described.texture_footprint.map_or(TextureFootprint::Shrinking, |width| TextureFootprint::Fixed(width.get() as f32));
    FilmSpec { size, crop, filter, layers, lights: LightNames::default(), allocation: Allocation::default(), texture_footprint }
}

fn layer(described: describe::Layer) -> Layer {
    match described {
        describe::Layer::Albedo => Layer::Albedo,
        describe::Layer::N => Layer::Normal,
        describe::Layer::Ns => Layer::ShadingNormal,
        describe::Layer::P => Layer::Position,
        describe::Layer::Z => Layer::Depth,
        describe::Layer::Uv => Layer::Uv,
        describe::Layer::Emission => Layer::Emission,
        describe::Layer::Direct => Layer::Direct,
        describe::Layer::Indirect => Layer::Indirect,
        describe::Layer::Lights => Layer::Light(0),
        describe::Layer::Time => Layer::Time,
    }
}

pub(super) fn sampler(described: &describe::Sampler) -> SamplerSpec {
    let kind = match described.kind {
        describe::SamplerKind::Independent => Kind::Independent,
        describe::SamplerKind::Stratified => Kind::Stratified,
        describe::SamplerKind::Halton => Kind::Halton,
        describe::SamplerKind::Sobol => Kind::Sobol,
    };
    SamplerSpec { kind, seed: described.seed, spp: described.spp.get().into(), scramblings: described.scramblings.get() }
}

/// An upper bound of the memory that the film of a scene takes while rendering, in bytes. The scene's own memory is not included.
pub fn film_memory(scene: &describe::Scene) -> u128 {
    let (mut film, sampler) = (film(&scene.film), sampler(&scene.sampler));
    let emitters: usize = scene.groups.values().chain([&scene.shapes]).map(|shapes| emitters(shapes)).sum();
    film.layers = with_lights(&film.layers, emitters + scene.lights.len() + 1);
    memory::needed(film.crop.pixel_count(), film.layout(sampler.error_estimator()), sampler.spp)
}

/// An upper bound of the number of names of emitting shapes.
fn emitters(shapes: &[describe::Shape]) -> usize {
    let shine = |shape: &describe::Shape| match shape {
        describe::Shape::Group(group) => emitters(&group.shapes),
        describe::Shape::Sdf(sdf) => usize::from(sdf.emission.is_some() || sdf.parts.iter().flatten().any(|part| part.emission.is_some())),
        other => usize::from(other.emission().is_some()),
    };
    shapes.iter().map(shine).sum()
}
