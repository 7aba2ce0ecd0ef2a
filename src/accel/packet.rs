//! Traversal of the hierarchy by several rays side by side, one in each lane.
//!
//! The rays of a packet visit the nodes that any of them visits. Each lane does what [`Bvh::intersect`](crate::primitive::Primitive) does
//! for a single ray, with the same exact test of triangles, so that the hits have the same bits. Where only a few rays of a packet go on,
//! they go on as single rays.
//!
//! Tests: packets_find_what_single_rays_find.

use std::ops::Range;

use arrayvec::ArrayVec;
use glam::{Vec2, Vec3};

use super::bvh::{Bvh, Nearest};
use super::leaves::{Place, Run, UNDERFLOW};
use super::node::{Child, Node, STACK, Target, WIDEN};
use crate::math::Ray;
use crate::math::float::ROUNDING;
use crate::math::lanes::{self, Kernel, Lanes, MAX_COUNT, Rays, Vector, VectorF64, Width, each_lane, to_array};
use crate::primitive::{Hit, Primitive};
use crate::shape::{FacetUv, ShapeHit, triangle};

/// Greatest number of rays that enter an inner node as single rays. Renders take the same time with 2 to 6.
const FEW: u32 = 3;

/// Number of nodes above which rays that go different ways are traced one by one. A packet visits boxes in the order of one of its rays, and
/// what is in the wrong order for another ray costs the more, the deeper the hierarchy is: in `benches/peers/rays.rs` diffuse rays side by
/// side take 1.1 times as long in the `blob` of 10⁶ triangles, and twice as long in the `beams` of 2.6·10⁶.
const LARGE: usize = 1 << 16;

/// Nearest hits of rays side by side.
#[derive(Clone, Copy)]
pub struct Hits {
    /// Bit mask of the rays that hit something. The other numbers hold for these only.
    pub found: u32,
    /// Indices of the shapes.
    pub shape: [u32; MAX_COUNT],
    /// Indices of the primitives within the shapes.
    pub primitive: [u32; MAX_COUNT],
    /// First coordinates on the primitives.
    pub u: [f32; MAX_COUNT],
    /// Second coordinates on the primitives.
    pub v: [f32; MAX_COUNT],
    /// Ray parameters (m).
    pub t: [f32; MAX_COUNT],
    /// Numbers of the triangles for [`Rays::skip`]; numbers of no triangle for other surfaces.
    pub place: [u32; MAX_COUNT],
}

impl Hits {
    /// No hits.
    #[inline(always)]
    fn none() -> Hits {
        let (numbers, zeros) = ([0; MAX_COUNT], [0.0; MAX_COUNT]);
        Hits { found: 0, shape: numbers, primitive: numbers, u: zeros, v: zeros, t: zeros, place: [NO_PLACE; MAX_COUNT] }
    }

    /// Hit of a ray that hit something.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> Hit {
        let (shape, primitive, uv) = (self.shape[lane], self.primitive[lane], Vec2::new(self.u[lane], self.v[lane]));
        Hit { instance: None, shape, primitive, uv, t: self.t[lane] }
    }
}

/// No triangle.
pub const NO_PLACE: u32 = u32::MAX;

/// What is known of the nearest hits so far.
///
/// A candidate is a triangle that the exact test may accept. For each ray only the candidate that may be the nearest is kept. After the
/// traversal the exact test decides about these candidates, in all lanes at once. Where another candidate may be as near, or where the test
/// refuses the candidate, the ray is traced again as a single one.
struct Candidates {
    /// Lower bound of the candidate's distance; infinite if there is none.
    first: [f32; MAX_COUNT],
    /// Lower bound of the distances of all others.
    second: [f32; MAX_COUNT],
    /// Upper bound of the nearest hit's distance, above it.
    limit: [f32; MAX_COUNT],
    place: [Place; MAX_COUNT],
    /// Index of the candidate's first coordinate among those of the leaves, and the distance to the next.
    corners: [(u32, u32); MAX_COUNT],
    /// Hits of curved primitives and of single rays, where the candidate is one. They are exact.
    known: [ShapeHit; MAX_COUNT],
    /// Bit mask of the rays whose candidate is known exactly.
    is_known: u32,
}

