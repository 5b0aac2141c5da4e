//! Time stamps as cameras write them.

use super::Schedule;
use std::fmt::Write;

/// The stamps of each camera as CSV with the columns `index,time_s`, microseconds kept. They say what the cameras believe,
/// not what is true.
pub fn time_stamps_csv(schedule: &Schedule) -> impl Iterator<Item = (&str, String)> {
    schedule.cameras.iter().map(|(camera, entries)| {
        let mut text = String::from("index,time_s\n");
        for entry in entries {
            // −0.000000 is 0.
            let stamp_s = (entry.stamp_s * 1e6).round() / 1e6 + 0.0;
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{},{stamp_s:.6}", entry.index);
        }
        (camera.as_str(), text)
    })
}
