//! Statistics of a render for `--stats`. Only here times and memory of the machine are read.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DVec3, Vec3};
use serde_json::json;

use crate::camera::Camera;
use crate::effects::Effects;
use crate::light::Lights;
use crate::math::{Ray, RayDifferential, SurfaceDifferential};
use crate::medium::{Boundaries, Inside, InterfaceCrossing, Media};
use crate::primitive::Hit;
use crate::render::RenderReport;
use crate::scene::{Scene, Surface};
use crate::shape::SurfacePoint;
use clap::ValueEnum;

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextOrJson {
    Text,
    Json,
}

/// Scene that counts the rays that it traces; used only if they are to be reported.
pub struct RayCounter {
    scene: Arc<dyn Scene>,
    /// Counts per thread, each in its own cache line, so that threads do not disturb each other.
    counts: Vec<Line>,
}

#[repr(align(128))]
#[derive(Default)]
struct Line {
    nearest: AtomicU64,
    shadow: AtomicU64,
}

impl RayCounter {
    /// Counter for a scene.
    pub fn new(scene: Arc<dyn Scene>, threads: usize) -> RayCounter {
        RayCounter { scene, counts: (0..threads + 1).map(|_| Line::default()).collect() }
    }

    /// Numbers of rays for the nearest hit, and of shadow rays.
    pub fn rays(&self) -> (u64, u64) {
        let sum = |f: fn(&Line) -> &AtomicU64| self.counts.iter().map(|line| f(line).load(Ordering::Relaxed)).sum();
        (sum(|line| &line.nearest), sum(|line| &line.shadow))
    }

    fn line(&self) -> &Line {
        let thread = rayon::current_thread_index().map_or(0, |i| i + 1);
        &self.counts[thread.min(self.counts.len() - 1)]
    }
}

impl Scene for RayCounter {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.line().nearest.fetch_add(1, Ordering::Relaxed);
        self.scene.intersect(ray)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.line().shadow.fetch_add(1, Ordering::Relaxed);
        self.scene.occluded(ray)
    }

    fn surface(&self, ray: &Ray, hit: &Hit) -> Surface<'_> {
        self.scene.surface(ray, hit)
    }

    fn surface_with_footprint(&self, ray: &Ray, hit: &Hit, differential: &RayDifferential) -> (Surface<'_>, Option<SurfaceDifferential>) {
        self.scene.surface_with_footprint(ray, hit, differential)
    }

    fn surface_seen_from(&self, ray: &Ray, hit: &Hit, wo: Vec3) -> Surface<'_> {
        self.scene.surface_seen_from(ray, hit, wo)
    }

    fn lights(&self) -> &Lights {
        self.scene.lights()
    }

    fn camera(&self) -> &Camera {
        self.scene.camera()
    }

    fn media(&self) -> Option<&Media> {
        self.scene.media()
    }

    fn boundaries(&self, hit: &Hit, point: &SurfacePoint) -> Boundaries {
        self.scene.boundaries(hit, point)
    }

    fn bodies_around(&self, p: Vec3) -> Inside {
        self.scene.bodies_around(p)
    }

    fn interface(&self, ray: &Ray) -> Option<InterfaceCrossing> {
        self.scene.interface(ray)
    }

    fn effects(&self) -> Effects {
        self.scene.effects()
    }

    fn origin(&self) -> DVec3 {
        self.scene.origin()
    }
}

/// Statistics to print.
pub struct Summary<'a> {
    /// Report of the render.
    pub report: &'a RenderReport,
    /// Mean number of samples per pixel.
    pub spp: f64,
    /// Number of pixels.
    pub pixels: u64,
    /// Number of primitives.
    pub primitives: u64,
    /// Number of instances, with those within them.
    pub instances: u32,
    /// Numbers of rays, as [`RayCounter::rays`] returns them.
    pub rays: (u64, u64),
    /// Number of threads.
    pub threads: usize,
    /// Time for reading and building the scene (s).
    pub load: f64,
}

impl Summary<'_> {
    /// Text or JSON of the statistics.
    pub fn print(&self, format: TextOrJson) -> String {
        let seconds = self.report.elapsed.as_secs_f64();
        let samples = (self.spp * self.pixels as f64).round() as u64;
        let rays = self.rays.0 + self.rays.1;
        match format {
            TextOrJson::Json => {
                let object = json!({
                    "version": env!("CARGO_PKG_VERSION"), "build": env!("PT_BUILD_ID"), "threads": self.threads,
                    "load_seconds": self.load, "render_seconds": seconds, "spp": self.spp.round() as u64, "camera_samples": samples,
                    "rays": self.rays.0, "shadow_rays": self.rays.1, "primitives": self.primitives, "instances": self.instances,
                    "invalid_samples": self.report.invalid, "camera_samples_per_second": samples as f64 / seconds,
                    "rays_per_second": rays as f64 / seconds, "peak_memory_bytes": peak_memory(),
                });
                format!("{object}\n")
            }
            TextOrJson::Text => {
                let instances = if self.instances > 0 { format!(", {} instances", self.instances) } else { String::new() };
                let memory = peak_memory().map_or(String::new(), |bytes| format!("memory      {:.0} MB at most\n", bytes as f64 * 1e-6));
                format!(
                    "load        {:.2} s, {} primitives{instances}\nrender      {seconds:.2} s on {} threads\nsamples     {samples} ({:.2} M/s)\n\
                     rays        {} and {} shadow rays ({:.2} M/s), {:.2} + {:.2} per sample\n{memory}invalid     {} samples\n",
                    self.load,
                    self.primitives,
                    self.threads,
                    samples as f64 / seconds * 1e-6,
                    self.rays.0,
                    self.rays.1,
                    rays as f64 / seconds * 1e-6,
                    self.rays.0 as f64 / samples.max(1) as f64,
                    self.rays.1 as f64 / samples.max(1) as f64,
                    self.report.invalid,
                )
            }
        }
    }
}

/// Peak memory of the process, if the system reports it.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib * 1024)
}
