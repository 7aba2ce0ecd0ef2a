//! Intersection: closed meshes are closed, rays do not hit the surface that they leave, and small or distant shapes keep their digits.

use std::sync::{Arc, OnceLock};

use glam::{DVec3, Vec2, Vec3, Vec4};

use super::meshes::{baked, icosphere, mesh, round_mesh, shapes};
use super::{Failures, Random, Row, moving_meshes};
use crate::accel;
use crate::bsdf::{Bsdf, Diffuse};
use crate::light::ShadowTarget;
use crate::math::{Ray, Spectrum, SphericalTriangle, Transform};
use crate::primitive::Primitive;
use crate::rays::{self, RayCaster};
use crate::scene::Surface;
use crate::shape::curves::Basis;
use crate::shape::{
    BilinearPatch, Cone, Curves, Cylinder, Disk, Geometry, MeshData, PartialDisk, PartialSphere, Quad, Shape, Sphere, SurfacePoint,
    VertexColor, triangle,
};

/// The rows.
pub fn rows() -> Vec<Row> {
    vec![
        leaks(),
        adversarial(),
        moving_meshes::leaks(),
        crossings(),
        axis_parallel(),
        self_hits(),
        shadow_rays(),
        small_lamp(),
        gap(),
        offsets(),
        double_precision(),
        degenerate(),
        known_misses(),
        far_sphere(),
        tiny_targets(),
        cones(),
        triangles(),
        subdivided_solids(),
        displaced_spheres(),
        split_vertices(),
    ]
}

/// Rays at the default effort.
const RAYS: u64 = 10_000_000;

/// Positions of the sphere: at the origin, and where f32 is coarse. At the third other programs had leaks.
const CENTERS: [[f64; 3]; 4] = [[0.0; 3], [1e3; 3], [148_376.0, 1_234.0, -223_423.0], [1e6; 3]];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Aim {
    Anywhere,
    Vertex,
    Edge,
}

/// A closed mesh with its hierarchy, not moved to the origin as that of a scene would be.
struct Shell {
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    hierarchy: Box<dyn Primitive>,
    center: DVec3,
    radius: f64,
}

/// A shell that is made when it is first asked for.
type LateShell = Arc<OnceLock<Shell>>;

impl Shell {
    /// A sphere of 20·4^splits triangles.
    fn sphere(splits: u32, center: DVec3, radius: f64) -> Shell {
        let (points, triangles) = icosphere(splits);
        Shell::new(points.iter().map(|p| (center + *p * radius).as_vec3()).collect(), triangles, center, radius)
    }

    fn new(points: Vec<Vec3>, triangles: Vec<[u32; 3]>, center: DVec3, radius: f64) -> Shell {
        let hierarchy = accel::build(shapes(vec![baked(mesh(points.clone(), triangles.clone()))]));
        Shell { points, triangles, hierarchy, center, radius }
    }

    /// A vertex, the middle of an edge, or the centroid of a triangle.
    fn feature(&self, random: &mut Random) -> DVec3 {
        let [a, b, c] = self.triangles[random.below(self.triangles.len())].map(|v| self.points[v as usize].as_dvec3());
        match random.below(3) {
            0 => a,
            1 => a.midpoint(b),
            _ => (a + b + c) / 3.0,
        }
    }

    /// A ray from inside.
    fn ray(&self, aim: Aim, random: &mut Random) -> Ray {
        let origin = (self.center + random.in_cube() * (0.5 * self.radius)).as_vec3();
        let [a, b, _] = self.triangles[random.below(self.triangles.len())].map(|v| self.points[v as usize].as_dvec3());
        let target = match aim {
            Aim::Anywhere => origin.as_dvec3() + random.direction(),
            Aim::Vertex => a,
            Aim::Edge => a.lerp(b, random.unit()),
        };
        Ray::new(origin, (target - origin.as_dvec3()).normalize().as_vec3())
    }

    /// What is wrong with a ray that must hit the mesh.
    fn leak(&self, ray: &Ray) -> Option<String> {
        let leaks = self.hierarchy.intersect(ray).is_none() || !self.hierarchy.occluded(ray);
        leaks.then(|| format!("from {:?} towards {:?}", ray.origin, ray.direction))
    }
}

fn leaks() -> Row {
    let row = Row::new("G1", "rays out of a closed sphere of 5120 triangles", "none may leave");
    let row = row.peers("Embree's own test allows 2e-5; pbrt's is switched off; a plain Moeller-Trumbore test loses 26 % at vertices");
    CENTERS.iter().flat_map(|&c| [2.0, 1e3].map(|r| (DVec3::from(c), r))).fold(row, |row, (center, radius)| {
        let late = LateShell::default();
        [Aim::Anywhere, Aim::Vertex, Aim::Edge].into_iter().fold(row, |row, aim| {
            let (late, at) = (late.clone(), ["anywhere", "at vertices", "at edges"][aim as usize]);
            row.never(format!("radius {radius}, x {:e}, {at}", center.x), RAYS, move |tries| {
                let shell = late.get_or_init(|| Shell::sphere(4, center, radius));
                Failures::count(tries, |random| shell.leak(&shell.ray(aim, random)))
            })
        })
    })
}

