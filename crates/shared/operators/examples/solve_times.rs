//! Times and checks of the sparse solve on a problem from a file: what `just bench operators` runs.
//!
//! `solve_times PROBLEM [--threads N] [--order ORDER] [--repeats N]` prints one JSON object. `PROBLEM` is
//! little-endian: three u64 (vertices, entries, handles), then positions (#V × 3 f64), row starts (#V + 1 u64), columns
//! (u32), values (f64), handle vertices (u32). `ORDER` is a list of u32 to be used instead of the nested dissection.
#![allow(
    clippy::disallowed_methods,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a benchmark reads the clock and a file, prints, and may fail"
)]

use nalgebra::Point3;
use operators::{CsMat, Dirichlet, Factor, Ordering};
use std::collections::BTreeMap;
use std::time::Instant;

struct Problem {
    points: Vec<Point3<f64>>,
    matrix: CsMat<f64>,
    handles: Vec<u32>,
}

/// Takes values off the front of a byte slice.
fn take<const N: usize, T>(bytes: &mut &[u8], count: usize, from: fn([u8; N]) -> T) -> Vec<T> {
    let (head, tail) = bytes.split_at(count * N);
    *bytes = tail;
    head.chunks_exact(N).map(|chunk| from(chunk.try_into().unwrap())).collect()
}

impl Problem {
    fn read(path: &str) -> Self {
        let file = std::fs::read(path).unwrap();
        let mut bytes = &file[..];
        let sizes = take(&mut bytes, 3, u64::from_le_bytes);
        let [vertices, entries, handles] = [0, 1, 2].map(|i| sizes[i] as usize);
        let coordinates = take(&mut bytes, vertices * 3, f64::from_le_bytes);
        let starts = take(&mut bytes, vertices + 1, u64::from_le_bytes).into_iter().map(|x| x as usize);
        let starts = starts.collect::<Vec<_>>();
        let columns: Vec<usize> =
            take(&mut bytes, entries, u32::from_le_bytes).into_iter().map(|x| x as usize).collect();
        let values = take(&mut bytes, entries, f64::from_le_bytes);
        Self {
            points: coordinates.chunks_exact(3).map(|p| Point3::new(p[0], p[1], p[2])).collect(),
            matrix: CsMat::new((vertices, vertices), starts, columns, values),
            handles: take(&mut bytes, handles, u32::from_le_bytes),
        }
    }
}

/// Seconds that this process' threads have been on a processor.
fn cpu_seconds() -> f64 {
    let tasks = std::fs::read_dir("/proc/self/task").unwrap();
    let spent = tasks.filter_map(|task| {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse::<f64>().ok()
    });
    spent.sum::<f64>() * 1e-9
}

/// MiB of a line of `/proc/self/status`.
fn memory_mib(line: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let found = status.lines().find(|text| text.starts_with(line)).unwrap();
    found.split_whitespace().nth(1).unwrap().parse::<f64>().unwrap() / 1024.0
}

/// Named times in seconds, `{"name": [[cpu, wall], …], …}`.
#[derive(Default)]
struct Clock {
    times: BTreeMap<String, Vec<String>>,
}

impl Clock {
    fn time<T>(&mut self, name: &str, work: impl FnOnce() -> T) -> T {
        let (cpu, wall) = (cpu_seconds(), Instant::now());
        let result = work();
        let (cpu, wall) = (cpu_seconds() - cpu, wall.elapsed().as_secs_f64());
        self.times.entry(name.to_string()).or_default().push(format!("[{cpu:.5},{wall:.5}]"));
        result
    }

    fn json(&self) -> String {
        let of = |(name, times): (&String, &Vec<String>)| format!("\"{name}\":[{}]", times.join(","));
        format!("{{{}}}", self.times.iter().map(of).collect::<Vec<_>>().join(","))
    }
}

/// A field of millimetres at every vertex that handles on a face would not refuse.
fn manufactured(points: &[Point3<f64>]) -> Vec<f64> {
    points.iter().map(|p| 8.0 * (p.x * 0.031).sin() + 5.0 * (p.y * 0.027).cos() + 0.02 * p.z).collect()
}

