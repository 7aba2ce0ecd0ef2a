//! Bounding volume hierarchy and its traversal.

use arrayvec::ArrayVec;
use glam::Vec2;

use super::bits;
use super::build::{Wide, wide};
use super::node::{Child, Node, STACK, Slabs, WIDEN, padding};
use super::packet::{LANES, Packet};
#[cfg(target_arch = "x86_64")]
use super::simd::Whole;
use super::simd::{Halves, Lanes, Set};
use super::{Item, Shapes};
use crate::math::{Aabb, Ray};
use crate::primitive::{Hit, Primitive};
use crate::shape::{Facet, FacetUv, ShapeHit};

/// Bounding volume hierarchy over the primitives of a scene.
pub struct Bvh {
    shapes: Shapes,
    items: Vec<Item>,
    bounds: Aabb,
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    packets: Vec<Packet>,
    /// Item numbers of the curved primitives, leaf by leaf.
    curved: Vec<u32>,
    root: Option<Child>,
    set: Set,
}

/// Leaf: ranges of packets and of curved items.
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
}

impl Bvh {
    /// Builds the hierarchy.
    pub fn new(shapes: Shapes) -> Bvh {
        let mut bvh = Bvh {
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
        let mut boxes = bvh.list_items(&shapes);
        bvh.bounds = boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
        let pad = padding(&bvh.bounds);
        boxes.iter_mut().for_each(|b| *b = b.padded(pad));
        if let Some(Wide { nodes, leaves, root }) = wide(&boxes) {
            bvh.leaves = leaves.iter().map(|items| bvh.pack(items)).collect();
            (bvh.nodes, bvh.root) = (nodes, Some(root));
        }
        bvh
    }

    /// Lists one item per triangle or curved primitive, and returns their boxes.
    fn list_items(&mut self, shapes: &Shapes) -> Vec<Aabb> {
        let mut boxes = vec![];
        for (shape, family) in shapes.iter().enumerate() {
            for primitive in 0..family.count() {
                let mut add = |bounds: Aabb, facet_uv| {
                    boxes.push(bounds);
                    self.items.push(Item { shape: shape as u32, primitive, facet_uv });
                };
                let facet = family.facet(primitive);
                if facet == Facet::Curved {
                    add(family.bounds(primitive), FacetUv::Triangle);
                }
                facet.triangles().for_each(|(corners, facet_uv)| add(Aabb::around(corners), facet_uv));
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
            let facet = self.shapes[item.shape as usize].facet(item.primitive);
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
    fn intersect_leaf<L: Lanes>(&self, leaf: usize, ray: &Ray, nearest: &mut Nearest) {
        let leaf = self.leaves[leaf];
        for packet in &self.packets[leaf.packets.0 as usize..leaf.packets.1 as usize] {
            for lane in bits(packet.candidates::<L>(ray, nearest.t_max)) {
                if let Some(hit) = packet.intersect(lane, ray, nearest.t_max) {
                    nearest.update(hit, packet.item[lane]);
                }
            }
        }
        for &number in &self.curved[leaf.curved.0 as usize..leaf.curved.1 as usize] {
            let item = self.items[number as usize];
            if let Some(hit) = self.shapes[item.shape as usize].intersect(item.primitive, &Ray { t_max: nearest.t_max, ..*ray }) {
                nearest.update(hit, number);
            }
        }
    }

    /// Whether the ray hits anything in a leaf.
    #[inline(always)]
    fn leaf_occludes<L: Lanes>(&self, leaf: usize, ray: &Ray) -> bool {
        let leaf = self.leaves[leaf];
        let flat = self.packets[leaf.packets.0 as usize..leaf.packets.1 as usize]
            .iter()
            .any(|packet| bits(packet.candidates::<L>(ray, ray.t_max)).any(|lane| packet.intersect(lane, ray, ray.t_max).is_some()));
        flat || self.curved[leaf.curved.0 as usize..leaf.curved.1 as usize].iter().any(|&number| {
            let item = self.items[number as usize];
            self.shapes[item.shape as usize].intersect(item.primitive, ray).is_some()
        })
    }
}

impl Nearest {
    /// Replaces the hit by a nearer one, or by an equally near one of a lower item.
    #[inline(always)]
    fn update(&mut self, hit: ShapeHit, item: u32) {
        if hit.t < self.hit.t || (hit.t == self.hit.t && item < self.item) {
            *self = Nearest { hit, item, t_max: hit.t.next_up() };
        }
    }
}

impl Primitive for Bvh {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        match self.set {
            Set::Plain => self.nearest::<Halves>(ray),
            // SAFETY: `set` is AVX2 only if this machine has it.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code, reason = "sound: the set is what this machine was found to have")]
            Set::Avx2 => unsafe { self.nearest_avx2(ray) },
        }
    }

    fn occluded(&self, ray: &Ray) -> bool {
        match self.set {
            Set::Plain => self.any::<Halves>(ray),
            // SAFETY: `set` is AVX2 only if this machine has it.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code, reason = "sound: the set is what this machine was found to have")]
            Set::Avx2 => unsafe { self.any_avx2(ray) },
        }
    }
}

/// Traversals, compiled once for each instruction set.
impl Bvh {
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn nearest_avx2(&self, ray: &Ray) -> Option<Hit> {
        self.nearest::<Whole>(ray)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn any_avx2(&self, ray: &Ray) -> bool {
        self.any::<Whole>(ray)
    }

    /// Nearest hit, by front-to-back traversal: the nearest child first, the others in order on the stack.
    #[inline(always)]
    fn nearest<L: Lanes>(&self, ray: &Ray) -> Option<Hit> {
        let slabs = Slabs::<L>::new(ray);
        let mut nearest = Nearest { hit: ShapeHit { t: ray.t_max, uv: Vec2::ZERO }, item: u32::MAX, t_max: ray.t_max };
        let mut stack = ArrayVec::<(f32, Child), STACK>::new();
        let mut next = Some((0.0, self.root?));
        while let Some((entry, child)) = next {
            if entry <= nearest.hit.t * WIDEN {
                match child.get() {
                    Err(leaf) => self.intersect_leaf::<L>(leaf, ray, &mut nearest),
                    Ok(node) => self.nodes[node].push_hits(&slabs, nearest.t_max, &mut stack),
                }
            }
            next = stack.pop();
        }
        let item = self.items.get(nearest.item as usize)?;
        Some(Hit { shape: item.shape, primitive: item.primitive, uv: item.facet_uv.uv(nearest.hit.uv), t: nearest.hit.t })
    }

    /// Whether there is any hit, by traversal in any order until the first hit.
    #[inline(always)]
    fn any<L: Lanes>(&self, ray: &Ray) -> bool {
        let Some(root) = self.root else { return false };
        let slabs = Slabs::<L>::new(ray);
        let mut stack = ArrayVec::<Child, STACK>::new();
        stack.push(root);
        while let Some(child) = stack.pop() {
            match child.get() {
                Err(leaf) if self.leaf_occludes::<L>(leaf, ray) => return true,
                Err(_) => {}
                Ok(node) => {
                    let (_, hits) = self.nodes[node].intersect(&slabs, ray.t_max);
                    stack.extend(bits(hits).map(|i| self.nodes[node].child[i]));
                }
            }
        }
        false
    }
}
