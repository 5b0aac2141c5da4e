//! A truth folder small enough to know by heart: three cameras, five markers, four frames, a sheet with one fold.

use artifact::{
    CameraRig, Clock, Curve2d, CurveState, Document, FrameReader, FrameWriter, HeadPose, HeadPoseFrame,
    HeadPoseHeader, HeadTrajectories, LargeScale, MarkerFrame, MarkerHeader, MeshRef, PerCamera, Rate,
    Sample2d, SampleStatus, Section, SectionState, Sections, SectionsFrame, SectionsHeader, SequenceForm,
    Shown, Space, Stream, SyncCamera, SyncFrame, SyncHeader, SyncSource, TakeRef, TimeBase, Tracks2d,
    Tracks2dFrame, Tracks2dHeader, Trajectories3d, Unit, ValleyPoint, Valleys, ValleysFrame, ValleysHeader,
    Wrinkle, Wrinkled, Wrinkles2d, Wrinkles2dFrame, Wrinkles2dHeader, pc2, picture,
};
use camera::{BrownConrady, Camera, Lens};
use mesh::Mesh;
use nalgebra::{Isometry3, Point2, Point3, Rotation3, UnitQuaternion, Vector2, Vector3};
use std::path::{Path, PathBuf};

pub(crate) const FRAMES: std::ops::RangeInclusive<i64> = 1001..=1004;
const CAMERAS: [&str; 3] = ["m1", "m2", "m3"];
/// Cameras with pictures.
const FILMED: [&str; 2] = ["m1", "m2"];

/// Folders `take`, `truth` and an empty `out`.
pub(crate) struct Folder {
    pub(crate) root: tempfile::TempDir,
}

pub(crate) fn take(id: &str) -> TakeRef {
    TakeRef { take: id.into(), session: "s1".into(), sha256: format!("{id:0<64}") }
}

fn rate() -> Option<Rate> {
    Some(Rate::per_second(50))
}

fn strings(ids: &[&str]) -> Vec<String> {
    ids.iter().map(ToString::to_string).collect()
}

fn write<S: Stream>(path: &Path, header: S::Header, frames: impl IntoIterator<Item = S::Frame>) {
    let mut writer = FrameWriter::<S>::create(path, header).unwrap();
    frames.into_iter().for_each(|frame| writer.write(&frame).unwrap());
    writer.finish().unwrap().publish().unwrap();
}

fn write_document<T: Document>(path: &Path, document: &T) {
    artifact::write_document(path, document).unwrap().publish().unwrap();
}

impl Folder {
    pub(crate) fn new() -> Self {
        let folder = Self { root: tempfile::tempdir().unwrap() };
        std::fs::create_dir(folder.path("out")).unwrap();
        folder.write_capture();
        folder.write_wrinkles();
        folder.write_surfaces();
        folder.write_paint();
        folder.write_normals("truth/normals", 0.0);
        folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.root.path().join(name)
    }

    fn truth(&self, name: &str) -> PathBuf {
        self.path("truth").join(name)
    }

    /// Copies a stream of the truth to `out`, with every frame changed.
    pub(crate) fn change<S: Stream>(&self, name: &str, change: impl Fn(&mut S::Frame)) {
        let reader = FrameReader::<S>::open(&self.truth(name)).unwrap();
        let header = reader.header().clone();
        let frames = reader.map(|frame| {
            let mut frame = frame.unwrap();
            change(&mut frame);
            frame
        });
        write::<S>(&self.path("out").join(name), header, frames);
    }

    /// Copies a stream of the truth to `out`, with its header changed.
    pub(crate) fn change_header<S: Stream>(&self, name: &str, change: impl Fn(&mut S::Header)) {
        let reader = FrameReader::<S>::open(&self.truth(name)).unwrap();
        let mut header = reader.header().clone();
        change(&mut header);
        write::<S>(&self.path("out").join(name), header, reader.map(Result::unwrap));
    }

    /// Copies a document of the truth to `out`, changed.
    pub(crate) fn change_document<T: Document>(&self, name: &str, change: impl Fn(&mut T)) {
        let mut document: T = artifact::read_document(&self.truth(name)).unwrap();
        change(&mut document);
        write_document(&self.path("out").join(name), &document);
    }

    /// Copies a cache of the truth to `out`, moved along x.
    pub(crate) fn change_samples(&self, name: &str, shift: f32) {
        let mut reader = pc2::Reader::open(&self.truth(name)).unwrap();
        let mut writer =
            pc2::Writer::create(&self.path("out").join(name), reader.vertex_count(), *FRAMES.start())
                .unwrap();
        while let Some(mut sample) = reader.read().unwrap() {
            sample.iter_mut().step_by(3).for_each(|x| *x += shift);
            writer.write(&sample).unwrap();
        }
        writer.finish().unwrap().publish().unwrap();
    }

