//! A scene, built: shapes placed, materials assigned, the hierarchy over them ready.

mod origin;

use std::sync::Arc;

use glam::DVec3;

use crate::accel;
use crate::bsdf::{Bsdf, HitContext, Material, Passage, SurfaceMaterial};
use crate::camera::Camera;
use crate::effects::Effects;
use crate::error::{Error, Fault, Result};
use crate::light::{Area, Emission, Emitter, Light, Lights};
use crate::math::{Ray, Transform, float};
use crate::primitive::{Hit, Primitive};
use crate::sampler::hash;
use crate::scene::{Scene, Surface, beside};
use crate::shape::{Geometry, Sdf, Shape, ShapeHit, SurfacePoint};

/// The one scene of production use.
pub struct World {
    shapes: Arc<[Box<dyn Shape>]>,
    dresses: Vec<Dress>,
    skins: Vec<Worn>,
    /// Whether any of them lets rays through.
    has_holes: bool,
    hierarchy: Box<dyn Primitive>,
    lights: Lights,
    camera: Camera,
    effects: Effects,
    origin: DVec3,
}

/// A skin, and what is known of it beforehand.
struct Worn {
    skin: SurfaceMaterial,
    /// The model that it is everywhere, if it is, and if it needs no more than the shading normal.
    uniform: Option<Bsdf<'static>>,
    needs_tangents: bool,
}

impl Worn {
    fn new(skin: SurfaceMaterial) -> Worn {
        let needs_tangents = skin.needs_tangents();
        Worn { uniform: skin.material.uniform().filter(|_| !needs_tangents), needs_tangents, skin }
    }
}

/// What a shape wears.
struct Dress {
    /// One per part.
    parts: Vec<Wear>,
    /// Of its first primitive; the others follow.
    first_light: u32,
    has_lift: bool,
}

/// What a part of a shape wears: its material, and what it emits.
#[derive(Clone, Debug, PartialEq)]
pub struct Wear {
    pub material: MaterialId,
    pub emitter: Option<Emitter>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct MaterialId(u32);

/// A scene in the making: coordinates are the user's, f64 where it matters.
pub struct WorldBuilder {
    camera: Camera,
    skins: Vec<SurfaceMaterial>,
    objects: Vec<Object>,
    lights: Vec<Light>,
}

struct Object {
    geometry: Box<dyn Geometry>,
    to_world: Transform,
    parts: Vec<Wear>,
}

/// Coordinates beyond this are refused: their squares and cubes would leave f32 behind.
pub const MAX_EXTENT: f64 = 1e18;

impl World {
    pub fn builder(camera: Camera) -> WorldBuilder {
        WorldBuilder { camera, skins: vec![], objects: vec![], lights: vec![] }
    }

    pub fn primitive_count(&self) -> u64 {
        self.shapes.iter().map(|shape| shape.count() as u64).sum()
    }

    pub fn shapes(&self) -> Arc<[Box<dyn Shape>]> {
        self.shapes.clone()
    }

    /// The first material of a shape that light goes into, if it has one.
    pub fn inside(&self, shape: usize) -> Option<MaterialId> {
        let materials = self.dresses.get(shape)?.parts.iter().map(|part| part.material);
        materials.into_iter().find(|id| self.skins[id.0 as usize].skin.material.passage() == Passage::Body)
    }

    /// The material that a ray met.
    pub fn material(&self, hit: &Hit) -> &Material {
        &self.worn(hit).skin.material
    }

    /// The materials of a shape's parts.
    pub fn materials(&self, shape: u32) -> impl Iterator<Item = &Material> {
        self.dresses[shape as usize].parts.iter().map(|part| &self.skins[part.material.0 as usize].skin.material)
    }

    /// The same scene, met through another structure: for tests of the hierarchy.
    pub fn with_primitives(mut self, build: impl FnOnce(Arc<[Box<dyn Shape>]>) -> Box<dyn Primitive>) -> World {
        self.hierarchy = build(self.shapes.clone());
        self
    }
}

impl WorldBuilder {
    /// A material, or a material with a relief and holes.
    pub fn material(&mut self, skin: impl Into<SurfaceMaterial>) -> MaterialId {
        self.skins.push(skin.into());
        MaterialId(self.skins.len() as u32 - 1)
    }

