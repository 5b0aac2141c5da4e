//! The markers and the take that they belong to.

use anyhow::bail;
use artifact::{Trajectories, Trajectories3d, Unit};
use stage::Run;
use std::path::Path;

/// Reads the markers, with the frame rate and the reference of the take where the file has none.
pub(crate) fn read(
    run: &mut Run,
    markers: &Path,
    unit: Option<Unit>,
    take: Option<&Path>,
) -> anyhow::Result<Trajectories> {
    let mut trajectories = run.markers::<Trajectories3d>(markers, unit)?;
    run.input("markers", markers)?;
    let Some(path) = take else { return Ok(trajectories) };
    let (manifest, reference) = stage::load_take(run, path)?;
    let header = &mut trajectories.header;
    if let Some(stated) = header.take.as_ref().filter(|stated| stated.sha256 != reference.sha256) {
        bail!(
            "{}: was made from {stated}, not from {reference}\n  to do: give that take's manifest",
            markers.display()
        );
    }
    if let Some(rate) = header.rate.filter(|rate| (rate.hz() / manifest.rate.hz() - 1.0).abs() > 1e-6) {
        bail!(
            "{}: has {rate}, but {} says {}\n  to do: find out which is right",
            markers.display(),
            path.display(),
            manifest.rate
        );
    }
    header.rate = header.rate.or(Some(manifest.rate));
    header.take = Some(reference);
    Ok(trajectories)
}
