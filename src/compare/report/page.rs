//! The page `index.html`: one file that contains everything.

use super::pictures::pictures;
use super::plot::{self, last_error};
use crate::compare::{Comparison, Conclusion, CostKind, Method, Reference, TARGETS};
use crate::error::{Error, Result};
use crate::measure::Metric;
use crate::measure::error::EPSILON;
use crate::measure::format;
use crate::output;
use crate::output::page::{STYLE, VIEWER, fill, piece, script, xml};

const TEMPLATE: &str = include_str!("assets/page.html");
const LIVE_SCRIPT: &str = include_str!("assets/live.js");

/// Where a page is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// In the report's folder, beside its other files.
    Folder,
    /// In a browser while the comparison goes on, and after its end.
    Live {
        /// Number of this page among those that show the comparison.
        version: u64,
        /// Whether the comparison is over. FLIP is measured for the last page only, since it takes most of the time.
        is_last: bool,
    },
}

/// The page before the first report.
pub fn waiting(scene: &str) -> String {
    fill(include_str!("assets/waiting.html"), |name| match name {
        "scene" => xml(scene),
        "style" => STYLE.into(),
        "live" => live(0),
        "script" => LIVE_SCRIPT.into(),
        other => unreachable!("the page asks for {other}"),
    })
}

/// HTML of the progress display.
fn live(version: u64) -> String {
    include_str!("assets/live.html").replace("{{version}}", &version.to_string())
}

/// Returns the page.
pub fn html(comparison: &Comparison, place: Place) -> Result<String> {
    let has_flip = !matches!(place, Place::Live { is_last: false, .. });
    let version = if let Place::Live { version, .. } = place { Some(version) } else { None };
    let pictures =
        serde_json::to_string(&pictures(comparison, has_flip)).map_err(|e| Error::Internal(format!("cannot write JSON: {e}")))?;
    let value = |name: &str| match name {
        "scene" => xml(&comparison.scene),
        "style" => STYLE.into(),
        "dark" => include_str!("assets/dark.css").into(),
        "conclusions" => comparison.conclusions.iter().map(conclusion).collect(),
        "provenance" => provenance(comparison),
        "reference" => reference(comparison),
        "confidence" => format::per_cent(comparison.confidence),
        "targets" => TARGETS.iter().map(|t| format!("<th scope=\"col\">{} %</th>\n", format::per_cent(*t))).collect(),
        "methods" => (0..comparison.methods.len()).map(|index| row(comparison, index)).collect(),
        "measures" => measures(comparison),
        "plots" => plot::elements(comparison).iter().map(figure).collect(),
        "epsilon" => EPSILON.to_string(),
        "pictures" => script(&pictures),
        "script" => VIEWER.into(),
        "live" => version.map(live).unwrap_or_default(),
        "live-script" => version.map_or("", |_| LIVE_SCRIPT).into(),
        "files" => files(place).into(),
        other => piece(other).unwrap_or_else(|| unreachable!("the page asks for {other}")).into(),
    };
    Ok(fill(TEMPLATE, value))
}

/// Where the numbers of the page are.
fn files(place: Place) -> &'static str {
    match place {
        Place::Folder => {
            "All numbers: <a href=\"convergence.csv\">convergence.csv</a>, <a href=\"convergence.json\">convergence.json</a>; plots: \
             <a href=\"plots/\">plots/</a>."
        }
        Place::Live { .. } => "All numbers and plots are in the folder of the report when the comparison is over.",
    }
}

fn reference(comparison: &Comparison) -> String {
    let Reference { origin, error, .. } = &comparison.reference;
    let subtracted = if error.is_some_and(|error| error.refusal().is_none()) { ", subtracted" } else { "" };
    format!("{}, {}{subtracted}", xml(origin), unbroken(&comparison.reference.own_error(comparison.confidence)))
}

