//! Built scene: shapes in world space with their materials, lights and the hierarchy over them.

mod builder;
mod extent;
mod footprints;
mod instanced;
mod media;
mod motion;
mod objects;
mod origin;
mod spaces;
mod wide;

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::bsdf::{Bsdf, HitContext, Material, MaterialId, Passage, SurfaceMaterial};
use crate::camera::Camera;
use crate::effects::Effects;
use crate::light::{Emission, Emitter, Lights};
use crate::math::{Aabb, Ray, RayDifferential, SurfaceDifferential, float};
use crate::medium::{Boundaries, Inside, InterfaceCrossing, Media};
use crate::primitive::{Hit, InstanceId, Primitive};
use crate::sampler::hash;
use crate::scene::{Scene, Surface};
use crate::shape::{Shape, ShapeHit, SurfacePoint, offset_ray_origin};
use crate::texture::{Footprint, TextureContext};

pub use builder::WorldBuilder;
pub use instanced::PlacedGroup;
pub use objects::{GroupId, Objects};
pub use spaces::MAX_COPIES;
pub use wide::{LightLanes, MediumLanes, ReceiverLanes, ScatteredLanes, SurfaceArrays, SurfaceLanes, WideWorld};

/// Scene that is ready for rendering.
pub struct World {
    shapes: Arc<[Box<dyn Shape>]>,
    /// Appearance of each shape.
    appearances: Vec<ShapeAppearance>,
    /// Place of each shape.
    places: Vec<ShapePlace>,
    /// Number of each shape, or of the one that it is a copy of, in the order in which shapes were added.
    described: Vec<u32>,
    materials: Vec<PreparedMaterial>,
    /// Whether any material has holes.
    has_holes: bool,
    hierarchy: Box<dyn Primitive>,
    /// Shapes that are only boundaries of media. They are no part of the hierarchy.
    interfaces: Option<Box<dyn Primitive>>,
    /// Bounds of all shapes.
    bounds: Aabb,
    lights: Lights,
    camera: Camera,
    /// Media, if the scene has any.
    media: Option<Media>,
    /// Bodies with media that touch, if any do.
    touching: Option<media::Touching>,
    effects: Effects,
    origin: DVec3,
    /// Tables for paths side by side, if the scene allows them.
    tables: Option<wide::Tables>,
}

/// Material with properties that are computed once.
struct PreparedMaterial {
    surface: SurfaceMaterial,
    /// BSDF, if it is the same everywhere and needs no tangents.
    uniform: Option<Bsdf<'static>>,
    needs_tangents: bool,
    /// Whether light passes through the surface.
    transmits: bool,
    /// Whether scattering depends on the wavelength.
    is_dispersive: bool,
    /// Whether the surface may reflect or refract into single directions.
    has_delta_lobes: bool,
}

impl PreparedMaterial {
    fn new(surface: SurfaceMaterial) -> PreparedMaterial {
        let needs_tangents = surface.needs_tangents();
        let uniform = surface.material.uniform().filter(|_| !needs_tangents);
        let single = [Effects::SPECULAR_REFLECTION, Effects::REFRACTION];
        let has_delta_lobes = single.into_iter().any(|effect| surface.material.effects().contains(effect));
        let is_dispersive = surface.material.effects().contains(Effects::DISPERSION);
        PreparedMaterial { uniform, needs_tangents, transmits: surface.material.transmits(), is_dispersive, has_delta_lobes, surface }
    }

    /// Surface of this material.
    #[inline(always)]
    fn surface<'a>(&self, point: SurfacePoint, bsdf: Bsdf<'a>, emission: Option<(Emission, u32)>) -> Surface<'a> {
        Surface {
            transmits: self.transmits,
            is_dispersive: self.is_dispersive && matches!(bsdf, Bsdf::Compound(_)),
            ..Surface::new(point, bsdf, emission)
        }
    }

    /// Sets the shading normal of the normal or bump map, and the frame along the tangents.
    ///
    /// - `tangents`: ∂p/∂u, ∂p/∂v (m)
    /// - `view`: ray from the viewer
    fn set_shading_frame(&self, surface: &mut Surface, tangents: Option<[Vec3; 2]>, view: &Ray) {
        let ns = match (&self.surface.normal_modifier, tangents) {
            (Some(normal_modifier), Some(tangents)) => normal_modifier.normal(&surface.point, tangents, -view.direction),
            _ => surface.point.ns,
        };
        surface.set_shading_frame(ns, tangents.map(|[u, _]| u));
    }
}

