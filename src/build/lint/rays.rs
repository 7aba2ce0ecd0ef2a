//! Random rays of the tests for mistakes.

use glam::{Vec2, Vec3};

use crate::bsdf::{Material, Passage};
use crate::effects::Effects;
use crate::light::{EmittedRay, Light};
use crate::math::{Aabb, Density, Discrete, Frame, Local, Ray, float, warp};
use crate::primitive::{Hit, InstanceId};
use crate::sampler::hash;
use crate::scene::{Scene as _, Surface};
use crate::shape::{SurfacePoint, offset_ray_origin};
use crate::world::{ShapePlace, World};

/// The random numbers in [0, 1) of one test ray or path.
#[derive(Clone)]
pub struct Numbers(u64);

impl Numbers {
    /// The numbers of a ray.
    ///
    /// - `set`: what the ray tests, such as a shape
    pub fn new(set: u32, ray: u32) -> Numbers {
        Numbers(hash::absorb(hash::absorb(0, set), ray))
    }

    pub fn pair(&mut self) -> Vec2 {
        self.0 = hash::mix(self.0);
        let (a, b) = hash::halves(self.0);
        Vec2::new(float::unit_f32(a), float::unit_f32(b))
    }

    /// A random unit vector.
    pub fn direction(&mut self) -> Vec3 {
        warp::uniform_sphere(self.pair())
    }
}

/// A point of a surface, with the hit that names the surface.
#[derive(Clone)]
pub struct OnShape {
    pub hit: Hit,
    pub point: SurfacePoint,
    pub numbers: Numbers,
}

/// The largest number of primitives of a shape whose areas are compared for [`points`].
const MOST_COMPARED: u32 = 10_000;

/// Random points of a shape, of equal density where it has few primitives, and on random ones of many; none if the shape cannot be sampled
/// or shows nowhere.
pub fn points(world: &World, shape: u32, count: u32) -> impl Iterator<Item = OnShape> {
    let geometry = &*world.shapes()[shape as usize];
    let primitives = if is_sampled(world, shape) { geometry.count() } else { 0 };
    let by_area = (primitives <= MOST_COMPARED).then(|| Discrete::new(&(0..primitives).map(|i| geometry.area(i)).collect::<Vec<_>>()));
    (0..count).filter_map(move |k| {
        let mut numbers = Numbers::new(shape, k);
        let choice = numbers.pair().x;
        let primitive = match &by_area {
            Some(by_area) => by_area.as_ref()?.sample(choice).0 as u32,
            None => (choice * primitives as f32) as u32,
        };
        Some(point(world, shape, primitive, numbers))
    })
}

/// Random points of a shape's primitives of some materials, of equal density; none if the shape cannot be sampled or shows nowhere.
pub fn points_of(world: &World, shape: u32, count: u32, is_meant: impl Fn(&Material) -> bool) -> impl Iterator<Item = OnShape> {
    let geometry = &*world.shapes()[shape as usize];
    let instance = instance(world, shape);
    let hit_on = |primitive| Hit { instance, shape, primitive, uv: Vec2::ZERO, t: 0.0 };
    let area = |i: u32| if is_meant(world.material(&hit_on(i))) { geometry.area(i) } else { 0.0 };
    let areas: Vec<f32> = if is_sampled(world, shape) { (0..geometry.count()).map(area).collect() } else { vec![] };
    let by_area = Discrete::new(&areas);
    (0..count).filter_map(move |k| {
        let mut numbers = Numbers::new(shape, k);
        let primitive = by_area.as_ref()?.sample(numbers.pair().x).0 as u32;
        Some(point(world, shape, primitive, numbers))
    })
}

/// Whether points of a shape can be sampled, and it shows somewhere.
fn is_sampled(world: &World, shape: u32) -> bool {
    world.shapes()[shape as usize].is_sampled() && world.place(shape) != ShapePlace::Nowhere
}

/// An instance that shows the shape, if it is part of a group.
fn instance(world: &World, shape: u32) -> Option<InstanceId> {
    match world.place(shape) {
        ShapePlace::Instance(id) => Some(id),
        ShapePlace::World | ShapePlace::Nowhere => None,
    }
}

/// A random point of a primitive.
fn point(world: &World, shape: u32, primitive: u32, mut numbers: Numbers) -> OnShape {
    let hit = Hit { instance: instance(world, shape), shape, primitive, uv: Vec2::ZERO, t: 0.0 };
    let (point, _) = world.shapes()[shape as usize].sample_area(primitive, numbers.pair());
    OnShape { hit, point: world.placed(&hit, point), numbers }
}

