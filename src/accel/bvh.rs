//! The hierarchy and its two walks.

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
use crate::shape::{Facet, Fold, ShapeHit};

pub struct Bvh {
    shapes: Shapes,
    items: Vec<Item>,
    bounds: Aabb,
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    packets: Vec<Packet>,
    /// Item numbers of what is not flat.
    curved: Vec<u32>,
    root: Option<Child>,
    set: Set,
}

/// Ranges of packets and of curved items.
#[derive(Clone, Copy)]
struct Leaf {
    packets: (u32, u32),
    curved: (u32, u32),
}

/// The best hit so far.
struct Nearest {
    hit: ShapeHit,
    item: u32,
    /// What the tests are asked for: they accept t < t_max only, and the next float above `hit.t` lets equally
    /// near hits of lower items through.
    t_max: f32,
}

impl Bvh {
    pub fn new(shapes: Shapes) -> Bvh {
        let mut bvh = Bvh {
            items: vec![],
            bounds: Aabb::EMPTY,
            nodes: vec![],
            leaves: vec![],
            packets: vec![],
            curved: vec![],
            root: None,
            set: Set::found(),
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

    /// One item per triangle or curved primitive; returns their boxes.
    fn list_items(&mut self, shapes: &Shapes) -> Vec<Aabb> {
        let mut boxes = vec![];
        for (shape, family) in shapes.iter().enumerate() {
            for primitive in 0..family.count() {
                let mut add = |bounds: Aabb, fold| {
                    boxes.push(bounds);
                    self.items.push(Item { shape: shape as u32, primitive, fold });
                };
                let facet = family.facet(primitive);
                if facet == Facet::Curved {
                    add(family.bounds(primitive), Fold::Plain);
                }
                facet.triangles().for_each(|(corners, fold)| add(Aabb::around(corners), fold));
            }
        }
        boxes
    }

    fn pack(&mut self, items: &[u32]) -> Leaf {
        let (first_packet, first_curved) = (self.packets.len() as u32, self.curved.len() as u32);
        let mut triangles = vec![];
        for &number in items {
            let item = self.items[number as usize];
            let facet = self.shapes[item.shape as usize].facet(item.primitive);
            match facet.triangles().find(|(_, fold)| *fold == item.fold) {
                Some((corners, _)) => triangles.push((number, corners)),
                None => self.curved.push(number),
            }
        }
        self.packets.extend(triangles.chunks(LANES).map(Packet::new));
        Leaf { packets: (first_packet, self.packets.len() as u32), curved: (first_curved, self.curved.len() as u32) }
    }

    /// Every hit of the leaf that is nearer than the nearest so far, or as near and of a lower item, in turn.
    #[inline(always)]
    fn leaf<L: Lanes>(&self, leaf: usize, ray: &Ray, nearest: &mut Nearest) {
        let leaf = self.leaves[leaf];
        for packet in &self.packets[leaf.packets.0 as usize..leaf.packets.1 as usize] {
            for lane in bits(packet.candidates::<L>(ray, nearest.t_max)) {
                if let Some(hit) = packet.intersect(lane, ray, nearest.t_max) {
                    nearest.offer(hit, packet.item[lane]);
                }
            }
        }
        for &number in &self.curved[leaf.curved.0 as usize..leaf.curved.1 as usize] {
            let item = self.items[number as usize];
            if let Some(hit) = self.shapes[item.shape as usize].intersect(item.primitive, &Ray { t_max: nearest.t_max, ..*ray }) {
                nearest.offer(hit, number);
            }
        }
    }

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
    #[inline(always)]
    fn offer(&mut self, hit: ShapeHit, item: u32) {
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
            // Sound: the set is what this machine was found to have.
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => unsafe { self.nearest_avx2(ray) },
        }
    }

    fn occluded(&self, ray: &Ray) -> bool {
        match self.set {
            Set::Plain => self.any::<Halves>(ray),
            // Sound: as above.
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => unsafe { self.any_avx2(ray) },
        }
    }
}

/// The walks, compiled once for each set of instructions.
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

    /// Front to back: the nearest child first, the others wait on the stack in order.
    #[inline(always)]
    fn nearest<L: Lanes>(&self, ray: &Ray) -> Option<Hit> {
        let slabs = Slabs::<L>::new(ray);
        let mut nearest = Nearest { hit: ShapeHit { t: ray.t_max, uv: Vec2::ZERO }, item: u32::MAX, t_max: ray.t_max };
        let mut stack = ArrayVec::<(f32, Child), STACK>::new();
        let mut next = Some((0.0, self.root?));
        while let Some((entry, child)) = next {
            if entry <= nearest.hit.t * WIDEN {
                match child.get() {
                    Err(leaf) => self.leaf::<L>(leaf, ray, &mut nearest),
                    Ok(node) => self.nodes[node].push_met(&slabs, nearest.t_max, &mut stack),
                }
            }
            next = stack.pop();
        }
        let item = self.items.get(nearest.item as usize)?;
        Some(Hit { shape: item.shape, primitive: item.primitive, uv: item.fold.uv(nearest.hit.uv), t: nearest.hit.t })
    }

    /// In any order: the first hit ends it.
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
                    let (_, met) = self.nodes[node].meet(&slabs, ray.t_max);
                    stack.extend(bits(met).map(|i| self.nodes[node].child[i]));
                }
            }
        }
        false
    }
}
