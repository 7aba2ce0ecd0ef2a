//! Error measures between two pictures, each with its own name and formula.
//!
//! One word, such as relMSE, means different formulas in different programs. Here every name stands for one formula, and whoever prints a
//! number prints [`Metric::formula`] with it.
//!
//! - every measure is an error: 0 for equal pictures, and larger is worse
//! - each pixel has an error (the mean over red, green and blue if a formula is per value); the mean over all pixels is the result
//! - pt's own measure is `relmse` without options: its ε follows the reference, so that scaling both pictures changes nothing. The
//!   other measures have the constants of the programs they come from
//!
//! To add one: a function in a file beside this one, and a row in [`ALL`].

mod absolute;
mod filter;
mod flip;
mod image_pair;
mod relative;
mod squared;
mod ssim;

use crate::reader::unknown;
use crate::{Error, Result};

pub use image_pair::{ImagePair, Named};

/// A kind of error measure: a row of [`ALL`].
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// Name on the command line.
    pub name: &'static str,
    /// Error of a pixel, with `a` for the values of the first picture and `r` for those of the second. The mean over pixels
    /// follows.
    pub formula: &'static str,
    /// Role of the first picture.
    pub first: &'static str,
    /// Role of the second picture.
    pub second: &'static str,
    /// Function that returns the error of every pixel, rows from the top.
    error: fn(&ImagePair, Option<f64>) -> Vec<f64>,
    /// Default of ε in words, for formulas whose ε can be chosen.
    epsilon: Option<&'static str>,
    /// Whether the square root of the mean is taken.
    root: bool,
}

impl Kind {
    /// Formula of a pixel's error, its ε, and the roles of `a` and `r` if they differ.
    pub fn about(&self) -> String {
        let epsilon = self.epsilon.map_or(String::new(), |epsilon| format!(", ε = {epsilon}, or :eps=NUMBER"));
        let root = if self.root { ", root of the mean" } else { "" };
        let roles = if self.first == self.second { String::new() } else { format!("; a: {}, r: {}", self.first, self.second) };
        format!("{}{epsilon}{root}{roles}", self.formula)
    }
}

const PLAIN: Kind = Kind { name: "", formula: "", first: PICTURE, second: REFERENCE, error: squared::square, epsilon: None, root: false };
const PICTURE: &str = "picture";
const REFERENCE: &str = "reference";
const EITHER: &str = "either";

/// Every kind of error measure, in the order of `pt list metrics`.
pub const ALL: &[Kind] = &[
    Kind { name: "mse", formula: "(a − r)²", first: EITHER, second: EITHER, ..PLAIN },
    Kind { name: "rmse", formula: "(a − r)²", first: EITHER, second: EITHER, root: true, ..PLAIN },
    Kind { name: "mae", formula: "|a − r|", first: EITHER, second: EITHER, error: absolute::difference, ..PLAIN },
    Kind { name: "l1", formula: "|a − r|", first: EITHER, second: EITHER, error: absolute::difference, ..PLAIN },
    Kind { name: "l2", formula: "(a − r)²", first: EITHER, second: EITHER, ..PLAIN },
    Kind {
        name: "relmse",
        formula: "(a − r)²/(r² + ε)",
        error: relative::relmse,
        epsilon: Some("0.01·mean²(r) over all pixels and colours"),
        ..PLAIN
    },
    Kind { name: "relmse-tev", formula: "(a − r)²/(r² + 0.01)", error: relative::tev, ..PLAIN },
    Kind { name: "relmse-seesharp", formula: "(a − r)²/(r² + 0.01), 0 where r = 0", error: relative::seesharp, ..PLAIN },
    Kind { name: "mrse-pbrt", formula: "(a − r)²/(r + 0.01)², 0 where infinite", error: relative::pbrt, ..PLAIN },
    Kind { name: "mrse-jeri", formula: "(a − r)²/(r² + 0.0001)", error: relative::jeri, ..PLAIN },
    Kind {
        name: "mrse-tungsten", formula: "(a − r)²/(a² + 0.001)", first: REFERENCE, second: PICTURE, error: relative::tungsten, ..PLAIN
    },
    Kind { name: "mape", formula: "|a − r|/(|r| + ε)", error: absolute::mape, epsilon: Some("0.01"), ..PLAIN },
    Kind {
        name: "smape",
        formula: "2|a − r|/(|a| + |r| + 2ε)",
        first: EITHER,
        second: EITHER,
        error: absolute::smape,
        epsilon: Some("0.01"),
        ..PLAIN
    },
    Kind {
        name: "flip",
        formula: "LDR-FLIP after tone mapping, 67.02 pixels per degree",
        first: EITHER,
        second: EITHER,
        error: |pair, _| flip::flip(pair),
        ..PLAIN
    },
    Kind {
        name: "ssim",
        formula: "1 − SSIM of the luma after tone mapping, Gaussian window of 11 × 11 with σ = 1.5",
        first: EITHER,
        second: EITHER,
        error: |pair, _| ssim::ssim(pair),
        ..PLAIN
    },
];