/// Rays between features of a mesh: from a vertex, the middle of an edge or a centroid, moved into the mesh, exactly at another.
fn adversarial() -> Row {
    let row = Row::new("G1a", "rays from features of a mesh of 1.3 million triangles at other features", "none may leave");
    let places = [(0.0, 2f64.powi(-20)), (0.0, 1.0), (0.0, 2f64.powi(20)), (1e6, 1e3)];
    places.into_iter().fold(row, |row, (coordinate, radius)| {
        row.never(format!("radius {radius:.3e}, coordinates {coordinate:e}"), RAYS, move |tries| {
            let shell = Shell::sphere(8, DVec3::splat(coordinate), radius);
            Failures::count_judged(tries, |random| {
                let (from, to) = (shell.feature(random), shell.feature(random));
                // A little inside, so that the ray must leave through the far side.
                let origin = from.lerp(shell.center, random.pick(&[1e-3, 0.1, 0.5])).as_vec3();
                let ray = Ray::new(origin, (to - origin.as_dvec3()).try_normalize()?.as_vec3());
                Some(shell.leak(&ray))
            })
        })
    })
}

/// All hits along rays through a closed mesh, by the ray caster in double precision: from outside an even number, from inside an odd one.
fn crossings() -> Row {
    let row = Row::new("G2", "rays that cross a closed mesh an odd number of times from outside, even from inside", "none may");
    let row = row.peers("Embree and trimesh count edges twice or not at all (embree #188, trimesh #1180)");
    [(1.0, 0.0), (2f64.powi(-20), 0.0), (2f64.powi(20), 0.0), (1.0, 1e6)].into_iter().fold(row, |row, (radius, coordinate)| {
        row.never(format!("at features, radius {radius:.1e}, x {coordinate:e}"), RAYS / 10, move |tries| {
            let shell = Shell::sphere(4, DVec3::splat(coordinate), radius);
            let points = shell.points.iter().map(|p| p.as_dvec3()).collect();
            let caster = RayCaster::new(points, shell.triangles.clone()).expect("a mesh");
            Failures::count_judged(tries, |random| {
                let (near, far) = (shell.feature(random), shell.feature(random));
                let line = (far - near).try_normalize()?;
                let is_outside = random.below(2) == 0;
                let origin = if is_outside { near - line * (4.0 * radius) } else { shell.center + random.in_cube() * (0.5 * radius) };
                let ray = rays::Ray::new(origin, far - origin);
                let is_odd = caster.all(&ray).len() % 2 == 1;
                Some((is_odd == is_outside).then(|| format!("{ray:?}")))
            })
        })
    })
}

/// Rays in the planes of boxes, with components that are 0, −0 and tiny, find what they find without a hierarchy.
fn axis_parallel() -> Row {
    Row::new("G3", "rays along the faces of boxes, with components 0, -0 and 1e-40", "the hit without a hierarchy")
        .peers("bvh missed them (#149)")
        .never("grid of 512 axis-parallel squares", 1_000_000, |tries| {
            let mut squares: Vec<Box<dyn Shape>> = vec![];
            for k in 0..512 {
                let corner = Vec3::new((k % 8) as f32, (k / 8 % 8) as f32, (k / 64) as f32);
                let axes = [[Vec3::X, Vec3::Y], [Vec3::Y, Vec3::Z], [Vec3::Z, Vec3::X]][k % 3];
                let corners = vec![corner, corner + axes[0], corner + axes[0] + axes[1], corner + axes[1]];
                squares.push(baked(mesh(corners, vec![[0, 1, 2], [0, 2, 3]])));
            }
            let squares = shapes(squares);
            let hierarchy = accel::build(squares.clone());
            Failures::count(tries, |random| {
                let mut coordinate = || random.below(17) as f32 * 0.5;
                let origin = Vec3::new(coordinate(), coordinate(), coordinate());
                let axis = random.below(3);
                let tiny = [0.0f32, -0.0, 1e-40, -1e-40];
                let mut direction = [random.pick(&tiny), random.pick(&tiny), random.pick(&tiny)];
                direction[axis] = random.pick(&[1.0, -1.0]);
                let ray = Ray::new(origin, Vec3::from(direction));
                let all = squares.iter().flat_map(|square| (0..square.count()).filter_map(|i| square.intersect(i, &ray)));
                let nearest = all.map(|hit| hit.t).reduce(f32::min);
                let found = hierarchy.intersect(&ray).map(|hit| hit.t);
                (found != nearest || hierarchy.occluded(&ray) != nearest.is_some())
                    .then(|| format!("from {origin:?} towards {direction:?}: {found:?}, not {nearest:?}"))
            })
        })
}

