//! Scene for paths that are followed side by side, one in each lane.
//!
//! Flat shapes, materials and emission lie in tables from which each lane reads its own. Ellipsoids have code for lanes. All else, such as a
//! textured surface, is computed for one lane after the other by the code for single paths. Either way each lane gets the bits that a single path gets.
//!
//! Tests: side_by_side_paths_have_the_bits_of_single_ones.

mod background;
mod bsdfs;
mod lights;
mod medium;
mod varied;

use std::any::Any;

use glam::{Vec2, Vec3};

use super::{PartAppearance, World};
use crate::accel::{Bvh, Hits, NO_PLACE};
use crate::bsdf::Bsdf;
use crate::effects::Effects;
use crate::math::Ray;
use crate::math::Spectrum;
use crate::math::lanes::{Lanes, MAX_COUNT, Rays, Subroutine, Vector, Width, each_lane, tangents, to_array};
use crate::medium::{Media, Medium};
use crate::scene::Scene;
use crate::shape::{Facet, Shape, ShapeHit, SurfacePoint};

pub use self::bsdfs::ScatteredLanes;
use self::lights::WideLight;
pub use self::lights::{LightLanes, ReceiverLanes};
pub use self::medium::MediumLanes;
pub use self::varied::SurfaceArrays;

/// Tables of a scene.
pub(super) struct Tables {
    width: Width,
    /// Rows of [`FLAT`] numbers, one for each flat primitive: three vectors a, b and c, the normal, the offset, and 1 for triangles or 0. The
    /// point with the coordinates u and v is w a + u b + v c. For parallelograms b and c are the edges from the corner a, and w is 1; for
    /// triangles all three are corners, and w is 1 − u − v.
    flats: Vec<f32>,
    /// Row of the first primitive of each shape; [`NONE`] for shapes of other kinds.
    first_flat: Vec<u32>,
    /// Rows of [`LOOK`] numbers, one for each part of each shape: reflectance, radiance, and as 0 or 1 whether the part is diffuse,
    /// emits, does so on both sides, and lets light pass.
    looks: Vec<f32>,
    /// Row of the first part of each shape.
    first_look: Vec<u32>,
    /// Material of each part, with the bit [`VARIES`] if the part does not look the same everywhere.
    materials: Vec<u32>,
    /// The lights that are sampled in all lanes at once.
    lights: Vec<WideLight>,
}

/// Numbers in a row of the table of flat primitives.
const FLAT: u32 = 14;

/// Greatest number of primitives of a shape that has rows. A row has 56 bytes, which large meshes would pay for every triangle.
const MOST_ROWS: u32 = 1 << 12;

/// Numbers in a row of the table of parts.
const LOOK: u32 = 10;

/// Least cosine to the normal of a ray that surely moves away from the plane: a hundred times its rounding.
const LEAVING: f32 = 100.0 * f32::EPSILON;

/// Mark of a shape that has no rows.
const NONE: u32 = u32::MAX;

/// Bit of a part whose scattering or emission differs from place to place.
const VARIES: u32 = 1 << 31;

/// World and its tables.
#[derive(Clone, Copy)]
pub struct WideWorld<'a> {
    world: &'a World,
    tables: &'a Tables,
    hierarchy: &'a Bvh,
}

/// Surfaces that rays have hit, one in each lane.
pub struct SurfaceLanes<'a, L: Lanes> {
    /// Which lanes have one.
    pub found: L::Mask,
    /// Positions (m).
    pub p: Vector<L>,
    /// Unit geometric normals.
    pub ng: Vector<L>,
    /// Unit shading normals.
    pub ns: Vector<L>,
    /// Lanes through whose surface light may pass.
    pub transmits: L::Mask,
    offset: L::F32,
    /// First two axes of the frame of the shading normal.
    tangents: [Vector<L>; 2],
    albedo: Vector<L>,
    is_diffuse: L::Mask,
    radiance: Vector<L>,
    emits: L::Mask,
    is_two_sided: L::Mask,
    /// Indices of the materials.
    materials: [u32; MAX_COUNT],
    /// Bit mask of the lanes whose part varies.
    varied: u32,
    /// Bit mask of the lanes that have their own scattering model.
    modelled: u32,
    /// These models, in the order of the lanes: on the heap, because an array would be moved with the other fields even where it is empty.
    models: Vec<Bsdf<'a>>,
    hits: Hits,
}

