//! Where the images go: PNG pictures, or one video per camera.

use anyhow::bail;
use artifact::{Footage, FrameRange, Rate, Staged, picture};
use serde::Serialize;
use std::path::{Path, PathBuf};
use virtual_rig::clock::Schedule;
use virtual_rig::take::{Role, Shot, Station, Studio};

/// How a video's frames are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Video {
    /// Lossless, .avi
    Ffv1,
    /// Lossy, .mp4
    H264,
    /// Lossy, .avi
    Mjpg,
}

impl Video {
    /// Refuses what this build cannot do.
    pub(super) fn check(self) -> anyhow::Result<()> {
        match cfg!(feature = "video") {
            true => Ok(()),
            false => bail!(
                "--video: this build cannot write video\n  to do: build it with --features video (needs OpenCV), or \
                 leave --video out for PNG sequences"
            ),
        }
    }

    fn ending(self) -> &'static str {
        match self {
            Self::Ffv1 | Self::Mjpg => "avi",
            Self::H264 => "mp4",
        }
    }
}

/// Images a second that a camera films.
pub(super) fn camera_rate(studio: &Studio, station: &Station) -> Rate {
    let extent = &studio.scenario().extent;
    let every = match station.role {
        Role::Mocap => 1,
        Role::Wrinkle => extent.wrinkle_every,
    };
    Rate { frames: extent.rate.frames, seconds: extent.rate.seconds * every }
}

/// A camera's footage, as the manifest names it.
pub(super) fn entry(video: Option<Video>, camera: &str) -> Footage {
    Footage {
        file: video.map(|video| format!("footage/{camera}.{}", video.ending())),
        images: video.is_none().then(|| format!("footage/{camera}/{{frame:06}}.png")),
        first: 0,
        timestamps: Some(format!("footage/{camera}.csv")),
    }
}

/// Takes the cameras' images, each camera's in their order.
pub(super) enum FootageSink {
    /// Numbered pictures in a folder of each camera; in the folder of the take.
    Pictures(PathBuf),
    /// A video of each camera.
    #[cfg(feature = "video")]
    Videos(videos::Videos),
}

impl FootageSink {
    /// Makes nothing on the disk yet, but refuses what could not be written.
    pub(super) fn new(
        video: Option<Video>,
        studio: &Studio,
        schedule: &Schedule,
        frames: FrameRange,
        out: &Path,
    ) -> anyhow::Result<Self> {
        let Some(video) = video else { return Ok(Self::Pictures(out.join("take"))) };
        video.check()?;
        check_start(studio, schedule, frames)?;
        #[cfg(feature = "video")]
        return Ok(Self::Videos(videos::Videos::new(video, studio, out)?));
        #[cfg(not(feature = "video"))]
        return Ok(Self::Pictures(out.join("take")));
    }

    /// Takes an image: rows of red, green, blue.
    pub(super) fn write(&mut self, shot: &Shot, station: &Station, rgb: &[u8]) -> anyhow::Result<()> {
        match self {
            Self::Pictures(folder) => {
                let [width, height] = station.camera.image_size.map(|side| side as usize);
                for index in shot.entry.index..shot.entry.index + shot.copies {
                    let path = folder.join(format!("footage/{}/{index:06}.png", shot.camera));
                    picture::write_rgb8(&path, width, height, rgb)?.publish()?;
                }
                Ok(())
            }
            #[cfg(feature = "video")]
            Self::Videos(videos) => videos.write(shot, rgb),
        }
    }

    /// Ends the videos; they are yet to be published.
    pub(super) fn finish(self) -> anyhow::Result<Vec<Staged>> {
        match self {
            Self::Pictures(_) => Ok(Vec::new()),
            #[cfg(feature = "video")]
            Self::Videos(videos) => videos.finish(),
        }
    }
}

/// A picture keeps its number in its name; in a video the first one is always number 0.
fn check_start(studio: &Studio, schedule: &Schedule, frames: FrameRange) -> anyhow::Result<()> {
    let is_in = |entry: &virtual_rig::clock::Entry| frames.contains(studio.filmed_with(entry.mocap_frame));
    for (camera, entries) in &schedule.cameras {
        if entries.iter().any(is_in) && !entries.first().is_some_and(is_in) {
            bail!(
                "--frames {frames}: leaves out the first image of camera {camera}, but a video counts its frames from there\n  \
                 to do: start with the take's first frame, or leave --video out: PNG pictures keep their numbers"
            );
        }
    }
    Ok(())
}

#[cfg(feature = "video")]
mod videos {
    use super::{Video, camera_rate, entry};
    use ::footage::{Codec, Error, VideoWriter};
    use anyhow::anyhow;
    use artifact::Staged;
    use std::collections::BTreeMap;
    use std::path::{Path, PathBuf};
    use virtual_rig::take::{Shot, Studio};

    /// The videos of a take.
    pub(in super::super) struct Videos {
        codec: Codec,
        cameras: BTreeMap<String, Plan>,
        begun: BTreeMap<String, (Staged, VideoWriter)>,
    }

    struct Plan {
        path: PathBuf,
        image_size: [u32; 2],
        rate: (u32, u32),
    }

    impl Videos {
        pub(super) fn new(video: Video, studio: &Studio, out: &Path) -> anyhow::Result<Self> {
            let codec = match video {
                Video::Ffv1 => Codec::Ffv1,
                Video::H264 => Codec::H264,
                Video::Mjpg => Codec::Mjpg,
            };
            let mut cameras = BTreeMap::new();
            for (id, station) in studio.stations() {
                let rate = camera_rate(studio, station);
                let plan = Plan {
                    path: out.join("take").join(entry(Some(video), id).file.unwrap_or_default()),
                    image_size: station.camera.image_size,
                    rate: (rate.frames, rate.seconds),
                };
                VideoWriter::check(&plan.path, codec, plan.image_size, plan.rate).map_err(
                    |error| match error {
                        Error::Size { .. } => anyhow!("{error}, or choose another --image-scale"),
                        other => other.into(),
                    },
                )?;
                cameras.insert(id.clone(), plan);
            }
            Ok(Self { codec, cameras, begun: BTreeMap::new() })
        }

        pub(super) fn write(&mut self, shot: &Shot, rgb: &[u8]) -> anyhow::Result<()> {
            let plan = &self.cameras[&shot.camera];
            if !self.begun.contains_key(&shot.camera) {
                self.begun.insert(shot.camera.clone(), plan.begin(self.codec)?);
            }
            if let Some((_, writer)) = self.begun.get_mut(&shot.camera) {
                for _ in 0..shot.copies {
                    writer.write(rgb).map_err(|error| error.in_file(&plan.path))?;
                }
            }
            Ok(())
        }

        pub(super) fn finish(self) -> anyhow::Result<Vec<Staged>> {
            let end = |(staged, writer): (Staged, VideoWriter)| {
                writer.finish().map_err(|error| error.in_file(staged.path()))?;
                Ok(staged)
            };
            self.begun.into_values().map(end).collect()
        }
    }

    impl Plan {
        fn begin(&self, codec: Codec) -> anyhow::Result<(Staged, VideoWriter)> {
            let staged = Staged::reserve(&self.path)?;
            let temporary = staged.temporary().unwrap_or(&self.path);
            let writer = VideoWriter::create(temporary, codec, self.image_size, self.rate)
                .map_err(|error| error.in_file(&self.path))?;
            Ok((staged, writer))
        }
    }
}