    /// Copies pictures of the truth to where a pattern says.
    pub(crate) fn copy_pictures(&self, name: &str, pattern: &str) {
        for camera in FILMED {
            for frame in FRAMES {
                let from = self.truth(&format!("{name}/{camera}/{frame:06}.png"));
                let to = artifact::image_path(&pattern.replace("{camera}", camera), frame);
                std::fs::copy(from, self.path(&to)).unwrap();
            }
        }
    }
}

// Capture

fn marker(id: usize, frame: i64) -> Point3<f64> {
    let places =
        [[0.0, 0.0, 0.0], [40.0, 5.0, -10.0], [-35.0, 12.0, -8.0], [5.0, 45.0, -5.0], [-3.0, -38.0, 6.0]];
    let time = (frame - 1001) as f64;
    Point3::from(places[id]) + Vector3::new(0.5 * time, 0.1 * time * id as f64, 0.0)
}

fn rig() -> CameraRig {
    let camera = |i: usize| {
        let angle = (i as f64 - 1.0) * 0.5;
        let eye = Point3::new(600.0 * angle.sin(), 60.0 * i as f64, 600.0 * angle.cos());
        Camera {
            image_size: [656, 490],
            lens: Lens {
                focal_px: Vector2::new(1100.0, 1098.0),
                center_px: Vector2::new(327.0, 246.0),
                distortion: BrownConrady { k1: -0.1, k2: 0.05, p1: 4e-4, p2: -3e-4, k3: 0.0 },
            },
            cam_from_world: Camera::pose_looking_at(eye, Point3::origin(), Vector3::y()),
        }
    };
    let cameras = CAMERAS.iter().enumerate().map(|(i, id)| (id.to_string(), camera(i).into()));
    CameraRig { cameras: cameras.collect(), take: Some(take("t1")) }
}

fn tracks(frame: i64) -> Tracks2dFrame {
    let seen = |camera: &Camera, id| {
        let pixel = camera.project(&marker(id, frame)).unwrap();
        Some(Sample2d::seen(Point2::from(pixel)))
    };
    let rig = rig();
    let images = rig.cameras.values().map(|rig| Some((0..5).map(|id| seen(&rig.camera, id)).collect()));
    Tracks2dFrame { frame, cameras: images.collect() }
}

fn pose(frame: i64) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::y() * 0.01 * (frame - 1001) as f64);
    Isometry3::from_parts(Vector3::new(0.0, 0.2 * (frame - 1001) as f64, 100.0).into(), turn)
}

impl Folder {
    fn write_capture(&self) {
        let markers = strings(&["p0", "p1", "p2", "p3", "p4"]);
        write_document(&self.truth("cameras.json"), &rig());
        write_document(&self.truth("cameras-calibrated.json"), &rig());
        let (cameras, rate, take) = (strings(&CAMERAS), rate(), Some(take("t1")));
        let header = Tracks2dHeader { cameras, markers: markers.clone(), rate, take: take.clone() };
        write::<Tracks2d>(&self.truth("tracks-2d.jsonl"), header, FRAMES.map(tracks));
        let header = MarkerHeader { unit: Unit::Mm, rate, markers: markers.clone(), take: take.clone() };
        let points = |frame: i64, head_from_world: Isometry3<f64>| MarkerFrame {
            frame,
            points: (0..5).map(|id| Some(head_from_world * marker(id, frame))).collect(),
            status: vec![SampleStatus::Measured; 5],
        };
        let world = FRAMES.map(|frame| points(frame, Isometry3::identity()));
        write::<Trajectories3d>(&self.truth("markers.jsonl"), header.clone(), world);
        let head = FRAMES.map(|frame| points(frame, pose(frame).inverse()));
        write::<HeadTrajectories>(&self.truth("head.jsonl"), header, head);
        let header = HeadPoseHeader { rate, reference_frame: 1001, markers, take };
        let poses = FRAMES.map(|frame| HeadPoseFrame {
            frame,
            world_from_head: Some(pose(frame)),
            residual_mm: None,
            markers_used: 5,
        });
        write::<HeadPose>(&self.truth("pose.jsonl"), header, poses);
        self.write_sync();
    }

