//! Scattering in double precision.
//!
//! Directions are in the frame of the surface, with +z along its normal, and point away from it. `eta` is the index of refraction inside
//! divided by that outside.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::{DVec2, DVec3};

/// A scattering model.
#[derive(Clone, Copy, Debug)]
pub enum DoubleMaterial {
    /// Lambert: f = ρ/π.
    Diffuse { albedo: DVec3 },
    /// Lambert with a checkerboard of so many squares per unit of the texture coordinates.
    Checkered { even: DVec3, odd: DVec3, scale: f64 },
    /// A mirror of one reflectance.
    Mirror { color: DVec3 },
    /// Polished metal with the index of refraction η + ik.
    Metal { eta: DVec3, k: DVec3 },
    /// Polished metal by its reflectance at normal incidence, with Schlick's approximation.
    Schlick { normal: DVec3 },
    /// Clear glass, whose inside absorbs: e^(−σd) is left after the distance d (1/m).
    Dielectric { eta: f64, color: DVec3, absorption: DVec3 },
    /// A pane of glass as one surface.
    ThinDielectric { eta: f64, color: DVec3 },
}

/// A sampled direction.
pub struct DoubleSample {
    pub wi: DVec3,
    /// f |cos θi| / p
    pub weight: DVec3,
    /// Index of refraction on the side of `wi` over that on the side of `wo`.
    pub eta: f64,
}

impl DoubleMaterial {
    /// The material at a point.
    ///
    /// - `uv`: texture coordinates
    pub fn at(self, uv: DVec2) -> DoubleMaterial {
        match self {
            DoubleMaterial::Checkered { even, odd, scale } => {
                let cell = (uv * scale).floor();
                DoubleMaterial::Diffuse { albedo: if (cell.x + cell.y).rem_euclid(2.0) < 1.0 { even } else { odd } }
            }
            other => other,
        }
    }

    /// Samples a direction; `None` if the light is absorbed.
    ///
    /// - `choice`, `u`: random numbers in [0, 1)
    /// - `inside`: length of the way through the inside of the body before this hit (m)
    pub fn sample(&self, wo: DVec3, choice: f64, u: DVec2, inside: f64) -> Option<DoubleSample> {
        let reflected =
            |weight: DVec3| (weight.max_element() > 0.0).then_some(DoubleSample { wi: DVec3::new(-wo.x, -wo.y, wo.z), weight, eta: 1.0 });
        if wo.z == 0.0 {
            return None;
        }
        match *self {
            // Looked up before.
            DoubleMaterial::Checkered { .. } => None,
            DoubleMaterial::Diffuse { albedo } => {
                let disk = disk(u);
                let wi = disk.extend((1.0 - disk.length_squared()).max(0.0).sqrt().copysign(wo.z));
                (albedo.max_element() > 0.0).then_some(DoubleSample { wi, weight: albedo, eta: 1.0 })
            }
            DoubleMaterial::Mirror { color } => reflected(color),
            DoubleMaterial::Metal { eta, k } => reflected(per_channel(|c| metal_reflectance(wo.z.abs(), eta[c], k[c]))),
            DoubleMaterial::Schlick { normal } => reflected(normal + (1.0 - normal) * (1.0 - wo.z.abs()).powi(5)),
            DoubleMaterial::Dielectric { eta, color, absorption } => {
                // Outside nothing is absorbed, also where the absorption is infinite.
                let color = if inside > 0.0 { color * per_channel(|c| (-absorption[c] * inside).exp()) } else { color };
                // Index of refraction of the far side over that of this side.
                let n = if wo.z > 0.0 { eta } else { 1.0 / eta };
                let Some(refracted) = refract(wo, n).filter(|_| choice >= reflectance(wo.z.abs(), n)) else { return reflected(color) };
                (color.max_element() > 0.0).then_some(DoubleSample { wi: refracted, weight: color / (n * n), eta: n })
            }
            DoubleMaterial::ThinDielectric { eta, color } => {
                let once = reflectance(wo.z.abs(), eta);
                // Light that is reflected back and forth between both faces: R + T² R (1 + R² + …) = 2R/(1 + R).
                let both = 2.0 * once / (1.0 + once);
                let passed = DoubleSample { wi: -wo, weight: color, eta: 1.0 };
                if choice < both { reflected(color) } else { (color.max_element() > 0.0).then_some(passed) }
            }
        }
    }
}

fn per_channel(of: impl Fn(usize) -> f64) -> DVec3 {
    DVec3::new(of(0), of(1), of(2))
}

/// Point of the unit disk by the concentric map.
///
/// (r, φ) = (a, π/4 · b/a) if |a| > |b|, else (b, π/2 − π/4 · a/b)
///
/// Random numbers are the lower ends of cells of the width 2⁻²⁴, and a, b = 2u − 1 + 2⁻²⁴ are the middles of these cells.
pub fn disk(u: DVec2) -> DVec2 {
    let DVec2 { x: a, y: b } = 2.0 * u - (1.0 - 0.5f64.powi(24));
    if a == 0.0 && b == 0.0 {
        return DVec2::ZERO;
    }
    let (r, phi) = if a.abs() > b.abs() { (a, FRAC_PI_4 * (b / a)) } else { (b, FRAC_PI_2 - FRAC_PI_4 * (a / b)) };
    DVec2::new(r * phi.cos(), r * phi.sin())
}

