//! Cameras: blur, planes of focus, places of points on the film, fisheye lenses, openings with blades, and lenses of glass.

use std::f64::consts::{SQRT_2, TAU};

use glam::{DVec2, DVec3, Vec2};

use super::{Failures, Random, Row};
use crate::camera::realistic::{LensTable, Sensor};
use crate::camera::{Aperture, Blades, Camera, CameraRay, Fisheye, FisheyeMapping, Orthographic, Perspective, Pose, Realistic, Spherical};
use crate::math::{Ray, Transform};

/// The rows.
pub fn rows() -> Vec<Row> {
    vec![circle_of_confusion(), planes_of_focus(), places_on_the_film(), fisheye_angles(), blades(), focus_of_glass(), falloff()]
}

/// Rounding of a number of f32, relative.
const ROUNDING: f64 = 1.0 / 16_777_216.0;
const MAPPINGS: [FisheyeMapping; 4] =
    [FisheyeMapping::Equidistant, FisheyeMapping::Equisolid, FisheyeMapping::Stereographic, FisheyeMapping::Orthographic];

fn origin() -> Pose {
    Pose::new(&Transform::IDENTITY)
}

/// The middles of the cells of a grid over the unit square.
fn grid(side: u32) -> impl Iterator<Item = Vec2> {
    let middle = move |k: u32| (k as f32 + 0.5) / side as f32;
    (0..side).flat_map(move |i| (0..side).map(move |j| Vec2::new(middle(i), middle(j))))
}

/// c = A f (d − s)/(d (s − f)) for a lens of diameter A = f/N in focus at s, and a point at distance d. The sensor is v = f s/(s − f) behind
/// the lens; the two positions on it at which opposite edges of the lens see the point are c apart.
fn circle_of_confusion() -> Row {
    let (f, number, s, d, height) = (0.05, 2.0, 2.0, 4.0, 0.024);
    let found = move || {
        let v = f * s / (s - f);
        let lens = Perspective::new(origin(), 40.0, (0.5 * f / number) as f32, s as f32).with_sensor(v, height, None);
        let camera = Camera::Perspective(lens);
        // The concentric map takes the middles of opposite edges of the square to opposite edges of the disk.
        let seen = [1.0, 0.0].map(|x| camera.connect(DVec3::new(0.0, 0.0, -d).as_vec3(), 1.0, Vec2::new(x, 0.5), 0.0));
        let [Some(right), Some(left)] = seen else { return f64::NAN };
        1e3 * height * f64::from(right.film.distance(left.film))
    };
    Row::new(
        "W19",
        "width of a blurred point at 4 m, 50 mm at f/2 in focus at 2 m, mm",
        "seven roundings of a position on the film, times its height of 24 mm",
    )
    .number("on the axis", 0.320512821, 1e-5, found)
}

/// The rays of a point of the film, from any two points of the lens, meet in the plane of focus, however film and plane are moved.
fn planes_of_focus() -> Row {
    let reason = "32 roundings, over the cosine of the angle between the ray and the normal of the plane";
    Row::new("C1", "rays of a point of the film that do not meet in the plane of focus", reason).never(
        "shifted and tilted, with and without blades",
        1_000_000,
        |tries| Failures::count_judged(tries, meet_in_focus),
    )
}

fn meet_in_focus(random: &mut Random) -> Option<Option<String>> {
    let tilt = [random.range(-60.0, 60.0), random.range(-60.0, 60.0)];
    let (fov, radius, distance) = (random.range(5.0, 100.0), random.magnitude(1e-3, 0.3), random.magnitude(0.5, 100.0));
    let shift = [random.range(-0.5, 0.5), random.range(-0.5, 0.5)];
    let lens = Perspective::new(origin(), fov, radius as f32, distance as f32).shifted(shift).tilted(tilt);
    let lens =
        if random.below(2) == 0 { lens } else { lens.with_blades(Blades::new(3 + random.below(7) as u32, random.range(0.0, 360.0))) };
    let camera = Camera::Perspective(lens);
    let [(sin_x, cos_x), (sin_y, cos_y)] = tilt.map(|degrees| degrees.to_radians().sin_cos());
    let normal = DVec3::new(sin_y * cos_x, -sin_x, cos_y * cos_x);
    let film = random.square();
    let [a, b] = [random.square(), random.square()].map(|u| {
        let ray = camera.ray(film, 1.5, u, 0.0);
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let cos = normal.dot(d);
        (o + d * (normal.dot(DVec3::new(0.0, 0.0, -distance) - o) / cos), cos.abs())
    });
    let (cos, far) = (a.1.min(b.1), a.0.length().max(b.0.length()));
    // Points behind the lens, or where the plane of focus is seen along itself, are in focus at no distance.
    let is_seen = a.0.z < 0.0 && b.0.z < 0.0 && cos > 0.1 && far < 20.0 * distance;
    is_seen.then(|| (a.0.distance(b.0) > 32.0 * ROUNDING * far / cos).then(|| format!("{camera:?} at {film}")))
}