/// Rays prepared for the tests.
struct Packet<'a, L: Lanes> {
    rays: &'a Rays<L>,
    single: SingleRays,
    /// Finite inverse of the direction.
    inverse: Vector<L>,
    origin: VectorF64<L>,
    direction: VectorF64<L>,
}

/// The rays for the tests of single ones.
struct SingleRays {
    origin: [[f32; MAX_COUNT]; 3],
    direction: [[f32; MAX_COUNT]; 3],
    t_max: [f32; MAX_COUNT],
}

impl SingleRays {
    #[inline(always)]
    fn new<L: Lanes>(rays: &Rays<L>) -> SingleRays {
        let mut t_max = [0.0; MAX_COUNT];
        L::store(rays.t_max, &mut t_max);
        SingleRays { origin: rays.origin.to_arrays(), direction: rays.direction.to_arrays(), t_max }
    }

    #[inline(always)]
    fn get(&self, k: usize) -> Ray {
        let (o, d) = (&self.origin, &self.direction);
        let ray = Ray::new(Vec3::new(o[0][k], o[1][k], o[2][k]), Vec3::new(d[0][k], d[1][k], d[2][k]));
        Ray { t_max: self.t_max[k], ..ray }
    }
}

/// Child that some rays have yet to visit.
#[derive(Clone, Copy)]
struct Entry<L: Lanes> {
    child: Child,
    /// Bit mask of the rays.
    rays: u32,
    /// Distances at which the rays enter the child's box.
    near: L::F32,
}

impl<'a, L: Lanes> Packet<'a, L> {
    #[inline(always)]
    fn new(rays: &'a Rays<L>) -> Packet<'a, L> {
        let d = rays.direction;
        Packet {
            inverse: Vector { x: bounded_inverse::<L>(d.x), y: bounded_inverse::<L>(d.y), z: bounded_inverse::<L>(d.z) },
            origin: rays.origin.widened(),
            direction: d.widened(),
            single: SingleRays::new(rays),
            rays,
        }
    }

    /// Whether all rays go the same way along each axis, so that they meet boxes in about the same order.
    #[inline(always)]
    fn has_one_order(&self, active: L::Mask) -> bool {
        let (d, zero, all) = (self.rays.direction, L::f32(0.0), L::bits(active));
        let (x, y, z) = (L::bits(L::lt(d.x, zero)) & all, L::bits(L::lt(d.y, zero)) & all, L::bits(L::lt(d.z, zero)) & all);
        (x == 0 || x == all) && (y == 0 || y == all) && (z == 0 || z == all)
    }

    /// Rays that leave the triangle at a place, which therefore they do not hit.
    #[inline(always)]
    fn leaves_from(&self, place: Place) -> L::Mask {
        L::eq_u32(self.rays.skip, L::u32(place.number()))
    }

    /// Distances at which the rays enter the box of a child, and the rays that hit it before `t_max`.
    #[inline(always)]
    fn enter(&self, [min, max]: [Vec3; 2], t_max: L::F32) -> (L::F32, L::Mask) {
        let (o, inverse) = (self.rays.origin, self.inverse);
        let x = slab::<L>([min.x, max.x], o.x, inverse.x);
        let y = slab::<L>([min.y, max.y], o.y, inverse.y);
        let z = slab::<L>([min.z, max.z], o.z, inverse.z);
        let near = L::max(L::max(x.0, y.0), L::max(z.0, L::f32(0.0)));
        let far = L::min(L::min(x.1, y.1), L::min(z.1, t_max));
        (near, L::le(near, far * L::f32(WIDEN)))
    }
}

/// Finite inverse, as for single rays: see [`Slabs::new`](super::node::Slabs::new).
#[inline(always)]
fn bounded_inverse<L: Lanes>(x: L::F32) -> L::F32 {
    let bound = f32::MAX / 2.0;
    L::min(L::max(L::f32(1.0) / x, L::f32(-bound)), L::f32(bound))
}

/// Distances at which rays enter and leave a slab.
#[inline(always)]
fn slab<L: Lanes>([min, max]: [f32; 2], origin: L::F32, inverse: L::F32) -> (L::F32, L::F32) {
    let (a, b) = ((L::f32(min) - origin) * inverse, (L::f32(max) - origin) * inverse);
    (L::min(a, b), L::max(a, b))
}

/// Products of Möller and Trumbore for one triangle and several rays, with bounds of their errors: see [`Run::products`].
struct Products<L: Lanes> {
    det: L::F32,
    u: L::F32,
    v: L::F32,
    t: L::F32,
    slack: L::F32,
    t_slack: L::F32,
}

impl<L: Lanes> Products<L> {
    #[inline(always)]
    fn new([a, b, c]: [Vec3; 3], rays: &Rays<L>) -> Products<L> {
        let (e1, e2) = (b - a, c - a);
        let edge = L::f32(e1.abs().max_element().max(e2.abs().max_element()));
        let (e1, e2) = (Vector::<L>::splat(e1), Vector::<L>::splat(e2));
        let (s, d) = (rays.origin - Vector::splat(a), rays.direction);
        let (p, q) = (d.cross(e2), s.cross(e1));
        let det = e1.dot(p);
        let sign = L::copysign(L::f32(1.0), det);
        let greatest = L::max(L::max(L::abs(s.x), L::abs(s.y)), L::abs(s.z));
        let slack = L::f32(128.0 * ROUNDING) * (greatest + edge) * edge;
        let underflow = L::f32(UNDERFLOW);
        Products {
            det: L::abs(det),
            u: s.dot(p) * sign,
            v: d.dot(q) * sign,
            t: e2.dot(q) * sign,
            slack: slack + underflow,
            t_slack: slack * edge + underflow,
        }
    }

