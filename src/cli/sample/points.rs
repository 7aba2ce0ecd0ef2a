//! Warps by name, and their points.

use glam::{DVec3, UVec2, Vec2, Vec3};

use crate::bsdf::microfacet::{Distribution, MIN_ALPHA, Microfacets};
use crate::error::{Error, Result};
use crate::math::float::{self, gamma};
use crate::math::{Local, SphericalRectangle, SphericalTriangle, warp};
use crate::sampler::{Kind, SampleNumbers, SamplerSpec};

/// Domain of the points of a warp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// The unit square.
    Square,
    /// The plane, within −1 … 1.
    Plane,
    /// Space, within the unit sphere.
    Space,
}

/// Parameters of warps.
#[derive(Clone, Copy, Debug)]
pub struct Parameters {
    /// Exponent n of cosⁿ.
    pub exponent: f32,
    /// 1 − cos of the half angle of a cone.
    pub one_minus_cos: f32,
    /// Corners of a triangle; for a rectangle a corner and its two neighbours.
    pub corners: [Vec3; 3],
    /// Roughness of facets, along x and y.
    pub alpha: Vec2,
    /// Direction from which facets are seen: polar angle and azimuth (degrees).
    pub wo: [f64; 2],
}

/// Map from random numbers to a point.
pub enum Map {
    /// Map from the unit square.
    Square(OfSquare<Vec3>),
    /// Map from the unit square to the sphere, with a density.
    Sphere(Directions),
    /// Map with any number of random numbers.
    Free(fn(SampleNumbers) -> Vec3),
}

type OfSquare<T> = Box<dyn Fn(Vec2) -> T + Send + Sync>;

/// Map to the sphere, and the density of its directions [sr⁻¹].
pub struct Directions {
    /// The map.
    pub map: OfSquare<Vec3>,
    /// The density.
    pub pdf: Box<dyn Fn(Vec3) -> f32 + Send + Sync>,
}

/// A warp with its name.
pub struct Warp {
    /// Name on the command line.
    pub name: &'static str,
    /// Description in one line.
    pub about: &'static str,
    /// Domain of its points.
    pub domain: Domain,
    /// Makes the map; an error means that the parameters leave nothing to sample.
    pub map: fn(&Parameters) -> Result<Map>,
}

/// All warps. To add one: a row here.
pub const WARPS: &[Warp] = &[
    Warp {
        name: "disk",
        about: "Uniform on the unit disk, by the concentric map.",
        domain: Domain::Plane,
        map: |_| of_square(|u| warp::disk(u).extend(0.0)),
    },
    Warp {
        name: "triangle",
        about: "Uniform on a triangle, as the barycentrics of two corners.",
        domain: Domain::Square,
        map: |_| of_square(|u| warp::triangle(u).extend(0.0)),
    },
    Warp {
        name: "ball-rejection",
        about: "Uniform in the unit ball: points of the cube, until one lies inside.",
        domain: Domain::Space,
        map: |_| Ok(Map::Free(rejected)),
    },
    Warp {
        name: "ball",
        about: "Uniform in the unit ball, directly: a direction, and the cube root of u for a radius.",
        domain: Domain::Space,
        map: |_| Ok(Map::Free(ball)),
    },
    Warp {
        name: "sphere",
        about: "Uniform on the unit sphere.",
        domain: Domain::Space,
        map: |_| of_sphere(warp::uniform_sphere, |_| warp::uniform_sphere_pdf()),
    },
    Warp {
        name: "hemisphere",
        about: "Uniform on the hemisphere z > 0.",
        domain: Domain::Space,
        map: |_| of_sphere(warp::uniform_hemisphere, warp::uniform_hemisphere_pdf),
    },
    Warp {
        name: "hemisphere-angles",
        about: "The usual mistake: uniform in the angle, so that points crowd at the pole. Compare `hemisphere` and `cosine`.",
        domain: Domain::Space,
        map: |_| of_sphere(angles, warp::uniform_hemisphere_pdf),
    },
    Warp {
        name: "cosine",
        about: "On the hemisphere, with density proportional to the cosine.",
        domain: Domain::Space,
        map: |_| of_sphere(warp::cosine_hemisphere, warp::cosine_hemisphere_pdf),
    },
    Warp {
        name: "cosine-power",
        about: "On the hemisphere, with density proportional to cosⁿ: --exponent n.",
        domain: Domain::Space,
        map: |&Parameters { exponent: n, .. }| {
            of_sphere(move |u| warp::cos_power_hemisphere(u, n), move |w| warp::cos_power_hemisphere_pdf(w, n))
        },
    },
    Warp {
        name: "cone",
        about: "Uniform on a cone of directions: --angle degrees, its half angle.",
        domain: Domain::Space,
        map: |&Parameters { one_minus_cos: h, .. }| {
            let inside = move |w: Vec3| if 1.0 - w.z <= h { warp::uniform_cone_pdf(h) } else { 0.0 };
            of_sphere(move |u| warp::uniform_cone(u, h), inside)
        },
    },
    Warp {
        name: "spherical-triangle",
        about: "Uniform in the solid angle of a triangle, seen from the origin: --corners A B C.",
        domain: Domain::Space,
        map: spherical_triangle,
    },
    Warp {
        name: "spherical-rectangle",
        about: "Uniform in the solid angle of a rectangle, seen from the origin: --corners A B C, the right angle at A.",
        domain: Domain::Space,
        map: spherical_rectangle,
    },
    Warp {
        name: "visible-ggx",
        about: "Normals of the facets in sight, by Trowbridge and Reitz (GGX): --alpha X,Y --wo THETA,PHI.",
        domain: Domain::Space,
        map: |p| visible_normals(p, Distribution::Ggx),
    },
    Warp {
        name: "visible-beckmann",
        about: "Normals of the facets in sight, of Gaussian slopes: --alpha X,Y --wo THETA,PHI.",
        domain: Domain::Space,
        map: |p| visible_normals(p, Distribution::Beckmann),
    },
];

