//! The picture that the others are measured against, and what is known of its own error.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::film::Image;
use crate::measure::{Refusal, RelativeError, format};
use crate::output::Attributes;
use crate::output::attributes::REFUSED;

/// Picture that the others are measured against.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Picture, with `StdErr.R`, `StdErr.G`, `StdErr.B` if its errors are known; they are subtracted.
    pub image: Image,
    /// Origin: a file, or how the picture was computed.
    pub origin: String,
    /// Relative error √relMSE of the reference itself, if known.
    pub error: Option<RelativeError>,
    /// Attributes of the picture's file.
    pub attributes: Attributes,
}

impl Reference {
    /// Reference from a file, with the error that its attributes state.
    pub fn from_file(image: Image, origin: String, attributes: Attributes) -> Reference {
        let error = stated_error(&attributes);
        Reference { image, origin, error, attributes }
    }

    /// Returns whether the interval of the reference's own error ends at or below `target`. A reference without a stated error is trusted.
    pub fn resolves(&self, target: f64, confidence: f64) -> bool {
        self.error.is_none_or(|error| error.stated(confidence).is_ok_and(|error| error.high <= target))
    }

    /// Its own error in words: `relative error 2.1 % (95 %: 2–2.2)`.
    pub fn own_error(&self, confidence: f64) -> String {
        match self.error.map(|error| error.stated(confidence)) {
            None => "whose own error is not stated".into(),
            Some(Err(refusal)) => format!("whose own error cannot be established ({})", refusal.words().0),
            Some(Ok(error)) => format!("relative error {}", format::error(&error, confidence)),
        }
    }
}

/// Error that the attributes of a file state, with the uncertainty that follows from its interval, or an error that cannot be stated if
/// they say so. `None` if they state no interval.
fn stated_error(attributes: &Attributes) -> Option<RelativeError> {
    let text = |name: &str| attributes.iter().find(|(own, _)| own == name).map(|(_, value)| value.to_string());
    let number = |name: &str| text(name)?.parse::<f64>().ok().filter(|x| x.is_finite());
    if let Some(refusal) = text(REFUSED) {
        return Some(RelativeError::refused(if refusal == Refusal::HeavyTail.to_string() {
            Refusal::HeavyTail
        } else {
            Refusal::TooNoisy
        }));
    }
    let value = number("pt/relativeError").filter(|value| *value >= 0.0)?;
    let quantile = |confidence: f64| Normal::standard().inverse_cdf(0.5 + 0.5 * confidence);
    let reach = (number("pt/relativeErrorHigh")? / value).ln();
    let confidence = number("pt/confidence").filter(|confidence| *confidence > 0.0 && *confidence < 1.0)?;
    let is_interval = reach.is_finite() && reach >= 0.0;
    // Whoever states an error has found that enough pixels share the noise.
    is_interval.then(|| RelativeError { value, spread: reach / quantile(confidence), effective_pixels: f64::INFINITY })
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::super::synthetic::image;
    use super::*;

    fn stated(image: Image, facts: &[(&str, f64)]) -> Reference {
        let attributes = facts.iter().map(|(name, value)| ((*name).to_owned(), value.to_string().into())).collect();
        Reference::from_file(image, "r.exr".into(), attributes)
    }

    /// 0.02 to 0.03 with 68.27 %: one standard deviation of the logarithm is ln 1.5. With 95.45 % it would be half of that.
    #[test]
    fn the_error_of_a_file_is_that_of_its_attributes() {
        let facts = |confidence: f64| [("pt/relativeError", 0.02), ("pt/relativeErrorHigh", 0.03), ("pt/confidence", confidence)];
        for (confidence, deviations) in [(0.682_689, 1.0), (0.954_5, 2.0)] {
            let error = stated(image(|_| 1.0, 0.02), &facts(confidence)).error.expect("an error");
            assert_eq!(error.value, 0.02);
            assert_relative_eq!(error.spread, 1.5f64.ln() / deviations, max_relative = 1e-4);
        }
        assert!(stated(image(|_| 1.0, 0.02), &[]).error.is_none());
        assert!(stated(image(|_| 1.0, 0.02), &[("pt/relativeError", 0.02)]).error.is_none(), "an error without an interval");
    }

    /// A file that says that its error cannot be established resolves no error, however large.
    #[test]
    fn a_refusal_of_a_file_is_a_refusal() {
        for refusal in [Refusal::HeavyTail, Refusal::TooNoisy] {
            let attributes = vec![(REFUSED.to_owned(), refusal.to_string().into())];
            let reference = Reference::from_file(image(|_| 1.0, 0.02), "r.exr".into(), attributes);
            assert_eq!(reference.error.and_then(|error| error.refusal()), Some(refusal));
            assert!(!reference.resolves(10.0, 0.95));
            assert_eq!(reference.own_error(0.95), format!("whose own error cannot be established ({})", refusal.words().0));
        }
    }
}
