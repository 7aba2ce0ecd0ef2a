//! Conversion of numbers: no value is rounded to infinity, and only 0 becomes 0.

/// Value of a number's text, if a 32-bit float can hold it.
///
/// Geometry is placed in 64 bits but rendered in 32, so one rule holds for every number of a scene.
///
/// # Errors
/// A sentence: beyond 3.4028235e38 the value would become infinite; below 1.1754944e-38 it would lose digits or become 0.
pub(super) fn real(text: &str) -> Result<f64, String> {
    let (wide, narrow) = match (text.parse::<f64>(), text.parse::<f32>()) {
        (Ok(wide), Ok(narrow)) => (wide, narrow),
        _ => return Err(format!("expected a number, found {text}")),
    };
    if !narrow.is_finite() {
        return Err(format!("the number {text} is too large for a 32-bit float (at most {:e})", f32::MAX));
    }
    if narrow.abs() < f32::MIN_POSITIVE && !is_zero(text) {
        return Err(format!("the number {text} is too small for a 32-bit float (at least {:e}, or 0)", f32::MIN_POSITIVE));
    }
    Ok(wide)
}

/// Value of a number's text, if it is whole: `7`, `-2`, `1e3` and `7.0` are.
pub(super) fn whole(text: &str) -> Option<i128> {
    // Beyond 2^53 a 64-bit float cannot hold every whole number.
    const EXACT: f64 = (1u64 << 53) as f64;
    let as_written = text.parse::<i128>().ok();
    as_written.or_else(|| text.parse::<f64>().ok().filter(|x| x.fract() == 0.0 && x.abs() <= EXACT).map(|x| x as i128))
}

/// Returns whether all digits of the mantissa are 0: true for `0.0e9`, false for `1e-400`.
fn is_zero(text: &str) -> bool {
    let mantissa = text.split(['e', 'E']).next().unwrap_or(text);
    !mantissa.contains(|c| matches!(c, '1'..='9'))
}
