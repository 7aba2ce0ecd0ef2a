//! Leaves of the hierarchy: runs of triangles and bundles of slender items, each with a fast conservative test, and other items.

use std::ops::Range;

use arrayvec::ArrayVec;
use glam::Vec3;

use super::Item;
use super::bundle::{self, Bundle};
use super::node::Child;
use crate::math::Ray;
use crate::math::float::ROUNDING;
use crate::math::simd::{Lanes, dot, splat};
use crate::shape::triangle::{self, Tolerance};
use crate::shape::{Capsule, FacetUv, ShapeHit};

/// Greatest number of triangles in a run, which are tested side by side.
pub const LANES: usize = 8;

/// Numbers for each triangle: three coordinates of three corners.
const ROWS: usize = 9;

/// Leaves of a hierarchy.
pub struct Leaves {
    /// Coordinates of the corners, run after run. A run of n triangles has a row of n numbers for each corner and axis. [`LANES`] more
    /// numbers at the end can be read after each row, where they belong to no lane.
    corners: Vec<f32>,
    /// Item of each triangle.
    triangles: Vec<Item>,
    /// Curved primitives and instances, leaf by leaf.
    curved: Vec<Item>,
    bundles: Vec<Bundle>,
    /// Items of the bundles.
    bundled: Vec<Bundled>,
    /// Leaves that are not a single run of triangles or a single bundle.
    mixed: Vec<Mixed>,
}

/// Leaf of any items: ranges of triangles, of bundles, and of the other items.
#[derive(Clone, Copy)]
struct Mixed {
    triangles: (u32, u32),
    bundles: (u32, u32),
    curved: (u32, u32),
}

/// Items of a bundle: their shape, and the primitive in each lane.
#[derive(Clone, Copy)]
struct Bundled {
    shape: u32,
    primitives: [u32; bundle::SIZE],
}

/// Place of an item in the leaves.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Place(u32);

/// Bit of the places of items that are not flat.
const CURVED: u32 = 1 << 31;

/// Set in addition to [`CURVED`] for an item in a bundle: the lower bits are bundle · [`bundle::SIZE`] + lane.
const BUNDLED: u32 = 1 << 30;

impl Place {
    /// No item.
    pub const NONE: Place = Place(u32::MAX);

    /// Number of the place of a triangle.
    #[inline(always)]
    pub fn number(self) -> u32 {
        self.0
    }

    /// Place of an item that is not flat.
    pub fn curved(index: u32) -> Place {
        Place(index | CURVED)
    }

    /// Place of an item in a bundle.
    pub fn bundled(bundle: usize, lane: usize) -> Place {
        Place((bundle * bundle::SIZE + lane) as u32 | CURVED | BUNDLED)
    }
}

/// Triangles that are tested side by side.
#[derive(Clone, Copy)]
pub struct Run<'a> {
    corners: &'a [f32],
    /// Place of the first triangle among all of the hierarchy.
    first: usize,
    count: usize,
}

impl Leaves {
    /// No leaves, with room for some triangles.
    pub fn with_capacity(triangles: usize) -> Leaves {
        let mut corners = Vec::with_capacity(ROWS * triangles + LANES);
        corners.extend([0.0; LANES]);
        let triangles = Vec::with_capacity(triangles);
        Leaves { corners, triangles, curved: vec![], bundles: vec![], bundled: vec![], mixed: vec![] }
    }

    /// Adds a leaf.
    ///
    /// - `triangles`: items that are triangles, and their corners
    /// - `slender`: items with a capsule around each, in their order
    /// - `curved`: the other items
    pub fn push(&mut self, triangles: &[(Item, [Vec3; 3])], slender: &[(Item, Capsule)], curved: &[Item]) -> Child {
        let (first, first_bundle, first_curved) = (self.triangles.len(), self.bundles.len(), self.curved.len());
        self.corners.truncate(ROWS * first);
        for run in triangles.chunks(LANES) {
            for (k, axis) in (0..3).flat_map(|k| (0..3).map(move |axis| (k, axis))) {
                self.corners.extend(run.iter().map(|(_, corners)| corners[k][axis]));
            }
        }
        self.corners.extend([0.0; LANES]);
        self.triangles.extend(triangles.iter().map(|(item, _)| item));
        slender.chunk_by(|(a, _), (b, _)| a.shape == b.shape).flat_map(|of_shape| of_shape.chunks(bundle::SIZE)).for_each(|items| {
            self.add_bundle(items);
        });
        self.curved.extend(curved);
        let bundles = self.bundles.len() - first_bundle;
        if triangles.is_empty() && curved.is_empty() && bundles == 1 {
            return Child::bundle(first_bundle);
        }
        let is_run = bundles == 0 && curved.is_empty() && (1..=LANES).contains(&triangles.len());
        Child::run(first, triangles.len()).filter(|_| is_run).unwrap_or_else(|| {
            self.mixed.push(Mixed {
                triangles: (first as u32, self.triangles.len() as u32),
                bundles: (first_bundle as u32, self.bundles.len() as u32),
                curved: (first_curved as u32, self.curved.len() as u32),
            });
            Child::mixed(self.mixed.len() - 1)
        })
    }

