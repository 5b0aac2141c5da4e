//! The shell of a stage's binary: arguments → read → call → write.
//!
//! A binary hands its arguments type and a function to [`run`]; the shell parses, sets up threads, messages and
//! interruption, calls the function with a [`Run`], and maps what comes back to an exit code: 0 done, 1 the data
//! could not be processed, 2 usage. Data goes to standard output only; everything else to standard error. This is
//! the only crate that prints, and the only one that reads the clock.
//!
//! ```no_run
//! use clap::Parser;
//! #[derive(Parser)]
//! struct Arguments {
//!     #[command(flatten)]
//!     common: stage::Common,
//! }
//! impl stage::Arguments for Arguments {
//!     fn common(&self) -> &stage::Common {
//!         &self.common
//!     }
//! }
//! fn main() -> std::process::ExitCode {
//!     stage::run::<Arguments>(|run, _arguments| {
//!         run.result("answer", 42);
//!         Ok(())
//!     })
//! }
//! ```

mod footage;
mod inputs;
mod progress;
mod run;
mod shell;
mod stopwatch;

pub use footage::{CameraImages, Footage, ImageSource, check_take};
pub use inputs::{MeshOptions, load_take, resolve_unit};
pub use progress::Progress;
pub use run::Run;
pub use shell::{Arguments, Common, run};
pub use stopwatch::Stopwatch;
