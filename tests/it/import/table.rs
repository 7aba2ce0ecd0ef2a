//! The tables of docs/import.md, which say how each construct of a dialect is converted.

/// A row of a table.
pub struct Row {
    pub construct: String,
    /// "read", "refused", or "said": read in another way or left out, with a sentence.
    pub outcome: &'static str,
}

/// The table under a heading of the second level.
pub fn rows(heading: &str) -> Vec<Row> {
    let page = include_str!("../../../docs/import.md");
    let mut lines = page.lines().skip_while(|line| *line != format!("## {heading}")).skip(1);
    let section: Vec<&str> = lines.by_ref().take_while(|line| !line.starts_with("## ")).collect();
    assert!(!section.is_empty(), "docs/import.md has no section {heading}");
    let cells = section.iter().filter_map(|line| line.strip_prefix("| ")?.strip_suffix(" |")?.split_once(" | "));
    cells.skip(1).map(|(construct, outcome)| Row { construct: construct.to_owned(), outcome: word(outcome) }).collect()
}

fn word(outcome: &str) -> &'static str {
    match outcome {
        _ if outcome.starts_with("read") => "read",
        _ if outcome.starts_with("refused") => "refused",
        _ if outcome.starts_with("approximated") || outcome.starts_with("left out") => "said",
        _ => panic!("a row says neither read, approximated, left out nor refused: {outcome}"),
    }
}