    /// Frees memory that was reserved for more leaves.
    pub fn shrink_to_fit(&mut self) {
        self.bundles.shrink_to_fit();
        self.bundled.shrink_to_fit();
        self.curved.shrink_to_fit();
        self.mixed.shrink_to_fit();
    }

    /// Adds a bundle of at most [`bundle::SIZE`] items of a shape.
    fn add_bundle(&mut self, items: &[(Item, Capsule)]) {
        let mut bundled = Bundled { shape: items[0].0.shape, primitives: [0; bundle::SIZE] };
        for (primitive, (item, _)) in bundled.primitives.iter_mut().zip(items) {
            *primitive = item.primitive;
        }
        let capsules: ArrayVec<Capsule, { bundle::SIZE }> = items.iter().map(|(_, capsule)| *capsule).collect();
        self.bundles.push(Bundle::new(&capsules));
        self.bundled.push(bundled);
    }

    /// Run of `count` triangles from the triangle `first` on.
    #[inline(always)]
    pub fn run(&self, first: usize, count: usize) -> Run<'_> {
        // The last row begins 8 · count numbers after the first.
        let end = ROWS * first + (ROWS - 1) * count + LANES;
        Run { corners: &self.corners[ROWS * first..end], first, count }
    }

    /// Coordinates of the corners of all triangles, see [`Run::corners_at`].
    pub fn corners(&self) -> &[f32] {
        &self.corners
    }

    /// Runs of a leaf of any items, its bundles, and the places of the other items.
    pub fn mixed(&self, index: usize) -> (impl Iterator<Item = Run<'_>>, Range<usize>, Range<u32>) {
        let Mixed { triangles: (first, end), bundles, curved } = self.mixed[index];
        let runs = (first as usize..end as usize).step_by(LANES);
        let runs = runs.map(move |start| self.run(start, LANES.min(end as usize - start)));
        (runs, bundles.0 as usize..bundles.1 as usize, curved.0..curved.1)
    }

    /// Capsules around the items of a bundle.
    #[inline(always)]
    pub fn bundle(&self, index: usize) -> &Bundle {
        &self.bundles[index]
    }

    /// Item at a place.
    #[inline(always)]
    pub fn item(&self, place: Place) -> Option<Item> {
        match place {
            Place::NONE => None,
            Place(place) if place & CURVED == 0 => self.triangles.get(place as usize).copied(),
            Place(place) if place & BUNDLED == 0 => self.curved.get((place & !CURVED) as usize).copied(),
            Place(place) => {
                let place = (place & !(CURVED | BUNDLED)) as usize;
                let Bundled { shape, primitives } = self.bundled.get(place / bundle::SIZE)?;
                Some(Item { shape: *shape, primitive: primitives[place % bundle::SIZE], facet_uv: FacetUv::Triangle })
            }
        }
    }
}

