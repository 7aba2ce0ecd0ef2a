//! Builds a [`World`]: bakes shapes, places groups, and makes the lights and the hierarchy.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::DVec3;

use super::extent::{Extent, GroupExtent};
use super::media::Touching;
use super::motion::as_instances;
use super::objects::{GroupId, Object, Objects};
use super::spaces::{Hierarchies, ShapeCopy, baked, copies, spaces, still};
use super::wide::Tables;
use super::{PartAppearance, PreparedMaterial, ShapeAppearance, ShapePlace, World};
use crate::accel;
use crate::bsdf::{Material, MaterialId, SurfaceMaterial};
use crate::camera::Camera;
use crate::effects::Effects;
use crate::error::{Error, Fault, Result};
use crate::light::{Area, Emitter, EmitterMotion, Light, Lights};
use crate::math::lanes::Width;
use crate::math::transform::greatest_stretch;
use crate::math::{Aabb, AnimatedTransform, Spectrum, Transform};
use crate::medium::{Body, MOST_BODIES, MOST_DEPTH, Media, Medium, MediumId};
use crate::primitive::InstanceId;
use crate::shape::{Geometry, Sdf, Shape};

/// Builder of a [`World`]. Coordinates are those of the user, in f64 where precision matters.
pub struct WorldBuilder {
    camera: Camera,
    materials: Vec<SurfaceMaterial>,
    scene: Objects,
    /// Groups, each after those that it shows.
    groups: Vec<Objects>,
    lights: Vec<Light>,
    media: Vec<Medium>,
    /// Medium outside of all shapes that have one.
    around: Option<MediumId>,
    width: Width,
    has_footprints: bool,
}

impl WorldBuilder {
    pub(super) fn new(camera: Camera) -> WorldBuilder {
        WorldBuilder {
            camera,
            materials: vec![],
            scene: Objects::default(),
            groups: vec![],
            lights: vec![],
            media: vec![],
            around: None,
            width: Width::detect(),
            has_footprints: true,
        }
    }

    /// Sets the number of paths that are followed side by side. The default is that of the machine, [`Width::detect`].
    pub fn width(&mut self, width: Width) {
        self.width = width;
    }

    /// Sets whether textures are averaged over footprints, which is the default.
    pub fn texture_footprints(&mut self, has_footprints: bool) {
        self.has_footprints = has_footprints;
    }

