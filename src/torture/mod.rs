//! Hard cases of rendering whose answers are known exactly, put to the renderer's own functions: `pt torture`.
//!
//! A [`Table`] is one subject, such as Fresnel's equations. Its [`Row`]s are laws with an identifier, such as `F2`, and each has
//! [`Case`]s: a setup, the exact answer, and a function that asks the renderer. To add one: an entry in the file of its table. To add a
//! table: a file beside these and a row in [`TABLES`].
//!
//! Every answer comes from a formula or another program, never from pt. A case takes its random numbers from fixed seeds, so that it
//! always passes or always fails. Statistical cases share a probability of false alarms of 1 % ([`radiance::critical`]).

mod bsdfs;
mod cameras;
pub mod everything;
mod fresnel;
mod geometry;
pub mod glass;
mod lights;
mod media;
pub mod meshes;
mod moving_meshes;
#[cfg(feature = "cli")]
mod page;
pub mod radiance;
mod radiometry;
mod random;
mod report;
mod samplers;
mod stability;
pub mod terminator;
mod transforms;

use rayon::prelude::*;

#[cfg(feature = "cli")]
pub use page::html;
pub use random::Random;
pub use report::{Record, csv, json, markdown, number, worst_share};

/// One subject, with its rows.
pub struct Table {
    /// The subject, in a few words.
    pub subject: &'static str,
    /// Makes the rows.
    pub rows: fn() -> Vec<Row>,
}

/// All tables.
pub const TABLES: [Table; 11] = [
    Table { subject: "Fresnel's and Snell's laws", rows: fresnel::rows },
    Table { subject: "panes, lenses and prisms of glass", rows: glass::rows },
    Table { subject: "scenes whose radiance is known by formula", rows: radiometry::rows },
    Table { subject: "fog and other media", rows: media::rows },
    Table { subject: "materials", rows: bsdfs::rows },
    Table { subject: "intersection", rows: geometry::rows },
    Table { subject: "what must not change a picture, and samples that are no numbers", rows: stability::rows },
    Table { subject: "transforms and motion", rows: transforms::rows },
    Table { subject: "cameras", rows: cameras::rows },
    Table { subject: "random numbers and samplers", rows: samplers::rows },
    Table { subject: "lights that are tiny, huge or far, and the shadow terminator", rows: lights::rows },
];

/// One law: an identifier, what it demands, and its cases.
pub struct Row {
    /// A letter and a number, such as `F2`.
    pub id: &'static str,
    /// What is computed or counted.
    pub what: &'static str,
    /// Reason of the tolerance.
    pub reason: &'static str,
    /// What other programs reach, where that is known.
    pub peers: &'static str,
    /// What is done before the cases are asked, which is on all threads.
    pub prepare: Option<fn()>,
    /// The cases.
    pub cases: Vec<Case>,
}

/// One setup with its exact answer.
pub struct Case {
    /// The setup, in a few words.
    pub setup: String,
    /// The exact answer.
    pub expected: f64,
    /// Whether the case is left out of a quick run.
    pub is_slow: bool,
    ask: Box<dyn Fn(Effort) -> Answer + Send + Sync>,
}

/// What the renderer answers in one case.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// The answer, or the number of failures.
    pub found: f64,
    /// Greatest permitted difference from the exact answer.
    pub tolerance: f64,
    /// Number of rays, samples or inputs.
    pub tries: u64,
    /// The first input that fails, or why there is no answer.
    pub note: String,
}

/// How much is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Few tries, and no slow cases: about a minute on two cores.
    Quick,
    /// 10⁷ rays of each kind.
    Standard,
    /// 10⁸ rays of each kind, and means to 0.1 %.
    Full,
}

/// Result of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The answer is within the tolerance.
    Holds,
    /// It is not, or it is not a number.
    Fails,
    /// The case cannot be tested here, see [`Row::not_yet`].
    NotYet,
}

impl Effort {
    /// Number of tries, of which the default takes `standard`: a hundredth part, or ten times as many.
    pub fn tries(self, standard: u64) -> u64 {
        match self {
            Effort::Quick => (standard / 100).max(1),
            Effort::Standard => standard,
            Effort::Full => standard * 10,
        }
    }
}

impl Row {
    /// A law without cases.
    pub fn new(id: &'static str, what: &'static str, reason: &'static str) -> Row {
        Row { id, what, reason, peers: "", prepare: None, cases: vec![] }
    }

    /// A law that cannot be tested here: about a feature that pt does not have, or about another machine.
    pub fn not_yet(id: &'static str, what: &'static str) -> Row {
        Row::new(id, what, "")
    }

    /// Adds what other programs reach.
    pub fn peers(self, peers: &'static str) -> Row {
        Row { peers, ..self }
    }

    /// Adds what is done before the cases are asked: tables that all of them need, which each thread would otherwise compute for itself, since
    /// a cache is not locked while a table is made.
    pub fn prepared_by(self, prepare: fn()) -> Row {
        Row { prepare: Some(prepare), ..self }
    }