impl Run<'_> {
    /// Place of the triangle in a lane.
    #[inline(always)]
    pub fn place(&self, lane: usize) -> Place {
        Place((self.first + lane) as u32)
    }

    /// Number of triangles.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.count
    }

    /// Index of the first coordinate of the triangle in a lane among those of all leaves, and the distance from one to the next.
    #[inline(always)]
    pub fn corners_at(&self, lane: usize) -> (u32, u32) {
        ((ROWS * self.first + lane) as u32, self.count as u32)
    }

    /// Corners of the triangle in a lane.
    #[inline(always)]
    pub fn triangle(&self, lane: usize) -> [Vec3; 3] {
        [self.corner(0, lane), self.corner(1, lane), self.corner(2, lane)]
    }

    #[inline(always)]
    fn corner(&self, k: usize, lane: usize) -> Vec3 {
        let (first, count) = (3 * k * self.count + lane, self.count);
        Vec3::new(self.corners[first], self.corners[first + count], self.corners[first + 2 * count])
    }

    /// Exact test of the triangle in a lane.
    #[inline(always)]
    pub fn intersect<T: Tolerance>(&self, lane: usize, ray: &Ray, t_max: f32, tolerance: T) -> Option<ShapeHit> {
        triangle::intersect_with_tolerance(ray, t_max, self.triangle(lane), tolerance)
    }

    /// Products that decide about hits with all triangles.
    ///
    /// They are the products of Möller and Trumbore in f32. With edges ≤ e, |origin − corner| ≤ s per axis and |d| ≤ 1, a triple product
    /// is a sum of six terms ≤ s·e (or e²), each rounded at most seven times, so that its error is below 2⁻²⁴·6·7·s·e. The bound used is
    /// 2⁻²⁴·128·(s + e)·e + 2⁻¹²⁴. The second term is for products below the normal numbers of f32, each of which is off by 2⁻¹⁵⁰ at most:
    /// where such a product is multiplied by a large s, either the first term is greater than that, or the determinant is within the
    /// bound, and the exact test decides. The numerator of t has one more factor e. A tolerance τ allows for products that are
    /// 2 √3 τ e < 4 τ e less than 0.
    ///
    /// Source: Möller and Trumbore, *Fast, Minimum Storage Ray/Triangle Intersection* (1997).
    #[inline(always)]
    pub fn products<L: Lanes, T: Tolerance>(&self, ray: &Ray, tolerance: T) -> Products<L> {
        let count = self.count;
        let row = |row: usize| match self.corners[row * count..].first_chunk() {
            Some(numbers) => L::load(numbers),
            None => L::splat(f32::NAN),
        };
        let corner = |k: usize| [row(3 * k), row(3 * k + 1), row(3 * k + 2)];
        let (o, d) = (splat(ray.origin.to_array()), splat(ray.direction.to_array()));
        let a = corner(0);
        let (e1, e2, s) = (minus(corner(1), a), minus(corner(2), a), minus(o, a));
        let edge = greatest(e1).larger(greatest(e2));
        let (p, q) = (cross(d, e2), cross(s, e1));
        let det = dot(e1, p);
        let (u, v, t) = (dot(s, p).signed_by(det), dot(d, q).signed_by(det), dot(e2, q).signed_by(det));
        let mut slack = L::splat(128.0 * ROUNDING).times(greatest(s).plus(edge)).times(edge);
        if !T::IS_EXACT {
            slack = slack.plus(L::splat(4.0 * tolerance.get()).times(edge));
        }
        let underflow = L::splat(UNDERFLOW);
        let [slack, t_slack] = [slack.plus(underflow), slack.times(edge).plus(underflow)];
        Products { det: det.signed_by(det), u, v, t, slack, t_slack, lanes: (1 << count) - 1 }
    }
}

/// Determinant, numerators of the barycentric weights and of t, and bounds of their errors, for the triangles of a run.
#[derive(Clone, Copy)]
pub struct Products<L> {
    det: L,
    u: L,
    v: L,
    t: L,
    slack: L,
    t_slack: L,
    lanes: u32,
}

impl<L: Lanes> Products<L> {
    /// Bit mask of the lanes that the exact test may accept. It contains all lanes that the test accepts, and few others. A lane whose
    /// determinant is within its error is kept. Coordinates above 2⁴⁰ m are beyond what it promises, because products of
    /// three lengths are beyond the range of f32.
    ///
    /// Tests: certain_hits_are_hits, row G1 of `pt torture`, the_hierarchy_finds_what_a_linear_search_finds.
    #[inline(always)]
    pub fn may_hit(&self, t_max: f32) -> u32 {
        let Products { det, u, v, t, slack, t_slack, lanes } = *self;
        let below = L::splat(0.0).minus(slack);
        let inside = below.at_most(u) & below.at_most(v) & u.plus(v).at_most(det.plus(slack));
        // t may overflow although the other products do not. NaN counts as neither behind nor beyond.
        let beyond = det.plus(slack).times(L::splat(t_max)).plus(t_slack).below(t);
        let elsewhere = t.below(L::splat(0.0).minus(t_slack)) | beyond;
        ((inside & !elsewhere) | det.below(slack)) & lanes
    }

