//! Suggestions for unknown words ("did you mean"): the known word for the same thing, or the most similar word.

use super::synonyms::own_word;

/// Known word most similar to `word`, if a typing error explains the difference.
pub fn closest<'k>(word: &str, known: impl IntoIterator<Item = &'k str>) -> Option<&'k str> {
    // One error in a short word, and one more for every four letters.
    let slips = |k: &str| 1 + k.chars().count() / 4;
    // The difference in length is a lower bound of the errors. Without this check a name of megabytes would take minutes to
    // compare.
    let has_length = |k: &&str| word.len() / 4 <= k.chars().count() + slips(k);
    let near = |(distance, k): &(usize, &str)| *distance <= slips(k);
    let distances = known.into_iter().filter(has_length).map(|k| (strsim::damerau_levenshtein(word, k), k));
    distances.filter(near).min().map(|(_, k)| k)
}

/// Message for an unknown word: `unknown key "rougness", did you mean "roughness"?`
pub fn unknown(what: &str, word: &str, known: &[&str]) -> String {
    match own_word(word, known).or_else(|| closest(word, known.iter().copied())) {
        Some(near) => format!("unknown {what} {word:?}, did you mean {near:?}?"),
        None if known.is_empty() => format!("unknown {what} {word:?}, there are none"),
        None => format!("unknown {what} {word:?}, expected {}", choice(known)),
    }
}

/// List of words: `a`, `a or b`, `one of a, b, c`.
pub(super) fn choice(words: &[&str]) -> String {
    match words {
        [one] => one.to_string(),
        [one, other] => format!("{one} or {other}"),
        _ => format!("one of {}", words.join(", ")),
    }
}