    /// Bounds of the distances at which the rays hit, the upper one for those that surely do.
    #[inline(always)]
    fn distances(&self) -> [L::F32; 2] {
        let &Products { det, t, slack, t_slack, .. } = self;
        let near = (t - t_slack) / (det + slack) * L::f32(1.0 - 4.0 * f32::EPSILON);
        // Beyond the range of f32 nothing is known.
        let is_bound = L::le(slack, det) & L::lt(L::f32(0.0), near) & L::lt(near, L::f32(f32::INFINITY));
        let near = L::select(is_bound, near, L::f32(0.0));
        [near, (t + t_slack) / (det - slack) * L::f32(1.0 + 4.0 * f32::EPSILON)]
    }

    /// Rays whose hit the exact test may accept.
    #[inline(always)]
    fn may_hit(&self, t_max: L::F32) -> L::Mask {
        let &Products { det, u, v, t, slack, t_slack } = self;
        let below = -slack;
        let inside = L::le(below, u) & L::le(below, v) & L::le(u + v, det + slack);
        let beyond = L::lt((det + slack) * t_max + t_slack, t);
        let elsewhere = L::lt(t, -t_slack) | beyond;
        (inside & !elsewhere) | L::lt(det, slack)
    }

    /// Rays whose hit the exact test surely accepts.
    #[inline(always)]
    fn surely_hit(&self, t_max: L::F32) -> L::Mask {
        let &Products { det, u, v, t, slack, t_slack } = self;
        let inside = L::le(slack, u) & L::le(slack, v) & L::le(u + v, det - slack);
        let between = L::lt(t_slack, t) & L::lt(t + t_slack, (det - slack) * t_max);
        inside & between & L::lt(det, L::f32(f32::MAX))
    }
}

impl Bvh {
    /// Nearest hits with 0 < t < t_max of the rays in the lanes of `active`. The hierarchy has no instances.
    #[inline(always)]
    pub fn nearest_of_many<L: Lanes>(&self, rays: &Rays<L>, active: L::Mask) -> Hits {
        let packet = Packet::new(rays);
        if self.nodes.len() > LARGE && !packet.has_one_order(active) {
            return self.hits_one_by_one(&packet, L::bits(active));
        }
        let mut candidates = Candidates::new(&packet);
        let mut stack = ArrayVec::<Entry<L>, STACK>::new();
        if let Some(child) = self.root {
            stack.push(Entry { child, rays: L::bits(active), near: L::f32(0.0) });
        }
        while let Some(Entry { child, rays: visiting, near }) = stack.pop() {
            let limit = L::load(&candidates.limit);
            let visiting = L::mask(visiting) & L::le(near, limit * L::f32(WIDEN));
            let which = L::bits(visiting);
            if which == 0 {
                continue;
            }
            if which.count_ones() <= FEW && matches!(child.target(), Target::Inner(_)) {
                self.nearest_of_few(&packet, which, child, &mut candidates);
                continue;
            }
            match child.target() {
                Target::Inner(node) => push_children(&self.nodes[node], &packet, which, limit, &mut stack),
                Target::Run(first, count) => candidates.add_run(self.leaves.run(first, count), &packet, visiting),
                Target::Bundle(_) => self.nearest_of_few(&packet, which, child, &mut candidates),
                Target::Mixed(leaf) => {
                    let (runs, bundles, curved) = self.leaves.mixed(leaf);
                    for run in runs {
                        candidates.add_run(run, &packet, visiting);
                    }
                    for bundle in bundles {
                        self.nearest_of_few(&packet, which, Child::bundle(bundle), &mut candidates);
                    }
                    self.curved_nearest(&packet, which, curved, &mut candidates);
                }
            }
        }
        self.hits(&packet, &candidates, L::bits(active))
    }