/// Place where a shape shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapePlace {
    /// In world space.
    World,
    /// In instances of its group. This is one of them.
    Instance(InstanceId),
    /// Nowhere, because copies of it show.
    Nowhere,
}

/// Appearance of a shape.
struct ShapeAppearance {
    /// Appearance of each part.
    parts: Vec<PartAppearance>,
    /// Index of the light of the first primitive. The lights of the other primitives follow.
    first_light: u32,
    has_shadow_terminator_offset: bool,
}

/// Material and emission of a part of a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct PartAppearance {
    /// Material.
    pub material: MaterialId,
    /// Emission; `None` if the part does not emit.
    pub emitter: Option<Emitter>,
}

/// Greatest coordinate of a scene (m). Sums of a few squares of such coordinates are within the range of f32.
pub const MAX_EXTENT: f64 = 1e18;

impl World {
    /// A builder of a scene with a camera and nothing else.
    pub fn builder(camera: Camera) -> WorldBuilder {
        WorldBuilder::new(camera)
    }

    /// Centre (m, the user's coordinates) and radius (m) of a sphere around all shapes; the radius is 0 if there are none.
    pub fn bounding_sphere(&self) -> (DVec3, f64) {
        let bounds = &self.bounds;
        match bounds.is_empty() {
            true => (self.origin, 0.0),
            false => (bounds.center().as_dvec3() + self.origin, f64::from(bounds.radius())),
        }
    }

    /// Number of primitives of all shapes, those of groups counted once.
    pub fn primitive_count(&self) -> u64 {
        let shown = (0..).zip(self.shapes.iter()).filter(|(shape, _)| self.place(*shape) != ShapePlace::Nowhere);
        shown.map(|(_, shape)| shape.count() as u64).sum()
    }

    /// Number of instances, with those within them.
    pub fn instance_count(&self) -> u32 {
        self.hierarchy.instance_count()
    }

    /// Shape that was described, of which this one may be a copy: an index among the shapes of the scene and then those of the groups,
    /// in the order in which they were added.
    pub fn described_shape(&self, shape: u32) -> u32 {
        self.described[shape as usize]
    }

    /// Shapes: those of the scene in world space; those of groups, and all that move, in the space of their group; copies at rest in world
    /// space.
    pub fn shapes(&self) -> Arc<[Box<dyn Shape>]> {
        self.shapes.clone()
    }

    /// Place where a shape shows.
    pub fn place(&self, shape: u32) -> ShapePlace {
        self.places[shape as usize]
    }

    /// First of a shape's materials that bounds a body, such as glass; `None` if all are opaque or thin.
    pub fn body_material(&self, shape: usize) -> Option<MaterialId> {
        let materials = self.appearances.get(shape)?.parts.iter().map(|part| part.material);
        materials.into_iter().find(|id| self.materials[id.0 as usize].surface.material.passage() == Passage::Body)
    }

    /// Whether a shape is only the boundary of a medium, so that rays do not hit it.
    pub fn is_interface(&self, shape: u32) -> bool {
        self.place(shape) == ShapePlace::World && self.materials(shape).all(|material| matches!(material, Material::Interface(_)))
    }

    /// Material at a hit.
    pub fn material(&self, hit: &Hit) -> &Material {
        &self.prepared_material(hit).surface.material
    }

    /// Materials of a shape's parts.
    pub fn materials(&self, shape: u32) -> impl Iterator<Item = &Material> {
        self.appearances[shape as usize].parts.iter().map(|part| &self.materials[part.material.0 as usize].surface.material)
    }
}

