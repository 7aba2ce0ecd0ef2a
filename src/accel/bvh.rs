//! Bounding volume hierarchy and its traversal.

use std::any::Any;
use std::ops::Range;

use arrayvec::ArrayVec;
use glam::{Vec2, Vec3};

use super::build::{Wide, wide};
use super::bundle::View;
use super::leaves::{Leaves, Place, Run};
use super::node::{Child, Node, STACK, Slabs, Target, WIDEN, padded};
use super::{INSTANCE, Item, Shapes};
use crate::math::lanes::each_lane;
#[cfg(target_arch = "x86_64")]
use crate::math::simd::Whole;
use crate::math::simd::{Halves, Lanes, Set};
use crate::math::{Aabb, Ray};
use crate::primitive::{Hit, Instance, InstanceId, Nesting, Primitive};
use crate::shape::triangle::{Exact, Tolerance, Within};
use crate::shape::{Capsule, Facet, FacetUv, ShapeHit};

/// Bounding volume hierarchy over the primitives of a scene, or of a group.
pub struct Bvh {
    pub(super) shapes: Shapes,
    instances: Vec<Instance>,
    bounds: Aabb,
    pub(super) nodes: Vec<Node>,
    pub(super) leaves: Leaves,
    pub(super) root: Option<Child>,
    set: Set,
    /// Whether rays can be traced side by side: there are no instances, no hits depend on where a ray ends, and the coordinates of all
    /// corners can be gathered.
    has_packets: bool,
}

/// Nearest hit so far.
pub(super) struct Nearest {
    pub hit: ShapeHit,
    pub place: Place,
    /// Limit for the tests, which accept only t < t_max: the next float above `hit.t`, so that equally near hits of lower items are found.
    pub t_max: f32,
    /// Hit within the item, if it is an instance.
    pub within: Option<Hit>,
}

impl Bvh {
    /// The hierarchy, if rays can be traced through it side by side with the hits of single rays.
    pub fn for_packets(primitives: &dyn Primitive) -> Option<&Bvh> {
        let any: &dyn Any = primitives;
        any.downcast_ref::<Bvh>().filter(|bvh| bvh.has_packets)
    }

    /// Builds the hierarchy over the primitives of the shapes with the indices `own`, and over instances.
    pub fn new(shapes: Shapes, own: Vec<u32>, instances: Vec<Instance>) -> Bvh {
        let mut bvh = Bvh {
            instances,
            bounds: Aabb::EMPTY,
            nodes: vec![],
            leaves: Leaves::with_capacity(0),
            root: None,
            set: Set::detect(),
            shapes: shapes.clone(),
            has_packets: false,
        };
        let (items, mut boxes, triangle_count) = bvh.list_items(own);
        bvh.bounds = boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
        boxes.iter_mut().for_each(|b| *b = padded(b));
        let first_instance = items.partition_point(|item| item.shape != INSTANCE);
        let mut leaves = Leaves::with_capacity(triangle_count);
        let (mut triangles, mut slender, mut curved) = (vec![], vec![], vec![]);
        let built = wide(&boxes, first_instance, |numbers| {
            triangles.clear();
            slender.clear();
            curved.clear();
            for item in numbers.iter().map(|&number| items[number as usize]) {
                match (bvh.corners(item), bvh.capsule(item)) {
                    (Some(corners), _) => triangles.push((item, corners)),
                    (None, Some(capsule)) => slender.push((item, capsule)),
                    (None, None) => curved.push(item),
                }
            }
            leaves.push(&triangles, &slender, &curved)
        });
        leaves.shrink_to_fit();
        bvh.leaves = leaves;
        let is_addressable = bvh.leaves.corners().len() < 1 << 31;
        bvh.has_packets = is_addressable && bvh.instances.is_empty() && !shapes.iter().any(|shape| shape.hits_depend_on_end());
        if let Some(Wide { mut nodes, root }) = built {
            nodes.shrink_to_fit();
            (bvh.nodes, bvh.root) = (nodes, Some(root));
        }
        bvh
    }

