//! The page: the sentence, and the picture after each change with what differs.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::{Outcome, Trial, Verdict};
use crate::error::Result;
use crate::film::Image;
use crate::measure::format::per_cent;
use crate::output::page::{STYLE, fill, xml};
use crate::output::{Tonemap, png};

const TEMPLATE: &str = include_str!("assets/page.html");

/// Factor of the differences that the page shows.
const ENLARGED: f32 = 100.0;

/// The page as one HTML file that contains everything.
///
/// - `facts`: how it was made, in a sentence
/// - `tonemap`: of the pictures
///
/// # Errors
/// The errors of encoding a picture as PNG.
pub fn html(scene: &str, sentence: &str, facts: &str, trial: &Trial, outcomes: &[Outcome], tonemap: &Tonemap) -> Result<String> {
    let unchanged = trial.image();
    let rows = outcomes.iter().map(|outcome| row(outcome, &unchanged, tonemap)).collect::<Result<String>>()?;
    Ok(fill(TEMPLATE, |name| match name {
        "scene" => xml(scene),
        "style" => STYLE.into(),
        "sentence" => xml(sentence),
        "facts" => xml(facts),
        "enlarged" => ENLARGED.to_string(),
        "rows" => rows.clone(),
        other => unreachable!("the page asks for {other}"),
    }))
}

fn row(outcome: &Outcome, unchanged: &Image, tonemap: &Tonemap) -> Result<String> {
    let name = xml(&outcome.change.name);
    let (word, class, said) = match &outcome.verdict {
        Verdict::Same => ("the same", "same", String::new()),
        Verdict::Differs(said) => ("differs", "differs", said.iter().map(|text| format!("<p>{}</p>", xml(text))).collect()),
        Verdict::Refused(reason) => ("refused", "differs", format!("<p>{}</p>", xml(reason))),
    };
    let pictures = match &outcome.found {
        None => String::new(),
        Some(found) => {
            let whole = if found.pictures.same_bits {
                "same bits".into()
            } else {
                let [difference, error] = [found.pictures.whole.0, found.pictures.whole.1].map(per_cent);
                format!("{difference} ± {error} % in the mean")
            };
            let shown = picture(&found.image, &format!("{name}: the picture"), tonemap)?;
            let differs = picture(&difference(&found.image, unchanged), &format!("{name}: the difference"), tonemap)?;
            format!("{shown}{differs}<small>{whole}</small>")
        }
    };
    Ok(format!("<section class=\"change {class}\">\n<h2>{name}: <b>{word}</b></h2>\n{said}<div>{pictures}</div>\n</section>\n"))
}

fn picture(image: &Image, text: &str, tonemap: &Tonemap) -> Result<String> {
    let data = STANDARD.encode(png::encode(image, tonemap)?);
    let (width, height) = (2 * image.size.x, 2 * image.size.y);
    Ok(format!("<img alt=\"{text}\" title=\"{text}\" width=\"{width}\" height=\"{height}\" src=\"data:image/png;base64,{data}\">"))
}

/// The absolute difference of each value, enlarged.
fn difference(image: &Image, unchanged: &Image) -> Image {
    let mut difference = image.clone();
    for (channel, before) in difference.channels.iter_mut().zip(&unchanged.channels) {
        channel.values.iter_mut().zip(&before.values).for_each(|(a, b)| *a = ENLARGED * (*a - b).abs());
    }
    difference
}