    /// Bit mask of the lanes that the exact test surely accepts: all products are on the right side by more than their errors, and the
    /// determinant is within the range of f32.
    ///
    /// Tests: certain_hits_are_hits.
    #[inline(always)]
    pub fn surely_hit(&self, t_max: f32) -> u32 {
        let Products { det, u, v, t, slack, t_slack, lanes } = *self;
        let inside = slack.at_most(u) & slack.at_most(v) & u.plus(v).at_most(det.minus(slack));
        let between = t_slack.below(t) & t.plus(t_slack).below(det.minus(slack).times(L::splat(t_max)));
        let is_finite = det.below(L::splat(f32::MAX));
        inside & between & is_finite & lanes
    }
}

/// 2⁻¹²⁴, see [`Run::products`].
pub const UNDERFLOW: f32 = 1.0 / (1u128 << 124) as f32;

#[inline(always)]
fn minus<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0].minus(b[0]), a[1].minus(b[1]), a[2].minus(b[2])]
}

#[inline(always)]
fn cross<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    let minor = |i: usize, j: usize| a[i].times(b[j]).minus(a[j].times(b[i]));
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

/// Greatest absolute value.
#[inline(always)]
fn greatest<L: Lanes>(a: [L; 3]) -> L {
    a[0].size().larger(a[1].size()).larger(a[2].size())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::super::bundle::View;
    use super::super::node::Target;
    use super::*;
    use crate::math::lanes::each_lane;
    use crate::math::simd::Halves;
    use crate::shape::triangle::{Exact, Within};

    /// Numbers of very different sizes and both signs.
    fn number() -> impl Strategy<Value = f32> + Clone {
        (-1.0f32..1.0, prop_oneof![Just(0), -6i32..6, -140i32..120]).prop_map(|(x, exponent)| x * 2f32.powi(exponent))
    }

    fn vector(number: impl Strategy<Value = f32> + Clone) -> impl Strategy<Value = Vec3> {
        (number.clone(), number.clone(), number).prop_map(|(x, y, z)| Vec3::new(x, y, z))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        /// What the quick test is sure of, the exact test accepts; what the exact test accepts, the quick test does not exclude. Rays
        /// pass through points of the triangle's plane, many of them near its border, at all scales.
        #[test]
        fn certain_hits_are_hits(
            corners in prop_oneof![prop::array::uniform3(vector(-1.0f32..1.0)), prop::array::uniform3(vector(number()))],
            origin in prop_oneof![vector(-4.0f32..4.0), vector(number())],
            scale in prop_oneof![Just(0), -60i32..60],
            weights in (-0.2f32..1.2, -0.2f32..1.2, prop_oneof![Just(1.0f32), Just(1e-6), Just(0.0)]),
            end in prop_oneof![Just(f32::INFINITY), 0.9f32..1.1],
            tolerance in prop_oneof![Just(0.0f32), 1e-6f32..1e-2],
        ) {
            let scale = 2f32.powi(scale);
            let ([a, b, c], origin) = (corners.map(|v| v * scale), origin * scale);
            // The third weight brings the point near an edge.
            let target = a + (b - a) * weights.0 + (c - a) * (weights.1 * weights.2);
            let Some(direction) = (target - origin).as_dvec3().try_normalize() else { return Ok(()) };
            let ray = Ray::new(origin, direction.as_vec3());
            let t_max = end * (target - origin).length();
            let mut leaves = Leaves::with_capacity(1);
            let item = Item { shape: 0, primitive: 0, facet_uv: crate::shape::FacetUv::Triangle };
            leaves.push(&[(item, [a, b, c])], &[], &[]);
            let run = leaves.run(0, 1);
            let products = run.products::<Halves, _>(&ray, Exact);
            let is_hit = run.intersect(0, &ray, t_max, Exact).is_some();
            prop_assert!(is_hit || products.surely_hit(t_max) == 0, "a miss is said to be a hit");
            // Beyond that, nothing is promised.
            let is_held = [a, b, c, origin].iter().all(|v| v.abs().max_element() < 2f32.powi(40));
            prop_assert!(!is_hit || !is_held || products.may_hit(t_max) == 1, "a hit is excluded");
            let within = Within(tolerance * scale);
            let products = run.products::<Halves, _>(&ray, within);
            let is_hit = run.intersect(0, &ray, t_max, within).is_some();
            prop_assert!(is_hit || products.surely_hit(t_max) == 0, "a miss is said to be a hit within the tolerance");
            prop_assert!(!is_hit || !is_held || products.may_hit(t_max) == 1, "a hit within the tolerance is excluded");
        }
    }

    /// A leaf is one run if it can be, and keeps all of its items otherwise, with their corners.
    #[test]
    fn leaves_keep_all_their_items() {
        for (triangles, slender, curved) in
            [(1, 0, 0), (8, 0, 0), (9, 0, 0), (30, 0, 2), (0, 0, 3), (8, 0, 1), (0, 1, 0), (0, 8, 0), (0, 9, 0), (5, 11, 2)]
        {
            let item = |primitive| Item { shape: 7, primitive, facet_uv: crate::shape::FacetUv::Triangle };
            // Triangle i lies at the height i.
            let flat = |i: u32| (item(i), [Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| corner + Vec3::Z * i as f32));
            let mut leaves = Leaves::with_capacity(0);
            // Slender item i lies at the height 1000 + i, across the line of the ray.
            let capsule = |i: u32| Capsule { ends: [0.0, 1.0].map(|x| DVec3::new(x, 0.25, f64::from(1000 + i))), radius: 0.1 };
            leaves.push(&[flat(500)], &[(item(700), capsule(700))], &[]);
            let (own, others): (Vec<_>, Vec<_>) = ((0..triangles).map(flat).collect(), (0..curved).map(|i| item(100 + i)).collect());
            let capsules: Vec<_> = (0..slender).map(|i| (item(200 + i), capsule(i))).collect();
            let child = leaves.push(&own, &capsules, &others);
            leaves.push(&[flat(600)], &[(item(700), capsule(700))], &[]);
            let (runs, bundles, places) = match child.target() {
                Target::Run(first, count) => (vec![leaves.run(first, count)], 0..0, 0..0),
                Target::Bundle(bundle) => (vec![], bundle..bundle + 1, 0..0),
                Target::Mixed(index) => {
                    let (runs, bundles, places) = leaves.mixed(index);
                    (runs.collect(), bundles, places)
                }
                Target::Inner(_) => panic!("a leaf is not an inner node"),
            };
            assert_eq!(matches!(child.target(), Target::Run(..)), slender == 0 && curved == 0 && triangles <= 8);
            assert_eq!(matches!(child.target(), Target::Bundle(_)), triangles == 0 && curved == 0 && (1..=8).contains(&slender));
            let down = Ray::new(Vec3::new(0.25, 0.25, -1.0), Vec3::Z);
            for run in &runs {
                // The rows of one run are not those of the next one.
                let products = run.products::<Halves, _>(&down, Exact);
                let all = (1 << run.count) - 1;
                assert_eq!((products.may_hit(f32::INFINITY), products.surely_hit(f32::INFINITY)), (all, all));
            }
            let mut found = vec![];
            for (run, lane) in runs.iter().flat_map(|run| (0..run.count).map(move |lane| (run, lane))) {
                let primitive = leaves.item(run.place(lane)).expect("an item").primitive;
                let hit = run.intersect(lane, &down, f32::INFINITY, Exact).expect("a hit");
                assert_eq!(hit.t, 1.0 + primitive as f32);
                found.push(primitive);
            }
            found.extend(places.map(|place| leaves.item(Place::curved(place)).expect("an item").primitive));
            let view = View::new(&down);
            let lanes = bundles.flat_map(|index| each_lane(leaves.bundle(index).may_hit::<Halves>(&view)).map(move |lane| (index, lane)));
            found.extend(lanes.map(|(index, lane)| leaves.item(Place::bundled(index, lane)).expect("an item").primitive));
            let others = (0..curved).map(|i| 100 + i).chain((0..slender).map(|i| 200 + i));
            assert_eq!(found, (0..triangles).chain(others).collect::<Vec<_>>());
        }
    }
}