    /// One item per triangle, curved primitive or instance, their boxes, and the number of triangles.
    fn list_items(&self, own: Vec<u32>) -> (Vec<Item>, Vec<Aabb>, usize) {
        let (mut items, mut boxes, mut others) = (vec![], vec![], 0);
        for shape in own {
            let family = &self.shapes[shape as usize];
            for primitive in 0..family.count() {
                let mut add = |bounds: Aabb, facet_uv| {
                    boxes.push(bounds);
                    items.push(Item { shape, primitive, facet_uv });
                };
                let facet = family.facet(primitive);
                if facet == Facet::Curved {
                    add(family.bounds(primitive), FacetUv::Triangle);
                    others += 1;
                }
                facet.triangles().for_each(|(corners, facet_uv)| add(Aabb::around(corners), facet_uv));
            }
        }
        for (primitive, instance) in (0..).zip(&self.instances) {
            let bounds = instance.bounds();
            if !bounds.is_empty() {
                boxes.push(bounds);
                items.push(Item { shape: INSTANCE, primitive, facet_uv: FacetUv::Triangle });
                others += 1;
            }
        }
        let triangle_count = items.len() - others;
        (items, boxes, triangle_count)
    }

    /// Corners of an item that is a triangle.
    fn corners(&self, item: Item) -> Option<[Vec3; 3]> {
        if item.shape == INSTANCE {
            return None;
        }
        let facet = self.shapes[item.shape as usize].facet(item.primitive);
        facet.triangles().find(|(_, facet_uv)| *facet_uv == item.facet_uv).map(|(corners, _)| corners)
    }

    /// Capsule around an item that is slender.
    fn capsule(&self, item: Item) -> Option<Capsule> {
        if item.shape == INSTANCE { None } else { self.shapes[item.shape as usize].capsule(item.primitive) }
    }

    /// Updates the nearest hit with the hits in a run of triangles.
    #[inline(always)]
    fn intersect_run<L: Lanes, T: Tolerance>(&self, run: Run, ray: &Ray, tolerance: T, nearest: &mut Nearest) {
        for lane in each_lane(run.products::<L, T>(ray, tolerance).may_hit(nearest.t_max)) {
            if let Some(hit) = run.intersect(lane, ray, nearest.t_max, tolerance) {
                self.update(nearest, hit, run.place(lane));
            }
        }
    }

    /// Updates the nearest hit with the hits in a leaf of any items.
    #[inline(always)]
    fn intersect_mixed<L: Lanes, T: Tolerance>(
        &self,
        leaf: usize,
        ray: &Ray,
        view: &mut Option<View>,
        tolerance: T,
        nearest: &mut Nearest,
    ) {
        let (runs, bundles, _) = self.leaves.mixed(leaf);
        for run in runs {
            self.intersect_run::<L, T>(run, ray, tolerance, nearest);
        }
        for bundle in bundles {
            self.intersect_bundle::<L>(bundle, ray, view, nearest);
        }
        self.intersect_curved(leaf, ray, tolerance, nearest);
    }

    /// Updates the nearest hit with the hits in a bundle.
    ///
    /// - `view`: the ray's system, made for the first bundle that it meets
    #[inline(always)]
    fn intersect_bundle<L: Lanes>(&self, bundle: usize, ray: &Ray, view: &mut Option<View>, nearest: &mut Nearest) {
        for lane in each_lane(self.leaves.bundle(bundle).may_hit::<L>(view.get_or_insert_with(|| View::new(ray)))) {
            let place = Place::bundled(bundle, lane);
            let Some(Item { shape, primitive, .. }) = self.leaves.item(place) else { continue };
            if let Some(hit) = self.shapes[shape as usize].intersect(primitive, &Ray { t_max: nearest.t_max, ..*ray }) {
                self.update(nearest, hit, place);
            }
        }
    }

    /// Updates the nearest hit with the hits of the items in a leaf that are in no run and no bundle.
    #[inline(always)]
    fn intersect_curved<T: Tolerance>(&self, leaf: usize, ray: &Ray, tolerance: T, nearest: &mut Nearest) {
        let (_, _, curved) = self.leaves.mixed(leaf);
        for place in curved.map(Place::curved) {
            let Some(item) = self.leaves.item(place) else { continue };
            let ray = Ray { t_max: nearest.t_max, ..*ray };
            if item.shape == INSTANCE {
                if let Some(hit) = self.instances[item.primitive as usize].intersect(&ray, tolerance.get()) {
                    self.update_within(nearest, hit, place);
                }
            } else if let Some(hit) = self.shapes[item.shape as usize].intersect(item.primitive, &ray) {
                self.update(nearest, hit, place);
            }
        }
    }

