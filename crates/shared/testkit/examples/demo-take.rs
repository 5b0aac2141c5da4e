//! Writes a take of the synthetic face as a user would bring it, and apart from it the truth.
//!
//! `cargo run -p testkit --example demo-take -- OUT_DIR [--seed 1] [--vertices 30000] [--frames 25] [--noise 0]
//! [--dropouts]`

use artifact::{
    Axis, Clock, Consent, FileRef, FrameWriter, HeadPose, LargeScale, MeshRef, Take, TakeRef, Trajectories3d,
    Unit, file_name, pc2, sha256,
};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use testkit::face::Face;
use testkit::{Performance, Recording};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

struct Arguments {
    out: PathBuf,
    seed: u64,
    vertices: usize,
    frames: usize,
    recording: Recording,
}

fn arguments() -> Result<Arguments> {
    let mut parsed = Arguments {
        out: PathBuf::new(),
        seed: 1,
        vertices: Face::VERTEX_COUNT,
        frames: 25,
        recording: Recording::default(),
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--seed" => parsed.seed = value()?.parse()?,
            "--vertices" => parsed.vertices = value()?.parse()?,
            "--frames" => parsed.frames = value()?.parse()?,
            "--noise" => parsed.recording.noise_mm = value()?.parse()?,
            "--dropouts" => parsed.recording.dropouts = true,
            option if option.starts_with('-') => return Err(format!("unknown option {option}").into()),
            folder => parsed.out = folder.into(),
        }
    }
    match parsed.out.as_os_str().is_empty() || parsed.frames == 0 {
        true => {
            Err("say where to write: demo-take OUT_DIR [--seed 1] [--vertices 30000] [--frames 25]".into())
        }
        false => Ok(parsed),
    }
}

fn main() -> Result<()> {
    let Arguments { out, seed, vertices, frames, mut recording } = arguments()?;
    recording.seed = seed;
    let performance = Performance::new(Face::new(seed, vertices), frames);
    let scan = write_scan(&out, &performance)?;
    let take = write_take(&out, &performance, seed, &scan)?;
    let markers = performance.record(&recording, Some(take.clone()));
    markers.write::<Trajectories3d>(&out.join("markers.jsonl"))?.publish()?;
    artifact::stage_bytes(&out.join("picks.csv"), picks(&performance).as_bytes())?.publish()?;
    write_truth(&out.join("truth"), &performance, &recording, scan, take)
}

fn reference(path: &Path) -> artifact::Result<FileRef> {
    Ok(FileRef { name: file_name(path), sha256: sha256(path)? })
}

fn write_scan(out: &Path, performance: &Performance) -> Result<MeshRef> {
    let path = out.join("scan.obj");
    let mesh = performance.face.mesh();
    artifact::write_mesh(&path, mesh, Unit::Mm)?.publish()?;
    Ok(MeshRef { file: reference(&path)?, unit: Unit::Mm, vertex_count: mesh.positions.len() })
}

fn write_take(out: &Path, performance: &Performance, seed: u64, scan: &MeshRef) -> Result<TakeRef> {
    let path = out.join("take.json");
    let consent = Consent {
        licence: "synthetic: nobody was recorded".to_string(),
        credit: None,
        notes: Some(format!("synthetic face, seed {seed}")),
    };
    let take = Take {
        subject: format!("synthetic-{seed}"),
        session: "demo".to_string(),
        take: format!("demo-{seed}"),
        rate: performance.rate,
        start_timecode: None,
        first_frame: performance.first_frame,
        clock: Clock::Mocap,
        cameras: Vec::new(),
        mesh_unit: Unit::Mm,
        mesh_up: Axis::Y,
        references: [("scan".to_string(), scan.file.clone())].into(),
        consent,
    };
    artifact::write_document(&path, &take)?.publish()?;
    Ok(TakeRef { take: take.take, session: take.session, sha256: sha256(&path)? })
}

/// A user's picks: on vertices of the scan, up to 0.3 mm off the marker.
fn picks(performance: &Performance) -> String {
    const OFF_MM: f64 = 0.3;
    let positions = &performance.face.mesh().positions;
    let mut text = String::from("marker,x,y,z\n");
    for (i, marker) in performance.markers.iter().enumerate() {
        let angle = 2.4 * i as f64;
        let aimed = positions[marker.vertex as usize]
            + nalgebra::Vector3::new(angle.cos(), angle.sin(), 0.0) * OFF_MM;
        let off = |vertex: &usize| (positions[*vertex] - aimed).norm_squared();
        let hit =
            (0..positions.len()).min_by(|a, b| off(a).total_cmp(&off(b))).map_or(aimed, |hit| positions[hit]);
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{},{},{},{}", marker.name, hit.x, hit.y, hit.z);
    }
    text
}

fn write_truth(
    folder: &Path,
    performance: &Performance,
    recording: &Recording,
    mesh: MeshRef,
    take: TakeRef,
) -> Result<()> {
    let cache = folder.join("large-scale.pc2");
    let mut writer = pc2::Writer::create(&cache, mesh.vertex_count, performance.first_frame)?;
    for frame in 0..performance.weights.len() {
        let flat: Vec<f32> = performance
            .surface(frame)
            .iter()
            .flat_map(|point| [point.x as f32, point.y as f32, point.z as f32])
            .collect();
        writer.write(&flat)?;
    }
    writer.finish()?.publish()?;
    let index = LargeScale {
        mesh,
        cache: file_name(&cache),
        form: artifact::SequenceForm::Pc2,
        rate: Some(performance.rate),
        frames: performance.frames(),
        take: Some(take.clone()),
    };
    artifact::write_document(&folder.join("large-scale.json"), &index)?.publish()?;
    let (header, poses) = performance.head_poses(recording, Some(take));
    let mut writer = FrameWriter::<HeadPose>::create(&folder.join("head-pose.jsonl"), header)?;
    poses.iter().try_for_each(|pose| writer.write(pose))?;
    writer.finish()?.publish()?;
    Ok(())
}
