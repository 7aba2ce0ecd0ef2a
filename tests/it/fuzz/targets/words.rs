//! Words of the command line, and tables of numbers.

use std::path::Path;

use pt::cli::files_of;
use pt::rays::table::rows;

/// Arguments, one in each line; those of `-D` are put into a scene.
pub fn command_line(_: &Path, bytes: &[u8]) -> Result<bool, String> {
    let text = String::from_utf8_lossy(bytes);
    let words: Vec<&str> = text.split('\n').collect();
    let files = files_of(&words);
    if files.as_ref().is_err_and(|refusal| refusal.trim().is_empty()) {
        return Err("refused without a message".into());
    }
    let unsaid = |refusal: &pt::Error| !matches!(refusal, pt::Error::Usage(text) if !text.trim().is_empty());
    let scene = br#"{"pt": 1, "camera": {"look_at": {"from": [0, 0, 3], "to": [0, 0, 0]}}, "shapes": [{"type": "sphere"}]}"#;
    let mut root = pt::describe::root(scene, "s.json").expect("JSON");
    for (pointer, value) in words.iter().filter_map(|word| word.split_once('=')) {
        let read = root.set(pointer, value).and_then(|()| pt::describe::read(&root, "s.json").map(drop));
        if let Err(refusal) = &read
            && unsaid(refusal)
        {
            super::judged(read)?;
        }
    }
    Ok(files.is_ok())
}

/// A table of rays, and of points.
pub fn rays(_: &Path, bytes: &[u8]) -> Result<bool, String> {
    let Ok(text) = std::str::from_utf8(bytes) else { return Ok(false) };
    let refusals = [rows::<6>(text).err(), rows::<3>(text).err()];
    match refusals.iter().flatten().find(|fault| fault.line.is_none() || fault.message.trim().is_empty()) {
        Some(fault) => Err(format!("refused without a line: {fault:?}")),
        None => Ok(refusals.iter().any(Option::is_none)),
    }
}
