//! From stored 8-bit values to linear light.

use crate::Error;

/// Linear light of the 256 codes of a transfer function, by the name that manifests give it: `srgb`, `rec709`, `linear` or
/// `gamma G`. White is 1.
///
/// # Errors
/// [`Error::Transfer`] for any other name.
pub fn linear_light(transfer: &str) -> Result<[f32; 256], Error> {
    let decode: Box<dyn Fn(f64) -> f64> = match transfer.trim().to_ascii_lowercase().as_str() {
        "srgb" => Box::new(|code| segments(code, 0.040_45, 12.92, 0.055, 2.4)),
        "rec709" | "bt709" => Box::new(|code| segments(code, 0.081, 4.5, 0.099, 1.0 / 0.45)),
        "linear" => Box::new(|code| code),
        other => {
            let gamma = other.strip_prefix("gamma").and_then(|rest| rest.trim().parse::<f64>().ok());
            match gamma.filter(|gamma| (0.1..=10.0).contains(gamma)) {
                Some(gamma) => Box::new(move |code: f64| code.powf(gamma)),
                None => return Err(Error::Transfer(transfer.to_string())),
            }
        }
    };
    Ok(std::array::from_fn(|code| decode(code as f64 / 255.0) as f32))
}

/// A line up to `foot`, a power beyond.
fn segments(code: f64, foot: f64, slope: f64, offset: f64, gamma: f64) -> f64 {
    match code <= foot {
        true => code / slope,
        false => ((code + offset) / (1.0 + offset)).powf(gamma),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_manifests_are_known() {
        for (name, mid) in [("srgb", 0.2158), ("linear", 0.502), ("gamma 2.2", 0.2195), ("rec709", 0.2615)] {
            let light = linear_light(name).unwrap();
            assert!((f64::from(light[128]) - mid).abs() < 2e-3, "{name} {}", light[128]);
            assert_eq!((light[0], light[255]), (0.0, 1.0), "{name}");
        }
        assert!(linear_light("log-c").is_err());
        assert!(linear_light("gamma -1").is_err());
    }
}
