//! What is written down beside the images: manifest, scan, picks, cameras, time stamps.

use super::Arguments;
use super::footage;
use artifact::{
    Axis, CameraRig, Clock, FileRef, MeshRef, RigCamera, Staged, Take, TakeCamera, TakeRef, Unit, obj,
    sha256, stage_bytes,
};
use camera::Camera;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;
use virtual_rig::clock::Schedule;
use virtual_rig::film::Transfer;
use virtual_rig::scenario::FaultKind;
use virtual_rig::take::{Station, Studio};

/// What the files of a take refer to.
pub(super) struct Paper {
    /// Folder of what a user brings.
    folder: PathBuf,
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
    /// Writes the manifest, the scenario and the scan under temporary names, since everything refers to their hashes.
    /// `files`: what was given beside the scenario, by role.
    pub(super) fn new(
        studio: &Studio,
        files: BTreeMap<String, FileRef>,
        arguments: &Arguments,
    ) -> anyhow::Result<(Self, Vec<Staged>)> {
        let (folder, truth) = (arguments.out.join("take"), arguments.out.join("truth"));
        let body = studio.body();
        let scan_file = obj::write(&folder.join("scan.obj"), &body.mesh, Unit::Mm)?;
        let scan = MeshRef {
            file: FileRef { name: "scan.obj".into(), sha256: hash(&scan_file)? },
            unit: Unit::Mm,
            vertex_count: body.mesh.positions.len(),
        };
        let scenario_file = artifact::write_document(&truth.join("scenario.json"), studio.scenario())?;
        let scenario = FileRef { name: "scenario.json".into(), sha256: hash(&scenario_file)? };
        let clock = clock(studio);
        let mut references = files;
        references.extend([("scan".to_string(), scan.file.clone()), ("scenario".to_string(), scenario)]);
        let manifest = manifest(studio, arguments, references, clock);
        let manifest_file = artifact::write_document(&folder.join("take.json"), &manifest)?;
        let take = TakeRef { take: manifest.take, session: manifest.session, sha256: hash(&manifest_file)? };
        Ok((Self { folder, truth, take, scan, clock }, vec![scenario_file, scan_file, manifest_file]))
    }

    /// Which point of the scan each marker sits on.
    pub(super) fn write_picks(&self, studio: &Studio) -> anyhow::Result<Staged> {
        let mut picks = String::from("marker,x,y,z\n");
        for dot in studio.layers().dots() {
            let [x, y, z] = [dot.center.x, dot.center.y, dot.center.z];
            // Writing to a string cannot fail.
            let _ = writeln!(picks, "{},{x:.4},{y:.4},{z:.4}", dot.id);
        }
        Ok(stage_bytes(&self.folder.join("picks.csv"), picks.as_bytes())?)
    }

    /// What the cameras' clocks say of their images.
    pub(super) fn write_stamps(&self, schedule: &Schedule) -> anyhow::Result<Vec<Staged>> {
        let stamps = virtual_rig::clock::time_stamps_csv(schedule);
        let file = |camera| self.folder.join(format!("footage/{camera}.csv"));
        stamps.map(|(camera, stamps)| Ok(stage_bytes(&file(camera), stamps.as_bytes())?)).collect()
    }

    /// The cameras.
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
    arguments: &Arguments,
    references: BTreeMap<String, FileRef>,
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
            footage: (!arguments.no_footage).then(|| footage::entry(arguments.video, id)),
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
        references,
        consent: arguments.given.consent(),
    }
}