/// A sum of products as if in twice the precision [OgitaRumpOishi2005]: the rounding of a right-hand side must not be
/// taken for the solver's.
fn exact_dot(products: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut sum, mut lost) = (0.0f64, 0.0f64);
    for (a, b) in products {
        let product = a * b;
        let next = sum + product;
        let part = next - sum;
        lost += a.mul_add(b, -product) + ((sum - (next - part)) + (product - part));
        sum = next;
    }
    sum + lost
}

/// Largest deviations of the factor's solution from a field, plain and refined, its right-hand side being the matrix times the
/// field.
fn accuracy_mm(problem: &Problem, factor: &Factor, clock: &mut Clock) -> [f64; 2] {
    let truth = manufactured(&problem.points);
    let mut free = vec![false; truth.len()];
    factor.order().iter().for_each(|&vertex| free[vertex as usize] = true);
    let row = |&vertex: &u32| -> f64 {
        let row = problem.matrix.outer_view(vertex as usize).unwrap();
        exact_dot(
            row.iter().filter(|&(column, _)| free[column]).map(|(column, &value)| (value, truth[column])),
        )
    };
    let right: Vec<f64> = factor.order().iter().map(row).collect();
    let mut solution = right.clone();
    let error = |solution: &[f64]| {
        let error = |(&vertex, &value): (&u32, &f64)| (value - truth[vertex as usize]).abs();
        factor.order().iter().zip(solution).map(error).fold(0.0, f64::max)
    };
    factor.solve_in_place(&mut solution, 1);
    let plain = error(&solution);
    clock.time("refine", || factor.refine_in_place(&problem.matrix, &right, &mut solution, 1));
    [plain, error(&solution)]
}

fn run(problem: &Problem, order: Option<&str>, repeats: usize) -> String {
    let mut clock = Clock::default();
    let before_mib = memory_mib("VmRSS");
    let ordering = match order {
        Some(path) => {
            let bytes = std::fs::read(path).unwrap();
            let vertices = take(&mut &bytes[..], bytes.len() / 4, u32::from_le_bytes);
            Ordering::from_saved(vertices, problem.points.len()).unwrap()
        }
        None => clock.time("ordering", || Ordering::nested_dissection(&problem.matrix, &problem.points)),
    };
    let system = clock
        .time("factor", || Dirichlet::factor(&problem.matrix, &problem.handles, &[], &ordering).unwrap());
    let factor_mib = memory_mib("VmHWM") - before_mib;
    let values = |axis: usize| (0..problem.handles.len()).map(|i| ((i * 7 + axis * 3) % 11) as f64).collect();
    let columns: Vec<Vec<f64>> = (0..3).map(values).collect();
    let factor = system.free_factor();
    let mut packed = vec![1.0; factor.order().len() * 3];
    for _ in 0..repeats {
        clock.time("solve3", || factor.solve_in_place(&mut packed, 3));
    }
    clock.time("frame", || system.solve(&columns));
    clock.time("basis", || system.responses(true));
    let [accuracy, refined] = accuracy_mm(problem, factor, &mut clock);
    format!(
        "{{\"vertices\":{},\"entries\":{},\"stored\":{},\"before_mib\":{before_mib:.1},\"factor_mib\":{factor_mib:.1},\
         \"accuracy_mm\":{accuracy:e},\"refined_mm\":{refined:e},\"seconds\":{}}}",
        problem.points.len(),
        factor.entry_count(),
        factor.stored_count(),
        clock.json()
    )
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let option = |name: &str| words.iter().position(|word| word == name).map(|at| words[at + 1].as_str());
    let number = |name: &str, default: usize| option(name).map_or(default, |text| text.parse().unwrap());
    let problem = Problem::read(&words[0]);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(number("--threads", 1)).build().unwrap();
    println!("{}", pool.install(|| run(&problem, option("--order"), number("--repeats", 3))));
}
