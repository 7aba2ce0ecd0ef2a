//! A scene, built: shapes placed, materials assigned, the hierarchy over them ready.

use std::sync::Arc;

use glam::DVec3;

use crate::accel;
use crate::bsdf::Material;
use crate::camera::Camera;
use crate::effects::Effects;
use crate::error::{Error, Fault, Result};
use crate::light::{Area, Emission, Light, Lights};
use crate::math::{Ray, Transform};
use crate::primitive::{Hit, Primitive};
use crate::scene::{Scene, Surface};
use crate::shape::{Geometry, Shape};

/// The one scene of production use.
pub struct World {
    shapes: Arc<[Box<dyn Shape>]>,
    dresses: Vec<Dress>,
    materials: Vec<Material>,
    hierarchy: Box<dyn Primitive>,
    lights: Lights,
    camera: Camera,
    effects: Effects,
    origin: DVec3,
}

/// What a shape wears.
struct Dress {
    /// One per part.
    materials: Vec<MaterialId>,
    emission: Option<Emission>,
    /// Of its first primitive; the others follow.
    first_light: u32,
    has_lift: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaterialId(u32);

/// A scene in the making: coordinates are the user's, f64 where it matters.
pub struct WorldBuilder {
    camera: Camera,
    materials: Vec<Material>,
    objects: Vec<Object>,
    lights: Vec<Light>,
}

struct Object {
    geometry: Box<dyn Geometry>,
    to_world: Transform,
    materials: Vec<MaterialId>,
    emission: Option<Emission>,
}

/// Coordinates beyond this are refused: their squares and cubes would leave f32 behind.
pub const MAX_EXTENT: f64 = 1e18;

impl World {
    pub fn builder(camera: Camera) -> WorldBuilder {
        WorldBuilder { camera, materials: vec![], objects: vec![], lights: vec![] }
    }

    /// What was subtracted from all coordinates, so that f32 is finest where the scene is.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    pub fn primitive_count(&self) -> u64 {
        self.shapes.iter().map(|shape| shape.count() as u64).sum()
    }

    pub fn shapes(&self) -> Arc<[Box<dyn Shape>]> {
        self.shapes.clone()
    }

    /// The same scene, met through another structure: for tests of the hierarchy.
    pub fn with_primitives(mut self, build: impl FnOnce(Arc<[Box<dyn Shape>]>) -> Box<dyn Primitive>) -> World {
        self.hierarchy = build(self.shapes.clone());
        self
    }
}

impl WorldBuilder {
    pub fn material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// A shape of one material; emitting where `emission` says so.
    pub fn shape(&mut self, geometry: impl Geometry + 'static, to_world: Transform, material: MaterialId, emission: Option<Emission>) {
        self.parts(geometry, to_world, vec![material], emission);
    }

    /// A shape with one material per part; at least one.
    pub fn parts(
        &mut self,
        geometry: impl Geometry + 'static,
        to_world: Transform,
        materials: Vec<MaterialId>,
        emission: Option<Emission>,
    ) {
        self.objects.push(Object { geometry: Box::new(geometry), to_world, materials, emission });
    }

    /// A light that no ray can hit, or the environment.
    pub fn light(&mut self, light: Light) {
        self.lights.push(light);
    }

    /// Everything in world space, around the middle of the scene, with the hierarchy over it.
    ///
    /// # Errors
    /// `Invalid` for shapes that nothing can hit and coordinates beyond [`MAX_EXTENT`].
    pub fn build(self) -> Result<World> {
        let origin = self.middle()?;
        let recentre = Transform::translate(-origin).unwrap_or(Transform::IDENTITY);
        let bake = |object: &Object| object.geometry.bake(&object.to_world.then(&recentre));
        let shapes: Arc<[Box<dyn Shape>]> = self.objects.iter().map(bake).collect::<Result<Vec<_>>>()?.into();
        let hierarchy = accel::build(shapes.clone());

        let mut lights: Vec<Light> = self.lights.into_iter().map(|light| light.recentred(origin)).collect();
        let dress = |(k, object): (usize, Object)| {
            let first_light = lights.len() as u32;
            if let Some(emission) = object.emission {
                let light = |primitive| Light::Area(Area { shape: k as u32, primitive, emission });
                lights.extend((0..shapes[k].count()).map(light));
            }
            Dress { materials: object.materials, emission: object.emission, first_light, has_lift: shapes[k].has_lift() }
        };
        let dresses: Vec<Dress> = self.objects.into_iter().enumerate().map(dress).collect();
        let lights = Lights::new(lights, shapes.clone(), hierarchy.bounds().radius());
        let materials: Vec<Material> = self.materials.into_iter().map(|m| m.recentred(origin)).collect();

        let worn = dresses.iter().flat_map(|d| &d.materials).map(|m| materials[m.0 as usize].effects());
        let normals = shapes.iter().filter(|s| s.has_shading_normals()).map(|_| Effects::SHADING_NORMALS);
        let effects = worn.chain(normals).fold(lights.effects() | self.camera.effects(), Effects::union);
        let camera = self.camera.recentred(origin);
        Ok(World { shapes, dresses, materials, hierarchy, lights, camera, effects, origin })
    }

    /// The middle of the box around all shapes.
    fn middle(&self) -> Result<DVec3> {
        let boxes = self.objects.iter().map(|o| o.geometry.bounds(&o.to_world));
        let Some((min, max)) = boxes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) else { return Ok(DVec3::ZERO) };
        let extent = min.abs().max(max.abs()).max_element();
        if extent <= MAX_EXTENT {
            return Ok(0.5 * min + 0.5 * max);
        }
        Err(Error::invalid(Fault::new(format!("the scene's extent {extent:.3e} exceeds {MAX_EXTENT:e}"))))
    }
}

impl Scene for World {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.hierarchy.intersect(ray)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.hierarchy.occluded(ray)
    }

    fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let shape = &self.shapes[hit.shape as usize];
        let dress = &self.dresses[hit.shape as usize];
        let point = shape.point(hit.primitive, ray, &crate::shape::ShapeHit { t: hit.t, uv: hit.uv });
        let part = if dress.materials.len() > 1 { shape.part(hit.primitive) as usize } else { 0 };
        let material = &self.materials[dress.materials[part].0 as usize];
        let emission = dress.emission.map(|e| (e, dress.first_light + hit.primitive));
        let mut surface = Surface::new(point, material.met(&point, ray, hit.t), emission);
        if dress.has_lift {
            surface.lift(shape.lift(hit.primitive, hit.uv, &point), ray);
        }
        if material.is_anisotropic() {
            surface = surface.along(shape.tangent(hit.primitive, &point));
        }
        surface
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
}