    /// Adds a material, optionally with a normal or bump map and holes.
    pub fn material(&mut self, surface: impl Into<SurfaceMaterial>) -> MaterialId {
        self.materials.push(surface.into());
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Adds a shape with one material, which emits light if `emitter` is set.
    pub fn shape(&mut self, geometry: impl Geometry + 'static, to_world: Transform, material: MaterialId, emitter: Option<Emitter>) {
        self.scene.shape(geometry, to_world, material, emitter);
    }

    /// Adds a solid whose parts may have different materials and emission.
    pub fn solid(&mut self, sdf: Sdf, to_world: Transform, parts: Vec<PartAppearance>) {
        self.scene.solid(sdf, to_world, parts);
    }

    /// Adds a medium.
    pub fn medium(&mut self, medium: Medium) -> MediumId {
        self.media.push(medium);
        MediumId(self.media.len() as u32 - 1)
    }

    /// Fills the shape that was added last with a medium. The shape must be closed.
    pub fn fill(&mut self, medium: MediumId) {
        self.scene.fill(medium);
    }

    /// Sets the medium outside of all shapes that have one.
    pub fn surround(&mut self, medium: MediumId) {
        self.around = Some(medium);
    }

    /// Adds shapes and instances to the scene itself.
    pub fn objects(&mut self, objects: Objects) {
        self.scene.append(objects);
    }

    /// Adds shapes and instances that move together. Their shapes must not have media.
    ///
    /// - `to_world`: transform from their space to the world
    pub fn moving(&mut self, objects: Objects, to_world: AnimatedTransform) {
        self.scene.moving(objects, to_world);
    }

    /// Adds a group, which shows only where there is an instance of it. It may contain instances of groups that were added before.
    pub fn group(&mut self, objects: Objects) -> GroupId {
        self.groups.push(objects);
        GroupId(self.groups.len() as u32 - 1)
    }

    /// Adds a light that rays cannot hit, or the environment.
    pub fn light(&mut self, light: Light) {
        self.lights.push(light);
    }

    /// Builds the scene in coordinates around the region of its finest detail, with the hierarchy.
    ///
    /// # Errors
    /// `Invalid` for shapes that no ray can hit, for coordinates beyond [`MAX_EXTENT`](super::MAX_EXTENT), and for instances that give a
    /// medium too great an optical depth; `Limit` for more than 2³² − 2 instances with those within them, more than
    /// [`MAX_COPIES`](super::MAX_COPIES), or more than [`MOST_BODIES`] shapes with a medium.
    pub fn build(self) -> Result<World> {
        let WorldBuilder { camera, materials, scene, groups, lights, media, around, width, has_footprints } = self;
        let (scene, groups) = as_instances(scene, groups);
        let extents = GroupExtent::all(&groups)?;
        let origin = Extent::of(&scene, &extents).checked()?.origin(camera.eye());
        let origins = std::iter::once(origin).chain(extents.iter().map(|group| group.detail.middle));
        let all = std::iter::once(scene).chain(groups);
        let (objects, placements): (Vec<_>, Vec<_>) = all.map(|objects| (objects.shapes, objects.instances)).unzip();
        let copies = copies(&objects, &placements)?;
        let moves = placements.iter().flatten().any(|placement| placement.to_outer.is_moving());
        let overrides: BTreeSet<MaterialId> = placements.iter().flatten().filter_map(|placement| placement.material).collect();

        let spaces = spaces(&objects, origins);
        let shapes = baked(&spaces, &copies)?;
        let is_interface = |material: MaterialId| matches!(materials[material.0 as usize].material, Material::Interface(_));
        let are_interfaces = |object: &Object| object.parts.iter().all(|part| is_interface(part.material));
        let own = (0..).zip(&objects[0]).filter(|(_, object)| are_interfaces(object)).map(|(shape, _)| shape);
        let of_copies =
            still(&spaces, &copies).filter(|(_, copy, _)| copy.material.map_or_else(|| are_interfaces(copy.object), is_interface));
        let interfaces: BTreeSet<u32> = own.chain(of_copies.map(|(shape, ..)| shape)).collect();
        let Hierarchies { scene: hierarchy, shown, moving } = Hierarchies::new(&spaces, placements, &shapes, &copies, &interfaces)?;
        let interfaces =
            (!interfaces.is_empty()).then(|| accel::build_with_instances(shapes.clone(), interfaces.into_iter().collect(), vec![]));
        let place = |id: Option<InstanceId>, object: &Object| match id {
            Some(id) if !object.is_copied() => ShapePlace::Instance(id),
            _ => ShapePlace::Nowhere,
        };
        let of_groups = spaces.iter().zip(shown).skip(1).flat_map(|(space, id)| space.objects.iter().map(move |object| place(id, object)));
        let of_copies = moving.iter().map(|moving| moving.as_ref().map_or(ShapePlace::World, |(id, _)| ShapePlace::Instance(*id)));
        let places = objects[0].iter().map(|_| ShapePlace::World).chain(of_groups).chain(of_copies).collect();
        let described = objects.iter().flatten().chain(copies.iter().map(|copy| copy.object)).map(|object| object.described).collect();

        let lights = lights.into_iter().map(|light| light.recentred(origin)).collect();
        let mut appearances = Appearances { shapes: &shapes, origin, lights, of_shapes: vec![] };
        objects[0].iter().for_each(|object| appearances.add(object, None, Shown::Still));
        objects[1..].iter().flatten().for_each(|object| appearances.add(object, None, Shown::AsCopies));
        for (copy, moving) in copies.iter().zip(moving) {
            appearances.add(copy.object, copy.material, moving.map_or(Shown::Still, |(_, motion)| Shown::Moving(motion)));
        }
        let Appearances { lights, of_shapes: appearances, .. } = appearances;

        let bounds = interfaces.as_ref().map_or(Aabb::EMPTY, |interfaces| interfaces.bounds()).union(hierarchy.bounds());
        let lights = Lights::new(lights, shapes.clone(), (bounds.center(), bounds.radius()));
        let materials: Vec<PreparedMaterial> =
            materials.into_iter().map(|surface| PreparedMaterial::new(surface.recentred(origin))).collect();
        let bodies = bodies(&objects[0], still(&spaces, &copies))?;
        check_depths(&media, &bodies)?;
        let used = appearances.iter().flat_map(|d| &d.parts).map(|part| part.material).chain(overrides);
        let prepared = used.map(|material| materials[material.0 as usize].surface.effects());
        let normals = shapes.iter().filter(|s| s.has_shading_normals()).map(|_| Effects::SHADING_NORMALS);
        let smooth = shapes.iter().filter(|s| s.has_shadow_terminator_offset()).map(|_| Effects::SMOOTH_SHADOWS);
        let curves = shapes.iter().filter(|s| s.is_of_curves()).map(|_| Effects::CURVES);
        let in_media = (!bodies.is_empty() || around.is_some()).then_some(Effects::MEDIA);
        let moves = moves || shapes.iter().any(|shape| shape.is_moving());
        let prepared = prepared.chain(in_media).chain(moves.then_some(Effects::MOTION));
        let effects = prepared.chain(normals).chain(smooth).chain(curves).fold(lights.effects() | camera.effects(), Effects::union);
        let effects = if has_footprints { effects } else { effects.without(Effects::FOOTPRINTS) };
        let camera = camera.recentred(origin);
        let has_holes = effects.contains(Effects::CUT_OUTS);
        let media = effects.contains(Effects::MEDIA).then(|| Media::new(media, bodies, around, origin));
        let glows = media.as_ref().is_some_and(Media::emits);
        let effects = if glows { effects | Effects::UNSAMPLED_EMITTER } else { effects };
        let touching = media.as_ref().and_then(|media| Touching::new(media, &shapes));
        let tables = None;
        let mut world = World {
            shapes,
            appearances,
            places,
            described,
            materials,
            has_holes,
            hierarchy,
            interfaces,
            bounds,
            lights,
            camera,
            media,
            touching,
            effects,
            origin,
            tables,
        };
        if world.media.is_some() {
            let at_camera = world.bodies_containing(world.camera.eye().as_vec3());
            world.media = world.media.map(|media| media.with_camera(at_camera));
        }
        world.tables = Tables::new(&world, width);
        Ok(world)
    }
}

/// The shapes with media.
///
/// - `copies`: those of groups, with their transforms to the world
///
/// # Errors
/// `Limit` for more than [`MOST_BODIES`].
fn bodies<'c>(objects: &[Object], copies: impl Iterator<Item = (u32, &'c ShapeCopy<'c>, &'c Transform)>) -> Result<Vec<Body>> {
    let body = |shape: u32, object: &Object, to_world: Option<&Transform>| {
        let own_to_world = to_world.map_or(object.to_outer, |to_world| object.to_outer.then(to_world));
        Some(Body { shape, medium: object.medium?, to_world: to_world.map(Transform::matrix), volume: volume(object, &own_to_world) })
    };
    let own = (0..).zip(objects).filter_map(|(shape, object)| body(shape, object, None));
    let bodies: Vec<Body> = own.chain(copies.filter_map(|(shape, copy, to_world)| body(shape, copy.object, Some(to_world)))).collect();
    if bodies.len() > MOST_BODIES {
        return Err(Error::Limit(Fault::new(format!("more than {MOST_BODIES} shapes have a medium"))));
    }
    Ok(bodies)
}

