//! What one test says.

use std::fmt;

/// The outcome of one test: no where p falls below its level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// The probability of a deviation as large or larger by chance, of the worst of `tests` single tests.
    pub p: f64,
    /// Of each single test.
    pub level: f64,
    /// How many single tests this sums up.
    pub tests: usize,
}

impl Verdict {
    pub fn accepts(&self) -> bool {
        self.p >= self.level
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let word = if self.accepts() { "agree" } else { "DIFFER" };
        write!(f, "{word} (p {:.2e}, level {:.2e}, {} tests)", self.p, self.level, self.tests)
    }
}
