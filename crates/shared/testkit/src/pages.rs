//! What the tests of pages run on: Node, a Chromium, and the packages of `crates/shared/loopback/web`.

use std::path::{Path, PathBuf};
use std::process::Command;

/// A command that runs a script with Node, in a folder where the packages of pages are installed; none, with a line that says *skipped*
/// and why, where Node, the packages or (if `in_browser`) a Chromium are absent. `$FURROW_BROWSER` names another browser.
#[must_use]
#[allow(
    clippy::disallowed_methods,
    clippy::print_stdout,
    reason = "a test asks where its tools are, and says what it looked for in vain"
)]
pub fn node(script: &Path, in_browser: bool) -> Option<Command> {
    let web = Path::new(env!("CARGO_MANIFEST_DIR")).join("../loopback/web");
    let lacks = |what: &str| {
        println!("skipped: {what}");
        None
    };
    if !Command::new("node").arg("--version").output().is_ok_and(|output| output.status.success()) {
        return lacks("there is no node");
    }
    if !web.join("node_modules/esbuild").is_dir() {
        return lacks("the packages of pages are not installed; run: just web");
    }
    if in_browser && browser().is_none() {
        return lacks("there is no Chromium; install chromium-headless-shell, or name one in FURROW_BROWSER");
    }
    let mut command = Command::new("node");
    command.current_dir(web).arg(script);
    Some(command)
}

/// The places where `test/browser.mjs` looks.
const PLACES: [&str; 3] =
    ["/usr/bin/chromium-headless-shell", "/usr/bin/chromium", "/usr/bin/chromium-browser"];

#[allow(clippy::disallowed_methods, reason = "a test asks where its tools are")]
fn browser() -> Option<PathBuf> {
    let named = std::env::var_os("FURROW_BROWSER").map(PathBuf::from);
    let places = PLACES.iter().map(PathBuf::from);
    named.into_iter().chain(places).find(|place| place.exists())
}
