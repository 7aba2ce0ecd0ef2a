//! The price of an error: the time at which a method reaches it, or the reason why no time is stated.
//!
//! ```text
//! √relMSE(t) = target,   ln t = mean over the replicates of ln t_i
//! ```
//!
//! t_i is the time from which replicate i stays below the target. Between checkpoints the logarithms are interpolated linearly. Beyond
//! the last one relMSE falls like 1/t, as plain Monte Carlo does. Before the first one nothing is known: there a picture would have less
//! than one sample per pixel, and the first checkpoint is a bound.
//!
//! A time is stated only if all of this holds:
//!
//! 1. The method has no bias as large as the target. For a method that leaves out something that the scene calls for, the data must
//!    exclude one, within [`SquaredBias::bound`]; for others it is enough that none was detected. A bias that the reference does not
//!    resolve may be the reference's own error and does not count as detected.
//! 2. The reference is known to be closer to the truth than the target ([`Reference::resolves`]).
//! 3. The error is not that of a few pixels: after the last checkpoint relMSE is at most twice that without the largest 0.1 % of the
//!    pixels. Otherwise the next bright sample would change it completely.
//! 4. The error does not grow with time if the time is extrapolated.
//! 5. There are several replicates, and they agree on the time: its interval reaches at most from a tenth to ten times of it.

use std::cmp::Ordering;

use super::bias::SquaredBias;
use super::replicates::replicates;
use super::{CheckpointStats, Cost, CostKind, Measurement, NoPrice, Reference};

/// Largest ratio of relMSE to trimmed relMSE for which the error counts as that of many pixels.
const FEW_PIXELS: f64 = 2.0;

/// Largest ratio of the upper end of an interval of time to the time.
const WIDE: f64 = 10.0;

/// What is known of a method.
pub struct Priced<'a> {
    /// Measurements, one per replicate and checkpoint.
    pub measurements: &'a [Measurement],
    /// Statistics of the checkpoints.
    pub curve: &'a [CheckpointStats],
    /// Slope of the error, with its standard error.
    pub slope: Option<(f64, f64)>,
    /// Bias against the reference.
    pub bias: Option<SquaredBias>,
    /// Whether the method leaves out something that the scene calls for.
    pub lacks: bool,
    /// The reference.
    pub reference: &'a Reference,
    /// Confidence of intervals.
    pub confidence: f64,
}

impl Priced<'_> {
    /// Bias of which the reference is not the cause, with its standard error.
    pub fn detected_bias(&self) -> Option<(f64, f64)> {
        self.bias?.detected().filter(|(bias, _)| self.reference.resolves(*bias, self.confidence))
    }

    /// Time that an error takes.
    ///
    /// # Errors
    /// The reason why no time is stated.
    pub fn price(&self, target: f64) -> Result<Cost, NoPrice> {
        if self.measurements.iter().all(|m| m.replicate == 0) {
            return Err(NoPrice::Single);
        }
        if self.detected_bias().is_some_and(|(bias, _)| bias >= target) {
            return Err(NoPrice::Bias);
        }
        if !self.reference.resolves(target, self.confidence) {
            return Err(NoPrice::Reference);
        }
        if self.lacks && self.bias.is_none_or(|bias| bias.bound() >= target) {
            return Err(NoPrice::Lacks);
        }
        // A relMSE of 0 or less is closer to the truth than the reference is: no pixel stands out.
        if self.curve.last().is_some_and(|last| last.relmse.0 > 0.0 && last.relmse.0 > FEW_PIXELS * last.trimmed.0) {
            return Err(NoPrice::FewPixels);
        }
        let cost = cost(self.measurements, target, self.confidence).ok_or(NoPrice::Spread)?;
        if cost.kind == CostKind::Extrapolated && self.slope.is_some_and(|(slope, _)| slope >= 0.0) {
            return Err(NoPrice::Rising);
        }
        match cost.kind {
            // The comparison is false for NaN.
            _ if !matches!(cost.high.partial_cmp(&(WIDE * cost.seconds)), Some(Ordering::Less | Ordering::Equal)) => Err(NoPrice::Spread),
            // Some replicates give only a bound. The mean of bounds is no bound, but the upper end of the interval is.
            CostKind::AtMost => Ok(Cost { seconds: cost.high, ..cost }),
            CostKind::Measured | CostKind::Extrapolated => Ok(cost),
        }
    }
}