    /// Rays of the lanes of `active` that hit anything with 0 < t < t_max. The hierarchy has no instances.
    #[inline(always)]
    pub fn occluded_of_many<L: Lanes>(&self, rays: &Rays<L>, active: L::Mask) -> L::Mask {
        let packet = Packet::new(rays);
        let mut open = L::bits(active);
        let mut stack = ArrayVec::<(Child, u32), STACK>::new();
        stack.extend(self.root.map(|child| (child, open)));
        while let Some((child, visiting)) = stack.pop() {
            let which = visiting & open;
            if which == 0 {
                continue;
            }
            if which.count_ones() <= FEW && matches!(child.target(), Target::Inner(_)) {
                open &= !self.occluded_of_few(&packet, which, child);
                continue;
            }
            let visiting = L::mask(which);
            match child.target() {
                Target::Inner(node) => {
                    let node = &self.nodes[node];
                    for (slot, bounds) in node.boxes() {
                        let (_, hit) = packet.enter(bounds, rays.t_max);
                        let hit = L::bits(hit & visiting);
                        if hit != 0 {
                            stack.push((node.child[slot], hit));
                        }
                    }
                }
                Target::Run(first, count) => open &= !run_occludes(self.leaves.run(first, count), &packet, visiting),
                Target::Bundle(_) => open &= !self.occluded_of_few(&packet, which, child),
                Target::Mixed(leaf) => {
                    let (runs, bundles, curved) = self.leaves.mixed(leaf);
                    for run in runs {
                        open &= !run_occludes(run, &packet, visiting);
                    }
                    for bundle in bundles {
                        open &= !self.occluded_of_few(&packet, which & open, Child::bundle(bundle));
                    }
                    open &= !self.occluded_by_curved(&packet, which & open, curved);
                }
            }
        }
        active & !L::mask(open)
    }

    /// Adds the nearest hits of some rays below a child, ray by ray.
    #[inline(always)]
    fn nearest_of_few<L: Lanes>(&self, packet: &Packet<L>, which: u32, child: Child, candidates: &mut Candidates) {
        for k in each_lane(which) {
            let mut nearest = candidates.single(k);
            self.descend(child, &packet.single.get(k), &mut nearest);
            if nearest.place != Place::NONE {
                candidates.add_known(k, nearest.place, nearest.hit);
            }
        }
    }

    /// Adds the nearest hits of some rays with the curved primitives in a leaf.
    #[inline(always)]
    fn curved_nearest<L: Lanes>(&self, packet: &Packet<L>, which: u32, places: Range<u32>, candidates: &mut Candidates) {
        for place in places.map(Place::curved) {
            let Some(item) = self.leaves.item(place) else { continue };
            let shape = &self.shapes[item.shape as usize];
            if let Some(ellipsoid) = shape.ellipsoid() {
                let limit = L::load(&candidates.limit);
                let (t, found) = ellipsoid.intersect_lanes::<L>(packet.origin, packet.direction, limit);
                let t = to_array::<L>(t);
                for k in each_lane(L::bits(found) & which) {
                    candidates.add_known(k, place, ShapeHit { t: t[k], uv: Vec2::ZERO });
                }
            } else {
                for k in each_lane(which) {
                    let ray = Ray { t_max: candidates.limit[k], ..packet.single.get(k) };
                    if let Some(hit) = shape.intersect(item.primitive, &ray) {
                        candidates.add_known(k, place, hit);
                    }
                }
            }
        }
    }

