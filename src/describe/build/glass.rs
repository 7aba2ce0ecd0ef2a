//! Glass that is no body: open meshes, single sheets, faces that look both ways.

use glam::Vec2;

use crate::bsdf::Passage;
use crate::math::{Discrete, Frame, Local, Ray, float, warp};
use crate::primitive::Hit;
use crate::sampler::hash;
use crate::scene::{Scene as _, offset_ray_origin};
use crate::shape::SurfacePoint;
use crate::world::World;

/// How many ways into each shape are followed, as long as they are no more than `MOST_WAYS` in all: of those into a pane without rims,
/// twenty are lost where it is two hundred times as wide as it is thick.
const WAYS: u32 = 2048;
const MOST_WAYS: u32 = 1 << 15;
/// At most so many of them are lost by rounding at edges.
const LOST_BY_ROUNDING: u32 = 2;
/// A way that met so many surfaces says nothing.
const MOST_MEETINGS: u32 = 64;
/// How many shapes are named.
const NAMED: usize = 4;

/// Sentences about shapes of glass that light enters and then finds itself outside of, without having left them.
///
/// - `names`: one for each shape of the world
pub(super) fn warnings(world: &World, names: &[&str]) -> Vec<String> {
    let shapes = world.shapes();
    let glass: Vec<u32> = (0..shapes.len() as u32).filter(|&shape| is_glass(world, shape)).collect();
    let ways = MOST_WAYS.checked_div(glass.len() as u32).map_or(0, |ways| ways.min(WAYS));
    let lost = glass.into_iter().map(|shape| (shape, lost(world, shape, ways)));
    let open: Vec<(u32, u32)> = lost.filter(|&(_, lost)| lost > LOST_BY_ROUNDING).collect();
    let mut said: Vec<String> = open.iter().take(NAMED).map(|&(shape, lost)| sentence(names[shape as usize], lost, ways)).collect();
    said.extend((open.len() > NAMED).then(|| format!("and {} more shapes of such glass", open.len() - NAMED)));
    said
}

fn sentence(name: &str, lost: u32, ways: u32) -> String {
    let percent = (100.0 * f64::from(lost) / f64::from(ways)).max(1.0).round();
    format!(
        "{name}: open or inconsistently wound glass: {percent} % of the ways into it lead out past its surface, where light is off by the \
         square of the index; close it, all faces outwards, or make a single sheet \"thin_dielectric\""
    )
}

/// Whether it can be open: what has points to draw, and a part of glass.
fn is_glass(world: &World, shape: u32) -> bool {
    world.materials(shape).any(|material| material.passage() == Passage::Body) && world.shapes()[shape as usize].is_sampled()
}

/// How many of the ways into a shape are lost.
fn lost(world: &World, shape: u32, ways: u32) -> u32 {
    let geometry = &world.shapes()[shape as usize];
    let met = |primitive| Hit { shape, primitive, uv: Vec2::ZERO, t: 0.0 };
    let of_glass = |primitive: &u32| world.material(&met(*primitive)).passage() == Passage::Body;
    let areas: Vec<f32> = (0..geometry.count()).map(|i| if of_glass(&i) { geometry.area(i) } else { 0.0 }).collect();
    let Some(by_area) = Discrete::new(&areas) else { return 0 };
    let is_lost = |way: &u32| {
        let mut numbers = Numbers(hash::absorb(hash::absorb(0, shape), *way));
        let (primitive, _, _) = by_area.sample(numbers.pair().x);
        let (point, _) = geometry.sample_area(primitive as u32, numbers.pair());
        is_lost(world, &met(primitive as u32), &point, &mut numbers)
    };
    (0..ways).filter(is_lost).count() as u32
}

/// Whether a way into a body meets what it cannot meet inside: nothing at all, or the outer side of the same glass.
///
/// It goes straight on and is thrown back by what lets no light through, so that water in a basin is a body too, and a pane in a closed
/// room is none. What is behind the outer side of another glass is not known: two media that touch have one face.
fn is_lost(world: &World, entered: &Hit, from: &SurfacePoint, numbers: &mut Numbers) -> bool {
    let glass = world.material(entered);
    let mut ray = scattered(from, -1.0, numbers);
    for _ in 0..MOST_MEETINGS {
        let Some(hit) = world.intersect(&ray) else { return true };
        let (point, material) = (world.surface(&ray, &hit).point, world.material(&hit));
        let is_outside = ray.direction.dot(point.ng) < 0.0;
        ray = match material.passage() {
            Passage::Body => return is_outside && hit.shape == entered.shape && std::ptr::eq(material, glass),
            Passage::Sheet => Ray::new(offset_ray_origin(&point, ray.direction), ray.direction),
            Passage::Blocked => scattered(&point, if is_outside { 1.0 } else { -1.0 }, numbers),
        };
    }
    false
}

/// A ray that leaves a surface on the side of its normal, or for a `side` of −1 on the other.
fn scattered(point: &SurfacePoint, side: f32, numbers: &mut Numbers) -> Ray {
    let direction = Frame::around(point.ng * side).to_world(Local(warp::cosine_hemisphere(numbers.pair())));
    Ray::new(offset_ray_origin(point, direction), direction)
}

/// Numbers in [0, 1) that belong to one way.
struct Numbers(u64);

impl Numbers {
    fn pair(&mut self) -> Vec2 {
        self.0 = hash::mix(self.0);
        let (a, b) = hash::halves(self.0);
        Vec2::new(float::unit_f32(a), float::unit_f32(b))
    }
}