    /// A shape of one material; emitting where `emission` says so.
    pub fn shape(&mut self, geometry: impl Geometry + 'static, to_world: Transform, material: MaterialId, emission: Option<Emission>) {
        self.parts(geometry, to_world, vec![material], emission.map(Emitter::from));
    }

    /// A shape with one material per part; at least one.
    pub fn parts(&mut self, geometry: impl Geometry + 'static, to_world: Transform, materials: Vec<MaterialId>, emitter: Option<Emitter>) {
        let parts = materials.into_iter().map(|material| Wear { material, emitter: emitter.clone() }).collect();
        self.objects.push(Object { geometry: Box::new(geometry), to_world, parts });
    }

    /// A solid, each part of which may emit something else; one for each part.
    pub fn solid(&mut self, sdf: Sdf, to_world: Transform, parts: Vec<Wear>) {
        self.objects.push(Object { geometry: Box::new(sdf), to_world, parts });
    }

    /// A light that no ray can hit, or the environment.
    pub fn light(&mut self, light: Light) {
        self.lights.push(light);
    }

    /// Everything in world space, around the place where the scene is finest, with the hierarchy over it.
    ///
    /// # Errors
    /// `Invalid` for shapes that nothing can hit and coordinates beyond [`MAX_EXTENT`].
    pub fn build(self) -> Result<World> {
        let origin = self.origin()?;
        let recentre = Transform::translate(-origin).unwrap_or(Transform::IDENTITY);
        let bake = |object: &Object| object.geometry.bake(&object.to_world.then(&recentre));
        let shapes: Arc<[Box<dyn Shape>]> = self.objects.iter().map(bake).collect::<Result<Vec<_>>>()?.into();
        let hierarchy = accel::build(shapes.clone());

        let mut lights: Vec<Light> = self.lights.into_iter().map(|light| light.recentred(origin)).collect();
        let dress = |(k, object): (usize, Object)| {
            let first_light = lights.len() as u32;
            let recentred = |wear: Wear| Wear { emitter: wear.emitter.map(|emitter| emitter.recentred(origin)), ..wear };
            let parts: Vec<Wear> = object.parts.into_iter().map(recentred).collect();
            // What emits differently from part to part is not sampled; the brightest stands for all.
            let brightness = |emitter: &Emitter| emitter.emission.radiance.average();
            let brightest = |a: &&Emitter, b: &&Emitter| brightness(a).total_cmp(&brightness(b));
            if let Some(emitter) = parts.iter().filter_map(|part| part.emitter.as_ref()).max_by(brightest) {
                let light = |primitive| Light::Area(Area { shape: k as u32, primitive, emitter: emitter.clone() });
                lights.extend((0..shapes[k].count()).map(light));
            }
            Dress { parts, first_light, has_lift: shapes[k].has_lift() }
        };
        let dresses: Vec<Dress> = self.objects.into_iter().enumerate().map(dress).collect();
        let lights = Lights::new(lights, shapes.clone(), hierarchy.bounds().radius());
        let skins: Vec<Worn> = self.skins.into_iter().map(|skin| Worn::new(skin.recentred(origin))).collect();

        let worn = dresses.iter().flat_map(|d| &d.parts).map(|part| skins[part.material.0 as usize].skin.effects());
        let normals = shapes.iter().filter(|s| s.has_shading_normals()).map(|_| Effects::SHADING_NORMALS);
        let effects = worn.chain(normals).fold(lights.effects() | self.camera.effects(), Effects::union);
        let camera = self.camera.recentred(origin);
        let has_holes = effects.contains(Effects::CUT_OUTS);
        Ok(World { shapes, dresses, skins, has_holes, hierarchy, lights, camera, effects, origin })
    }

    /// The point around which coordinates are stored: [`origin`].
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
    #[inline]
    fn point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.shapes[hit.shape as usize].point(hit.primitive, ray, &ShapeHit { t: hit.t, uv: hit.uv })
    }

    #[inline]
    fn wear(&self, hit: &Hit) -> &Wear {
        let dress = &self.dresses[hit.shape as usize];
        let part = if dress.parts.len() > 1 { self.shapes[hit.shape as usize].part(hit.primitive, hit.uv) as usize } else { 0 };
        &dress.parts[part]
    }

