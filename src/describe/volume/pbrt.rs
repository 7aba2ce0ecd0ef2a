//! Grids of pbrt: the parameters of a medium of type "uniformgrid" in a scene file.
//!
//! Source: pbrt-v4, description of its file format, `MakeNamedMedium`.

use std::collections::BTreeMap;

use glam::{DVec3, UVec3};

use super::{Quantity, Volume, by_axis, counted, invalid};
use crate::{Error, Fault, Result};

/// The parameters that are read besides the values, by their names; the types before them are not checked, since versions of pbrt differ
/// in them.
const NAMES: [&str; 5] = ["nx", "ny", "nz", "p0", "p1"];

/// Reads the medium of a scene file. Everything else in it is left out.
///
/// # Errors
/// `Invalid` where there is no such medium, or more than one; `Limit` for too many values.
pub fn read(text: &str, quantity: Quantity) -> Result<Volume> {
    let name = match quantity {
        Quantity::Density => "density",
        Quantity::Emission => "Lescale",
        Quantity::Albedo => return invalid("media of pbrt have no grid of albedos: give a .vol file of Mitsuba, or 32-bit floats"),
    };
    let found = parameters(text, name)?;
    let numbers = |name: &str, count: usize| match found.get(name) {
        None => invalid(format!("no medium of type \"uniformgrid\": it has no \"{name}\"")),
        Some(numbers) if numbers.len() != count => invalid(format!("\"{name}\": expected {count} numbers, found {}", numbers.len())),
        Some(numbers) => Ok(numbers.as_slice()),
    };
    let side = |name: &str| {
        let number = numbers(name, 1)?[0];
        let is_side = number.fract() == 0.0 && (1.0..=f64::from(u32::MAX)).contains(&number);
        if is_side { Ok(number as u32) } else { invalid(format!("\"{name}\": expected a whole number above 0, found {number}")) }
    };
    let size = UVec3::new(side("nx")?, side("ny")?, side("nz")?);
    let values = numbers(name, counted(size)?).map_err(|error| match found.get(name) {
        Some(found) => Error::invalid(Fault::new(format!("\"{name}\": expected {} numbers, found {}", by_axis(size), found.len()))),
        None => error,
    })?;
    let corner = |name: &str, default: f64| match found.get(name) {
        None => Ok(DVec3::splat(default)),
        Some(_) => numbers(name, 3).map(DVec3::from_slice),
    };
    let bounds = [corner("p0", 0.0)?, corner("p1", 1.0)?];
    if bounds[0].cmpge(bounds[1]).any() {
        return invalid(format!("expected \"p1\" above \"p0\" along each axis, found {} and {}", bounds[1], bounds[0]));
    }
    Ok(Volume { size, channels: 1, values: values.iter().map(|value| *value as f32).collect(), bounds: Some(bounds) })
}

/// The numbers of the parameters with one of [`NAMES`], and of that of the values.
fn parameters<'t>(text: &'t str, values: &'static str) -> Result<BTreeMap<&'t str, Vec<f64>>> {
    let mut found = BTreeMap::new();
    // The name of the parameter whose numbers follow.
    let mut name: Option<&str> = None;
    for (line, text) in (1..).zip(text.lines()) {
        let mut rest = text;
        while let Some(token) = next_token(&mut rest) {
            if let Some(declared) = token.strip_prefix('"') {
                // A declaration is "type name".
                name = declared
                    .trim_end_matches('"')
                    .split_whitespace()
                    .nth(1)
                    .and_then(|name| NAMES.into_iter().chain([values]).find(|known| *known == name));
                let is_new = name.is_none_or(|name| found.insert(name, vec![]).is_none());
                if !is_new {
                    let message = format!("a second \"{}\": expected one medium of type \"uniformgrid\"", name.unwrap_or_default());
                    return Err(Error::invalid(Fault::new(message).at_line(line)));
                }
                continue;
            }
            let Some(numbers) = name.and_then(|name| found.get_mut(name)) else { continue };
            match token.parse::<f64>() {
                Ok(number) if number.is_finite() => numbers.push(number),
                // A directive ends the parameters.
                _ if token.starts_with(|c: char| c.is_ascii_alphabetic()) => name = None,
                _ => return Err(Error::invalid(Fault::new(format!("expected a number, found {token:?}")).at_line(line))),
            }
        }
    }
    Ok(found)
}

/// Takes a quoted string or a word from a line. Brackets separate words, and the rest after # is a comment.
fn next_token<'t>(rest: &mut &'t str) -> Option<&'t str> {
    let line = rest.trim_start_matches(|c: char| c.is_whitespace() || c == '[' || c == ']');
    let end = match line.chars().next()? {
        '#' => return None,
        '"' => line[1..].find('"').map_or(line.len(), |end| end + 2),
        _ => line.find(|c: char| c.is_whitespace() || matches!(c, '[' | ']' | '"' | '#')).unwrap_or(line.len()),
    };
    let (token, after) = line.split_at(end);
    *rest = after;
    Some(token)
}