    /// Which of some rays hit any of the curved primitives in a leaf.
    #[inline(always)]
    fn occluded_by_curved<L: Lanes>(&self, packet: &Packet<L>, which: u32, places: Range<u32>) -> u32 {
        let mut open = which;
        for place in places.map(Place::curved) {
            let Some(item) = self.leaves.item(place) else { continue };
            let shape = &self.shapes[item.shape as usize];
            if let Some(ellipsoid) = shape.ellipsoid() {
                let (_, hit) = ellipsoid.intersect_lanes::<L>(packet.origin, packet.direction, packet.rays.t_max);
                open &= !L::bits(hit);
            } else {
                for k in each_lane(open) {
                    open &= !(u32::from(shape.intersect(item.primitive, &packet.single.get(k)).is_some()) << k);
                }
            }
            if open == 0 {
                break;
            }
        }
        which & !open
    }

    /// Which of some rays hit anything below a child, ray by ray.
    #[inline(always)]
    fn occluded_of_few<L: Lanes>(&self, packet: &Packet<L>, which: u32, child: Child) -> u32 {
        let mut hit = 0;
        for k in each_lane(which) {
            hit |= u32::from(self.is_any_below(child, &packet.single.get(k))) << k;
        }
        hit
    }

    /// The nearest hits: candidates that the exact test accepts before all others, and those of single rays.
    #[inline(always)]
    fn hits<L: Lanes>(&self, packet: &Packet<L>, candidates: &Candidates, active: u32) -> Hits {
        let mut hits = Hits::none();
        let (infinity, second) = (L::f32(f32::INFINITY), L::load(&candidates.second));
        let exists = L::bits(L::lt(L::load(&candidates.first), infinity)) & active;
        let tested = exists & !candidates.is_known;
        let mut sure = 0;
        if tested != 0 {
            let hit = triangle::intersect_many(packet.origin, packet.direction, self.corners_of_lanes::<L>(candidates), L::mask(tested));
            sure = L::bits(hit.found & L::lt(hit.t, second) & L::lt(hit.t, packet.rays.t_max));
            L::store(hit.t, &mut hits.t);
            L::store(hit.u, &mut hits.u);
            L::store(hit.v, &mut hits.v);
        }
        for k in each_lane(exists & candidates.is_known) {
            let ShapeHit { t, uv } = candidates.known[k];
            (hits.t[k], hits.u[k], hits.v[k]) = (t, uv.x, uv.y);
            sure |= u32::from(t < candidates.second[k]) << k;
        }
        for k in each_lane(sure) {
            let Some(item) = self.leaves.item(candidates.place[k]) else { continue };
            (hits.shape[k], hits.primitive[k], hits.place[k]) = (item.shape, item.primitive, candidates.place[k].number());
            if item.facet_uv != FacetUv::Triangle {
                let uv = item.facet_uv.uv(Vec2::new(hits.u[k], hits.v[k]));
                (hits.u[k], hits.v[k]) = (uv.x, uv.y);
            }
        }
        hits.found = sure;
        for k in each_lane(exists & !sure) {
            self.hit_of_one(&packet.single.get(k), k, &mut hits);
        }
        hits
    }

    /// Nearest hits of rays that are traced one by one.
    #[inline(always)]
    fn hits_one_by_one<L: Lanes>(&self, packet: &Packet<L>, active: u32) -> Hits {
        let mut hits = Hits::none();
        for k in each_lane(active) {
            self.hit_of_one(&packet.single.get(k), k, &mut hits);
        }
        hits
    }

    /// Hit of a ray that is traced as a single one.
    #[inline(never)]
    fn hit_of_one(&self, ray: &Ray, k: usize, hits: &mut Hits) {
        if let Some((Hit { shape, primitive, uv, t, .. }, place)) = self.nearest_with_place(ray) {
            (hits.shape[k], hits.primitive[k], hits.t[k], hits.u[k], hits.v[k]) = (shape, primitive, t, uv.x, uv.y);
            (hits.found, hits.place[k]) = (hits.found | 1 << k, place.number());
        }
    }

