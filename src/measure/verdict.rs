//! Outcome of a statistical test.

use std::fmt;

/// Outcome of one or several tests, each of which rejects its hypothesis if p is below the level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// Smallest p-value of the `tests` single tests: the probability that chance makes so large a deviation.
    pub p: f64,
    /// Level of each single test.
    pub level: f64,
    /// Number of single tests.
    pub tests: usize,
}

impl Verdict {
    /// Returns whether no single test rejects.
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
