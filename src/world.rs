//! Built scene: shapes in world space with their materials, lights and the hierarchy over them.

mod origin;

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::accel;
use crate::bsdf::{Bsdf, HitContext, Material, Passage, SurfaceMaterial};
use crate::camera::Camera;
use crate::effects::Effects;
use crate::error::{Error, Fault, Result};
use crate::light::{Area, Emitter, Light, Lights};
use crate::math::{Ray, Spectrum, Transform, float};
use crate::primitive::{Hit, Primitive};
use crate::sampler::hash;
use crate::scene::{Scene, Surface};
use crate::shape::{Geometry, Sdf, Shape, ShapeHit, SurfacePoint, offset_ray_origin};

/// Scene that is ready for rendering.
pub struct World {
    shapes: Arc<[Box<dyn Shape>]>,
    /// Appearance of each shape.
    appearances: Vec<ShapeAppearance>,
    materials: Vec<PreparedMaterial>,
    /// Whether any material has holes.
    has_holes: bool,
    hierarchy: Box<dyn Primitive>,
    lights: Lights,
    camera: Camera,
    effects: Effects,
    origin: DVec3,
}

/// Material with properties that are computed once.
struct PreparedMaterial {
    surface: SurfaceMaterial,
    /// BSDF, if it is the same everywhere and needs no tangents.
    uniform: Option<Bsdf<'static>>,
    needs_tangents: bool,
}

impl PreparedMaterial {
    fn new(surface: SurfaceMaterial) -> PreparedMaterial {
        let needs_tangents = surface.needs_tangents();
        PreparedMaterial { uniform: surface.material.uniform().filter(|_| !needs_tangents), needs_tangents, surface }
    }
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

/// Index of a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct MaterialId(u32);

/// Builder of a [`World`]. Coordinates are those of the user, in f64 where precision matters.
pub struct WorldBuilder {
    camera: Camera,
    materials: Vec<SurfaceMaterial>,
    objects: Vec<Object>,
    lights: Vec<Light>,
}

/// Shape with its transform and the appearance of its parts.
struct Object {
    geometry: Box<dyn Geometry>,
    to_world: Transform,
    parts: Vec<PartAppearance>,
}

/// Greatest coordinate of a scene (m). Squares and cubes of greater coordinates exceed the range of f32.
pub const MAX_EXTENT: f64 = 1e18;

impl World {
    /// A builder of a scene with a camera and nothing else.
    pub fn builder(camera: Camera) -> WorldBuilder {
        WorldBuilder { camera, materials: vec![], objects: vec![], lights: vec![] }
    }

    /// Number of primitives of all shapes.
    pub fn primitive_count(&self) -> u64 {
        self.shapes.iter().map(|shape| shape.count() as u64).sum()
    }

    /// Shapes in world space.
    pub fn shapes(&self) -> Arc<[Box<dyn Shape>]> {
        self.shapes.clone()
    }

