//! Output of `pt check --measure`: what each effect holds and costs, as tables or JSON, and advice.

use serde_json::{Value, json};

use super::messages::broken;
use super::signals;
use crate::error::{Error, Result};
use crate::measure::effects::{CONFIDENCE, EffectFigures, EffectReport, Figure};
use crate::measure::format::{per_cent, two_digits};
use crate::measure::{Interval, Refusal};
use crate::render::Observer;

/// Width of the tables and sentences.
const COLUMNS: usize = 80;
/// Width of names, and of cells.
const NAME: usize = 26;
const CELL: usize = 17;

/// Ends the measurement on a signal.
pub struct Interrupts;

impl Observer for Interrupts {
    fn cancelled(&self) -> bool {
        signals::caught().is_some()
    }
}

/// The report of a measurement that was not interrupted.
///
/// # Errors
/// `Interrupted`.
pub fn finished(report: Option<EffectReport>) -> Result<EffectReport> {
    report.ok_or_else(|| Error::Interrupted(signals::caught().unwrap_or_default()))
}

/// Tables and advice.
pub fn text(report: &EffectReport) -> String {
    let EffectReport { size, samples, replicates, seconds, rows, .. } = report;
    let head = format!(
        "measured in {} s: {replicates} pictures of {} × {} pixels with {} each, and as many without each effect",
        two_digits(*seconds),
        size.x,
        size.y,
        samples_of(*samples)
    );
    let mut text = format!("{}\n\n", broken(&head, "", COLUMNS));
    text += &line("share in per cent", ["of the light", "of the noise", "of the time"].map(str::to_owned));
    for row in rows {
        text += &line(&row.name, [row.light, row.noise, row.time].map(|figure| cell(figure, share)));
    }
    text += &format!("\n{}", line("without it", ["mean, per cent", "picture, per cent", "price, ratio"].map(str::to_owned)));
    for row in rows.iter().filter(|row| row.mean.is_some()) {
        text += &line(&row.name, [cell(row.mean, share), cell(row.picture, ends_in_per_cent), cell(row.price, ratio)]);
    }
    let refusals = [
        (Refusal::HeavyTail, "a few pixels, or one picture, hold most of the noise, so that chance decides"),
        (Refusal::TooNoisy, Refusal::TooNoisy.words().1),
    ];
    let refused = |(refusal, _): &(Refusal, &str)| rows.iter().flat_map(all).any(|(_, figure)| figure == Some(Err(*refusal)));
    let refusals = refusals.into_iter().filter(refused).map(|(refusal, why)| format!("{}: {why}", refusal.words().0));
    let sure = per_cent(CONFIDENCE);
    let notes = [format!("intervals contain the true value with {sure} %; –: no change removes this effect alone")];
    notes
        .into_iter()
        .chain(refusals.map(|refusal| refusal.to_string()))
        .for_each(|note| text += &format!("\n{}", broken(&note, "", COLUMNS)));
    text += "\n\n";
    let advice = advice(report);
    advice.iter().for_each(|sentence| text += &format!("{}\n", broken(sentence, "", COLUMNS)));
    text
}

/// Sentences about what may be left out.
fn advice(report: &EffectReport) -> Vec<String> {
    let sentence = |row: &EffectFigures| {
        let [picture, time] = [row.picture, row.time].map(|figure| cell(figure, percentage));
        format!("{}: leaving it out changes the picture by {picture} and saves {time} of the time", row.name)
    };
    let (spp, noise) = report.noise_of_scene;
    let noise = noise.map(|noise| format!(", or than the noise of {}, {} %", samples_of(spp), per_cent(noise))).unwrap_or_default();
    let found: Vec<String> = report.dispensable().map(sentence).collect();
    let less = format!("less than 0.1 %{noise}");
    match found.is_empty() {
        true => vec![format!("nothing to leave out: no effect that takes time changes the picture by {less}")],
        false => std::iter::once(format!("may be left out, as the picture changes by {less}:")).chain(found).collect(),
    }
}

/// `1 sample`, `64 samples per pixel`.
fn samples_of(samples: u64) -> String {
    if samples == 1 { "a sample per pixel".into() } else { format!("{samples} samples per pixel") }
}

/// A row; a long name has a line of its own.
fn line(name: &str, cells: [String; 3]) -> String {
    let [a, b, c] = cells;
    let start = if name.chars().count() < NAME { format!("  {name:NAME$}") } else { format!("  {name}\n  {:NAME$}", "") };
    format!("{start}{a:CELL$} {b:CELL$} {c}\n")
}

/// A figure in words: `–` if there is none.
fn cell(figure: Option<Figure>, words: fn(Interval) -> String) -> String {
    match figure {
        None => "–".into(),
        Some(Err(refusal)) => refusal.words().0.into(),
        Some(Ok(interval)) => words(interval),
    }
}

/// A share in per cent: `62.4 ± 1.1`. Both have the digits of the second.
fn share(interval: Interval) -> String {
    const MOST_DIGITS: i32 = 3;
    let (value, half) = (100.0 * interval.value, 50.0 * (interval.high - interval.low));
    let digits = if half > 0.0 { (1 - half.log10().floor() as i32).clamp(0, MOST_DIGITS) } else { MOST_DIGITS };
    let rounded = |x: f64| format!("{x:.*}", digits as usize);
    match rounded(half).parse() {
        Ok(0.0) if half == 0.0 => two_digits(value),
        Ok(0.0) => format!("{} ± <0.001", rounded(value)),
        _ => format!("{} ± {}", rounded(value), rounded(half)),
    }
}

