//! Times of frames from a response basis: what `just bench linear-shell` runs.
//!
//! `frame_times --vertices N --handles N [--threads N] [--repeats N]` prints one JSON object:
//! seconds `[cpu, wall]` of every repeat, for one frame and for a batch of sixteen. What the numbers are does not change the
//! time, so the basis is made up.
#![allow(
    clippy::disallowed_methods,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a benchmark reads the clock, prints, and may fail"
)]

use linear_shell::Basis;
use nalgebra::Vector3;
use std::time::Instant;

/// Seconds that this process' threads have been on a processor.
fn cpu_seconds() -> f64 {
    let tasks = std::fs::read_dir("/proc/self/task").unwrap();
    let spent = tasks.filter_map(|task| {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse::<f64>().ok()
    });
    spent.sum::<f64>() * 1e-9
}

/// `[[cpu, wall], …]` of a batch, the first time apart, which touches fresh memory.
fn times(basis: &Basis, rest: &[f32], batch: usize, repeats: usize) -> String {
    let displacement = |i: usize| Vector3::new(i as f64 * 0.1, 1.0 - i as f64 * 0.02, (i % 7) as f64);
    let handles = basis.values().len() / basis.vertex_count();
    let frames: Vec<Vec<Vector3<f64>>> =
        (0..batch).map(|frame| (0..handles).map(|handle| displacement(frame + handle)).collect()).collect();
    let mut out = Vec::new();
    basis.deform_into(rest, &frames, 1.0, &mut out);
    let time = |_| {
        let (cpu, wall) = (cpu_seconds(), Instant::now());
        basis.deform_into(rest, &frames, 1.0, &mut out);
        format!("[{:.5},{:.5}]", cpu_seconds() - cpu, wall.elapsed().as_secs_f64())
    };
    format!("[{}]", (0..repeats).map(time).collect::<Vec<_>>().join(","))
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |name: &str, default: usize| {
        let at = words.iter().position(|word| word == name);
        at.map_or(default, |at| words[at + 1].parse().unwrap())
    };
    let (vertices, handles) = (number("--vertices", 700_000), number("--handles", 90));
    let value = |i: usize| (i % 997) as f32 * 1e-4;
    let basis = Basis::new((0..vertices * handles).map(value).collect(), handles);
    let rest: Vec<f32> = (0..vertices * 3).map(value).collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(number("--threads", 1)).build().unwrap();
    let repeats = number("--repeats", 5);
    let (one, batch) = pool.install(|| (times(&basis, &rest, 1, repeats), times(&basis, &rest, 16, repeats)));
    println!("{{\"frame\":{one},\"batch16\":{batch}}}");
}