    /// Whether the ray hits a run of triangles.
    #[inline(always)]
    fn run_occludes<L: Lanes, T: Tolerance>(run: Run, ray: &Ray, tolerance: T) -> bool {
        let products = run.products::<L, T>(ray, tolerance);
        let candidates = products.may_hit(ray.t_max);
        candidates != 0
            && (products.surely_hit(ray.t_max) != 0
                || each_lane(candidates).any(|lane| run.intersect(lane, ray, ray.t_max, tolerance).is_some()))
    }

    /// Whether the ray hits anything in a leaf of any items.
    #[inline(always)]
    fn mixed_occludes<L: Lanes, T: Tolerance>(&self, leaf: usize, ray: &Ray, view: &mut Option<View>, tolerance: T) -> bool {
        let (runs, bundles, curved) = self.leaves.mixed(leaf);
        // Loops, because a closure may be compiled apart from this function, without its instruction set.
        for run in runs {
            if Bvh::run_occludes::<L, T>(run, ray, tolerance) {
                return true;
            }
        }
        for bundle in bundles {
            if self.bundle_occludes::<L>(bundle, ray, view) {
                return true;
            }
        }
        self.curved_occlude(curved, ray, tolerance)
    }

    /// Whether the ray hits anything in a bundle.
    #[inline(always)]
    fn bundle_occludes<L: Lanes>(&self, bundle: usize, ray: &Ray, view: &mut Option<View>) -> bool {
        for lane in each_lane(self.leaves.bundle(bundle).may_hit::<L>(view.get_or_insert_with(|| View::new(ray)))) {
            let Some(Item { shape, primitive, .. }) = self.leaves.item(Place::bundled(bundle, lane)) else { continue };
            if self.shapes[shape as usize].intersect(primitive, ray).is_some() {
                return true;
            }
        }
        false
    }

    /// Whether the ray hits any of the items in a leaf that are in no run and no bundle.
    #[inline(always)]
    fn curved_occlude<T: Tolerance>(&self, curved: Range<u32>, ray: &Ray, tolerance: T) -> bool {
        for place in curved.map(Place::curved) {
            let is_hit = match self.leaves.item(place) {
                None => false,
                Some(Item { shape: INSTANCE, primitive, .. }) => self.instances[primitive as usize].occluded(ray, tolerance.get()),
                Some(Item { shape, primitive, .. }) => self.shapes[shape as usize].intersect(primitive, ray).is_some(),
            };
            if is_hit {
                return true;
            }
        }
        false
    }

    /// Replaces the nearest hit by a nearer one, or by an equally near one of a lower item.
    #[inline(always)]
    fn update(&self, nearest: &mut Nearest, hit: ShapeHit, place: Place) {
        if hit.t < nearest.hit.t || (hit.t == nearest.hit.t && self.is_before(place, nearest.place)) {
            *nearest = Nearest { hit, place, t_max: hit.t.next_up(), ..*nearest };
        }
    }

    /// Replaces the nearest hit by a nearer one in an instance.
    #[inline(never)]
    fn update_within(&self, nearest: &mut Nearest, hit: Hit, place: Place) {
        self.update(nearest, ShapeHit { t: hit.t, uv: hit.uv }, place);
        if nearest.place == place {
            nearest.within = Some(hit);
        }
    }

    /// Whether an item is before another one. No item is after all others.
    #[inline(never)]
    fn is_before(&self, place: Place, other: Place) -> bool {
        let number = |place: Place| self.leaves.item(place).map(|item| (item.shape, item.primitive, item.facet_uv as u8));
        number(other).is_none_or(|other| number(place).is_some_and(|number| number < other))
    }
}