impl World {
    /// Surface point of a hit.
    #[inline]
    fn point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        if let Some(id) = hit.instance {
            return self.point_of_instance(id, ray, hit);
        }
        self.shapes[hit.shape as usize].point(hit.primitive, ray, &ShapeHit { t: hit.t, uv: hit.uv })
    }

    /// Surface at a point.
    ///
    /// - `footprint`: area over which textures are averaged
    /// - `ray`: ray that hit the point, along which light is absorbed
    /// - `view`: ray from the viewer, towards which shading normals are bent
    #[inline(always)]
    fn surface_at(&self, point: SurfacePoint, footprint: Option<Footprint>, ray: &Ray, view: &Ray, hit: &Hit) -> Surface<'_> {
        if let Some(id) = hit.instance {
            return self.surface_of_instance(id, point, footprint, ray, view, hit);
        }
        let part = self.part_appearance(hit);
        let (appearance, prepared) = (&self.appearances[hit.shape as usize], &self.materials[part.material.0 as usize]);
        let emission = part.emitter.as_ref().map(|e| (e.at(&TextureContext::exact(&point)), appearance.first_light + hit.primitive));
        if let (Some(bsdf), false) = (prepared.uniform, appearance.has_shadow_terminator_offset) {
            return prepared.surface(point, bsdf, emission);
        }
        let bsdf = prepared.surface.material.bsdf_at(&HitContext {
            texture: TextureContext { footprint, ..TextureContext::exact(&point) },
            inside: length_inside(ray, hit, &point),
            wavelength: None,
        });
        if appearance.has_shadow_terminator_offset || prepared.needs_tangents {
            return self.with_shading_frame(prepared.surface(point, bsdf, emission), view, hit);
        }
        prepared.surface(point, bsdf, emission)
    }

    /// Appearance of the part that was hit.
    #[inline]
    fn part_appearance(&self, hit: &Hit) -> &PartAppearance {
        let appearance = &self.appearances[hit.shape as usize];
        let part = if appearance.parts.len() > 1 { self.shapes[hit.shape as usize].part(hit.primitive, hit.uv) as usize } else { 0 };
        &appearance.parts[part]
    }

    /// Material of the part that was hit.
    #[inline]
    fn prepared_material(&self, hit: &Hit) -> &PreparedMaterial {
        let of_instance = hit.instance.and_then(|id| self.hierarchy.instance(id, 0.0).material());
        let material = of_instance.unwrap_or_else(|| self.part_appearance(hit).material);
        &self.materials[material.0 as usize]
    }

    /// Derivatives of the position by the texture coordinates at a hit (m).
    fn tangents(&self, point: &SurfacePoint, view: &Ray, hit: &Hit) -> Option<[Vec3; 2]> {
        match hit.instance {
            Some(id) => self.tangents_of_instance(id, point, view, hit),
            None => self.shapes[hit.shape as usize].tangents(hit.primitive, point, view.time),
        }
    }

    /// The surface with its shadow terminator offset, its tangent frame, and its normal or bump map.
    #[inline(never)]
    fn with_shading_frame<'a>(&self, mut surface: Surface<'a>, ray: &Ray, hit: &Hit) -> Surface<'a> {
        let (shape, prepared) = (&self.shapes[hit.shape as usize], self.prepared_material(hit));
        if self.appearances[hit.shape as usize].has_shadow_terminator_offset {
            surface.set_shadow_origin(shape.shadow_terminator_offset(hit.primitive, hit.uv, &surface.point, ray.time), ray);
        }
        if prepared.needs_tangents {
            let tangents = self.tangents(&surface.point, ray, hit);
            prepared.set_shading_frame(&mut surface, tangents, ray);
        }
        surface
    }

    /// First hit that is not in a hole.
    #[inline(never)]
    fn intersect_past_holes(&self, ray: &Ray) -> Option<Hit> {
        let (mut onward, mut hit, mut distance) = (*ray, self.hierarchy.intersect(ray)?, 0.0);
        for passed in 0..MAX_HOLES {
            let Some(opacity) = &self.prepared_material(&hit).surface.opacity else { break };
            let point = self.point(&onward, &hit);
            if hole_number(ray, passed) < opacity.scalar(&TextureContext::exact(&point)) {
                break;
            }
            // The origin is off the surface and so off the ray; lengths are measured along the ray.
            let origin = offset_ray_origin(&point, ray.direction);
            distance = (origin - ray.origin).dot(ray.direction);
            onward = Ray { origin, from: ray.at(distance), t_max: ray.t_max - distance, ..*ray };
            hit = self.hierarchy.intersect(&onward)?;
        }
        if distance == 0.0 {
            return Some(hit);
        }
        Some(Hit { t: distance + onward.length(hit.t, self.point(&onward, &hit).ng), ..hit })
    }
}

