//! The folder that images are written to: neither footage nor another run's images may be in their way.

use anyhow::bail;
use artifact::{Frames, Take, provenance};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The folder that images are written to.
pub(super) struct OutputFolder {
    /// Images of an earlier run, which its list of images names.
    stale: Vec<PathBuf>,
    /// The cameras' folders that they lie in.
    folders: BTreeSet<PathBuf>,
}

/// Files that stand beside the cameras' folders.
const FILES: [&str; 2] = ["sync.jsonl", "frames.json"];

impl OutputFolder {
    /// Looks whether the images of these cameras can go there; nothing is changed yet.
    pub(super) fn check(
        folder: &Path,
        take_path: &Path,
        take: &Take,
        cameras: &[&str],
    ) -> anyhow::Result<Self> {
        check_ids(take_path, cameras)?;
        check_footage(folder, take_path, take)?;
        let list = folder.join("frames.json");
        let named = if is_ours(&list) { artifact::read_document::<Frames>(&list).ok() } else { None };
        let mut found = Self { stale: Vec::new(), folders: BTreeSet::new() };
        if !folder.is_dir() {
            return Ok(found);
        }
        for camera in artifact::subfolders(folder)? {
            let place = folder.join(&camera);
            for name in artifact::files(&place)?.into_iter().filter(|name| is_picture(name)) {
                if !named.as_ref().is_some_and(|frames| names(frames, &camera, &name)) {
                    bail!(
                        "{}: holds a picture that no frames.json of capture-sync names: {name}; it is of a run that did not end, or \
                         of something else\n  to do: name another --out, or remove that folder",
                        place.display()
                    );
                }
                found.stale.push(place.join(name));
            }
            found.folders.insert(place);
        }
        Ok(found)
    }

    /// Removes the images of the earlier run.
    pub(super) fn clear(self) -> artifact::Result<()> {
        self.stale.iter().try_for_each(|path| artifact::withdraw(path))?;
        // One that holds something else stays.
        self.folders.iter().for_each(|folder| drop(std::fs::remove_dir(folder)));
        Ok(())
    }
}

/// Tries whether the folder can be made and written to; leaves nothing.
pub(super) fn check_writable(folder: &Path) -> anyhow::Result<()> {
    let exists = |place: &&Path| place.as_os_str().is_empty() || place.exists();
    let there = folder.ancestors().find(exists).unwrap_or(Path::new("."));
    let there = if there.as_os_str().is_empty() { Path::new(".") } else { there };
    if !there.is_dir() {
        bail!("{}: is not a folder\n  to do: choose another --out", there.display());
    }
    match artifact::Sink::create(&there.join("capture-sync")) {
        Ok(sink) => drop(sink),
        Err(_) if there.join("capture-sync").exists() => {}
        Err(error) => bail!(
            "{}: cannot be written to: {}\n  to do: choose another --out, or its permissions",
            folder.display(),
            error.what
        ),
    }
    Ok(())
}

fn check_ids(take: &Path, cameras: &[&str]) -> anyhow::Result<()> {
    for (i, id) in cameras.iter().enumerate() {
        let is_file = |file: &&&str| {
            id.eq_ignore_ascii_case(file) || id.eq_ignore_ascii_case(&format!("{file}.prov.json"))
        };
        if let Some(file) = FILES.iter().find(is_file) {
            bail!(
                "{}: camera {id}: its images' folder would have the name of a file, {file}\n  to do: give the camera another id",
                take.display()
            );
        }
        if let Some(other) = cameras[..i].iter().find(|other| id.eq_ignore_ascii_case(other)) {
            bail!(
                "{}: cameras {other} and {id}: some disks take their folders for one\n  to do: give one of them another id",
                take.display()
            );
        }
    }
    Ok(())
}

/// Refuses a folder whose cameras' folders hold footage, of whichever camera.
fn check_footage(folder: &Path, take_path: &Path, take: &Take) -> anyhow::Result<()> {
    let Ok(folder_there) = folder.canonicalize() else { return Ok(()) };
    let inside: Vec<PathBuf> = artifact::subfolders(folder)?
        .iter()
        .filter_map(|camera| folder_there.join(camera).canonicalize().ok())
        .collect();
    let base = take_path.parent().unwrap_or(Path::new("."));
    for camera in &take.cameras {
        let Some(footage) = &camera.footage else { continue };
        let Some(file) = footage.images.as_ref().or(footage.file.as_ref()) else { continue };
        let place = base.join(file);
        let place = place.parent().and_then(|place| place.canonicalize().ok());
        if place.is_some_and(|place| inside.contains(&place)) {
            bail!(
                "{}: images would be written over the footage of camera {}, or among it\n  to do: choose another --out",
                folder.display(),
                camera.id
            );
        }
    }
    Ok(())
}

/// Whether this stage wrote a list of images.
fn is_ours(list: &Path) -> bool {
    let text = artifact::read_text(&provenance::path_beside(list)).ok();
    let side_car: Option<serde_json::Value> = text.and_then(|text| serde_json::from_str(&text).ok());
    side_car.is_some_and(|value| {
        value["data"]["stage"].as_str().is_some_and(|name| name.starts_with("capture-sync"))
    })
}

fn is_picture(name: &str) -> bool {
    let ending = Path::new(name).extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    ending.is_some_and(|ending| matches!(&ending[..], "png" | "jpg" | "jpeg"))
}

/// Whether a list of images names a picture of a camera's folder.
fn names(frames: &Frames, camera: &str, name: &str) -> bool {
    let number = name.split('.').next().and_then(|digits| digits.parse().ok());
    let images = frames.cameras.get(camera);
    let path = number.and_then(|number| images?.image(number));
    path.is_some_and(|path| path == format!("{camera}/{name}"))
}
