//! Progress on standard error: a bar with the time left on a terminal, plain lines elsewhere.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

/// Time between plain lines.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// A progress report; it ends when dropped.
pub struct Progress {
    bar: ProgressBar,
    what: String,
    plain: Option<Plain>,
}

struct Plain {
    start: Instant,
    last: Instant,
}

impl Progress {
    #[allow(clippy::disallowed_methods, reason = "this is the only room with a clock")]
    pub(crate) fn start(what: &str, total: Option<u64>, quiet: bool) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let bar = match total {
            Some(total) => ProgressBar::new(total),
            None => ProgressBar::no_length(),
        };
        if quiet || !terminal {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        let template = match total {
            Some(_) => "{msg} {bar:30} {pos}/{len}, {per_sec}, {eta} left",
            None => "{msg} {spinner} {pos}, {per_sec}",
        };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.set_message(what.to_string());
        let now = Instant::now();
        let plain = (!quiet && !terminal).then_some(Plain { start: now, last: now });
        Self { bar, what: what.to_string(), plain }
    }

    /// Counts one step as done.
    pub fn step(&mut self) {
        self.bar.inc(1);
        let Some(plain) = &mut self.plain else { return };
        if plain.last.elapsed() < LINE_EVERY {
            return;
        }
        plain.last += plain.last.elapsed();
        let done = self.bar.position();
        let line = match self.bar.length() {
            Some(total) => {
                let left =
                    plain.start.elapsed().as_secs_f64() / done as f64 * total.saturating_sub(done) as f64;
                format!("{}: {done}/{total}, {left:.0} s left", self.what)
            }
            None => format!("{}: {done}", self.what),
        };
        // A closed standard error must not stop the work.
        let _ = writeln!(std::io::stderr(), "{line}");
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
