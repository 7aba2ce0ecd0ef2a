//! The program `pt`: see `pt --help`.

use std::process::ExitCode;

#[global_allocator]
static MEMORY: pt::Memory = pt::Memory;

fn main() -> ExitCode {
    pt::cli::main_with(&[pt::integrators::ALL])
}