/// Mean time of the replicates; `None` if one of them has no error that can be measured.
fn cost(measurements: &[Measurement], target: f64, confidence: f64) -> Option<Cost> {
    let times = replicates(measurements, |of| crossing(of, target).map(|(ln_seconds, _)| ln_seconds))?;
    let any = |kind: CostKind| {
        let share = replicates(measurements, |of| crossing(of, target).map(|(_, found)| f64::from(u8::from(found == kind))));
        share.is_some_and(|share| share.mean > 0.0)
    };
    let kind = match (any(CostKind::AtMost), any(CostKind::Extrapolated)) {
        (true, _) => CostKind::AtMost,
        (false, true) => CostKind::Extrapolated,
        (false, false) => CostKind::Measured,
    };
    let reach = times.quantile(0.5 + 0.5 * confidence) * times.error;
    let low = if kind == CostKind::AtMost { 0.0 } else { (times.mean - reach).exp() };
    Some(Cost { seconds: times.mean.exp(), low, high: (times.mean + reach).exp(), kind })
}

/// ln of the seconds from which the relMSE of a replicate stays at target² or below.
fn crossing(of: &[&Measurement], target: f64) -> Option<(f64, CostKind)> {
    let goal = 2.0 * target.ln();
    let points: Vec<(f64, f64)> = of.iter().filter(|m| m.relmse > 0.0).map(|m| (m.seconds.ln(), m.relmse.ln())).collect();
    let (first, last) = (points.first()?, points.last()?);
    let above = points.iter().rposition(|point| point.1 > goal);
    Some(match above.map(|i| (points[i], points.get(i + 1))) {
        None => (first.0, CostKind::AtMost),
        Some((above, Some(below))) => {
            let share = (above.1 - goal) / (above.1 - below.1);
            (above.0 + share * (below.0 - above.0), CostKind::Measured)
        }
        Some((_, None)) => (last.0 + last.1 - goal, CostKind::Extrapolated),
    })
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::super::curve::{points, slope};
    use super::super::synthetic::{history, image};
    use super::*;
    use crate::measure::RelativeError;

    fn reference(error: Option<RelativeError>) -> Reference {
        Reference { image: image(|_| 1.0, 0.0), origin: "r".into(), error, attributes: vec![] }
    }

    fn known(value: f64, effective_pixels: f64) -> Option<RelativeError> {
        Some(RelativeError { value, spread: 0.1, effective_pixels })
    }

    /// - `square`: b² with its standard error
    fn price_of(of: &[Measurement], target: f64, reference: &Reference, square: [f64; 2], lacks: bool) -> Result<Cost, NoPrice> {
        let [square, error] = square;
        let bias = Some(SquaredBias::new(square, error));
        Priced { measurements: of, curve: &points(of), slope: slope(of), bias, lacks, reference, confidence: 0.95 }.price(target)
    }

    fn price(of: &[Measurement], target: f64) -> Result<Cost, NoPrice> {
        price_of(of, target, &reference(None), [0.0, 0.0], false)
    }

    fn law() -> Vec<Measurement> {
        [history(0, 0.04, 1.0, 6), history(1, 0.04, 1.0, 6)].concat()
    }

    /// The price is where √relMSE = target: at t = (v / target²)^(1/b) between checkpoints, and by the law 1/t beyond them.
    #[test]
    fn prices_are_where_the_law_says() {
        for (target, seconds, kind) in
            [(0.1, 4.0, CostKind::Measured), (0.05, 16.0, CostKind::Measured), (0.01, 400.0, CostKind::Extrapolated)]
        {
            let cost = price(&law(), target).expect("a price");
            assert_relative_eq!(cost.seconds, seconds, max_relative = 1e-9);
            assert_eq!(cost.kind, kind, "{target}");
            assert_relative_eq!(cost.high / cost.low, 1.0, max_relative = 1e-9);
        }
    }

    /// Replicates that differ by a factor f in time: ln t = ln 4 ± ½ ln f, with one degree of freedom t₀.₉₇₅ = 12.706. The interval of a
    /// factor f^6.35 either way is stated up to ten, f = 1.44, and refused beyond.
    #[test]
    fn replicates_that_differ_widen_the_interval_until_no_time_is_stated() {
        let apart = |f: f64| [history(0, 0.04 * f.sqrt(), 1.0, 8), history(1, 0.04 / f.sqrt(), 1.0, 8)].concat();
        let cost = price(&apart(1.4), 0.1).expect("a price");
        assert_relative_eq!(cost.seconds, 4.0, max_relative = 1e-9);
        assert_relative_eq!((cost.high / cost.low).ln(), 2.0 * 12.7062 * 0.5 * 1.4f64.ln(), max_relative = 1e-4);
        assert_eq!(price(&apart(1.5), 0.1), Err(NoPrice::Spread));
    }

    /// Less than a sample per pixel is no picture: of a target that the first checkpoint meets only a bound is known.
    #[test]
    fn before_the_first_checkpoint_there_is_only_a_bound() {
        let cost = price(&law(), 0.4).expect("a bound");
        assert_eq!((cost.kind, cost.low), (CostKind::AtMost, 0.0));
        assert_relative_eq!(cost.seconds, 1.0, max_relative = 1e-9);
    }

    /// A curve that falls below the target and rises again has reached it where it falls the second time.
    #[test]
    fn an_error_is_reached_where_the_curve_stays_below_it() {
        let bent = |r: u32| {
            let mut bent = history(r, 0.04, 1.0, 6);
            // 0.2² at 1 s, then 0.05², 0.2², 0.1² at 8 s, and so on.
            for (m, relmse) in bent.iter_mut().zip([0.04, 0.0025, 0.04, 0.01, 0.0025, 0.0025]) {
                (m.relmse, m.trimmed) = (relmse, relmse);
            }
            bent
        };
        let both = [bent(0), bent(1)].concat();
        assert_relative_eq!(price(&both, 0.1).expect("a price").seconds, 8.0, max_relative = 1e-9);
        let times: Vec<f64> = [0.19, 0.15, 0.1, 0.07, 0.05].iter().map(|t| price(&both, *t).expect("a price").seconds).collect();
        assert!(times.is_sorted(), "a smaller error takes no less time: {times:?}");
    }

    /// An error that grows with time has no time at which it is small, unless it was small.
    #[test]
    fn an_error_that_grows_is_not_extrapolated() {
        let grows = [history(0, 0.04, -0.5, 6), history(1, 0.04, -0.5, 6)].concat();
        assert_eq!(price(&grows, 0.1), Err(NoPrice::Rising));
        assert!(price(&law(), 0.01).is_ok(), "one that falls is");
    }

    /// No time is stated for an error of which a few pixels hold more than half.
    #[test]
    fn an_error_of_a_few_pixels_has_no_price() {
        let trimmed = |share: f64| {
            let mut of = law();
            of.iter_mut().for_each(|m| m.trimmed = share * m.relmse);
            of
        };
        assert_eq!(price(&trimmed(0.49), 0.1), Err(NoPrice::FewPixels));
        assert!(price(&trimmed(0.51), 0.1).is_ok());
    }

    /// b² = 0.0009 ± 0.0004 may be as large as 0.0009 + 4 · 0.0004 = 0.05². A method that leaves something out gets no price up to
    /// there; one that leaves out nothing does, because no bias is proved.
    #[test]
    fn a_method_that_leaves_something_out_must_show_that_it_gets_there() {
        let priced = |target: f64, lacks: bool| price_of(&law(), target, &reference(None), [0.0009, 0.0004], lacks);
        assert_eq!(priced(0.0499, true), Err(NoPrice::Lacks));
        assert!(priced(0.0501, true).is_ok() && priced(0.0499, false).is_ok());
        // Proved bias is that of any method: 0.0009 exceeds four times 0.0001.
        let proved = |target: f64, lacks: bool| price_of(&law(), target, &reference(None), [0.0009, 0.0001], lacks);
        assert_eq!([proved(0.029, true), proved(0.029, false)], [Err(NoPrice::Bias); 2]);
        assert!(proved(0.031, false).is_ok());
    }

    /// A difference of 0.2 from a reference whose error may be 0.3 · e^(1.96 · 0.1) proves no bias; it does where that error is a tenth.
    #[test]
    fn the_error_of_a_coarse_reference_is_no_bias() {
        let priced = |error: Option<RelativeError>| price_of(&law(), 0.1, &reference(error), [0.04, 0.0004], false);
        assert_eq!(priced(known(0.3, 1e4)), Err(NoPrice::Reference));
        assert_eq!([priced(known(0.03, 1e4)), priced(None)], [Err(NoPrice::Bias); 2]);
    }

    /// The interval of the reference's error ends at 0.02 · e^(1.96 · 0.1) = 0.0243.
    #[test]
    fn no_price_is_stated_below_the_error_of_the_reference() {
        let priced = |target: f64, error: Option<RelativeError>| price_of(&law(), target, &reference(error), [0.0, 0.0], false);
        assert_eq!(priced(0.0243, known(0.02, 1e4)), Err(NoPrice::Reference));
        assert!(priced(0.0244, known(0.02, 1e4)).is_ok());
        assert_eq!(priced(0.1, known(0.02, 29.0)), Err(NoPrice::Reference), "an error of a few pixels tells nothing");
        assert!(priced(0.01, None).is_ok(), "an error that is not stated refuses nothing");
    }
}
