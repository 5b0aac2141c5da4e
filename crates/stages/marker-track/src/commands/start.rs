//! Where tracking begins: the labelled frame of each camera.

use super::follow::Camera;
use super::guide::Guide;
use anyhow::bail;
use artifact::Labels;
use marker_track::{Error, GuideHits, Hint, Params, Tracker};
use stage::{CameraImages, Footage, Run};
use std::collections::BTreeMap;
use std::path::Path;

/// A guide that is off by more than this many of its gates, in the median of a camera's labelled markers, guides nothing.
const REFUSED: f64 = 2.0;

/// What tracking starts from.
pub(crate) struct Start<'a> {
    /// Of the labels.
    pub(crate) file: &'a Path,
    pub(crate) params: &'a Params,
    pub(crate) labels: &'a Labels,
    pub(crate) markers: &'a [String],
    /// Place of the labelled frame.
    pub(crate) first: usize,
}

/// Refuses ids that no list of edits could name.
pub(crate) fn check_ids(file: &Path, labels: &Labels) -> anyhow::Result<()> {
    let ids = |(camera, places): (&String, &BTreeMap<String, _>)| {
        places.keys().map(|marker| (camera.clone(), marker.clone())).collect::<Vec<_>>()
    };
    let is_bad = |id: &str| id.contains(|c: char| c.is_whitespace() || c == '#');
    for (camera, marker) in labels.cameras.iter().flat_map(ids) {
        if let Some(id) = [&camera, &marker].into_iter().find(|id| is_bad(id)) {
            bail!(
                "{}, camera {camera}, marker {marker}: the id '{id}' holds a blank or #, so that no edit can name it\n  to do: write _ instead",
                file.display()
            );
        }
    }
    Ok(())
}