    /// First material of a shape that has an inside, such as glass.
    pub fn inside(&self, shape: usize) -> Option<MaterialId> {
        let materials = self.appearances.get(shape)?.parts.iter().map(|part| part.material);
        materials.into_iter().find(|id| self.materials[id.0 as usize].surface.material.passage() == Passage::Body)
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

impl WorldBuilder {
    /// Adds a material, optionally with a normal or bump map and holes.
    pub fn material(&mut self, surface: impl Into<SurfaceMaterial>) -> MaterialId {
        self.materials.push(surface.into());
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Adds a shape with one material, which emits light if `emitter` is set.
    pub fn shape(&mut self, geometry: impl Geometry + 'static, to_world: Transform, material: MaterialId, emitter: Option<Emitter>) {
        self.parts(geometry, to_world, vec![material], emitter);
    }

    /// Adds a shape with one material per part; there must be at least one.
    pub fn parts(&mut self, geometry: impl Geometry + 'static, to_world: Transform, materials: Vec<MaterialId>, emitter: Option<Emitter>) {
        let parts = materials.into_iter().map(|material| PartAppearance { material, emitter: emitter.clone() }).collect();
        self.objects.push(Object { geometry: Box::new(geometry), to_world, parts });
    }

    /// Adds a solid whose parts may have different materials and emission.
    pub fn solid(&mut self, sdf: Sdf, to_world: Transform, parts: Vec<PartAppearance>) {
        self.objects.push(Object { geometry: Box::new(sdf), to_world, parts });
    }

    /// Adds a light that rays cannot hit, or the environment.
    pub fn light(&mut self, light: Light) {
        self.lights.push(light);
    }

    /// Builds the scene in coordinates around the region of its finest detail, with the hierarchy.
    ///
    /// # Errors
    /// `Invalid` for shapes that no ray can hit and for coordinates beyond [`MAX_EXTENT`].
    pub fn build(self) -> Result<World> {
        let origin = self.origin()?;
        let recentre = Transform::translate(-origin).unwrap_or(Transform::IDENTITY);
        let bake = |object: &Object| object.geometry.bake(&object.to_world.then(&recentre));
        let shapes: Arc<[Box<dyn Shape>]> = self.objects.iter().map(bake).collect::<Result<Vec<_>>>()?.into();
        let hierarchy = accel::build(shapes.clone());

        let mut lights: Vec<Light> = self.lights.into_iter().map(|light| light.recentred(origin)).collect();
        let appearance = |(k, object): (usize, Object)| {
            let first_light = lights.len() as u32;
            let recentred =
                |part: PartAppearance| PartAppearance { emitter: part.emitter.map(|emitter| emitter.recentred(origin)), ..part };
            let parts: Vec<PartAppearance> = object.parts.into_iter().map(recentred).collect();
            // A shape whose parts emit differently is not sampled. Its brightest emitter represents it among the lights.
            let brightness = |emitter: &Emitter| Spectrum::from_illuminant(emitter.radiance).average();
            let brightest = |a: &&Emitter, b: &&Emitter| brightness(a).total_cmp(&brightness(b));
            if let Some(emitter) = parts.iter().filter_map(|part| part.emitter.as_ref()).max_by(brightest) {
                let light = |primitive| Light::Area(Area { shape: k as u32, primitive, emitter: emitter.clone() });
                lights.extend((0..shapes[k].count()).map(light));
            }
            ShapeAppearance { parts, first_light, has_shadow_terminator_offset: shapes[k].has_shadow_terminator_offset() }
        };
        let appearances: Vec<ShapeAppearance> = self.objects.into_iter().enumerate().map(appearance).collect();
        let bounds = hierarchy.bounds();
        let lights = Lights::new(lights, shapes.clone(), (bounds.center(), bounds.radius()));
        let materials: Vec<PreparedMaterial> =
            self.materials.into_iter().map(|surface| PreparedMaterial::new(surface.recentred(origin))).collect();

        let prepared = appearances.iter().flat_map(|d| &d.parts).map(|part| materials[part.material.0 as usize].surface.effects());
        let normals = shapes.iter().filter(|s| s.has_shading_normals()).map(|_| Effects::SHADING_NORMALS);
        let smooth = shapes.iter().filter(|s| s.has_shadow_terminator_offset()).map(|_| Effects::SMOOTH_SHADOWS);
        let effects = prepared.chain(normals).chain(smooth).fold(lights.effects() | self.camera.effects(), Effects::union);
        let camera = self.camera.recentred(origin);
        let has_holes = effects.contains(Effects::CUT_OUTS);
        Ok(World { shapes, appearances, materials, has_holes, hierarchy, lights, camera, effects, origin })
    }

    /// Origin of the stored coordinates, see [`origin`].
    ///
    /// # Errors
    /// `Invalid` for coordinates beyond [`MAX_EXTENT`].
    fn origin(&self) -> Result<DVec3> {
        let boxes = self.objects.iter().map(|o| o.geometry.bounds(&o.to_world));
        let extent = boxes.map(|(min, max)| min.abs().max(max.abs()).max_element()).fold(0.0, f64::max);
        if extent > MAX_EXTENT || extent.is_nan() {
            return Err(Error::invalid(Fault::new(format!("the scene's extent {extent:.3e} exceeds {MAX_EXTENT:e}"))));
        }
        Ok(origin::of(self.objects.iter().map(|o| o.geometry.detail(&o.to_world)), self.camera.eye()))
    }
}

impl World {
    /// Surface point of a hit.
    #[inline]
    fn point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.shapes[hit.shape as usize].point(hit.primitive, ray, &ShapeHit { t: hit.t, uv: hit.uv })
    }

    /// Surface at a point.
    ///
    /// - `ray`: ray that hit the point, along which light is absorbed
    /// - `view`: ray from the viewer, towards which shading normals are bent
    #[inline(always)]
    fn surface_at(&self, point: SurfacePoint, ray: &Ray, view: &Ray, hit: &Hit) -> Surface<'_> {
        let part = self.part_appearance(hit);
        let (appearance, prepared) = (&self.appearances[hit.shape as usize], &self.materials[part.material.0 as usize]);
        let emission = part.emitter.as_ref().map(|e| (e.at(&point), appearance.first_light + hit.primitive));
        if let (Some(bsdf), false) = (prepared.uniform, appearance.has_shadow_terminator_offset) {
            return Surface::new(point, bsdf, emission);
        }
        // A ray that hits a surface from inside has been inside since its last hit. This is exact for a body without others in it.
        let inside = if ray.direction.dot(point.ng) > 0.0 { ray.length(hit.t, point.ng) } else { 0.0 };
        let bsdf = prepared.surface.material.bsdf_at(&HitContext { point, inside });
        if appearance.has_shadow_terminator_offset || prepared.needs_tangents {
            return self.with_shading_frame(Surface::new(point, bsdf, emission), view, hit);
        }
        Surface::new(point, bsdf, emission)
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
        &self.materials[self.part_appearance(hit).material.0 as usize]
    }

    /// The surface with its shadow terminator offset, its tangent frame, and its normal or bump map.
    #[inline(never)]
    fn with_shading_frame<'a>(&self, mut surface: Surface<'a>, ray: &Ray, hit: &Hit) -> Surface<'a> {
        let (shape, prepared) = (&self.shapes[hit.shape as usize], self.prepared_material(hit));
        if self.appearances[hit.shape as usize].has_shadow_terminator_offset {
            surface.set_shadow_origin(shape.shadow_terminator_offset(hit.primitive, hit.uv, &surface.point), ray);
        }
        if prepared.needs_tangents {
            let tangents = shape.tangents(hit.primitive, &surface.point);
            let ns = match (&prepared.surface.normal_modifier, tangents) {
                (Some(normal_modifier), Some(tangents)) => normal_modifier.normal(&surface.point, tangents, -ray.direction),
                _ => surface.point.ns,
            };
            surface.set_shading_frame(ns, tangents.map(|[u, _]| u));
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
            if hole_number(ray, passed) < opacity.scalar(&point) {
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
        self.surface_at(self.point(ray, hit), ray, ray, hit)
    }

    fn surface_seen_from(&self, ray: &Ray, hit: &Hit, wo: Vec3) -> Surface<'_> {
        let point = self.point(ray, hit);
        let view = Ray { origin: point.p + wo * hit.t, from: point.p + wo * hit.t, direction: -wo, ..*ray };
        let ns = self.point(&view, hit).ns;
        self.surface_at(SurfacePoint { ns, ..point }, ray, &view, hit)
    }

    fn lights(&self) -> &Lights {
        &self.lights
    }

    fn camera(&self) -> &Camera {
        &self.camera
    }

    fn effects(&self) -> Effects {
        self.effects
    }

    fn origin(&self) -> DVec3 {
        self.origin
    }
}
