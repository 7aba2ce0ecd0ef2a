//! Unique file names and titles of the methods.

use std::collections::BTreeSet;

use crate::compare::Comparison;

/// Title of the reference.
pub const REFERENCE: &str = "Reference";

/// Title of every method, different from all others and from that of the reference.
pub fn titles(comparison: &Comparison) -> Vec<String> {
    unique(comparison.methods.iter().map(|method| method.name.clone()), REFERENCE, " ")
}

/// File name without extension of every method: `nee · sobol` gives `nee-sobol`.
pub fn stems(comparison: &Comparison) -> Vec<String> {
    unique(comparison.methods.iter().map(|method| stem(&method.name)), "reference", "-")
}

/// Name in lower-case letters, digits and single hyphens.
fn stem(name: &str) -> String {
    let words = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    let stem = words.map(str::to_ascii_lowercase).collect::<Vec<_>>().join("-");
    if stem.is_empty() { "method".into() } else { stem }
}

fn unique(names: impl Iterator<Item = String>, taken: &str, joint: &str) -> Vec<String> {
    let mut taken = BTreeSet::from([taken.to_owned()]);
    let once = |name: String| {
        let others = (2..).map(|n| format!("{name}{joint}{n}"));
        let free = std::iter::once(name.clone()).chain(others).find(|name| !taken.contains(name)).unwrap_or_default();
        taken.insert(free.clone());
        free
    };
    names.map(once).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_has_a_name_of_its_own() {
        let names = ["nee · sobol", "NEE / Sobol", "reference", "…"].map(stem);
        assert_eq!(unique(names.into_iter(), "reference", "-"), ["nee-sobol", "nee-sobol-2", "reference-2", "method"]);
    }
}
