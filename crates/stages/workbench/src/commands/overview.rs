//! What is there of a take, and what each page waits for.

use super::Bench;
use artifact::Take;
use serde::Serialize;
use workbench::{Need, Page, Place, pages};

#[derive(Serialize)]
pub(crate) struct Overview {
    /// Name of the take's folder.
    take: String,
    manifest: Option<Take>,
    /// Whether `--run` was given.
    has_run: bool,
    pages: Vec<Shown>,
}

#[derive(Serialize)]
struct Shown {
    id: &'static str,
    title: &'static str,
    does: &'static str,
    writes: &'static str,
    next: &'static str,
    needs: Vec<ShownNeed>,
}

#[derive(Serialize)]
struct ShownNeed {
    /// Where it is, or would be.
    path: String,
    what: &'static str,
    made_by: &'static str,
    is_optional: bool,
    is_there: bool,
}

pub(crate) fn overview(bench: &Bench) -> Overview {
    let take = bench.take.folder();
    let name = take.file_name().unwrap_or(take.as_os_str()).to_string_lossy().into_owned();
    let pages = pages().iter().map(|page| shown(bench, page)).collect();
    Overview { take: name, manifest: bench.manifest.clone(), has_run: bench.run.is_some(), pages }
}

fn shown(bench: &Bench, page: &Page) -> Shown {
    let Page { id, title, does, needs, writes, next } = *page;
    Shown { id, title, does, writes, next, needs: needs.iter().map(|need| shown_need(bench, need)).collect() }
}

fn shown_need(bench: &Bench, need: &Need) -> ShownNeed {
    let Need { places, what, made_by, is_optional } = *need;
    let named = |(place, path): &(Place, &str)| match place {
        Place::Take => format!("TAKE/{path}"),
        Place::Run => format!("RUN/{path}"),
    };
    let path = places.iter().map(named).collect::<Vec<_>>().join(" or ");
    ShownNeed { path, what, made_by, is_optional, is_there: bench.find(places).is_some() }
}
