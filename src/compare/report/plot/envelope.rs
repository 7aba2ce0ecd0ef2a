//! The lower envelope of curves: the least error that any method has reached at each time.
//!
//! ```text
//! f(t) = min over t' ≤ t and over methods m of e_m(t')
//! ```
//!
//! Between its checkpoints ln e_m is interpolated linearly in ln t; before the first one the method has no picture. So the best method
//! changes only where two curves cross, or where one begins or ends. After the end of the best curve its last picture stays the best until
//! another curve falls below it.

use super::error_curve::ErrorPoint;

/// Part of the envelope: a straight line in logarithms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Index of the curve.
    pub curve: usize,
    /// The two ends. Their error and its interval are those of the curve; `samples` are meaningless.
    pub ends: [ErrorPoint; 2],
}

/// Returns the pieces of the envelope in order of time; one may be a single point. Where nothing improves there is a gap between two.
pub fn envelope(curves: &[Vec<ErrorPoint>]) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = vec![];
    let mut least = f64::INFINITY;
    let times = breaks(curves);
    for pair in times.windows(2) {
        // Between two breaks all curves are straight and none cross.
        let middle = (pair[0] * pair[1]).sqrt();
        let now = (0..curves.len()).filter_map(|curve| Some((curve, at(&curves[curve], middle)?.error)));
        let Some((curve, _)) = now.min_by(|a, b| a.1.total_cmp(&b.1)) else { continue };
        let Some([mut start, end]) = at(&curves[curve], pair[0]).zip(at(&curves[curve], pair[1])).map(|(a, b)| [a, b]) else { continue };
        if start.error.min(end.error) >= least {
            continue;
        }
        if start.error > least {
            // The curve falls below the best so far within the piece.
            let share = (start.error / least).ln() / (start.error / end.error).ln();
            start = between(&start, &end, share);
        }
        // A curve that rises is the best at its start only.
        let end = if end.error < start.error { end } else { start };
        pieces.push(Piece { curve, ends: [start, end] });
        least = end.error;
    }
    pieces
}

/// Times at which a curve bends or begins or two curves cross, in order.
fn breaks(curves: &[Vec<ErrorPoint>]) -> Vec<f64> {
    let sorted = |mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    };
    let bends = sorted(curves.iter().flatten().map(|point| point.seconds).collect());
    let mut all = bends.clone();
    for pair in bends.windows(2) {
        let ends = |curve: &Vec<ErrorPoint>| Some([at(curve, pair[0])?, at(curve, pair[1])?].map(|point| point.error.ln()));
        let straight: Vec<[f64; 2]> = curves.iter().filter_map(ends).collect();
        for (i, a) in straight.iter().enumerate() {
            for b in &straight[i + 1..] {
                let [before, after] = [a[0] - b[0], a[1] - b[1]];
                if before * after < 0.0 {
                    all.push(pair[0] * (pair[1] / pair[0]).powf(before / (before - after)));
                }
            }
        }
    }
    sorted(all)
}

/// Point of a curve at a time; `None` outside of its checkpoints.
fn at(curve: &[ErrorPoint], seconds: f64) -> Option<ErrorPoint> {
    if let Some(point) = curve.iter().find(|point| point.seconds == seconds) {
        return Some(*point);
    }
    let pair = curve.windows(2).find(|pair| pair[0].seconds < seconds && seconds < pair[1].seconds)?;
    Some(between(&pair[0], &pair[1], (seconds / pair[0].seconds).ln() / (pair[1].seconds / pair[0].seconds).ln()))
}

/// Point between two others, interpolated in logarithms.
fn between(a: &ErrorPoint, b: &ErrorPoint, share: f64) -> ErrorPoint {
    let mix = |value: fn(&ErrorPoint) -> f64| value(a) * (value(b) / value(a)).powf(share);
    ErrorPoint { samples: None, seconds: mix(|p| p.seconds), error: mix(|p| p.error), low: mix(|p| p.low), high: mix(|p| p.high) }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    /// e = v · tˢ at these times, with an interval of a tenth.
    fn curve(v: f64, slope: f64, times: &[f64]) -> Vec<ErrorPoint> {
        let point = |t: &f64| {
            let error = v * t.powf(slope);
            ErrorPoint { samples: None, seconds: *t, error, low: error / 1.1, high: error * 1.1 }
        };
        times.iter().map(point).collect()
    }

    /// Two power laws on grids that interleave cross once: 0.8 t^−0.5 = 0.4 t^−0.25 at t = 16. A front of the points alone would go back
    /// and forth between them.
    #[test]
    fn the_best_changes_only_where_the_curves_cross() {
        let curves = [curve(0.8, -0.5, &[1.0, 4.0, 16.5, 64.0, 256.0]), curve(0.4, -0.25, &[1.5, 6.0, 24.0, 96.0, 300.0])];
        let pieces = envelope(&curves);
        let mut owners: Vec<usize> = pieces.iter().map(|piece| piece.curve).collect();
        owners.dedup();
        // The second curve begins at 1.5 s; the first one is alone before that, and ends at 256 s.
        assert_eq!(owners, [0, 1, 0]);
        let first = pieces.iter().rposition(|piece| piece.curve == 1).expect("a piece");
        let [before, after] = [pieces[first].ends[1], pieces[first + 1].ends[0]];
        assert_relative_eq!(before.seconds, 16.0, max_relative = 1e-9);
        assert_relative_eq!(after.seconds, 16.0, max_relative = 1e-9);
        assert_relative_eq!(before.error, 0.2, max_relative = 1e-9);
        assert_relative_eq!(before.high, 0.22, max_relative = 1e-9);
    }

    /// At every time of a fine grid no curve has been below the envelope, and one was as low.
    #[test]
    fn the_envelope_is_the_least_error_so_far() {
        let bumpy = |shift: f64, waves: f64| -> Vec<ErrorPoint> {
            let times: Vec<f64> = (0..9).map(|k| shift * 2f64.powi(k)).collect();
            let mut points = curve(0.5, -0.4, &times);
            points.iter_mut().enumerate().for_each(|(k, p)| p.error *= (waves * k as f64).sin().exp());
            points
        };
        let curves = [bumpy(1.0, 2.1), bumpy(1.3, 1.1), bumpy(1.7, 0.7)];
        let pieces = envelope(&curves);
        let mut least = f64::INFINITY;
        for k in 0..4000 {
            let seconds = 1.0 * 500f64.powf(f64::from(k) / 4000.0);
            let now = curves.iter().filter_map(|curve| at(curve, seconds)).map(|point| point.error).fold(f64::INFINITY, f64::min);
            least = least.min(now);
            let ends = |piece: &Piece| at(&piece.ends, seconds).map(|point| point.error);
            let past = pieces.iter().filter(|piece| piece.ends[1].seconds <= seconds).map(|piece| piece.ends[1].error);
            let found = pieces.iter().filter_map(ends).chain(past).fold(f64::INFINITY, f64::min);
            // Least errors between two times of the grid are missed by as much as a curve changes there.
            assert!((found / least).ln().abs() < 0.02, "{seconds}: {found}, {least}");
        }
        assert!(pieces.windows(2).all(|pair| pair[0].ends[1].seconds <= pair[1].ends[0].seconds * (1.0 + 1e-12)));
        assert!(pieces.windows(2).all(|pair| pair[1].ends[0].error <= pair[0].ends[1].error * (1.0 + 1e-12)));
    }

    #[test]
    fn curves_of_no_or_one_point_are_harmless() {
        assert!(envelope(&[]).is_empty() && envelope(&[vec![], curve(1.0, 0.0, &[1.0])]).is_empty());
    }
}
