//! The pages, and what they ask for.

mod documents;
mod images;
mod meshes;
mod overview;
mod programs;

use anyhow::bail;
use artifact::Take;
use documents::Documents;
use images::Images;
use loopback::{Asset, Method, Request, Response, Root, Site, asset};
use programs::{Marked, Programs};
use serde::Deserialize;
use stage::{Run, Stopwatch};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use workbench::{CAMERAS, Claim, Document, Place, Standing};

/// A take on the bench.
pub(crate) struct Bench {
    take: Root,
    manifest: Option<Take>,
    run: Option<PathBuf>,
    documents: Documents,
    images: OnceLock<Images>,
    programs: Programs,
    claim: Mutex<Claim>,
    /// What was taken for paint the last time that somebody asked.
    learnt: Mutex<Vec<u8>>,
    clock: Stopwatch,
    /// One file is written at a time.
    pen: Mutex<()>,
}

/// The pages, as they were built: see `web/`.
const ASSETS: [Asset; 3] = [
    Asset {
        path: "",
        content_type: "text/html; charset=utf-8",
        bytes: include_bytes!("../../web/built/index.html"),
    },
    Asset {
        path: "workbench.js",
        content_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../web/built/workbench.js"),
    },
    Asset {
        path: "workbench.css",
        content_type: "text/css; charset=utf-8",
        bytes: include_bytes!("../../web/built/workbench.css"),
    },
];

/// What was asked for, or why not.
type Answer = Result<Response, Response>;

/// What a thread that failed left behind is still whole: it is replaced at once or not at all.
fn locked<T>(held: &Mutex<T>) -> MutexGuard<'_, T> {
    held.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A problem of what was asked for, with all its causes.
fn refused(error: &anyhow::Error) -> Response {
    Response::refused(422, &format!("{error:#}"))
}

impl Bench {
    /// Lays a take on the bench.
    ///
    /// # Errors
    /// If a folder is not there, or the manifest cannot be read.
    pub(crate) fn open(
        run: &mut Run,
        take: &Path,
        of_run: Option<&Path>,
        programs: Option<PathBuf>,
    ) -> anyhow::Result<Self> {
        let root = Root::new(take)?;
        if let Some(folder) = of_run.filter(|folder| !folder.is_dir()) {
            bail!(
                "{}: there is no such folder\n  to do: run just take first, or leave --run out",
                folder.display()
            );
        }
        let manifest = root.folder().join("take.json");
        let manifest = match manifest.exists() {
            true => Some(stage::load_take(run, &manifest)?.0),
            false => None,
        };
        if manifest.is_none() {
            run.warn(format!("{}: has no take.json; only photographs can be worked on", take.display()));
        }
        Ok(Self {
            documents: Documents::new(root.folder(), manifest.as_ref().map(|take| take.mesh_unit)),
            take: root,
            manifest,
            run: of_run.map(Path::to_path_buf),
            images: OnceLock::new(),
            programs: Programs::new(programs)?,
            claim: Mutex::default(),
            learnt: Mutex::default(),
            clock: Stopwatch::start(),
            pen: Mutex::default(),
        })
    }

    /// Where a file of the take or of the run is; none where it is in neither.
    fn find(&self, places: &[(Place, &str)]) -> Option<PathBuf> {
        places.iter().find_map(|(place, path)| match place {
            Place::Take => self.take.existing(path).ok(),
            Place::Run => self.run.as_ref().map(|run| run.join(path)).filter(|path| path.exists()),
        })
    }

    /// The images; read when they are first asked for, and again as long as they are not there.
    fn images(&self) -> Result<&Images, Response> {
        if let Some(images) = self.images.get() {
            return Ok(images);
        }
        let images = Images::open(self).map_err(|error| refused(&error))?;
        Ok(self.images.get_or_init(|| images))
    }