/// Volume of the box around a body along the body's own axes (m³), which stays the same when the body or the whole scene is turned. It has
/// 28 binary digits, so that equal bodies in different places have equal volumes in spite of rounding.
fn volume(object: &Object, own_to_world: &Transform) -> f64 {
    const DROPPED: u32 = f64::MANTISSA_DIGITS - 28;
    let (low, high) = object.geometry.bounds(&Transform::IDENTITY);
    let volume = (high - low).element_product() * own_to_world.matrix().matrix3.determinant().abs();
    f64::from_bits((volume.to_bits() + (1 << (DROPPED - 1))) >> DROPPED << DROPPED)
}

/// Refuses instances in which rays could take seconds to pass a medium, see [`MOST_DEPTH`].
///
/// # Errors
/// `Invalid` for such an instance.
fn check_depths(media: &[Medium], bodies: &[Body]) -> Result<()> {
    let of_media: Vec<f64> = media.iter().map(Medium::most_per_cell).collect();
    let depths = bodies.iter().filter_map(|body| Some(of_media[body.medium.0 as usize] * greatest_stretch(body.to_world?.matrix3)));
    match depths.fold(0.0, f64::max) {
        depth if depth > MOST_DEPTH => Err(Error::invalid(Fault::new(format!(
            "an instance gives a medium an optical depth of {depth:.1e} within a few values of its density, expected at most \
             {MOST_DEPTH:e}: make the coefficients or the instance smaller"
        )))),
        _ => Ok(()),
    }
}

