//! OpenCV says nothing by itself: what matters becomes an error.

use std::sync::Once;

static ONCE: Once = Once::new();

pub(crate) fn silence() {
    ONCE.call_once(|| {
        // A library that stays talkative is no reason to fail.
        let _ = opencv::core::set_log_level(opencv::core::LogLevel::LOG_LEVEL_SILENT);
    });
}
