//! Scenes of other programs that are not shipped with pt: tests ask them where they lie beside the package.

use std::path::{Path, PathBuf};

/// The folder of `PT_SHARED_DATA`, or `../shared/data` beside the package; `None`, and a sentence, where there is none.
pub fn shared(folder: &str) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let found = std::env::var_os("PT_SHARED_DATA").map_or_else(beside, PathBuf::from).join(folder);
    if !found.is_dir() {
        eprintln!("{}: no such folder, so that its scenes are not tested", found.display());
        return None;
    }
    Some(found)
}
