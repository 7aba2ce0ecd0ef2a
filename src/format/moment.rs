//! Points in time.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A date and a time with its distance from UTC, such as `2026-06-21T18:30+02:00`, or with `Z` for UTC.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
#[schemars(inline, with = "String")]
pub struct Moment {
    text: String,
    seconds: f64,
}

impl Moment {
    /// Time since the start of 1970, UTC (s).
    pub fn seconds(&self) -> f64 {
        self.seconds
    }
}

impl TryFrom<String> for Moment {
    type Error = String;

    fn try_from(text: String) -> Result<Moment, String> {
        let expected = || format!("expected a time with its distance from UTC, as 2026-06-21T18:30+02:00, found {text:?}");
        let timestamp: jiff::Timestamp = text.parse().map_err(|_| expected())?;
        Ok(Moment { seconds: timestamp.as_second() as f64, text })
    }
}

impl From<Moment> for String {
    fn from(moment: Moment) -> String {
        moment.text
    }
}