/// A ray in a random direction that leaves a surface on the side of its normal, or on the other side for a `side` of −1.
pub fn scattered(point: &SurfacePoint, side: f32, numbers: &mut Numbers) -> Ray {
    let direction = Frame::around(point.ng * side).to_world(Local(warp::cosine_hemisphere(numbers.pair())));
    onward(point, direction)
}

/// A ray that leaves a surface in a direction.
pub fn onward(point: &SurfacePoint, direction: Vec3) -> Ray {
    Ray::new(offset_ray_origin(point, direction), direction)
}

/// What a ray meets first.
pub struct Met<'a> {
    pub hit: Hit,
    pub surface: Surface<'a>,
    pub passage: Passage,
    pub material: &'a Material,
    /// Whether the ray comes from the side of the normal.
    pub is_outside: bool,
}

/// What a ray meets first.
pub fn meet<'a>(world: &'a World, ray: &Ray) -> Option<Met<'a>> {
    let hit = world.intersect(ray)?;
    let (surface, material) = (world.surface(ray, &hit), world.material(&hit));
    let is_outside = ray.direction.dot(surface.point.ng) < 0.0;
    Some(Met { hit, surface, passage: material.passage(), material, is_outside })
}

/// Whether two hits are of the same shape in the same place.
pub fn are_of_one_shape(a: &Hit, b: &Hit) -> bool {
    (a.instance, a.shape) == (b.instance, b.shape)
}

/// The number of emitted rays of all lights together.
const EMITTED: u32 = 1 << 12;

/// Random rays that lights at finite distances emit.
pub fn emitted(world: &World) -> impl Iterator<Item = EmittedRay> {
    let finite = Effects::AREA_LIGHT | Effects::POINT_LIGHT;
    let count = if world.lights().effects() - finite == world.lights().effects() { 0 } else { EMITTED };
    let rays = (0..count).filter_map(|k| {
        let mut numbers = Numbers::new(u32::MAX - 1, k);
        let (position, direction, choice) = (numbers.pair(), numbers.pair(), numbers.pair().x);
        world.lights().emit(choice, position, direction, 0.0)
    });
    // The starts of rays from infinity have a density over a disk around the scene.
    rays.filter(|emitted| emitted.point.is_some() || matches!(emitted.position, Density::Delta))
}

/// The number of directions in which [`surrounding`] looks.
const DIRECTIONS: u32 = 128;

/// The shape whose inner side random rays from a point meet in all directions, and what is behind it; `None` if any of them meets something
/// else. Lamps that the rays meet do not count, unless they are three quarters of all: a ray from a lamp may meet the lamp itself.
pub fn surrounding(world: &World, point: Vec3) -> Option<(u32, Passage)> {
    let (mut known, mut count) = (None, 0);
    for k in 0..DIRECTIONS {
        let Met { hit, surface, passage, is_outside, .. } = meet(world, &Ray::new(point, Numbers::new(0, k).direction()))?;
        if surface.emission.is_some() {
            continue;
        }
        let found = (hit.shape, passage);
        if is_outside || hit.instance.is_some() || known.is_some_and(|known| known != found) {
            return None;
        }
        (known, count) = (Some(found), count + 1);
    }
    known.filter(|_| 4 * count > DIRECTIONS)
}

/// Whether some light may start within bounds.
pub fn has_light_within(world: &World, within: &Aabb) -> bool {
    let lights = world.lights();
    let mut areas = lights.iter().filter_map(|light| if let Light::Area(area) = light { Some(area.shape) } else { None });
    let overlaps = |shape: u32| {
        let bounds = bounds(world, shape);
        bounds.min.cmple(within.max).all() && bounds.max.cmpge(within.min).all()
    };
    areas.any(overlaps) || emitted(world).any(|emitted| is_within(emitted.ray.origin, within))
}

/// The bounds of a shape in the world.
pub fn bounds(world: &World, shape: u32) -> Aabb {
    let shape = &world.shapes()[shape as usize];
    (0..shape.count()).fold(Aabb::EMPTY, |all, i| all.union(shape.bounds(i)))
}

/// Whether a point is within bounds.
pub fn is_within(point: Vec3, bounds: &Aabb) -> bool {
    point.cmpge(bounds.min).all() && point.cmple(bounds.max).all()
}
