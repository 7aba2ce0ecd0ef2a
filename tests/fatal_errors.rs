//! Fatal errors: a panic and a lack of memory end the program with their exit code and one line of text.
//!
//! The program under test is this test itself, started again as `pt` with one integrator that panics and one that allocates too much
//! memory.

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

/// Integrator that panics at some pixels.
#[derive(Clone, Default, Deserialize, JsonSchema)]
struct Panics {}

/// Integrator that asks for more memory than there are addresses.
#[derive(Clone, Default, Deserialize, JsonSchema)]
struct AllocatesTooMuch {}

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

impl Integrator for AllocatesTooMuch {
    fn prepare(&self, _: Arc<dyn Scene>, _: &FilmSpec) -> Box<dyn Estimator> {
        // (The allocation fails in any case: it is of 2⁶⁰ bytes.)
        assert!(Vec::<u8>::new().try_reserve_exact(1 << 60).is_err());
        Box::new(AtPixel)
    }
}

const TABLE: &[Entry] =
    &[Entry::of::<Panics>("panics", "panics", Effects::NONE), Entry::of::<AllocatesTooMuch>("allocates", "allocates", Effects::NONE)];

/// Environment variable that is set when this program runs as the program under test.
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
    assert!(line.contains("fatal_errors.rs:") && line.ends_with("(this is a bug in pt, please report it)\n"), "{line}");

    let json = run(&["a.json", "-q", "-i", "panics", "-o", "x.exr", "--json-errors"]);
    let object: serde_json::Value = serde_json::from_slice(&json.stderr).expect("JSON");
    assert_eq!(object["exit_code"], 6, "{object}");

    let out_of_memory = run(&["a.json", "-q", "-i", "allocates", "-o", "x.exr"]);
    assert_eq!((out_of_memory.status.code(), said(&out_of_memory).as_str()), (Some(4), "error: a.json: out of memory\n"));
    let json = run(&["a.json", "-q", "-i", "allocates", "-o", "x.exr", "--json-errors"]);
    let object: serde_json::Value = serde_json::from_slice(&json.stderr).expect("JSON");
    assert_eq!((&object["exit_code"], json.status.code()), (&4.into(), Some(4)), "{object}");

    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1, "only a.json is there");
    println!("fatal errors: a panic ends with exit code 6, a lack of memory with 4");
    ExitCode::SUCCESS
}
