//! The world compared with an oracle: a test of every primitive, in f64, by textbook formulas that share no code with `src/`.

use std::sync::Arc;

use glam::{DVec3, UVec2, Vec2, Vec3};
use pt::bsdf::Material;
use pt::camera::{Camera, Perspective, Pose};
use pt::effects::Effects;
use pt::film::{FilmSpec, Image, MomentFilm};
use pt::light::{Emitter, Lights};
use pt::math::{Ray, RayDifferential, Rgb, SurfaceDifferential, Transform};
use pt::medium::{Boundaries, Inside, InterfaceCrossing, Media};
use pt::primitive::Hit;
use pt::render::{Settings, Silent, render};
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::{Scene, Surface};
use pt::shape::{FacetUv, Quad, Sphere, SurfacePoint};
use pt::world::World;

/// Scene that finds hits by brute force.
struct Oracle {
    world: Arc<World>,
    triangles: Vec<Triangle>,
    spheres: Vec<Ball>,
}

struct Triangle {
    shape: u32,
    primitive: u32,
    corners: [DVec3; 3],
    fold: FacetUv,
}

struct Ball {
    shape: u32,
    center: DVec3,
    radius: f64,
}

impl Oracle {
    /// - `balls`: number of the shape, centre and radius, as they were described
    fn new(world: Arc<World>, balls: &[(u32, DVec3, f64)]) -> Oracle {
        let mut triangles = vec![];
        for (shape, family) in world.shapes().iter().enumerate() {
            for primitive in 0..family.count() {
                for (corners, fold) in family.facet(primitive).triangles() {
                    triangles.push(Triangle { shape: shape as u32, primitive, corners: corners.map(|c| c.as_dvec3()), fold });
                }
            }
        }
        let spheres = balls.iter().map(|&(shape, center, radius)| Ball { shape, center: center - world.origin(), radius }).collect();
        Oracle { world, triangles, spheres }
    }

    /// All hits in front of the ray; the weights of a triangle's corners tell how far from an edge each is.
    fn hits(&self, ray: &Ray) -> Vec<(f64, Hit, f64)> {
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let flat = self.triangles.iter().filter_map(|t| {
            let (time, [_, b, c], margin) = moeller_trumbore(o, d, t.corners)?;
            let uv = t.fold.uv(Vec2::new(b as f32, c as f32));
            Some((time, Hit { instance: None, shape: t.shape, primitive: t.primitive, uv, t: time as f32 }, margin))
        });
        let round = self.spheres.iter().filter_map(|ball| {
            let (time, margin) = quadratic(o - ball.center, d, ball.radius)?;
            Some((time, Hit { instance: None, shape: ball.shape, primitive: 0, uv: Vec2::ZERO, t: time as f32 }, margin))
        });
        flat.chain(round).filter(|(time, ..)| *time < ray.t_max as f64).collect()
    }
}

/// Möller and Trumbore (1997): t, weights, and the smallest weight.
fn moeller_trumbore(o: DVec3, d: DVec3, [a, b, c]: [DVec3; 3]) -> Option<(f64, [f64; 3], f64)> {
    let (e1, e2) = (b - a, c - a);
    let p = d.cross(e2);
    let det = e1.dot(p);
    let s = o - a;
    let (u, q) = (s.dot(p) / det, s.cross(e1));
    let v = d.dot(q) / det;
    let t = e2.dot(q) / det;
    let w = 1.0 - u - v;
    let margin = u.min(v).min(w);
    (margin >= 0.0 && t > 0.0).then_some((t, [w, u, v], margin))
}

/// Intersection by the quadratic formula: t, and half the chord relative to the radius, which tells how far inside the silhouette the ray
/// passes.
fn quadratic(o: DVec3, d: DVec3, r: f64) -> Option<(f64, f64)> {
    let (a, half_b, c) = (d.dot(d), o.dot(d), o.dot(o) - r * r);
    let discriminant = half_b * half_b - a * c;
    let root = (discriminant >= 0.0).then(|| discriminant.sqrt())?;
    let t = [(-half_b - root) / a, (-half_b + root) / a].into_iter().find(|&t| t > 0.0)?;
    Some((t, root / r))
}

impl Scene for Oracle {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.hits(ray).into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, hit, _)| hit)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        !self.hits(ray).is_empty()
    }

    fn surface(&self, ray: &Ray, hit: &Hit) -> Surface<'_> {
        self.world.surface(ray, hit)
    }

    fn surface_with_footprint(&self, ray: &Ray, hit: &Hit, differential: &RayDifferential) -> (Surface<'_>, Option<SurfaceDifferential>) {
        self.world.surface_with_footprint(ray, hit, differential)
    }

    fn surface_seen_from(&self, ray: &Ray, hit: &Hit, wo: Vec3) -> Surface<'_> {
        self.world.surface_seen_from(ray, hit, wo)
    }

    fn lights(&self) -> &Lights {
        self.world.lights()
    }

    fn camera(&self) -> &Camera {
        self.world.camera()
    }

    fn media(&self) -> Option<&Media> {
        self.world.media()
    }

    fn boundaries(&self, hit: &Hit, point: &SurfacePoint) -> Boundaries {
        self.world.boundaries(hit, point)
    }

    fn bodies_around(&self, p: Vec3) -> Inside {
        self.world.bodies_around(p)
    }

    fn interface(&self, ray: &Ray) -> Option<InterfaceCrossing> {
        self.world.interface(ray)
    }

    fn effects(&self) -> Effects {
        self.world.effects()
    }

    fn origin(&self) -> DVec3 {
        self.world.origin()
    }
}

