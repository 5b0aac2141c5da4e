//! SMPTE time code: `HH:MM:SS:FF` counts every frame; `HH:MM:SS;FF` (drop-frame) leaves out labels so that 29.97 Hz keeps
//! to the clock on the wall.

use crate::Rate;

/// A time code as a number of frames since midnight.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Timecode {
    /// Frames since 00:00:00:00.
    pub frame: i64,
    /// Frames a second, rounded up: the number of labels in a second.
    labels: i64,
    is_drop: bool,
}

impl Timecode {
    /// Reads a label. Drop-frame labels exist at 30000/1001 and 60000/1001 Hz only; they leave out the first two (four) of
    /// every minute but each tenth.
    ///
    /// # Errors
    /// What is wrong with the label, in words: its form, a number out of range, a label that drop-frame leaves out, or a
    /// rate without drop-frame.
    pub fn parse(text: &str, rate: Rate) -> Result<Self, String> {
        let form = || format!("'{text}' is not a time code HH:MM:SS:FF, or HH:MM:SS;FF for drop-frame");
        let separators: Vec<char> = text.chars().filter(|c| !c.is_ascii_digit()).collect();
        let parts: Vec<i64> =
            text.split([':', ';']).map(str::parse).collect::<Result<_, _>>().map_err(|_| form())?;
        let ([hours, minutes, seconds, frames], [':', ':', last @ (':' | ';')]) =
            (&parts[..], &separators[..])
        else {
            return Err(form());
        };
        let labels = rate.hz().ceil() as i64;
        if *hours > 23 || *minutes > 59 || *seconds > 59 || *frames >= labels {
            return Err(format!(
                "'{text}' is out of range: there are 24 hours and, at {rate}, {labels} frames a second"
            ));
        }
        let is_drop = *last == ';';
        let left_out = left_out_per_minute(rate);
        if is_drop && left_out == 0 {
            return Err(format!(
                "'{text}' is drop-frame, which is for 30000/1001 and 60000/1001 Hz, not for {rate}"
            ));
        }
        if is_drop && *seconds == 0 && minutes % 10 != 0 && *frames < left_out {
            return Err(format!("'{text}' is one of the labels that drop-frame leaves out"));
        }
        let minutes = 60 * hours + minutes;
        let skipped = if is_drop { left_out * (minutes - minutes / 10) } else { 0 };
        Ok(Self { frame: (60 * minutes + seconds) * labels + frames - skipped, labels, is_drop })
    }

    /// The time code so many frames later; it starts again at midnight.
    #[must_use]
    pub fn plus(self, frames: i64) -> Self {
        let minutes = 24 * 60;
        let skipped = if self.is_drop { self.left_out() * (minutes - minutes / 10) } else { 0 };
        let day = 60 * minutes * self.labels - skipped;
        Self { frame: (self.frame + frames).rem_euclid(day), ..self }
    }

    fn left_out(self) -> i64 {
        self.labels / 15
    }
}

/// Two at 29.97 Hz, four at 59.94 Hz, none elsewhere.
fn left_out_per_minute(rate: Rate) -> i64 {
    [(30, 2), (60, 4)]
        .into_iter()
        .find(|(labels, _)| u64::from(rate.frames) * 1001 == labels * 1000 * u64::from(rate.seconds))
        .map_or(0, |(_, left_out)| left_out)
}

impl std::fmt::Display for Timecode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut label = self.frame;
        if self.is_drop {
            let (per_minute, left_out) = (60 * self.labels - self.left_out(), self.left_out());
            let per_ten = 10 * per_minute + left_out;
            let (tens, rest) = (label.div_euclid(per_ten), label.rem_euclid(per_ten));
            // The first minute of ten leaves nothing out.
            let skipped =
                if rest < 60 * self.labels { 0 } else { 1 + (rest - 60 * self.labels) / per_minute };
            label += left_out * (9 * tens + skipped);
        }
        let (seconds, frames) = (label / self.labels, label % self.labels);
        let mark = if self.is_drop { ';' } else { ':' };
        write!(f, "{:02}:{:02}:{:02}{mark}{frames:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)
    }
}

#[cfg(test)]
mod tests {
    use super::Timecode;
    use crate::Rate;

    const NTSC: Rate = Rate { frames: 30_000, seconds: 1001 };

    /// The table of SMPTE ST 12-1: drop-frame is 17 982 frames in ten minutes, 2 589 408 in a day.
    #[test]
    fn drop_frame_leaves_out_labels_and_no_frames() {
        for (label, frame) in [
            ("00:00:59;29", 1799),
            ("00:01:00;02", 1800),
            ("00:09:59;29", 17_981),
            ("00:10:00;00", 17_982),
            ("01:00:00;00", 107_892),
            ("23:59:59;29", 2_589_407),
        ] {
            let code = Timecode::parse(label, NTSC).unwrap();
            assert_eq!((code.frame, code.to_string()), (frame, label.to_string()));
        }
        let last = Timecode::parse("23:59:59;29", NTSC).unwrap();
        assert_eq!(last.plus(1).to_string(), "00:00:00;00");
    }

    #[test]
    fn every_frame_of_a_day_has_a_label_of_its_own() {
        for (rate, days) in [(NTSC, 2_589_408), (Rate::per_second(25), 2_160_000)] {
            let start = if rate == NTSC { "00:00:00;00" } else { "00:00:00:00" };
            let start = Timecode::parse(start, rate).unwrap();
            for frame in (0..days).step_by(17) {
                let code = start.plus(frame);
                assert_eq!(Timecode::parse(&code.to_string(), rate).unwrap(), code);
            }
        }
    }

    #[test]
    fn labels_that_do_not_exist_are_refused() {
        let refused = |label: &str, rate| Timecode::parse(label, rate).unwrap_err();
        assert!(refused("00:01:00;00", NTSC).contains("leaves out"));
        assert!(refused("00:01:00;02", Rate::per_second(25)).contains("not for 25 Hz"));
        assert!(refused("00:00:00:25", Rate::per_second(25)).contains("out of range"));
        for label in ["", "1", "00:00:00", "00:00;00:00", "aa:00:00:00", "00:00:00:00:00"] {
            assert!(refused(label, NTSC).contains("is not a time code"), "{label}");
        }
    }
}
