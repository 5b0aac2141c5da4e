//! What is given beside the scenario: a scan or an expression set, recorded weights.

use anyhow::{Context, bail};
use artifact::{Consent, FileRef, Unit, picks, picture};
use serde::{Serialize, Serializer};
use stage::Run;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use virtual_rig::act::Clip;
use virtual_rig::body::Base;
use virtual_rig::body::expressions::{Shape, expressions};
use virtual_rig::body::scan::{Notes, Scan, scan};
use virtual_rig::body::texture::Texture;
use virtual_rig::scenario::{Performance, Scenario};
use virtual_rig::take::Given;

#[derive(clap::Args, Serialize)]
#[command(next_help_heading = "A face of yours")]
pub(crate) struct GivenFace {
    /// Scan that acts instead of the parametric face: .obj or .ply, any polygons, open or closed
    #[arg(long, value_name = "FILE", requires = "landmarks", requires = "unit")]
    #[serde(serialize_with = "as_name")]
    mesh: Option<PathBuf>,
    /// Unit of the scan's and the landmarks' coordinates
    #[arg(long, value_name = "mm|cm|m", requires = "mesh")]
    unit: Option<Unit>,
    /// Places of named landmarks on it: .csv (name,vertex or name,x,y,z) or .pp
    #[arg(long, value_name = "FILE", requires = "mesh")]
    #[serde(serialize_with = "as_name")]
    landmarks: Option<PathBuf>,
    /// Its albedo, .png or .jpg; needs texture coordinates
    #[arg(long, value_name = "FILE", requires = "mesh")]
    #[serde(serialize_with = "as_name")]
    texture: Option<PathBuf>,
    /// An expression of the scan, in dense correspondence; may be said again
    #[arg(long, value_name = "NAME=FILE", requires = "mesh", value_parser = named_file)]
    #[serde(serialize_with = "as_names")]
    shape: Vec<(String, PathBuf)>,
    /// Recorded weights of a performance (Live Link Face CSV); the scenario's performance then is this recording
    #[arg(long, value_name = "FILE")]
    #[serde(serialize_with = "as_name")]
    weights: Option<PathBuf>,
    /// Licence of the face, in words; travels into the manifest
    #[arg(long, value_name = "TEXT", requires = "mesh")]
    licence: Option<String>,
    /// Credit line of the face; travels into the manifest
    #[arg(long, value_name = "TEXT", requires = "mesh")]
    credit: Option<String>,
}

/// A side-car holds no paths: the same files give the same bytes wherever they lie.
#[allow(clippy::ref_option, reason = "serde hands a field over by reference")]
fn as_name<S: Serializer>(path: &Option<PathBuf>, serializer: S) -> Result<S::Ok, S::Error> {
    path.as_deref().map(artifact::file_name).serialize(serializer)
}

