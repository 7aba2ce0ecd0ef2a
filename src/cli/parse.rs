//! Parsers of option values that several commands share.

use std::fmt::Display;
use std::str::FromStr;
use std::time::Duration;

/// Parses a size of a film, with the limits of the scene format.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = numbers(&text.replace(['x', '×'], ",")).map_err(|_| "expected a size such as 640x480".to_owned())?;
    let right = sides.iter().all(|side| (1..=65536).contains(side));
    right.then_some(sides).ok_or("expected a size from 1x1 to 65536x65536".to_owned())
}

/// Parses a whole number within bounds. clap's own parser would report invalid digits, not what is expected.
pub fn whole<N>(low: N, high: N) -> impl Fn(&str) -> Result<N, String> + Clone
where
    N: FromStr + PartialOrd + Display + Copy,
{
    move |text| {
        let inside = |n: &N| (low..=high).contains(n);
        text.parse().ok().filter(inside).ok_or_else(|| format!("expected a whole number from {low} to {high}"))
    }
}

/// Parses `N` whole numbers separated by commas.
pub fn numbers<const N: usize>(text: &str) -> Result<[u32; N], String> {
    let parsed: Option<Vec<u32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let example = (1..=N).map(|n| (100 * n).to_string()).collect::<Vec<_>>().join(",");
    parsed.and_then(|numbers| numbers.try_into().ok()).ok_or(format!("expected {N} whole numbers such as {example}"))
}

/// Parses a number of threads. clap's own message would not mention the environment, which may have given the value.
pub fn threads(text: &str) -> Result<u32, String> {
    let expected = "expected a whole number from 1 to 1024 (in --threads or PT_THREADS)".to_owned();
    text.parse().ok().filter(|n| (1..=1024).contains(n)).ok_or(expected)
}

/// Parses a finite number.
pub fn finite(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|x: &f32| x.is_finite()).ok_or("expected a number".to_owned())
}

/// Parses a finite number above 0.
pub fn above_zero(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|x: &f32| x.is_finite() && *x > 0.0).ok_or("expected a number above 0".to_owned())
}

/// Parses a share above 0 and below 1, in per cent or not.
pub fn share(text: &str) -> Result<f64, String> {
    let (number, unit) = text.trim().strip_suffix('%').map_or((text, 1.0), |number| (number, 100.0));
    let parsed = number.trim().parse().ok().map(|x: f64| x / unit);
    parsed.filter(|x| *x > 0.0 && *x < 1.0).ok_or("expected a share such as 1% or 0.01, above 0 and below 1".to_owned())
}

/// Parses a duration: `30s`, `1h30m`, or a number of seconds.
pub fn duration(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().and_then(|s: f64| Duration::try_from_secs_f64(s).ok());
    let parsed = seconds.or_else(|| humantime::parse_duration(text).ok());
    parsed.filter(|d| !d.is_zero()).ok_or("expected a duration such as 30s, 1h30m or 0.5".to_owned())
}
