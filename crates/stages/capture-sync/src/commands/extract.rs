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
        bit_depth: match &files.source {
            Source::Pictures(..) => camera.bit_depth,
            Source::Video(_) => 8,
        },
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
    use footage::{Frame, VideoReader};
    use rayon::prelude::*;

    /// Pictures that are written side by side.
    const BATCH: usize = 32;

    /// Writes the wanted frames as PNG. All frames before them are decoded, none is jumped over: seeking lands beside the
    /// frame that was asked for in many a file.
    pub(super) fn write(
        files: &FootageFiles,
        path: &Path,
        images: &str,
        wanted: &[(i64, i64)],
        out: &Path,
        progress: &mut Progress,
    ) -> anyhow::Result<()> {
        let mut reader =
            VideoReader::open(path).map_err(|error| anyhow!("camera {}: {error}", files.camera.id))?;
        let [width, height] = reader.image_size().map(|side| side as usize);
        for batch in wanted.chunks(BATCH) {
            let frames: Vec<(i64, Frame)> = batch
                .iter()
                .map(|&(number, index)| Ok((number, frame(&mut reader, files, path, index)?)))
                .collect::<anyhow::Result<_>>()?;
            frames.par_iter().try_for_each(|(number, frame)| {
                let to = out.join(artifact::image_path(images, *number));
                picture::write_rgb8(&to, width, height, &frame.rgb)?.publish()
            })?;
            batch.iter().for_each(|_| progress.step());
        }
        Ok(())
    }

    /// Goes on to a frame.
    fn frame(
        reader: &mut VideoReader,
        files: &FootageFiles,
        path: &Path,
        index: i64,
    ) -> anyhow::Result<Frame> {
        let fail = |error: footage::Error| anyhow!("camera {}: {error}", files.camera.id);
        while i64::try_from(reader.next_index()).is_ok_and(|position| position < index) {
            if reader.pass().transpose().map_err(fail)?.is_none() {
                break;
            }
        }
        match reader.next().transpose().map_err(fail)? {
            Some(frame) if frame.index as i64 == index => Ok(frame),
            _ => bail!(
                "{}: camera {} has no frame {index}\n  to do: run again; the file was changed meanwhile",
                path.display(),
                files.camera.id
            ),
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
            "{}: camera {}'s footage is a video, which this build cannot read\n  to do: build with the feature `video`",
            path.display(),
            files.camera.id
        )
    }
}
