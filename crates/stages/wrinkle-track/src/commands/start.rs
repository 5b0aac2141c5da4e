//! What is known before the first image is followed: the cameras, and the wrinkles with their names.

use super::masks::MaskedShot;
use super::names::Name;
use anyhow::bail;
use artifact::{Curve2d, PaintModel, Wrinkle};
use stage::{CameraImages, Footage, Run};
use std::collections::BTreeMap;
use std::path::Path;
use wrinkle_track::{
    Classifier, Follower, MarkedPaint, MarkedWrinkle, NamedPlace, TrackParams, marked_wrinkles,
};

/// A camera at work.
pub(crate) struct Camera {
    pub(crate) id: String,
    pub(crate) images: CameraImages,
    pub(crate) follower: Follower,
    pub(crate) classifier: Classifier,
    /// Place of the marked frame.
    pub(crate) first: usize,
    /// Per frame wrinkles that appear in it.
    pub(crate) named: BTreeMap<usize, Vec<(usize, NamedPlace)>>,
    /// Per frame the curves of all wrinkles, if it has an image.
    pub(crate) curves: Vec<Option<Vec<Option<Curve2d>>>>,
    pub(crate) strays: usize,
    pub(crate) clipped: f64,
}

/// What was read.
pub(crate) struct Start<'a> {
    pub(crate) model: &'a PaintModel,
    pub(crate) footage: &'a Footage,
    pub(crate) names: Option<(&'a Path, &'a [Name])>,
    pub(crate) params: TrackParams,
}

