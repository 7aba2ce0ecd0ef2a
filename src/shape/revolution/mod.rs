//! Surfaces of revolution about the z axis, of a full turn or a part of it: what cylinders, cones, and parts of spheres and disks have in
//! common.

mod sector;

use glam::{DMat3, DVec2, DVec3, Vec2, Vec3};

pub(crate) use sector::Sector;

use super::sphere::uniform_radius;
use super::{
    Facet, HIT_ROUNDING, Shape, ShapeHit, SurfacePoint, VertexColor, border_width, gauss_nodes, offset_bound, stretch, unit_change,
};
use crate::math::float::ONE_MINUS_EPSILON;
use crate::math::{Aabb, AreaPdf, Ray, Transform};

/// The curve in the half-plane (ρ, z) that turns about the z axis, in a space of its own where its size is about 1.
pub(super) trait Profile: Send + Sync + 'static {
    /// Whether the surface has the same normal everywhere.
    const IS_FLAT: bool = false;

    /// Number of intervals along the curve over which the area is integrated: 1 if normals do not vary along it.
    const AREA_STEPS: u32 = 1;

    /// Distances along the line o + t d at which it meets the surface of a full turn, the lesser first, or NaN.
    ///
    /// - `o`: a point near the surface
    fn roots(&self, o: DVec3, d: DVec3) -> [f64; 2];

    /// Whether the point (ρ, z) of the unbounded curve lies on the curve, or beyond its ends by no more than `margin`.
    fn covers(&self, rho_z: DVec2, margin: f64) -> bool;

    /// The point of the curve that is nearest to a point close by.
    fn project(&self, rho_z: DVec2) -> DVec2;

    /// Normal of the curve, to the outside, of any length.
    fn normal(&self, rho_z: DVec2) -> DVec2;

    /// Change of the normal n, of [`Profile::normal`]'s length, when the point moves by `along`; `None` where it is not defined.
    fn normal_change(&self, at: &Place, along: DVec3) -> Option<DVec3>;

    /// Area of the surface for each radian of the turn.
    fn area_per_radian(&self) -> f64;

    /// The point of the curve at a share of the area.
    fn at_share(&self, share: f64) -> DVec2;

    /// Inverse of [`Profile::at_share`].
    fn share(&self, rho_z: DVec2) -> f64;

    /// Texture coordinates.
    fn uv(&self, at: &Place, sector: &Sector) -> Vec2;

    /// Derivatives of the position by the texture coordinates; `None` where they are not defined.
    fn tangents(&self, at: &Place, sector: &Sector) -> Option<[DVec3; 2]>;

    /// Greatest a·ρ + b·z on the curve.
    fn greatest(&self, a: f64, b: f64) -> f64;
}

/// Point of a surface of revolution.
pub(super) struct Place {
    /// Unit direction from the axis; +x on the axis.
    pub direction: DVec2,
    /// Distance ρ from the axis, and z.
    pub rho_z: DVec2,
}

impl Place {
    pub fn position(&self) -> DVec3 {
        (self.direction * self.rho_z.x).extend(self.rho_z.y)
    }

    /// Change of the direction when the point moves by `along`; `None` on the axis.
    pub fn turn(&self, along: DVec3) -> Option<DVec3> {
        let across = self.direction.perp();
        (self.rho_z.x > 0.0).then(|| (across * (across.dot(along.truncate()) / self.rho_z.x)).extend(0.0))
    }

    /// Derivative of the position by a share of the turn; `None` on the axis.
    pub fn around(&self, sector: &Sector) -> Option<DVec3> {
        (self.rho_z.x > 0.0).then(|| (self.direction.perp() * (self.rho_z.x * sector.angle())).extend(0.0))
    }
}

/// Middle of the profiles' own spaces, near which all of them lie.
const MIDDLE: DVec3 = DVec3::new(0.0, 0.0, 0.5);

/// Image of a surface of revolution under p ↦ center + linear·p, in f64 because curved shapes are few.
///
/// Borders are widened by the bound of the rounding errors, so that no ray passes between parts that adjoin each other.
pub(super) struct Revolved<P> {
    profile: P,
    sector: Sector,
    center: DVec3,
    linear: DMat3,
    inverse: DMat3,
    /// Bounding box.
    low: DVec3,
    high: DVec3,
    /// Size of the centre's coordinates in the profile's own space, in which they are rounded.
    far: f64,
    area: f64,
}

