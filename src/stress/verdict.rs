//! What is to be said of a change, and the sentence about all of them.

use super::{Change, Edit, Found, Outcome, Range};
use crate::measure::format::per_cent;

/// Share of the paths that may meet another surface: at the outlines of shapes, rounding decides which.
const OTHER_SURFACES: f64 = 1e-2;

/// Share of the lines that may pass through one side of a closed shape, in addition to those of the scene as it is: where faces of three
/// shapes coincide, a line may find two of them only.
const BROKEN_LINES: f64 = 1e-3;

/// What is to be said of a change.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// The picture and the rays are the same.
    Same,
    /// Something differs: each sentence says what.
    Differs(Vec<String>),
    /// The changed scene cannot be built, for this reason.
    Refused(String),
}

impl Verdict {
    /// The verdict on what was found.
    ///
    /// - `paths`: the number of paths, and of lines
    pub fn of(change: &Change, found: &Found, paths: u64) -> Verdict {
        let Found { pictures, paths: rays, invalid, shown, warnings, .. } = found;
        let mut said = vec![];
        let mut say = |is_said: bool, text: String| said.extend(is_said.then_some(text));
        let worst = rays.worst.as_deref().unwrap_or("?");
        say(*invalid > 0, format!("{invalid} samples are no numbers"));
        say(change.keeps_bits && !pictures.same_bits, "the picture does not have the same bits".into());
        if pictures.tiles > 0 {
            let percent = per_cent(pictures.tile.abs());
            let word = if pictures.tile > 0.0 { "brighter" } else { "darker" };
            let objects = if shown.is_empty() { String::new() } else { format!(" ({})", first_three(shown)) };
            let others = if pictures.tiles > 1 { format!(", and {} more tiles differ", pictures.tiles - 1) } else { String::new() };
            say(true, format!("the tile at pixel {},{} is {percent} % {word}{objects}{others}", pictures.at.x, pictures.at.y));
        } else {
            let percent = per_cent(pictures.whole.0.abs());
            let word = if pictures.whole.0 > 0.0 { "brighter" } else { "darker" };
            say(pictures.is_whole, format!("the whole picture is {percent} % {word}"));
        }
        say(rays.self_hits > 0, format!("{} rays hit the surface that they leave, most of them on {worst}", rays.self_hits));
        let share = rays.broken as f64 / paths as f64;
        // In another order a line may meet the other one of two faces that coincide.
        let is_judged = change.edit != Edit::Reverse;
        say(
            is_judged && share > BROKEN_LINES,
            format!("{} lines pass through a closed shape on one side only, most of them {worst}", rays.broken),
        );
        let share = rays.others as f64 / paths as f64;
        say(share > OTHER_SURFACES, format!("{} % of the paths meet another surface", per_cent(share)));
        if said.is_empty() {
            return Verdict::Same;
        }
        said.extend(warnings.iter().map(|warning| format!("pt warns: {warning}")));
        Verdict::Differs(said)
    }

    /// Whether the picture and the rays are the same.
    pub fn is_same(&self) -> bool {
        *self == Verdict::Same
    }
}

fn first_three(names: &[String]) -> String {
    let more = if names.len() > 3 { ", …" } else { "" };
    names.iter().take(3).cloned().collect::<Vec<_>>().join(", ") + more
}

/// The sentence about all changes: within what the scene is safe, and what to do.
pub fn sentence(scene: &str, outcomes: &[Outcome]) -> String {
    let as_it_is = outcomes.iter().find(|outcome| outcome.change.edit == Edit::None).map(|outcome| &outcome.verdict);
    if let Some(Verdict::Differs(said)) = as_it_is {
        return format!("{scene} is not safe as it is: {}.", said.join("; "));
    }
    let [sizes, distances, far] = [Range::Size, Range::Distance, Range::FarObject].map(|kind| safe(outcomes, kind));
    let mut clauses = vec![];
    clauses.extend(sizes.map(|(low, high)| format!("from {low:e} to {high:e} times its size")));
    clauses.extend(distances.map(|(_, high)| format!("up to {high:e} diameters from the origin")));
    clauses.extend(far.map(|(_, high)| format!("with objects up to {high:e} diameters away")));
    let others: Vec<&str> = outcomes
        .iter()
        .filter(|outcome| outcome.change.range.is_none() && !outcome.verdict.is_same())
        .map(|outcome| outcome.change.name.as_str())
        .collect();
    let mut text = match clauses.split_last() {
        None if others.is_empty() => return format!("{scene} is safe under all changes that were tried."),
        None => String::new(),
        Some((last, [])) => format!("{scene} is safe {last}. "),
        Some((last, rest)) => format!("{scene} is safe {}, and {last}. ", rest.join(", ")),
    };
    if !others.is_empty() {
        text += &format!("It is not safe when {}. ", others.join(", or "));
    }
    for (kind, remedy) in [
        (Range::Size, "choose a unit of length in which the scene is within that range"),
        (Range::Distance, "move the scene to the origin"),
        (Range::FarObject, "bring far objects nearer and make them smaller, or put their light into the background"),
    ] {
        if outcomes.iter().any(|outcome| outcome.change.range.is_some_and(|(k, _)| k == kind) && !outcome.verdict.is_same()) {
            text += &format!("Beyond: {remedy}. ");
        }
    }
    text.trim_end().into()
}

/// The range around the scene as it is in which every change of a kind leaves the scene the same; `None` if none was tried.
fn safe(outcomes: &[Outcome], kind: Range) -> Option<(f64, f64)> {
    let mut tried: Vec<(f64, bool)> = outcomes
        .iter()
        .filter_map(|outcome| outcome.change.range.filter(|(k, _)| *k == kind).map(|(_, at)| (at, outcome.verdict.is_same())))
        .collect();
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    let start = if kind == Range::Size { 1.0 } else { 0.0 };
    let up = tried.iter().filter(|(at, _)| *at > start).take_while(|(_, is_same)| *is_same).map(|(at, _)| *at).last();
    let down = tried.iter().rev().filter(|(at, _)| *at < start).take_while(|(_, is_same)| *is_same).map(|(at, _)| *at).last();
    (!tried.is_empty()).then(|| (rounded(down.unwrap_or(start)), rounded(up.unwrap_or(start))))
}

/// Powers of two are told as the power of ten within them.
fn rounded(at: f64) -> f64 {
    if at == 0.0 { at } else { 10f64.powi((at.log10() + if at > 1.0 { 1e-9 } else { -1e-9 }) as i32) }
}