    #[inline]
    fn worn(&self, hit: &Hit) -> &Worn {
        &self.skins[self.wear(hit).material.0 as usize]
    }

    /// On the smooth surface that it stands for, along its axes, and with its relief.
    #[inline(never)]
    fn dressed<'a>(&self, mut surface: Surface<'a>, ray: &Ray, hit: &Hit) -> Surface<'a> {
        let (shape, worn) = (&self.shapes[hit.shape as usize], self.worn(hit));
        if self.dresses[hit.shape as usize].has_lift {
            surface.lift(shape.lift(hit.primitive, hit.uv, &surface.point), ray);
        }
        if worn.needs_tangents {
            let tangents = shape.tangents(hit.primitive, &surface.point);
            let ns = match (&worn.skin.relief, tangents) {
                (Some(relief), Some(tangents)) => relief.normal(&surface.point, tangents, -ray.direction),
                _ => surface.point.ns,
            };
            surface.turn(ns, tangents.map(|[u, _]| u));
        }
        surface
    }

    /// The first hit that is not a hole.
    #[inline(never)]
    fn past_holes(&self, ray: &Ray) -> Option<Hit> {
        let (mut onward, mut hit, mut way) = (*ray, self.hierarchy.intersect(ray)?, 0.0);
        for passed in 0..MOST_HOLES {
            let Some(opacity) = &self.worn(&hit).skin.opacity else { break };
            let point = self.point(&onward, &hit);
            if chance(ray, passed) < opacity.scalar(&point) {
                break;
            }
            // Beside the surface, and so beside the ray itself, from which lengths count.
            let origin = beside(&point, ray.direction);
            way = (origin - ray.origin).dot(ray.direction);
            onward = Ray { origin, from: ray.at(way), t_max: ray.t_max - way, ..*ray };
            hit = self.hierarchy.intersect(&onward)?;
        }
        if way == 0.0 {
            return Some(hit);
        }
        Some(Hit { t: way + onward.length(hit.t, self.point(&onward, &hit).ng), ..hit })
    }
}

/// A ray that passes more holes than this has met a surface.
const MOST_HOLES: u32 = 4096;

/// A number in [0, 1) that belongs to a ray and the surface that it meets after it `passed` so many, for surfaces that are
/// partly there.
///
/// No two rays are alike, so that it is as good as random; the same ray finds the same surfaces again. A surface that it meets
/// twice, a sphere's, has two numbers. Exponents are left out: a scene of twice the size has the same holes.
fn chance(ray: &Ray, passed: u32) -> f32 {
    const EXPONENT: u32 = 0xff << 23;
    let line = ray.origin.to_array().into_iter().chain(ray.direction.to_array()).map(|x| x.to_bits() & !EXPONENT);
    let key = line.chain([passed]).fold(0, hash::absorb);
    float::unit_f32(hash::halves(key).0)
}

impl Scene for World {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        if self.has_holes { self.past_holes(ray) } else { self.hierarchy.intersect(ray) }
    }

    fn occluded(&self, ray: &Ray) -> bool {
        if self.has_holes { self.intersect(ray).is_some() } else { self.hierarchy.occluded(ray) }
    }

    fn surface(&self, ray: &Ray, hit: &Hit) -> Surface<'_> {
        let (point, wear) = (self.point(ray, hit), self.wear(hit));
        let (dress, worn) = (&self.dresses[hit.shape as usize], &self.skins[wear.material.0 as usize]);
        let emission = wear.emitter.as_ref().map(|e| (e.at(&point), dress.first_light + hit.primitive));
        if let (Some(bsdf), false) = (worn.uniform, dress.has_lift) {
            return Surface::new(point, bsdf, emission);
        }
        // A ray that meets a surface from inside has been inside since it last met one: exact for a body without others in it.
        let inside = if ray.direction.dot(point.ng) > 0.0 { ray.length(hit.t, point.ng) } else { 0.0 };
        let bsdf = worn.skin.material.bsdf_at(&HitContext { point, inside });
        if dress.has_lift || worn.needs_tangents {
            return self.dressed(Surface::new(point, bsdf, emission), ray, hit);
        }
        Surface::new(point, bsdf, emission)
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