fn as_names<S: Serializer>(shapes: &[(String, PathBuf)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(shapes.iter().map(|(name, path)| (name, artifact::file_name(path))))
}

fn named_file(text: &str) -> Result<(String, PathBuf), String> {
    match text.split_once('=') {
        Some((name, file)) if !name.is_empty() && !file.is_empty() => Ok((name.into(), file.into())),
        _ => Err("say NAME=FILE, e.g. smile=smile.obj".into()),
    }
}

impl GivenFace {
    /// Reads what is given; the files by role.
    pub(super) fn read(
        &self,
        run: &mut Run,
        scenario: &mut Scenario,
    ) -> anyhow::Result<(Given, BTreeMap<String, FileRef>)> {
        let mut files = BTreeMap::new();
        let clip = match &self.weights {
            None => None,
            Some(path) => {
                let text = artifact::read_text(path)?;
                files.insert("weights".to_string(), run.input("weights", path)?);
                if !matches!(scenario.performance, Performance::Recording(_)) {
                    scenario.performance = Performance::Recording(Default::default());
                }
                Some(
                    Clip::parse(&text)
                        .with_context(|| format!("{}: is no recording of weights", path.display()))?,
                )
            }
        };
        let base = match (&self.mesh, &self.landmarks) {
            (Some(mesh), Some(landmarks)) => {
                Some(self.base(run, mesh, landmarks, scenario.vertices, &mut files)?)
            }
            _ => None,
        };
        Ok((Given { base, clip }, files))
    }

    fn base(
        &self,
        run: &mut Run,
        path: &Path,
        landmarks: &Path,
        vertices: usize,
        files: &mut BTreeMap<String, FileRef>,
    ) -> anyhow::Result<Base> {
        let (mesh, reference) = run.mesh("mesh", path, &[("--unit", self.unit)])?;
        let picked = picks::read(landmarks, reference.unit)?;
        files.insert("mesh".to_string(), reference.file.clone());
        files.insert("landmarks".to_string(), run.input("landmarks", landmarks)?);
        let texture = self.texture.as_deref().map(|path| read_texture(run, path, files)).transpose()?;
        let notes = Notes {
            unit: reference.unit,
            landmarks: &picked,
            texture: texture.as_ref(),
            levels: levels(mesh.positions.len(), vertices),
        };
        let in_file = || path.display().to_string();
        if self.shape.is_empty() {
            let scan = scan(&mesh, &notes).with_context(in_file)?;
            tell(run, path, &scan);
            return Ok(Base::Scan(scan));
        }
        let mut shapes = Vec::with_capacity(self.shape.len());
        for (name, file) in &self.shape {
            let mesh = artifact::read_mesh(file, reference.unit)?;
            files.insert(format!("shape-{name}"), run.input(name, file)?);
            shapes.push(Shape { name: name.clone(), file: file.display().to_string(), mesh });
        }
        let set = expressions(&mesh, &shapes, &notes).with_context(in_file)?;
        tell(run, path, &set.scan);
        Ok(Base::Expressions(set))
    }

    /// What may be done with the take.
    pub(super) fn consent(&self) -> Consent {
        match &self.mesh {
            None => Consent {
                licence: "none needed".into(),
                credit: None,
                notes: Some("a synthetic face: nobody was recorded".into()),
            },
            Some(_) => Consent {
                licence: self.licence.clone().unwrap_or_else(|| "unknown".into()),
                credit: self.credit.clone(),
                notes: Some("a virtual take: the scan acts, nobody was recorded".into()),
            },
        }
    }
}

/// How often triangles become four, so that bisection does the rest.
fn levels(from: usize, wanted: usize) -> usize {
    let mut levels = 0;
    while from * 4usize.pow(levels as u32 + 1) <= wanted && levels < 6 {
        levels += 1;
    }
    levels
}

fn tell(run: &mut Run, path: &Path, scan: &Scan) {
    if let Some((name, worst)) = scan.residuals.iter().max_by(|one, other| one.1.total_cmp(&other.1)) {
        run.detail(&format!("{}: landmarks fit to {worst:.1} mm ({name})", path.display()));
    }
    if !scan.mouth_is_open {
        run.warn(format!(
            "{}: the mouth is not cut open, so the lips will stretch; cut it with mesh-clip, or leave jaw and speech out",
            path.display()
        ));
    }
    if !scan.eyes_are_open {
        run.warn(format!(
            "{}: the eyes are closed or not cut open; blinks will pull on the lids",
            path.display()
        ));
    }
}

fn read_texture(
    run: &mut Run,
    path: &Path,
    files: &mut BTreeMap<String, FileRef>,
) -> anyhow::Result<Texture> {
    let picture = picture::read_rgb(path)?;
    files.insert("texture".to_string(), run.input("texture", path)?);
    let codes = picture.to_8_bits();
    match Texture::from_srgb(picture.width, picture.height, &codes) {
        Ok(texture) => Ok(texture),
        Err(error) => bail!("{}: {error}", path.display()),
    }
}