/// Kind of a shape that is placed at random.
#[derive(Clone, Copy, Debug)]
enum Family {
    Triangle,
    Quad,
    Disk,
    Sphere,
    Ellipsoid,
    Cylinder,
    Cone,
    PartialSphere,
    PartialDisk,
    BilinearPatch,
    Tube,
    Ribbon,
}

const FAMILIES: [Family; 12] = [
    Family::Triangle,
    Family::Quad,
    Family::Disk,
    Family::Sphere,
    Family::Ellipsoid,
    Family::Cylinder,
    Family::Cone,
    Family::PartialSphere,
    Family::PartialDisk,
    Family::BilinearPatch,
    Family::Tube,
    Family::Ribbon,
];

/// Corners of a saddle that twists by about a right angle.
const SADDLE: [DVec3; 4] =
    [DVec3::new(-1.0, -1.0, 0.4), DVec3::new(1.0, -0.9, -0.5), DVec3::new(-0.8, 1.0, -0.4), DVec3::new(0.9, 1.0, 0.5)];

/// A straight curve that tapers: a tube, which is convex, or a ribbon, which is flat.
fn straight(is_ribbon: bool) -> Curves {
    let points = [[-1.0, 0.0, 0.0, 0.4], [1.0, 0.0, 0.0, 0.2]].map(Vec4::from).to_vec();
    Curves { basis: Basis::Linear, points, counts: vec![2], normals: if is_ribbon { vec![Vec3::Z; 2] } else { vec![] } }
}

impl Family {
    /// Whether a ray hits the shape at most once.
    fn is_flat(self) -> bool {
        matches!(self, Family::Triangle | Family::Quad | Family::Disk | Family::PartialDisk | Family::Ribbon)
    }

    /// The shape and its size. Coordinates are of the given size, or 10^U(−8, 8) each.
    fn place(self, coordinate: Option<f64>, random: &mut Random) -> (Box<dyn Shape>, f64) {
        let spread = random.decade(-1.0, 2.0);
        let mut any = || match coordinate {
            Some(c) => c + spread * random.range(-1.0, 1.0),
            None => random.decade(-8.0, 8.0) * if random.below(2) == 0 { 1.0 } else { -1.0 },
        };
        let corners = [(); 3].map(|_| DVec3::new(any(), any(), any()));
        let size = coordinate.map_or((corners[0] - corners[1]).length(), |_| spread);
        let stretch =
            if matches!(self, Family::Sphere | Family::Tube | Family::Ribbon) { DVec3::ONE } else { random.in_cube() * 0.9 + 1.0 };
        let place = Transform::scale(stretch * size).expect("not zero").then(&random.rotation());
        let place = place.then(&Transform::translate(corners[0]).expect("finite"));
        let shape = match self {
            Family::Triangle if triangle::normal(corners.map(|c| c.as_vec3())).is_none() => return self.place(coordinate, random),
            Family::Triangle => return (baked(mesh(corners.map(|c| c.as_vec3()).to_vec(), vec![[0, 1, 2]])), size),
            Family::Quad => Quad { size: [1.0, 2.0] }.bake(&place),
            Family::Disk => Disk { radius: 1.0 }.bake(&place),
            Family::Sphere | Family::Ellipsoid => Sphere { radius: 1.0 }.bake(&place),
            Family::Cylinder => Cylinder { radius: 1.0, z: [-0.7, 1.0], phi_max: 250.0 }.bake(&place),
            Family::Cone => Cone { radius: 1.0, height: 1.5, phi_max: 360.0 }.bake(&place),
            Family::PartialSphere => PartialSphere { radius: 1.0, z: [-1.0, 0.4], phi_max: 300.0 }.bake(&place),
            Family::PartialDisk => PartialDisk { radius: 1.0, inner_radius: 0.4, phi_max: 200.0 }.bake(&place),
            Family::BilinearPatch => BilinearPatch { corners: SADDLE }.bake(&place),
            Family::Tube | Family::Ribbon => straight(matches!(self, Family::Ribbon)).bake(&place),
        };
        // Far out, a small shape or all corners may round to a line. Another shape is then tried.
        match shape {
            Ok(shape) => (shape, size),
            Err(_) => self.place(coordinate, random),
        }
    }
}

fn surface(point: SurfacePoint) -> Surface<'static> {
    Surface::new(point, Bsdf::Diffuse(Diffuse { albedo: Spectrum::ONE }), None)
}

/// A point on the shape, sampled or hit by a ray.
fn point(shape: &dyn Shape, random: &mut Random) -> SurfacePoint {
    let (point, _) = shape.sample_area(0, random.square());
    if random.below(2) == 0 {
        return point;
    }
    let distance = f64::from(shape.bounds(0).radius()) * random.decade(-1.0, 1.0);
    let origin = point.p + (random.direction() * distance).as_vec3();
    let Some(direction) = (point.p - origin).try_normalize() else { return point };
    let ray = Ray::new(origin, direction);
    shape.intersect(0, &ray).map_or(point, |hit| shape.point(0, &ray, &hit))
}

