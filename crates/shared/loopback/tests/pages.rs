//! The pages that are embedded are what their sources make.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests may")]

use std::path::Path;

#[test]
fn what_is_built_is_what_a_fresh_build_makes() {
    let web = Path::new(env!("CARGO_MANIFEST_DIR")).join("web");
    let Some(mut build) = testkit::node(&web.join("build.mjs"), false) else { return };
    let output = build.arg("--check").output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn sources_of_pages_have_sound_types() {
    let web = Path::new(env!("CARGO_MANIFEST_DIR")).join("web");
    let Some(mut check) = testkit::node(&web.join("node_modules/typescript/bin/tsc"), false) else { return };
    let output = check.args(["--noEmit", "--project", "tsconfig.json"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}
