//! How far off a picture is, and how sure one may be of it: error measures, and tests that compare an estimate with the truth, and
//! two estimates with each other.
//!
//! Every test has a level: the probability that it says no to what is right. Levels are shared out
//! among many tests by [`sidak`], so that the whole suite keeps its promise. No test here clamps a
//! sample or hides a difference behind an absolute threshold: scaling both images changes no verdict.

pub mod adaptive;
pub mod agreement;
mod around;
pub mod average;
mod calm;
pub mod course;
pub mod distance;
pub mod follow;
pub mod ledger;
pub mod level;
pub mod mean;
pub mod metric;
pub mod relative;
mod share;
pub mod verdict;
pub mod words;
pub mod worst;

pub use agreement::{Agreement, Render, agreement};
pub use average::average;
pub use course::{Checkpoint, Course, Price, checkpoints};
pub use distance::Distance;
pub use follow::{Outcome, Target, Until, Watcher, follow, follow_on};
pub use ledger::{Removed, ledger};
pub use level::{critical_z, sidak};
pub use mean::{Mean, Welch};
pub use metric::Metric;
pub use relative::{EPSILON, RelativeError};
pub use verdict::Verdict;
pub use worst::{Noisy, Worst, worst};
