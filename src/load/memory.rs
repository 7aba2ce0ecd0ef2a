//! Check before the render that a picture fits into memory.

use std::fs::read_to_string;

use crate::build::film_memory;
use crate::describe::Scene;
use crate::error::memory::can_be_had;
use crate::error::{Error, Result};
use crate::reader::{Location, Node, locate};

/// Checks the size of the picture.
///
/// # Errors
/// `Limit`, at the flag or key that determines the size.
pub fn check(scene: &Scene, root: &Node, file: &str) -> Result<()> {
    let needed = film_memory(scene);
    let free = free();
    if free.is_none_or(|free| needed <= free.into()) && can_be_had(needed) {
        return Ok(());
    }
    let is_flag = |pointer: &&str| root.get(pointer).is_some_and(|node| matches!(node.location, Location::Override(_)));
    let asked = ["/film/width", "/film/height", "/film/crop"].into_iter().find(is_flag).unwrap_or("/film");
    let scarce = free.filter(|free| needed > u128::from(*free));
    let there = scarce.map_or("more than the system gives".into(), |free| format!("{} are free", bytes(free.into())));
    Err(Error::Limit(locate(root, file, asked, format!("the picture needs {} of memory, {there}", bytes(needed)))))
}

/// Size as text, rounded up: `512 MiB`, `3 GiB`.
fn bytes(bytes: u128) -> String {
    if bytes < 1 << 30 { format!("{} MiB", bytes.div_ceil(1 << 20)) } else { format!("{} GiB", bytes.div_ceil(1 << 30)) }
}

/// Free memory of the system, or of the container that pt runs in (bytes); `None` if neither is known.
fn free() -> Option<u64> {
    let system = read_to_string("/proc/meminfo").ok().and_then(|text| {
        let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
        line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib * 1024)
    });
    let number = |name: &str| read_to_string(format!("/sys/fs/cgroup/memory.{name}")).ok()?.trim().parse::<u64>().ok();
    let container = number("max").zip(number("current")).map(|(most, used)| most.saturating_sub(used));
    system.into_iter().chain(container).min()
}
