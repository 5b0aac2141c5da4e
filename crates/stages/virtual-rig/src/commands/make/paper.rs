//! What is written down beside the images: manifest, scan, picks, cameras, time stamps.

use super::footage::{self, Video};
use super::given;
use artifact::{
    Axis, CameraRig, Clock, FileRef, MeshRef, RigCamera, Staged, Take, TakeCamera, TakeRef, Unit, obj,
    sha256, stage_bytes,
};
use camera::Camera;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use virtual_rig::clock::Schedule;
use virtual_rig::film::Transfer;
use virtual_rig::scenario::FaultKind;
use virtual_rig::take::{Station, Studio};

/// What the files of a take refer to.
pub(super) struct Paper {
    /// Folder of the truth.
    pub(super) truth: PathBuf,
    /// The take.
    pub(super) take: TakeRef,
    /// The scan.
    pub(super) scan: MeshRef,
    /// Where time comes from.
    pub(super) clock: Clock,
}

impl Paper {
    /// Writes the manifest and the scan under temporary names, since everything refers to their hashes.
    pub(super) fn new(
        studio: &Studio,
        given: &given::GivenFace,
        video: Option<Video>,
        out: &Path,
    ) -> anyhow::Result<(Self, Vec<Staged>)> {
        let folder = out.join("take");
        let body = studio.body();
        let scan_file = obj::write(&folder.join("scan.obj"), &body.mesh, Unit::Mm)?;
        let scan = MeshRef {
            file: FileRef { name: "scan.obj".into(), sha256: hash(&scan_file)? },
            unit: Unit::Mm,
            vertex_count: body.mesh.positions.len(),
        };
        let clock = clock(studio);
        let manifest = manifest(studio, given, video, &scan, clock);
        let manifest_file = artifact::write_document(&folder.join("take.json"), &manifest)?;
        let take = TakeRef { take: manifest.take, session: manifest.session, sha256: hash(&manifest_file)? };
        Ok((Self { truth: out.join("truth"), take, scan, clock }, vec![scan_file, manifest_file]))
    }

    /// What else a user brings: which point of the scan each marker sits on, and what the cameras' clocks say.
    pub(super) fn write_take(
        &self,
        studio: &Studio,
        schedule: &Schedule,
        out: &Path,
    ) -> anyhow::Result<Vec<Staged>> {
        let folder = out.join("take");
        let mut picks = String::from("marker,x,y,z\n");
        for dot in studio.layers().dots() {
            let [x, y, z] = [dot.center.x, dot.center.y, dot.center.z];
            // Writing to a string cannot fail.
            let _ = writeln!(picks, "{},{x:.4},{y:.4},{z:.4}", dot.id);
        }
        let mut outputs = vec![stage_bytes(&folder.join("picks.csv"), picks.as_bytes())?];
        for (camera, stamps) in virtual_rig::clock::time_stamps_csv(schedule) {
            outputs.push(stage_bytes(&folder.join(format!("footage/{camera}.csv")), stamps.as_bytes())?);
        }
        Ok(outputs)
    }

    /// The scenario and the cameras.
    pub(super) fn write_truth(&self, studio: &Studio) -> anyhow::Result<Vec<Staged>> {
        let rig = |camera: fn(&Station) -> &Camera| CameraRig {
            cameras: studio
                .stations()
                .iter()
                .map(|(id, station)| (id.clone(), RigCamera::from(camera(station).clone())))
                .collect(),
            take: Some(self.take.clone()),
        };
        let file = |name: &str| self.truth.join(name);
        Ok(vec![
            artifact::write_document(&file("scenario.json"), studio.scenario())?,
            artifact::write_document(&file("cameras.json"), &rig(|station| &station.camera))?,
            artifact::write_document(&file("cameras-calibrated.json"), &rig(|station| &station.calibrated))?,
        ])
    }
}

fn hash(staged: &Staged) -> anyhow::Result<String> {
    Ok(sha256(staged.temporary().unwrap_or(staged.path()))?)
}

/// Cameras whose clocks go their own way share nothing but the flash, if there is one.
fn clock(studio: &Studio) -> Clock {
    let scenario = studio.scenario();
    let own = |kind| scenario.faults.iter().any(|fault| fault.kind == kind);
    match (own(FaultKind::Offset) || own(FaultKind::Drift), &scenario.flash) {
        (false, _) => Clock::Trigger,
        (true, Some(_)) => Clock::Flash,
        (true, None) => Clock::Free,
    }
}

fn manifest(
    studio: &Studio,
    given: &given::GivenFace,
    video: Option<Video>,
    scan: &MeshRef,
    clock: Clock,
) -> Take {
    let scenario = studio.scenario();
    let extent = scenario.extent;
    let camera = |(id, station): (&String, &Station)| {
        TakeCamera {
            id: id.clone(),
            image_size: station.camera.image_size,
            // A fault of the coding is what nobody knows of.
            transfer: match scenario.sensor.transfer {
                Transfer::Srgb => "srgb".into(),
                Transfer::Linear => "linear".into(),
                Transfer::Gamma(gamma) => format!("gamma {gamma}"),
            },
            bit_depth: 8,
            rate: footage::camera_rate(studio, station),
            footage: Some(footage::entry(video, id)),
        }
    };
    Take {
        subject: format!("virtual-{}", scenario.seed),
        session: format!("virtual-{}", scenario.seed),
        take: format!("{}-{}", scenario.name, scenario.seed),
        rate: extent.rate,
        start_timecode: None,
        first_frame: extent.first_frame,
        clock,
        cameras: studio.stations().iter().map(camera).collect(),
        mesh_unit: Unit::Mm,
        mesh_up: Axis::Y,
        references: BTreeMap::from([("scan".to_string(), scan.file.clone())]),
        consent: given.consent(),
    }
}
