//! Builds the world from the description of a scene: reads files, resolves names, composes transforms.

mod background;
mod camera;
mod curves;
mod density;
mod displacement;
mod field;
mod instances;
mod lamps;
mod light;
mod lint;
mod material;
mod medium;
mod mesh;
mod poses;
mod transform;
mod turns;

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec3;

use crate::bsdf::MaterialId;
use crate::describe::{Channel, Color, Contents, Encoding, Files, Material, MaterialRef, Names, Point, Scene, Shape, Size};
use crate::effects::Effects;
use crate::error::{Error, Fault, Result};
use crate::film::layer::with_lights;
use crate::film::{FilmSpec, Layer};
use crate::light::Emitter;
use crate::math::{AnimatedTransform, Rgb, Transform};
use crate::medium::{Media, MediumId};
use crate::reader::{Node, locate};
use crate::sampler::SamplerSpec;
use crate::scene::Scene as _;
use crate::shape::{
    BilinearPatch, Cone, Cuboid, Cylinder, Disk, Geometry, MovingMesh, PartialDisk, PartialSphere, Quad, Sphere, TriangleMesh,
};
use crate::texture::image::Pixels;
use crate::texture::pyramid::Pyramid;
use crate::world::{Objects, PartAppearance, World, WorldBuilder};
use camera::Failure;
pub use camera::film_memory;
use instances::BuiltGroup;
use lamps::Lamp;
use material::{MOST_PARTS, MOST_TEXTURES, Use};
pub(crate) use transform::placed;

/// A scene ready to render.
pub struct Built {
    /// The shapes, lights, materials and the camera.
    pub world: World,
    /// The image, its crop, filter and layers.
    pub film: FilmSpec,
    /// The sampler with its seed and number of samples.
    pub sampler: SamplerSpec,
    /// Sentences about probable mistakes in the scene, and how they were handled.
    pub warnings: Vec<String>,
    /// Such sentences that hold for integrators whose paths start at the camera only.
    pub warnings_for_camera_paths: Vec<String>,
    /// The names of shapes, materials and lights.
    pub names: Names,
    /// The parts of the scene by name, each with the effects that it needs.
    pub needs: Vec<(String, Effects)>,
    /// The hashes of the files' contents.
    pub contents: Contents,
}

/// The origin of a description, for messages and for the files that it names.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    /// The JSON tree of the scene file, which has the positions of values.
    pub root: &'a Node,
    /// The scene file, as the user named it.
    pub file: &'a str,
    /// The files that the scene may read.
    pub files: &'a Files,
}

