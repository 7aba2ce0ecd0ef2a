//! What a proof says: one readable block per law.

use std::fmt;

/// The outcome of all laws for one model.
#[derive(Clone, Debug)]
pub struct Report {
    /// As `Debug` writes it.
    pub model: String,
    /// The probability that any law refuses a right model.
    pub alpha: f64,
    pub findings: Vec<Finding>,
}

/// The outcome of one law.
#[derive(Clone, Debug)]
pub struct Finding {
    /// In one word.
    pub law: &'static str,
    /// What it demands, as a formula where there is one.
    pub demands: &'static str,
    pub verdict: Verdict,
    /// What was tried and found, one line each.
    pub notes: Vec<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    Holds,
    /// The law does not apply to this model.
    Exempt,
    Refused(CounterExample),
}

/// An input for which a law does not hold, and all it takes to see that.
#[derive(Clone, Debug, PartialEq)]
pub struct CounterExample {
    /// With all digits, so that it can be repeated.
    pub inputs: String,
    pub expected: String,
    pub found: String,
    pub sure: String,
}

/// For a contradiction that one evaluation shows.
pub const CERTAIN: &str = "certain, no chance is involved";

impl Report {
    pub fn accepts(&self) -> bool {
        self.refusals().next().is_none()
    }

    pub fn refusals(&self) -> impl Iterator<Item = (&Finding, &CounterExample)> {
        self.findings.iter().filter_map(|finding| match &finding.verdict {
            Verdict::Refused(example) => Some((finding, example)),
            _ => None,
        })
    }

    /// Whether this law, by name, refuses the model.
    pub fn refuses(&self, law: &str) -> bool {
        self.refusals().any(|(finding, _)| finding.law == law)
    }

    /// The refusals, or the words "proved".
    ///
    /// # Errors
    /// The whole report as text, for a test to print.
    pub fn into_result(self) -> Result<(), String> {
        if self.accepts() { Ok(()) } else { Err(self.to_string()) }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let refusals = self.refusals().count();
        let word = if refusals == 0 { "proved".to_owned() } else { format!("REFUSED by {refusals} of {} laws", self.findings.len()) };
        writeln!(f, "{}: {word} (a right model is refused with probability {})", self.model, self.alpha)?;
        self.findings.iter().try_for_each(|finding| write!(f, "{finding}"))
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let word = match &self.verdict {
            Verdict::Holds => "holds",
            Verdict::Exempt => "does not apply",
            Verdict::Refused(_) => "REFUSED",
        };
        writeln!(f, "  {:<12} {word}: {}", self.law, self.demands)?;
        for note in &self.notes {
            writeln!(f, "      {note}")?;
        }
        match &self.verdict {
            Verdict::Refused(example) => write!(f, "{example}"),
            _ => Ok(()),
        }
    }
}

impl fmt::Display for CounterExample {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let rows = [("at", &self.inputs), ("expected", &self.expected), ("found", &self.found), ("how sure", &self.sure)];
        rows.into_iter().try_for_each(|(name, text)| writeln!(f, "      {name:<9} {text}"))
    }
}