/// A ratio above 0 for a column: `0.88 (0.84–0.92)`, `<0.01`, `11 (9–15)`.
fn ratio(interval: Interval) -> String {
    let words = |x: f64| if x < 1.0 && x > 0.0 { format!("{x:.2}") } else { two_digits(x) };
    let Interval { value, low, high } = interval;
    if high > 0.0 && high < 0.01 { "<0.01".into() } else { format!("{} ({}–{})", words(value), words(low), words(high)) }
}

/// A share above 0 in per cent, as a ratio is written.
fn ends_in_per_cent(interval: Interval) -> String {
    ratio(interval.map(|x| 100.0 * x))
}

/// `1.2 % (1.1–1.3)`
fn percentage(interval: Interval) -> String {
    let [value, low, high] = [interval.value, interval.low, interval.high].map(per_cent);
    format!("{value} % ({low}–{high})")
}

/// All figures of a row with their names.
fn all(row: &EffectFigures) -> [(&'static str, Option<Figure>); 6] {
    let EffectFigures { light, noise, time, mean, picture, price, .. } = *row;
    [("light", light), ("noise", noise), ("time", time), ("mean", mean), ("picture", picture), ("price", price)]
}

/// One JSON object. A figure is an object with `value`, `low` and `high`, or with `refusal`, or null.
pub fn as_json(report: &EffectReport) -> String {
    let figure = |figure: Option<Figure>| match figure {
        None => Value::Null,
        Some(Ok(Interval { value, low, high })) => json!({ "value": value, "low": low, "high": high }),
        Some(Err(refusal)) => json!({ "refusal": refusal.words().0 }),
    };
    let row = |row: &EffectFigures| {
        let figures = all(row).map(|(name, found)| (name.to_owned(), figure(found)));
        std::iter::once(("name".to_owned(), row.name.clone().into())).chain(figures).collect::<serde_json::Map<_, _>>()
    };
    let (spp, noise) = report.noise_of_scene;
    let may_go: Vec<&str> = report.dispensable().map(|row| row.name.as_str()).collect();
    let whole = json!({
        "size": [report.size.x, report.size.y], "samples": report.samples, "replicates": report.replicates,
        "seconds": report.seconds, "confidence": CONFIDENCE, "spp": spp, "noise": noise,
        "effects": report.rows.iter().map(row).collect::<Vec<_>>(), "dispensable": may_go,
    });
    format!("{whole}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interval(value: f64, half: f64) -> Interval {
        Interval { value, low: value - half, high: value + half }
    }

    #[test]
    fn shares_have_the_digits_of_their_error() {
        for (value, half, text) in [
            (0.623_81, 0.0114, "62.4 ± 1.1"),
            (-0.384, 0.12, "-38 ± 12"),
            (0.000_212, 0.000_013, "0.021 ± 0.001"),
            (0.5, 1e-9, "50.000 ± <0.001"),
            (0.25, 0.0, "25"),
        ] {
            assert_eq!(share(interval(value, half)), text);
        }
    }

    #[test]
    fn ratios_are_short() {
        for (low, value, high, text) in [
            (0.84, 0.883, 0.921, "0.88 (0.84–0.92)"),
            (0.0, 0.02, 0.05, "0.02 (0–0.05)"),
            (0.001, 0.002, 0.003, "<0.01"),
            (0.0, 0.0, 0.0, "0 (0–0)"),
            (0.81, 1.26, 2.04, "1.3 (0.81–2)"),
        ] {
            assert_eq!(ratio(Interval { value, low, high }), text);
        }
    }

    fn report(picture: Interval, time: Interval) -> EffectReport {
        let figures = |name: &str, picture: Option<Figure>, time: Option<Figure>| {
            let some = Some(Ok(interval(-0.123_456, 1e-5)));
            EffectFigures {
                name: name.into(),
                light: Some(Err(Refusal::HeavyTail)),
                noise: some,
                time,
                mean: some,
                picture,
                price: picture,
            }
        };
        let rows = vec![
            figures("depth of field", Some(Ok(picture)), Some(Ok(time))),
            figures("smooth shadows of coarse meshes", Some(Ok(interval(0.5, 0.1))), None),
        ];
        let size = glam::UVec2::new(64, 48);
        EffectReport { size, samples: 8, replicates: 24, seconds: 4.9, noise_of_scene: (64, None), rows }
    }

    /// What is invisible with all uncertainty and saves time with all uncertainty may be left out, and nothing else. All fits into 80 columns.
    #[test]
    fn advice_leaves_out_what_is_invisible_and_takes_time() {
        let dispensable = report(interval(0.0002, 0.0002), interval(0.12, 0.04));
        let said = text(&dispensable);
        assert!(said.lines().all(|line| line.chars().count() <= COLUMNS), "{said}");
        assert!(said.contains("heavy tail: a few pixels,"), "{said}");
        let words = said.split_whitespace().collect::<Vec<_>>().join(" ");
        let advice = "depth of field: leaving it out changes the picture by 0.02 % (0–0.04) and saves 12 % (8–16) of the time";
        assert!(words.ends_with(advice), "{said}");
        for (picture, time) in [(interval(0.0002, 0.0009), interval(0.12, 0.04)), (interval(0.0002, 0.0), interval(0.12, 0.13))] {
            assert!(text(&report(picture, time)).contains("nothing to leave out"));
        }
        let noisy = EffectReport { noise_of_scene: (64, Some(0.03)), ..report(interval(0.01, 0.01), interval(0.12, 0.04)) };
        assert!(text(&noisy).contains("depth of field: leaving"), "less than the noise");
    }
}
