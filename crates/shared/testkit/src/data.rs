//! Recorded data, kept outside the repository.

use std::path::{Path, PathBuf};

/// A file or folder of the data folder (`$FURROW_DATA`, by default `shared/data` beside the repository); none, with a
/// line that says *skipped*, where it is absent: a test that needs it then ends.
#[must_use]
#[allow(
    clippy::disallowed_methods,
    clippy::print_stdout,
    reason = "a test asks where its data is, and says what it looked for in vain"
)]
pub fn data(name: &str) -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..");
    let folder =
        std::env::var_os("FURROW_DATA").map_or_else(|| root.join("../shared/data"), |data| root.join(data));
    let path = folder.join(name);
    match path.canonicalize() {
        Ok(path) => Some(path),
        Err(_) => {
            println!("skipped: {} absent", path.display());
            None
        }
    }
}
