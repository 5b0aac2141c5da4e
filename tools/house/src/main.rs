//! Keeps the floor plan: who may use what, what flows where, and that every stage is built alike.
//!
//! `cargo run -q -p house -- check` reports what breaks a rule; `table` and `picture` draw the stages (with
//! `--write`, into the README and `docs/pipeline.svg`); `new-stage NAME` lays the ground for a new stage.
//! Exit code 0: all is well; 1: a fault, or something could not be read; 2: usage.

mod disk;
mod metadata;
mod model;
mod new_stage;
mod picture;
mod rules;
mod rust_text;
mod table;

use anyhow::{Context as _, bail};
use model::{Crate, House, Weight};
use std::io::Write as _;
use std::path::Path;
use std::process::ExitCode;

const USAGE: &str = "usage: house check | table [--write] | picture [--write] | new-stage NAME";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match arguments[..] {
        ["check"] => check(),
        ["table"] => show(table::draw),
        ["picture"] => show(picture::draw),
        ["table", "--write"] => disk::root().and_then(|root| write_table(&root)).map(|()| true),
        ["picture", "--write"] => disk::root().and_then(|root| write_picture(&root)).map(|()| true),
        ["new-stage", name] => disk::root().and_then(|root| new_stage(&root, name)).map(|()| true),
        _ => {
            say_error(USAGE);
            return ExitCode::from(2);
        }
    };
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            say_error(&format!("house: error: {error:#}"));
            ExitCode::FAILURE
        }
    }
}

/// A closed output is no reason to fail.
fn say(text: &str) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

fn say_error(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Reports all findings; true if none is a fault.
fn check() -> anyhow::Result<bool> {
    let house = disk::read_house(&disk::root()?)?;
    let findings = rules::check(&house);
    findings.iter().for_each(|(rule, finding)| say_error(&format!("{finding} [{rule}]")));
    let faults = findings.iter().filter(|(_, finding)| finding.weight == Weight::Fault).count();
    let crates = house.crates.len();
    let stages = house.stages().count();
    say(&format!(
        "house: {crates} crates, {stages} stages: {faults} faults, {} warnings",
        findings.len() - faults
    ));
    Ok(faults == 0)
}

fn ordered(house: &House) -> anyhow::Result<Vec<&Crate>> {
    match rules::order(house) {
        Ok(stages) => Ok(stages),
        Err(stuck) => bail!("what they read and write runs in a circle: {}", stuck.join(", ")),
    }
}

fn show(draw: impl Fn(&[&Crate]) -> String) -> anyhow::Result<bool> {
    let house = disk::read_house(&disk::root()?)?;
    say(draw(&ordered(&house)?).trim_end());
    Ok(true)
}

fn write_table(root: &Path) -> anyhow::Result<()> {
    let house = disk::read_house(root)?;
    let readme = house.text(table::FILE).with_context(|| format!("{} is missing", table::FILE))?;
    let fresh = table::replace(readme, &table::draw(&ordered(&house)?))
        .map_err(|message| anyhow::anyhow!("{} {message}", table::FILE))?;
    disk::write(&root.join(table::FILE), &fresh)
}

fn write_picture(root: &Path) -> anyhow::Result<()> {
    let house = disk::read_house(root)?;
    disk::write(&root.join(picture::FILE), &picture::draw(&ordered(&house)?))
}

fn new_stage(root: &Path, name: &str) -> anyhow::Result<()> {
    new_stage::create(root, name)?;
    write_table(root)?;
    write_picture(root)?;
    say(&new_stage::next_steps(name));
    Ok(())
}