/// A point is seen at a position on the film whose ray passes through it.
fn places_on_the_film() -> Row {
    let reason = "128 roundings, as an angle: positions on the film are rounded too";
    Row::new("C2", "points whose position on the film has a ray that misses them", reason).never(
        "perspective, orthographic, spherical and four fisheye cameras",
        1_000_000,
        |tries| Failures::count_judged(tries, is_seen_where_it_is),
    )
}

fn is_seen_where_it_is(random: &mut Random) -> Option<Option<String>> {
    let to_world = random.rotation().then(&Transform::translate(random.direction()).expect("finite"));
    let pose = Pose::new(&to_world);
    let camera = match random.below(8) {
        0 => {
            let lens = Perspective::new(pose, random.range(5.0, 100.0), 0.01, random.magnitude(0.5, 100.0) as f32);
            let lens = lens.shifted([random.range(-0.5, 0.5), random.range(-0.5, 0.5)]);
            Camera::Perspective(lens.tilted([random.range(-30.0, 30.0), random.range(-30.0, 30.0)]))
        }
        1 => Camera::Perspective(Perspective::new(pose, random.range(5.0, 100.0), 0.0, 1.0)),
        2 => Camera::Orthographic(Orthographic { pose, height: random.magnitude(0.1, 10.0) as f32 }),
        3 => Camera::Spherical(Spherical { pose }),
        k => Camera::Fisheye(Fisheye::new(pose, random.range(30.0, if k == 7 { 180.0 } else { 300.0 }), MAPPINGS[k - 4])),
    };
    let (film, lens) = (random.square(), random.square());
    let CameraRay { ray, weight } = camera.sample(film, 1.5, lens, 0.0);
    // A pole of a panorama is a whole edge of the film, and has no density.
    let is_pole = matches!(camera, Camera::Spherical(_)) && film.y == 0.0;
    if weight == 0.0 || is_pole {
        return None;
    }
    let p = ray.at(random.magnitude(0.5, 20.0) as f32);
    let miss = camera.connect(p, 1.5, lens, 0.0).map_or(f64::INFINITY, |seen| {
        let Ray { origin, direction, .. } = camera.sample(seen.film, 1.5, lens, 0.0).ray;
        let line = p.as_dvec3() - origin.as_dvec3();
        let away = line - direction.as_dvec3() * line.dot(direction.as_dvec3());
        let wide = if let Camera::Orthographic(camera) = &camera { camera.height.into() } else { 0.0 };
        away.length() / (line.length() + wide)
    });
    Some((miss > 128.0 * ROUNDING).then(|| format!("{camera:?} at {film}")))
}

/// Angle from the axis, halfway between the centre and the edge of a picture of 180 degrees, by the four formulas.
fn fisheye_angles() -> Row {
    let half = SQRT_2 / 4.0;
    let exact = [45.0, (2.0 * half.asin()).to_degrees(), (2.0 * 0.5f64.atan()).to_degrees(), 30.0];
    let row = Row::new("C3", "angle halfway to the edge of a fisheye picture of 180°, degrees", "a few roundings of f32");
    MAPPINGS.into_iter().zip(exact).fold(row, |row, (mapping, exact)| {
        row.number(format!("{mapping:?}").to_lowercase(), exact, 2e-5, move || {
            let camera = Camera::Fisheye(Fisheye::new(origin(), 180.0, mapping));
            let d = camera.ray(Vec2::new(0.75, 0.5), 1.0, Vec2::ZERO, 0.0).direction.as_dvec3();
            d.truncate().length().atan2(-d.z).to_degrees()
        })
    })
}