impl Tables {
    /// Tables of a scene; `None` if its paths are better followed one by one: some material depends on the wavelength, a surface has holes
    /// or smooth shadows, there are instances, implicit surfaces or media other than [`Media::uniform`], vertices or lights move, the tables
    /// would be too long for their indices, or there is only one lane.
    pub fn new(world: &World, width: Width) -> Option<Tables> {
        let is_wide = width.count() > 1
            && Bvh::for_packets(&*world.hierarchy).is_some()
            && !world.has_holes
            && (world.media.is_none() || medium(world).is_some())
            && !world.lights.effects().contains(Effects::MOTION)
            && !world.shapes.iter().any(|shape| shape.is_moving())
            && !world.appearances.iter().any(|appearance| appearance.has_shadow_terminator_offset)
            && !world.materials.iter().any(|material| material.is_dispersive);
        if !is_wide {
            return None;
        }
        let mut tables = Tables {
            width,
            flats: vec![0.0; FLAT as usize],
            first_flat: vec![],
            looks: vec![0.0; LOOK as usize],
            first_look: vec![],
            materials: vec![0],
            lights: WideLight::of(world),
        };
        for (shape, appearance) in world.shapes.iter().zip(&world.appearances) {
            let is_flat = (1..=MOST_ROWS).contains(&shape.count()) && !shape.has_shading_normals();
            let rows: Option<Vec<_>> = (0..shape.count()).filter(|_| is_flat).map(|i| flat(&**shape, i)).collect();
            let rows = rows.unwrap_or_default();
            tables.first_flat.push(if rows.is_empty() { NONE } else { tables.flats.len() as u32 / FLAT });
            tables.flats.extend(rows.as_flattened());
            tables.first_look.push(tables.materials.len() as u32);
            for part in &appearance.parts {
                let material = &world.materials[part.material.0 as usize];
                let diffuse = match material.uniform {
                    Some(Bsdf::Diffuse(diffuse)) => Some(diffuse.albedo),
                    _ => None,
                };
                let emission = part.emitter.as_ref().map(|emitter| (Spectrum::from_illuminant(emitter.radiance), emitter.two_sided));
                let is = |yes: bool| f32::from(u8::from(yes));
                tables.looks.extend(diffuse.unwrap_or(Spectrum::BLACK).coefficients());
                tables.looks.extend(emission.map_or(Spectrum::BLACK, |emission| emission.0).coefficients());
                tables.looks.extend([
                    is(diffuse.is_some()),
                    is(emission.is_some()),
                    is(emission.is_some_and(|emission| emission.1)),
                    is(material.transmits),
                ]);
                tables.materials.push(part.material.0 | if varies(world, part) { VARIES } else { 0 });
            }
        }
        // Indices within the tables are 31-bit numbers.
        let lengths = [tables.flats.len(), tables.looks.len(), world.materials.len()];
        lengths.into_iter().all(|length| length < i32::MAX as usize).then_some(tables)
    }
}

/// Row of a flat primitive, see [`Tables::flats`]; `None` for others.
fn flat(shape: &dyn Shape, i: u32) -> Option<[f32; FLAT as usize]> {
    let (vectors, is_triangle) = match shape.facet(i) {
        Facet::Parallelogram([a, b, _, d]) => ([a, b - a, d - a], 0.0),
        Facet::Triangle(corners) => (corners, 1.0),
        Facet::Curved => return None,
    };
    let SurfacePoint { ng: n, offset, .. } = shape.sample_area(i, Vec2::ZERO).0;
    let [a, b, c] = vectors;
    Some([a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, n.x, n.y, n.z, offset, is_triangle])
}