    fn ask(&self, request: &Request) -> Answer {
        let (first, rest) = request.path.split_once('/').unwrap_or((&request.path, ""));
        match (request.method, first) {
            (Method::Get, "overview") => Ok(Response::json(&overview::overview(self))),
            (Method::Get, "cameras") => Ok(Response::json(&self.images()?.cameras())),
            (Method::Get, "image") => self.images()?.image(rest),
            (Method::Get, "mesh") => meshes::mesh(self, rest).map_err(|error| refused(&error)),
            (Method::Get, "document") => self.documents.shown(document(rest)?),
            (Method::Get, "picture") => self.documents.picture(document(rest)?),
            (Method::Post, "here") => Ok(self.here(&request.json()?)),
            (Method::Put, "draft") => self.writing(request, rest, |document, base| {
                self.documents.draft(&document, base, &request.body)
            }),
            (Method::Post, "save") => {
                self.writing(request, rest, |document, base| self.documents.save(&document, base))
            }
            (Method::Post, "discard") => {
                self.writing(request, rest, |document, _| self.documents.discard(&document))
            }
            (Method::Post, "dots") => {
                self.programs.dots(self, &request.json()?).map_err(|error| refused(&error))
            }
            (Method::Get, "learnt") => Ok(Response::bytes("image/png", locked(&self.learnt).clone())),
            (Method::Post, "learn") => self.learn(&request.json()?),
            (Method::Post, "warp") => {
                self.programs.warp(self, &request.json()?).map_err(|error| refused(&error))
            }
            (Method::Post, "hints") => self.hints(&request.json()?),
            (Method::Get, _) => Err(Response::missing()),
            _ => Err(Response::refused(405, "this cannot be written")),
        }
    }

    /// Does what only the page that holds the bench may do. The query says `page=…&base=…`.
    fn writing(
        &self,
        request: &Request,
        id: &str,
        write: impl FnOnce(Document, Option<&str>) -> Answer,
    ) -> Answer {
        let said = |name: &str| {
            let words =
                request.query.as_deref().unwrap_or("").split('&').filter_map(|word| word.split_once('='));
            words.into_iter().find(|(key, _)| *key == name).map(|(_, value)| value)
        };
        let page = said("page").ok_or_else(|| Response::refused(400, "which page this is must be said"))?;
        match self.stand(page, false) {
            Standing::Holds => {
                let _alone = locked(&self.pen);
                write(document(id)?, said("base").filter(|base| !base.is_empty()))
            }
            Standing::Looks => {
                Err(Response::refused(423, "another window works on this take; take over there first"))
            }
        }
    }

    fn here(&self, call: &Call) -> Response {
        if call.leaves {
            locked(&self.claim).leave(&call.page);
            return Response::done();
        }
        Response::json(&(self.stand(&call.page, call.takes_over) == Standing::Holds))
    }

    fn stand(&self, page: &str, takes_over: bool) -> Standing {
        let mut claim = locked(&self.claim);
        let now_s = self.clock.seconds();
        if takes_over { claim.take(page, now_s) } else { claim.hear(page, now_s) }
    }

    fn learn(&self, asked: &Marked) -> Answer {
        let (mask, results) = self.programs.learn(self, asked).map_err(|error| refused(&error))?;
        *locked(&self.learnt) = mask;
        Ok(Response::json(&results))
    }

    /// What other cameras say of the markers in one image.
    fn hints(&self, asked: &Asked) -> Answer {
        let Some(path) = self.find(CAMERAS) else { return Ok(Response::json(&serde_json::json!({}))) };
        let rig: artifact::CameraRig =
            artifact::read_document(&path).map_err(|error| refused(&anyhow::Error::new(error)))?;
        let rig = rig.cameras.into_iter().map(|(id, camera)| (id, camera.camera)).collect();
        match workbench::epipolar::hints(&rig, &asked.labels, &asked.camera) {
            Ok(hints) => Ok(Response::json(&hints)),
            // A camera that was not calibrated is shown without lines.
            Err(_) => Ok(Response::json(&serde_json::json!({}))),
        }
    }
}

/// What a page says every few seconds.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Call {
    page: String,
    #[serde(default)]
    takes_over: bool,
    #[serde(default)]
    leaves: bool,
}

/// Labels so far, and the camera that is looked at.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Asked {
    labels: std::collections::BTreeMap<String, workbench::epipolar::Dots>,
    camera: String,
}

fn document(id: &str) -> Result<Document, Response> {
    Document::of(id).ok_or_else(Response::missing)
}

impl Site for Bench {
    fn answer(&self, request: &Request) -> Response {
        if request.method == Method::Get
            && let Some(response) = asset(&ASSETS, &request.path)
        {
            return response;
        }
        self.ask(request).unwrap_or_else(|refusal| refusal)
    }
}