/// Builds the world that `scene` describes.
///
/// # Errors
/// `Invalid` with all files that lie outside of the scene's folder, all mesh files that cannot be used and all shapes that cannot be
/// placed; `Io` where a file cannot be read; `Limit` where nested textures or materials are too many.
pub fn build(scene: &Scene, source: Source) -> Result<Built> {
    let camera = camera::camera(scene, source.files);
    let refused = source.files.refused(scene);
    let unusable = match &camera {
        // A file that the scene may not read is refused once.
        Err(Failure::Fault(pointer, message)) if refused.iter().all(|(refused, _)| refused != pointer) => {
            Some(((*pointer).to_owned(), message.clone()))
        }
        _ => None,
    };
    let refused = unusable.into_iter().chain(refused).take(crate::MAX_FAULTS);
    let refused: Vec<Fault> = refused.map(|(pointer, message)| locate(source.root, source.file, &pointer, message)).collect();
    let (camera, contents) = match camera {
        Ok(built) if refused.is_empty() => built,
        Err(Failure::Error(error)) if refused.is_empty() => return Err(error),
        _ => return Err(Error::Invalid(refused)),
    };
    let mut needs = vec![("camera".to_owned(), camera.effects())];
    let world = World::builder(camera.clone());
    let mut builder = Builder {
        scene,
        source,
        world,
        objects: Objects::default(),
        groups: BTreeMap::new(),
        materials: BTreeMap::new(),
        media: BTreeMap::new(),
        textures: 0,
        parts: 0,
        pictures: BTreeMap::new(),
        pyramids: BTreeMap::new(),
        contents,
        boxes: vec![],
        lamps: vec![],
        needs: vec![],
        override_needs: vec![],
        warnings: vec![],
        faults: vec![],
        failures: vec![],
    };
    builder.world.texture_footprints(scene.film.has_footprints());
    builder.groups()?;
    let of_groups = std::mem::take(&mut builder.needs);
    builder.shapes("/shapes", &scene.shapes, &Transform::IDENTITY)?;
    builder.world.objects(std::mem::take(&mut builder.objects));
    builder.needs.extend(of_groups);
    builder.surroundings();
    builder.needs.append(&mut builder.override_needs);
    builder.lights();
    builder.background();
    if builder.textures > MOST_TEXTURES {
        let message = format!("textures within textures make more than {MOST_TEXTURES} of them");
        return Err(Error::Limit(locate(source.root, source.file, "/textures", message)));
    }
    if builder.parts > MOST_PARTS {
        let message = format!("materials within materials make more than {MOST_PARTS} of them");
        return Err(Error::Limit(locate(source.root, source.file, "/materials", message)));
    }
    if let Some(failure) = std::mem::take(&mut builder.failures).into_iter().next() {
        return Err(failure);
    }
    if !builder.faults.is_empty() {
        builder.faults.truncate(crate::MAX_FAULTS);
        return Err(Error::Invalid(builder.faults));
    }
    let mut warnings = std::mem::take(&mut builder.warnings);
    let of_scene = |message: &str| format!("{}: {message}", source.file);
    warnings.extend(builder.averted(&camera));
    needs.append(&mut builder.needs);
    let contents = std::mem::take(&mut builder.contents);
    let media = builder.medium_names();
    let place = |fault: Fault| if fault.file.is_empty() { locate(source.root, source.file, "/shapes", fault.message) } else { fault };
    let world = builder.world.build().map_err(|error| match error {
        Error::Invalid(faults) => Error::Invalid(faults.into_iter().map(place).collect()),
        Error::Limit(fault) => Error::Limit(locate(source.root, source.file, "/groups", fault.message)),
        other => other,
    })?;
    if camera_meets_media(&world) {
        let message = "the camera moves into or out of a medium, or between two: let it stay within one, or outside of all";
        return Err(Error::invalid(locate(source.root, source.file, "/camera/transform", message)));
    }
    warnings.extend(missing(&world).map(of_scene));
    let has_keyframes = scene.has_keyframes() && scene.shutter.open != scene.shutter.close;
    if has_keyframes && !world.effects().contains(Effects::MOTION) {
        warnings.push(of_scene("/shutter: nothing moves while the shutter is open: the keyframes are at other times, or all the same"));
    }
    let of_parts = Names::of(scene, &world, media);
    warnings.extend(camera::of_no_lens(&scene.camera).iter().chain(&turns::warnings(source.root)).map(|message| of_scene(message)));
    // The first entry of `needs` is the camera; the shapes of the scene and of its groups follow, as the world numbers them.
    let names: Vec<&str> = needs[1..].iter().map(|(name, _)| name.as_str()).collect();
    let linted = lint::Linted { world: &world, shapes: &names, names: &of_parts };
    warnings.extend(lint::warnings(&linted).iter().map(|message| of_scene(message)));
    let for_camera_paths = lint::warnings_for_camera_paths(&linted).iter().map(|message| of_scene(message)).collect();
    let mut film = camera::film(&scene.film);
    if film.layers.contains(&Layer::Light(0)) {
        film.lights = of_parts.lights(world.lights(), world.media().is_some_and(Media::emits));
        film.layers = with_lights(&film.layers, film.lights.names.len());
    }
    let sampler = camera::sampler(&scene.sampler);
    Ok(Built { world, film, sampler, warnings, warnings_for_camera_paths: for_camera_paths, names: of_parts, needs, contents })
}

