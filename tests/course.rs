//! The course in docs/course is true: its code is that of examples/course, and its commands print what it says.
//!
//! - Each block of Rust consists of lines that stand together in a file of `examples/course`. A line `…` leaves some out.
//! - Each block of shell commands is run, in a folder with the scenes and documentation of the project. `pt` is the program, and
//!   `cargo run --release --example course --` is this test itself, started again as the example. Where a block of text follows, the
//!   output on stdout must be the text; `…` in the text stands for anything within a line, and a line `…` for any lines. Where none does,
//!   every command must succeed. Lines that begin with `cargo test` are left out.

#[path = "../examples/course/main.rs"]
mod course;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// Environment variable that is set when this test runs as the example.
const IS_EXAMPLE: &str = "PT_COURSE";
const ROOT: &str = env!("CARGO_MANIFEST_DIR");
/// How the text starts the example.
const CARGO: &str = "cargo run --release --example course --";
/// What the text leaves out.
const LEFT_OUT: &str = "…";

/// A block of code in a chapter.
struct Block {
    /// File and line.
    at: String,
    language: String,
    text: String,
}

fn blocks(chapter: &Path) -> Vec<Block> {
    let text = std::fs::read_to_string(chapter).expect("a chapter");
    let (mut blocks, mut open): (Vec<Block>, Option<Block>) = (vec![], None);
    for (number, line) in text.lines().enumerate() {
        match (line.strip_prefix("```"), &mut open) {
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (Some(language), None) => {
                let at = format!("{}:{}", chapter.strip_prefix(ROOT).expect("within the project").display(), number + 1);
                open = Some(Block { at, language: language.to_owned(), text: String::new() });
            }
            (None, Some(block)) => block.text += &format!("{line}\n"),
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "{}: a block has no end", chapter.display());
    blocks
}

fn files(folder: &str, extension: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(Path::new(ROOT).join(folder)).expect(folder).map(|entry| entry.expect("an entry").path());
    let mut files: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|e| e == extension)).collect();
    files.sort();
    assert!(!files.is_empty(), "{folder} has no file .{extension}");
    files
}

/// Whether a text is what a pattern describes, in which `…` stands for anything.
fn line_matches(pattern: &str, line: &str) -> bool {
    let parts: Vec<&str> = pattern.split(LEFT_OUT).collect();
    let [first, middle @ .., last] = &parts[..] else { return pattern == line };
    let Some(rest) = line.strip_prefix(first) else { return false };
    let Some(mut rest) = rest.strip_suffix(last) else { return false };
    for part in middle {
        let Some(at) = rest.find(part) else { return false };
        rest = &rest[at + part.len()..];
    }
    true
}

/// Whether lines are what patterns describe, in which a line `…` stands for any lines.
fn lines_match(patterns: &[&str], lines: &[&str], is_line: fn(&str, &str) -> bool) -> bool {
    match (patterns, lines) {
        ([], lines) => lines.is_empty(),
        ([pattern, rest @ ..], lines) if pattern.trim() == LEFT_OUT => {
            (0..=lines.len()).any(|skip| lines_match(rest, &lines[skip..], is_line))
        }
        ([pattern, rest @ ..], [line, others @ ..]) => is_line(pattern, line) && lines_match(rest, others, is_line),
        (_, []) => false,
    }
}

/// The blocks of Rust that are not in the sources.
fn unknown_code(blocks: &[Block], sources: &[String]) -> Vec<String> {
    let is_known = |block: &Block| {
        let wanted: Vec<&str> = [LEFT_OUT].into_iter().chain(block.text.lines()).chain([LEFT_OUT]).collect();
        sources.iter().any(|source| {
            let lines: Vec<&str> = source.lines().collect();
            lines_match(&wanted, &lines, |wanted, line| wanted.trim() == line.trim())
        })
    };
    let unknown = blocks.iter().filter(|block| block.language == "rust" && !is_known(block));
    unknown.map(|block| format!("{}: this is not in examples/course:\n{}", block.at, block.text)).collect()
}