/// A room with a lamp, a glass ball and a matte one.
fn room() -> (Arc<World>, Oracle) {
    let pose = Transform::look_at(DVec3::new(0.1, 1.2, 4.0), DVec3::Y, DVec3::Y).expect("a pose");
    let mut world = World::builder(Camera::Perspective(Perspective::new(Pose::new(&pose), 40.0, 0.0, 1.0)));
    let white = world.material(Material::diffuse(Rgb::new(0.7, 0.6, 0.5)));
    let glass = world.material(Material::glass(1.5));
    let at = |x, y, z| Transform::translate(DVec3::new(x, y, z)).expect("finite");
    let turned = |axis, degrees, to: Transform| Transform::rotate(axis, degrees).expect("an axis").then(&to);
    let wall = Quad { size: [2.0, 2.0] };
    world.shape(wall, at(0.0, 1.0, -1.0), white, None);
    world.shape(wall, turned(DVec3::X, -90.0, at(0.0, 0.0, 0.0)), white, None);
    world.shape(wall, turned(DVec3::Y, 73.0, at(-1.0, 1.0, 0.0)), white, None);
    let lamp = Some(Emitter::new(Rgb::new(5.0, 6.0, 7.0)));
    world.shape(Quad { size: [1.0, 0.8] }, turned(DVec3::X, 90.0, at(0.2, 2.0, 0.1)), white, lamp);
    let balls = [(DVec3::new(-0.3, 0.4, 0.1), 0.35), (DVec3::new(0.5, 0.3, 0.2), 0.3)];
    for (&(center, radius), material) in balls.iter().zip([glass, white]) {
        world.shape(Sphere { radius }, Transform::translate(center).expect("finite"), material, None);
    }
    let world = Arc::new(world.build().expect("a valid scene"));
    let described: Vec<(u32, DVec3, f64)> = (4..).zip(balls).map(|(shape, (center, radius))| (shape, center, radius)).collect();
    (world.clone(), Oracle::new(world, &described))
}

/// Rays between random points in the room.
fn rays(count: u64) -> impl Iterator<Item = Ray> {
    let sequence = SamplerSpec { kind: Kind::Independent, seed: 3, spp: 1, ..SamplerSpec::default() }.build();
    (0..count).map(move |index| {
        let mut numbers = sequence.sample(UVec2::ZERO, index);
        let mut point = |d| Vec3::new(numbers.get_1d(d), numbers.get_1d(d + 1), numbers.get_1d(d + 2)) * 2.4 - 1.2;
        let (from, to) = (point(0), point(3));
        Ray::new(from, (to - from).normalize())
    })
}

/// Hits agree except within 10⁻⁵ of an edge or silhouette, where rounding of the corners to f32 may decide.
#[test]
fn the_world_hits_what_brute_force_hits() {
    let (world, oracle) = room();
    let mut met = 0;
    for ray in rays(200_000) {
        let hits = oracle.hits(&ray);
        if hits.iter().any(|(_, _, margin)| *margin < 1e-5) {
            continue;
        }
        let truth = hits.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        let found = world.intersect(&ray);
        assert_eq!(found.map(|h| (h.shape, h.primitive)), truth.map(|(_, h, _)| (h.shape, h.primitive)), "{ray:?}");
        if let (Some(found), Some((t, ..))) = (found, truth) {
            // The balls' centres are rounded once, 2⁻²⁴ of coordinates below 2; at grazing that is magnified by 1/√(2·margin).
            assert!((found.t as f64 - t).abs() <= 2e-6, "{} {t}", found.t);
            met += 1;
        }
        assert_eq!(world.occluded(&ray), truth.is_some());
    }
    assert!(met > 100_000, "only {met} rays met anything");
}

/// The paths are the same up to rounding, except for the few that pass an edge on the other side.
#[test]
fn pictures_by_brute_force_are_the_same() {
    for entry in pt::integrators::ALL {
        let integrator = pt::integrator::choose(&[pt::integrators::ALL], None, Some(entry.name), "").expect("defaults").1;
        let picture = |scene: Arc<dyn Scene>| -> Image {
            let mut film = MomentFilm::new(FilmSpec::new(24, 24));
            let settings = Settings::new(SamplerSpec { kind: Kind::Independent, seed: 1, spp: 64, ..SamplerSpec::default() });
            let report = render(scene, &*integrator, &mut film, &settings, &Silent);
            assert_eq!(report.invalid, 0);
            film.image()
        };
        let (world, oracle) = room();
        let (a, b) = (picture(world), picture(Arc::new(oracle)));
        let mean = |image: &Image| image.pixels().flatten().map(f64::from).sum::<f64>();
        let difference: f64 = a.pixels().flatten().zip(b.pixels().flatten()).map(|(a, b)| f64::from((a - b).abs())).sum();
        assert!(difference < 2e-3 * mean(&a), "{}: {difference} of {}", entry.name, mean(&a));
    }
}
