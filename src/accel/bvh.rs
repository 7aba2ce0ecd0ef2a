//! Bounding volume hierarchy and its traversal.

use arrayvec::ArrayVec;
use glam::Vec2;

use super::bits;
use super::build::{Wide, wide};
use super::node::{Child, Node, STACK, Slabs, WIDEN, padding};
use super::packet::{LANES, Packet};
use super::{INSTANCE, Item, Shapes};
#[cfg(target_arch = "x86_64")]
use crate::math::simd::Whole;
use crate::math::simd::{Halves, Lanes, Set};
use crate::math::{Aabb, Ray};
use crate::primitive::{Hit, Instance, InstanceId, Nesting, Primitive};
use crate::shape::triangle::{Exact, Tolerance, Within};
use crate::shape::{Facet, FacetUv, ShapeHit};

/// Bounding volume hierarchy over the primitives of a scene, or of a group.
pub struct Bvh {
    shapes: Shapes,
    instances: Vec<Instance>,
    items: Vec<Item>,
    bounds: Aabb,
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    packets: Vec<Packet>,
    /// Item numbers of the curved primitives and of the instances, leaf by leaf.
    curved: Vec<u32>,
    root: Option<Child>,
    set: Set,
}

/// Leaf: ranges of packets and of items that are not flat.
#[derive(Clone, Copy)]
struct Leaf {
    packets: (u32, u32),
    curved: (u32, u32),
}

/// Nearest hit so far.
struct Nearest {
    hit: ShapeHit,
    item: u32,
    /// Limit for the tests, which accept only t < t_max: the next float above `hit.t`, so that equally near hits of lower items are found.
    t_max: f32,
    /// Hit within the item, if it is an instance.
    within: Option<Hit>,
}

impl Bvh {
    /// Builds the hierarchy over the primitives of the shapes with the indices `own`, and over instances.
    pub fn new(shapes: Shapes, own: Vec<u32>, instances: Vec<Instance>) -> Bvh {
        let mut bvh = Bvh {
            instances,
            items: vec![],
            bounds: Aabb::EMPTY,
            nodes: vec![],
            leaves: vec![],
            packets: vec![],
            curved: vec![],
            root: None,
            set: Set::detect(),
            shapes: shapes.clone(),
        };
        let mut boxes = bvh.list_items(own);
        bvh.bounds = boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
        let pad = padding(&bvh.bounds);
        boxes.iter_mut().for_each(|b| *b = b.padded(pad));
        let first_instance = bvh.items.partition_point(|item| item.shape != INSTANCE);
        if let Some(Wide { nodes, leaves, root }) = wide(&boxes, first_instance) {
            bvh.leaves = leaves.iter().map(|items| bvh.pack(items)).collect();
            (bvh.nodes, bvh.root) = (nodes, Some(root));
        }
        bvh
    }

    /// Lists one item per triangle, curved primitive or instance, and returns their boxes.
    fn list_items(&mut self, own: Vec<u32>) -> Vec<Aabb> {
        let mut boxes = vec![];
        for shape in own {
            let family = &self.shapes[shape as usize];
            for primitive in 0..family.count() {
                let mut add = |bounds: Aabb, facet_uv| {
                    boxes.push(bounds);
                    self.items.push(Item { shape, primitive, facet_uv });
                };
                let facet = family.facet(primitive);
                if facet == Facet::Curved {
                    add(family.bounds(primitive), FacetUv::Triangle);
                }
                facet.triangles().for_each(|(corners, facet_uv)| add(Aabb::around(corners), facet_uv));
            }
        }
        for (primitive, instance) in (0..).zip(&self.instances) {
            let bounds = instance.bounds();
            if !bounds.is_empty() {
                boxes.push(bounds);
                self.items.push(Item { shape: INSTANCE, primitive, facet_uv: FacetUv::Triangle });
            }
        }
        boxes
    }

    /// Makes a leaf of some items.
    fn pack(&mut self, items: &[u32]) -> Leaf {
        let (first_packet, first_curved) = (self.packets.len() as u32, self.curved.len() as u32);
        let mut triangles = vec![];
        for &number in items {
            let item = self.items[number as usize];
            let facet = if item.shape == INSTANCE { Facet::Curved } else { self.shapes[item.shape as usize].facet(item.primitive) };
            match facet.triangles().find(|(_, facet_uv)| *facet_uv == item.facet_uv) {
                Some((corners, _)) => triangles.push((number, corners)),
                None => self.curved.push(number),
            }
        }
        self.packets.extend(triangles.chunks(LANES).map(Packet::new));
        Leaf { packets: (first_packet, self.packets.len() as u32), curved: (first_curved, self.curved.len() as u32) }
    }

    /// Updates the nearest hit with the hits in a leaf.
    #[inline(always)]
    fn intersect_leaf<L: Lanes, T: Tolerance>(&self, leaf: usize, ray: &Ray, tolerance: T, nearest: &mut Nearest) {
        let leaf = self.leaves[leaf];
        for packet in &self.packets[leaf.packets.0 as usize..leaf.packets.1 as usize] {
            for lane in bits(packet.candidates::<L, T>(ray, nearest.t_max, tolerance)) {
                if let Some(hit) = packet.intersect(lane, ray, nearest.t_max, tolerance) {
                    nearest.update(hit, packet.item[lane]);
                }
            }
        }
        for &number in &self.curved[leaf.curved.0 as usize..leaf.curved.1 as usize] {
            let (item, ray) = (self.items[number as usize], Ray { t_max: nearest.t_max, ..*ray });
            if item.shape == INSTANCE {
                if let Some(hit) = self.instances[item.primitive as usize].intersect(&ray, tolerance.get()) {
                    nearest.update_within(hit, number);
                }
            } else if let Some(hit) = self.shapes[item.shape as usize].intersect(item.primitive, &ray) {
                nearest.update(hit, number);
            }
        }
    }

