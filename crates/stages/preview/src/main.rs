//! `preview`: shaded pictures of a mesh or of frames of a sequence.

mod commands;

fn main() -> std::process::ExitCode {
    stage::run::<commands::Arguments>(commands::run)
}
