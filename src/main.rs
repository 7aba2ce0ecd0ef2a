//! `pt`: see `pt --help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    pt::cli::main_with(&[pt::integrators::ALL])
}