/// Text that no line break can divide between a number and its unit.
fn unbroken(text: &str) -> String {
    let mut joined = String::with_capacity(text.len());
    for word in text.split(' ') {
        let is_unit =
            matches!(word.trim_end_matches(['.', ',', ';', ':', ')', '?']), "%" | "s" | "ms" | "min" | "h" | "days" | "years" | "spp");
        if !joined.is_empty() {
            joined.push(if is_unit && joined.ends_with(|c: char| c.is_ascii_digit()) { '\u{a0}' } else { ' ' });
        }
        joined.push_str(word);
    }
    joined
}

/// Sentence, with its command behind a word that opens it.
fn conclusion(Conclusion { text, command }: &Conclusion) -> String {
    let details =
        command.as_deref().map_or(String::new(), |text| format!("<details><summary>Command</summary>{}</details>\n", command_line(text)));
    format!("<p>{}</p>\n{details}", xml(&unbroken(text)))
}

/// Command with a button that copies it.
fn command_line(text: &str) -> String {
    format!("<span class=\"command\"><code>{0}</code><button data-copy aria-label=\"Copy the command {0}\">Copy</button></span>", xml(text))
}

/// Facts about how the comparison was made; empty if nothing is known.
fn provenance(comparison: &Comparison) -> String {
    let made = &comparison.provenance;
    if made.command.is_empty() {
        return String::new();
    }
    let row = |name: &str, value: &str| format!("<dt>{name}</dt><dd>{value}</dd>\n");
    let mut rows = row("Command", &command_line(&made.command));
    rows += &row("Repeat it", &command_line("pt compare --replay convergence.json"));
    rows.extend(made.facts().iter().map(|(name, value)| row(name, &xml(value))));
    rows.extend(
        comparison.methods.iter().map(|method| row(&format!("Hash of {}", xml(&method.name)), &output::hash(&method.image).to_string())),
    );
    format!(
        "<section aria-labelledby=\"made-title\">\n<h2 id=\"made-title\">How it was made</h2>\n<dl id=\"made\">\n{rows}</dl>\n</section>\n"
    )
}

fn figure([wide, narrow]: &[String; 2]) -> String {
    format!("<figure><div class=\"wide\">{wide}</div><div class=\"narrow\">{narrow}</div></figure>\n")
}

/// Row of the table for one method.
fn row(comparison: &Comparison, index: usize) -> String {
    let method = &comparison.methods[index];
    let cell =
        |class: &str, label: &str, value: String| format!("<td class=\"{class}\" data-label=\"{label}\"><span>{value}</span></td>\n");
    let mut cells = cell("", "Sampler", xml(&method.sampler));
    cells += &cell("", "Error at the end", last(comparison, method));
    cells += &cell("", "Slope", method.slope.map_or("–".into(), plot::slope));
    for (i, target) in TARGETS.into_iter().enumerate() {
        let class = if is_cheapest(comparison, index, i) { "price best" } else { "price" };
        cells += &cell(class, &format!("Time to {} %", format::per_cent(target)), price(method, i));
    }
    let bias = method.bias.map(|(bias, deviation)| format!("{} ± {} %", format::per_cent(bias), format::per_cent(deviation)));
    let bound = || method.bias_bound.map_or(String::new(), |bound| format!(" <small>below {} %</small>", format::per_cent(bound)));
    let unseen = || if method.bias_bound.is_some() { format!("none seen{}", bound()) } else { "not known".into() };
    cells += &cell("", "Bias", bias.unwrap_or_else(unseen));
    let lacks = if !method.files.is_empty() {
        "not known".into()
    } else if method.lacks.is_empty() {
        "nothing".into()
    } else {
        xml(&method.lacks)
    };
    cells += &cell("lacks", "Leaves out", lacks);
    let swatch = format!("<i class=\"swatch f-m{}\"></i>", index % 6);
    format!("<tr><th scope=\"row\">{swatch}{}</th>\n{cells}</tr>\n", xml(&method.name))
}

