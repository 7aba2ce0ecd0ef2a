//! Logarithmic axes and their labels.

/// Map from value to pixel: equal ratios are equal lengths.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    values: [f64; 2],
    pixels: [f64; 2],
}

impl Axis {
    /// Axis that holds all positive values, with a margin on both sides.
    pub fn over(values: impl Iterator<Item = f64>, pixels: [f64; 2]) -> Axis {
        let logs = values.filter(|v| v.is_finite() && *v > 0.0).map(f64::log10);
        let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        let (low, high) = if low <= high { (low, high) } else { (-1.0, 0.0) };
        let air = (0.05 * (high - low)).max(0.08);
        Axis { values: [low - air, high + air], pixels }
    }

    /// Pixel of a value. Values beyond the ends are drawn at the ends.
    pub fn at(&self, value: f64) -> f64 {
        let [low, high] = self.values;
        let [from, to] = self.pixels;
        let share = (value.max(f64::MIN_POSITIVE).log10() - low) / (high - low);
        from + share.clamp(0.0, 1.0) * (to - from)
    }

    /// Value at a pixel.
    pub fn value(&self, pixel: f64) -> f64 {
        let [low, high] = self.values;
        let [from, to] = self.pixels;
        10f64.powf(low + (pixel - from) / (to - from) * (high - low))
    }

    /// Round values, as many as `most` labels allow.
    pub fn ticks(&self, most: usize) -> Vec<f64> {
        let fine = [&[1.0, 2.0, 5.0][..], &[1.0, 3.0], &[1.0]].into_iter().map(|steps| self.decades(steps, 1));
        let coarse = (2..).map(|stride| self.decades(&[1.0], stride));
        fine.chain(coarse).find(|ticks| ticks.len() <= most).unwrap_or_default()
    }

    /// Ticks at powers of two, or at every second, third … power if there would be more than `most`.
    pub fn doublings(&self, most: usize) -> Vec<f64> {
        let [low, high] = self.values.map(|v| v / 2f64.log10());
        let every = |stride: i32| -> Vec<f64> {
            (low.ceil() as i32..=high.floor() as i32).filter(|k| k % stride == 0).map(|k| f64::from(k).exp2()).collect()
        };
        (1..).map(every).find(|ticks| ticks.len() <= most).unwrap_or_default()
    }

    /// Ticks at times that are round in the unit of their label: 10 s, 1 min, 10 min, 1 h.
    pub fn times(&self, most: usize) -> Vec<f64> {
        let fine = [&[1.0, 2.0, 5.0][..], &[1.0, 3.0], &[1.0]].into_iter().map(|steps| self.clock(steps));
        let coarse = (2..).map(|stride| self.clock(&[1.0]).into_iter().step_by(stride).collect());
        fine.chain(coarse).find(|ticks: &Vec<f64>| ticks.len() <= most.max(1)).unwrap_or_default()
    }

    /// Ticks at step · 10^k seconds, minutes, hours and days, where each tick is shorter than the next unit.
    fn clock(&self, steps: &[f64]) -> Vec<f64> {
        const UNITS: [(f64, i32, f64); 4] = [(1.0, -9, 60.0), (60.0, 0, 3600.0), (3600.0, 0, 86400.0), (86400.0, 0, f64::INFINITY)];
        let [low, high] = self.values.map(|v| 10f64.powf(v));
        let of = |(unit, least, end): (f64, i32, f64)| {
            let tens = (least..12).flat_map(|k| steps.iter().map(move |step| decimal(*step, k)));
            tens.map(move |count| unit * count).filter(move |t| *t < end)
        };
        UNITS.into_iter().flat_map(of).filter(|t| (low..=high).contains(t)).collect()
    }

    fn decades(&self, steps: &[f64], stride: i32) -> Vec<f64> {
        let [low, high] = self.values;
        let decades = (low.floor() as i32..=high.ceil() as i32).filter(|k| k % stride == 0);
        let values = decades.flat_map(|k| steps.iter().map(move |step| decimal(*step, k)));
        values.filter(|v| (low..=high).contains(&v.log10())).collect()
    }
}

/// step · 10^k, parsed from text so that 3 · 10⁻³ is the nearest number to 0.003.
fn decimal(step: f64, k: i32) -> f64 {
    format!("{step}e{k}").parse().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_ratios_are_equal_lengths() {
        let axis = Axis::over([0.01, 10.0].into_iter(), [100.0, 700.0]);
        let step = axis.at(0.02) - axis.at(0.01);
        assert!((axis.at(8.0) - axis.at(4.0) - step).abs() < 1e-9);
        assert!((axis.value(axis.at(0.5)) - 0.5).abs() < 1e-12);
        assert!(axis.at(0.01) > 100.0 && axis.at(10.0) < 700.0);
        assert_eq!(axis.at(-1.0), 100.0);
    }

    #[test]
    fn labels_have_room() {
        let ticks = |low, high, most| Axis::over([low, high].into_iter(), [0.0, 1.0]).ticks(most);
        assert_eq!(ticks(0.011, 0.3, 8), [0.01, 0.02, 0.05, 0.1, 0.2]);
        assert_eq!(ticks(0.003, 1.0, 6), [0.003, 0.01, 0.03, 0.1, 0.3, 1.0]);
        assert_eq!(ticks(1e-6, 1e6, 5), [1e-6, 1e-3, 1e0, 1e3, 1e6]);
        let times = |low, high, most| Axis::over([low, high].into_iter(), [0.0, 1.0]).times(most);
        assert_eq!(times(0.1, 3600.0, 7), [0.1, 1.0, 10.0, 60.0, 600.0, 3600.0]);
        assert_eq!(times(4.0, 300.0, 8), [5.0, 10.0, 20.0, 50.0, 60.0, 120.0, 300.0]);
        let doublings = Axis::over([1.0, 4096.0].into_iter(), [0.0, 1.0]).doublings(7);
        assert_eq!(doublings, [1.0, 4.0, 16.0, 64.0, 256.0, 1024.0, 4096.0]);
        for broken in [vec![], vec![f64::NAN, -1.0], vec![2.0]] {
            let axis = Axis::over(broken.into_iter(), [0.0, 1.0]);
            assert!(axis.at(2.0).is_finite() && axis.ticks(8).len() <= 8);
        }
    }
}
