//! Ribbons: flat curves whose surface turns with given normals.
//!
//! p(s, ν) = c + ν w b/|b|,    b = c′ × N,    −1 ≤ ν ≤ 1
//!
//! where c is the curve, w half its width, and N its normal, which is interpolated like the control points. The normal of the surface is on the
//! side of N.

use glam::{DVec3, Vec2, Vec3, Vec3Swizzles as _, Vec4Swizzles as _};

use super::line::Line;
use super::piece::{Cubic, Local};
use super::strands::Strands;
use crate::math::bernstein::Bernstein;
use crate::math::float::ONE_MINUS_EPSILON;
use crate::math::{Aabb, AreaPdf, Ray};
use crate::shape::{Capsule, Facet, Shape, ShapeHit, SurfacePoint, VertexColor, gauss_nodes, offset_bound};

/// Ribbons in world space. The `uv` of a hit are s, and ν from 0 to 1.
pub(super) struct Ribbons(pub Strands);

/// A piece with its normals, which have no radius.
struct Ribbon {
    curve: Cubic,
    normals: Cubic,
}

impl Ribbon {
    /// The point with the coordinates s and ν, and its derivatives by them (m).
    fn at(&self, s: f64, nu: f64) -> [DVec3; 3] {
        let (Local { value, first, second }, normal) = (self.curve.at(s), self.normals.at(s));
        let across = first.xyz().cross(normal.value.xyz());
        let change = second.xyz().cross(normal.value.xyz()) + first.xyz().cross(normal.first.xyz());
        let (length, unit) = (across.length(), across.normalize_or_zero());
        let turn = if length > 0.0 { (change - unit * unit.dot(change)) / length } else { DVec3::ZERO };
        let by_s = first.xyz() + nu * (first.w * unit + value.w * turn);
        [value.xyz() + nu * value.w * unit, by_s, value.w * unit]
    }

    fn stretch(&self, s: f64, nu: f64) -> f64 {
        let [_, by_s, by_nu] = self.at(s, nu);
        by_s.cross(by_nu).length()
    }

    /// Area ∫∫ |∂p/∂s × ∂p/∂ν| ds dν (m²).
    fn area(&self) -> f64 {
        let row = |s: f64| gauss_nodes(2).map(|x| self.stretch(s, 2.0 * x - 1.0)).sum::<f64>() / 4.0;
        2.0 * gauss_nodes(8).map(row).sum::<f64>() / 16.0
    }
}

/// Precision of s, relative to the range in which it is looked for.
const PRECISE: f64 = 1e-12;

/// Coordinate ν from −1 to 1 for one from 0 to 1.
fn signed(share: f32) -> f64 {
    2.0 * f64::from(share) - 1.0
}

impl Ribbons {
    fn ribbon(&self, i: u32) -> Ribbon {
        Ribbon { curve: self.0.piece(i), normals: self.0.normals(i) }
    }

    fn point_at(&self, i: u32, uv: Vec2) -> SurfacePoint {
        let ribbon = self.ribbon(i);
        let [p, by_s, by_nu] = ribbon.at(uv.x.into(), signed(uv.y));
        // Where the ribbon has no width, its normal is that of the curve.
        let normal = by_nu.cross(by_s).try_normalize();
        let ng = normal.unwrap_or_else(|| ribbon.normals.at(uv.x.into()).value.xyz().normalize_or(DVec3::Z)).as_vec3();
        SurfacePoint {
            p: p.as_vec3(),
            offset: offset_bound(ng, ribbon.curve.aabb().magnitude()),
            ng,
            ns: ng,
            uv: Vec2::new(uv.y, self.0.place(i).at(uv.x.into())),
            color: VertexColor::WHITE,
        }
    }

    fn uv_of(&self, i: u32, point: &SurfacePoint) -> Vec2 {
        let place = self.0.place(i);
        let s = ((f64::from(point.uv.y) - place.from) / place.length).clamp(0.0, 1.0);
        Vec2::new(s as f32, point.uv.x)
    }

    fn pdf_at(&self, i: u32, uv: Vec2) -> AreaPdf {
        let ribbon = self.ribbon(i);
        let (stretch, area) = (2.0 * ribbon.stretch(uv.x.into(), signed(uv.y)), ribbon.area());
        AreaPdf::new(if stretch > 0.0 { 1.0 / stretch } else { 1.0 / area } as f32)
    }
}

impl Shape for Ribbons {
    fn is_of_curves(&self) -> bool {
        true
    }

    fn count(&self) -> u32 {
        self.0.count()
    }

    fn bounds(&self, i: u32) -> Aabb {
        self.0.piece(i).aabb()
    }

