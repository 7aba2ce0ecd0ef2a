//! State of a render, as its page is told.

use serde::Serialize;

/// State of a render. As JSON it is the data of an event.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Status {
    /// How far the render is.
    pub progress: Progress,
    /// What is known of the error.
    pub accuracy: Accuracy,
    /// The pixels that add most to the noise, the noisiest first.
    pub worst: Vec<WorstPixel>,
    /// The latest picture, if there is one. All of its pixels are new, as each wave of samples reaches all of them.
    pub picture: Option<PictureVersion>,
    /// Whether the page has ended the render, and its files are about to be written.
    pub is_stopping: bool,
    /// The words that close the render, after its end.
    pub closing: Option<String>,
}

#[cfg(feature = "serve")]
impl super::events::Followed for Status {
    fn is_last(&self) -> bool {
        self.closing.is_some()
    }
}

/// State of the work for a report. As JSON it is the data of an event.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ReportStatus {
    /// Version of the report that is shown; 0 before the first.
    pub version: u64,
    /// What is being done.
    pub doing: String,
    /// Share of it that is done.
    pub share: f64,
    /// Time since its beginning (s).
    pub elapsed: f64,
    /// Estimated remaining time (s).
    pub remaining: Option<f64>,
    /// Whether a page has ended the work, and the report is about to be written.
    pub is_stopping: bool,
    /// The words that close the work, after its end.
    pub closing: Option<String>,
}

#[cfg(feature = "serve")]
impl super::events::Followed for ReportStatus {
    fn is_last(&self) -> bool {
        self.closing.is_some()
    }
}

/// How far a render is.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Progress {
    /// Samples per pixel so far.
    pub samples: f64,
    /// Samples per pixel that are expected, if they end the render.
    pub planned: Option<f64>,
    /// Share of the work that is done, by samples or by time.
    pub share: f64,
    /// Time since the beginning (s).
    pub elapsed: f64,
    /// Estimated remaining time (s).
    pub remaining: Option<f64>,
}

/// What is known of the error. It is measured from time to time.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Accuracy {
    /// Samples per pixel after which it was measured.
    pub samples: f64,
    /// Relative error, and the lower and upper bound of its interval, if they are established.
    pub error: Option<[f64; 3]>,
    /// The price of a smaller error, or the reason why none is stated, as in the closing line.
    pub words: String,
}

/// A pixel and its share of the noise of all pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WorstPixel {
    /// Column and row, in the whole picture.
    pub pixel: [u32; 2],
    /// Its share of the squared relative error.
    pub share: f64,
}

/// A picture, and the part of the whole that it shows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PictureVersion {
    /// Number of the picture, from 1.
    pub number: u64,
    /// Samples per pixel.
    pub samples: f64,
    /// First pixel (column, row) in the whole picture.
    pub origin: [u32; 2],
    /// Width and height (pixels).
    pub size: [u32; 2],
}
