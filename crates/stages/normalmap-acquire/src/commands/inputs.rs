//! Photographs, landmarks and masks, and whether they go together.

use super::film::{frame, is_video};
use anyhow::{bail, ensure};
use artifact::picture::read_gray;
use artifact::{GreenAxis, LandmarkFile, Landmarks, Photograph, Transfer, read_landmarks, read_photograph};
use normalmap_acquire::{Face, Pair, Photo, Plane, Scheme, normal_of, rough_normals};
use stage::Run;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The neutral face
#[derive(clap::Args)]
#[command(next_help_heading = "Neutral face")]
pub(crate) struct Neutral {
    /// Photograph of the face at rest (PNG, JPEG), or a video: its first frame, or film.mp4#12 its frame 12
    #[arg(long, value_name = "FILE")]
    pub(crate) neutral: PathBuf,
    /// Landmarks in it (.json, .tem, .pts, .csv)
    #[arg(long, value_name = "FILE")]
    pub(crate) neutral_landmarks: PathBuf,
    /// Distance of the pupils, px [default: by the landmarks]
    #[arg(long, value_name = "PX")]
    interocular_px: Option<f64>,
    /// Painted region of interest: white where wrinkles are wanted; several are added up
    #[arg(long, value_name = "FILE")]
    mask: Vec<PathBuf>,
    /// Normal map of the neutral skin, in the frame of its photograph (OpenGL)
    #[arg(long, value_name = "FILE", conflicts_with = "normal_z")]
    neutral_normals: Option<PathBuf>,
    /// Share of the neutral normal towards the camera where it is the same everywhere
    #[arg(long, value_name = "NZ")]
    normal_z: Option<f64>,
    /// What codes mean: srgb, rec709, linear or "gamma G" [default: what the files say, else srgb]
    #[arg(long, value_name = "NAME")]
    pub(crate) transfer: Option<Transfer>,
    /// Parts that are no skin: ids of landmarks around each
    #[arg(long, value_name = "ID,ID,…")]
    exclude: Vec<String>,
    /// Landmarks to leave out of the warp
    #[arg(long, value_name = "ID,…", value_delimiter = ',')]
    leave_out: Vec<String>,
    /// Use the landmarks that both files have, and pass over the others
    #[arg(long)]
    common_landmarks: bool,
    /// Take photographs of different sizes or depths as they are
    #[arg(long)]
    unlike: bool,
}

/// Landmarks further than this from where the others expect them are crossed, distances of the pupils.
const CROSSED_IO: f64 = 0.5;

/// The neutral photograph and what is known of it.
pub(crate) struct Rest {
    pub(crate) photo: Photo,
    pub(crate) photograph: Photograph,
    pub(crate) landmarks: Landmarks,
    pub(crate) face: Face,
    pub(crate) scheme: Scheme,
}

impl Neutral {
    /// Reads all of it.
    pub(crate) fn read(&self, run: &mut Run) -> anyhow::Result<Rest> {
        let photograph = photograph(run, "neutral", &self.neutral, self.transfer)?;
        let landmarks = landmarks(run, "neutral-landmarks", &self.neutral_landmarks, &photograph)?;
        let scheme = Scheme::of(landmarks.points.keys().map(String::as_str));
        let io_px = self.interocular(&landmarks, &scheme)?;
        let size = [photograph.width, photograph.height];
        let mut parts = scheme.parts.clone();
        parts.extend(
            self.exclude.iter().map(|ids| (ids.split(',').map(|id| id.trim().to_string()).collect(), 0.0)),
        );
        let depths: Option<Vec<_>> = landmarks.points.values().map(|p| Some((p.at, p.depth_px?))).collect();
        let rough = depths.map(|points| rough_normals(&points, io_px, [0, 0], size)).transpose()?;
        let face = Face {
            io_px,
            parts,
            painted: self.painted(run, size)?,
            neutral: self.neutral_normals(run, size)?,
            rough,
            ..Face::default()
        };
        Ok(Rest { photo: photo(&photograph), photograph, landmarks, face, scheme })
    }

