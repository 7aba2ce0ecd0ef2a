//! Tells the binary which commit it was built from; without a repository it is "source".

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    // A file that does not exist would count as changed in every build, so that all would be compiled again.
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]).filter(|log| Path::new(log).exists()) {
        println!("cargo:rerun-if-changed={log}");
    }
    let id = git(&["rev-parse", "--short=12", "HEAD"]);
    println!("cargo:rustc-env=PT_BUILD_ID={}", id.as_deref().unwrap_or("source"));
}

/// What git prints on one line; `None` without git or a repository.
fn git(arguments: &[&str]) -> Option<String> {
    let out = Command::new("git").args(arguments).output().ok().filter(|out| out.status.success())?;
    Some(String::from_utf8(out.stdout).ok()?.trim().into())
}
