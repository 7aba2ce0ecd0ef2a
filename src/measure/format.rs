//! Errors, times and prices as text for people.

use super::{ErrorHistory, ErrorInterval, ErrorTarget, Forecast, Outcome, Refusal, Scope};

/// Relative errors whose prices are listed.
pub const TARGETS: [f64; 4] = [0.1, 0.03, 0.01, 0.003];

/// A share as a number of per cent with two digits: `2.1`, `0.3`, `12`.
pub fn per_cent(share: f64) -> String {
    two_digits(100.0 * share)
}

/// A number with this many digits: `0.0123450`, `12.5000`, `1.50000e9`.
pub fn number(x: f64, digits: i32) -> String {
    if x == 0.0 || !x.is_finite() {
        return x.to_string();
    }
    let (exponent, decimals) = (x.abs().log10().floor() as i32, digits - 1);
    if (-4..digits).contains(&exponent) { format!("{x:.*}", (decimals - exponent) as usize) } else { format!("{x:.*e}", decimals as usize) }
}

/// An error with its interval: `2.1 % (95 %: 2.0–2.2)`.
pub fn error(error: &ErrorInterval, confidence: f64) -> String {
    let [value, low, high] = [error.value, error.low, error.high].map(per_cent);
    format!("{value} % ({} %: {low}–{high})", per_cent(confidence))
}

/// The price of the next smaller error: `1 % would take about 14 s (12 s–16 s)`.
pub fn next_price(history: &ErrorHistory, confidence: f64) -> Option<String> {
    let error = history.last()?.error?.stated(confidence).ok()?;
    let target = TARGETS.into_iter().rev().filter(|target| *target < 0.8 * error.value).find(|target| *target >= 0.01);
    let target = target.or_else(|| TARGETS.into_iter().find(|target| *target < 0.8 * error.value))?;
    let price = history.price(target, confidence)?;
    Some(format!("{} % would take about {}", per_cent(target), self::price(&price)))
}

/// A price with its interval: `38 s (35 s–41 s)`.
pub fn price(price: &Forecast) -> String {
    format!("{} ({})", duration(price.value), between(price.low, price.high))
}

/// An interval of times: `35 s–41 s`. If both ends read the same, their distance from the middle is given: `± 3 %`.
pub fn between(low: f64, high: f64) -> String {
    let [from, to] = [low, high].map(duration);
    match from == to {
        true if high.is_finite() => format!("± {} %", per_cent(((high - low) / (high + low)).max(0.0))),
        true => from,
        false => format!("{from}–{to}"),
    }
}

/// The outcome of a target: `target 1 %: met (95 % sure)`, `target 1 % in 10,20,10,20: not met`.
pub fn outcome(target: &ErrorTarget, outcome: Outcome) -> String {
    let place = match target.scope {
        Scope::Picture => String::new(),
        Scope::Region(crop) => format!(" in {crop}"),
        Scope::Tiles { share } => format!(" on {} % of the tiles", exact_per_cent(share)),
    };
    let what = format!("target {} %{place}", per_cent(target.error));
    match outcome {
        Outcome::Met => format!("{what}: met ({} % sure)", per_cent(target.confidence)),
        Outcome::NotMet => format!("{what}: not met"),
        Outcome::HeavyTail => format!("{what}: cannot be established ({})", Refusal::HeavyTail),
        Outcome::Black => format!("{what}: cannot be established (no light was found)"),
    }
}

/// A share that somebody has chosen, as a number of per cent with up to two decimals: `97.5`.
pub fn exact_per_cent(share: f64) -> String {
    ((1e4 * share).round() / 100.0).to_string()
}

/// A time as precise as a forecast is: `0.8 s`, `14 s`, `3 min 40 s`, `2 h 5 min`, `3 days`.
pub fn duration(seconds: f64) -> String {
    let whole = seconds.round();
    match seconds {
        s if !s.is_finite() => "for ever".into(),
        s if s < 0.0095 => format!("{} ms", two_digits(1e3 * s)),
        s if s < 9.95 => format!("{} s", two_digits(s)),
        s if s < 119.5 => format!("{whole} s"),
        s if s < 3570.0 => format!("{} min {:02} s", (whole / 60.0).floor(), whole % 60.0),
        s if s < 2.0 * 86400.0 => {
            let minutes = (s / 60.0).round();
            format!("{} h {:02} min", (minutes / 60.0).floor(), minutes % 60.0)
        }
        s if s < 2.0 * 365.25 * 86400.0 => format!("{} days", (s / 86400.0).round()),
        s => format!("{} years", two_digits(s / (365.25 * 86400.0))),
    }
}

/// A number with two significant digits, or more if they stand before the decimal point.
pub fn two_digits(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    let places = (1 - x.abs().log10().floor() as i32).max(0);
    let rounded = format!("{x:.*}", places as usize);
    // 9.96 has become 10.0.
    let places = (1 - rounded.parse().unwrap_or(x).abs().log10().floor() as i32).max(0);
    let text = format!("{x:.*}", places as usize);
    // 1.0 reads as 1, 0.30 as 0.3.
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (share, text) in [
            (0.0213, "2.1"),
            (0.01, "1"),
            (0.003, "0.3"),
            (0.95, "95"),
            (0.999, "100"),
            (0.0996, "10"),
            (1.234, "123"),
            (0.0, "0"),
            (2e-6, "0.0002"),
        ] {
            assert_eq!(per_cent(share), text, "{share}");
        }
        assert_eq!([0.95, 0.975, 0.999].map(exact_per_cent), ["95", "97.5", "99.9"]);
    }

    #[test]
    fn an_error_has_an_interval() {
        assert_eq!(error(&ErrorInterval { value: 0.021, low: 0.02, high: 0.022 }, 0.95), "2.1 % (95 %: 2–2.2)");
    }

    #[test]
    fn times_are_as_long_as_they_need_be() {
        for (seconds, text) in [
            (0.0031, "3.1 ms"),
            (0.5, "0.5 s"),
            (9.97, "10 s"),
            (14.2, "14 s"),
            (220.0, "3 min 40 s"),
            (119.7, "2 min 00 s"),
            (7500.0, "2 h 05 min"),
            (3599.0, "1 h 00 min"),
            (3.0 * 86400.0, "3 days"),
            (f64::INFINITY, "for ever"),
        ] {
            assert_eq!(duration(seconds), text, "{seconds}");
        }
    }

    #[test]
    fn intervals_of_times_have_two_ends_or_a_width() {
        let day = 86400.0;
        for (low, high, text) in [
            (35.0, 41.0, "35 s–41 s"),
            (1.8 * day, 3.2 * day, "43 h 12 min–3 days"),
            (2.1 * day, 2.3 * day, "± 4.5 %"),
            (14.0, 14.2, "± 0.71 %"),
            (5.0, 5.0, "± 0 %"),
            (3.0 * day, f64::INFINITY, "3 days–for ever"),
            (f64::INFINITY, f64::INFINITY, "for ever"),
        ] {
            assert_eq!(between(low, high), text, "{low} to {high}");
        }
    }

    #[test]
    fn numbers_have_so_many_digits() {
        let table = [(0.0, "0"), (1.0, "1.00000"), (-12.5, "-12.5000"), (1e-5, "1.00000e-5"), (123_456.7, "123457"), (1.5e9, "1.50000e9")];
        for (x, text) in table {
            assert_eq!(number(x, 6), text);
        }
        assert_eq!((number(0.012_345, 2), number(f64::INFINITY, 6), number(f64::NAN, 6)), ("0.012".into(), "inf".into(), "NaN".into()));
    }
}