/// Identity map, for the points of samplers.
pub const SQUARE: Warp = Warp { name: "square", about: "", domain: Domain::Square, map: |_| of_square(|u| u.extend(0.0)) };

/// First `count` points.
pub fn draw(warp: &Warp, parameters: &Parameters, sampler: Kind, seed: u64, count: u32) -> Result<Vec<Vec3>> {
    let map = (warp.map)(parameters)?;
    let map = |mut numbers: SampleNumbers| match &map {
        Map::Square(map) | Map::Sphere(Directions { map, .. }) => map(numbers.get_2d(0)),
        Map::Free(map) => map(numbers),
    };
    let sequence = SamplerSpec { kind: sampler, seed, spp: count.into(), ..SamplerSpec::default() }.build();
    Ok((0..count).map(|i| map(sequence.sample(UVec2::ZERO, i.into()))).collect())
}

/// CSV with a header and a line per point, with all digits.
pub fn csv(points: &[Vec3], warp: &Warp) -> String {
    let mut text = if warp.domain == Domain::Space { "x,y,z\n" } else { "x,y\n" }.to_owned();
    for p in points {
        text += &match warp.domain {
            Domain::Space => format!("{:?},{:?},{:?}\n", p.x, p.y, p.z),
            _ => format!("{:?},{:?}\n", p.x, p.y),
        };
    }
    text
}

fn of_square(map: fn(Vec2) -> Vec3) -> Result<Map> {
    Ok(Map::Square(Box::new(map)))
}

fn of_sphere(map: impl Fn(Vec2) -> Vec3 + Send + Sync + 'static, pdf: impl Fn(Vec3) -> f32 + Send + Sync + 'static) -> Result<Map> {
    Ok(Map::Sphere(Directions { map: Box::new(map), pdf: Box::new(pdf) }))
}

fn spherical_triangle(parameters: &Parameters) -> Result<Map> {
    let seen = SphericalTriangle::new(parameters.corners).ok_or_else(unseen)?;
    of_sphere(move |u| seen.sample(u), move |w| if seen.contains(w) { seen.pdf() } else { 0.0 })
}

fn spherical_rectangle(parameters: &Parameters) -> Result<Map> {
    let [corner, b, c] = parameters.corners;
    let edges = [b - corner, c - corner];
    // f32 decimals leave a right angle wrong by a rounding of each coordinate.
    let scale = parameters.corners.map(Vec3::length).into_iter().fold(0.0, f32::max);
    if edges[0].dot(edges[1]).abs() > gamma(8) * scale * (edges[0].length() + edges[1].length()) {
        return Err(Error::Usage("--corners: expected a right angle at the first corner of a spherical-rectangle".into()));
    }
    let seen = SphericalRectangle::new(corner, edges).ok_or_else(unseen)?;
    of_sphere(move |u| seen.sample(u), move |w| if seen.contains(w) { seen.pdf() } else { 0.0 })
}

fn unseen() -> Error {
    Error::Usage("--corners: expected corners that span an area as seen from the origin, not edge-on".into())
}

fn visible_normals(parameters: &Parameters, distribution: Distribution) -> Result<Map> {
    let [theta, phi] = parameters.wo;
    if theta > 90.0 {
        return Err(Error::Usage(format!("--wo {theta},{phi}: expected at most 90 degrees from the normal; facets are seen from above")));
    }
    let smooth = || Error::Usage(format!("--alpha: expected at least {MIN_ALPHA:?}, smoother than which is a mirror"));
    let facets = Microfacets::new(parameters.alpha, distribution).ok_or_else(smooth)?;
    let ((sin, cos), (y, x)) = (float::sin_cos_degrees(theta), float::sin_cos_degrees(phi));
    let wo = Local(DVec3::new(sin * x, sin * y, cos).as_vec3());
    // G₁(wo) (wo·h) D(h) / cos θo, see `Microfacets::projected_area`.
    let pdf = move |h: Vec3| {
        let in_sight = if h.z > 0.0 { wo.0.dot(h).max(0.0) } else { 0.0 };
        2.0 * in_sight * facets.density(Local(h)) / (wo.cos() + facets.projected_area(wo))
    };
    of_sphere(move |u| facets.sample_visible(wo, u).0, pdf)
}

fn rejected(mut numbers: SampleNumbers) -> Vec3 {
    let mut dimension = 0;
    loop {
        let p = 2.0 * numbers.get_2d(dimension).extend(numbers.get_1d(dimension + 2)) - 1.0;
        if p.length_squared() < 1.0 {
            return p;
        }
        dimension += 3;
    }
}

fn ball(mut numbers: SampleNumbers) -> Vec3 {
    let direction = warp::uniform_sphere(numbers.get_2d(0));
    direction * float::powf(numbers.get_1d(2), 1.0 / 3.0)
}

/// θ = u · 90°: as many points lie between 0° and 10° as between 80° and 90°, where there is eleven times the area.
fn angles(u: Vec2) -> Vec3 {
    let (sin, cos) = float::sin_cos(u.x * std::f32::consts::FRAC_PI_2);
    let (y, x) = float::sin_cos(u.y * std::f32::consts::TAU);
    Vec3::new(sin * x, sin * y, cos)
}
