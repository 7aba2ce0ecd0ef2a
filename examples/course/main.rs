//! Integrators, materials and light samplers of the course in docs/course, with the command line of pt.
//!
//! ```sh
//! cargo run --release --example course -- meter docs/course/furnace.json -i paths
//! cargo run --release --example course -- prove matte
//! ```

mod integrator;
mod light;
mod material;
mod method;

use std::process::ExitCode;

use pt::proof::{Options, incidences, prove};

/// Runs the command line of pt with the methods of the course, or `prove`.
pub fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["prove", name] => proved(name),
        _ => pt::cli::main_with(&[pt::integrators::ALL, integrator::METHODS, material::METHODS, light::METHODS]),
    }
}

/// Puts a model to the laws of scattering, and prints the report. Exit code 1 if a law is broken.
fn proved(name: &str) -> ExitCode {
    let Some(model) = material::model(name).or_else(|| light::model(name)) else {
        eprintln!("error: no model has the name {name:?}");
        return ExitCode::from(2);
    };
    let options = Options { samples: 50_000, incidences: incidences(&[0.9, 0.25]), ..Options::default() };
    let report = prove(&*model, &options);
    print!("{report}");
    ExitCode::from(u8::from(!report.accepts()))
}