    fn write_sync(&self) {
        let clock = SyncCamera {
            rate: Rate::per_second(50),
            every: 1,
            phase: *FRAMES.start(),
            offset_frames: 0.0,
            drift_ppm: 0.0,
            source: SyncSource::Trigger,
        };
        let header = SyncHeader {
            rate: Rate::per_second(50),
            clock: Clock::Trigger,
            cameras: CAMERAS.iter().map(|id| (id.to_string(), clock.clone())).collect(),
            take: Some(take("t1")),
        };
        let shown = |frame| Some(Shown { index: frame - 1001, time_s: None, doubled: false });
        let frames = FRAMES.map(|frame| SyncFrame {
            frame,
            shows: CAMERAS.iter().map(|id| (id.to_string(), shown(frame))).collect(),
        });
        write::<TimeBase>(&self.truth("sync.jsonl"), header, frames);
    }
}

// Wrinkles in the images: one deep, one shallow, one flat; straight lines, 60 px apart.

const WRINKLES: [(&str, f64, f64); 3] = [("brow", 40.0, 2.0), ("shallow", 100.0, 0.4), ("flat", 160.0, 0.0)];

fn wrinkles() -> Vec<Wrinkle> {
    WRINKLES.iter().map(|(id, ..)| Wrinkle { id: id.to_string(), paint: None }).collect()
}

fn in_images<T>(of: impl Fn(f64, f64) -> T) -> PerCamera<T> {
    let camera = || WRINKLES.iter().map(|&(id, y, d)| (id.to_string(), of(y, d))).collect();
    FILMED.iter().map(|id| (id.to_string(), camera())).collect()
}

fn section(x: f64, y: f64, d_px: f64) -> Section {
    Section {
        u: x,
        at: [x, y],
        normal: [0.0, 1.0],
        w_px: 4.0,
        d_px,
        epsilon: 0.0,
        kappa: 0.0,
        tilt_rad: None,
        deviation: None,
        residual: None,
        state: if d_px > 0.0 { SectionState::Measured } else { SectionState::Flat },
    }
}

impl Folder {
    fn write_wrinkles(&self) {
        let (cameras, take) = (strings(&FILMED), Some(take("t1")));
        let header = SectionsHeader {
            cameras: cameras.clone(),
            wrinkles: wrinkles(),
            profile: artifact::Profile::S,
            rate: rate(),
            take: take.clone(),
        };
        let along = |y: f64, d: f64| (2..8).map(|i| section(8.0 * f64::from(i), y, d)).collect();
        let frames = FRAMES.map(|frame| SectionsFrame { frame, sections: in_images(along) });
        write::<Sections>(&self.truth("sections.jsonl"), header, frames);
        let header = Wrinkles2dHeader { cameras, wrinkles: wrinkles(), rate: rate(), take };
        let curve = |y: f64, _| Curve2d {
            controls: (0..10).map(|i| [8.0 * f64::from(i), y]).collect(),
            state: CurveState::Seen,
            confidence: 1.0,
            paint: Vec::new(),
        };
        let frames = FRAMES.map(|frame| Wrinkles2dFrame { frame, curves: in_images(curve) });
        write::<Wrinkles2d>(&self.truth("wrinkles-2d.jsonl"), header, frames);
    }
}

// A sheet of 30 × 10 mm with a fold along x = 15.

const COLUMNS: usize = 61;
const ROWS: usize = 21;
const STEP: f64 = 0.5;
const WIDTH: f64 = 1.0;
const DEPTH: f64 = 0.5;

fn sheet() -> Mesh {
    let place = |i: usize| [(i % COLUMNS) as f64 * STEP, (i / COLUMNS) as f64 * STEP, 0.0];
    let quad = |i: usize| {
        let at = (i / (COLUMNS - 1) * COLUMNS + i % (COLUMNS - 1)) as u32;
        let next = at + COLUMNS as u32;
        [[at, at + 1, next + 1], [at, next + 1, next]]
    };
    let triangles: Vec<[u32; 3]> = (0..(COLUMNS - 1) * (ROWS - 1)).flat_map(quad).collect();
    Mesh::from_triangles((0..COLUMNS * ROWS).map(place).collect(), &triangles)
}

fn fold(x: f64) -> f64 {
    let p = (x - 15.0).abs() / WIDTH;
    if p < 5.0 { DEPTH * (p - 1.0) * (-p).exp() } else { 0.0 }
}

