//! From the process's start to its exit code.

use crate::Run;
use clap::Parser;
use std::io::Write;
use std::process::ExitCode;
use std::sync::Mutex;

/// Options that every binary has.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Common options")]
pub struct Common {
    /// Say nothing but errors
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Say more
    #[arg(short, long, global = true)]
    pub verbose: bool,
    /// Number of threads [default: one per core]; results do not depend on it
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print the run's summary as JSON on standard output
    #[arg(long, global = true)]
    pub json: bool,
}

/// The arguments of a binary.
pub trait Arguments: Parser {
    /// The common ones among them.
    fn common(&self) -> &Common;
}

/// Runs a binary: parses the arguments, does `work`, reports, and returns the exit code.
pub fn run<A: Arguments + Send>(work: impl FnOnce(&mut Run, A) -> anyhow::Result<()> + Send) -> ExitCode {
    let arguments = match A::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            let code = u8::try_from(error.exit_code()).unwrap_or(2);
            // A closed pipe while printing the help is no failure.
            let _ = error.print();
            return ExitCode::from(code);
        }
    };
    let common = arguments.common().clone();
    let command = A::command();
    let mut run = Run::new(command.get_name(), command.get_version().unwrap_or_default(), common.clone());
    on_interrupt(run.name().to_string());
    let outcome = in_pool(common.threads, || work(&mut run, arguments).and_then(|()| run.conclude()));
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            complain(run.name(), &error);
            ExitCode::FAILURE
        }
    }
}

/// Stack of a worker; the work runs on one, and main threads have as much.
const STACK_BYTES: usize = 8 << 20;

/// Does the work on a thread of the pool, so that parallel parts find it awake: handed over from outside, half of a
/// short part can pass before the second thread has a processor. Results do not depend on the number of threads.
fn in_pool(threads: Option<u16>, work: impl FnOnce() -> anyhow::Result<()> + Send) -> anyhow::Result<()> {
    let threads = threads.map_or(0, usize::from);
    rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK_BYTES).build()?.install(work)
}

/// What ends the work, where stopping it is how it is meant to end.
static ENDING: Mutex<Option<Box<dyn FnOnce() + Send>>> = Mutex::new(None);

/// Sets what Ctrl-C does, once; the next one ends the process as ever.
pub(crate) fn end_with(end: impl FnOnce() + Send + 'static) {
    if let Ok(mut ending) = ENDING.lock() {
        *ending = Some(Box::new(end));
    }
}

/// On Ctrl-C or a request to terminate: no temporary file stays, and the exit code says so.
#[allow(clippy::disallowed_methods, reason = "this is where an interrupted process ends")]
fn on_interrupt(name: String) {
    let stop = move || {
        if let Some(end) = ENDING.lock().ok().and_then(|mut end| end.take()) {
            return end();
        }
        artifact::discard_unfinished();
        // Where even standard error is closed, the exit code remains.
        let _ = writeln!(
            std::io::stderr(),
            "\n{name}: interrupted; nothing unfinished stays under a finished name"
        );
        std::process::exit(130);
    };
    // Without a handler the process still stops; only its temporary files stay, under names that say so.
    let _ = ctrlc::set_handler(stop);
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        let io = cause.downcast_ref::<std::io::Error>();
        io.is_some_and(|io| io.kind() == std::io::ErrorKind::BrokenPipe)
            || cause.to_string().contains("Broken pipe (os error 32)")
    })
}

/// The chain of causes, outermost first, one line each.
fn complain(name: &str, error: &anyhow::Error) {
    let mut text = format!("{name}: error: {error}\n");
    for cause in error.chain().skip(1) {
        text.push_str(&format!("  because: {cause}\n"));
    }
    // Where even standard error is closed, the exit code remains.
    let _ = std::io::stderr().write_all(text.as_bytes());
}