    /// Corners of the candidates.
    #[inline(always)]
    fn corners_of_lanes<L: Lanes>(&self, candidates: &Candidates) -> [VectorF64<L>; 3] {
        let (mut first, mut step) = ([0; MAX_COUNT], [0; MAX_COUNT]);
        for k in 0..L::COUNT {
            (first[k], step[k]) = candidates.corners[k];
        }
        let (first, step) = (L::load_u32(&first), L::load_u32(&step));
        let corners = self.leaves.corners();
        let step3 = step * L::u32(3);
        [
            corner_of_lanes::<L>(corners, first, step).widened(),
            corner_of_lanes::<L>(corners, first + step3, step).widened(),
            corner_of_lanes::<L>(corners, first + step3 + step3, step).widened(),
        ]
    }
}

/// Corners with the coordinates at some places of a table.
#[inline(always)]
fn corner_of_lanes<L: Lanes>(table: &[f32], first: L::U32, step: L::U32) -> Vector<L> {
    Vector { x: L::gather(table, first), y: L::gather(table, first + step), z: L::gather(table, first + step + step) }
}

impl Candidates {
    #[inline(always)]
    fn new<L: Lanes>(packet: &Packet<L>) -> Candidates {
        let none = [f32::INFINITY; MAX_COUNT];
        Candidates {
            first: none,
            second: none,
            limit: packet.single.t_max,
            place: [Place::NONE; MAX_COUNT],
            corners: [(0, 0); MAX_COUNT],
            known: [ShapeHit { t: 0.0, uv: Vec2::ZERO }; MAX_COUNT],
            is_known: 0,
        }
    }

    /// Adds the triangles of a run.
    #[inline(always)]
    fn add_run<L: Lanes>(&mut self, run: Run, packet: &Packet<L>, visiting: L::Mask) {
        for lane in 0..run.len() {
            let limit = L::load(&self.limit);
            let products = Products::new(run.triangle(lane), packet.rays);
            let candidates = products.may_hit(limit * L::f32(WIDEN)) & visiting & !packet.leaves_from(run.place(lane));
            if !L::any(candidates) {
                continue;
            }
            let infinity = L::f32(f32::INFINITY);
            let [near, far] = products.distances();
            let near = L::select(candidates, near, infinity);
            let sure = products.surely_hit(limit) & candidates;
            L::store(L::min(L::select(sure, far, infinity), limit), &mut self.limit);
            let (first, second) = (L::load(&self.first), L::load(&self.second));
            let nearer = L::lt(near, first);
            L::store(L::min(second, L::max(first, near)), &mut self.second);
            L::store(L::min(near, first), &mut self.first);
            let replaced = L::bits(nearer);
            for k in each_lane(replaced) {
                (self.place[k], self.corners[k]) = (run.place(lane), run.corners_at(lane));
            }
            self.is_known &= !replaced;
        }
    }

    /// What a single ray may still find.
    #[inline(always)]
    fn single(&self, k: usize) -> Nearest {
        let limit = self.limit[k];
        Nearest { hit: ShapeHit { t: limit, uv: Vec2::ZERO }, place: Place::NONE, t_max: limit, within: None }
    }