/// A kind of error measure with its options: `relmse`, `relmse:eps=1e-2`, `mse:robust`, `mape:eps=1e-3,robust`. `eps` sets ε; `robust`
/// leaves out the 0.1 % of the pixels with the largest errors.
#[derive(Clone, Copy, Debug)]
pub struct Metric {
    kind: Kind,
    epsilon: Option<f64>,
    robust: bool,
}

/// Error between two pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The error, as one number.
    pub value: f64,
    /// Error of every pixel, rows from the top.
    pub map: Vec<f64>,
}

impl Default for Metric {
    /// pt's own measure: `relmse`.
    fn default() -> Metric {
        Metric { kind: ALL.iter().find(|kind| kind.name == "relmse").copied().unwrap_or(PLAIN), epsilon: None, robust: false }
    }
}

impl Metric {
    /// Reads a name, and options after a colon, separated by commas.
    ///
    /// # Errors
    /// `Usage` for unknown names and options.
    pub fn parse(text: &str) -> Result<Metric> {
        let (name, options) = text.split_once(':').unwrap_or((text, ""));
        let known = || ALL.iter().map(|kind| kind.name).collect::<Vec<_>>();
        let kind = ALL.iter().find(|kind| kind.name == name).copied();
        let kind = kind.ok_or_else(|| Error::Usage(unknown("metric", name, &known())))?;
        let mut metric = Metric { kind, epsilon: None, robust: false };
        for option in options.split(',').filter(|option| !option.is_empty()) {
            metric.set(text, option)?;
        }
        Ok(metric)
    }

    fn set(&mut self, text: &str, option: &str) -> Result<()> {
        let usage = |message: &str| Err(Error::Usage(format!("metric {text:?}: {message}")));
        match option.split_once('=') {
            None if option == "robust" => self.robust = true,
            Some(("eps", _)) if self.kind.epsilon.is_none() => return usage("this metric takes no eps"),
            Some(("eps", value)) => match value.parse() {
                Ok(epsilon) if (0.0..f64::INFINITY).contains(&epsilon) => self.epsilon = Some(epsilon),
                _ => return usage("expected a number from 0 after eps="),
            },
            _ => return usage(&format!("unknown option {option:?}, expected robust or eps=NUMBER")),
        }
        Ok(())
    }

    /// Name with options, as [`Metric::parse`] reads it.
    pub fn name(&self) -> String {
        let epsilon = self.epsilon.map(|epsilon| format!("eps={epsilon}"));
        let options: Vec<String> = epsilon.into_iter().chain(self.robust.then(|| "robust".to_owned())).collect();
        let colon = if options.is_empty() { "" } else { ":" };
        format!("{}{colon}{}", self.kind.name, options.join(","))
    }

    /// Formula in full, with the numbers that are used.
    pub fn formula(&self) -> String {
        let epsilon = self.epsilon.map(|epsilon| epsilon.to_string()).or(self.kind.epsilon.map(str::to_owned));
        let epsilon = epsilon.map_or(String::new(), |epsilon| format!(", ε = {epsilon}"));
        let pixels = if self.robust { "all pixels but the worst 0.1 %" } else { "all pixels" };
        let root = if self.kind.root { "square root of the " } else { "" };
        format!("{root}mean over {pixels} of {}{epsilon}", self.kind.formula)
    }

    /// Kind of measure, without options.
    pub fn kind(&self) -> &Kind {
        &self.kind
    }

    /// Error between two pictures, as one number and for every pixel.
    pub fn measure(&self, pair: &ImagePair) -> Measured {
        let map = (self.kind.error)(pair, self.epsilon);
        let mean = if self.robust { trimmed_mean(&map) } else { mean(&map) };
        Measured { value: if self.kind.root { mean.sqrt() } else { mean }, map }
    }
}

/// Σx/n; 0 for no values.
fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Mean without the largest n/1000 values, rounded down: fewer than a thousand values are all used.
///
/// Source: SeeSharp's RelMSE_OutlierRejection, which leaves out as many. Tests: trimmed_mean_by_hand.
fn trimmed_mean(values: &[f64]) -> f64 {
    let kept = values.len() - values.len() / 1000;
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    mean(&sorted[..kept])
}
