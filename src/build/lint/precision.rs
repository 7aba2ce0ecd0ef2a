//! Warnings about shapes that are too small or too thin for the precision of f32 coordinates at their position.

use std::collections::BTreeMap;

use glam::{DVec3, Vec2, Vec3};

use super::Linted;
use super::rays::bounds;
use crate::bsdf::MaterialId;
use crate::math::Aabb;
use crate::shape::{Facet, Shape, offset_bound, triangle};
use crate::world::{ShapePlace, World};

/// The distance from the origin, in multiples of a shape's size, beyond which its form degrades: f32 resolves 2²⁴ = 1.7·10⁷ steps.
const MOST_SIZES_AWAY: f32 = 1e7;

/// The smallest thickness of a body, in multiples of the offset from the surface at which rays start.
const LEAST_OFFSETS: f64 = 4.0;

/// Warnings about the shape that is too small for its distance from the origin, and about bodies that are too thin.
pub(super) fn warnings(linted: &Linted) -> Vec<String> {
    let (world, name) = (linted.world, |shape: usize| linted.name(shape as u32));
    let count = world.shapes().len() as u32;
    let bounds: Vec<Aabb> = (0..count).map(|shape| bounds(world, shape)).collect();
    let small = lost(&bounds).map(|(shape, text)| format!("{}: {text}", name(shape)));
    let thin =
        bodies(world, &bounds).into_iter().filter(Body::is_too_thin).map(|body| format!("{}: {}", name(body.shape), body.complaint()));
    small.into_iter().chain(thin).collect()
}

/// The shape that loses most precision by its position, if any loses too much, with a message.
fn lost(bounds: &[Aabb]) -> Option<(usize, String)> {
    let sizes = bounds.iter().map(|b| (b.magnitude().max_element(), (b.max - b.min).max_element()));
    let (shape, (reach, size)) = sizes.enumerate().max_by(|(_, a), (_, b)| (a.0 / a.1).total_cmp(&(b.0 / b.1)))?;
    let text = format!(
        "{size:.1e} m large, {reach:.1e} m away from where the scene is finest: f32 steps by {:.1e} m there, which distorts its form; move it \
         nearer, or make it larger",
        reach.next_up() - reach
    );
    (reach / size > MOST_SIZES_AWAY).then_some((shape, text))
}

/// A closed surface with an inside: one shape, or several shapes of one material.
#[derive(Default)]
struct Body {
    /// The index of the body's first shape.
    shape: usize,
    /// The surface area (m²).
    area: f64,
    /// The integral of the normal over the surface (m²). It is 0 for a closed surface, and for the two faces of a plate without rims.
    vector_area: DVec3,
    /// The integral ∫ (p − c)·n dA / 3 (m³). It is the enclosed volume of a closed surface, and a third of the volume between the
    /// two faces of a plate without rims.
    volume: f64,
    /// The integral over the surface of the offset at which rays start (m³).
    offset: f64,
}

impl Body {
    fn is_closed(&self) -> bool {
        self.vector_area.length() < 1e-3 * self.area
    }

    /// Returns 2 V / A (m), which is the thickness of a plate. [`measured`] sets V and A of a curved shape so that the result is the
    /// shortest side of its bounding box.
    fn thickness(&self) -> f64 {
        2.0 * self.volume.abs() / self.area
    }

    fn is_too_thin(&self) -> bool {
        self.thickness() < LEAST_OFFSETS * self.offset / self.area
    }

    fn complaint(&self) -> String {
        let (thickness, offset) = (self.thickness(), self.offset / self.area);
        format!(
            "this body is about {thickness:.1e} m thick, and rays start {offset:.1e} m off its surface: they miss its other side, and it \
             refracts and absorbs wrongly. Move it towards the middle of the scene, or make it a thin_dielectric without an inside"
        )
    }
}

/// The bodies of the scene with an inside that light reaches. Open surfaces are not included; `open_glass` reports them.
fn bodies(world: &World, bounds: &[Aabb]) -> Vec<Body> {
    let (mut closed, mut open) = (vec![], BTreeMap::<MaterialId, (DVec3, Body)>::new());
    for (shape, baked) in world.shapes().iter().enumerate() {
        let Some(material) = world.body_material(shape).filter(|_| world.place(shape as u32) != ShapePlace::Nowhere) else { continue };
        let center = open.get(&material).map_or(bounds[shape].center().as_dvec3(), |(center, _)| *center);
        let body = measured(&**baked, shape, center, bounds[shape]);
        if body.is_closed() {
            closed.push(body);
        } else {
            let (_, all) = open.entry(material).or_insert_with(|| (center, Body { shape, ..Body::default() }));
            all.area += body.area;
            all.vector_area += body.vector_area;
            all.volume += body.volume;
            all.offset += body.offset;
        }
    }
    let whole = |(_, body): (DVec3, Body)| Body { volume: 3.0 * body.volume, ..body };
    closed.into_iter().chain(open.into_values().map(whole).filter(Body::is_closed)).collect()
}

/// The contribution of a shape to a body, with V = ∫ (p − c)·n dA / 3. Curved shapes are measured by their bounding box, unless their normals
/// are so similar that they are a part of a body only.
fn measured(baked: &dyn Shape, shape: usize, center: DVec3, bounds: Aabb) -> Body {
    let mut body = Body { shape, ..Body::default() };
    for i in 0..baked.count() {
        if baked.facet(i) == Facet::Curved && (baked.is_flat(i) || baked.normal_cone(i).is_some()) {
            sum_up(baked, i, center, &mut body);
            continue;
        }
        if baked.facet(i) == Facet::Curved {
            let size = bounds.max.as_dvec3() - bounds.min.as_dvec3();
            let offset = f64::from(offset_bound(Vec3::splat(3f32.sqrt().recip()), bounds.magnitude()));
            return Body { shape, area: 1.0, volume: 0.5 * size.min_element(), offset, ..Body::default() };
        }
        for (corners, _) in baked.facet(i).triangles() {
            let [a, b, c] = corners.map(|p| p.as_dvec3());
            let vector_area = 0.5 * (b - a).cross(c - a);
            let Some(n) = triangle::normal(corners) else { continue };
            let magnitude = corners.iter().fold(Vec3::ZERO, |most, p| most.max(p.abs()));
            body.area += vector_area.length();
            body.vector_area += vector_area;
            body.volume += vector_area.dot((a + b + c) / 3.0 - center) / 3.0;
            body.offset += vector_area.length() * f64::from(offset_bound(n, magnitude));
        }
    }
    body
}

/// Adds a primitive to a body, by the midpoint rule over the numbers with which it is sampled.
fn sum_up(baked: &dyn Shape, i: u32, center: DVec3, body: &mut Body) {
    const STEPS: u32 = 8;
    for k in 0..STEPS * STEPS {
        let (point, pdf) = baked.sample_area(i, (Vec2::new((k % STEPS) as f32, (k / STEPS) as f32) + 0.5) / STEPS as f32);
        let area = 1.0 / (f64::from(STEPS * STEPS) * f64::from(pdf.get()));
        let vector_area = point.ng.as_dvec3() * area;
        body.area += area;
        body.vector_area += vector_area;
        body.volume += vector_area.dot(point.p.as_dvec3() - center) / 3.0;
        body.offset += area * f64::from(point.offset);
    }
}
