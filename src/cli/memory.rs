//! Whether a picture fits into memory: asked before it is rendered.

use std::fs::read_to_string;

use crate::describe::Scene;
use crate::error::{Error, Result};
use crate::film::memory::can_be_had;
use crate::reader::{Node, Place, locate};

/// # Errors
/// `Limit`, told of the flag or key that asks for the size.
pub fn check(scene: &Scene, root: &Node, file: &str) -> Result<()> {
    let needed = scene.film_memory();
    let free = free();
    if free.is_none_or(|free| needed <= free.into()) && can_be_had(needed) {
        return Ok(());
    }
    let is_flag = |pointer: &&str| root.get(pointer).is_some_and(|node| matches!(node.place, Place::Override(_)));
    let asked = ["/film/width", "/film/height", "/film/crop"].into_iter().find(is_flag).unwrap_or("/film");
    let scarce = free.filter(|free| needed > u128::from(*free));
    let there = scarce.map_or("more than the system gives".into(), |free| format!("{} are free", bytes(free.into())));
    Err(Error::Limit(locate(root, file, asked, format!("the picture needs {} of memory, {there}", bytes(needed)))))
}

/// `512 MiB`, `3 GiB`: rounded up.
fn bytes(bytes: u128) -> String {
    if bytes < 1 << 30 { format!("{} MiB", bytes.div_ceil(1 << 20)) } else { format!("{} GiB", bytes.div_ceil(1 << 30)) }
}

/// Bytes that the system, or the container that pt runs in, has left; `None` where neither says so.
fn free() -> Option<u64> {
    let system = read_to_string("/proc/meminfo").ok().and_then(|text| {
        let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
        line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib * 1024)
    });
    let number = |name: &str| read_to_string(format!("/sys/fs/cgroup/memory.{name}")).ok()?.trim().parse::<u64>().ok();
    let container = number("max").zip(number("current")).map(|(most, used)| most.saturating_sub(used));
    system.into_iter().chain(container).min()
}