/// Runs the commands of a block in `folder`. Returns what they printed on stdout, and whether all of them succeeded.
fn printed(block: &Block, folder: &Path, must_succeed: bool) -> (String, bool) {
    let this = std::env::current_exe().expect("this test");
    let lines = block.text.lines().filter(|line| !line.starts_with("cargo test"));
    let script = lines.collect::<Vec<_>>().join("\n").replace(CARGO, "example");
    let functions = "example() { PT_COURSE=1 \"$PT_EXAMPLE\" \"$@\"; }; pt() { \"$PT_PROGRAM\" \"$@\"; };";
    let mut shell = Command::new("sh");
    // Without a text it is enough that all commands succeed; a text may show an exit code.
    shell.args(["-c", &format!("{functions}\n{}{script}", if must_succeed { "set -e\n" } else { "" })]).current_dir(folder);
    shell.env("PT_EXAMPLE", this).env("PT_PROGRAM", env!("CARGO_BIN_EXE_pt")).env("LC_ALL", "C.UTF-8");
    let output = shell.output().expect("a shell");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(!errors.contains("error:") && !errors.contains("not found"), "{}:\n{errors}", block.at);
    (String::from_utf8_lossy(&output.stdout).into_owned(), output.status.success())
}

/// The blocks of commands that fail, or whose output is not the text that follows them, and the number of blocks that were run.
fn wrong_output(blocks: &[Block], folder: &Path) -> (Vec<String>, usize) {
    let commands: Vec<(usize, &Block)> = blocks.iter().enumerate().filter(|(_, block)| block.language == "sh").collect();
    let judged = |&(k, block): &(usize, &Block)| {
        let text = blocks.get(k + 1).filter(|next| next.language == "text");
        let (printed, has_succeeded) = printed(block, folder, text.is_none());
        let Some(text) = text else {
            return (!has_succeeded).then(|| format!("{}: a command failed, and printed\n{printed}", block.at));
        };
        let (wanted, found): (Vec<&str>, Vec<&str>) = (text.text.lines().collect(), printed.lines().collect());
        let is_right = lines_match(&wanted, &found, line_matches);
        (!is_right).then(|| format!("{}: expected\n{}\nfound\n{printed}", block.at, text.text))
    };
    (commands.iter().filter_map(judged).collect(), commands.len())
}

/// The comparison itself can fail.
fn the_comparison_finds_differences() {
    let is_equal =
        |wanted: &str, found: &str| lines_match(&wanted.lines().collect::<Vec<_>>(), &found.lines().collect::<Vec<_>>(), line_matches);
    assert!(is_equal("a\n…\nb … c", "a\nx\ny\nb 12 c") && is_equal("a", "a") && is_equal("…a…b", "xaxb"));
    for (wanted, found) in [("a", "b"), ("a", "a\nb"), ("a\nb", "a"), ("a\n…\nc", "a\nb"), ("1 … 2", "1  3"), ("a…a", "a")] {
        assert!(!is_equal(wanted, found), "{wanted:?} {found:?}");
    }
    let wrong = Block { at: String::new(), language: "rust".into(), text: "let x = 1;\nlet y = 2;\n".into() };
    assert_eq!(unknown_code(&[wrong], &["let x = 1;\n\nlet y = 2;\n".into()]).len(), 1);
}

fn main() -> ExitCode {
    if std::env::var_os(IS_EXAMPLE).is_some() {
        return course::main();
    }
    the_comparison_finds_differences();
    let folder = tempfile::tempdir().expect("a folder");
    for shown in ["docs", "scenes"] {
        std::os::unix::fs::symlink(Path::new(ROOT).join(shown), folder.path().join(shown)).expect("a link");
    }
    let sources: Vec<String> =
        files("examples/course", "rs").iter().map(|path| std::fs::read_to_string(path).expect("a source file")).collect();
    let (mut faults, mut runs, mut code) = (vec![], 0, 0);
    for chapter in files("docs/course", "md") {
        let blocks = blocks(&chapter);
        code += blocks.iter().filter(|block| block.language == "rust").count();
        faults.extend(unknown_code(&blocks, &sources));
        let (wrong, run) = wrong_output(&blocks, folder.path());
        faults.extend(wrong);
        runs += run;
    }
    faults.iter().for_each(|fault| println!("{fault}"));
    println!("course: {code} blocks of code compared, {runs} blocks of commands run, {} faults", faults.len());
    assert!(code > 10 && runs > 10, "the chapters are not read");
    ExitCode::from(u8::from(!faults.is_empty()))
}