/// Whether the spawned ray hits the surface at its start. A ray from the inside of a curved surface correctly hits its far side, which it
/// leaves and does not enter; and a ray from either side of a saddle may meet another part of it, on the side where the ray is.
fn is_false_hit(family: Family, shape: &dyn Shape, point: &SurfacePoint, ray: &Ray) -> bool {
    let Some(hit) = shape.intersect(0, ray) else { return false };
    let inwards = point.ng.dot(ray.direction) < 0.0;
    let enters = shape.point(0, ray, &hit).ng.dot(ray.direction) < 0.0;
    match family {
        Family::BilinearPatch => inwards == enters || hit.t <= point.offset,
        _ => family.is_flat() || !inwards || (enters && hit.t <= point.offset),
    }
}

/// Whether a ray to a point of the lamp, on the side that it faces, hits the lamp before. A part of a saddle correctly hides another part if
/// the ray comes out of it: it then meets the other part from the side that it is sent to.
fn is_hidden(family: Family, light: &dyn Shape, ray: &Ray) -> bool {
    let Some(hit) = light.intersect(0, ray) else { return false };
    !matches!(family, Family::BilinearPatch) || light.point(0, ray, &hit).ng.dot(ray.direction) < 0.0
}

/// Coordinates of shapes, and their names. Without coordinates they are 10^U(−8, 8).
const PLACES: [(Option<f64>, &str); 4] =
    [(None, "coordinates 1e-8 to 1e8"), (Some(0.0), "at 0"), (Some(1e3), "at 1e3"), (Some(1e6), "at 1e6")];

fn self_hits() -> Row {
    const RAYS_OF_EACH: u64 = 1000;
    let row = Row::new("G4", "rays that leave a surface and hit it at once", "none may").peers("a fixed offset of 1e-4: 50 % at 1e6");
    FAMILIES.iter().flat_map(|&family| PLACES.map(|place| (family, place))).fold(row, |row, (family, (place, name))| {
        row.never(format!("{family:?}, {name}"), RAYS, move |tries| {
            let count = |random: &mut Random| {
                let (shape, size) = family.place(place, random);
                let mut failures = Failures::default();
                for _ in 0..RAYS_OF_EACH {
                    let point = point(&*shape, random);
                    // A shape thinner than its error bound has no inside to start from, and so has a cone at its apex, where v = 1.
                    let share = if matches!(family, Family::Cone) { 1.0 - f64::from(point.uv.y) } else { 1.0 };
                    if !family.is_flat() && 0.1 * size * share < 4.0 * f64::from(point.offset) {
                        continue;
                    }
                    let ray = surface(point).spawn(random.direction().as_vec3(), 0.0);
                    failures.record(is_false_hit(family, &*shape, &point, &ray).then(|| format!("{point:?}, {:?}", ray.direction)));
                }
                failures
            };
            Failures::sum(tries.div_ceil(RAYS_OF_EACH), count)
        })
    })
}

/// A sampled point of a lamp is visible from every point without an occluder between: neither end shadows itself.
fn shadow_rays() -> Row {
    const RAYS_OF_EACH: u64 = 1000;
    let row = Row::new("G4a", "shadow rays between two shapes that hit one of them", "none may");
    FAMILIES.iter().flat_map(|&family| PLACES.map(|place| (family, place))).fold(row, |row, (family, (place, name))| {
        row.never(format!("to {family:?}, {name}"), RAYS, move |tries| {
            let count = |random: &mut Random| {
                let ((light, _), (lit, _)) = (family.place(place, random), Family::Triangle.place(place, random));
                let mut failures = Failures::default();
                for _ in 0..RAYS_OF_EACH {
                    let from = point(&*lit, random);
                    let Some((target, _)) = light.sample_from(0, from.p, random.square()) else { continue };
                    let Some(wi) = (target.p - from.p).try_normalize() else { continue };
                    // The far side of a curved lamp is correctly hidden by its near side.
                    if !family.is_flat() && target.ng.dot(-wi) <= 0.0 {
                        continue;
                    }
                    // If one end lies in the plane of the other, within the error bounds, its side is unknown.
                    let line = target.p.as_dvec3() - from.p.as_dvec3();
                    let apart = line.dot(from.ng.as_dvec3()).abs().min(line.dot(target.ng.as_dvec3()).abs());
                    let stray = 4.0 * f32::EPSILON * line.length() as f32;
                    if apart <= 2.0 * f64::from(from.offset + target.offset + stray) {
                        continue;
                    }
                    let ray = surface(from).shadow_ray(wi, &ShadowTarget::Surface(target), 0.0);
                    let is_hit = lit.intersect(0, &ray).is_some() || is_hidden(family, &*light, &ray);
                    failures.record(is_hit.then(|| format!("{from:?} to {target:?}")));
                }
                failures
            };
            Failures::sum(tries.div_ceil(RAYS_OF_EACH), count)
        })
    })
}

