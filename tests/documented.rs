//! Check that what documentation refers to exists: tests, and files that pages link to.
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

/// The pages of the documentation.
fn pages() -> Vec<PathBuf> {
    fn add(folder: &Path, found: &mut Vec<PathBuf>) {
        for path in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            if path.is_dir() {
                add(&path, found);
            } else if path.extension().is_some_and(|extension| extension == "md") {
                found.push(path);
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut pages: Vec<PathBuf> = ["README.md", "ARCHITECTURE.md", "CHANGELOG.md"].iter().map(|name| root.join(name)).collect();
    add(&root.join("docs"), &mut pages);
    pages
}

/// The lines of a page that are no code.
fn prose(page: &str) -> impl Iterator<Item = &str> {
    let mut is_code = false;
    page.lines().filter(move |line| {
        let is_fence = line.starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    })
}

/// The targets of the links `](…)` of a page.
fn links(page: &str) -> Vec<&str> {
    prose(page).flat_map(|line| line.split("](").skip(1)).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target).collect()
}

/// The names of a page's headings in links: lower case, without punctuation, hyphens for spaces.
fn anchors(page: &str) -> BTreeSet<String> {
    let headings = prose(page).filter(|line| line.starts_with('#')).map(|line| line.trim_start_matches('#').trim());
    let name = |c: char| match c {
        ' ' => Some('-'),
        _ if c.is_alphanumeric() || c == '-' || c == '_' => Some(c),
        _ => None,
    };
    headings.map(|heading| heading.to_lowercase().chars().filter_map(name).collect()).collect()
}

#[test]
fn links_of_pages_lead_somewhere() {
    let mut broken = vec![];
    for path in pages() {
        let page = std::fs::read_to_string(&path).expect("a page");
        for link in links(&page).into_iter().filter(|link| !link.contains("://")) {
            let (file, anchor) = link.split_once('#').map_or((link, None), |(file, anchor)| (file, Some(anchor)));
            let target = if file.is_empty() { path.clone() } else { path.with_file_name(file) };
            let is_there = match anchor {
                None => target.exists(),
                Some(anchor) => std::fs::read_to_string(&target).is_ok_and(|text| anchors(&text).contains(anchor)),
            };
            broken.extend((!is_there).then(|| format!("{}: {link}", path.display())));
        }
    }
    assert!(broken.is_empty(), "links that lead nowhere:\n{}", broken.join("\n"));
}

/// docs/SUMMARY.md is the table of contents of the book: every page is a chapter, once.
#[test]
fn every_page_is_a_chapter() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let summary = std::fs::read_to_string(docs.join("SUMMARY.md")).expect("a table of contents");
    let mut chapters: Vec<PathBuf> = links(&summary).into_iter().map(|link| docs.join(link)).collect();
    let mut written: Vec<PathBuf> = pages().into_iter().filter(|path| path.starts_with(&docs) && !path.ends_with("SUMMARY.md")).collect();
    chapters.sort();
    written.sort();
    assert_eq!(chapters, written);
}

#[test]
fn links_and_headings_are_read() {
    let page = "# A b: `c`, d\na [b](c.md#d) and ![e](f.png)\n```text\n# no\n[g](h)\n```\n## Ω-i_j\n";
    assert_eq!(links(page), ["c.md#d", "f.png"]);
    assert_eq!(anchors(page).into_iter().collect::<Vec<_>>(), ["a-b-c-d", "ω-i_j"]);
}
