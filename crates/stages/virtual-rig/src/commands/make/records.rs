//! What is true of every frame, written as the frames are filmed.

use super::headers::Headers;
use super::paper::Paper;
use anyhow::bail;
use artifact::{
    FrameWriter, HeadPose, HeadPoseFrame, HeadTrajectories, LargeScale, MarkerFrame, PerCamera, SampleStatus,
    Sections, SectionsFrame, Staged, SyncFrame, SyncHeader, TimeBase, Tracks2d, Tracks2dFrame,
    Trajectories3d, ValleyPoint, Valleys, ValleysFrame, Wrinkled, Wrinkles2d, Wrinkles2dFrame, pc2,
};
use nalgebra::Point3;
use std::collections::BTreeMap;
use std::path::PathBuf;
use virtual_rig::clock::Schedule;
use virtual_rig::take::{ImageTruth, Role, Set, Shot, Studio};
use virtual_rig::wrinkle::Valley;

/// The files of the truth that grow frame by frame.
pub(super) struct Records {
    folder: PathBuf,
    sync: FrameWriter<TimeBase>,
    tracks: FrameWriter<Tracks2d>,
    markers: FrameWriter<Trajectories3d>,
    head: FrameWriter<HeadTrajectories>,
    pose: FrameWriter<HeadPose>,
    valleys: FrameWriter<Valleys>,
    curves: FrameWriter<Wrinkles2d>,
    sections: FrameWriter<Sections>,
    large_scale: pc2::Writer,
    wrinkled: pc2::Writer,
    index: LargeScale,
    mocap: Vec<String>,
    due: SyncHeader,
}

impl Records {
    /// Begins the files. `frames`: those of the take that are written, counted from its first one.
    pub(super) fn create(
        studio: &Studio,
        paper: &Paper,
        schedule: &Schedule,
        frames: impl Iterator<Item = i64>,
    ) -> anyhow::Result<Self> {
        let headers = Headers::new(studio, paper);
        let due = headers.sync(schedule);
        let extent = studio.scenario().extent;
        let numbers: Vec<i64> = frames.map(|frame| extent.first_frame + frame).collect();
        let start = numbers.first().copied().unwrap_or(extent.first_frame);
        let vertices = studio.body().mesh.positions.len();
        let folder = paper.truth.clone();
        let file = |name: &str| folder.join(name);
        Ok(Self {
            sync: FrameWriter::create(&file("sync.jsonl"), due.clone())?,
            tracks: FrameWriter::create(&file("tracks-2d.jsonl"), headers.tracks())?,
            markers: FrameWriter::create(&file("markers.jsonl"), headers.markers())?,
            head: FrameWriter::create(&file("head.jsonl"), headers.markers())?,
            pose: FrameWriter::create(&file("pose.jsonl"), headers.pose())?,
            valleys: FrameWriter::create(&file("valleys.jsonl"), headers.valleys())?,
            curves: FrameWriter::create(&file("wrinkles-2d.jsonl"), headers.curves())?,
            sections: FrameWriter::create(&file("sections.jsonl"), headers.sections())?,
            large_scale: pc2::Writer::create(&file("large-scale.pc2"), vertices, start)?,
            wrinkled: pc2::Writer::create(&file("wrinkled.pc2"), vertices, start)?,
            index: headers.index(numbers),
            mocap: headers.cameras(Role::Mocap),
            due,
            folder,
        })
    }

    /// Writes a frame: `own` is the face at the frame's own time, `truths` what is true of its images.
    pub(super) fn write(
        &mut self,
        studio: &Studio,
        frame: i64,
        own: &Set,
        truths: Vec<(Shot, ImageTruth)>,
        shots: &[Shot],
    ) -> anyhow::Result<()> {
        self.write_sync(frame, shots)?;
        let world = studio.markers_in_world(own);
        let head_from_world = own.pose.world_from_head.inverse();
        let in_head: Vec<Point3<f64>> = world.iter().map(|point| head_from_world * point).collect();
        self.markers.write(&measured(frame, &world))?;
        self.head.write(&measured(frame, &in_head))?;
        self.pose.write(&HeadPoseFrame {
            frame,
            world_from_head: Some(own.pose.world_from_head),
            residual_mm: Some(0.0),
            markers_used: studio.head_markers().len(),
        })?;
        let valleys = own.pose.valleys.iter().filter(|valley| !valley.points.is_empty());
        let valleys = valleys.map(|valley| (valley.id.clone(), valley_points(valley))).collect();
        self.valleys.write(&ValleysFrame { frame, valleys })?;
        self.large_scale.write(&coordinates(&own.pose.large_scale))?;
        self.wrinkled.write(&coordinates(&own.pose.skin))?;
        self.write_images(frame, truths)
    }