/// Length of the ray inside the body whose surface it hits (m).
///
/// A ray that hits a surface from inside has been inside since its last hit. This is exact for a body without others in it.
#[inline(always)]
fn length_inside(ray: &Ray, hit: &Hit, point: &SurfacePoint) -> f32 {
    if ray.direction.dot(point.ng) > 0.0 { ray.length(hit.t, point.ng) } else { 0.0 }
}

/// Greatest number of holes that a ray passes.
const MAX_HOLES: u32 = 4096;

/// Pseudorandom number in [0, 1) for a ray and the surface that it hits after `passed` holes. It is compared with the opacity of the
/// surface.
///
/// The number is a hash of the ray, so that the same ray always passes the same holes. A surface that a ray hits twice, such as a
/// sphere, has two numbers. Exponents are left out of the hash, so that a scene of twice the size has the same holes.
fn hole_number(ray: &Ray, passed: u32) -> f32 {
    const EXPONENT: u32 = 0xff << 23;
    let line = ray.origin.to_array().into_iter().chain(ray.direction.to_array()).map(|x| x.to_bits() & !EXPONENT);
    let key = line.chain([passed]).fold(0, hash::absorb);
    float::unit_f32(hash::halves(key).0)
}

impl Scene for World {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        if self.has_holes { self.intersect_past_holes(ray) } else { self.hierarchy.intersect(ray) }
    }

    fn occluded(&self, ray: &Ray) -> bool {
        if self.has_holes { self.intersect(ray).is_some() } else { self.hierarchy.occluded(ray) }
    }

    fn surface(&self, ray: &Ray, hit: &Hit) -> Surface<'_> {
        self.surface_at(self.point(ray, hit), None, ray, ray, hit)
    }

    fn surface_with_footprint(&self, ray: &Ray, hit: &Hit, differential: &RayDifferential) -> (Surface<'_>, Option<SurfaceDifferential>) {
        self.surface_with_footprint(ray, hit, differential)
    }

    fn surface_seen_from(&self, ray: &Ray, hit: &Hit, wo: Vec3) -> Surface<'_> {
        let point = self.point(ray, hit);
        let view = Ray { origin: point.p + wo * hit.t, from: point.p + wo * hit.t, direction: -wo, ..*ray };
        let ns = self.point(&view, hit).ns;
        self.surface_at(SurfacePoint { ns, ..point }, None, ray, &view, hit)
    }

    fn lights(&self) -> &Lights {
        &self.lights
    }

    fn camera(&self) -> &Camera {
        &self.camera
    }

    fn media(&self) -> Option<&Media> {
        self.media.as_ref()
    }

    fn boundaries(&self, hit: &Hit, point: &SurfacePoint) -> Boundaries {
        self.boundaries_at(hit, point)
    }

    fn bodies_around(&self, p: Vec3) -> Inside {
        self.bodies_containing(p)
    }

    fn interface(&self, ray: &Ray) -> Option<InterfaceCrossing> {
        self.interface_on(ray)
    }

    fn effects(&self) -> Effects {
        self.effects
    }

    fn origin(&self) -> DVec3 {
        self.origin
    }
}