impl<P: Profile> Revolved<P> {
    /// Places a surface.
    ///
    /// - `size`: lengths of the profile's unit across and along the axis (m)
    /// - `base`: z of the profile's origin (m)
    pub fn new(profile: P, sector: Sector, size: [f64; 2], base: f64, to_world: &Transform) -> Revolved<P> {
        let size = DVec3::new(size[0], size[0], size[1]);
        let linear = to_world.matrix().matrix3 * DMat3::from_diagonal(size);
        let inverse = DMat3::from_diagonal(size.recip()) * to_world.inverse().matrix().matrix3;
        let center = to_world.point(DVec3::Z * base);
        let rows = linear.transpose();
        let greatest = |row: DVec3| profile.greatest(sector.greatest(row.truncate()), row.z);
        let corner = |side: f64| {
            center + side * DVec3::new(greatest(side * rows.x_axis), greatest(side * rows.y_axis), greatest(side * rows.z_axis))
        };
        let far = (inverse.x_axis * center.x).length() + (inverse.y_axis * center.y).length() + (inverse.z_axis * center.z).length();
        let (low, high) = (corner(-1.0), corner(1.0));
        let mut surface = Revolved { profile, sector, center, linear, inverse, low, high, far, area: 0.0 };
        surface.area = surface.integrated_area();
        surface
    }

    /// Lower and upper corner of the bounding box.
    pub fn corners(&self) -> (DVec3, DVec3) {
        (self.low, self.high)
    }

    /// Area ∫ |det M|·|M⁻ᵀn| dA over the surface in its own space: that times r² if it is only enlarged by r, otherwise by the Gaussian rule of
    /// two points on each interval.
    fn integrated_area(&self) -> f64 {
        if let Some(r) = uniform_radius(self.linear) {
            return self.own_area() * r * r;
        }
        const TURN_STEPS: u32 = 64;
        let mut sum = 0.0;
        for along in gauss_nodes(P::AREA_STEPS) {
            let rho_z = self.profile.at_share(along);
            sum += gauss_nodes(TURN_STEPS).map(|turn| self.stretch(&Place { direction: self.sector.direction(turn), rho_z })).sum::<f64>();
        }
        self.own_area() * sum / f64::from(4 * TURN_STEPS * P::AREA_STEPS)
    }

    /// Area in the profile's own space.
    fn own_area(&self) -> f64 {
        self.sector.angle() * self.profile.area_per_radian()
    }

    /// Normal in the profile's own space, of the length that the profile gives it.
    fn own_normal(&self, at: &Place) -> DVec3 {
        let normal = self.profile.normal(at.rho_z);
        (at.direction * normal.x).extend(normal.y)
    }

    /// World area per area in the profile's own space.
    fn stretch(&self, at: &Place) -> f64 {
        stretch(self.linear, self.own_normal(at).normalize())
    }

    /// Density by area with which points are sampled: uniform in the profile's own space.
    fn pdf_at(&self, at: &Place) -> AreaPdf {
        AreaPdf::new((1.0 / (self.own_area() * self.stretch(at))) as f32)
    }

    /// The point of the surface near a point in the world.
    fn place(&self, p: DVec3) -> Place {
        let own = self.inverse * (p - self.center);
        let rho = own.truncate().length();
        let direction = if rho > 0.0 { own.truncate() / rho } else { DVec2::X };
        Place { direction, rho_z: self.profile.project(DVec2::new(rho, own.z)) }
    }

    fn at(&self, at: &Place) -> SurfacePoint {
        let ng = (self.inverse.transpose() * self.own_normal(at)).normalize().as_vec3();
        let p = (self.center + self.linear * at.position()).as_vec3();
        let offset = offset_bound(ng, self.low.abs().max(self.high.abs()).as_vec3());
        SurfacePoint { p, offset, ng, ns: ng, uv: self.profile.uv(at, &self.sector), color: VertexColor::WHITE }
    }

