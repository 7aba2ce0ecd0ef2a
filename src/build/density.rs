//! Builds what varies in media. Densities become grids of numbers in a box.

use glam::{DVec3, UVec3};
use rayon::prelude::*;

use super::{Builder, rgb, transform};
use crate::Error;
use crate::describe::volume::{Quantity, Request, Volume};
use crate::describe::{self, ExponentialDensity, NoiseDensity, ValuesAt};
use crate::format::Side;
use crate::math::{Rgb, Transform, float};
use crate::medium::{ColorGrid, Density, Grid, Places};
use crate::texture::noise::fbm;

/// A box: its lower and upper corner, in metres.
pub(super) type Bounds = [DVec3; 2];

const UNIT_CUBE: Bounds = [DVec3::ZERO, DVec3::ONE];

impl Builder<'_> {
    /// Builds a density; nothing after adding a fault. Returns with it the box that its file gives it, or, where no file gives one, that of the
    /// scene. The scene may place a density with a box in its file in another one.
    pub(super) fn density(&mut self, pointer: &str, described: &describe::Density) -> Option<(Density, Bounds)> {
        use describe::Density as D;
        let given = described.bounds().map(|bounds| [bounds.low.0, bounds.high.0].map(DVec3::from));
        let mut of_file = given.unwrap_or(UNIT_CUBE);
        let grid = match described {
            D::Grid(grid) => {
                let size = size_of(grid.size);
                let volume = match &grid.file {
                    Some(file) => {
                        let values_at = grid.values_at;
                        let request = Request { quantity: Quantity::Density, size, grid: grid.grid.as_deref(), values_at, bounds: None };
                        self.volume(pointer, file, request)?
                    }
                    None => {
                        // Grids without a file have a size, and as many values as it says.
                        let values = grid.values.iter().flatten().map(|value| value.get() as f32).collect();
                        Volume { size: size?, channels: 1, values, bounds: None }
                    }
                };
                of_file = volume.bounds.unwrap_or(of_file);
                Grid::new(volume.size, volume.values, places(grid.values_at))
            }
            D::Noise(described) => noise(described, of_file),
            D::Exponential(described) => exponential(described, of_file),
        };
        let [low, high] = given.unwrap_or(of_file);
        let to_box = Transform::scale(high - low).and_then(|scale| Ok(scale.then(&Transform::translate(low)?)));
        match (to_box, transform::placed(described.transform(), &Transform::IDENTITY)) {
            (Ok(to_box), Ok(to_world)) => return Some((Density::new(grid, &to_box.then(&to_world)), of_file)),
            (Err(error), _) => self.fault(&format!("{pointer}/bounds"), &error.to_string()),
            (_, Err(message)) => self.fault(&format!("{pointer}/transform"), &message),
        }
        None
    }

    /// Builds a grid of colours; nothing after adding a fault.
    ///
    /// - `of_density`: the box that the density has in its file
    /// - `must_agree`: whether a file that names a box must name this one
    pub(super) fn color_grid(
        &mut self,
        pointer: &str,
        described: &describe::ColorGrid,
        quantity: Quantity,
        of_density: Bounds,
        must_agree: bool,
    ) -> Option<ColorGrid> {
        let (size, places) = (size_of(described.size), places(described.values_at));
        let Some(file) = &described.file else {
            let values = described.values.iter().flatten().map(rgb).collect();
            return Some(ColorGrid::Rgb(Grid::new(size?, values, places)));
        };
        let (grid, values_at) = (described.grid.as_deref(), described.values_at);
        let volume = self.volume(pointer, file, Request { quantity, size, grid, values_at, bounds: Some(of_density) })?;
        if let Some([low, high]) = volume.bounds
            && must_agree
            && [low, high] != of_density
        {
            let message = format!(
                "{file}: expected the box of the density, from {} to {}, found from {low} to {high}: give the density \"bounds\", which hold \
                 for all its grids",
                of_density[0], of_density[1]
            );
            self.fault(&format!("{pointer}/file"), &message);
        }
        if volume.channels == 1 {
            return Some(ColorGrid::Gray(Grid::new(volume.size, volume.values, places)));
        }
        let values = volume.values.chunks_exact(3).map(|rgb| Rgb::new(rgb[0], rgb[1], rgb[2])).collect();
        Some(ColorGrid::Rgb(Grid::new(volume.size, values, places)))
    }

    /// The values in a file; nothing after adding a fault.
    fn volume(&mut self, pointer: &str, file: &str, request: Request) -> Option<Volume> {
        match self.source.files.volume(file, request) {
            Ok((volume, hash)) => {
                self.contents.insert(file.to_owned(), hash);
                return Some(volume);
            }
            Err(Error::Invalid(faults)) => self.file_faults(&format!("{pointer}/file"), file, faults),
            Err(other) => self.failures.push(other),
        }
        None
    }
}

/// The number of values along each axis, if the scene says it.
fn size_of(described: Option<[Side; 3]>) -> Option<UVec3> {
    described.map(|size| UVec3::from_array(size.map(Side::get)))
}

fn places(described: ValuesAt) -> Places {
    match described {
        ValuesAt::Centers => Places::Centers,
        ValuesAt::Corners => Places::Corners,
    }
}

/// offset + amplitude · fbm(p / size) − falloff · r², from 0 to 1.
fn noise(described: &NoiseDensity, [low, high]: Bounds) -> Grid {
    let sides = high - low;
    let cell = sides.max_element() / f64::from(described.resolution.get());
    let size = (sides / cell).round().as_uvec3().max(UVec3::ONE);
    let at = |x: u32, y: u32, z: u32| {
        let share = (UVec3::new(x, y, z).as_dvec3() + 0.5) / size.as_dvec3();
        let noise = fbm((low + share * sides) / described.size.get(), described.octaves.get());
        let r = 2.0 * share - 1.0;
        let density = described.offset.get() + described.amplitude.get() * noise - described.falloff.get() * r.length_squared();
        // Extreme settings give the difference of two infinite numbers, which is not a number.
        if density.is_nan() { 0.0 } else { density.clamp(0.0, 1.0) as f32 }
    };
    let layer = |z: u32| (0..size.y).flat_map(move |y| (0..size.x).map(move |x| at(x, y, z)));
    Grid::new(size, (0..size.z).into_par_iter().flat_map_iter(layer).collect(), Places::Centers)
}

/// Number of layers of a density that falls exponentially. Over 16 scale heights, linear interpolation between them adds 3·10⁻⁵ of the density.
const LAYERS: u32 = 1024;

/// e^(−height / scale height), with +y up.
fn exponential(described: &ExponentialDensity, [low, high]: Bounds) -> Grid {
    let step = (high.y - low.y) / f64::from(LAYERS - 1) / described.scale_height.get();
    let values = (0..LAYERS).map(|layer| float::exp_f64(-step * f64::from(layer)) as f32).collect();
    Grid::new(UVec3::new(1, LAYERS, 1), values, Places::Corners)
}
