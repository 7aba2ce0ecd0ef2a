//! Report of a test of a model: one readable block per law.

use std::fmt;

/// Results of all laws for one model.
#[derive(Clone, Debug)]
pub struct Report {
    /// `Debug` text of the model.
    pub model: String,
    /// Probability that any law refuses a right model.
    pub alpha: f64,
    /// Results of the laws.
    pub findings: Vec<Finding>,
}

/// Result of one law.
#[derive(Clone, Debug)]
pub struct Finding {
    /// Name of the law.
    pub law: &'static str,
    /// Demand of the law, as a formula if there is one.
    pub demands: &'static str,
    /// Verdict on the model.
    pub verdict: Verdict,
    /// Notes about what was tried and found, one line each.
    pub notes: Vec<String>,
}

/// Verdict of one law.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// No violation was found.
    Holds,
    /// The law does not apply to this model.
    Exempt,
    /// The law is violated.
    Refused(CounterExample),
}

/// Input that violates a law, with the evidence.
#[derive(Clone, Debug, PartialEq)]
pub struct CounterExample {
    /// Input with all digits, so that it can be repeated.
    pub inputs: String,
    /// Expected result.
    pub expected: String,
    /// Actual result.
    pub found: String,
    /// Certainty of the violation.
    pub sure: String,
}

/// Certainty of a violation that one evaluation shows.
pub const CERTAIN: &str = "certain, no chance is involved";

impl Report {
    /// Returns whether no law is violated.
    pub fn accepts(&self) -> bool {
        self.refusals().next().is_none()
    }

    /// Violated laws, with counter-examples.
    pub fn refusals(&self) -> impl Iterator<Item = (&Finding, &CounterExample)> {
        self.findings.iter().filter_map(|finding| match &finding.verdict {
            Verdict::Refused(example) => Some((finding, example)),
            _ => None,
        })
    }

    /// Returns whether the law of this name is violated.
    pub fn refuses(&self, law: &str) -> bool {
        self.refusals().any(|(finding, _)| finding.law == law)
    }

    /// `Ok` if no law is violated.
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
