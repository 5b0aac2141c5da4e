//! Transfer functions: from stored values to linear light, by the names that manifests give them.

use std::fmt;
use std::str::FromStr;

/// How a camera stores light. Named `srgb`, `rec709`, `linear` or `gamma G`, e.g. `gamma 2.2`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Transfer {
    /// IEC 61966-2-1: most pictures of 8 bits.
    #[default]
    Srgb,
    /// Rec. ITU-R BT.709, the curve of a camera: most video.
    Rec709,
    /// Stored as it is.
    Linear,
    /// The power G of what is stored is linear.
    Gamma(f64),
}

/// A transfer function has a name that is not known.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the transfer function '{0}' is not known\n  to do: say srgb, rec709, linear or gamma G")]
pub struct UnknownTransfer(pub String);

/// No camera has a gamma beyond.
const GAMMAS: std::ops::RangeInclusive<f64> = 0.1..=10.0;

impl Transfer {
    /// The linear light of a stored value; both 0–1, white is 1.
    #[must_use]
    pub fn light(self, stored: f64) -> f64 {
        match self {
            Self::Srgb => segments(stored, 0.040_45, 12.92, 0.055, 2.4),
            Self::Rec709 => segments(stored, 0.081, 4.5, 0.099, 1.0 / 0.45),
            Self::Linear => stored,
            Self::Gamma(gamma) => stored.powf(gamma),
        }
    }

    /// The linear light of each code of 8 bits.
    #[must_use]
    pub fn light_of_codes(self) -> [f64; 256] {
        std::array::from_fn(|code| self.light(code as f64 / 255.0))
    }
}

/// A line up to `foot`, a power beyond.
fn segments(stored: f64, foot: f64, slope: f64, offset: f64, gamma: f64) -> f64 {
    match stored <= foot {
        true => stored / slope,
        false => ((stored + offset) / (1.0 + offset)).powf(gamma),
    }
}

impl FromStr for Transfer {
    type Err = UnknownTransfer;

    fn from_str(name: &str) -> Result<Self, UnknownTransfer> {
        let plain = name.trim().to_ascii_lowercase();
        match plain.as_str() {
            "srgb" => return Ok(Self::Srgb),
            "rec709" | "bt709" => return Ok(Self::Rec709),
            "linear" => return Ok(Self::Linear),
            _ => {}
        }
        let gamma = plain.strip_prefix("gamma").and_then(|rest| rest.trim().parse::<f64>().ok());
        match gamma.filter(|gamma| GAMMAS.contains(gamma)) {
            Some(gamma) => Ok(Self::Gamma(gamma)),
            None => Err(UnknownTransfer(name.to_string())),
        }
    }
}

impl fmt::Display for Transfer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Srgb => write!(f, "srgb"),
            Self::Rec709 => write!(f, "rec709"),
            Self::Linear => write!(f, "linear"),
            Self::Gamma(gamma) => write!(f, "gamma {gamma}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_become_the_light_of_the_standards() {
        for (name, mid) in
            [("sRGB", 0.215_861), ("linear", 0.501_961), ("gamma 2.2", 0.219_520), ("bt709", 0.261_482)]
        {
            let light = name.parse::<Transfer>().unwrap().light_of_codes();
            assert!((light[128] - mid).abs() < 1e-5, "{name} {}", light[128]);
            assert_eq!((light[0], light[255]), (0.0, 1.0), "{name}");
            assert!(light.is_sorted(), "{name}");
        }
    }

    #[test]
    fn names_are_read_back() {
        for transfer in [Transfer::Srgb, Transfer::Rec709, Transfer::Linear, Transfer::Gamma(2.4)] {
            assert_eq!(transfer.to_string().parse(), Ok(transfer));
        }
        for name in ["log-c", "gamma -1", "gamma", ""] {
            assert_eq!(name.parse::<Transfer>(), Err(UnknownTransfer(name.to_string())));
        }
    }
}