/// The medium that fills all space, if it has code for lanes and no boundary without a surface cuts it into pieces.
fn medium(world: &World) -> Option<&Medium> {
    world.media.as_ref().filter(|_| world.interfaces.is_none()).and_then(Media::uniform)
}

/// Whether a part does not look the same everywhere.
fn varies(world: &World, part: &PartAppearance) -> bool {
    world.materials[part.material.0 as usize].uniform.is_none() || part.emitter.as_ref().is_some_and(|emitter| emitter.texture.is_some())
}

impl<'a> WideWorld<'a> {
    /// A scene for paths that are followed side by side; `None` if they are better followed one by one.
    pub fn of(scene: &dyn Scene) -> Option<WideWorld<'_>> {
        let any: &dyn Any = scene;
        let world = any.downcast_ref::<World>()?;
        Some(WideWorld { world, tables: world.tables.as_ref()?, hierarchy: Bvh::for_packets(&*world.hierarchy)? })
    }

    /// Number of lanes.
    pub fn width(&self) -> Width {
        self.tables.width
    }

    /// Nearest hits of the rays in the lanes of `active`.
    #[inline(always)]
    pub fn intersect<L: Lanes>(&self, rays: &Rays<L>, active: L::Mask) -> Hits {
        L::call(Nearest { hierarchy: self.hierarchy, rays: *rays, active })
    }

    /// Which rays in the lanes of `active` hit something before their ends.
    #[inline(always)]
    pub fn occluded<L: Lanes>(&self, rays: &Rays<L>, active: L::Mask) -> L::Mask {
        L::call(Occluded { hierarchy: self.hierarchy, rays: *rays, active })
    }

    /// Surfaces that rays have hit. Those in the lanes of [`SurfaceLanes::varied`] are not complete.
    #[inline(always)]
    pub fn surfaces<L: Lanes>(&self, rays: &Rays<L>, hits: &Hits) -> SurfaceLanes<'a, L> {
        let tables = self.tables;
        let (mut flats, mut looks, mut materials) = ([0; MAX_COUNT], [0; MAX_COUNT], [0; MAX_COUNT]);
        let (mut others, mut varied) = (0, 0);
        for lane in each_lane(hits.found) {
            let (shape, primitive) = (hits.shape[lane] as usize, hits.primitive[lane]);
            let first = tables.first_flat[shape];
            if first == NONE {
                others |= 1 << lane
            } else {
                flats[lane] = first + primitive
            }
            looks[lane] = tables.first_look[shape] + self.part(shape, hits, lane);
            let material = tables.materials[looks[lane] as usize];
            materials[lane] = material & !VARIES;
            varied |= u32::from(material & VARIES != 0) << lane;
        }
        let row = L::load_u32(&flats) * L::u32(FLAT);
        let flats = &tables.flats;
        let (u, v) = (L::load(&hits.u), L::load(&hits.v));
        let one = L::f32(1.0);
        let w = L::select(is::<L>(flats, row, 13), one - u - v, one);
        let mut p = vector::<L>(flats, row, 0).scaled(w) + vector::<L>(flats, row, 3).scaled(u) + vector::<L>(flats, row, 6).scaled(v);
        let (mut ng, mut offset) = (vector(flats, row, 9), L::gather(flats, row + L::u32(12)));
        let mut ns = ng;
        // The points of varied lanes come with their surfaces.
        others &= !varied;
        if others != 0 {
            self.points(rays, hits, others, [&mut p, &mut ng, &mut ns], &mut offset);
        }
        let row = L::load_u32(&looks) * L::u32(LOOK);
        let looks = &tables.looks;
        let found = L::mask(hits.found);
        SurfaceLanes {
            found,
            tangents: tangents(ns),
            albedo: vector(looks, row, 0),
            radiance: vector(looks, row, 3),
            is_diffuse: is::<L>(looks, row, 6),
            emits: is::<L>(looks, row, 7) & found,
            is_two_sided: is::<L>(looks, row, 8),
            transmits: is::<L>(looks, row, 9),
            materials,
            varied,
            modelled: 0,
            models: vec![],
            hits: *hits,
            p,
            ng,
            ns,
            offset,
        }
    }

    /// Part of a shape that was hit.
    #[inline(always)]
    fn part(&self, shape: usize, hits: &Hits, lane: usize) -> u32 {
        if self.world.appearances[shape].parts.len() > 1 {
            return self.world.shapes[shape].part(hits.primitive[lane], Vec2::new(hits.u[lane], hits.v[lane]));
        }
        0
    }

    /// Points of shapes that have no table: those of an ellipsoid in all its lanes at once, all others lane by lane.
    #[inline(always)]
    fn points<L: Lanes>(&self, rays: &Rays<L>, hits: &Hits, which: u32, vectors: [&mut Vector<L>; 3], offset: &mut L::F32) {
        let [p, ng, ns] = vectors;
        let (shapes, mut others, mut left) = (L::load_u32(&hits.shape), 0, which);
        while left != 0 {
            let shape = hits.shape[left.trailing_zeros() as usize];
            let its = L::bits(L::eq_u32(shapes, L::u32(shape))) & left;
            left &= !its;
            let Some(ellipsoid) = self.world.shapes[shape as usize].ellipsoid() else {
                others |= its;
                continue;
            };
            let (points, its) = (ellipsoid.points_lanes(rays, L::load(&hits.t)), L::mask(its));
            *p = Vector::select(its, points.p, *p);
            *ng = Vector::select(its, points.ng, *ng);
            *ns = Vector::select(its, points.ng, *ns);
            *offset = L::select(its, points.offset, *offset);
        }
        if others == 0 {
            return;
        }
        let mut points = PointArrays { p: p.to_arrays(), ng: ng.to_arrays(), ns: ns.to_arrays(), offset: to_array::<L>(*offset) };
        for lane in each_lane(others) {
            points.set(lane, &self.point(&rays.get(lane), hits, lane));
        }
        (*p, *ng, *ns) = (Vector::from_arrays(&points.p), Vector::from_arrays(&points.ng), Vector::from_arrays(&points.ns));
        *offset = L::load(&points.offset);
    }

    /// Point that the ray of a lane has hit.
    #[inline(never)]
    fn point(&self, ray: &Ray, hits: &Hits, lane: usize) -> SurfacePoint {
        let hit = ShapeHit { t: hits.t[lane], uv: Vec2::new(hits.u[lane], hits.v[lane]) };
        self.world.shapes[hits.shape[lane] as usize].point(hits.primitive[lane], ray, &hit)
    }
}

