//! Read, bake, write.

use super::{Arguments, input};
use anyhow::Context;
use artifact::{BakedMaps, BakedTile, Staged, npy, picture};
use bake::{
    Bits, Low, Params, Report, Tile, bake, displacement_codes, displacement_range, normal_codes, steps,
};
use serde::Serialize;
use stage::Run;
use std::path::PathBuf;
use std::sync::Mutex;

/// What changes the outputs.
#[derive(Serialize)]
struct Parameters<'a> {
    #[serde(flatten)]
    params: &'a Params,
    frame: Option<i64>,
    green: artifact::GreenAxis,
    bits: &'a str,
}

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    let Arguments { size, samples, reach_mm, padding, frame, .. } = arguments;
    let params = Params { size, samples, reach_mm, padding };
    params.check()?;
    let green = arguments.green;
    run.parameters(&Parameters { params: &params, frame, green, bits: &arguments.bits })?;
    let surfaces = input::read(run, &arguments)?;
    let index = arguments.out.join("maps.json");
    let outputs: Vec<PathBuf> =
        [Some(index.clone()), arguments.tangents.clone()].into_iter().flatten().collect();
    let outputs: Vec<&std::path::Path> = outputs.iter().map(PathBuf::as_path).collect();
    run.check_outputs(&outputs)?;
    run.check_folders(&outputs)?;
    let progress = Mutex::new(run.progress("bands", Some(steps(&surfaces.low, &params) as u64)));
    let step = || {
        if let Ok(mut progress) = progress.lock() {
            progress.step();
        }
    };
    let baked = run.timed("bake", || bake(&surfaces.low, &surfaces.high, &params, step));
    drop(progress);
    let (tiles, report) = baked.with_context(|| arguments.low.display().to_string())?;
    tell(run, &report);
    let range = displacement_range(report.displacement_mm);
    let mut staged = Vec::new();
    let mut entries = Vec::new();
    for tile in &tiles {
        entries.push(write(&arguments, tile, tiles.len() > 1, range, &mut staged)?);
    }
    if let Some(path) = &arguments.tangents {
        let values = tangents(&surfaces.low);
        staged.push(npy::write(path, [values.len() / 4, 4], &values)?);
    }
    let maps = BakedMaps {
        mesh: surfaces.low_ref,
        frame,
        size,
        green,
        black_mm: range[0],
        white_mm: range[1],
        tiles: entries,
    };
    staged.push(artifact::write_document(&index, &maps)?);
    run.publish(staged)
}

/// Writes the pictures of a tile.
fn write(
    arguments: &Arguments,
    tile: &Tile,
    numbered: bool,
    range: [f64; 2],
    staged: &mut Vec<Staged>,
) -> anyhow::Result<BakedTile> {
    let named = |what: &str, ending: &str| match numbered {
        true => format!("{what}.{}.{ending}", tile.number),
        false => format!("{what}.{ending}"),
    };
    let entry = BakedTile {
        tile: tile.number,
        normal: named("normal", "png"),
        displacement_exr: named("displacement", "exr"),
        displacement: named("displacement", "png"),
    };
    let (size, at) = (tile.size, |name: &str| arguments.out.join(name));
    staged.push(match arguments.bits == "8" {
        true => {
            let codes = normal_codes(&tile.normals, Bits::Eight, arguments.green);
            let codes: Vec<u8> = codes.into_iter().map(|code| code as u8).collect();
            picture::write_rgb8(&at(&entry.normal), size, size, &codes)?
        }
        false => {
            let codes = normal_codes(&tile.normals, Bits::Sixteen, arguments.green);
            picture::write_rgb16(&at(&entry.normal), size, size, &codes)?
        }
    });
    staged.push(artifact::write_exr(&at(&entry.displacement_exr), size, size, &tile.displacement_mm)?);
    let codes = displacement_codes(&tile.displacement_mm, range);
    staged.push(picture::write_gray16(&at(&entry.displacement), size, size, &codes)?);
    Ok(entry)
}

fn tangents(low: &Low) -> Vec<f32> {
    let row = |corner: &bake::Corner| {
        let along = corner.tangent.along;
        [along.x, along.y, along.z, corner.tangent.sign].map(|x| x as f32)
    };
    low.triangles.iter().flatten().flat_map(row).collect()
}

/// Missing more than this share of the samples is worth a warning.
const MANY_MISSED: f64 = 0.01;

fn tell(run: &mut Run, report: &Report) {
    run.result("coverage", report.coverage);
    run.result("samples", report.samples);
    run.result("missed", report.missed);
    run.result("beyond_horizon", report.beyond_horizon);
    run.result("displacement_min_mm", report.displacement_mm[0]);
    run.result("displacement_max_mm", report.displacement_mm[1]);
    let share = |count: usize| 100.0 * count as f64 / report.samples.max(1) as f64;
    if report.missed as f64 > MANY_MISSED * report.samples as f64 {
        run.warn(format!(
            "{:.1} % of the low-resolution mesh has no wrinkled surface over it and stays flat: raise --reach-mm, or leave those \
             parts out of the low-resolution mesh",
            share(report.missed)
        ));
    }
    if report.doubled > 0 {
        run.warn(format!(
            "{:.1} % of the samples lie under two triangles of the texture, and the first one counts: mirrored halves cannot show \
             wrinkles of their own; unwrap them side by side",
            share(report.doubled)
        ));
    }
    if report.beyond_horizon > 0 {
        run.warn(format!(
            "{:.1} % of the normals lean beyond the horizon of the low-resolution mesh and were held there: it is too coarse, or folds \
             close over themselves",
            share(report.beyond_horizon)
        ));
    }
}
