//! Error measures for pictures, statistical tests of estimates, and renders that stop at an accuracy.
//!
//! Every test has a level: the probability that it refuses a right result. [`sidak`] shares a level among many tests, so that the
//! whole test suite keeps its promise. No test here clamps a sample or hides a difference behind an absolute threshold: scaling
//! both images changes no verdict.

pub mod adaptive;
pub mod agreement;
pub mod average;
pub mod bias_report;
pub mod distance;
pub mod effects;
pub mod error;
pub mod error_history;
pub mod forecast;
pub mod format;
pub mod level;
pub mod mean;
pub mod meter;
pub mod meters;
pub mod metric;
pub mod outliers;
pub mod render_until;
pub mod replicates;
pub mod verdict;
pub mod verify;

pub use agreement::{Agreement, SampledImage, agreement};
pub use average::average;
pub use bias_report::{BiasEstimate, bias_report};
pub use distance::Distance;
pub use error::{EPSILON, ErrorInterval, FEWEST_PIXELS, MostPixels, Refusal, RelativeError, Scope, Tile, tile_errors, tiles, worst_tile};
pub use error_history::{Checkpoint, ErrorHistory, checkpoints};
pub use forecast::Forecast;
pub use level::{critical_z, sidak};
pub use mean::{Mean, Welch};
pub use metric::Metric;
pub use outliers::{Outlier, Outliers, PixelOutlier, find_outliers, noisiest_pixels, worst_of_pixel};
pub use render_until::{ErrorObserver, ErrorTarget, Outcome, StopCondition, render_until, resume_until};
pub use replicates::{Interval, Replicates};
pub use verdict::Verdict;
