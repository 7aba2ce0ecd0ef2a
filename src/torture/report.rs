//! Answers as JSON, as comma-separated values, and as a table in Markdown.

use serde_json::{Value, json};

use super::{Answer, Case, Effort, Row, Verdict};

/// A case with its answer.
pub struct Record<'a> {
    /// The row.
    pub row: &'a Row,
    /// The case.
    pub case: &'a Case,
    /// The answer.
    pub answer: Answer,
}

impl Record<'_> {
    /// Whether the case holds.
    pub fn verdict(&self) -> Verdict {
        self.answer.verdict(self.case.expected)
    }
}

impl Verdict {
    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Holds => "holds",
            Verdict::Fails => "FAILS",
            Verdict::NotYet => "not yet",
        }
    }
}

/// Greatest error of some cases, as a share of what their tolerance permits; `None` where nothing may differ.
pub fn worst_share(records: &[Record]) -> Option<f64> {
    let shares = records.iter().filter(|record| record.answer.tolerance > 0.0);
    shares.map(|record| record.answer.error(record.case.expected) / record.answer.tolerance).reduce(f64::max)
}

/// A number with ten digits.
pub fn number(x: f64) -> String {
    if x == 0.0 || (1e-3..1e7).contains(&x.abs()) {
        format!("{:.10}", x).trim_end_matches('0').trim_end_matches('.').into()
    } else {
        format!("{x:.9e}")
    }
}

/// One JSON object: the program, the effort, and a list of all cases. Numbers that JSON does not have are null.
pub fn json(version: &str, effort: Effort, records: &[Record], missing: &[&Row]) -> String {
    let number = |x: f64| if x.is_finite() { json!(x) } else { Value::Null };
    let case = |record: &Record| {
        let Record { row, case, answer } = record;
        json!({
            "id": row.id, "what": row.what, "setup": case.setup, "expected": number(case.expected), "found": number(answer.found),
            "error": number(answer.error(case.expected)), "tolerance": number(answer.tolerance), "reason": row.reason,
            "tries": answer.tries, "note": answer.note, "peers": row.peers, "verdict": record.verdict().word(),
        })
    };
    let not_yet = |row: &&Row| json!({ "id": row.id, "what": row.what, "verdict": Verdict::NotYet.word() });
    let cases: Vec<Value> = records.iter().map(case).chain(missing.iter().map(not_yet)).collect();
    let report = json!({ "pt": version, "effort": format!("{effort:?}").to_lowercase(), "cases": cases });
    format!("{report:#}\n")
}

/// One line for each case: id, what, setup, expected, found, error, tolerance, tries, verdict, note.
pub fn csv(records: &[Record], missing: &[&Row]) -> String {
    let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    let mut text = "id,what,setup,expected,found,error,tolerance,tries,verdict,note\n".to_owned();
    for record in records {
        let Record { row, case, answer } = record;
        let (what, setup, note) = (quoted(row.what), quoted(&case.setup), quoted(&answer.note));
        let (found, error) = (answer.found, answer.error(case.expected));
        let numbers = format!("{},{found},{error:e},{:e},{}", case.expected, answer.tolerance, answer.tries);
        text += &format!("{},{what},{setup},{numbers},{},{note}\n", row.id, record.verdict().word());
    }
    for row in missing {
        text += &format!("{},{},,,,,,,{},\n", row.id, quoted(row.what), Verdict::NotYet.word());
    }
    text
}

/// One table with a line for each row: its cases, how often was tried, the greatest error and what others reach.
pub fn markdown(records: &[Record], missing: &[&Row]) -> String {
    let plain = |text: &str| text.replace('|', "\\|");
    let mut text =
        "| row | what | cases | tries | greatest error | allowed, and why | elsewhere |\n|---|---|---|---|---|---|---|\n".to_owned();
    for of_row in records.chunk_by(|a, b| a.row.id == b.row.id) {
        let row = of_row[0].row;
        let tries: u64 = of_row.iter().map(|record| record.answer.tries).sum();
        let tries = if tries == of_row.len() as u64 { String::new() } else { format!("{:.1e}", tries as f64) };
        // Of the case that comes nearest to what it is allowed; among counts, the sum of all failures.
        let counts = of_row.iter().filter(|record| record.answer.tolerance == 0.0).map(|record| record.answer.error(record.case.expected));
        let share = |record: &&Record| record.answer.error(record.case.expected) / record.answer.tolerance;
        let numbers = of_row.iter().filter(|record| record.answer.tolerance > 0.0);
        let (errors, allowed) = match numbers.max_by(|a, b| share(a).total_cmp(&share(b))) {
            Some(worst) => (format!("{:.1e}", worst.answer.error(worst.case.expected)), format!("{:.1e}: ", worst.answer.tolerance)),
            None => (format!("{} fail", counts.sum::<f64>()), String::new()),
        };
        let fails = if of_row.iter().any(|record| record.verdict() != Verdict::Holds) { " **FAILS**" } else { "" };
        let (what, reason, peers) = (plain(row.what), plain(row.reason), plain(row.peers));
        text += &format!("| {} | {what} | {} | {tries} | {errors}{fails} | {allowed}{reason} | {peers} |\n", row.id, of_row.len());
    }
    for row in missing {
        text += &format!("| {} | {} | | | {} | | |\n", row.id, plain(row.what), Verdict::NotYet.word());
    }
    text
}