/// Refracted direction by Snell's law; `None` under total reflection.
///
/// - `n`: index of refraction of the far side over that of the side of `wo`
fn refract(wo: DVec3, n: f64) -> Option<DVec3> {
    let cos2 = 1.0 - (1.0 - wo.z * wo.z) / (n * n);
    (cos2 > 0.0).then(|| DVec3::new(-wo.x / n, -wo.y / n, -cos2.sqrt().copysign(wo.z)).normalize())
}

/// Fresnel's reflectance of a boundary between clear media, for light without polarisation; 1 under total reflection.
///
/// rₛ = (c − n c′)/(c + n c′),    rₚ = (n c − c′)/(n c + c′)
fn reflectance(cos: f64, n: f64) -> f64 {
    let c = cos.min(1.0);
    let cos2 = 1.0 - (1.0 - c * c) / (n * n);
    if cos2 <= 0.0 {
        return 1.0;
    }
    let far = cos2.sqrt();
    let (s, p) = ((c - n * far) / (c + n * far), (n * c - far) / (n * c + far));
    0.5 * (s * s + p * p)
}

/// Fresnel's reflectance of metal, by complex numbers: the same formulas with the complex index N = η + ik and the complex cosine
/// c′ = √(1 − sin²θ/N²).
fn metal_reflectance(cos: f64, eta: f64, k: f64) -> f64 {
    let c = Complex(cos.min(1.0), 0.0);
    let index = Complex(eta, k);
    let square = index.times(index);
    let sine2 = Complex(1.0 - c.0 * c.0, 0.0);
    let far = Complex(1.0, 0.0).minus(sine2.over(square)).root();
    let (near_far, index_far) = (index.times(c), index.times(far));
    let s = c.minus(index_far).over(c.plus(index_far));
    let p = near_far.minus(far).over(near_far.plus(far));
    0.5 * (s.square() + p.square())
}

#[derive(Clone, Copy)]
struct Complex(f64, f64);

impl Complex {
    fn plus(self, other: Complex) -> Complex {
        Complex(self.0 + other.0, self.1 + other.1)
    }

    fn minus(self, other: Complex) -> Complex {
        Complex(self.0 - other.0, self.1 - other.1)
    }

    fn times(self, other: Complex) -> Complex {
        Complex(self.0 * other.0 - self.1 * other.1, self.0 * other.1 + self.1 * other.0)
    }

    fn over(self, other: Complex) -> Complex {
        let product = self.times(Complex(other.0, -other.1));
        Complex(product.0 / other.square(), product.1 / other.square())
    }

    /// Square of the absolute value.
    fn square(self) -> f64 {
        self.0 * self.0 + self.1 * self.1
    }

    /// The root with a real part that is not negative.
    fn root(self) -> Complex {
        let length = self.0.hypot(self.1);
        Complex((0.5 * (length + self.0)).max(0.0).sqrt(), (0.5 * (length - self.0)).max(0.0).sqrt().copysign(self.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of textbooks: glass reflects ((n − 1)/(n + 1))² at normal incidence, nothing of one polarisation at Brewster's angle, and all
    /// beyond the critical angle. A metal without absorption is glass. Gold at 633 nm reflects 97 %: ((η − 1)² + k²)/((η + 1)² + k²).
    #[test]
    fn formulas_hold_in_double_precision() {
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-14, "{a} {b}");
        near(reflectance(1.0, 1.5), 0.04);
        let brewster = 1.0 / (1.0 + 1.5f64 * 1.5).sqrt();
        let s = (1.5f64 * 1.5 - 1.0) / (1.5 * 1.5 + 1.0);
        near(reflectance(brewster, 1.5), 0.5 * s * s);
        near(reflectance(0.7, 1.0 / 1.5), 1.0);
        (1..=100).for_each(|i| near(metal_reflectance(f64::from(i) / 100.0, 1.5, 0.0), reflectance(f64::from(i) / 100.0, 1.5)));
        near(metal_reflectance(1.0, 0.18, 3.43), (0.82f64.powi(2) + 3.43f64.powi(2)) / (1.18f64.powi(2) + 3.43f64.powi(2)));
    }

    /// Snell's law, and the way back.
    #[test]
    fn refraction_in_double_precision_is_reversible() {
        for i in 1..100 {
            let sine = f64::from(i) / 100.0;
            let wo = DVec3::new(0.6 * sine, 0.8 * sine, (1.0 - sine * sine).sqrt());
            let wi = refract(wo, 1.5).expect("from outside all light enters");
            assert!((wi.truncate().length() * 1.5 - sine).abs() < 1e-14);
            assert!((refract(wi, 1.0 / 1.5).expect("the way back") - wo).length() < 1e-13);
        }
    }

    /// The concentric map is onto the disk, keeps areas, and has the corners of the square on the circle.
    #[test]
    fn the_disk_is_filled_evenly() {
        const N: u32 = 64;
        let cell = |i: u32| (f64::from(i) + 0.5) / f64::from(N);
        let points: Vec<DVec2> = (0..N * N).map(|i| disk(DVec2::new(cell(i % N), cell(i / N)))).collect();
        assert!(points.iter().all(|p| p.length() < 1.0));
        // Radii below √s hold the share s of the area; a ring of cells is 1/64 wide.
        for s in [0.25, 0.5, 0.75] {
            let inside = points.iter().filter(|p| p.length_squared() < s).count();
            assert!((inside as f64 / f64::from(N * N) - s).abs() < 2.0 / f64::from(N), "{inside} {s}");
        }
    }
}
