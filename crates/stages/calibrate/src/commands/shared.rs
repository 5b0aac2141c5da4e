//! What the subcommands share.

use artifact::FrameReader;
use calibrate::{BoardCorners, Corners, LensModel, Report, Robust};
use clap::ValueEnum;
use stage::Run;
use std::path::Path;

/// Which distortion a lens has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Lens {
    /// No distortion
    Pinhole,
    /// k1
    Radial1,
    /// k1, k2
    Radial2,
    /// k1, k2, p1, p2
    Tangential,
    /// k1, k2, p1, p2, k3
    Full,
}

impl From<Lens> for LensModel {
    fn from(lens: Lens) -> Self {
        match lens {
            Lens::Pinhole => Self::Pinhole,
            Lens::Radial1 => Self::Radial1,
            Lens::Radial2 => Self::Radial2,
            Lens::Tangential => Self::Tangential,
            Lens::Full => Self::Full,
        }
    }
}

/// How residuals are weighed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Loss {
    /// All alike
    Squares,
    /// Large ones by their length
    Huber,
    /// Large ones hardly at all
    Cauchy,
}

impl From<Loss> for Robust {
    fn from(loss: Loss) -> Self {
        match loss {
            Loss::Squares => Self::Squares,
            Loss::Huber => Self::Huber,
            Loss::Cauchy => Self::Cauchy,
        }
    }
}

/// Reads found corners.
pub(crate) fn read_corners(run: &mut Run, path: &Path) -> anyhow::Result<Corners> {
    let reader = FrameReader::<BoardCorners>::open(path)?;
    let header = reader.header().clone();
    let frames = reader.collect::<artifact::Result<Vec<_>>>()?;
    run.input("corners", path)?;
    Ok(Corners { header, frames })
}

/// An error of the method, said of the file that it concerns.
pub(crate) fn of_file(path: &Path, error: &calibrate::Error) -> anyhow::Error {
    anyhow::anyhow!("{}: {error}", path.display())
}

/// Says per camera how good the calibration is; refuses one in which a camera fits with nothing.
pub(crate) fn tell(run: &mut Run, report: &Report) -> anyhow::Result<()> {
    if let Some((id, camera)) = report.misfit() {
        anyhow::bail!(
            "camera {id}: what it sees fits with no other camera: median error {:.1} px, {} outliers among {} points\n  to do: look \
             whether its images are mirrored, show another board or were taken at other times; or leave the camera out",
            camera.median_px,
            camera.outliers,
            camera.corners
        );
    }
    for (id, camera) in &report.cameras {
        if camera.corners == 0 {
            run.say(&format!("  {id}: no points; it stays as it was"));
            continue;
        }
        if camera.coverage < LITTLE_COVERED {
            let share = 100.0 * camera.coverage;
            run.warn(format!(
                "camera {id}: points lie in {share:.0} % of its image's cells; where none was, the lens is a guess"
            ));
        }
        run.say(&format!(
            "  {id}: rms {:.3} px, median {:.3} px, {} images, {} points ({} outliers), in {:.0} % of the image's cells",
            camera.rms_px,
            camera.median_px,
            camera.views,
            camera.corners,
            camera.outliers,
            100.0 * camera.coverage
        ));
    }
    if !report.converged {
        run.warn("the adjustment had not come to an end after its last step");
    }
    run.result("rms_px", report.rms_px);
    run.result("outliers", report.outliers);
    run.result("report", serde_json::to_value(report)?);
    Ok(())
}

/// Share of the image under which a camera's corners are too few places to tell a lens from.
const LITTLE_COVERED: f64 = 0.25;