/// A small lamp at the centre of the scene has a small offset. From far away at a grazing angle, the rounding of the direction alone could
/// carry the shadow ray through it.
fn small_lamp() -> Row {
    Row::new("G4b", "shadow rays that hit the small lamp that they end at, far away and grazing", "none may").never(
        "1 to 10^4 times its size away, cosines from 1e-3",
        2 * RAYS,
        |tries| {
            Failures::count(tries, |random| {
                let place = random.rotation();
                let light = Quad { size: [2.0, 2.0] }.bake(&place).expect("an area");
                let (target, _) = light.sample_area(0, random.square());
                let (distance, cosine) = (random.decade(0.0, 4.0), random.decade(-3.0, 0.0));
                let across = random.direction().with_z(0.0).normalize() * (distance * (1.0 - cosine * cosine).sqrt());
                let p = place.point(across.with_z(distance * cosine)).as_vec3();
                let wi = (target.p - p).normalize();
                let from = SurfacePoint { p, offset: 0.0, ng: wi, ns: wi, uv: target.uv, color: VertexColor::WHITE };
                let ray = surface(from).shadow_ray(wi, &ShadowTarget::Surface(target), 0.0);
                light.intersect(0, &ray).map(|_| format!("from {p:?} to {:?}", target.p))
            })
        },
    )
}

fn gap() -> Row {
    Row::new("G5", "rays through a gap of 4e-5 between a unit sphere and a shell", "in turn, and no surface twice")
        .peers("Mitsuba before 2026-09 skips the gap (#1871)")
        .never("from outside inwards, and back", 2_000_000, |tries| {
            let gap = 4e-5;
            let [inner, outer] = [1.0, 1.0 + gap].map(|radius| Sphere { radius }.bake(&Transform::IDENTITY).expect("a sphere"));
            Failures::count(tries, |random| {
                let from = (random.direction() * random.range(2.0, 5.0)).as_vec3();
                let to = (random.direction() * random.range(0.0, 0.99)).as_vec3();
                let ray = Ray::new(from, (to - from).normalize());
                let holds = || {
                    let first = outer.intersect(0, &ray)?;
                    let entered = surface(outer.point(0, &ray, &first)).spawn(ray.direction, 0.0);
                    let (second, far) = (inner.intersect(0, &entered)?, outer.intersect(0, &entered)?);
                    let back = surface(inner.point(0, &entered, &second)).spawn(-ray.direction, 0.0);
                    let leaves = outer.intersect(0, &back)?;
                    let clear = inner.intersect(0, &back).is_none() && leaves.t < 1.0;
                    (second.t < far.t && f64::from(second.t) > 0.5 * gap && clear).then_some(())
                };
                holds().is_none().then(|| format!("from {from:?} towards {:?}", ray.direction))
            })
        })
}

fn offsets() -> Row {
    let row = Row::new("G6", "greatest distance of a new ray's start from the surface", "the bound that avoids self-hits");
    let row = row.peers("Waechter and Binder: 1.5e-5, .031, 32");
    [(0.0, 1e-5, "1"), (1e3, 5e-3, "1e3"), (1e6, 5.0, "1e6")]
        .into_iter()
        .fold(row, |row, (coordinate, bound, name)| {
            // The answer is to be at most the bound: between 0 and it.
            row.number(format!("coordinates of {name}: half of {bound:e}"), 0.5 * bound, 0.5 * bound, move || {
                let moved = |seed| {
                    let mut random = Random::new(seed);
                    let corners = [(); 3].map(|_| (DVec3::splat(coordinate) + random.in_cube()).as_vec3());
                    let (point, _) = baked(mesh(corners.to_vec(), vec![[0, 1, 2]])).sample_area(0, random.square());
                    (surface(point).spawn(point.ng, 0.0).origin.as_dvec3() - point.p.as_dvec3()).length()
                };
                (0..2000).map(moved).fold(0.0, f64::max)
            })
        })
        // A floor through the origin has no rounding error: its rays start on it, and do not hit it.
        .never("a floor through the origin: none", 2_000_000, |tries| {
            let floor = Quad { size: [2.0, 2.0] }.bake(&Transform::IDENTITY).expect("an area");
            Failures::count(tries, |random| {
                let (point, _) = floor.sample_area(0, random.square());
                let ray = surface(point).spawn(random.direction().as_vec3(), 0.0);
                let holds = point.offset == 0.0 && ray.origin == Vec3::new(point.p.x, point.p.y, 0.0) && floor.intersect(0, &ray).is_none();
                (!holds).then(|| format!("{point:?} towards {:?}", ray.direction))
            })
        })
}

