//! Warnings about glass that does not enclose a volume: open meshes, single sheets, inconsistent winding.

use glam::Vec2;

use crate::bsdf::Passage;
use crate::math::{Discrete, Frame, Local, Ray, float, warp};
use crate::primitive::Hit;
use crate::sampler::hash;
use crate::scene::Scene as _;
use crate::shape::{SurfacePoint, offset_ray_origin};
use crate::world::{ShapePlace, World};

/// The number of test paths into each shape, unless that makes more than `MOST_WAYS` in total. For a pane without rims that is two
/// hundred times as wide as thick, about twenty of them leave through the missing rims.
const WAYS: u32 = 2048;
/// The largest number of test paths in total.
const MOST_WAYS: u32 = 1 << 15;
/// The number of test paths that rounding at edges may lose.
const LOST_BY_ROUNDING: u32 = 2;
/// The number of hits after which a test path is given up.
const MOST_HITS: u32 = 64;
/// The largest number of shapes that warnings name.
const NAMED: usize = 4;

/// Warnings about glass shapes that light can enter and then be outside of without crossing their surface.
///
/// - `names`: the name of each shape of the world
pub(super) fn warnings(world: &World, names: &[&str]) -> Vec<String> {
    let shapes = world.shapes();
    let glass: Vec<u32> = (0..shapes.len() as u32).filter(|&shape| is_glass(world, shape)).collect();
    let ways = MOST_WAYS.checked_div(glass.len() as u32).map_or(0, |ways| ways.min(WAYS));
    let lost = glass.into_iter().map(|shape| (shape, lost(world, shape, ways)));
    let open: Vec<(u32, u32)> = lost.filter(|&(_, lost)| lost > LOST_BY_ROUNDING).collect();
    let mut said: Vec<String> =
        open.iter().take(NAMED).map(|&(shape, lost)| sentence(names[world.described_shape(shape) as usize], lost, ways)).collect();
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

/// Whether a shape is to be tested: some part of it is glass, and its surface can be sampled.
fn is_glass(world: &World, shape: u32) -> bool {
    world.materials(shape).any(|material| material.passage() == Passage::Body) && world.shapes()[shape as usize].is_sampled()
}

/// The number of test paths into a shape that end outside of it without having left it.
fn lost(world: &World, shape: u32, ways: u32) -> u32 {
    let geometry = &world.shapes()[shape as usize];
    let instance = match world.place(shape) {
        ShapePlace::Instance(id) => Some(id),
        ShapePlace::World => None,
        ShapePlace::Nowhere => return 0,
    };
    let hit_on = |primitive| Hit { instance, shape, primitive, uv: Vec2::ZERO, t: 0.0 };
    let of_glass = |primitive: &u32| world.material(&hit_on(*primitive)).passage() == Passage::Body;
    let areas: Vec<f32> = (0..geometry.count()).map(|i| if of_glass(&i) { geometry.area(i) } else { 0.0 }).collect();
    let Some(by_area) = Discrete::new(&areas) else { return 0 };
    let is_lost = |way: &u32| {
        let mut numbers = Numbers(hash::absorb(hash::absorb(0, shape), *way));
        let (primitive, _, _) = by_area.sample(numbers.pair().x);
        let hit = hit_on(primitive as u32);
        let (point, _) = geometry.sample_area(primitive as u32, numbers.pair());
        is_lost(world, &hit, &world.placed(&hit, point), &mut numbers)
    };
    (0..ways).filter(is_lost).count() as u32
}

/// Whether a path into a body hits what cannot be inside of it: nothing at all, or the outer side of the same glass.
///
/// The path goes straight on through thin sheets and scatters at opaque surfaces. So water in a basin counts as a body, and a single
/// pane in a closed room does not. A path that hits the outer side of another glass is not lost: touching media share one face.
fn is_lost(world: &World, entered: &Hit, from: &SurfacePoint, numbers: &mut Numbers) -> bool {
    let glass = world.material(entered);
    let mut ray = scattered(from, -1.0, numbers);
    for _ in 0..MOST_HITS {
        let Some(hit) = world.intersect(&ray) else { return true };
        let (point, material) = (world.surface(&ray, &hit).point, world.material(&hit));
        let is_outside = ray.direction.dot(point.ng) < 0.0;
        ray = match material.passage() {
            Passage::Body => {
                let is_same = (hit.instance, hit.shape) == (entered.instance, entered.shape);
                return is_outside && is_same && std::ptr::eq(material, glass);
            }
            Passage::Sheet => Ray::new(offset_ray_origin(&point, ray.direction), ray.direction),
            Passage::Blocked => scattered(&point, if is_outside { 1.0 } else { -1.0 }, numbers),
        };
    }
    false
}

/// A ray in a random direction that leaves a surface on the side of its normal, or on the other side for a `side` of −1.
fn scattered(point: &SurfacePoint, side: f32, numbers: &mut Numbers) -> Ray {
    let direction = Frame::around(point.ng * side).to_world(Local(warp::cosine_hemisphere(numbers.pair())));
    Ray::new(offset_ray_origin(point, direction), direction)
}

/// The random numbers in [0, 1) of one test path.
struct Numbers(u64);

impl Numbers {
    fn pair(&mut self) -> Vec2 {
        self.0 = hash::mix(self.0);
        let (a, b) = hash::halves(self.0);
        Vec2::new(float::unit_f32(a), float::unit_f32(b))
    }
}
