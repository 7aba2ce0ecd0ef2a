//! `pt sample tests.json`: runs the tests of the courses of dirt and darts.

use std::path::Path;
use std::process::ExitCode;

use glam::{DVec3, UVec2, Vec3};

use super::SampleArgs;
use super::globe::{COLUMNS, Density, Histogram, ROWS, pictures};
use super::material::of_sphere;
use crate::bsdf::TransportMode;
use crate::build::Source;
use crate::cli::{note, print_stdout};
use crate::describe;
use crate::error::Result;
use crate::import::darts::coursework::{self, ExpectedHit, Test, TestKind, Tests};
use crate::math::{self, Frame, Ray};
use crate::sampler::{SampleNumbers, SamplerSpec};
use crate::scene::Scene;
use crate::shape::ShapeHit;
use crate::world::World;

/// Sampled directions for each cell of the sphere.
const PER_CELL: u64 = 50;
/// Range of the integral of a density. It may be below 1, as directions below the surface are missing.
const INTEGRAL: std::ops::RangeInclusive<f64> = 0.90..=1.01;
/// Smallest share of valid samples.
const VALID: f64 = 0.90;

/// Runs the tests of a file; the exit code is 1 if one of them fails.
pub fn tests(path: &Path, args: &SampleArgs) -> Result<ExitCode> {
    let read = coursework::read(path, args.allow_outside)?;
    read.notes.iter().for_each(|warning| note(&format!("warning: {warning}")));
    let mut passed = 0;
    for test in &read.tests {
        let verdict = run(test, &read, args)?;
        let word = if verdict.passes { "passed" } else { "FAILED" };
        print_stdout(&format!("{}\n{}  {word}\n", test.name, verdict.lines.iter().map(|line| format!("  {line}\n")).collect::<String>()))?;
        passed += usize::from(verdict.passes);
    }
    print_stdout(&format!("{passed} of {} tests passed\n", read.tests.len()))?;
    Ok(ExitCode::from(u8::from(passed < read.tests.len())))
}

struct Verdict {
    lines: Vec<String>,
    passes: bool,
}

fn run(test: &Test, read: &Tests, args: &SampleArgs) -> Result<Verdict> {
    let source = Source { root: &test.scene, file: &read.file, files: &read.files };
    let world = crate::build::build(&describe::read(&test.scene, &read.file)?, source)?.world;
    let stem = || {
        let prefix = args.output.as_ref().map(|prefix| prefix.to_string_lossy().into_owned());
        format!("{}{}", prefix.unwrap_or_default(), test.name.replace(['/', '\\'], "_"))
    };
    match test.what {
        TestKind::Material { normal, incoming, density } => {
            let bsdf = of_sphere(&world)?;
            let frame = Frame::around(normal.as_vec3());
            let wo = frame.to_local(-incoming.as_vec3());
            let draw = |mut numbers: SampleNumbers| {
                let (choice, u) = numbers.get_3d(0);
                let sample = bsdf.sample(wo, choice, u, TransportMode::Radiance)?;
                Some(Draw {
                    direction: frame.to_world(sample.wi).as_dvec3(),
                    is_delta: sample.density == math::Density::Delta,
                    is_below: !wo.same_side(sample.wi),
                })
            };
            let pdf = |w: DVec3| f64::from(bsdf.pdf(wo, frame.to_local(w.as_vec3())).get());
            sampled(pdf, draw, density, &stem(), args.seed)
        }
        TestKind::Surface => {
            let from = -world.origin().as_vec3();
            sampled(|w| seen(&world, from, w), |numbers| towards(&world, from, numbers), true, &stem(), args.seed)
        }
        TestKind::Intersection { origin, direction, expected, threshold } => Ok(meets(&world, [origin, direction], expected, threshold)),
    }
}

/// A sampled direction.
struct Draw {
    direction: DVec3,
    is_delta: bool,
    is_below: bool,
}