    /// Whether the ray hits anything in a leaf.
    #[inline(always)]
    fn leaf_occludes<L: Lanes, T: Tolerance>(&self, leaf: usize, ray: &Ray, tolerance: T) -> bool {
        let leaf = self.leaves[leaf];
        let flat = self.packets[leaf.packets.0 as usize..leaf.packets.1 as usize].iter().any(|packet| {
            let mut candidates = bits(packet.candidates::<L, T>(ray, ray.t_max, tolerance));
            candidates.any(|lane| packet.intersect(lane, ray, ray.t_max, tolerance).is_some())
        });
        flat || self.curved[leaf.curved.0 as usize..leaf.curved.1 as usize].iter().any(|&number| {
            let item = self.items[number as usize];
            match item.shape {
                INSTANCE => self.instances[item.primitive as usize].occluded(ray, tolerance.get()),
                shape => self.shapes[shape as usize].intersect(item.primitive, ray).is_some(),
            }
        })
    }
}

impl Nearest {
    /// Replaces the hit by a nearer one, or by an equally near one of a lower item.
    #[inline(always)]
    fn update(&mut self, hit: ShapeHit, item: u32) {
        if hit.t < self.hit.t || (hit.t == self.hit.t && item < self.item) {
            *self = Nearest { hit, item, t_max: hit.t.next_up(), ..*self };
        }
    }

    /// Replaces the hit by a nearer one in an instance.
    #[inline(never)]
    fn update_within(&mut self, hit: Hit, item: u32) {
        self.update(ShapeHit { t: hit.t, uv: hit.uv }, item);
        if self.item == item {
            self.within = Some(hit);
        }
    }
}

impl Primitive for Bvh {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        match self.set {
            Set::Plain => self.nearest::<Halves, _>(ray, Exact),
            // SAFETY: `set` is AVX2 only if this machine has it.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code, reason = "sound: the set is what this machine was found to have")]
            Set::Avx2 => unsafe { self.nearest_avx2(ray, Exact) },
        }
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

    fn instance(&self, id: InstanceId) -> Nesting<'_> {
        // Instances without others within them are numbered without gaps.
        let index = match self.instance_count() as usize == self.instances.len() {
            true => id.get() as usize - 1,
            false => self.instances.partition_point(|instance| instance.first() <= id.get()).wrapping_sub(1),
        };
        self.instances.get(index).map_or_else(Nesting::default, |instance| Nesting::new(instance, id))
    }
}

/// Traversals, compiled once for each instruction set.
impl Bvh {
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn nearest_avx2<T: Tolerance>(&self, ray: &Ray, tolerance: T) -> Option<Hit> {
        self.nearest::<Whole, T>(ray, tolerance)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn any_avx2<T: Tolerance>(&self, ray: &Ray, tolerance: T) -> bool {
        self.any::<Whole, T>(ray, tolerance)
    }

    /// Nearest hit, by front-to-back traversal: the nearest child first, the others in order on the stack.
    #[inline(always)]
    fn nearest<L: Lanes, T: Tolerance>(&self, ray: &Ray, tolerance: T) -> Option<Hit> {
        let slabs = Slabs::<L>::new(ray, tolerance);
        let mut nearest = Nearest { hit: ShapeHit { t: ray.t_max, uv: Vec2::ZERO }, item: u32::MAX, t_max: ray.t_max, within: None };
        let mut stack = ArrayVec::<(f32, Child), STACK>::new();
        let mut next = Some((0.0, self.root?));
        while let Some((entry, child)) = next {
            if entry <= nearest.hit.t * WIDEN {
                match child.get() {
                    Err(leaf) => self.intersect_leaf::<L, T>(leaf, ray, tolerance, &mut nearest),
                    Ok(node) => self.nodes[node].push_hits::<L, T>(&slabs, nearest.t_max, &mut stack),
                }
            }
            next = stack.pop();
        }
        let item = self.items.get(nearest.item as usize)?;
        if item.shape == INSTANCE {
            return nearest.within;
        }
        let uv = item.facet_uv.uv(nearest.hit.uv);
        Some(Hit { instance: None, shape: item.shape, primitive: item.primitive, uv, t: nearest.hit.t })
    }

    /// Whether there is any hit, by traversal in any order until the first hit.
    #[inline(always)]
    fn any<L: Lanes, T: Tolerance>(&self, ray: &Ray, tolerance: T) -> bool {
        let Some(root) = self.root else { return false };
        let slabs = Slabs::<L>::new(ray, tolerance);
        let mut stack = ArrayVec::<Child, STACK>::new();
        stack.push(root);
        while let Some(child) = stack.pop() {
            match child.get() {
                Err(leaf) if self.leaf_occludes::<L, T>(leaf, ray, tolerance) => return true,
                Err(_) => {}
                Ok(node) => {
                    let (_, hits) = self.nodes[node].intersect::<L, T>(&slabs, ray.t_max);
                    stack.extend(bits(hits).map(|i| self.nodes[node].child[i]));
                }
            }
        }
        false
    }
}
