//! Files of other programs that are not shipped with pt: tests read them where the environment variable PT_SHARED_DATA says.

use std::path::PathBuf;

/// The folder of that name within `PT_SHARED_DATA`; `None`, and a sentence about what is skipped, where there is none.
pub fn shared(folder: &str) -> Option<PathBuf> {
    let found = std::env::var_os("PT_SHARED_DATA").map(|data| PathBuf::from(data).join(folder)).filter(|found| found.is_dir());
    if found.is_none() {
        eprintln!("skipped: what {folder:?} of PT_SHARED_DATA holds");
    }
    found
}