/// Tests samples against their density, prints figures and writes two pictures.
fn sampled(
    pdf: impl Fn(DVec3) -> f64,
    draw: impl Fn(SampleNumbers) -> Option<Draw>,
    density: bool,
    stem: &str,
    seed: u64,
) -> Result<Verdict> {
    let pdf = Density::new(pdf);
    let count = PER_CELL * (ROWS * COLUMNS) as u64;
    let sequence = SamplerSpec { seed, ..SamplerSpec::default() }.build();
    let (mut drawn, mut valid) = (Histogram::new(count), 0u64);
    let (mut delta, mut below, mut wrong) = (false, false, pdf.is_wrong);
    for i in 0..count {
        let Some(draw) = draw(sequence.sample(UVec2::ZERO, i)) else { continue };
        delta |= draw.is_delta;
        below |= draw.is_below;
        wrong |= !draw.direction.is_finite();
        if draw.direction.is_finite() && !draw.is_below {
            drawn.add(draw.direction);
            valid += 1;
        }
    }
    pictures(&pdf, &drawn, stem)?;
    let share = valid as f64 / count as f64;
    let mut lines = vec![
        format!("integral of the pdf  {:.4}  (should be close to 1)", pdf.integral),
        format!("valid samples        {:.2} %  (should be close to 100 %)", 100.0 * share),
    ];
    let warnings = [
        (delta, "warning: some directions are mirrored and have no density"),
        (below, "warning: some directions lead below the surface"),
        (wrong, "warning: some directions or densities are not finite, or below 0"),
    ];
    lines.extend(warnings.into_iter().filter(|(found, _)| *found).map(|(_, warning)| warning.to_owned()));
    lines.push(format!("pictures             {stem}-pdf.png, {stem}-sampled.png"));
    let passes = (!density || INTEGRAL.contains(&pdf.integral)) && share >= VALID && !wrong;
    Ok(Verdict { lines, passes })
}

/// Samples a point of a random primitive, each with the same probability.
fn towards(world: &World, from: Vec3, mut numbers: SampleNumbers) -> Option<Draw> {
    let (choice, u) = numbers.get_3d(0);
    let mut index = ((f64::from(choice) * world.primitive_count() as f64) as u64).min(world.primitive_count().saturating_sub(1));
    for shape in world.shapes().iter() {
        let count = u64::from(shape.count());
        if index < count {
            let (point, _) = shape.sample_from(index as u32, from, u)?;
            return Some(Draw { direction: (point.p - from).try_normalize()?.as_dvec3(), is_delta: false, is_below: false });
        }
        index -= count;
    }
    None
}

/// Density of [`towards`].
fn seen(world: &World, from: Vec3, w: DVec3) -> f64 {
    let ray = Ray::new(from, w.as_vec3());
    let mut sum = 0.0;
    for shape in world.shapes().iter() {
        for i in 0..shape.count() {
            let density = |hit: ShapeHit| f64::from(shape.pdf_from(i, from, &shape.point(i, &ray, &hit)).get());
            sum += shape.intersect(i, &ray).map_or(0.0, density);
        }
    }
    sum / world.primitive_count().max(1) as f64
}

/// Tests whether a ray hits what it should, where it should.
fn meets(world: &World, [origin, direction]: [DVec3; 2], expected: Option<ExpectedHit>, threshold: f64) -> Verdict {
    let from = origin - world.origin();
    let ray = Ray::new(from.as_vec3(), direction.normalize().as_vec3());
    let found = world.intersect(&ray).map(|hit| {
        let point = world.surface(&ray, &hit).point;
        let p = point.p.as_dvec3() + world.origin();
        ExpectedHit { t: f64::from(hit.t) / direction.length(), p, gn: point.ng.as_dvec3(), sn: point.ns.as_dvec3() }
    });
    let lines = match (expected, found) {
        (None, Some(found)) => vec![format!("the ray should meet nothing, but does at t = {:?}", found.t)],
        (Some(_), None) => vec!["the ray should meet a surface, but meets none".to_owned()],
        (None, None) => vec![],
        (Some(expected), Some(found)) => {
            let off = |name: &str, a: DVec3, b: DVec3| {
                let is_off = (a - b).abs().max_element() > threshold;
                is_off.then(|| format!("{name} should be {a}, but is {b}"))
            };
            let t = ((expected.t - found.t).abs() > threshold).then(|| format!("t should be {:?}, but is {:?}", expected.t, found.t));
            let vectors = [
                off("p", expected.p, found.p),
                off("the geometric normal", expected.gn, found.gn),
                off("the shading normal", expected.sn, found.sn),
            ];
            t.into_iter().chain(vectors.into_iter().flatten()).collect()
        }
    };
    Verdict { passes: lines.is_empty(), lines }
}
