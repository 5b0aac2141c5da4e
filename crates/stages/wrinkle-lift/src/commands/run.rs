//! `wrinkle-lift run`.

use super::faces::Faces;
use super::options::{Material, Options};
use super::tell;
use anyhow::bail;
use artifact::{
    FrameReader, FrameWriter, Sections, SectionsFrame, SectionsHeader, Space, SyncFrame, SyncHeader,
    TimeBase, Valleys, ValleysFrame, ValleysHeader,
};
use nalgebra::{Isometry3, Point3};
use stage::{Run, check_take};
use std::collections::BTreeMap;
use std::path::PathBuf;
use wrinkle_lift::{
    Error, Ground, Image, Lifter, Moment, Params, Scene, Tally, arrange, edited, flatten_fleeting,
};

/// Makes valleys on the mesh from sections in the images
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    options: Options,
    /// Which image shows which frame (sync)
    #[arg(long, value_name = "FILE")]
    sync: PathBuf,
    /// Sections of the wrinkles in the images (sections)
    #[arg(long, value_name = "FILE")]
    sections: PathBuf,
    /// Cast creases where they are seen, as the paper does, although the bottom of a valley is seen off its place on the surface
    #[arg(long)]
    no_parallax: bool,
    /// Normals are averaged over this length, standard deviation, mm
    #[arg(long, value_name = "MM", default_value_t = Params::default().normal_mm)]
    normal_mm: f64,
    /// Highest bulges that a measured profile is believed to have, as share of its depth; 10 believes all
    #[arg(long, value_name = "SHARE", default_value_t = Params::default().bulge)]
    bulge: f64,
    /// Leave out what is seen more obliquely, degrees off the normal
    #[arg(long, value_name = "DEG", default_value_t = Params::default().max_view_deg)]
    max_view_deg: f64,
    /// Distance of the points along a valley, mm
    #[arg(long, value_name = "MM", default_value_t = Params::default().step_mm)]
    step_mm: f64,
    /// Longest gap along a wrinkle that is bridged, mm
    #[arg(long, value_name = "MM", default_value_t = Params::default().gap_mm)]
    gap_mm: f64,
    /// Length over which one camera's part of a wrinkle passes into another's, mm
    #[arg(long, value_name = "MM", default_value_t = Params::default().blend_mm)]
    blend_mm: f64,
    /// Distance from which cameras disagree on a place, mm; there the surer one is followed
    #[arg(long, value_name = "MM", default_value_t = Params::default().disagree_mm)]
    disagree_mm: f64,
    /// Keep wrinkles that are open in a single image, between images that see them flat
    #[arg(long)]
    keep_fleeting: bool,
    /// Valleys to write (valleys; - for standard output)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

impl Arguments {
    fn params(&self) -> Params {
        Params {
            parallax: !self.no_parallax,
            normal_mm: self.normal_mm,
            bulge: self.bulge,
            max_view_deg: self.max_view_deg,
            step_mm: self.step_mm,
            gap_mm: self.gap_mm,
            blend_mm: self.blend_mm,
            disagree_mm: self.disagree_mm,
            keep_fleeting: self.keep_fleeting,
        }
    }
}

/// Everything that is read, and what of it can be used.
struct Work {
    params: Params,
    material: Material,
    header: SectionsHeader,
    clock: SyncHeader,
    frames: Vec<SectionsFrame>,
    /// Per used image its frame and moment, in the order of `frames`, cameras by id.
    images: Vec<(i64, Moment)>,
}

/// Images that cannot be used, and why.
#[derive(Debug, Default)]
pub(super) struct Unused {
    /// The time base says that there is no image.
    pub(super) unsynced: Vec<i64>,
    /// No pose of the head.
    pub(super) poseless: Vec<i64>,
    /// The sequence has no such frame.
    pub(super) faceless: Vec<i64>,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("run");
    run.check_folders(&[&arguments.out])?;
    let (work, unused) = Work::read(run, arguments)?;
    let ground = Ground::of(&work.material.mesh);
    let mut writer = FrameWriter::<Valleys>::create(&arguments.out, work.valleys_header())?;
    let (mut frames, tally, unmapped) = work.lift(run, &ground)?;
    if !work.params.keep_fleeting {
        run.result("fleeting", flatten_fleeting(&mut frames, &edited(&work.frames)));
    }
    tell::warn_of_depth(run, &frames);
    let drift = run.timed("arrange", || arrange(&mut frames, &ground, &work.material.mesh.positions));
    tell::report(run, &tally, &unused, &drift, unmapped);
    tell::check(&tally, &arguments.sections)?;
    frames.iter().try_for_each(|frame| writer.write(frame))?;
    run.publish(vec![writer.finish()?])
}

impl Work {
    fn read(run: &mut Run, arguments: &Arguments) -> anyhow::Result<(Self, Unused)> {
        let params = arguments.params();
        params.check()?;
        run.parameters(&params)?;
        let path = &arguments.sections;
        let reader = FrameReader::<Sections>::open(path)?;
        run.input("sections", path)?;
        let header = reader.header().clone();
        let sync = FrameReader::<TimeBase>::open(&arguments.sync)?;
        run.input("sync", &arguments.sync)?;
        let clock = sync.header().clone();
        check_take(run, &arguments.sync, clock.take.as_ref(), header.take.as_ref())?;
        let material = arguments.options.read(run, header.take.as_ref())?;
        for id in &header.cameras {
            material.camera(id, path)?;
        }
        if let Some(id) = header.cameras.iter().find(|id| !clock.cameras.contains_key(*id)) {
            let (sync, sections) = (arguments.sync.display(), path.display());
            bail!(
                "{sync}: does not know camera {id} of {sections}\n  to do: give the time base of the same take"
            );
        }
        run.check_outputs(&[&arguments.out])?;
        let numbered = |frame: artifact::Result<SyncFrame>| frame.map(|frame| (frame.frame, frame));
        let shown: BTreeMap<i64, SyncFrame> = sync.map(numbered).collect::<artifact::Result<_>>()?;
        let mut work = Self { params, material, header, clock, frames: Vec::new(), images: Vec::new() };
        let mut unused = Unused::default();
        for frame in reader {
            work.keep(frame?, &shown, &mut unused);
        }
        if work.images.is_empty() {
            bail!(
                "{}: none of its images has a frame of the time base, a pose of the head and a face\n  to do: give files of one take",
                path.display()
            );
        }
        Ok((work, unused))
    }