    fn capsule(&self, i: u32) -> Option<Capsule> {
        Some(self.0.piece(i).capsule())
    }

    fn area(&self, i: u32) -> f32 {
        self.ribbon(i).area() as f32
    }

    fn facet(&self, _: u32) -> Facet {
        Facet::Curved
    }

    /// Finds the lines across the ribbon that the ray meets. Seen along the ray, the line at s passes through the origin where the
    /// polynomial c × b of degree 8 is 0; there, ν w/|b| = −c·b/b².
    fn intersect(&self, i: u32, ray: &Ray) -> Option<ShapeHit> {
        let ribbon = self.ribbon(i);
        let line = Line::new(ray, 0.5 * (ribbon.curve.0[0] + ribbon.curve.0[3]).xyz());
        let seen = Ribbon { curve: line.seen(&ribbon.curve), normals: Cubic(ribbon.normals.0.map(|n| line.vector(n.xyz()).extend(0.0))) };
        let range @ [start, end] = line.near(&seen.curve, ray.t_max)?;
        let mut nearest: Option<ShapeHit> = None;
        let mut consider = |s: f64| {
            let (Local { value, first, .. }, normal) = (seen.curve.at(s), seen.normals.at(s).value.xyz());
            let across = first.xyz().cross(normal);
            let flat = across.xy();
            let share = -value.xy().dot(flat) / flat.length_squared();
            let nu = share * across.length() / value.w;
            let t = line.t(value.z + share * across.z) as f32;
            let t_max = nearest.map_or(ray.t_max, |hit| hit.t);
            if nu.abs() <= 1.0 && t > 0.0 && t < t_max {
                nearest = Some(ShapeHit { t, uv: Vec2::new(s as f32, (0.5 + 0.5 * nu) as f32) });
            }
        };
        let crossed = Ribbon { curve: seen.curve.part(range), normals: seen.normals.part(range) }.crossed();
        // The ends belong to both pieces that meet there. The error of c × b is that of c times the length of b = c′ × N.
        let [c, n] = [&seen.curve.0, &seen.normals.0];
        let speed = c.windows(2).map(|pair| 3.0 * (pair[1] - pair[0]).xyz().length()).fold(0.0, f64::max);
        let rounding = line.rounding * speed * n.iter().map(|n| n.xyz().length()).fold(0.0, f64::max);
        for (s, value) in [(start, crossed.0[0]), (end, crossed.0[8])] {
            if value.abs() <= rounding {
                consider(s);
            }
        }
        crossed.crossings(PRECISE, |s| consider(start + (end - start) * s));
        nearest
    }

    fn point(&self, i: u32, _: &Ray, hit: &ShapeHit) -> SurfacePoint {
        self.point_at(i, hit.uv)
    }

    fn tangents(&self, i: u32, point: &SurfacePoint, _: f32) -> Option<[Vec3; 2]> {
        let uv = self.uv_of(i, point);
        let [_, by_s, by_nu] = self.ribbon(i).at(uv.x.into(), signed(uv.y));
        Some([(2.0 * by_nu).as_vec3(), (by_s / self.0.place(i).length).as_vec3()])
    }

    /// Samples uniformly in s and ν, which is nearly uniform by area.
    fn sample_area(&self, i: u32, u: Vec2) -> (SurfacePoint, AreaPdf) {
        (self.point_at(i, u), self.pdf_at(i, u))
    }

    fn area_pdf(&self, i: u32, point: &SurfacePoint) -> AreaPdf {
        self.pdf_at(i, self.uv_of(i, point))
    }

    fn area_coordinates(&self, i: u32, point: &SurfacePoint) -> Option<Vec2> {
        Some(self.uv_of(i, point).clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON)))
    }
}

impl Ribbon {
    /// The polynomial c × b in the plane that the ray is perpendicular to, for a ribbon as the ray sees it.
    fn crossed(&self) -> Bernstein<9> {
        let axis = |cubic: &Cubic, k: usize| cubic.0.map(|b| b[k]);
        let [c, n] = [&self.curve, &self.normals].map(|cubic| [0, 1, 2].map(|k| axis(cubic, k)));
        let d = c.map(|[a, b, c, d]| [3.0 * (b - a), 3.0 * (c - b), 3.0 * (d - c)]);
        // b = c′ × N, in x and y.
        let across_x = Bernstein::<6>::sum_of_products([(d[1], n[2]), (d[2].map(|x| -x), n[1])]).0;
        let across_y = Bernstein::<6>::sum_of_products([(d[2], n[0]), (d[0].map(|x| -x), n[2])]).0;
        Bernstein::sum_of_products([(c[0], across_y), (c[1].map(|x| -x), across_x)])
    }
}
