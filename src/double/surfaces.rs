//! Surfaces and their intersections in double precision.

use glam::{DMat3, DVec2, DVec3};

use super::materials::DoubleMaterial;
use crate::error::Result;
use crate::rays::{Ray, RayCaster};

/// A ray without end.
#[derive(Clone, Copy, Debug)]
pub struct DoubleRay {
    pub origin: DVec3,
    /// Unit direction.
    pub direction: DVec3,
}

/// What surfaces have beside their form.
#[derive(Clone, Copy, Debug)]
pub struct Appearance {
    pub material: DoubleMaterial,
    /// Radiance; zero where nothing is emitted.
    pub emission: DVec3,
    pub two_sided: bool,
}

/// Surfaces that rays can meet.
#[derive(Default)]
pub struct SurfaceList {
    /// Corners of triangles, three for each.
    corners: Vec<DVec3>,
    facets: Vec<Facet>,
    round: Vec<(Round, Appearance)>,
}

/// What a triangle has beside its corners.
#[derive(Clone, Copy)]
pub struct Facet {
    pub appearance: Appearance,
    /// Unit normal.
    pub normal: DVec3,
    /// Normals of the corners, between which the shading normal is interpolated.
    pub normals: Option<[DVec3; 3]>,
    /// Texture coordinates of the corners; zero where no texture is known.
    pub uvs: [DVec2; 3],
    /// The component of the normal whose sign chooses its axes, as the renderer has it: see [`Frame::around`].
    pub up: f64,
}

/// A surface without corners.
pub enum Round {
    /// Image of the unit sphere under M: centre + M x, with the inverse of M.
    Sphere { center: DVec3, inverse: DMat3 },
    /// Image of the unit disk: centre + a x + b y.
    Disk { center: DVec3, x: DVec3, y: DVec3, normal: DVec3 },
}

/// A surface point that a ray has met.
#[derive(Clone, Copy, Debug)]
pub struct DoubleHit {
    /// Distance from the origin of the ray (m).
    pub t: f64,
    pub p: DVec3,
    /// Unit geometric normal, to the outside.
    pub ng: DVec3,
    /// Frame of the shading normal.
    pub frame: Frame,
    pub appearance: Appearance,
}

/// The surfaces, ready for rays.
pub struct Surfaces {
    facets: Vec<Facet>,
    caster: RayCaster,
    round: Vec<(Round, Appearance)>,
}

impl SurfaceList {
    pub fn triangle(&mut self, corners: [DVec3; 3], facet: Facet) {
        self.corners.extend(corners);
        self.facets.push(facet);
    }

    pub fn round(&mut self, round: Round, appearance: Appearance) {
        self.round.push((round, appearance));
    }

    /// # Errors
    /// `Invalid` for coordinates that are not 0 or between 10⁻⁶⁰ and 10⁶⁰.
    pub fn build(self) -> Result<Surfaces> {
        let count = u32::try_from(self.facets.len()).unwrap_or(u32::MAX);
        let triangles = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Ok(Surfaces { facets: self.facets, caster: RayCaster::new(self.corners, triangles)?, round: self.round })
    }
}

impl Surfaces {
    /// The first surface that a ray meets.
    pub fn closest(&self, ray: &DoubleRay) -> Option<DoubleHit> {
        let flat = self.caster.closest(&Ray::new(ray.origin, ray.direction));
        let mut end = flat.map_or(f64::INFINITY, |hit| hit.t);
        let mut nearest = None;
        for (round, appearance) in &self.round {
            if let Some(t) = round.intersect(ray, end) {
                (end, nearest) = (t, Some((round, appearance)));
            }
        }
        if let Some((round, appearance)) = nearest {
            let p = ray.origin + ray.direction * end;
            let ng = round.normal(p);
            return Some(DoubleHit { t: end, p, ng, frame: Frame::around(ng, ng.z), appearance: *appearance });
        }
        flat.map(|hit| {
            let facet = &self.facets[hit.triangle as usize];
            let frame = match facet.shading_normal(hit.uv, ray.direction) {
                Some(ns) => Frame::around(ns, ns.z),
                None => Frame::around(facet.normal, facet.up),
            };
            let [a, b, c] = facet.uvs;
            let uv = a * (1.0 - hit.uv.x - hit.uv.y) + b * hit.uv.x + c * hit.uv.y;
            let appearance = Appearance { material: facet.appearance.material.at(uv), ..facet.appearance };
            DoubleHit { t: hit.t, p: ray.origin + ray.direction * hit.t, ng: facet.normal, frame, appearance }
        })
    }
}

