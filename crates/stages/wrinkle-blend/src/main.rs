//! `wrinkle-blend`: arguments → read → call → write.

mod commands;

use std::process::ExitCode;

fn main() -> ExitCode {
    stage::run::<commands::Arguments>(commands::run)
}