/// Over a regular polygon with n corners on the unit circle the mean of r² is (2 + cos(2π/n))/6; over the disk it is 1/2.
fn blades() -> Row {
    let row = Row::new("C4", "mean r² of points of the lens, radius 1", "the grid of 256 × 256 points");
    let moment = |aperture: Aperture| grid(256).map(|u| f64::from(aperture.point(u).length_squared())).sum::<f64>() / 65536.0;
    let row = row.number("disk", 0.5, 1e-4, move || moment(Aperture::disk(1.0)));
    [3, 5, 6, 8].into_iter().fold(row, |row, n| {
        let exact = (2.0 + (TAU / f64::from(n)).cos()) / 6.0;
        row.number(format!("{n} blades"), exact, 1e-4, move || moment(Aperture { radius: 1.0, blades: Some(Blades::new(n, 20.0)) }))
    })
}

/// A lens of glass, 1.5, whose surfaces have the radius 0.1 m; with a stop behind it if it has a diameter. Lengths in metres.
fn glass_lens(diameter: f64, stop: Option<f64>, focus: f64, height: f64) -> Option<Realistic> {
    let mut rows = vec![[0.1, 0.002, 1.5, diameter], [-0.1, if stop.is_some() { 0.01 } else { 0.0 }, 0.0, diameter]];
    rows.extend(stop.map(|stop| [0.0, 0.0, 0.0, stop]));
    Realistic::new(origin(), &LensTable::new(&rows).ok()?, focus, Sensor { height, width: None }, 1.0)
}

/// Rays from the middle of the film through the edge of a small lens cross its axis in the focus.
fn focus_of_glass() -> Row {
    let crossing = || {
        let camera = Camera::Realistic(glass_lens(1e-3, None, 1.0, 0.024)?);
        let rays = grid(16).map(|u| camera.sample(Vec2::splat(0.5), 1.0, u, 0.0)).filter(|ray| ray.weight > 0.0);
        // Where the ray is closest to the axis. Rays nearly parallel to it are left out: their rounding is too large.
        let depth = |CameraRay { ray, .. }: CameraRay| {
            let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
            let across: DVec2 = d.truncate();
            (across.length() > 3e-4).then(|| o.z - d.z * o.truncate().dot(across) / across.length_squared())
        };
        let depths: Vec<f64> = rays.filter_map(depth).collect();
        Some(depths.iter().sum::<f64>() / depths.len() as f64)
    };
    Row::new(
        "C5",
        "where a lens of glass that focuses at 1 m brings rays together, m",
        "spherical aberration, 3e-4, and the rounding of rays that differ from the axis by 5e-4",
    )
    .number("biconvex, index 1.5, 1 mm wide", -1.0, 2e-3, move || crossing().unwrap_or(f64::NAN))
}

/// A small stop behind the lens is the exit pupil, so that the light on the film falls with cos⁴ θ.
fn falloff() -> Row {
    let row = Row::new("C6", "light at an angle to the axis of a lens, over that in its middle: cos⁴", "the grid of 256 × 256 points");
    [10.0f64, 20.0, 30.0].into_iter().fold(row, |row, degrees| {
        let (slope, exact) = (degrees.to_radians().tan(), degrees.to_radians().cos().powi(4));
        let light = move || {
            let distance = glass_lens(0.04, Some(0.002), 2.0, 0.024)?.film_distance();
            let camera = Camera::Realistic(glass_lens(0.04, Some(0.002), 2.0, 2.0 * distance * slope)?);
            let sum = |y: f32| grid(256).map(|u| f64::from(camera.sample(Vec2::new(0.5, y), 1.0, u, 0.0).weight)).sum::<f64>();
            Some(sum(0.0) / sum(0.5))
        };
        row.number(format!("{degrees}°"), exact, 3e-3, move || light().unwrap_or(f64::NAN))
    })
}
