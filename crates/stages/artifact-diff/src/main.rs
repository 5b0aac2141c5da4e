//! `artifact-diff`: how far two artifacts are apart.

mod commands;

fn main() -> std::process::ExitCode {
    stage::run(commands::compare::compare)
}