impl Primitive for Bvh {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.nearest_with_place(ray).map(|(hit, _)| hit)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        match self.set {
            Set::Plain => self.any::<Halves, _>(ray, Exact),
            // SAFETY: `set` is AVX2 only if this machine has it.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code, reason = "sound: the set is what this machine was found to have")]
            Set::Avx2 => unsafe { self.any_avx2(ray, Exact) },
        }
    }

    fn intersect_with_tolerance(&self, ray: &Ray, tolerance: f32) -> Option<Hit> {
        match self.set {
            Set::Plain => self.nearest::<Halves, _>(ray, Within(tolerance)),
            // SAFETY: `set` is AVX2 only if this machine has it.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code, reason = "sound: the set is what this machine was found to have")]
            Set::Avx2 => unsafe { self.nearest_avx2(ray, Within(tolerance)) },
        }
        .map(|(hit, _)| hit)
    }

    fn occluded_with_tolerance(&self, ray: &Ray, tolerance: f32) -> bool {
        match self.set {
            Set::Plain => self.any::<Halves, _>(ray, Within(tolerance)),
            // SAFETY: `set` is AVX2 only if this machine has it.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code, reason = "sound: the set is what this machine was found to have")]
            Set::Avx2 => unsafe { self.any_avx2(ray, Within(tolerance)) },
        }
    }

    fn instance_count(&self) -> u32 {
        self.instances.last().map_or(0, Instance::last)
    }

    fn instance(&self, id: InstanceId, time: f32) -> Nesting<'_> {
        // Instances without others within them are numbered without gaps.
        let index = match self.instance_count() as usize == self.instances.len() {
            true => id.get() as usize - 1,
            false => self.instances.partition_point(|instance| instance.first() <= id.get()).wrapping_sub(1),
        };
        self.instances.get(index).map_or_else(Nesting::default, |instance| Nesting::new(instance, id, time))
    }
}

/// Traversals for packets whose rays go on as single rays.
impl Bvh {
    /// Nearest hit of a ray, and the place of its item.
    pub(super) fn nearest_with_place(&self, ray: &Ray) -> Option<(Hit, Place)> {
        match self.set {
            Set::Plain => self.nearest::<Halves, _>(ray, Exact),
            // SAFETY: `set` is AVX2 only if this machine has it.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code, reason = "sound: the set is what this machine was found to have")]
            Set::Avx2 => unsafe { self.nearest_avx2(ray, Exact) },
        }
    }

    /// Updates the nearest hit of a ray with those below a child.
    #[inline(always)]
    pub(super) fn descend(&self, child: Child, ray: &Ray, nearest: &mut Nearest) {
        match self.set {
            Set::Plain => self.nearest_below::<Halves, _>(child, ray, Exact, nearest),
            // SAFETY: `set` is AVX2 only if this machine has it.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code, reason = "sound: the set is what this machine was found to have")]
            Set::Avx2 => unsafe { self.nearest_below_avx2(child, ray, nearest) },
        }
    }

    /// Whether a ray hits anything below a child.
    #[inline(always)]
    pub(super) fn is_any_below(&self, child: Child, ray: &Ray) -> bool {
        match self.set {
            Set::Plain => self.any_below::<Halves, _>(child, ray, Exact),
            // SAFETY: `set` is AVX2 only if this machine has it.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code, reason = "sound: the set is what this machine was found to have")]
            Set::Avx2 => unsafe { self.any_below_avx2(child, ray) },
        }
    }
}