/// Arguments of [`Bvh::nearest_of_many`], for [`Lanes::call`]: inlined into every walk, the traversal takes a third of the compilation.
struct Nearest<'a, L: Lanes> {
    hierarchy: &'a Bvh,
    rays: Rays<L>,
    active: L::Mask,
}

impl<L: Lanes> Subroutine<L> for Nearest<'_, L> {
    type Output = Hits;

    #[inline(always)]
    fn run(self) -> Hits {
        let Nearest { hierarchy, rays, active } = self;
        hierarchy.nearest_of_many(&rays, active)
    }
}

/// Arguments of [`Bvh::occluded_of_many`], for [`Lanes::call`].
struct Occluded<'a, L: Lanes> {
    hierarchy: &'a Bvh,
    rays: Rays<L>,
    active: L::Mask,
}

impl<L: Lanes> Subroutine<L> for Occluded<'_, L> {
    type Output = L::Mask;

    #[inline(always)]
    fn run(self) -> L::Mask {
        let Occluded { hierarchy, rays, active } = self;
        hierarchy.occluded_of_many(&rays, active)
    }
}

/// Vectors of a table, from column `k` on.
#[inline(always)]
fn vector<L: Lanes>(table: &[f32], row: L::U32, k: u32) -> Vector<L> {
    let x = row + L::u32(k);
    Vector { x: L::gather(table, x), y: L::gather(table, x + L::u32(1)), z: L::gather(table, x + L::u32(2)) }
}