impl Start<'_> {
    /// The cameras with a mask, and all wrinkles, sorted by id.
    pub(crate) fn cameras(
        &self,
        run: &mut Run,
        shots: Vec<MaskedShot>,
    ) -> anyhow::Result<(Vec<Camera>, Vec<Wrinkle>)> {
        self.check_names(&shots)?;
        let marked: Vec<Vec<MarkedWrinkle>> =
            shots.iter().map(|shot| self.marked(run, shot)).collect::<anyhow::Result<_>>()?;
        let mut wrinkles = self.wrinkles(&marked)?;
        let late = self.late(&shots);
        for name in late.iter().map(|(_, name)| &name.place.wrinkle) {
            if let Err(place) = wrinkles.binary_search_by(|wrinkle| wrinkle.id.cmp(name)) {
                wrinkles.insert(place, Wrinkle { id: name.clone(), paint: None });
            }
        }
        let ids: Vec<String> = wrinkles.iter().map(|wrinkle| wrinkle.id.clone()).collect();
        let mut cameras = Vec::new();
        for (shot, marked) in shots.into_iter().zip(marked) {
            let mut named: BTreeMap<usize, Vec<(usize, NamedPlace)>> = BTreeMap::new();
            for (frame, name) in late.iter().filter(|(_, name)| name.camera == shot.camera) {
                if let Some(index) = ids.iter().position(|id| *id == name.place.wrinkle) {
                    named.entry(*frame).or_default().push((index, name.place.clone()));
                }
            }
            cameras.push(Camera {
                follower: Follower::new(&ids, &marked, self.params),
                classifier: Classifier::new(self.model)?,
                first: shot.index,
                named,
                curves: vec![None; shot.images.paths.len()],
                id: shot.camera,
                images: shot.images,
                strays: 0,
                clipped: 0.0,
            });
        }
        Ok((cameras, wrinkles))
    }

    /// The marked wrinkles of all cameras, each once, sorted by id.
    fn wrinkles(&self, marked: &[Vec<MarkedWrinkle>]) -> anyhow::Result<Vec<Wrinkle>> {
        let mut paints: BTreeMap<&String, u8> = BTreeMap::new();
        for MarkedWrinkle { id, paint, .. } in marked.iter().flatten() {
            if let Some(other) = paints.insert(id, *paint).filter(|other| other != paint) {
                let file = self.names.map_or(Path::new("masks"), |(path, _)| path).display();
                let [one, other] = [other, *paint].map(|paint| self.paint(paint));
                bail!(
                    "{file}: the wrinkle {id} lies on paint {one} and on paint {other}\n  to do: give two wrinkles two names"
                );
            }
        }
        let wrinkle = |(id, paint): (&String, u8)| Wrinkle { id: id.clone(), paint: Some(self.paint(paint)) };
        Ok(paints.into_iter().map(wrinkle).collect())
    }

    fn paint(&self, number: u8) -> String {
        let index = usize::from(number).saturating_sub(1);
        self.model.paints.get(index).map(|paint| paint.id.clone()).unwrap_or_default()
    }

    fn all_names(&self) -> &[Name] {
        self.names.map(|(_, names)| names).unwrap_or_default()
    }

    /// Names in other frames than the marked one, with their frames' places.
    fn late(&self, shots: &[MaskedShot]) -> Vec<(usize, &Name)> {
        let numbers = self.footage.numbers();
        let place = |name: &Name| {
            let index = numbers.iter().position(|number| Some(*number) == name.frame)?;
            let shot = shots.iter().find(|shot| shot.camera == name.camera)?;
            (shot.index != index).then_some(index)
        };
        self.all_names().iter().filter_map(|name| Some((place(name)?, name))).collect()
    }

    /// The marked wrinkles of a camera.
    fn marked(&self, run: &mut Run, shot: &MaskedShot) -> anyhow::Result<Vec<MarkedWrinkle>> {
        let (paints, labels) = self.labels(shot)?;
        let frame = self.footage.numbers()[shot.index];
        let is_here = |name: &&Name| name.camera == shot.camera && name.frame.is_none_or(|of| of == frame);
        let names: Vec<&Name> = self.all_names().iter().filter(is_here).collect();
        if self.names.is_some() && names.is_empty() {
            run.warn(format!("camera {}: no name is given for any of its wrinkles", shot.camera));
            return Ok(Vec::new());
        }
        let places: Vec<NamedPlace> = names.iter().map(|name| name.place.clone()).collect();
        let (size, prefix) = ([shot.mask.width, shot.mask.height], format!("{}_", shot.camera));
        let marked = marked_wrinkles(size, &labels, &paints, &places, &prefix, &self.params);
        if let (Some(wrong), Some((path, _))) = (marked.misplaced.first(), self.names) {
            let line = names.iter().find(|name| name.place == *wrong).map_or(0, |name| name.line);
            bail!(
                "{}, line {line}: nothing is marked at {}, {} in camera {}, where {} shall be\n  to do: name a place on the marked paint",
                path.display(),
                wrong.at.x,
                wrong.at.y,
                shot.camera,
                wrong.wrinkle
            );
        }
        if !marked.unnamed.is_empty() {
            let places: Vec<String> =
                marked.unnamed.iter().map(|at| format!("{:.0}, {:.0}", at.x, at.y)).collect();
            run.warn(format!("camera {}: marked, but without a name: at {}", shot.camera, places.join("; ")));
        }
        Ok(marked.wrinkles)
    }

    /// The paints of the model, and a mask in them.
    fn labels(&self, shot: &MaskedShot) -> anyhow::Result<(Vec<String>, Vec<u8>)> {
        let paints = self.model.paints.iter();
        let paints: Vec<MarkedPaint> =
            paints.map(|paint| MarkedPaint { name: paint.id.clone(), mark: paint.mark }).collect();
        let labels = shot.labels(&paints);
        let known = labels.iter().filter(|label| (1..=paints.len()).contains(&usize::from(**label))).count();
        if 2 * known < shot.mask.marks.iter().flatten().count() {
            bail!(
                "{}: most of it is marked in colours that the model does not know\n  to do: give the masks that the model was learnt from, or train again",
                shot.mask_path.display()
            );
        }
        Ok((paints.into_iter().map(|paint| paint.name).collect(), labels))
    }

    fn check_names(&self, shots: &[MaskedShot]) -> anyhow::Result<()> {
        let Some((path, names)) = self.names else { return Ok(()) };
        let numbers = self.footage.numbers();
        for name in names {
            let place = format!("{}, line {}", path.display(), name.line);
            if !shots.iter().any(|shot| shot.camera == name.camera) {
                bail!(
                    "{place}: no mask is given for camera {}\n  to do: mark its first image, or leave the row out",
                    name.camera
                );
            }
            if let Some(frame) = name.frame.filter(|frame| !numbers.contains(frame)) {
                bail!(
                    "{place}: the take has no frame {frame}\n  to do: name a frame of the take, or none for the marked one"
                );
            }
        }
        Ok(())
    }
}