    /// Adds the exact hit of a ray with an item.
    #[inline(always)]
    fn add_known(&mut self, k: usize, place: Place, hit: ShapeHit) {
        let t = hit.t;
        if t < self.first[k] {
            self.second[k] = self.first[k];
            (self.first[k], self.place[k], self.known[k]) = (t, place, hit);
            self.is_known |= 1 << k;
        } else {
            self.second[k] = self.second[k].min(t);
        }
        // Equally near hits are still found.
        self.limit[k] = self.limit[k].min(t.next_up());
    }
}

/// Which rays hit a run of triangles.
#[inline(always)]
fn run_occludes<L: Lanes>(run: Run, packet: &Packet<L>, visiting: L::Mask) -> u32 {
    let (mut open, t_max) = (visiting, packet.rays.t_max);
    for lane in 0..run.len() {
        let corners = run.triangle(lane);
        let products = Products::new(corners, packet.rays);
        let candidates = products.may_hit(t_max) & open & !packet.leaves_from(run.place(lane));
        if !L::any(candidates) {
            continue;
        }
        let sure = products.surely_hit(t_max) & candidates;
        let unsure = candidates & !sure;
        open = open & !sure;
        if L::any(unsure) {
            let [a, b, c] = corners;
            let corners = [VectorF64::splat(a.as_dvec3()), VectorF64::splat(b.as_dvec3()), VectorF64::splat(c.as_dvec3())];
            let hit = triangle::intersect_many(packet.origin, packet.direction, corners, unsure);
            open = open & !(hit.found & L::lt(hit.t, t_max));
        }
        if !L::any(open) {
            break;
        }
    }
    L::bits(visiting & !open)
}

/// Pushes the children of a node that some rays enter, those last that the first ray enters first.
#[inline(always)]
fn push_children<L: Lanes>(node: &Node, packet: &Packet<L>, which: u32, best: L::F32, stack: &mut ArrayVec<Entry<L>, STACK>) {
    let (visiting, first_ray) = (L::mask(which), which.trailing_zeros() as usize);
    let mut order = ArrayVec::<(f32, Entry<L>), { super::node::WIDTH }>::new();
    for (slot, bounds) in node.boxes() {
        let (near, hit) = packet.enter(bounds, best);
        let rays = L::bits(hit & visiting);
        if rays == 0 {
            continue;
        }
        let key = lanes::get::<L>(near, first_ray);
        let at = order.iter().position(|(other, _)| *other < key).unwrap_or(order.len());
        order.insert(at, (key, Entry { child: node.child[slot], rays, near }));
    }
    stack.extend(order.into_iter().map(|(_, entry)| entry));
}

/// Nearest hits of rays that are traced side by side, each as [`Primitive::intersect`] finds it.
pub fn intersect_all(primitives: &dyn Primitive, rays: &[Ray], width: Width) -> Vec<Option<Hit>> {
    let found = Bvh::for_packets(primitives).and_then(|bvh| width.run_wide(IntersectAll { bvh, rays }));
    found.unwrap_or_else(|| rays.iter().map(|ray| primitives.intersect(ray)).collect())
}

/// Which of several rays that are traced side by side hit something, each as [`Primitive::occluded`] finds it.
pub fn occluded_all(primitives: &dyn Primitive, rays: &[Ray], width: Width) -> Vec<bool> {
    let found = Bvh::for_packets(primitives).and_then(|bvh| width.run_wide(OccludedAll { bvh, rays }));
    found.unwrap_or_else(|| rays.iter().map(|ray| primitives.occluded(ray)).collect())
}

struct IntersectAll<'a> {
    bvh: &'a Bvh,
    rays: &'a [Ray],
}

impl Kernel for IntersectAll<'_> {
    type Output = Vec<Option<Hit>>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Vec<Option<Hit>> {
        let mut all = Vec::with_capacity(self.rays.len());
        for group in self.rays.chunks(L::COUNT) {
            let (rays, active) = Rays::<L>::new(group);
            let hits = self.bvh.nearest_of_many(&rays, active);
            for k in 0..group.len() {
                let hit = Hit {
                    instance: None,
                    shape: hits.shape[k],
                    primitive: hits.primitive[k],
                    uv: Vec2::new(hits.u[k], hits.v[k]),
                    t: hits.t[k],
                };
                all.push((hits.found >> k & 1 == 1).then_some(hit));
            }
        }
        all
    }
}

struct OccludedAll<'a> {
    bvh: &'a Bvh,
    rays: &'a [Ray],
}

impl Kernel for OccludedAll<'_> {
    type Output = Vec<bool>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Vec<bool> {
        let mut all = Vec::with_capacity(self.rays.len());
        for group in self.rays.chunks(L::COUNT) {
            let (rays, active) = Rays::<L>::new(group);
            let hit = L::bits(self.bvh.occluded_of_many(&rays, active));
            for k in 0..group.len() {
                all.push(hit >> k & 1 == 1);
            }
        }
        all
    }
}
