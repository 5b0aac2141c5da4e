//! The binary of `workbench`: arguments → pages, until it is stopped.

mod commands;

use clap::Parser;
use commands::Bench;
use loopback::{Limits, Server};
use stage::Run;
use std::path::PathBuf;
use std::process::ExitCode;

/// Pages in a browser on this machine for the steps that only people can do: names of dots, picks on the scan, paint
///
/// Works on a take's folder and writes what the stages read. What is not saved yet is kept in TAKE/.workbench, and so is what a
/// save replaced.
#[derive(Parser)]
#[command(name = "workbench", version)]
struct Arguments {
    /// The take's folder
    #[arg(value_name = "TAKE")]
    take: PathBuf,
    /// What a run made of the take so far, as `just take` leaves it: images by frame, cameras, wrinkles
    #[arg(long, value_name = "FOLDER")]
    run: Option<PathBuf>,
    /// Folder of the stages' programs, which the pages ask [default: that of this one]
    #[arg(long, value_name = "FOLDER")]
    programs: Option<PathBuf>,
    /// Port of 127.0.0.1 to serve on [default: a free one]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    port: u16,
    /// Print the address, and open no browser
    #[arg(long)]
    no_open: bool,
    #[command(flatten)]
    common: stage::Common,
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

fn main() -> ExitCode {
    stage::run::<Arguments>(serve)
}

fn serve(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    let bench = Bench::open(run, &arguments.take, arguments.run.as_deref(), arguments.programs)?;
    let server = Server::bind(arguments.port, Limits::default())?;
    let (url, stopper) = (server.url(), server.stopper());
    run.until_interrupted(move || stopper.stop());
    run.report(&url)?;
    run.say("  the pages are served to this machine until you stop this with Ctrl-C");
    if !arguments.no_open && !loopback::open_in_browser(&url) {
        run.say("  no browser could be opened: open the address yourself");
    }
    server.run(bench)?;
    Ok(())
}