/// Table of the additional error measures after the last checkpoint; empty if there are none.
fn measures(comparison: &Comparison) -> String {
    if comparison.metrics.is_empty() {
        return String::new();
    }
    let names: String = comparison.metrics.iter().map(|metric| format!("<th scope=\"col\">{}</th>", xml(&metric.name()))).collect();
    let cell = |(metric, (value, error)): (&Metric, &(f64, f64))| {
        let label = xml(&metric.name());
        format!("<td data-label=\"{label}\"><span>{} <small>± {}</small></span></td>", format::number(*value, 4), format::number(*error, 2))
    };
    let row = |(index, method): (usize, &Method)| {
        let others = method.curve.last().map_or(&[][..], |last| &last.others);
        let cells: String = comparison.metrics.iter().zip(others).map(cell).collect();
        format!("<tr><th scope=\"row\"><i class=\"swatch f-m{}\"></i>{}</th>{cells}</tr>\n", index % 6, xml(&method.name))
    };
    let rows: String = comparison.methods.iter().enumerate().map(row).collect();
    let formulas: String = comparison.metrics.iter().map(|m| format!("<li>{}: {}</li>\n", xml(&m.name()), xml(&m.formula()))).collect();
    format!(
        "<section aria-labelledby=\"measures-title\">\n<h2 id=\"measures-title\">Other measures, at the end</h2>\n<table class=\"measures\">\n\
         <thead><tr><th scope=\"col\">Method</th>{names}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table>\n<ul class=\"facts\">\n{formulas}</ul>\n</section>\n"
    )
}

/// Error after the last checkpoint, its interval, samples and time.
fn last(comparison: &Comparison, method: &Method) -> String {
    let last = match last_error(comparison, method) {
        Ok(last) => last,
        Err(reason) => return reason.into(),
    };
    let [error, low, high] = [last.error, last.low, last.high].map(format::per_cent);
    let interval = if low == high { String::new() } else { format!("{low}–{high} %<br>") };
    let samples = last.samples.map_or(String::new(), |samples| format!("{samples} spp, "));
    format!("{error} % <small>{interval}{samples}{}</small>", format::duration(last.seconds))
}

fn price(method: &Method, i: usize) -> String {
    let cost = match method.prices.get(i) {
        Some(Ok(cost)) => cost,
        Some(Err(reason)) => return format!("<small>{}</small>", reason.name()),
        None => return "–".into(),
    };
    // A line may break between two times, but not within one.
    let [seconds, interval] =
        [format::duration(cost.seconds), format::between(cost.low, cost.high)].map(|text| text.replace(' ', "\u{a0}"));
    match cost.kind {
        CostKind::Measured => format!("{seconds} <small>{interval}</small>"),
        CostKind::Extrapolated => format!("<span title=\"extrapolated\">≈ {seconds}</span> <small>{interval}</small>"),
        CostKind::AtMost => format!("<span title=\"the first checkpoint is there already\">&lt; {seconds}</span>"),
    }
}

fn is_cheapest(comparison: &Comparison, index: usize, i: usize) -> bool {
    let costs = || comparison.methods.iter().filter_map(|method| method.prices.get(i)?.ok());
    // A bound may be far above the true time, so that it is not ranked.
    if costs().any(|cost| cost.kind == CostKind::AtMost) {
        return false;
    }
    let seconds = |method: &Method| method.prices.get(i).and_then(|price| price.ok()).map(|cost| cost.seconds);
    let least = comparison.methods.iter().filter_map(seconds).min_by(f64::total_cmp);
    comparison.methods.len() > 1 && least.is_some() && seconds(&comparison.methods[index]) == least
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_stay_with_their_numbers() {
        assert_eq!(unbroken("a 1 % b 2 min 3 s, is s"), "a 1\u{a0}% b 2\u{a0}min 3\u{a0}s, is s");
    }
}