impl Start<'_> {
    /// The cameras, each with a tracker that stands at the labelled frame. Faults of all cameras are said together.
    pub(crate) fn cameras(
        &self,
        run: &mut Run,
        footage: &Footage,
        guide: Option<&Guide>,
    ) -> anyhow::Result<Vec<Camera>> {
        let file = self.file.display();
        let (mut cameras, mut faults) = (Vec::new(), Vec::new());
        for (id, places) in self.labels.cameras.iter().filter(|(_, places)| !places.is_empty()) {
            let images = footage.camera(id)?;
            match self.begin(&images, places)? {
                Some(Ok(tracker)) => cameras.push(self.camera(id, images, tracker)),
                Some(Err(error)) => faults.push(format!("{file}, camera {id}: {error}")),
                None => faults.push(format!(
                    "{file}, camera {id}: has no image of frame {}\n  to do: label another frame",
                    self.labels.frame
                )),
            }
        }
        if !faults.is_empty() {
            bail!("{}", faults.join("\n"));
        }
        if cameras.is_empty() {
            bail!(
                "{file}: no camera has labels\n  to do: number the dots with marker-track detect, and name them"
            );
        }
        for camera in &cameras {
            self.warn_of_labels(run, camera);
        }
        if let Some(guide) = guide {
            self.check_guide(run, &cameras, footage, guide)?;
        }
        self.add_unlabelled(run, &mut cameras, footage, guide)?;
        cameras.sort_by(|a, b| a.id.cmp(&b.id));
        Ok(cameras)
    }

    /// A tracker at the labelled frame's image, if the camera has that.
    fn begin(
        &self,
        images: &CameraImages,
        places: &BTreeMap<String, [f64; 2]>,
    ) -> anyhow::Result<Option<Result<Tracker, Error>>> {
        let Some(path) = &images.paths[self.first] else { return Ok(None) };
        let image = images.read_8_bits(path)?;
        Ok(Some(Tracker::start(&image.picture(), images.transfer, self.markers, places, self.params)))
    }

    fn camera(&self, id: &str, images: CameraImages, tracker: Tracker) -> Camera {
        let mut samples = vec![None; images.paths.len()];
        samples[self.first] = Some(tracker.samples());
        let strays = vec![Vec::new(); samples.len()];
        let guided = GuideHits::default();
        Camera { id: id.into(), images, tracker, samples, strays, guided, last: self.first }
    }

    fn warn_of_labels(&self, run: &mut Run, camera: &Camera) {
        let faults: Vec<String> = camera.tracker.label_faults().iter().map(Error::to_string).collect();
        if !faults.is_empty() {
            run.warn(format!(
                "{}, camera {}: labels that are left out: {}; put them on their dots (marker-track detect draws what is found), or take them out",
                self.file.display(),
                camera.id,
                faults.join("; ")
            ));
        }
    }

    fn hints(
        &self,
        guide: &Guide,
        id: &str,
        images: &CameraImages,
    ) -> anyhow::Result<Option<Vec<Option<Hint>>>> {
        guide.hints(self.labels.frame, id, images.size, self.markers)
    }

    /// Holds the guide against the dots of the labelled frame.
    fn check_guide(
        &self,
        run: &mut Run,
        cameras: &[Camera],
        footage: &Footage,
        guide: &Guide,
    ) -> anyhow::Result<()> {
        let gate = self.params.guide_gate_px;
        let mut off = Vec::new();
        for camera in cameras {
            let Some(hints) = self.hints(guide, &camera.id, &footage.camera(&camera.id)?)? else { continue };
            let median = guide.median_off(self.labels.frame, self.markers, &camera.tracker.samples(), &hints);
            off.extend(median.map(|median| (&camera.id, median)));
        }
        let words = |least: f64| -> Vec<String> {
            let far = off.iter().filter(|(_, median)| *median > least);
            far.map(|(id, median)| match median.is_finite() {
                true => format!("{id}: {median:.1} px"),
                false => format!("{id}: outside the image"),
            })
            .collect()
        };
        let say = |words: &[String]| {
            format!(
                "{}: does not lie where the labels of frame {} are (median distance, {})",
                guide.path().display(),
                self.labels.frame,
                words.join(", ")
            )
        };
        let far = words(REFUSED * gate);
        if !far.is_empty() {
            bail!(
                "{}\n  to do: give the guide and the cameras of this take; check units, ids of cameras and markers, and the labels",
                say(&far)
            );
        }
        let unsure = words(gate);
        if !unsure.is_empty() {
            run.warn(format!("{}; a larger --guide-gate-px may be needed", say(&unsure)));
        }
        Ok(())
    }

    /// Cameras without labels, of the image size of one that has some: the guide labels them, or a warning names them.
    fn add_unlabelled(
        &self,
        run: &mut Run,
        cameras: &mut Vec<Camera>,
        footage: &Footage,
        guide: Option<&Guide>,
    ) -> anyhow::Result<()> {
        let sizes: Vec<[u32; 2]> = cameras.iter().map(|camera| camera.images.size).collect();
        let is_labelled = |id: &String| self.labels.cameras.get(id).is_some_and(|places| !places.is_empty());
        let mut left_out = Vec::new();
        for id in footage.ids().into_iter().filter(|id| !is_labelled(id)) {
            let images = footage.camera(id)?;
            if !sizes.contains(&images.size) {
                continue;
            }
            match self.begin_guided(id, &images, guide)? {
                Some(tracker) => cameras.push(self.camera(id, images, tracker)),
                None => left_out.push(id.as_str()),
            }
        }
        if !left_out.is_empty() {
            let why = if guide.is_some() { "the guide shows no dots in their" } else { "no labels in their" };
            run.warn(format!(
                "cameras that are not tracked, with {why} image of frame {}: {}",
                self.labels.frame,
                left_out.join(", ")
            ));
        }
        Ok(())
    }

    /// A tracker whose labels are where the guide puts the markers that face the camera.
    fn begin_guided(
        &self,
        id: &str,
        images: &CameraImages,
        guide: Option<&Guide>,
    ) -> anyhow::Result<Option<Tracker>> {
        let Some(guide) = guide.filter(|guide| guide.has_camera(id)) else { return Ok(None) };
        let Some(hints) = self.hints(guide, id, images)? else { return Ok(None) };
        let facing = |(id, hint): (&String, &Option<Hint>)| {
            hint.filter(|hint| hint.facing).map(|hint| (id.clone(), hint.at))
        };
        let places: BTreeMap<String, [f64; 2]> = self.markers.iter().zip(&hints).filter_map(facing).collect();
        Ok(self.begin(images, &places)?.and_then(Result::ok))
    }
}