/// The same triangle test in f64 with another formula: the intersection with the plane, and areas in it.
fn double_precision() -> Row {
    let row = Row::new("G7", "distance, place and normal of hits against f64", "16 ulp of the scene's size");
    let row = row.peers("Embree's test: 16 ulp, 256 rays");
    [1.0, 1e3, 1e6].into_iter().fold(row, |row, size| {
        row.never(format!("coordinates up to {size:e}"), RAYS, move |tries| {
            Failures::count_judged(tries, |random| {
                let corners = [(); 3].map(|()| (random.in_cube() * size).as_vec3());
                let wide = corners.map(Vec3::as_dvec3);
                let origin = (random.in_cube() * size).as_vec3();
                let (u, v) = (random.unit(), random.unit());
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                let target = wide[0] * (1.0 - u - v) + wide[1] * u + wide[2] * v;
                let direction = (target - origin.as_dvec3()).normalize().as_vec3();
                let (o, d) = (origin.as_dvec3(), direction.as_dvec3());
                let normal = (wide[1] - wide[0]).cross(wide[2] - wide[0]);
                let slant = normal.normalize().dot(d).abs();
                // Nearly in the plane of the triangle the exact answer itself is ill-conditioned.
                if slant < 1e-2 || normal.length() < 1e-2 * size * size {
                    return None;
                }
                let t = (wide[0] - o).dot(normal) / d.dot(normal);
                let p = o + d * t;
                let share = |a: usize, b: usize| (wide[a] - p).cross(wide[b] - p).dot(normal) / normal.length_squared();
                let (u, v) = (share(2, 0), share(0, 1));
                // Rays at the rim may miss.
                if u.min(v).min(1.0 - u - v) < 1e-6 {
                    return None;
                }
                let ray = Ray::new(origin, direction);
                let ulp = 2f64.powi(-24) * 2.0 * size;
                let holds = triangle::intersect(&ray, f32::INFINITY, corners).is_some_and(|hit| {
                    let point = baked(mesh(corners.to_vec(), vec![[0, 1, 2]])).point(0, &ray, &hit);
                    (f64::from(hit.t) - t).abs() <= 16.0 * ulp
                        && (f64::from(hit.uv.x) - u).abs().max((f64::from(hit.uv.y) - v).abs()) <= 16.0 * 2f64.powi(-24)
                        && (point.p.as_dvec3() - p).length() <= 16.0 * ulp
                        && (point.ng.as_dvec3() - normal.normalize()).length() <= 16.0 * 2f64.powi(-24)
                });
                Some((!holds).then(|| format!("{corners:?} from {origin:?} towards {direction:?}")))
            })
        })
    })
}

fn degenerate() -> Row {
    Row::new("G8", "triangles without area are never hit", "exact").peers("a degenerate light gave NaN (openmoonray #251)").never(
        "repeated or collinear corners",
        10_000_000,
        |tries| {
            Failures::count(tries, |random| {
                // Corners on a grid and a power of two: the third lies exactly on the line.
                let mut corner = || (random.in_cube().as_vec3() * 64.0).round() / 64.0;
                let (a, b) = (corner(), corner());
                let corners = [a, b, a + (b - a) * random.pick(&[0.0, 0.5, 1.0, 2.0, 4.0])];
                let target = a.lerp(b, random.unit() as f32 * 2.0);
                let origin = (random.in_cube() * 3.0).as_vec3();
                let ray = Ray::new(origin, (target - origin).normalize());
                triangle::intersect(&ray, f32::INFINITY, corners).map(|hit| format!("{corners:?} at {}", hit.t))
            })
        },
    )
}

fn known_misses() -> Row {
    // A thin triangle, nearly parallel to the ray, that other programs hit at twenty times its distance.
    Row::new("G9", "a thin triangle seen along its plane is not hit beyond its ends", "the size of the triangle")
        .peers("Embree: a hit at 12291, not below 600 (#387)")
        .never("slivers of 1 : 1000 to 1 : 10^6", 1_000_000, |tries| {
            Failures::count(tries, |random| {
                let (axis, thin) = (random.direction(), random.decade(-6.0, -3.0));
                let across = axis.any_orthonormal_vector() * thin;
                let middle = random.in_cube() * 100.0;
                let corners = [middle - axis, middle + axis, middle + across].map(|p| p.as_vec3());
                let origin = (middle + axis * random.range(2.0, 10.0) + across * random.range(-2.0, 2.0)).as_vec3();
                let direction = (random.in_cube() * thin - axis).normalize().as_vec3();
                let hit = triangle::intersect(&Ray::new(origin, direction), f32::INFINITY, corners)?;
                let p = origin.as_dvec3() + direction.as_dvec3() * f64::from(hit.t);
                // Coordinates of 100 are rounded by 4·10⁻⁶.
                let far = (p - middle).dot(axis).abs() > 1.0 + 1e-4;
                far.then(|| format!("{corners:?} from {origin:?} towards {direction:?}: {p:?}"))
            })
        })
}

