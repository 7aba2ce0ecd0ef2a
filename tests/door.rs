//! How a program ends that cannot go on: with its exit code and one line of its own.
//!
//! The program is this test itself, started once more: `pt` with integrators that panic, and that take more memory than there is.

use std::process::{Command, ExitCode, Output};
use std::sync::Arc;

use pt::effects::Effects;
use pt::film::FilmSpec;
use pt::integrator::{CameraSample, Context, Entry, Estimator, Integrator};
use pt::math::Spectrum;
use pt::scene::Scene;
use schemars::JsonSchema;
use serde::Deserialize;

#[global_allocator]
static MEMORY: pt::Memory = pt::Memory;

/// Panics at one pixel.
#[derive(Clone, Default, Deserialize, JsonSchema)]
struct Panics {}

/// Integrator that asks for more memory than there are addresses.
#[derive(Clone, Default, Deserialize, JsonSchema)]
struct Gorges {}

struct AtPixel;

impl Integrator for Panics {
    fn prepare(&self, _: Arc<dyn Scene>, _: &FilmSpec) -> Box<dyn Estimator> {
        Box::new(AtPixel)
    }
}

impl Estimator for AtPixel {
    fn li(&self, camera: &CameraSample, _: &mut Context) -> Spectrum {
        assert!(camera.pixel.x < 7, "no light\nat pixel {}", camera.pixel);
        Spectrum::ONE
    }
}

impl Integrator for Gorges {
    fn prepare(&self, _: Arc<dyn Scene>, _: &FilmSpec) -> Box<dyn Estimator> {
        // (An answer is as good as the memory.)
        assert!(Vec::<u8>::new().try_reserve_exact(1 << 60).is_err());
        Box::new(AtPixel)
    }
}

const TABLE: &[Entry] = &[Entry::of::<Panics>("panics", "panics", Effects::NONE), Entry::of::<Gorges>("gorges", "gorges", Effects::NONE)];

/// Set where this is the program that is tested.
const IS_PROGRAM: &str = "PT_TESTED";

fn main() -> ExitCode {
    if std::env::var_os(IS_PROGRAM).is_some() {
        return pt::cli::main_with(&[pt::integrators::ALL, TABLE]);
    }
    let folder = tempfile::tempdir().expect("a folder");
    let scene = r#"{"pt": 1, "camera": {}, "film": {"width": 8, "height": 6}, "sampler": {"spp": 1}, "background": {"radiance": 1}}"#;
    std::fs::write(folder.path().join("a.json"), scene).expect("write");
    let run = |args: &[&str]| {
        let mut command = Command::new(std::env::current_exe().expect("this program"));
        command.current_dir(folder.path()).args(args).env(IS_PROGRAM, "1").env_remove("RUST_BACKTRACE").output().expect("it runs")
    };
    let said = |output: &Output| String::from_utf8_lossy(&output.stderr).into_owned();

    let panicked = run(&["a.json", "-q", "-i", "panics", "-o", "x.exr"]);
    let line = said(&panicked);
    assert_eq!(panicked.status.code(), Some(6), "{line}");
    assert!(line.starts_with("error: a.json: no light\\nat pixel [7, ") && line.lines().count() == 1, "{line}");
    assert!(line.contains("door.rs:") && line.ends_with("(this is a bug in pt, please report it)\n"), "{line}");

    let json = run(&["a.json", "-q", "-i", "panics", "-o", "x.exr", "--json-errors"]);
    let object: serde_json::Value = serde_json::from_slice(&json.stderr).expect("JSON");
    assert_eq!(object["exit_code"], 6, "{object}");

    let gorged = run(&["a.json", "-q", "-i", "gorges", "-o", "x.exr"]);
    assert_eq!((gorged.status.code(), said(&gorged).as_str()), (Some(4), "error: a.json: out of memory\n"));
    let json = run(&["a.json", "-q", "-i", "gorges", "-o", "x.exr", "--json-errors"]);
    let object: serde_json::Value = serde_json::from_slice(&json.stderr).expect("JSON");
    assert_eq!((&object["exit_code"], json.status.code()), (&4.into(), Some(4)), "{object}");

    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1, "only a.json is there");
    println!("door: panics end with 6, memory that ends with 4");
    ExitCode::SUCCESS
}