/// Traversals, compiled once for each instruction set.
impl Bvh {
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn nearest_below_avx2(&self, child: Child, ray: &Ray, nearest: &mut Nearest) {
        self.nearest_below::<Whole, _>(child, ray, Exact, nearest);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn any_below_avx2(&self, child: Child, ray: &Ray) -> bool {
        self.any_below::<Whole, _>(child, ray, Exact)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn nearest_avx2<T: Tolerance>(&self, ray: &Ray, tolerance: T) -> Option<(Hit, Place)> {
        self.nearest::<Whole, T>(ray, tolerance)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn any_avx2<T: Tolerance>(&self, ray: &Ray, tolerance: T) -> bool {
        self.any::<Whole, T>(ray, tolerance)
    }

    /// Nearest hit and the place of its item, by front-to-back traversal: the nearest child first, the others in order on the stack.
    #[inline(always)]
    fn nearest<L: Lanes, T: Tolerance>(&self, ray: &Ray, tolerance: T) -> Option<(Hit, Place)> {
        let mut nearest = Nearest { hit: ShapeHit { t: ray.t_max, uv: Vec2::ZERO }, place: Place::NONE, t_max: ray.t_max, within: None };
        self.nearest_below::<L, T>(self.root?, ray, tolerance, &mut nearest);
        let item = self.leaves.item(nearest.place)?;
        if item.shape == INSTANCE {
            return nearest.within.map(|hit| (hit, nearest.place));
        }
        let uv = item.facet_uv.uv(nearest.hit.uv);
        Some((Hit { instance: None, shape: item.shape, primitive: item.primitive, uv, t: nearest.hit.t }, nearest.place))
    }

    /// Updates the nearest hit with those below a child.
    #[inline(always)]
    fn nearest_below<L: Lanes, T: Tolerance>(&self, child: Child, ray: &Ray, tolerance: T, nearest: &mut Nearest) {
        let slabs = Slabs::<L>::new(ray, tolerance);
        let mut view = None;
        let mut stack = ArrayVec::<(f32, Child), STACK>::new();
        let mut next = Some((0.0, child));
        while let Some((entry, child)) = next {
            next = None;
            if entry <= nearest.hit.t * WIDEN {
                match child.target() {
                    Target::Inner(node) => next = self.nodes[node].nearest::<L, T>(&slabs, nearest.t_max, &mut stack),
                    Target::Run(first, count) => self.intersect_run::<L, T>(self.leaves.run(first, count), ray, tolerance, nearest),
                    Target::Bundle(bundle) => self.intersect_bundle::<L>(bundle, ray, &mut view, nearest),
                    Target::Mixed(leaf) => self.intersect_mixed::<L, T>(leaf, ray, &mut view, tolerance, nearest),
                }
            }
            next = next.or_else(|| stack.pop());
        }
    }

    /// Whether there is any hit, by traversal until the first hit: the last child first, which most likely stops the ray.
    #[inline(always)]
    fn any<L: Lanes, T: Tolerance>(&self, ray: &Ray, tolerance: T) -> bool {
        let Some(root) = self.root else { return false };
        self.any_below::<L, T>(root, ray, tolerance)
    }

    /// Whether there is any hit below a child.
    #[inline(always)]
    fn any_below<L: Lanes, T: Tolerance>(&self, child: Child, ray: &Ray, tolerance: T) -> bool {
        let slabs = Slabs::<L>::new(ray, tolerance);
        let mut view = None;
        let mut stack = ArrayVec::<Child, STACK>::new();
        stack.push(child);
        while let Some(child) = stack.pop() {
            let is_hit = match child.target() {
                Target::Inner(node) => {
                    let (_, hits) = self.nodes[node].intersect::<L, T>(&slabs, ray.t_max);
                    stack.extend(each_lane(hits).map(|i| self.nodes[node].child[i]));
                    false
                }
                Target::Run(first, count) => Bvh::run_occludes::<L, T>(self.leaves.run(first, count), ray, tolerance),
                Target::Bundle(bundle) => self.bundle_occludes::<L>(bundle, ray, &mut view),
                Target::Mixed(leaf) => self.mixed_occludes::<L, T>(leaf, ray, &mut view, tolerance),
            };
            if is_hit {
                return true;
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::math::Transform;
    use crate::shape::{Geometry, Sphere};

    /// Greatest excess of a box in the hierarchy over the items below it, as a share of the items' greatest coordinate.
    fn greatest_excess(bvh: &Bvh) -> f32 {
        let boxes = bvh.nodes.iter().flat_map(|node| node.boxes().map(|(slot, bounds)| (bounds, node.child[slot])));
        let excess = |([min, max], child): ([Vec3; 2], Child)| {
            let Target::Mixed(leaf) = child.target() else { return 0.0 };
            let items = bvh.leaves.mixed(leaf).2.filter_map(|index| bvh.leaves.item(Place::curved(index)));
            let bounds = items.map(|item| bvh.shapes[item.shape as usize].bounds(item.primitive)).fold(Aabb::EMPTY, Aabb::union);
            (bounds.min - min).max(max - bounds.max).max_element() / bounds.magnitude().max_element()
        };
        boxes.map(excess).fold(0.0, f32::max)
    }

    /// A far object does not enlarge the boxes of others: they exceed the items in them by two units in the last place of the items' own
    /// coordinates and by one that rounds the sum. If they were widened by the extent of the whole scene, an object 10⁶ diameters away
    /// would make each box as large as a quarter of the scene, and each ray would meet most items.
    #[test]
    fn far_objects_leave_the_boxes_of_others_alone() {
        let grid = (0..64).map(|k| DVec3::new((k % 4) as f64, (k / 4 % 4) as f64, (k / 16) as f64));
        let far = DVec3::new(4e6, 0.0, 0.0);
        let ball = |center: DVec3| Sphere { radius: 0.3 }.bake(&Transform::translate(center).expect("finite")).expect("a ball");
        let shapes: Vec<_> = grid.chain([far]).map(ball).collect();
        let bvh = Bvh::new(shapes.into(), (0..65).collect(), vec![]);
        let excess = greatest_excess(&bvh);
        assert!(excess > 0.0 && excess <= 3.0 * f32::EPSILON, "{excess:e}");
    }
}