fn far_sphere() -> Row {
    let hit = |y: f32| {
        let sphere = Sphere { radius: 0.1 }.bake(&Transform::IDENTITY).expect("a sphere");
        sphere.intersect(0, &Ray::new(Vec3::new(-1e7, y, 0.0), Vec3::X)).map_or(f64::INFINITY, |hit| hit.t.into())
    };
    Row::new("G10", "distance of a sphere of radius .1 from 10^7 away", "the spacing of f32 there")
        .peers("b² - 4ac is 0 in f32 and in f64: missed")
        .number("ray at .095 from its centre", 1e7 - 0.0312250, 1.0, move || hit(0.095))
        .number("at .1001 it misses: 1/distance", 0.0, 0.0, move || 1.0 / hit(0.1001))
}

/// Rays along an axis at a triangle of 10⁻⁷ to 10⁻³ of the distance, among others.
fn tiny_targets() -> Row {
    Row::new("G11", "tiny distant triangles that rays along an axis, or of any length, miss", "none may")
        .peers("obvhs misses with a direction of (0, 0, 1e-9)")
        .never("size 1e-7 to 1e-3 of the distance", 1_000_000, |tries| {
            const TARGETS: usize = 64;
            let count = |random: &mut Random| {
                let axis = random.below(3);
                let targets: Vec<(f64, f64, DVec3)> = (0..TARGETS)
                    .map(|k| {
                        let (distance, size) = (random.decade(-2.0, 4.0), random.decade(-7.0, -3.0));
                        // Each on a line of its own, so that none hides another.
                        (distance, size * distance, DVec3::new(k as f64 * 0.5, k as f64 * 0.25, 0.0))
                    })
                    .collect();
                let turned = |p: DVec3| {
                    let mut p = p.to_array();
                    p.rotate_right(axis);
                    Vec3::new(p[0] as f32, p[1] as f32, p[2] as f32)
                };
                let corners = |&(distance, size, line): &(f64, f64, DVec3)| {
                    let middle = line.with_z(-distance);
                    [DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, -1.0, 0.0), DVec3::new(0.0, 1.0, 0.0)].map(|c| turned(middle + c * size))
                };
                let all: Vec<[Vec3; 3]> = targets.iter().map(corners).collect();
                let mut failures = Failures::default();
                // Far from the axis a tiny triangle may round to nothing: such targets are left out.
                let kept: Vec<(usize, [Vec3; 3])> = all.into_iter().enumerate().filter(|(_, c)| triangle::normal(*c).is_some()).collect();
                let triangles = kept.iter().map(|(_, corners)| baked(mesh(corners.to_vec(), vec![[0, 1, 2]]))).collect();
                let hierarchy = accel::build(shapes(triangles));
                for (k, corners) in &kept {
                    let length = random.pick(&[1.0, 1e-3, 1e3]);
                    let ray = Ray::new(turned(targets[*k].2), turned(-DVec3::Z * length));
                    let inside = triangle::intersect(&ray, f32::INFINITY, *corners).is_some();
                    let found = hierarchy.intersect(&ray).is_some() && hierarchy.occluded(&ray);
                    failures.record((inside && !found).then(|| format!("{corners:?} from {:?}", ray.origin)));
                }
                failures
            };
            Failures::sum(tries.div_ceil(TARGETS as u64), count)
        })
}

fn cones() -> Row {
    let row =
        Row::new("G12", "solid angle of a small sphere, from its density", "three roundings").peers("2 pi (1 - cos) in f32: 0 at 1e-4");
    [(1e-2, 3.14167e-4), (1e-3, 3.1415934e-6), (1e-4, 3.1415927e-8), (1e-5, 3.1415927e-10)].into_iter().fold(row, |row, (sine, about)| {
        // 2π s²/(1 + c), which the table's figure states to six digits or more.
        let exact = std::f64::consts::TAU * sine * sine / (1.0 + f64::sqrt(1.0 - sine * sine));
        debug_assert!((exact / about - 1.0).abs() < 1e-6);
        row.number(format!("sine {sine:e}"), exact, 3e-7 * exact, move || {
            let sphere = Sphere { radius: sine }.bake(&Transform::IDENTITY).expect("a sphere");
            sphere.sample_from(0, Vec3::Z, Vec2::splat(0.3)).map_or(f64::NAN, |(_, pdf)| 1.0 / f64::from(pdf.get()))
        })
    })
}

