//! `pt torture` itself: all rows hold, and a wrong answer is told.
//!
//! The tables are tests of their own here, so that they run in parallel, with the tries of a quick run or more.

use std::process::{Command, Output};

use pt::torture::{Answer, Effort, Failures, Row, TABLES, Verdict, csv, html, json, markdown};

/// Asserts that all cases of the table that begins with this row hold.
fn assert_holds(first: &str, effort: Effort) {
    let rows = TABLES.iter().map(|table| (table.rows)()).find(|rows| rows[0].id == first).expect("a table");
    let records = rows.iter().flat_map(|row| row.ask(effort));
    let wrong = records.filter(|record| record.verdict() != Verdict::Holds);
    let told: Vec<String> =
        wrong.map(|record| format!("{} {}: {} {:?}", record.row.id, record.case.setup, record.case.expected, record.answer)).collect();
    assert!(told.is_empty(), "{}", told.join("\n"));
}

#[test]
fn fresnel() {
    assert_holds("F1", Effort::Standard);
}

#[test]
fn glass() {
    assert_holds("O1", Effort::Standard);
}

#[test]
fn cameras() {
    assert_holds("W19", Effort::Standard);
}

#[test]
fn radiometry() {
    assert_holds("W1", Effort::Standard);
}

#[test]
fn media() {
    assert_holds("V1", Effort::Quick);
}

#[test]
fn materials() {
    assert_holds("M1", Effort::Quick);
}

#[test]
fn intersection() {
    assert_holds("G1", Effort::Quick);
}

#[test]
fn stability() {
    assert_holds("S1", Effort::Quick);
}

#[test]
fn transforms() {
    assert_holds("T1", Effort::Standard);
}

#[test]
fn samplers() {
    assert_holds("R1", Effort::Quick);
}

#[test]
fn lights() {
    assert_holds("L5", Effort::Quick);
}

fn pt(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pt")).arg("torture").args(args).output().expect("a run")
}

/// Rows have identifiers of their own.
#[test]
fn rows_have_different_identifiers() {
    let mut ids: Vec<&str> = TABLES.iter().flat_map(|table| (table.rows)()).map(|row| row.id).collect();
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), count, "{ids:?}");
}

/// A wrong number, no number, and a single failure are told; where nothing was tried the case fails.
#[test]
fn wrong_answers_fail() {
    let row = Row::new("Z1", "answers of a test, \"quoted\"", "exact")
        .number("right", 1.0, 0.0, || 1.0)
        .number("off", 1.0, 0.1, || 1.2)
        .number("no number", 1.0, f64::MAX, || f64::NAN)
        .never("one of many", 1000, |tries| Failures { tries, failures: 1, first: Some("seed 7".into()) })
        .never("nothing tried", 1000, |_| Failures::default());
    let records = row.ask(Effort::Quick);
    let verdicts: Vec<Verdict> = records.iter().map(|record| record.verdict()).collect();
    assert_eq!(verdicts, [Verdict::Holds, Verdict::Fails, Verdict::Fails, Verdict::Fails, Verdict::Fails]);
    assert_eq!(records[3].answer, Answer { found: 1.0, tolerance: 0.0, tries: 10, note: "seed 7".into() });

    let missing = Row::not_yet("Z2", "a feature");
    let table: serde_json::Value = serde_json::from_str(&json("1", Effort::Quick, &records, &[&missing])).expect("JSON");
    let words: Vec<&str> = table["cases"].as_array().expect("cases").iter().filter_map(|case| case["verdict"].as_str()).collect();
    assert_eq!(words, ["holds", "FAILS", "FAILS", "FAILS", "FAILS", "not yet"]);
    assert_eq!((&table["cases"][1]["found"], &table["cases"][2]["found"]), (&1.2.into(), &serde_json::Value::Null));
    let lines = csv(&records, &[&missing]);
    assert_eq!(lines.lines().count(), 7);
    assert!(lines.contains("Z1,\"answers of a test, \"\"quoted\"\"\",\"off\",1,1.2,"), "{lines}");
    let table = markdown(&records, &[&missing]);
    assert!(table.contains("| Z1 | answers of a test, \"quoted\" | 5 |") && table.contains("**FAILS**"), "{table}");
    assert!(table.ends_with("| Z2 | a feature | | | not yet | | |\n"), "{table}");
}

