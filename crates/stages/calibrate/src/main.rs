//! The binary of `calibrate`.

mod commands;

use std::process::ExitCode;

fn main() -> ExitCode {
    stage::run(commands::run)
}
