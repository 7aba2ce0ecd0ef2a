//! Check that tests which documentation names exist.
//!
//! A comment that lists names after the word "Tests" and a colon promises that these laws are tested. A word of lower-case letters
//! with an underscore in such a list is taken for the name of a test, and a word like M4 after "row" for a row of `pt torture`; what is
//! said in plain words is not checked.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder of the crate").map(|entry| entry.expect("an entry").path()) {
        if entry.is_dir() {
            rust_files(&entry, found);
        } else if entry.extension().is_some_and(|extension| extension == "rs") {
            found.push(entry);
        }
    }
}

/// The comments of a source file, the lines of each block joined.
fn comments(source: &str) -> Vec<String> {
    let mut blocks = vec![String::new()];
    for line in source.lines().map(str::trim_start) {
        match line.strip_prefix("///").or_else(|| line.strip_prefix("//!")).or_else(|| line.strip_prefix("//")) {
            Some(text) => *blocks.last_mut().expect("one at least") += &format!(" {}", text.trim()),
            None => blocks.push(String::new()),
        }
    }
    blocks
}

/// The names of tests in a comment: of each list that "Tests:" opens and a full stop ends.
fn named(comment: &str) -> Vec<String> {
    let lists = comment.split("Tests:").skip(1).map(|rest| rest.split(". ").next().unwrap_or(rest));
    let words = lists.flat_map(|list| list.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_')));
    let is_name = |word: &&str| word.trim_matches('_').contains('_') && !word.contains(|c: char| c.is_ascii_uppercase());
    words.filter(is_name).map(str::to_owned).collect()
}

/// The rows of `pt torture` in a comment.
fn rows(comment: &str) -> Vec<String> {
    let lists = comment.split("Tests:").skip(1).map(|rest| rest.split(". ").next().unwrap_or(rest));
    let words = lists.flat_map(|list| list.split("row ").skip(1)).filter_map(|rest| rest.split([' ', ',', '.', ')']).next());
    words.filter(|word| word.starts_with(|c: char| c.is_ascii_uppercase())).map(str::to_owned).collect()
}

/// The names of the functions that a source file defines.
fn functions(source: &str) -> impl Iterator<Item = &str> {
    source.split("fn ").skip(1).filter_map(|rest| rest.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).next())
}

#[test]
fn tests_that_documentation_names_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = vec![];
    ["src", "integrators", "tests", "examples", "benches"].iter().for_each(|folder| rust_files(&root.join(folder), &mut files));
    let sources: Vec<(PathBuf, String)> =
        files.into_iter().map(|path| (path.clone(), std::fs::read_to_string(path).expect("a source file"))).collect();
    let defined: BTreeSet<&str> = sources.iter().flat_map(|(_, source)| functions(source)).collect();
    let tables: String =
        sources.iter().filter(|(path, _)| path.starts_with(root.join("src/torture"))).map(|(_, source)| &**source).collect();
    let mut missing = vec![];
    for (path, source) in &sources {
        for row in comments(source).iter().flat_map(|comment| rows(comment)).filter(|row| !tables.contains(&format!("\"{row}\""))) {
            missing.push(format!("{}: row {row}", path.display()));
        }
    }
    for (path, source) in &sources {
        for name in comments(source).iter().flat_map(|comment| named(comment)).filter(|name| !defined.contains(name.as_str())) {
            missing.push(format!("{}: {name}", path.display()));
        }
    }
    assert!(missing.is_empty(), "tests that do not exist:\n{}", missing.join("\n"));
}

#[test]
fn lists_of_tests_are_read() {
    let source = "/// Tests: a_law, plain words,\n/// row M4 of `pt torture`, b_law (M4). Then more_text.\nfn x() {}\n//! Source: x_y. Tests: c_law.\n";
    let names: Vec<String> = comments(source).iter().flat_map(|comment| named(comment)).collect();
    assert_eq!(names, ["a_law", "b_law", "c_law"]);
    let rows: Vec<String> = comments(source).iter().flat_map(|comment| rows(comment)).collect();
    assert_eq!(rows, ["M4"]);
}
