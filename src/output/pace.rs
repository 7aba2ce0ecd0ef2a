//! How often a picture or a report is shown while the work for it goes on: seldom enough that showing it costs next to nothing.

use std::time::{Duration, Instant};

/// Shortest time between two pictures.
const REFRESH: Duration = Duration::from_millis(250);

/// When the next picture is made.
#[derive(Debug)]
pub struct Pace {
    /// Largest share of the time that making and sending pictures may take.
    share: f64,
    /// Time before which no picture is made.
    due: Option<Instant>,
}

impl Pace {
    /// A pace at which the first picture is due now.
    ///
    /// - `share`: largest share of the time that making and sending pictures may take
    pub fn new(share: f64) -> Pace {
        Pace { share, due: None }
    }

    /// The pace with the first picture due later.
    #[cfg(feature = "serve")]
    pub fn after(self, first: Duration) -> Pace {
        Pace { due: Some(Instant::now() + first), ..self }
    }

    /// Whether it is too early for the next picture.
    pub fn is_early(&self, now: Instant) -> bool {
        self.due.is_some_and(|due| now < due)
    }

    /// Delays the next picture until the time that this one took is a small share. Delays for several reasons add up.
    pub fn postpone(&mut self, took: Duration) {
        let now = Instant::now();
        let due = self.due.map_or(now, |due| due.max(now)) + took.div_f64(self.share);
        self.due = Some(due.max(now + REFRESH));
    }
}
