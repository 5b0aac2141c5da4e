//! The images of a take, named by mocap frame.

use super::footage_files::{FootageFiles, Source, picture_path};
use anyhow::{anyhow, bail};
use artifact::{CameraFrames, FrameRun, SyncFrame};
use stage::{Progress, Run};
use std::path::Path;

/// The images of a camera that frames show: frame and index, by rising frame.
fn wanted(id: &str, frames: &[SyncFrame]) -> Vec<(i64, i64)> {
    let image = |frame: &SyncFrame| Some((frame.frame, frame.shows.get(id).copied()??.index));
    frames.iter().filter_map(image).collect()
}

/// Writes a camera's images below `out` and says where they are. Pictures keep their bytes; frames of a video become PNG.
pub(super) fn extract(
    run: &Run,
    files: &FootageFiles,
    frames: &[SyncFrame],
    out: &Path,
) -> anyhow::Result<CameraFrames> {
    let camera = &files.camera;
    let wanted = wanted(&camera.id, frames);
    let ending = match &files.source {
        Source::Pictures(pattern, _) => pattern
            .extension()
            .map_or_else(|| "png".to_string(), |ending| ending.to_string_lossy().to_ascii_lowercase()),
        Source::Video(_) => "png".to_string(),
    };
    let images = format!("{}/{{frame:06}}.{ending}", camera.id);
    let mut progress = run.progress(&format!("images of {}", camera.id), Some(wanted.len() as u64));
    match &files.source {
        Source::Pictures(pattern, _) => link(pattern, &images, &wanted, out, &mut progress)?,
        Source::Video(path) => video::write(files, path, &images, &wanted, out, &mut progress)?,
    }
    Ok(CameraFrames {
        images,
        image_size: camera.image_size,
        transfer: camera.transfer.clone(),
        bit_depth: camera.bit_depth,
        frames: FrameRun::runs(&wanted.iter().map(|(frame, _)| *frame).collect::<Vec<_>>()),
    })
}

fn link(
    pattern: &Path,
    images: &str,
    wanted: &[(i64, i64)],
    out: &Path,
    progress: &mut Progress,
) -> anyhow::Result<()> {
    for &(frame, index) in wanted {
        let to = out.join(artifact::image_path(images, frame));
        let from = picture_path(pattern, index);
        if to.exists() && !is_within(&to, out) {
            bail!("{}: lies outside the output folder\n  to do: choose another --out", to.display());
        }
        if same_place(&from, &to) {
            bail!("{}: would be written over the footage\n  to do: choose another --out", to.display());
        }
        artifact::stage_link(&to, &from).map_err(|error| anyhow!(error))?.publish()?;
        progress.step();
    }
    Ok(())
}

fn is_within(path: &Path, folder: &Path) -> bool {
    match (path.canonicalize(), folder.canonicalize()) {
        (Ok(path), Ok(folder)) => path.starts_with(folder),
        _ => false,
    }
}

/// Whether both name one file; a link made by an earlier run is another name, and may be replaced.
fn same_place(a: &Path, b: &Path) -> bool {
    let place = |path: &Path| Some(path.parent()?.canonicalize().ok()?.join(path.file_name()?));
    place(a).is_some_and(|a| place(b) == Some(a))
}

#[cfg(feature = "video")]
mod video {
    use super::{FootageFiles, Path, Progress, anyhow};
    use anyhow::bail;
    use artifact::picture;
    use footage::VideoReader;

    pub(super) fn write(
        files: &FootageFiles,
        path: &Path,
        images: &str,
        wanted: &[(i64, i64)],
        out: &Path,
        progress: &mut Progress,
    ) -> anyhow::Result<()> {
        let fail = |error: footage::Error| anyhow!("camera {}: {error}", files.camera.id);
        let reader = VideoReader::open(path).map_err(fail)?;
        let [width, height] = reader.image_size().map(|side| side as usize);
        let mut wanted = wanted.iter().copied().peekable();
        for frame in reader {
            // What follows the last wanted frame need not be decodable.
            if wanted.peek().is_none() {
                break;
            }
            let frame = frame.map_err(fail)?;
            while let Some((number, _)) = wanted.next_if(|(_, index)| *index == frame.index as i64) {
                let to = out.join(artifact::image_path(images, number));
                picture::write_rgb8(&to, width, height, &frame.rgb)?.publish()?;
                progress.step();
            }
        }
        match wanted.next() {
            Some((_, index)) => bail!(
                "{}: camera {} has no frame {index}\n  to do: copy the file again; it may have been cut",
                path.display(),
                files.camera.id
            ),
            None => Ok(()),
        }
    }
}

#[cfg(not(feature = "video"))]
mod video {
    use super::{FootageFiles, Path, Progress};
    use anyhow::bail;

    pub(super) fn write(
        files: &FootageFiles,
        path: &Path,
        _images: &str,
        _wanted: &[(i64, i64)],
        _out: &Path,
        _progress: &mut Progress,
    ) -> anyhow::Result<()> {
        bail!(
            "{}: camera {}'s footage is a video, which this build cannot read",
            path.display(),
            files.camera.id
        )
    }
}
