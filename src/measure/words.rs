//! Errors and times in words, as short as they are sure.

/// `2.1`, `0.3`, `12`: a share as a number of per cents, two digits.
pub fn per_cent(share: f64) -> String {
    two_digits(100.0 * share)
}

/// `0.8 s`, `14 s`, `3 min 40 s`, `2 h 5 min`, `3 days`: as precise as such a forecast is.
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

/// Two digits that count; more where they stand before the point.
fn two_digits(x: f64) -> String {
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
}