    fn interocular(&self, landmarks: &Landmarks, scheme: &Scheme) -> anyhow::Result<f64> {
        let middle = |ids: &[String]| {
            let places: Option<Vec<[f64; 2]>> =
                ids.iter().map(|id| Some(landmarks.points.get(id)?.at)).collect();
            let places = places.filter(|places| !places.is_empty())?;
            Some([0, 1].map(|axis| places.iter().map(|at| at[axis]).sum::<f64>() / places.len() as f64))
        };
        let told = || Some((middle(&scheme.eyes[0])?, middle(&scheme.eyes[1])?));
        let by_eyes = || told().map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]));
        match self.interocular_px.or(landmarks.interocular_px).or_else(by_eyes) {
            Some(io) if (8.0..1e5).contains(&io) => Ok(io),
            Some(io) => bail!("--interocular-px {io}: must lie between 8 and 100000"),
            None => bail!(
                "{}: does not say how far apart the pupils are\n  to do: say --interocular-px",
                self.neutral_landmarks.display()
            ),
        }
    }

    fn painted(&self, run: &mut Run, size: [usize; 2]) -> anyhow::Result<Option<Plane>> {
        let mut sum: Option<Plane> = None;
        for path in &self.mask {
            let mask = read_gray(path)?;
            run.input("mask", path)?;
            ensure!(
                [mask.width, mask.height] == size,
                "{}: has {} × {} pixels, the neutral photograph {} × {}\n  to do: paint the mask over the neutral photograph",
                path.display(),
                mask.width,
                mask.height,
                size[0],
                size[1]
            );
            let plane = Plane { width: mask.width, height: mask.height, values: mask.pixels };
            sum = Some(sum.map_or(plane.clone(), |sum| sum.with(&plane, |a, b| (a + b).min(1.0))));
        }
        Ok(sum)
    }

    fn neutral_normals(&self, run: &mut Run, size: [usize; 2]) -> anyhow::Result<Option<[Plane; 3]>> {
        if let Some(z) = self.normal_z {
            ensure!((0.05..=1.0).contains(&z), "--normal-z {z}: must lie between 0.05 and 1");
            // Which way it leans does not matter to the paper's rule; z alone counts.
            let plane = |value| Plane::filled(size[0], size[1], value);
            return Ok(Some([plane(0.0), plane(0.0), plane(z)]));
        }
        let Some(path) = &self.neutral_normals else { return Ok(None) };
        let map = artifact::picture::read_rgb(path)?;
        run.input("neutral-normals", path)?;
        ensure!(
            [map.width, map.height] == size,
            "{}: has {} × {} pixels, the neutral photograph {} × {}\n  to do: give a map in the frame of the photograph",
            path.display(),
            map.width,
            map.height,
            size[0],
            size[1]
        );
        let normal = |axis: usize| {
            Plane::from_fn(map.width, map.height, |column, row| {
                normal_of(map.at(column, row), GreenAxis::Opengl)[axis]
            })
        };
        Ok(Some([normal(0), normal(1), normal(2)]))
    }

    /// The same landmarks in both photographs.
    pub(crate) fn pairs(
        &self,
        rest: &Rest,
        expression: &Landmarks,
        path: &Path,
    ) -> anyhow::Result<Vec<Pair>> {
        let ids = |landmarks: &Landmarks| landmarks.points.keys().cloned().collect::<BTreeSet<_>>();
        let (here, there) = (ids(&rest.landmarks), ids(expression));
        if let Some(id) = here.symmetric_difference(&there).next().filter(|_| !self.common_landmarks) {
            let (owner, other) = match here.contains(id) {
                true => (&*self.neutral_landmarks, path),
                false => (path, &*self.neutral_landmarks),
            };
            bail!(
                "{}: has no landmark {id}, which {} has ({} and {} landmarks)\n  to do: mark the same places in both, or say --common-landmarks",
                other.display(),
                owner.display(),
                there.len(),
                here.len()
            );
        }
        let is_left_out = |id: &String| self.leave_out.contains(id) || rest.scheme.loose.contains(id);
        let pairs: Vec<Pair> = here
            .intersection(&there)
            .filter(|id| !is_left_out(id))
            .map(|id| Pair {
                id: id.clone(),
                from: rest.landmarks.points[id].at,
                to: expression.points[id].at,
            })
            .collect();
        ensure!(
            pairs.len() >= 4,
            "{}: {} landmarks can be used; at least 4 are needed\n  to do: mark more places",
            path.display(),
            pairs.len()
        );
        check_crossed(&pairs, [rest.face.io_px; 2], path)?;
        Ok(pairs)
    }

    /// The photograph of an expression, which must go with the neutral one.
    pub(crate) fn expression(&self, run: &mut Run, rest: &Rest, path: &Path) -> anyhow::Result<Photograph> {
        let photograph = photograph(run, "expression", path, self.transfer)?;
        self.check_alike(rest, &photograph, path)?;
        if rest.photograph.luminance == photograph.luminance {
            bail!(
                "{}: shows the same pixels as {}: there is no expression to take over\n  to do: give the photograph of an expression",
                path.display(),
                self.neutral.display()
            );
        }
        Ok(photograph)
    }

    /// Refuses a photograph that is no one of the neutral one's camera.
    pub(crate) fn check_alike(
        &self,
        rest: &Rest,
        photograph: &Photograph,
        path: &Path,
    ) -> anyhow::Result<()> {
        let (here, there) = (&rest.photograph, photograph);
        let told = |p: &Photograph| format!("{} × {} pixels of {} bits", p.width, p.height, p.bits);
        let alike = (here.width, here.height, here.bits) == (there.width, there.height, there.bits);
        ensure!(
            alike || self.unlike,
            "{}: has {}, the neutral photograph {}\n  to do: give photographs of one camera; if these are as they should be, say --unlike",
            path.display(),
            told(there),
            told(here)
        );
        Ok(())
    }
}

