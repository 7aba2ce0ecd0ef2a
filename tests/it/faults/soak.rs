//! A render that runs for long: its memory stays level, it opens no more and more files, and its pixels are those of a short render.

#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;
use std::process::Child;
use std::time::Duration;

use pt::output::exr;
use pt::part::Stored;

use super::{command, done, folder, wait_until};

/// Time of the render (s): a few seconds, or as this variable says.
fn seconds() -> f64 {
    std::env::var("PT_SOAK").ok().map_or(4.0, |text| text.parse().expect("PT_SOAK is a number of seconds"))
}

/// Number of readings during the render.
const READINGS: u32 = 200;

/// State of a process: resident memory (KiB), threads, open files.
type Reading = [u64; 3];

/// The state of a process; `None` once it has ended.
fn reading(child: &Child) -> Option<Reading> {
    let folder = Path::new("/proc").join(child.id().to_string());
    let status = fs::read_to_string(folder.join("status")).ok()?;
    let field = |name: &str| status.lines().find_map(|line| line.strip_prefix(name)?.split_whitespace().next()?.parse().ok());
    Some([field("VmRSS:")?, field("Threads:")?, fs::read_dir(folder.join("fd")).ok()?.count() as u64])
}

/// The greatest of each number.
fn greatest(readings: &[Reading]) -> Reading {
    readings.iter().fold([0; 3], |all, reading| std::array::from_fn(|k| all[k].max(reading[k])))
}

/// After a fifth of the time a render has all threads and files, and nearly all memory, that it will ever have. Its state is saved all the
/// time, on two threads. A few of its pixels, rendered by themselves on one thread with as many samples, have the same bits.
///
/// In four seconds only a leak of a mebibyte a second shows; `PT_SOAK=1800` renders for half an hour, in which 3 KiB a second do.
#[test]
fn a_long_render_stays_level() {
    let (folder, crop) = (folder(), [20, 28, 12, 18]);
    let at = folder.path();
    let line = format!("s.json --size 48x32 --threads 2 --time {} --checkpoint 0.2 -q -o x.exr", seconds());
    let mut child = command(at, &line).spawn().expect("it starts");
    wait_until("it has begun", || at.join("x.ptc").exists());
    let mut readings = vec![];
    while child.try_wait().expect("a child").is_none() {
        readings.extend(reading(&child));
        std::thread::sleep(Duration::from_secs_f64(seconds() / f64::from(READINGS)));
    }
    assert!(child.wait().expect("it ends").success());
    let (early, late) = readings.split_at(readings.len() / 5);
    let ([memory, threads, files], [later, more, others]) = (greatest(early), greatest(late));
    println!("memory {memory} KiB, later {later} KiB; {threads} threads, later {more}; {files} files, later {others}");
    assert!(early.len() > 3, "only {} readings: the machine is too busy", readings.len());
    // A film keeps a block of sums for each 1 in the binary form of the number of samples: at most three more of some 100 KiB in the rest of
    // the time. What is left of the 4 MiB is for the picture at the end, and for an allocator that gives memory back when it likes.
    assert!(later <= memory + 4096, "memory grows from {memory} to {later} KiB");
    assert!(more <= threads && others <= files + 2, "{threads} threads become {more}, {files} files {others}");

    let samples = Stored::open(&at.join("x.ptc")).unwrap_or_else(|e| panic!("{e}")).ranges()[0].end;
    let [x0, x1, y0, y1] = crop;
    done(at, &format!("s.json --size 48x32 --threads 1 --spp {samples} --crop {x0},{x1},{y0},{y1} -q -o part.exr"));
    let [whole, part] = ["x.exr", "part.exr"].map(|name| exr::read(&at.join(name)).unwrap_or_else(|e| panic!("{e}")).0);
    for channel in ["R", "G", "B"] {
        let [whole, part] = [&whole, &part].map(|image| image.channel(channel).expect("a channel"));
        for (k, value) in part.iter().enumerate() {
            let (x, y) = (x0 + k % (x1 - x0), y0 + k / (x1 - x0));
            assert_eq!(value.to_bits(), whole[y * 48 + x].to_bits(), "pixel {x}, {y} after {samples} samples");
        }
    }
}