    fn write_sync(&mut self, frame: i64, shots: &[Shot]) -> anyhow::Result<()> {
        let is_due =
            |shot: &Shot| self.due.cameras.get(&shot.camera).is_some_and(|camera| camera.is_due(frame));
        if let Some(shot) = shots.iter().find(|shot| !is_due(shot)) {
            bail!("camera {}: has an image of frame {frame}, in which it is not due", shot.camera);
        }
        let due = self.due.cameras.iter().filter(|(_, camera)| camera.is_due(frame));
        let shown = |id: &String| shots.iter().find(|shot| shot.camera == *id).map(Shot::shown);
        let shows = due.map(|(id, _)| (id.clone(), shown(id))).collect();
        Ok(self.sync.write(&SyncFrame { frame, shows })?)
    }

    fn write_images(&mut self, frame: i64, truths: Vec<(Shot, ImageTruth)>) -> anyhow::Result<()> {
        let mut of_camera: BTreeMap<String, ImageTruth> =
            truths.into_iter().map(|(shot, truth)| (shot.camera, truth)).collect();
        let mocap = self.mocap.iter().map(|id| of_camera.remove(id).map(|truth| truth.tracks));
        let cameras: Vec<_> = mocap.collect();
        self.tracks.write(&Tracks2dFrame { frame, cameras })?;
        if of_camera.is_empty() {
            return Ok(());
        }
        let mut curves: PerCamera<artifact::Curve2d> = BTreeMap::new();
        let mut sections: PerCamera<Vec<artifact::Section>> = BTreeMap::new();
        for (camera, truth) in of_camera {
            curves.insert(camera.clone(), truth.curves);
            sections.insert(camera, truth.sections);
        }
        self.curves.write(&Wrinkles2dFrame { frame, curves })?;
        Ok(self.sections.write(&SectionsFrame { frame, sections })?)
    }

    /// Ends the files; those that are about images only if there are any.
    pub(super) fn finish(self, with_images: bool) -> anyhow::Result<Vec<Staged>> {
        let document = |name: &str| -> (PathBuf, LargeScale) {
            let cache = format!("{name}.pc2");
            (self.folder.join(format!("{name}.json")), LargeScale { cache, ..self.index.clone() })
        };
        let (large_path, large) = document("large-scale");
        let (wrinkled_path, wrinkled) = document("wrinkled");
        let mut outputs = match with_images {
            true => vec![self.tracks.finish()?, self.curves.finish()?, self.sections.finish()?],
            false => Vec::new(),
        };
        outputs.extend([
            self.sync.finish()?,
            self.markers.finish()?,
            self.head.finish()?,
            self.pose.finish()?,
            self.valleys.finish()?,
            self.large_scale.finish()?,
            self.wrinkled.finish()?,
            artifact::write_document(&large_path, &large)?,
            artifact::write_document(&wrinkled_path, &Wrinkled(wrinkled))?,
        ]);
        Ok(outputs)
    }
}

fn measured(frame: i64, points: &[Point3<f64>]) -> MarkerFrame {
    MarkerFrame {
        frame,
        points: points.iter().map(|point| Some(*point)).collect(),
        status: vec![SampleStatus::Measured; points.len()],
    }
}

fn coordinates(points: &[Point3<f64>]) -> Vec<f32> {
    points.iter().flat_map(|point| [point.x as f32, point.y as f32, point.z as f32]).collect()
}

fn valley_points(valley: &Valley) -> Vec<ValleyPoint> {
    let point = |point: &virtual_rig::wrinkle::ValleyPoint| {
        let (epsilon, kappa) = point.profile.shape.rounding();
        ValleyPoint {
            x_mm: point.x_mm,
            face: point.triangle,
            barycentric: point.barycentric,
            at_mm: point.at.into(),
            normal: point.normal.into(),
            // The rig counts across to the left of a line, the artifact to its right.
            across: (-point.across).into(),
            w_mm: point.w_mm,
            d_mm: point.d_mm,
            epsilon,
            kappa: 0.0 - kappa,
        }
    };
    valley.points.iter().map(point).collect()
}