fn valley() -> Vec<ValleyPoint> {
    let middle = COLUMNS / 2;
    let point = |row: usize| ValleyPoint {
        x_mm: row as f64 * STEP,
        // A quad's first triangle starts at its vertex.
        face: 2 * (row * (COLUMNS - 1) + middle) as u32,
        barycentric: [1.0, 0.0, 0.0],
        at_mm: [15.0, row as f64 * STEP, fold(15.0)],
        normal: [0.0, 0.0, 1.0],
        across: [1.0, 0.0, 0.0],
        w_mm: WIDTH,
        d_mm: DEPTH,
        epsilon: 0.0,
        kappa: 0.0,
    };
    (0..ROWS - 1).map(point).collect()
}

impl Folder {
    fn write_surfaces(&self) {
        let (scan, rest) = (self.path("take/scan.obj"), sheet());
        artifact::write_mesh(&scan, &rest, Unit::Mm).unwrap().publish().unwrap();
        let file = artifact::FileRef { name: "scan.obj".into(), sha256: artifact::sha256(&scan).unwrap() };
        let mesh = MeshRef { file, unit: Unit::Mm, vertex_count: rest.positions.len() };
        let index = |cache: &str| LargeScale {
            mesh: mesh.clone(),
            cache: cache.into(),
            form: SequenceForm::Pc2,
            rate: rate(),
            frames: FRAMES.collect(),
            take: Some(take("t1")),
        };
        write_document(&self.truth("large-scale.json"), &index("large-scale.pc2"));
        write_document(&self.truth("wrinkled.json"), &Wrinkled(index("wrinkled.pc2")));
        self.write_cache("large-scale.pc2", &rest, |_| 0.0);
        self.write_cache("wrinkled.pc2", &rest, fold);
        let wrinkles = vec![Wrinkle { id: "brow".into(), paint: None }];
        let header =
            ValleysHeader { mesh, wrinkles, rate: rate(), take: Some(take("t1")), space: Space::Face };
        let frames =
            FRAMES.map(|frame| ValleysFrame { frame, valleys: [("brow".to_string(), valley())].into() });
        write::<Valleys>(&self.truth("valleys.jsonl"), header, frames);
    }

    fn write_cache(&self, name: &str, rest: &Mesh, height: impl Fn(f64) -> f64) {
        let mut writer =
            pc2::Writer::create(&self.truth(name), rest.positions.len(), *FRAMES.start()).unwrap();
        for frame in FRAMES {
            let rise = 0.25 * (frame - 1001) as f64;
            let sample = rest.positions.iter().flat_map(|p| [p.x, p.y, p.z + rise + height(p.x)]);
            writer.write(&sample.map(|x| x as f32).collect::<Vec<f32>>()).unwrap();
        }
        writer.finish().unwrap().publish().unwrap();
    }
}

// Pictures

impl Folder {
    fn write_paint(&self) {
        // A stroke of 40 × 8 pixels with half-covered edges.
        let coverage = |x: usize, y: usize| match (x, y) {
            (12..=51, 13..=19) => 255,
            (12..=51, 12 | 20) => 128,
            _ => 0,
        };
        let gray = (0..32).flat_map(|y| (0..64).flat_map(move |x| [coverage(x, y); 3]));
        let gray: Vec<u8> = gray.collect();
        for camera in FILMED {
            for frame in FRAMES {
                let path = self.truth(&format!("paint/{camera}/{frame:06}.png"));
                picture::write_rgb8(&path, 64, 32, &gray).unwrap().publish().unwrap();
            }
        }
    }

    /// Normals of a ball before black, turned by an angle about the view.
    pub(crate) fn write_normals(&self, folder: &str, angle: f64) {
        let normal = |x: usize, y: usize| {
            let (a, b) = ((x as f64 - 20.0) / 18.0, (y as f64 - 20.0) / 18.0);
            let inside = 1.0 - a * a - b * b;
            (inside > 0.0).then(|| Vector3::new(a, b, -inside.sqrt()))
        };
        let code = |normal: Option<Vector3<f64>>| match normal {
            Some(normal) => {
                let axis = normal.cross(&Vector3::new(0.3, 0.5, 0.1));
                let turned = Rotation3::from_scaled_axis(axis.normalize() * angle) * normal;
                std::array::from_fn(|i| ((0.5 * turned[i] + 0.5) * 65_535.0).round() as u16)
            }
            None => [0; 3],
        };
        let rgb: Vec<u16> = (0..40).flat_map(|y| (0..40).flat_map(move |x| code(normal(x, y)))).collect();
        for camera in FILMED {
            for frame in FRAMES {
                let path = self.path(&format!("{folder}/{camera}/{frame:06}.png"));
                picture::write_rgb16(&path, 40, 40, &rgb).unwrap().publish().unwrap();
            }
        }
    }
}