/// Truth values of a table, in column `k`.
#[inline(always)]
fn is<L: Lanes>(table: &[f32], row: L::U32, k: u32) -> L::Mask {
    L::lt(L::f32(0.0), L::gather(table, row + L::u32(k)))
}

/// Points of all lanes, as arrays in which single lanes can be set.
struct PointArrays {
    p: [[f32; MAX_COUNT]; 3],
    ng: [[f32; MAX_COUNT]; 3],
    ns: [[f32; MAX_COUNT]; 3],
    offset: [f32; MAX_COUNT],
}

impl PointArrays {
    fn set(&mut self, lane: usize, point: &SurfacePoint) {
        for axis in 0..3 {
            self.p[axis][lane] = point.p[axis];
            self.ng[axis][lane] = point.ng[axis];
            self.ns[axis][lane] = point.ns[axis];
        }
        self.offset[lane] = point.offset;
    }
}

impl<L: Lanes> SurfaceLanes<'_, L> {
    /// Radiance that the surfaces emit in the directions `w`, as [`Emission::towards`](crate::light::Emission::towards).
    #[inline(always)]
    pub fn emitted(&self, w: Vector<L>) -> Vector<L> {
        let shines = self.emits & (self.is_two_sided | L::lt(L::f32(0.0), self.ng.dot(w)));
        Vector::select(shines, self.radiance, Vector::splat(Vec3::ZERO))
    }

    /// Coordinates of directions in the frames of the shading normals.
    #[inline(always)]
    pub fn to_local(&self, w: Vector<L>) -> Vector<L> {
        Vector { x: w.dot(self.tangents[0]), y: w.dot(self.tangents[1]), z: w.dot(self.ns) }
    }

    /// Rays in the directions `wi`, starting off the surfaces, without an end.
    #[inline(always)]
    pub fn spawn(&self, wi: Vector<L>) -> Rays<L> {
        let off = self.ng.scaled(self.offset);
        let below = L::lt(self.ng.dot(wi), L::f32(0.0));
        let origin = Vector::select(below, self.p - off, self.p + off);
        Rays { origin, direction: wi, t_max: L::f32(f32::INFINITY), skip: self.skip(wi, wi) }
    }

    /// Triangles that rays leave for good: see [`Rays::skip`].
    ///
    /// A ray starts off the plane through its point, by the offset of the point. This is four times as much as any part of the flat shape
    /// may be off that plane because its corners, its normal and the point were rounded. A ray that moves away from the plane therefore does
    /// not come back to the triangle. Whether it moves away is decided up to the rounding of the cosine.
    ///
    /// - `side`: directions on the sides of the triangles on which the rays start
    #[inline(always)]
    fn skip(&self, side: Vector<L>, direction: Vector<L>) -> L::U32 {
        let (zero, cos) = (L::f32(0.0), self.ng.dot(direction));
        let away = L::select(L::lt(self.ng.dot(side), zero), -cos, cos);
        L::select_u32(L::lt(L::f32(LEAVING), away), L::load_u32(&self.hits.place), L::u32(NO_PLACE))
    }

    /// Shading normals on the side of `wo`.
    #[inline(always)]
    pub fn ns_towards(&self, wo: Vector<L>) -> Vector<L> {
        Vector::select(L::lt(self.ns.dot(wo), L::f32(0.0)), -self.ns, self.ns)
    }

    /// Whether both normals agree on the sides of two directions, given in world space and in the local frames.
    #[inline(always)]
    fn normals_agree(&self, wo: Vector<L>, lo: L::F32, wi: Vector<L>, li: L::F32) -> L::Mask {
        let same_side = L::lt(L::f32(0.0), self.ng.dot(wo) * self.ng.dot(wi));
        !(same_side ^ on_one_side::<L>(lo, li))
    }
}

/// Whether two cosines have the same sign.
#[inline(always)]
fn on_one_side<L: Lanes>(a: L::F32, b: L::F32) -> L::Mask {
    let zero = L::f32(0.0);
    (L::lt(zero, a) & L::lt(zero, b)) | (L::lt(a, zero) & L::lt(b, zero))
}