/// The number of times at which the media around a moving camera are looked for.
const MOMENTS: u16 = 64;

/// Whether the camera moves across the boundary of a medium: paths begin with the media that are around it when the shutter opens.
fn camera_meets_media(world: &World) -> bool {
    let around = |k: u16| world.bodies_around(world.camera().eye_at(f32::from(k) / f32::from(MOMENTS)).as_vec3());
    let first = world.media().filter(|_| world.camera().is_moving()).map(|media| *media.at_camera());
    first.is_some_and(|first| (0..=MOMENTS).any(|k| around(k) != first))
}

/// Returns a warning if the picture will be black, or show only the background.
fn missing(world: &World) -> Option<&'static str> {
    // What a medium emits is seen without lamps, shapes of other materials, and a background.
    if world.media().is_some_and(Media::emit) {
        return None;
    }
    let lights = world.lights();
    let has_background = !lights.infinite().is_empty();
    match (world.shapes().is_empty(), has_background, lights.has_emission()) {
        (true, true, _) => Some("no shapes, the image will show the background alone"),
        (_, _, false) => Some("no light, the image will be black"),
        (true, false, true) => Some("no shapes and no background, the image will be black"),
        (false, _, true) => None,
    }
}

struct Builder<'a> {
    scene: &'a Scene,
    source: Source<'a>,
    world: WorldBuilder,
    /// The shapes and instances of the scene, or of the group that is being built.
    objects: Objects,
    groups: BTreeMap<String, BuiltGroup>,
    /// The materials built so far with their effects, by JSON pointer.
    materials: BTreeMap<String, (MaterialId, Effects)>,
    /// The media built so far and what they ask for, by JSON pointer.
    media: BTreeMap<String, (MediumId, Effects)>,
    /// The number of textures built so far.
    textures: usize,
    /// The number of materials within materials built so far.
    parts: usize,
    /// The pictures read so far; `None` for one that could not be used.
    pictures: BTreeMap<(String, Encoding, Option<Channel>), Option<Arc<Pixels>>>,
    /// The pictures at lower resolutions made so far.
    pyramids: BTreeMap<(String, Encoding, Option<Channel>), Arc<Pyramid>>,
    contents: Contents,
    /// The bounding box of each shape, and of all instances of a description, in the coordinates of the scene or of a group.
    boxes: Vec<(DVec3, DVec3)>,
    lamps: Vec<Lamp>,
    needs: Vec<(String, Effects)>,
    /// The effects of the materials that instances have instead of those of their shapes.
    override_needs: Vec<(String, Effects)>,
    warnings: Vec<String>,
    faults: Vec<Fault>,
    /// Errors that are no mistakes in the scene: files that cannot be read, or are too large.
    failures: Vec<Error>,
}

