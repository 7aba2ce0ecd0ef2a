//! Laws of every kind of field that ray marching relies on.

use glam::DVec3;
use pt::shape::sdf::{Dual, Field, Union};

use super::zoo;
use crate::random::Random;

const FIELDS: u64 = 40;

fn each(mut check: impl FnMut(&str, &Field, &mut Random)) {
    for (name, make) in zoo::all() {
        for seed in 0..FIELDS {
            let mut random = Random::new(seed);
            let field = make(&mut random);
            check(&format!("{name}, seed {seed}"), &field, &mut random);
        }
    }
}

fn anywhere(random: &mut Random) -> DVec3 {
    random.in_cube() * random.decade(-1.0, 1.0)
}

/// |d(p) − d(q)| ≤ |p − q|, near and far. The tolerance is a few roundings of coordinates of 10.
#[test]
fn slopes_are_at_most_one() {
    each(|name, field, random| {
        for _ in 0..500 {
            let p = anywhere(random);
            let q = p + random.direction() * random.decade(-6.0, 1.0);
            let (change, way) = ((field.at(p) - field.at(q)).abs(), (p - q).length());
            assert!(change <= way + 64.0 * f64::EPSILON * 10.0, "{name}: {change} over {way} from {p}");
        }
    });
}

/// Point where a segment crosses the surface, by bisection.
fn crossing(field: &Field, mut a: DVec3, mut b: DVec3) -> Option<DVec3> {
    if (field.at(a) < 0.0) == (field.at(b) < 0.0) {
        return None;
    }
    for _ in 0..60 {
        let middle = 0.5 * (a + b);
        if (field.at(middle) < 0.0) == (field.at(a) < 0.0) { a = middle } else { b = middle }
    }
    Some(a)
}

/// No point of the surface is nearer than |d|.
#[test]
fn distances_are_never_too_large() {
    each(|name, field, random| {
        let [low, high] = field.bounds(0.2).map(|corner| corner.clamp(DVec3::splat(-1.5), DVec3::splat(1.5)));
        let mut near = || low + (high - low) * (random.in_cube() * 0.5 + 0.5);
        let segments = (0..3000).map(|_| (near(), near()));
        let surface: Vec<DVec3> = segments.filter_map(|(a, b)| crossing(field, a, b)).collect();
        assert!(surface.len() > 5, "{name}: only {} points", surface.len());
        for _ in 0..100 {
            let p = anywhere(random);
            let nearest = surface.iter().map(|s| (*s - p).length()).fold(f64::INFINITY, f64::min);
            assert!(field.at(p).abs() <= nearest * (1.0 + 1e-9) + 1e-12, "{name}: {} at {p}, but {nearest}", field.at(p));
        }
    });
}

/// An exact Euclidean distance leads to the surface: d(p − d ∇d) = 0.
#[test]
fn exact_distances_are_reached() {
    for (name, make) in zoo::EXACT {
        for seed in 0..FIELDS {
            let mut random = Random::new(seed);
            let field = make(&mut random);
            for _ in 0..200 {
                let p = anywhere(&mut random);
                let here = field.distance(Dual::coordinates(p));
                let left = field.at(p - here.gradient * here.value);
                assert!(left.abs() <= 1e-12, "{name}, seed {seed}: {left} is left of {} at {p}", here.value);
            }
        }
    }
}

/// Every point nearer to the solid than `grow` lies in the bounding box for the margin `grow`.
#[test]
fn bounding_boxes_contain_what_is_near() {
    each(|name, field, random| {
        for _ in 0..1000 {
            let (p, grow) = (random.in_cube() * 4.0, random.pick(&[0.0, 0.1, 1.0]));
            let [low, high] = field.bounds(grow);
            let inside = p.cmpge(low - 1e-12).all() && p.cmple(high + 1e-12).all();
            assert!(inside || field.at(p) > grow, "{name}: {} at {p}, outside of {low} to {high}", field.at(p));
        }
    });
}

/// A union skips only parts that cannot be nearest, so it is the minimum of its parts, to the bit.
#[test]
fn unions_skip_only_fields_that_cannot_be_nearest() {
    let kinds: Vec<_> = zoo::all().collect();
    let mut random = Random::new(1);
    for _ in 0..4000 {
        let of: Vec<Field> = (0..3).map(|_| random.pick(&kinds).1(&mut random)).collect();
        let union = Union::new(of.clone());
        for _ in 0..20 {
            let p = anywhere(&mut random);
            let all: Vec<f64> = of.iter().map(|field| field.at(p)).collect();
            let least = all.iter().copied().fold(f64::INFINITY, f64::min);
            let first = all.iter().position(|d| *d == least);
            assert_eq!(union.nearest(p.to_array()), (least, first.unwrap()), "at {p} of {of:?}");
        }
    }
}
