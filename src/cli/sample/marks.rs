//! Pictures of point sets: in the plane, or in space as seen from above the horizon.

use glam::{UVec2, Vec2, Vec3};

use super::points::Domain;
use crate::error::Result;
use crate::film::{Channel, Image};
use crate::output::{Tonemap, png};

/// Point in the picture, which spans −1 … 1 with a margin; y upwards.
#[derive(Clone, Copy, Debug)]
pub struct Mark {
    at: Vec2,
    /// Depth in the view: 0 at the front and 1 at the far side of the sphere.
    depth: f32,
}

/// Edge of the picture (pixels), and the number of pixels of a unit.
const SIZE: u32 = 640;
const SCALE: f32 = 290.0;
/// Radius of a dot (pixels).
const DOT: f32 = 1.6;
/// Sine and cosine of the view from 25° above the horizon.
const SIN_COS_TILT: (f32, f32) = (0.422_618_27, 0.906_307_8);

/// Marks of the points, the farthest first.
pub fn marks(points: &[Vec3], domain: Domain) -> Vec<Mark> {
    let mut marks: Vec<Mark> = points.iter().map(|&p| mark(p, domain)).collect();
    marks.sort_by(|a, b| b.depth.total_cmp(&a.depth));
    marks
}

fn mark(p: Vec3, domain: Domain) -> Mark {
    let (sin, cos) = SIN_COS_TILT;
    match domain {
        Domain::Square => Mark { at: 2.0 * p.truncate() - 1.0, depth: 0.0 },
        Domain::Plane => Mark { at: p.truncate(), depth: 0.0 },
        // x to the right, z upwards, y away from the eye.
        Domain::Space => Mark { at: Vec2::new(p.x, p.z * cos + p.y * sin), depth: 0.5 + 0.5 * (p.y * cos - p.z * sin) },
    }
}

/// Outline of the domain: corners of closed lines.
fn outlines(domain: Domain) -> Vec<Vec<Vec2>> {
    const STEPS: u32 = 180;
    let circle = |f: &dyn Fn(f32, f32) -> Vec2| {
        (0..=STEPS).map(|i| (std::f32::consts::TAU * i as f32 / STEPS as f32).sin_cos()).map(|(s, c)| f(c, s)).collect()
    };
    match domain {
        Domain::Square => vec![[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)].map(Vec2::from).to_vec()],
        Domain::Plane => vec![circle(&|x, y| Vec2::new(x, y))],
        // Silhouette and equator.
        Domain::Space => vec![circle(&|x, y| Vec2::new(x, y)), circle(&|x, y| mark(Vec3::new(x, y, 0.0), domain).at)],
    }
}

fn pixel(at: Vec2) -> Vec2 {
    0.5 * SIZE as f32 + SCALE * Vec2::new(at.x, -at.y)
}

/// Grey of a dot: near ones are dark, far ones pale.
fn shade(depth: f32) -> f32 {
    0.05 + 0.65 * depth
}

/// Picture as SVG.
pub fn svg(marks: &[Mark], domain: Domain) -> String {
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {SIZE} {SIZE}\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    for line in outlines(domain) {
        let corners: Vec<String> = line.into_iter().map(pixel).map(|p| format!("{:.1},{:.1}", p.x, p.y)).collect();
        text += &format!("<polyline points=\"{}\" fill=\"none\" stroke=\"silver\"/>\n", corners.join(" "));
    }
    for mark in marks {
        let (p, gray) = (pixel(mark.at), (255.0 * shade(mark.depth)) as u8);
        text += &format!("<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"{DOT}\" fill=\"rgb({gray},{gray},{gray})\"/>\n", p.x, p.y);
    }
    text + "</svg>\n"
}

/// Picture as PNG.
pub fn png(marks: &[Mark], domain: Domain) -> Result<Vec<u8>> {
    let mut canvas = vec![1.0f32; (SIZE * SIZE) as usize];
    for line in outlines(domain) {
        for ends in line.windows(2) {
            let steps = (ends[0].distance(ends[1]) * SCALE).ceil().max(1.0);
            (0..=steps as u32).for_each(|i| dot(&mut canvas, pixel(ends[0].lerp(ends[1], i as f32 / steps)), 0.7, 0.75));
        }
    }
    marks.iter().for_each(|mark| dot(&mut canvas, pixel(mark.at), DOT, shade(mark.depth)));
    gray(canvas)
}

/// Draws a dot with smooth edges.
fn dot(canvas: &mut [f32], at: Vec2, radius: f32, shade: f32) {
    let low = (at - radius - 1.0).max(Vec2::ZERO).as_uvec2();
    let high = (at + radius + 1.0).as_uvec2().min(UVec2::splat(SIZE - 1));
    for (x, y) in (low.y..=high.y).flat_map(|y| (low.x..=high.x).map(move |x| (x, y))) {
        let distance = (Vec2::new(x as f32, y as f32) + 0.5).distance(at);
        let cover = (radius + 0.5 - distance).clamp(0.0, 1.0);
        let value = &mut canvas[(y * SIZE + x) as usize];
        *value += cover * (shade - *value);
    }
}

fn gray(values: Vec<f32>) -> Result<Vec<u8>> {
    let channels = ["R", "G", "B"].map(|name| Channel { name: name.into(), values: values.clone() }).into();
    let size = UVec2::splat(SIZE);
    png::encode(&Image { full_size: size, origin: UVec2::ZERO, size, channels }, &Tonemap::default())
}