    /// Leaves the case that was added last out of quick runs, if `is_slow`.
    pub fn slow(mut self, is_slow: bool) -> Row {
        self.cases.last_mut().expect("a case was added").is_slow = is_slow;
        self
    }

    /// Asks the renderer all cases, on all threads. The answers do not depend on the threads.
    pub fn ask(&self, effort: Effort) -> Vec<Record<'_>> {
        if let Some(prepare) = self.prepare {
            prepare();
        }
        let is_asked = |case: &&Case| effort != Effort::Quick || !case.is_slow;
        self.cases.par_iter().filter(is_asked).map(|case| Record { row: self, case, answer: case.ask(effort) }).collect()
    }

    /// Adds a case with one number for an answer.
    pub fn number(
        mut self,
        setup: impl Into<String>,
        expected: f64,
        tolerance: f64,
        found: impl Fn() -> f64 + Send + Sync + 'static,
    ) -> Row {
        let ask = move |_| Answer { found: found(), tolerance, tries: 1, note: String::new() };
        self.cases.push(Case { setup: setup.into(), expected, is_slow: false, ask: Box::new(ask) });
        self
    }

    /// Adds a case that counts failures, of which there must be none.
    ///
    /// - `standard`: number of tries at the default effort
    /// - `count`: tries so often, and returns the failures
    pub fn never(mut self, setup: impl Into<String>, standard: u64, count: impl Fn(u64) -> Failures + Send + Sync + 'static) -> Row {
        let ask = move |effort: Effort| {
            let Failures { tries, failures, first } = count(effort.tries(standard));
            let note = if tries == 0 { "nothing was tried".into() } else { first.unwrap_or_default() };
            Answer { found: if tries == 0 { f64::NAN } else { failures as f64 }, tolerance: 0.0, tries, note }
        };
        self.cases.push(Case { setup: setup.into(), expected: 0.0, is_slow: false, ask: Box::new(ask) });
        self
    }

    /// Adds a case whose answer has its own tolerance.
    fn answered(mut self, setup: String, expected: f64, ask: impl Fn(Effort) -> Answer + Send + Sync + 'static) -> Row {
        self.cases.push(Case { setup, expected, is_slow: false, ask: Box::new(ask) });
        self
    }
}

impl Case {
    /// Asks the renderer.
    pub fn ask(&self, effort: Effort) -> Answer {
        (self.ask)(effort)
    }
}

impl Answer {
    /// Difference from the exact answer.
    pub fn error(&self, expected: f64) -> f64 {
        (self.found - expected).abs()
    }

    /// Whether the answer is within the tolerance of the exact one.
    pub fn verdict(&self, expected: f64) -> Verdict {
        if self.error(expected) <= self.tolerance { Verdict::Holds } else { Verdict::Fails }
    }
}

/// Number of tries and of failures among them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Failures {
    /// Number of tries.
    pub tries: u64,
    /// Number of failures.
    pub failures: u64,
    /// The first that failed: its inputs with all digits, or the seed that gives them.
    pub first: Option<String>,
}

impl Failures {
    /// Counts a try; `failure` describes it if it failed.
    pub fn record(&mut self, failure: Option<String>) {
        self.tries += 1;
        if let Some(failure) = failure {
            self.failures += 1;
            self.first.get_or_insert(failure);
        }
    }

    /// The tries of both.
    pub fn join(self, after: Failures) -> Failures {
        Failures { tries: self.tries + after.tries, failures: self.failures + after.failures, first: self.first.or(after.first) }
    }

    /// Tries `tries` times on all threads: `judge` returns what is wrong, or `None`. Every batch of tries has random numbers of its own, so
    /// that the result does not depend on the threads.
    pub fn count(tries: u64, judge: impl Fn(&mut Random) -> Option<String> + Sync) -> Failures {
        Failures::count_judged(tries, |random| Some(judge(random)))
    }

    /// As [`Failures::count`]; where `judge` returns `None` the input tells nothing and is not counted.
    pub fn count_judged(tries: u64, judge: impl Fn(&mut Random) -> Option<Option<String>> + Sync) -> Failures {
        const BATCH: u64 = 1 << 12;
        Failures::each(tries.div_ceil(BATCH), &|k, random| {
            let mut failures = Failures::default();
            for _ in 0..BATCH.min(tries - k * BATCH) {
                if let Some(judged) = judge(random) {
                    failures.record(judged);
                }
            }
            failures
        })
    }

    /// The tries of `setups` calls of `count`, on all threads.
    pub fn sum(setups: u64, count: impl Fn(&mut Random) -> Failures + Sync) -> Failures {
        Failures::each(setups, &|_, random| count(random))
    }

    /// The function is a `dyn`, so that the code for threads is compiled once for all cases.
    fn each(batches: u64, count: &(dyn Fn(u64, &mut Random) -> Failures + Sync)) -> Failures {
        (0..batches).into_par_iter().map(|k| count(k, &mut Random::new(k))).reduce(Failures::default, Failures::join)
    }
}