/// Refuses a landmark that the others contradict; the face's size where the pairs come from, and the distance of the pupils where they
/// lead, px.
pub(crate) fn check_crossed(pairs: &[Pair], [scale, io]: [f64; 2], path: &Path) -> anyhow::Result<()> {
    let warp = normalmap_acquire::Warp::fit(pairs, scale, 1e-3)?;
    let worst = (0..pairs.len()).max_by(|a, b| warp.left_out()[*a].total_cmp(&warp.left_out()[*b]));
    match worst.filter(|at| warp.left_out()[*at] > CROSSED_IO * io && pairs.len() > 6) {
        Some(at) => bail!(
            "{}, landmark {}: lies {:.0} px from where the other landmarks expect it\n  to do: check that it is not crossed with another, or say --leave-out {}",
            path.display(),
            pairs[at].id,
            warp.left_out()[at],
            pairs[at].id
        ),
        None => Ok(()),
    }
}

/// Reads a photograph that shows something.
fn photograph(
    run: &mut Run,
    role: &str,
    path: &Path,
    stated: Option<Transfer>,
) -> anyhow::Result<Photograph> {
    let photograph = run.timed("read", || read_still(path, stated))?;
    run.input(role, &still_of(path).map_or(path.to_path_buf(), |(video, _)| video))?;
    run.detail(&format!("  {}: codes mean {}", path.display(), photograph.codes));
    let bright = photograph.luminance.iter().filter(|light| **light > UNLIT).count();
    ensure!(
        20 * bright > photograph.luminance.len(),
        "{}: shows nothing: all but {bright} of its pixels are unlit\n  to do: give a photograph that is exposed",
        path.display()
    );
    let clipped = photograph.clipped.iter().filter(|clipped| **clipped).count();
    if 5 * clipped > photograph.clipped.len() {
        run.warn(format!("{}: {clipped} pixels are overexposed and do not count", path.display()));
    }
    if photograph.turned {
        run.detail(&format!(
            "  {}: turned as its EXIF data says; landmarks count in the turned picture",
            path.display()
        ));
    }
    Ok(photograph)
}

/// A photograph, or a frame of a video.
fn read_still(path: &Path, stated: Option<Transfer>) -> anyhow::Result<Photograph> {
    match still_of(path) {
        Some((video, number)) => frame(&video, number, stated),
        None => Ok(read_photograph(path, stated)?),
    }
}

/// The video that a path names, and which of its frames.
fn still_of(path: &Path) -> Option<(PathBuf, i64)> {
    let text = path.to_string_lossy();
    let (video, number) = match text.rsplit_once('#') {
        Some((video, number)) => (PathBuf::from(video), number.parse().ok()?),
        None => (path.to_path_buf(), 0),
    };
    is_video(&video).then_some((video, number))
}

/// Linear light below this is not to be divided by.
const UNLIT: f64 = 0.004;

pub(crate) fn photo(photograph: &Photograph) -> Photo {
    let (width, height) = (photograph.width, photograph.height);
    let usable = photograph.luminance.iter().zip(&photograph.clipped);
    let usable = usable.map(|(light, clipped)| f64::from(u8::from(*light > UNLIT && !clipped))).collect();
    Photo {
        light: Plane { width, height, values: photograph.luminance.clone() },
        usable: Plane { width, height, values: usable },
    }
}

/// Landmarks that lie in their photograph.
pub(crate) fn landmarks(
    run: &mut Run,
    role: &str,
    path: &Path,
    photograph: &Photograph,
) -> anyhow::Result<Landmarks> {
    let landmarks = read_marks(path, photograph)?;
    run.input(role, path)?;
    Ok(landmarks)
}

/// As [`landmarks`], not noted as an input.
pub(crate) fn read_marks(path: &Path, photograph: &Photograph) -> anyhow::Result<Landmarks> {
    let LandmarkFile { landmarks, is_uv } = read_landmarks(path)?;
    ensure!(
        !is_uv,
        "{}: holds texture coordinates\n  to do: give places in the photograph, px",
        path.display()
    );
    let size = [photograph.width, photograph.height];
    if let Some(said) = landmarks.size.filter(|said| said.map(|side| side as usize) != size) {
        bail!(
            "{}: is of a picture of {} × {} pixels, the photograph has {} × {}\n  to do: give the landmarks of this photograph, as it stands upright",
            path.display(),
            said[0],
            said[1],
            size[0],
            size[1]
        );
    }
    let outside = |at: &[f64; 2]| (0..2).any(|axis| !(-0.5..=size[axis] as f64 - 0.5).contains(&at[axis]));
    if let Some((id, point)) = landmarks.points.iter().find(|(_, point)| outside(&point.at)) {
        bail!(
            "{}, landmark {id}: ({:.1}, {:.1}) lies outside the photograph of {} × {} pixels\n  to do: check that the landmarks belong to it and count from its upper left corner",
            path.display(),
            point.at[0],
            point.at[1],
            size[0],
            size[1]
        );
    }
    ensure!(
        landmarks.points.len() >= 4,
        "{}: holds {} landmarks; at least 4 are needed\n  to do: mark more places",
        path.display(),
        landmarks.points.len()
    );
    Ok(landmarks)
}