/// The page has each case, opens rows that fail and names them on top, and shows text as it is.
#[test]
fn the_page_shows_what_fails() {
    let rows = vec![
        Row::new("Z1", "answers < of a test", "exact").number("right", 1.0, 0.0, || 1.0).number("off & on", 1.0, 0.1, || 1.05),
        Row::new("Z2", "a wrong one", "because").number("off", 1.0, 0.1, || 1.2),
        Row::not_yet("Z3", "a feature"),
    ];
    let tables = [("tests", rows)];
    let records: Vec<_> = tables[0].1.iter().flat_map(|row| row.ask(Effort::Quick)).collect();
    let page = html("pt", "1 of 3 cases FAIL", "", &tables, &records);
    for part in ["<li><a href=\"#Z2\">Z2: a wrong one</a></li>", "answers &lt; of a test", "off &amp; on", "<details open><summary>1 case<"]
    {
        assert!(page.contains(part), "{part} is not in {page}");
    }
    let count = |word: &str| page.matches(word).count();
    assert_eq!([count("<li>"), count("<details open>"), count("<details>"), count("class=\"missing\"")], [1, 1, 1, 1]);
    assert!(page.contains("50 %<span") && !page.contains("{{"), "{page}");
}

/// A count gives the same result for any number of threads.
#[test]
fn counts_do_not_depend_on_threads() {
    let count = || Failures::count(100_000, |random| (random.below(1000) == 0).then(|| format!("{}", random.bits())));
    let on = |threads: usize| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(count);
    let (one, seven) = (on(1), on(7));
    assert_eq!(one, seven);
    assert!(one.tries == 100_000 && (50..200).contains(&one.failures), "{one:?}");
}

#[test]
fn the_command_chooses_lists_and_writes() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("t.json");
    let output = pt(&["--quick", "--only", "f1", "--only", "D2", "-v", "-o", file.to_str().expect("a name")]);
    let text = String::from_utf8(output.stdout).expect("text");
    assert!(output.status.success(), "{text}");
    assert!(
        text.contains("index 1.5, from inside                        holds") && text.contains("all 6 cases hold; 1 row is not yet tested"),
        "{text}"
    );
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    let table: serde_json::Value = serde_json::from_slice(&std::fs::read(&file).expect("a file")).expect("JSON");
    assert_eq!(table["cases"].as_array().map(Vec::len), Some(7));

    let text = String::from_utf8(pt(&["--list"]).stdout).expect("text");
    assert!(text.contains("  F2   reflectance from air to glass") && text.contains("(not yet)"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
}

#[test]
fn unknown_rows_and_files_are_refused() {
    let told = |args: &[&str]| {
        let output = pt(args);
        (output.status.code(), String::from_utf8(output.stderr).expect("text"))
    };
    let (code, text) = told(&["--only", "Q*"]);
    assert!(code == Some(2) && text.contains("--only Q*: no such row, expected one of F1 F2"), "{text}");
    let (code, text) = told(&["-o", "table.txt"]);
    assert!(code == Some(2) && text.contains("table.txt: expected a name that ends in .html, .json, .csv or .md"), "{text}");
    let (code, text) = told(&["--quick", "--full"]);
    assert!(code == Some(2) && text.contains("cannot be used with"), "{text}");
}

/// Each line of `tests/mutations/list.txt` names code that exists, so that `tests/mutations/run.sh` still corrupts something.
#[test]
fn corruptions_are_of_code_that_exists() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let list = std::fs::read_to_string(root.join("tests/mutations/list.txt")).expect("the list");
    // A bar within code is written `\|`.
    let list = list.replace("\\|", "\u{1}");
    for line in list.lines() {
        let [file, old, new] =
            line.splitn(3, '|').map(|part| part.trim_matches(' ').replace('\u{1}', "|")).collect::<Vec<_>>().try_into().expect(line);
        let code = std::fs::read_to_string(root.join(&file)).unwrap_or_else(|error| panic!("{file}: {error}"));
        assert!(code.contains(&old) && old != new, "{line}");
    }
    assert!(list.lines().count() >= 20, "{list}");
}