/// How a shape that emits light shows.
enum Shown {
    /// The shape itself is the light, at rest.
    Still,
    /// The shape itself is the light, and it moves.
    Moving(Arc<EmitterMotion>),
    /// The shape belongs to a group, and each copy of it in an instance is a light of its own.
    AsCopies,
}

/// Appearances of the shapes and the lights, as far as they are made.
struct Appearances<'a> {
    shapes: &'a [Box<dyn Shape>],
    origin: DVec3,
    lights: Vec<Light>,
    of_shapes: Vec<ShapeAppearance>,
}

impl Appearances<'_> {
    /// Adds the appearance of the next shape.
    ///
    /// - `material`: material instead of the object's own
    fn add(&mut self, object: &Object, material: Option<MaterialId>, shown: Shown) {
        let (index, first_light) = (self.of_shapes.len(), self.lights.len() as u32);
        let is_copied = matches!(shown, Shown::AsCopies);
        let part = |part: &PartAppearance| {
            let emitter = part.emitter.clone().map(|emitter| emitter.recentred(self.origin));
            PartAppearance { emitter, material: material.unwrap_or(part.material) }
        };
        let parts: Vec<PartAppearance> = object.parts.iter().map(part).collect();
        // A shape whose parts emit differently is not sampled. Its brightest emitter represents it among the lights.
        let brightness = |emitter: &Emitter| Spectrum::from_illuminant(emitter.radiance).average();
        let brightest = |a: &&Emitter, b: &&Emitter| brightness(a).total_cmp(&brightness(b));
        let emitter = parts.iter().filter_map(|part| part.emitter.as_ref()).max_by(brightest);
        let motion = match shown {
            Shown::Moving(motion) => Some(motion),
            Shown::Still | Shown::AsCopies => None,
        };
        if let Some(emitter) = emitter.filter(|_| !is_copied) {
            let light = |primitive| Light::Area(Area::new(index as u32, primitive, emitter.clone()).moving(motion.clone()));
            self.lights.extend((0..self.shapes[index].count()).map(light));
        }
        let has_shadow_terminator_offset = self.shapes[index].has_shadow_terminator_offset();
        self.of_shapes.push(ShapeAppearance { parts, first_light, has_shadow_terminator_offset });
    }
}
