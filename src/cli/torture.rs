//! `pt torture`: puts hard cases with exact answers to the renderer's own functions.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use super::messages::indented;
use super::parse::threads;
use super::{VERSION, print_stdout, render};
use crate::error::{Error, Result};
use crate::measure::format::duration;
use crate::output;
use crate::torture::{Effort, Record, Row, TABLES, Verdict, csv, html, json, markdown, number, worst_share};

#[derive(clap::Args, Debug)]
pub struct TortureArgs {
    /// Few tries, and no slow cases: about a minute on two cores.
    #[arg(long, conflicts_with = "full")]
    pub quick: bool,
    /// 10⁸ rays of each kind and means to 0.1 %: hours.
    #[arg(long)]
    pub full: bool,
    /// Only these rows: F2, or G* for all that begin with G. May be given several times.
    #[arg(long, value_name = "ID")]
    pub only: Vec<String>,
    /// Print every case, and not only rows and failures.
    #[arg(short, long)]
    pub verbose: bool,
    /// Stop after the first row that fails.
    #[arg(long)]
    pub fail_fast: bool,
    /// List the rows without running them.
    #[arg(long)]
    pub list: bool,
    /// Output file: a page (.html), all cases as .json or .csv, or a table of the rows as .md.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Number of threads. Default: all cores. The answers do not depend on it.
    #[arg(short, long, env = "PT_THREADS", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<u32>,
}

/// Runs the command. Exit code 1 if any case fails.
pub fn torture(args: &TortureArgs) -> Result<ExitCode> {
    let form = args.output.as_ref().map(|path| Form::of(path)).transpose()?;
    args.output.as_deref().map(output::check_folder).transpose()?;
    let effort = match (args.quick, args.full) {
        (true, _) => Effort::Quick,
        (_, true) => Effort::Full,
        _ => Effort::Standard,
    };
    let tables: Vec<(&str, Vec<Row>)> = TABLES
        .iter()
        .map(|table| (table.subject, (table.rows)().into_iter().filter(|row| args.is_asked(row.id)).collect()))
        .filter(|(_, rows): &(_, Vec<Row>)| !rows.is_empty())
        .collect();
    if tables.is_empty() {
        let ids: Vec<&str> = TABLES.iter().flat_map(|table| (table.rows)()).map(|row| row.id).collect();
        return Err(Error::Usage(format!("--only {}: no such row, expected one of {}", args.only.join(" --only "), ids.join(" "))));
    }
    if args.list {
        let lines = tables.iter().flat_map(|(subject, rows)| [format!("{subject}\n")].into_iter().chain(rows.iter().map(listed)));
        return print_stdout(&lines.collect::<String>()).map(|()| ExitCode::SUCCESS);
    }
    render::pool(args.threads)?.install(|| run(args, effort, form, &tables))
}

impl TortureArgs {
    /// Whether a row is to be run. A star stands for any characters.
    fn is_asked(&self, id: &str) -> bool {
        let fits = |pattern: &String| match pattern.split_once('*') {
            None => id.eq_ignore_ascii_case(pattern),
            Some((start, end)) => {
                let (id, start, end) = (id.to_ascii_uppercase(), start.to_ascii_uppercase(), end.to_ascii_uppercase());
                id.len() >= start.len() + end.len() && id.starts_with(&start) && id.ends_with(&end)
            }
        };
        self.only.is_empty() || self.only.iter().any(fits)
    }
}

/// Kind of an output file.
#[derive(Clone, Copy)]
enum Form {
    Json,
    Csv,
    Markdown,
    Page,
}

impl Form {
    fn of(path: &Path) -> Result<Form> {
        let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
        match extension.as_ref().and_then(|extension| extension.to_str()) {
            Some("json") => Ok(Form::Json),
            Some("csv") => Ok(Form::Csv),
            Some("md") => Ok(Form::Markdown),
            Some("html") => Ok(Form::Page),
            _ => Err(Error::Usage(format!("{}: expected a name that ends in .html, .json, .csv or .md", path.display()))),
        }
    }
}

