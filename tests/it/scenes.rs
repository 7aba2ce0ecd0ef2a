//! Scenes whose radiance is known, and the test that every integrator finds it.

pub use pt::torture::Effort;
pub use pt::torture::radiance::*;

use pt::torture::Verdict;

/// Asks every integrator that simulates all effects of the scenes, and panics with a list of all wrong answers.
pub fn confirm(laws: Vec<KnownRadiance>, effort: Effort) {
    let mut wrong = vec![];
    for known in laws {
        let (name, cases) = (known.name.clone(), known.cases());
        assert!(!cases.is_empty(), "{name}: no integrator was asked");
        for (setup, expected, ask) in cases {
            let answer = ask(effort);
            if answer.verdict(expected) != Verdict::Holds {
                wrong.push(format!("{setup}: expected {expected}, found {answer:?}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
