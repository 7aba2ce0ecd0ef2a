//! Answers as a page: one HTML file that contains everything.

use super::report::{number, worst_share};
use super::{Record, Row, Verdict};
use crate::output::page::{STYLE, fill, xml};

const TEMPLATE: &str = include_str!("assets/page.html");

/// The page.
///
/// - `program`: name and version
/// - `sentence`: what was found
/// - `facts`: how it was made, in a sentence
/// - `tables`: the rows by subject; those without cases are told as missing
pub fn html(program: &str, sentence: &str, facts: &str, tables: &[(&str, Vec<Row>)], records: &[Record]) -> String {
    fill(TEMPLATE, |name| match name {
        "style" => STYLE.into(),
        "program" => xml(program),
        "sentence" => xml(sentence),
        "facts" => xml(facts),
        "failing" => failing(records),
        "tables" => tables.iter().map(|(subject, rows)| table(subject, rows, records)).collect(),
        other => unreachable!("the page asks for {other}"),
    })
}

/// The answers of a row.
fn of_row<'r, 'a>(row: &Row, records: &'r [Record<'a>]) -> &'r [Record<'a>] {
    let all = records.chunk_by(|a, b| a.row.id == b.row.id);
    all.into_iter().find(|of_row| of_row[0].row.id == row.id).unwrap_or_default()
}

/// Links to the rows that fail.
fn failing(records: &[Record]) -> String {
    let rows = records.chunk_by(|a, b| a.row.id == b.row.id).filter(|of_row| !all_hold(of_row)).map(|of_row| of_row[0].row);
    let links: String = rows.map(|row| format!("<li><a href=\"#{0}\">{0}: {1}</a></li>\n", row.id, xml(row.what))).collect();
    if links.is_empty() { links } else { format!("<ul>\n{links}</ul>\n") }
}

fn all_hold(records: &[Record]) -> bool {
    records.iter().all(|record| record.verdict() == Verdict::Holds)
}

fn table(subject: &str, rows: &[Row], records: &[Record]) -> String {
    let rows: String = rows.iter().map(|row| row_of(row, of_row(row, records))).collect();
    let columns = ["row", "what", "verdict", "greatest error"].map(|name| format!("<th scope=\"col\">{name}</th>")).concat();
    format!(
        "<section>\n<h2>{}</h2>\n<table class=\"rows\">\n<thead><tr>{columns}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table>\n</section>\n",
        xml(subject)
    )
}

fn row_of(row: &Row, records: &[Record]) -> String {
    let verdict = match records {
        [] if row.cases.is_empty() => Verdict::NotYet,
        [] => return String::new(),
        _ if all_hold(records) => Verdict::Holds,
        _ => Verdict::Fails,
    };
    let (class, open) = match verdict {
        Verdict::Holds => ("holds", ""),
        Verdict::Fails => ("fails", " open"),
        Verdict::NotYet => ("missing", ""),
    };
    let share = match worst_share(records) {
        Some(share) if share.is_finite() => {
            format!("{:.0} %<span class=\"bar\"><i style=\"width: {:.0}%\"></i></span>", 100.0 * share, (100.0 * share).min(100.0))
        }
        _ => String::new(),
    };
    let details = if records.is_empty() { String::new() } else { details(row, records, open) };
    format!(
        "<tr id=\"{0}\" class=\"{class}\"><th scope=\"row\">{0}</th><td class=\"what\">{1}{details}</td>\
         <td class=\"verdict\">{2}</td><td class=\"share\">{share}</td></tr>\n",
        row.id,
        xml(row.what),
        verdict.word()
    )
}

/// The cases of a row, behind a word that opens them.
fn details(row: &Row, records: &[Record], open: &str) -> String {
    let count = if records.len() == 1 { "1 case".to_owned() } else { format!("{} cases", records.len()) };
    let columns = ["case", "expected", "found", "error", "permitted", "tries", "verdict", ""];
    let columns = columns.map(|name| format!("<th scope=\"col\">{name}</th>")).concat();
    let cases: String = records.iter().map(case).collect();
    let peers = if row.peers.is_empty() { String::new() } else { format!("<p>Elsewhere: {}</p>", xml(row.peers)) };
    format!(
        "<details{open}><summary>{count}</summary><div class=\"scroll\"><table class=\"cases\"><thead><tr>{columns}</tr></thead>\n\
         <tbody>\n{cases}</tbody></table></div><p>Tolerance: {}</p>{peers}</details>",
        xml(row.reason)
    )
}

fn case(record: &Record) -> String {
    let Record { case, answer, .. } = record;
    let error = answer.error(case.expected);
    let tries = if answer.tries > 1 { answer.tries.to_string() } else { String::new() };
    let cells = [
        number(case.expected),
        number(answer.found),
        format!("{error:.1e}"),
        format!("{:.1e}", answer.tolerance),
        tries,
        record.verdict().word().to_owned(),
    ];
    let cells = cells.map(|cell| format!("<td>{cell}</td>")).concat();
    let class = if record.verdict() == Verdict::Holds { "holds" } else { "fails" };
    let (setup, note) = (xml(&case.setup), xml(&answer.note));
    format!("<tr class=\"{class}\"><th scope=\"row\">{setup}</th>{cells}<td class=\"note\">{note}</td></tr>\n")
}
