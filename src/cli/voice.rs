//! What goes to stderr beside errors: notes, warnings, and that a scene is being read.

use std::io::{IsTerminal, Write, stderr};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::args::{Args, Command, Progress};
use crate::error::text::printable;

/// What was asked for on the command line, for all of the process.
static IS_QUIET: AtomicBool = AtomicBool::new(false);
static SHOWS_PROGRESS: AtomicBool = AtomicBool::new(true);

/// Takes `--quiet` and `--progress` to heart.
pub fn follow(args: &Args) {
    let work = match &args.command {
        None => Some(&args.render.work),
        Some(Command::Compare(args)) => Some(&args.work),
        Some(Command::Verify(args)) => Some(&args.work),
        Some(Command::Reference(args)) => Some(&args.work),
        Some(_) => None,
    };
    IS_QUIET.store(args.quiet, Ordering::Relaxed);
    SHOWS_PROGRESS.store(!args.quiet && work.is_none_or(|work| work.progress != Progress::None), Ordering::Relaxed);
}

/// Whether nothing is to be said but errors and what was asked for.
pub fn is_quiet() -> bool {
    IS_QUIET.load(Ordering::Relaxed)
}

/// Says something on stderr that nobody asked for.
pub fn note(text: &str) {
    if !is_quiet() {
        insist(text);
    }
}

/// Says something on stderr that was asked for.
pub fn insist(text: &str) {
    let width = if stderr().is_terminal() { terminal_size::terminal_size_of(stderr()) } else { None };
    // Nothing in it moves a terminal.
    let text = printable(text);
    let text = width.map_or_else(|| text.to_string(), |(width, _)| wrapped(&text, width.0.into()));
    let _ = writeln!(stderr().lock(), "{text}");
}

/// Lines broken where they would be wider than a terminal: between the parts of a closing line, else between words. What is indented
/// stays as it is: tables, and commands to be copied.
fn wrapped(text: &str, width: usize) -> String {
    let line = |line: &str| match line.starts_with("  ") || line.chars().count() <= width {
        true => line.to_owned(),
        false => broken(line, if line.contains(" · ") { " ·" } else { "" }, width),
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// - `end`: what closes each part but the last, before a space
fn broken(line: &str, end: &str, width: usize) -> String {
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

/// Says that a scene is being read, where that takes long.
pub struct Loading {
    done: Option<Sender<()>>,
    teller: Option<JoinHandle<()>>,
}

/// How long nothing is said, and how often after that.
const PATIENCE: Duration = Duration::from_secs(1);
const AGAIN: Duration = Duration::from_secs(10);

impl Loading {
    /// Until it is dropped.
    ///
    /// - `file`: what messages call it
    pub fn start(file: &str) -> Loading {
        let (done, wait) = channel::<()>();
        let tell = {
            let file = file.to_owned();
            move || {
                let (start, mut patience) = (Instant::now(), PATIENCE);
                while let Err(RecvTimeoutError::Timeout) = wait.recv_timeout(patience) {
                    note(&format!("loading {file}: {:.0} s so far", start.elapsed().as_secs_f64()));
                    patience = AGAIN;
                }
            }
        };
        // Without a thread nothing is told, which is no reason not to load.
        let shown = SHOWS_PROGRESS.load(Ordering::Relaxed);
        let teller = shown.then(|| std::thread::Builder::new().spawn(tell).ok()).flatten();
        Loading { done: Some(done), teller }
    }
}

impl Drop for Loading {
    fn drop(&mut self) {
        drop(self.done.take());
        self.teller.take().map(JoinHandle::join);
    }
}

#[cfg(test)]
mod tests {
    use super::wrapped;

    const CLOSING: &str = "512×512 · nee · 64 spp · 9.6 s · relative error 9 % (95 %: 8.8–9.2) · 1 % would take about 5 min 57 s · cornell-box.exr, cornell-box.png";

    #[test]
    fn closing_lines_break_between_their_parts() {
        let expected = "512×512 · nee · 64 spp · 9.6 s · relative error 9 % (95 %: 8.8–9.2) ·\n  1 % would take about 5 min 57 s · cornell-box.exr, cornell-box.png";
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