impl Facet {
    /// Interpolated normal, bent towards the viewer until its cosine is two thirds of that of the facet's own normal; `None` for a flat
    /// triangle.
    fn shading_normal(&self, w: DVec2, direction: DVec3) -> Option<DVec3> {
        let [a, b, c] = self.normals?;
        let ns = (a * (1.0 - w.x - w.y) + b * w.x + c * w.y).try_normalize().filter(|ns| ns.dot(self.normal) > 0.0)?;
        let facing = -self.normal.dot(direction);
        let seen = -direction * facing.signum();
        let (cos, least) = (ns.dot(seen), 2.0 / 3.0 * facing.abs());
        Some(if cos >= least { ns } else { (ns + seen * (least - cos)).try_normalize().unwrap_or(ns) })
    }
}

impl Round {
    /// Distance of the first hit before `end`.
    fn intersect(&self, ray: &DoubleRay, end: f64) -> Option<f64> {
        let is_on_ray = |t: &f64| *t > 0.0 && *t < end;
        match self {
            // |o + t d| = 1 for the point of the ray that is nearest to the centre, and half of the chord.
            Round::Sphere { center, inverse } => {
                let (o, d) = (*inverse * (ray.origin - *center), *inverse * ray.direction);
                let middle = -o.dot(d) / d.length_squared();
                let half = ((1.0 - (o + d * middle).length_squared()) / d.length_squared()).sqrt();
                // NaN where the ray passes the sphere.
                [middle - half, middle + half].into_iter().find(is_on_ray)
            }
            Round::Disk { center, x, y, normal } => {
                let o = ray.origin - *center;
                let t = Some(-normal.dot(o) / normal.dot(ray.direction)).filter(is_on_ray)?;
                let (p, n) = (o + ray.direction * t, x.cross(*y));
                let (a, b) = (p.cross(*y).dot(n), x.cross(p).dot(n));
                (a * a + b * b <= n.length_squared().powi(2)).then_some(t)
            }
        }
    }

    fn normal(&self, p: DVec3) -> DVec3 {
        match self {
            Round::Sphere { center, inverse } => (inverse.transpose() * (*inverse * (p - *center))).normalize(),
            Round::Disk { normal, .. } => *normal,
        }
    }
}

impl DoubleHit {
    /// Ray from the point in a direction. It starts beside the surface, farther than the rounding errors of the point.
    pub fn spawn(&self, from: &DoubleRay, direction: DVec3) -> DoubleRay {
        let magnitude = self.p.abs().max(from.origin.abs()).max_element();
        let off = self.ng * (OFF * magnitude).copysign(self.ng.dot(direction));
        DoubleRay { origin: self.p + off, direction }
    }
}

/// Distance from a surface at which rays start, relative to the coordinates: some ten roundings of a point.
const OFF: f64 = 32.0 * f64::EPSILON;

/// Orthonormal axes with the normal as z.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub x: DVec3,
    pub y: DVec3,
    pub z: DVec3,
}

impl Frame {
    /// Axes around the unit vector `z`, turned as those of the renderer, so that the same random numbers give the same directions.
    ///
    /// - `up`: number whose sign chooses one of two sets of axes. It is the component of `z`; where that is zero but for rounding errors, it is
    ///   what the renderer takes.
    ///
    /// Source: Duff et al., *Building an Orthonormal Basis, Revisited*, JCGT 6(1), 2017.
    pub fn around(z: DVec3, up: f64) -> Frame {
        let sign = 1f64.copysign(up);
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        Frame { x: DVec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x), y: DVec3::new(b, sign + z.y * z.y * a, -z.y), z }
    }

    pub fn to_local(self, w: DVec3) -> DVec3 {
        DVec3::new(w.dot(self.x), w.dot(self.y), w.dot(self.z))
    }

    pub fn to_world(self, w: DVec3) -> DVec3 {
        self.x * w.x + self.y * w.y + self.z * w.z
    }
}
