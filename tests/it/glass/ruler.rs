//! Magnification by a pane of glass, measured with a ruler behind it.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use pt::bsdf::Material;
use pt::camera::{Camera, Perspective, Pose};
use pt::film::FilmSpec;
use pt::integrator::Integrator;
use pt::integrators::whitted::Whitted;
use pt::sampler::{Kind, SamplerSpec};
use pt::scene::Scene;
use pt::shape::{Quad, TriangleMesh};
use pt::world::World;

use super::{block, pane};
use crate::scenes::{at, black, facing, glow, picture};

/// The picture is a row of pixels over ±1/50 of the distance, with angles at which tan θ = θ to 10⁻⁴.
const WIDTH: u32 = 1024;
const HALF_WIDTH: f64 = 0.02;

/// Positions of the camera, a pane and a ruler behind it.
#[derive(Clone, Copy, Debug)]
pub struct Stand {
    /// From the camera to the ruler (m).
    pub distance: f64,
    /// From the camera to the near face (m).
    pub near: f64,
    pub thickness: f64,
    /// Whether the pane is a closed box. Otherwise it is two quads.
    pub closed: bool,
    /// Coordinate of the camera in the world, the same on every axis (m).
    pub offset: f64,
}

impl Stand {
    /// Builds the scene. Without glass the edge of the ruler appears half way from the middle of the row to its right end.
    pub fn scene(&self, glass: bool) -> Arc<World> {
        let eye = DVec3::splat(self.offset);
        let aspect = f64::from(WIDTH);
        let fov = 2.0 * (HALF_WIDTH / aspect).atan().to_degrees();
        let mut world = World::builder(Camera::Perspective(Perspective::new(Pose::new(&at(eye)), fov, 0.0, 1.0)));
        let (dark, clear) = (world.material(black()), world.material(Material::glass(1.5)));
        let edge = 0.5 * HALF_WIDTH * self.distance;
        let ruler = DVec3::new(edge - 2.0, 0.0, -self.distance);
        world.shape(Quad { size: [4.0, 4.0] }, facing(eye + ruler, DVec3::Z), dark, glow(1.0));
        if glass && self.closed {
            let half = Vec3::new(1.0, 1.0, 0.5 * self.thickness as f32);
            world.shape(TriangleMesh::new(block(half)), at(eye - DVec3::Z * (self.near + 0.5 * self.thickness)), clear, None);
        } else if glass {
            pane(&mut world, clear, eye, [-self.near - self.thickness, -self.near], 2.0);
        }
        Arc::new(world.build().unwrap())
    }

    /// The magnification M = D/(D − t(1 − 1/n)), which does not depend on the position of the pane.
    pub fn magnification(&self, n: f64) -> f64 {
        self.distance / (self.distance - self.thickness * (1.0 - 1.0 / n))
    }
}

/// Distance of the ruler's edge from the middle of the row (pixels), computed from the light left of the edge.
///
/// The depth allows only two interfaces, because faint images by inner reflections must not count.
pub fn edge(scene: Arc<dyn Scene>, integrator: &dyn Integrator) -> f64 {
    let sampler = SamplerSpec { kind: Kind::Stratified, spp: 64, seed: 1, ..SamplerSpec::default() };
    let image = picture(scene, integrator, FilmSpec::new(WIDTH, 1), sampler);
    let row: Vec<f64> = image.pixels().map(|[r, _, _]| f64::from(r)).collect();
    let plateau = row[0];
    row.iter().sum::<f64>() / plateau - 0.5 * f64::from(WIDTH)
}

/// The measured magnification.
pub fn read(stand: Stand, integrator: &dyn Integrator) -> f64 {
    edge(stand.scene(true), integrator) / edge(stand.scene(false), integrator)
}

fn whitted() -> Whitted {
    Whitted { max_depth: 2, ..Whitted::default() }
}

/// O3. 6 mm at 2 m, 100 mm at 1 m, 1 m at 3 m: 1.001001, 1.034483, 1.125; within 0.05 %.
#[test]
fn panes_magnify_as_snell_says() {
    for (distance, thickness, expected) in [(2.0, 0.006, 1.001001001), (1.0, 0.1, 1.034482759), (3.0, 1.0, 1.125)] {
        for (closed, share) in [(false, 0.1), (true, 0.1), (true, 0.6)] {
            let stand = Stand { distance, near: share * distance, thickness, closed, offset: 0.0 };
            assert!((stand.magnification(1.5) - expected).abs() < 1e-9);
            let m = read(stand, &whitted());
            assert!((m / expected - 1.0).abs() < 5e-4, "{stand:?}: {m} for {expected}");
        }
    }
}

/// O4. Thin panes do not magnify, at any position in the world: no distance is too short for a ray.
#[test]
fn thin_panes_do_not_magnify() {
    for (thickness, offset) in [1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5].into_iter().flat_map(|t| [0.0, 1e3, 1e5].map(|o| (t, o))) {
        for closed in [false, true] {
            let stand = Stand { distance: 2.0, near: 0.5, thickness, closed, offset };
            let (m, expected) = (read(stand, &whitted()), stand.magnification(1.5));
            assert!((m / expected - 1.0).abs() < 1e-3, "{stand:?}: {m} for {expected}");
        }
    }
}
