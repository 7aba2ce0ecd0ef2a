//! Table of the surfaces of a lens.

use std::ops::RangeInclusive;

/// Spherical surface of a lens, its opening, and what is behind it. All lengths have the same unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LensSurface {
    /// Curvature 1/R, positive if the centre of the sphere is on the side of the film; 0 for a plane.
    pub curvature: f64,
    /// Distance along the axis to the next surface on the side of the film.
    pub thickness: f64,
    /// Index of refraction between this surface and the next.
    pub ior: f64,
    /// Radius of the opening.
    pub aperture: f64,
}

/// Surfaces of a lens, from the front to the rear.
#[derive(Clone, Debug, PartialEq)]
pub struct LensTable {
    surfaces: Vec<LensSurface>,
    /// Index of the surface that is the stop: a plane between equal media.
    stop: Option<usize>,
}

/// Greatest number of surfaces.
pub const MOST_SURFACES: usize = 100;

/// Indices of refraction. Optical glass has 1.4 to 2.
const IORS: RangeInclusive<f64> = 1.0..=10.0;

/// Relative rounding error of a diameter that was scaled.
const ROUNDING: f64 = 1e-12;

/// Fault of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct TableFault {
    /// Index of the row that has it; `None` if it concerns the table.
    pub row: Option<usize>,
    /// Description of the fault.
    pub message: String,
}

impl LensTable {
    /// A table with the rows `[radius of curvature, thickness, index of refraction, diameter of the opening]`, as pbrt has them. A plane
    /// has the radius 0, and air has the index 0 or 1.
    ///
    /// # Errors
    /// The first row that describes no surface, or a table without refraction or with glass behind the last surface.
    pub fn new(rows: &[[f64; 4]]) -> Result<LensTable, TableFault> {
        let fault = |row, message: String| Err(TableFault { row, message });
        if rows.is_empty() || rows.len() > MOST_SURFACES {
            return fault(None, format!("expected 1 to {MOST_SURFACES} surfaces, found {}", rows.len()));
        }
        for (row, [radius, thickness, ior, diameter]) in rows.iter().enumerate() {
            let message = if !radius.is_finite() {
                format!("expected a radius, or 0 for a plane, found {radius}")
            } else if !(thickness.is_finite() && *thickness >= 0.0) {
                format!("expected a thickness of at least 0, found {thickness}")
            } else if *ior != 0.0 && !IORS.contains(ior) {
                format!("expected an index of refraction from 1 to 10, or 0 for air, found {ior}")
            } else if !(diameter.is_finite() && *diameter > 0.0) {
                format!("expected a diameter above 0, found {diameter}")
            } else if *radius != 0.0 && *diameter > 2.0 * radius.abs() {
                format!("expected a diameter of at most {}, that of the sphere, found {diameter}", 2.0 * radius.abs())
            } else {
                continue;
            };
            return fault(Some(row), message);
        }
        let surface = |&[radius, thickness, ior, diameter]: &[f64; 4]| LensSurface {
            curvature: if radius == 0.0 { 0.0 } else { 1.0 / radius },
            thickness,
            ior: if ior == 0.0 { 1.0 } else { ior },
            aperture: 0.5 * diameter,
        };
        let table = LensTable { surfaces: rows.iter().map(surface).collect(), stop: None };
        if table.surfaces.last().is_some_and(|last| last.ior != 1.0) {
            return fault(Some(rows.len() - 1), "expected air behind the last surface: the index of refraction 1".to_owned());
        }
        let stop = (0..rows.len()).find(|&k| table.surfaces[k].curvature == 0.0 && table.surfaces[k].ior == table.ior_before(k));
        Ok(LensTable { stop, ..table })
    }

    /// The lens with all lengths multiplied by a factor.
    pub fn scaled(mut self, factor: f64) -> LensTable {
        for surface in &mut self.surfaces {
            surface.curvature /= factor;
            surface.thickness *= factor;
            surface.aperture *= factor;
        }
        self
    }

    /// The lens with a smaller opening of its stop.
    ///
    /// # Errors
    /// The lens has no stop, or one with a smaller opening.
    pub fn stopped_down(mut self, diameter: f64) -> Result<LensTable, String> {
        let Some(stop) = self.stop.map(|stop| &mut self.surfaces[stop]) else {
            return Err("the lens has no stop: no row with the radius 0 between equal media".to_owned());
        };
        if diameter > 2.0 * stop.aperture * (1.0 + ROUNDING) {
            return Err("expected at most the diameter of the stop in the table".to_owned());
        }
        stop.aperture = 0.5 * diameter;
        Ok(self)
    }

    /// The surfaces, from the front to the rear.
    pub fn surfaces(&self) -> &[LensSurface] {
        &self.surfaces
    }

    /// Index of the stop.
    pub(super) fn stop(&self) -> Option<usize> {
        self.stop
    }

    /// Index of refraction in front of surface `k`.
    pub(super) fn ior_before(&self, k: usize) -> f64 {
        if k == 0 { 1.0 } else { self.surfaces[k - 1].ior }
    }

    /// Distance from the first surface to the last.
    pub fn length(&self) -> f64 {
        self.surfaces[..self.surfaces.len() - 1].iter().map(|surface| surface.thickness).sum()
    }
}