    /// Takes in what of a frame can be used.
    fn keep(&mut self, mut frame: SectionsFrame, shown: &BTreeMap<i64, SyncFrame>, unused: &mut Unused) {
        let number = frame.frame;
        let at = |lag: f64| Moment::of(number, lag);
        let mut moments = Vec::new();
        frame.sections.retain(|id, _| {
            let clock = self.clock.cameras.get(id);
            let image = shown.get(&number).and_then(|frame| frame.shows.get(id)).and_then(Option::as_ref);
            let (Some(clock), Some(_)) = (clock, image.filter(|image| !image.doubled)) else {
                unused.unsynced.push(number);
                return false;
            };
            let moment = at(clock.lag_frames(number));
            if self.material.pose(moment).is_none() {
                unused.poseless.push(number);
                return false;
            }
            if !self.material.has_face(moment) || !self.material.has_face(at(0.0)) {
                unused.faceless.push(number);
                return false;
            }
            moments.push((number, moment));
            true
        });
        if !moments.is_empty() {
            self.frames.push(frame);
            self.images.append(&mut moments);
        }
    }

    fn valleys_header(&self) -> ValleysHeader {
        ValleysHeader {
            mesh: self.material.reference.clone(),
            wrinkles: self.header.wrinkles.clone(),
            rate: self.header.rate.or(Some(self.clock.rate)),
            take: self.header.take.clone().or_else(|| self.clock.take.clone()),
            space: Space::Face,
        }
    }

    /// All valleys, what became of the sections, and how many vertices the warp's inverse did not reach in the worst frame.
    fn lift(&self, run: &mut Run, ground: &Ground) -> anyhow::Result<(Vec<ValleysFrame>, Tally, usize)> {
        let mut faces = Faces::open(&self.material, &self.images)?;
        let lifter = Lifter { ground, spaces: &self.material.spaces, params: &self.params };
        let (mut lifted, mut tally, mut unmapped) = (Vec::new(), Tally::default(), 0);
        let mut progress = run.progress("lift, frames", Some(self.frames.len() as u64));
        for frame in &self.frames {
            let scenes = self.scenes(run, ground, &mut faces, frame)?;
            unmapped = scenes.iter().map(|(_, scene)| scene.lost).max().unwrap_or(0).max(unmapped);
            let in_face = faces.frame(frame.frame)?;
            let (valleys, counts) = run.timed("lift", || self.lift_frame(&lifter, frame, in_face, &scenes));
            lifted.push(valleys);
            tally.add(counts);
            faces.release(frame.frame);
            progress.step();
        }
        Ok((lifted, tally, unmapped))
    }

    fn moment(&self, camera: &str, frame: i64) -> Moment {
        Moment::of(frame, self.clock.cameras.get(camera).map_or(0.0, |clock| clock.lag_frames(frame)))
    }

    /// The face at each of the moments that the frame's images were taken at.
    fn scenes<'a>(
        &self,
        run: &mut Run,
        ground: &'a Ground,
        faces: &mut Faces<'_>,
        frame: &SectionsFrame,
    ) -> anyhow::Result<Vec<(Moment, Scene<'a>)>> {
        let mut scenes: Vec<(Moment, Scene<'a>)> = Vec::new();
        for id in frame.sections.keys() {
            let moment = self.moment(id, frame.frame);
            if scenes.iter().any(|(other, _)| *other == moment) {
                continue;
            }
            let in_face: Vec<Point3<f64>> = run.timed("read", || faces.moment(moment))?;
            let scene = run.timed("carry back", || Scene::new(ground, in_face, &self.material.spaces));
            if scene.lost == ground.vertex_count() {
                let (frame, vertices) = (frame.frame, scene.lost);
                return Err(Error::NothingMapped { frame, vertices }.into());
            }
            scenes.push((moment, scene));
        }
        Ok(scenes)
    }

    fn lift_frame(
        &self,
        lifter: &Lifter<'_>,
        frame: &SectionsFrame,
        in_face: &[Point3<f64>],
        scenes: &[(Moment, Scene<'_>)],
    ) -> (ValleysFrame, Tally) {
        let image = |(id, sections)| -> Option<Image<'_>> {
            let id: &String = id;
            let moment = self.moment(id, frame.frame);
            let world_from_head: Isometry3<f64> = self.material.pose(moment)?;
            let scene = scenes.iter().find(|(other, _)| *other == moment).map(|(_, scene)| scene)?;
            let camera = &self.material.rig.get(id)?.camera;
            Some(Image { id, camera, world_from_head, scene, sections })
        };
        let images: Vec<Image<'_>> = frame.sections.iter().filter_map(image).collect();
        lifter.frame(frame.frame, in_face, &images)
    }
}