fn run(args: &TortureArgs, effort: Effort, form: Option<Form>, tables: &[(&str, Vec<Row>)]) -> Result<ExitCode> {
    let start = Instant::now();
    print_stdout("  row  verdict  cases  error*  what\n")?;
    let (mut records, mut missing) = (vec![], vec![]);
    'tables: for (subject, rows) in tables {
        print_stdout(&format!("{subject}\n"))?;
        for row in rows {
            if row.cases.is_empty() {
                missing.push(row);
                print_stdout(&line(row, Verdict::NotYet, 0, None))?;
                continue;
            }
            let first = records.len();
            records.extend(row.ask(effort));
            print_stdout(&row_text(row, &records[first..], args.verbose))?;
            if args.fail_fast && records[first..].iter().any(|record| record.verdict() == Verdict::Fails) {
                break 'tables;
            }
        }
    }
    let failed = records.iter().filter(|record| record.verdict() == Verdict::Fails).count();
    let verdict = match failed {
        0 => format!("all {} cases hold", records.len()),
        _ => format!("{failed} of {} cases FAIL", records.len()),
    };
    let not_yet = match missing.len() {
        0 => String::new(),
        1 => "; 1 row is not yet tested".to_owned(),
        count => format!("; {count} rows are not yet tested"),
    };
    let took = duration(start.elapsed().as_secs_f64());
    if let (Some(path), Some(form)) = (&args.output, form) {
        let text = match form {
            Form::Json => json(VERSION, effort, &records, &missing),
            Form::Csv => csv(&records, &missing),
            Form::Markdown => markdown(&records, &missing),
            Form::Page => {
                let facts = format!("Effort: {}, in {took}.", format!("{effort:?}").to_lowercase());
                html(&format!("pt {VERSION}"), &format!("{verdict}{not_yet}"), &facts, tables, &records)
            }
        };
        output::replace(path, text.as_bytes())?;
    }
    print_stdout(&format!("* greatest error of a row's cases, in per cent of what its tolerance permits\n{verdict}{not_yet} ({took})\n"))?;
    Ok(if failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Line of a row in the list.
fn listed(row: &Row) -> String {
    let word = if row.cases.is_empty() { format!(" ({})", Verdict::NotYet.word()) } else { String::new() };
    indented(&format!("  {:<5}", row.id), &format!("{}{word}", row.what))
}

/// Line of a row with its result and the number of its cases; `worst` is the greatest error as a share of the tolerance.
fn line(row: &Row, verdict: Verdict, cases: usize, worst: Option<f64>) -> String {
    let cases = if cases == 0 { String::new() } else { cases.to_string() };
    let text = |share: f64| match share {
        _ if share.is_nan() => "–".into(),
        _ if share > 9.99 => ">999 %".into(),
        _ => format!("{:.0} %", 100.0 * share),
    };
    let worst = worst.map_or(String::new(), text);
    indented(&format!("  {:<5}{:<9}{cases:>5}{worst:>8}  ", row.id, verdict.word()), row.what)
}

/// Line of a row, and lines of its failures or, if `verbose`, of all its cases.
fn row_text(row: &Row, records: &[Record], verbose: bool) -> String {
    let fails = records.iter().any(|record| record.verdict() == Verdict::Fails);
    let mut text = line(row, if fails { Verdict::Fails } else { Verdict::Holds }, records.len(), worst_share(records));
    for record in records.iter().filter(|record| verbose || record.verdict() == Verdict::Fails) {
        text += &case_text(record);
    }
    if fails || verbose {
        let peers = if row.peers.is_empty() { String::new() } else { format!("; elsewhere: {}", row.peers) };
        text += &indented("       ", &format!("tolerance: {}{peers}", row.reason));
    }
    text
}

fn case_text(record: &Record) -> String {
    let Record { case, answer, .. } = record;
    let mut text = format!("       {:<45} {}\n", case.setup, record.verdict().word());
    text += &if answer.tries > 1 && answer.tolerance == 0.0 {
        format!("         {} of {} tries fail\n", answer.found, answer.tries)
    } else {
        let error = answer.error(case.expected);
        let samples = if answer.tries > 1 { format!(", {} samples", answer.tries) } else { String::new() };
        let (expected, found) = (number(case.expected), number(answer.found));
        format!("         expected {expected}, found {found}: error {error:.1e} of {:.1e}{samples}\n", answer.tolerance)
    };
    if !answer.note.is_empty() {
        text += &indented("         ", &answer.note);
    }
    text
}
