//! Tiles whose samples are computed in batches, with paths side by side.

use glam::{UVec2, Vec2};

use super::pixel::PixelAccumulator;
use super::{Render, SampleId, TileResult, filtered};
use crate::camera::{Camera, Perspective};
use crate::film::{Crop, Wave};
use crate::integrator::{BATCH, Batch, CameraRays, Interrupt, SideBySide};
use crate::math::lanes::{Kernel, Lanes, Vector};
use crate::sampler::{NumberLanes, dimension};

/// Samples of a tile. They are computed in batches and added up pixel by pixel, in the order of single samples.
pub struct Batches<'a> {
    pub render: &'a Render,
    pub method: &'a dyn SideBySide,
    pub accumulator: PixelAccumulator,
    pub result: TileResult,
    pub interrupt: Interrupt<'a>,
}

impl Batches<'_> {
    /// Renders the samples of a wave in a tile; `None` if the render was cancelled meanwhile.
    pub fn render(mut self, tile: Crop, wave: Wave) -> Option<TileResult> {
        let render = self.render;
        let (mut batch, mut indices) = (Batch::new(), Vec::with_capacity(BATCH));
        let pixels = (tile.min.y..tile.max.y).flat_map(|y| (tile.min.x..tile.max.x).map(move |x| UVec2::new(x, y)));
        let mut last = None;
        for pixel in pixels {
            let wave = wave.scaled(render.spec.allocation.level(render.spec.crop.index(pixel)));
            self.result.samples += wave.samples();
            for index in wave.range() {
                if batch.len() == BATCH {
                    self.add(&mut batch, &mut indices, &mut last)?;
                }
                batch.push(pixel, render.numbers(pixel, index).1);
                indices.push(index);
            }
        }
        self.add(&mut batch, &mut indices, &mut last)?;
        self.accumulator.push_colors(&mut self.result.sums);
        Some(self.result)
    }

    /// Computes the samples of a batch and adds them up.
    ///
    /// - `last`: pixel of the last sample before
    fn add(&mut self, batch: &mut Batch, indices: &mut Vec<u64>, last: &mut Option<UVec2>) -> Option<()> {
        if self.interrupt.is_cancelled() {
            return None;
        }
        let render = self.render;
        match Pinhole::of(render) {
            Some(rays) => self.method.width().run(StartLanes { rays, batch: &mut *batch }),
            None => batch.start_each(|k, pixel, numbers| render.camera_sample(pixel, indices[k], numbers)),
        }
        self.method.estimate(batch, self.interrupt);
        for ((pixel, weight, radiance), &index) in batch.estimates().zip(&*indices) {
            if *last != Some(pixel) {
                if last.is_some() {
                    self.accumulator.push_colors(&mut self.result.sums);
                }
                self.accumulator.clear();
                *last = Some(pixel);
            }
            let sequence = (index % self.render.sequences.len() as u64) as usize;
            if !self.accumulator.add(sequence, filtered(radiance, weight)) {
                self.result.invalid.push(SampleId { pixel: (pixel.x, pixel.y), index });
            }
        }
        batch.clear();
        indices.clear();
        Some(())
    }
}

/// Rays of a pinhole through pixels with a box filter.
struct Pinhole<'a> {
    camera: &'a Perspective,
    radius: f32,
    size: Vec2,
}

impl<'a> Pinhole<'a> {
    /// The rays of a render; `None` if it has another camera or filter, the camera moves, or textures need differentials.
    fn of(render: &'a Render) -> Option<Pinhole<'a>> {
        let Camera::Perspective(camera) = render.scene.camera() else { return None };
        if render.scene.camera().is_moving() || render.has_footprints {
            return None;
        }
        let radius = render.spec.filter.box_radius()?;
        (!camera.has_lens()).then_some(Pinhole { camera, radius, size: render.spec.size.as_vec2() })
    }
}

impl CameraRays for Pinhole<'_> {
    #[inline(always)]
    fn rays<L: Lanes>(&self, [x, y]: [L::F32; 2], numbers: &mut NumberLanes<L>) -> (Vector<L>, Vector<L>) {
        let [u, v] = numbers.get_2d(dimension::FILM);
        let (one, two, half, radius) = (L::f32(1.0), L::f32(2.0), L::f32(0.5), L::f32(self.radius));
        let (x, y) = (x + half + (two * u - one) * radius, y + half + (two * v - one) * radius);
        let film = [x / L::f32(self.size.x), y / L::f32(self.size.y)];
        self.camera.pinhole_rays(film, self.size.x / self.size.y)
    }
}

/// Gives the samples of a batch their camera rays.
struct StartLanes<'r, 'b, 'a> {
    rays: Pinhole<'r>,
    batch: &'b mut Batch<'a>,
}

impl Kernel for StartLanes<'_, '_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.batch.start_lanes::<L>(&self.rays);
    }
}
