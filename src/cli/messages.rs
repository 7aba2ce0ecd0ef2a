//! Output to stderr other than errors: notes, warnings, and a message while a scene is read.

use std::io::{IsTerminal, Write, stderr, stdout};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::error::text::printable;

/// Option of the command line, for the whole process.
static IS_QUIET: AtomicBool = AtomicBool::new(false);
static SHOWS_PROGRESS: AtomicBool = AtomicBool::new(true);

/// Sets what is printed from now on.
///
/// - `shows_progress`: whether a message is printed while a scene is read
pub fn configure(is_quiet: bool, shows_progress: bool) {
    IS_QUIET.store(is_quiet, Ordering::Relaxed);
    SHOWS_PROGRESS.store(shows_progress, Ordering::Relaxed);
}

/// Returns whether only errors and requested output may be printed.
pub fn is_quiet() -> bool {
    IS_QUIET.load(Ordering::Relaxed)
}

/// Prints a note on stderr.
pub fn note(text: &str) {
    if !is_quiet() {
        print_stderr(text);
    }
}

/// Prints requested output on stderr.
pub fn print_stderr(text: &str) {
    let width = if stderr().is_terminal() { terminal_size::terminal_size_of(stderr()) } else { None };
    // Control characters are made harmless.
    let text = printable(text);
    let text = width.map_or_else(|| text.to_string(), |(width, _)| wrapped(&text, width.0.into()));
    let _ = writeln!(stderr().lock(), "{text}");
}

/// Text for stdout: broken at the width of the terminal if it is one.
pub fn fitted(text: &str) -> String {
    let width = if stdout().is_terminal() { terminal_size::terminal_size_of(stdout()) } else { None };
    width.map_or_else(|| text.to_owned(), |(width, _)| wrapped(text, width.0.into()) + "\n")
}

/// Breaks lines that are wider than a terminal: a closing line between its parts, other lines between words. Indented lines, such
/// as tables and commands to copy, stay as they are.
fn wrapped(text: &str, width: usize) -> String {
    let line = |line: &str| match line.starts_with("  ") || line.chars().count() <= width {
        true => line.to_owned(),
        false => broken(line, if line.contains(" · ") { " ·" } else { "" }, width),
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// Breaks a line. What follows a break is indented.
///
/// - `end`: text that ends each part but the last, before a space
pub fn broken(line: &str, end: &str, width: usize) -> String {
    let mut text = String::new();
    let mut used = 0;
    for part in line.split_inclusive(&format!("{end} ")) {
        let length = part.trim_end().chars().count();
        if used > 0 && used + length > width {
            text.truncate(text.trim_end().len());
            text += "\n  ";
            used = 2;
        }
        text += part;
        used += part.chars().count();
    }
    text
}

/// Text after a start, in lines of at most 80 characters that are indented by the length of the start.
pub fn indented(start: &str, text: &str) -> String {
    const WIDTH: usize = 80;
    let indent = start.chars().count();
    let (mut lines, mut length) = (start.to_owned(), indent);
    for (k, word) in text.split(' ').enumerate() {
        let width = word.chars().count();
        if k > 0 && length + 1 + width > WIDTH {
            lines += &format!("\n{:indent$}{word}", "");
            length = indent + width;
        } else {
            lines += if k > 0 { " " } else { "" };
            lines += word;
            length += width + usize::from(k > 0);
        }
    }
    lines + "\n"
}

/// Prints a message if reading a scene takes long.
pub struct Loading {
    done: Option<Sender<()>>,
    printer: Option<JoinHandle<()>>,
}

/// Time before the first message, and between messages.
const FIRST_MESSAGE_AFTER: Duration = Duration::from_secs(1);
const MESSAGE_INTERVAL: Duration = Duration::from_secs(10);

impl Loading {
    /// Starts the messages, which end when the value is dropped.
    ///
    /// - `file`: name of the file
    pub fn start(file: &str) -> Loading {
        let (done, wait) = channel::<()>();
        let print = {
            let file = file.to_owned();
            move || {
                let (start, mut timeout) = (Instant::now(), FIRST_MESSAGE_AFTER);
                while let Err(RecvTimeoutError::Timeout) = wait.recv_timeout(timeout) {
                    note(&format!("loading {file}: {:.0} s so far", start.elapsed().as_secs_f64()));
                    timeout = MESSAGE_INTERVAL;
                }
            }
        };
        // Without a thread no message is printed, which does not prevent loading.
        let shown = SHOWS_PROGRESS.load(Ordering::Relaxed);
        let printer = shown.then(|| std::thread::Builder::new().spawn(print).ok()).flatten();
        Loading { done: Some(done), printer }
    }
}

impl Drop for Loading {
    fn drop(&mut self) {
        drop(self.done.take());
        self.printer.take().map(JoinHandle::join);
    }
}

#[cfg(test)]
mod tests {
    use super::wrapped;

    const CLOSING: &str = "512×512 · nee · 64 spp · 9.6 s · relative error 9 % (95 %: 8.8–9.2) · 1 % would take about 5 min (4 min 10 s–6 min 00 s) · cornell-box.exr, cornell-box.png";

    #[test]
    fn closing_lines_break_between_their_parts() {
        let expected = "512×512 · nee · 64 spp · 9.6 s · relative error 9 % (95 %: 8.8–9.2) ·\n  1 % would take about 5 min (4 min 10 s–6 min 00 s) ·\n  cornell-box.exr, cornell-box.png";
        assert_eq!(wrapped(CLOSING, 80), expected);
        assert_eq!(wrapped(CLOSING, 200), CLOSING);
    }

    /// No line is wider than the terminal unless a word is, no word is lost, and tables stay as they are.
    #[test]
    fn sentences_break_between_words() {
        let sentence = "warning: scene.json:3:4: /shapes/1: the lamp faces away from everything in the scene: turn it round";
        for text in [sentence, CLOSING, "  a table  with   columns that are wider than the terminal is, which happens"] {
            for width in [20, 40, 79, 80, 81] {
                let broken = wrapped(text, width);
                let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
                assert_eq!(words(&broken), words(text));
                assert!(!text.starts_with(' ') || broken == text);
                let wide = |line: &&str| line.chars().count() > width && line.trim().contains(' ') && !line.contains('·');
                assert!(text != sentence || !broken.lines().any(|line| wide(&line)), "{width}: {broken}");
            }
        }
    }
}
