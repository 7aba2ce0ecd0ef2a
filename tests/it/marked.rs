//! Faulty texts in which a mark `^` gives the position of each fault.

use pt::describe::{self, Scene};

/// The scene, or its faults as the user sees them, without the file's name.
pub fn read(text: impl AsRef<[u8]>) -> Result<Scene, Vec<String>> {
    describe::parse(text.as_ref(), "s").map_err(|e| e.to_string().lines().map(|line| line.trim_start_matches("s:").to_owned()).collect())
}

/// A scene with `body` as its third key, from line 2 on.
pub fn scene(body: &str) -> String {
    format!("{{\"pt\": 1, \"camera\": {{}},\n{body}}}")
}

/// Returns the text without its marks `^`, and their positions as `line:column: ` of the characters that follow them.
pub fn unmark(marked: &str) -> (String, Vec<String>) {
    let (mut text, mut places, mut line, mut column) = (String::new(), vec![], 1, 1);
    for c in marked.chars() {
        match c {
            '^' => places.push(format!("{line}:{column}: ")),
            '\n' => (line, column) = (line + 1, 1),
            _ => column += 1,
        }
        text.extend(Some(c).filter(|c| *c != '^'));
    }
    (text, places)
}

/// The faults of each text stand at its marks, in order, and begin as expected.
pub fn assert_faults(marked: &str, expected: &[&str]) {
    let (text, places) = unmark(marked);
    assert_eq!(places.len(), expected.len(), "a mark for each fault of {marked}");
    let faults = read(&text).expect_err(marked);
    for (i, (place, expected)) in places.iter().zip(expected).enumerate() {
        let found = faults.get(i).map_or("nothing", String::as_str);
        assert!(found.starts_with(&format!("{place}{expected}")), "{marked}\n expected {place}{expected}\n found    {found}");
    }
    assert_eq!(faults.len(), expected.len(), "{marked}\n also {:#?}", &faults[expected.len()..]);
}

/// Asserts that each text has one fault, at its mark, with the given beginning.
pub fn assert_fault(cases: &[(&str, &str)]) {
    cases.iter().for_each(|(marked, expected)| assert_faults(marked, &[expected]));
}

/// Calls [`assert_fault`] for texts within [`scene`].
pub fn assert_fault_in_scene(cases: &[(&str, &str)]) {
    cases.iter().for_each(|(marked, expected)| assert_faults(&scene(marked), &[expected]));
}