impl Builder<'_> {
    fn shapes(&mut self, pointer: &str, shapes: &[Shape], outer: &Transform) -> Result<()> {
        for (i, shape) in shapes.iter().enumerate() {
            let pointer = format!("{pointer}/{i}");
            match transform::animated(shape.transform(), outer, &self.scene.shutter) {
                Ok(AnimatedTransform::Still(to_world)) => self.shape(&pointer, shape, &to_world)?,
                Ok(moving) => self.moving(&pointer, shape, moving)?,
                Err(message) => self.fault(&format!("{pointer}/transform"), &message),
            }
        }
        Ok(())
    }

    /// Builds a shape that moves, with all that it contains.
    ///
    /// # Errors
    /// Those of the shapes.
    fn moving(&mut self, pointer: &str, shape: &Shape, to_world: AnimatedTransform) -> Result<()> {
        let outer = (std::mem::take(&mut self.objects), std::mem::take(&mut self.boxes), std::mem::take(&mut self.lamps));
        let first = self.needs.len();
        self.shape(pointer, shape, &Transform::IDENTITY)?;
        self.needs[first..].iter_mut().for_each(|(_, effects)| *effects |= Effects::MOTION);
        if let Shape::Instances(instances) = shape {
            // The shapes of the group are listed apart, and may also show elsewhere, at rest.
            let name = instances.name.as_ref().map_or_else(|| format!("{pointer}, instances"), |name| format!("{name:?}, instances"));
            self.override_needs.push((name, Effects::MOTION));
        }
        let (inner, boxes) = (std::mem::take(&mut self.objects), std::mem::take(&mut self.boxes));
        (self.objects, self.boxes, self.lamps) = outer;
        self.boxes.extend(boxes.into_iter().map(|(low, high)| <(DVec3, DVec3)>::from(to_world.bounds([low, high]))));
        self.objects.moving(inner, to_world);
        Ok(())
    }

    fn shape(&mut self, pointer: &str, shape: &Shape, to_world: &Transform) -> Result<()> {
        let emitter = shape.emission().map(|described| self.emitter(&format!("{pointer}/emission"), described));
        if let Shape::Group(group) = shape {
            return self.shapes(&format!("{pointer}/shapes"), &group.shapes, to_world);
        }
        if let Shape::Instances(instances) = shape {
            return self.instances(pointer, instances, to_world);
        }
        let medium = shape.medium().map(|described| self.medium(&format!("{pointer}/medium"), described));
        // A medium alone has no surface.
        let interface = medium.map(|_| MaterialRef::Inline(Box::new(Material::Interface(Default::default()))));
        let (kind, own) = self.material(&format!("{pointer}/material"), shape.material().or(interface.as_ref()));
        let mut effects = own.1;
        effects |= medium.map_or(Effects::NONE, |(_, effects)| effects);
        let emits = |emitter: &Option<Emitter>| emitter.as_ref().is_some_and(|emitter| !emitter.radiance.is_black());
        if emits(&emitter) && !matches!(shape, Shape::Sdf(_)) {
            effects |= Effects::AREA_LIGHT;
        }
        let own = own.0;
        self.note_lamp(pointer, shape, to_world);
        match shape {
            Shape::Sphere(s) if s.is_whole() => {
                self.place_at(pointer, s.center, Sphere { radius: s.radius.get() }, to_world, own, emitter);
            }
            Shape::Sphere(s) => {
                let part = PartialSphere { radius: s.radius.get(), z: s.ends(), phi_max: s.phi_max.get() };
                self.place_at(pointer, s.center, part, to_world, own, emitter);
            }
            Shape::Box(s) => self.place_at(pointer, s.center, Cuboid { size: s.size.get() }, to_world, own, emitter),
            Shape::Quad(s) => {
                let size = match s.size {
                    Size::Square(side) => [side.get(); 2],
                    Size::Sides(sides) => sides.map(|side| side.get()),
                };
                self.place(Quad { size }, *to_world, vec![own], emitter);
            }
            Shape::Disk(s) if s.is_whole() => self.place(Disk { radius: s.radius.get() }, *to_world, vec![own], emitter),
            Shape::Disk(s) => {
                let part = PartialDisk { radius: s.radius.get(), inner_radius: s.inner_radius.get(), phi_max: s.phi_max.get() };
                self.place(part, *to_world, vec![own], emitter);
            }
            Shape::Cylinder(s) => {
                let cylinder = Cylinder { radius: s.radius.get(), z: [s.z_min.get(), s.z_max.get()], phi_max: s.phi_max.get() };
                self.place(cylinder, *to_world, vec![own], emitter);
            }
            Shape::Cone(s) => {
                let cone = Cone { radius: s.radius.get(), height: s.height.get(), phi_max: s.phi_max.get() };
                self.place(cone, *to_world, vec![own], emitter);
            }
            Shape::BilinearPatch(s) => {
                let corners = s.corners.map(|corner| DVec3::from(corner.0));
                self.place(BilinearPatch { corners }, *to_world, vec![own], emitter);
            }
            Shape::Curves(s) => {
                let Some(curves) = self.curves(pointer, s, to_world)? else { return Ok(()) };
                effects |= Effects::CURVES;
                self.place(curves, *to_world, vec![own], emitter);
            }
            Shape::Mesh(s) => {
                let Some(data) = self.mesh(pointer, s, to_world)? else { return Ok(()) };
                let (parts, more) = self.part_materials(pointer, s, &data, own);
                effects |= more;
                if effects.contains(Effects::SHADING_NORMALS) {
                    self.note_no_relief(pointer, &data);
                }
                if !data.normals.is_empty() {
                    effects |= Effects::SHADING_NORMALS;
                    effects |= if s.smooth_shadows { Effects::SMOOTH_SHADOWS } else { Effects::NONE };
                }
                let mesh =
                    TriangleMesh { smooth_shadows: s.smooth_shadows, keeps_winding: s.has_computed_normals(), ..TriangleMesh::new(data) };
                let Some(poses) = self.poses(pointer, s, &mesh.data)? else { return Ok(()) };
                match MovingMesh::new(mesh, poses) {
                    Ok(moving) => {
                        effects |= Effects::MOTION;
                        // No points are sampled on what bends.
                        if emits(&emitter) {
                            effects = (effects - Effects::AREA_LIGHT) | Effects::UNSAMPLED_EMITTER;
                        }
                        self.place(moving, *to_world, parts, emitter);
                    }
                    Err(still) => self.place(still, *to_world, parts, emitter),
                }
            }
            Shape::Sdf(s) => {
                let Some((solid, parts, more)) = self.sdf(pointer, s, PartAppearance { material: own, emitter }) else { return Ok(()) };
                effects |= more;
                if parts.iter().any(|part| emits(&part.emitter)) {
                    effects |= Effects::UNSAMPLED_EMITTER;
                }
                self.boxes.push(solid.bounds(to_world));
                self.objects.solid(solid, *to_world, parts);
            }
            Shape::Group(_) | Shape::Instances(_) => {}
        }
        medium.into_iter().for_each(|(medium, _)| self.objects.fill(medium));
        let name = shape.name().map_or_else(|| format!("{pointer}, {kind}"), |name| format!("{name:?}, {kind}"));
        self.needs.push((name, effects));
        Ok(())
    }

    fn emitter(&mut self, pointer: &str, described: &crate::describe::Emission) -> Emitter {
        let texture =
            described.texture.as_ref().map(|texture| Arc::new(self.texture_for(&format!("{pointer}/texture"), texture, Use::Emission)));
        Emitter { radiance: rgb(&described.radiance), two_sided: described.two_sided, texture }
    }

    /// Places a shape whose centre is at the origin: moves it to `center`, then applies `to_world`.
    fn place_at(
        &mut self,
        pointer: &str,
        center: Point,
        geometry: impl Geometry + 'static,
        to_world: &Transform,
        material: MaterialId,
        emitter: Option<Emitter>,
    ) {
        match Transform::translate(DVec3::from(center.0)) {
            Ok(to_center) => self.place(geometry, to_center.then(to_world), vec![material], emitter),
            Err(_) => self.fault(&format!("{pointer}/center"), "the centre is too far from the origin: use smaller coordinates"),
        }
    }

    fn place(&mut self, geometry: impl Geometry + 'static, to_world: Transform, materials: Vec<MaterialId>, emitter: Option<Emitter>) {
        self.boxes.push(geometry.bounds(&to_world));
        self.objects.parts(geometry, to_world, materials, emitter);
    }

    fn fault(&mut self, pointer: &str, message: &str) {
        self.faults.push(locate(self.source.root, self.source.file, pointer, message));
    }
}

fn rgb<T: Copy + Into<f64>>(color: &Color<T>) -> Rgb {
    Rgb::from_f64(color.linear())
}
