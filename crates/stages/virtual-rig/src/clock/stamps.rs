//! Time stamps as cameras write them.

use super::Schedule;
use std::fmt::Write;

/// The stamps of all cameras as CSV with the columns `camera,index,time_s`, microseconds kept. It says what the cameras
/// believe, not what is true.
#[must_use]
pub fn time_stamps_csv(schedule: &Schedule) -> String {
    let mut text = String::from("camera,index,time_s\n");
    for (camera, entries) in &schedule.cameras {
        for entry in entries {
            // −0.000000 is 0.
            let stamp_s = (entry.stamp_s * 1e6).round() / 1e6 + 0.0;
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{},{},{stamp_s:.6}", quoted(camera), entry.index);
        }
    }
    text
}

fn quoted(id: &str) -> String {
    match id.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", id.replace('"', "\"\"")),
        false => id.to_string(),
    }
}