fn triangles() -> Row {
    let row =
        Row::new("G13", "solid angle of a triangle", "roundings of f32").peers("Girard's formula in f32: -52 % at 1e-3, negative at 1e-4");
    let octant = || SphericalTriangle::new([Vec3::X, Vec3::Y, Vec3::Z]).map_or(f64::NAN, |seen| seen.solid_angle().into());
    let row = row.number("eighth of the sphere", std::f64::consts::FRAC_PI_2, 2e-6, octant);
    let table = [(1.0, 0.3398369094541), (0.1, 4.975144893e-3), (0.01, 4.9997500146e-5), (1e-3, 4.9999975e-7), (1e-4, 4.999999975e-9)];
    table.into_iter().fold(row, |row, (e, exact)| {
        row.number(format!("legs of {e} at distance 1"), exact, 2e-6 * exact, move || {
            let corners = [Vec3::Z, Vec3::new(e, 0.0, 1.0), Vec3::new(0.0, e, 1.0)];
            SphericalTriangle::new(corners).map_or(f64::NAN, |seen| seen.solid_angle().into())
        })
    })
}

/// On the limit surface of Loop subdivision with Warren's weights a corner lies at half of itself and half of the mean of its neighbours, or at
/// 2/5 and 3/5 with three neighbours. In these solids around the origin that mean is the corner times −1/3, 0 and 1/√5.
fn subdivided_solids() -> Row {
    let tetrahedron = || {
        let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]].map(|c| DVec3::from(c).normalize());
        (corners.to_vec(), vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    };
    let octahedron = || {
        let corners = vec![DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
        (corners, vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]])
    };
    let icosahedron = || icosphere(0);
    let row = Row::new("G14", "distance of the corners of a subdivided solid from its centre", "roundings of f32");
    type Solid = fn() -> (Vec<DVec3>, Vec<[u32; 3]>);
    let solids: [(&str, Solid, f64); 3] = [
        ("tetrahedron", tetrahedron, 0.4 - 0.6 / 3.0),
        ("octahedron", octahedron, 0.5),
        ("icosahedron", icosahedron, 0.5 + 0.5 / 5f64.sqrt()),
    ];
    let cases = solids.into_iter().flat_map(|solid| [1, 2, 4].map(|levels| (solid, levels)));
    cases.fold(row, |row, ((name, solid, exact), levels)| {
        row.number(format!("{name}, {levels} levels"), exact, 2e-7, move || {
            let (points, triangles) = solid();
            let limit = mesh(points.iter().map(|p| p.as_vec3()).collect(), triangles).subdivided(levels).ok();
            // The corners stay the first vertices.
            let distances = limit.map(|limit| limit.positions[..points.len()].iter().map(|p| f64::from(p.length())).collect::<Vec<_>>());
            distances.unwrap_or_default().into_iter().max_by(|a, b| (a - exact).abs().total_cmp(&(b - exact).abs())).unwrap_or(f64::NAN)
        })
    })
}

/// A vertex p of a unit sphere whose normals are exact, moved by the height h, lies at the distance 1 + h from the centre.
fn displaced_spheres() -> Row {
    let row = Row::new("G15", "distance of the vertices of a displaced sphere from its centre, over 1 + height", "roundings of f32");
    type Height = fn(Vec3) -> f64;
    let heights: [(&str, Height); 3] = [
        ("outwards by a fourth", |_| 0.25),
        ("inwards by a half", |_| -0.5),
        ("by a ramp", |p| 0.3 * f64::from(p.x) - 0.2 * f64::from(p.z)),
    ];
    heights.into_iter().fold(row, |row, (name, height)| {
        // Vertices of the unit sphere are off by up to 1.2e-7, which is twice as much of half the radius; the rest is the last rounding.
        row.number(name, 1.0, 3e-7, move || {
            let sphere = round_sphere(5);
            let heights: Vec<f64> = sphere.positions.iter().map(|p| height(*p)).collect();
            let moved = sphere.displaced(&heights);
            let ratios = moved.positions.iter().zip(&heights).map(|(p, h)| p.as_dvec3().length() / (1.0 + h));
            ratios.max_by(|a, b| (a - 1.0).abs().total_cmp(&(b - 1.0).abs())).unwrap_or(f64::NAN)
        })
    })
}

/// A sphere whose triangles share no vertices. Vertices at the same point have different heights, as those at the seam of a texture have.
fn split_vertices() -> Row {
    let row = Row::new("G15a", "rays out of a displaced sphere with several vertices at each point", "none may leave");
    [0.1, 0.5].into_iter().fold(row, |row, greatest| {
        row.never(format!("heights up to {greatest}"), RAYS / 10, move |tries| {
            let (sphere, mut heights) = (round_sphere(4), Random::new(15));
            let heights: Vec<f64> = sphere.positions.iter().map(|_| greatest * heights.unit()).collect();
            let moved = sphere.displaced(&heights);
            let shell = Shell::new(moved.positions, moved.triangles, DVec3::ZERO, 1.0);
            Failures::count(tries, |random| shell.leak(&shell.ray(random.pick(&[Aim::Anywhere, Aim::Vertex, Aim::Edge]), random)))
        })
    })
}

/// A unit sphere with exact normals. Each triangle has vertices of its own.
fn round_sphere(levels: u32) -> MeshData {
    let sphere = round_mesh(levels);
    MeshData { normals: sphere.positions.clone(), ..sphere }
}