    /// Whether a point where the line in the direction `d` meets the surface of a full turn lies on the surface.
    ///
    /// - `rounding`: rounding error of coordinates
    fn covers(&self, p: DVec3, d: DVec3, rounding: f64) -> bool {
        let across = p.truncate();
        let rho_z = DVec2::new(across.length(), p.z);
        let normal = self.profile.normal(self.profile.project(rho_z));
        let along_normal = if rho_z.x > 0.0 { normal.x * across.dot(d.truncate()) / rho_z.x } else { 0.0 } + normal.y * d.z;
        let cos = along_normal / (normal.length() * d.length());
        let margin = border_width(rounding, cos);
        self.profile.covers(rho_z, margin) && self.sector.covers(across, margin)
    }
}

impl<P: Profile> Shape for Revolved<P> {
    fn count(&self) -> u32 {
        1
    }

    fn bounds(&self, _: u32) -> Aabb {
        Aabb { min: self.low.as_vec3(), max: self.high.as_vec3() }
    }

    fn area(&self, _: u32) -> f32 {
        self.area as f32
    }

    fn facet(&self, _: u32) -> Facet {
        Facet::Curved
    }

    fn is_flat(&self, _: u32) -> bool {
        P::IS_FLAT
    }

    /// Meets the surface of a full turn, and takes the first hit that lies on the part which is there.
    ///
    /// Distances count from the point of the line that is nearest to the middle of the surface, because the terms of the quadratic
    /// equation lose the digits of a small surface far away. A plane has no such terms, and a ray that starts on it stays on it.
    fn intersect(&self, _: u32, ray: &Ray) -> Option<ShapeHit> {
        let o = self.inverse * (ray.origin.as_dvec3() - self.center);
        let d = self.inverse * ray.direction.as_dvec3();
        let start = if P::IS_FLAT { 0.0 } else { (MIDDLE - o).dot(d) / d.length_squared() };
        let near = o + d * start;
        let rounding = HIT_ROUNDING * (1.0 + o.length() + self.far);
        let hit = |s: f64| {
            let t = (start + s) as f32;
            (t > 0.0 && t < ray.t_max && self.covers(near + d * s, d, rounding)).then_some(t)
        };
        let t = self.profile.roots(near, d).into_iter().find_map(hit)?;
        Some(ShapeHit { t, uv: Vec2::ZERO })
    }

    fn point(&self, _: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        self.at(&self.place(ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(hit.t)))
    }

    fn tangents(&self, _: u32, point: &SurfacePoint, _: f32) -> Option<[Vec3; 2]> {
        let tangents = self.profile.tangents(&self.place(point.p.as_dvec3()), &self.sector)?;
        Some(tangents.map(|tangent| (self.linear * tangent).as_vec3()))
    }

    fn normal_change(&self, _: u32, _: Vec2, point: &SurfacePoint, along: Vec3, _: f32) -> Option<Vec3> {
        let at = self.place(point.p.as_dvec3());
        let change = self.profile.normal_change(&at, self.inverse * along.as_dvec3())?;
        let to_world = self.inverse.transpose();
        Some(unit_change(to_world * self.own_normal(&at), to_world * change).as_vec3())
    }

    /// Samples uniformly in the profile's own space. The density in the world is higher where that is stretched less.
    fn sample_area(&self, _: u32, u: Vec2) -> (SurfacePoint, AreaPdf) {
        let at = Place { direction: self.sector.direction(f64::from(u.x)), rho_z: self.profile.at_share(f64::from(u.y)) };
        let point = self.at(&at);
        // The density is that of the rounded point, so that it is the same number that `area_pdf` finds for this point later. At the apex
        // of a cone, rounding may put the point on the axis, from which it has no direction.
        (point, self.pdf_at(&self.place(point.p.as_dvec3())))
    }

    fn area_pdf(&self, _: u32, point: &SurfacePoint) -> AreaPdf {
        self.pdf_at(&self.place(point.p.as_dvec3()))
    }

    fn area_coordinates(&self, _: u32, point: &SurfacePoint) -> Option<Vec2> {
        let at = self.place(point.p.as_dvec3());
        let (turn, along) = (self.sector.angle_of(at.direction) / self.sector.angle(), self.profile.share(at.rho_z));
        Some(Vec2::new(turn as f32, along as f32).clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON)))
    }
}
