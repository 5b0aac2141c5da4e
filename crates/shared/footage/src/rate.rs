//! Frame rates as fractions.

/// How far OpenCV's figure may be from a rate, relative: it writes 30000/1001 as 2997/100.
const TOLERANCE: f64 = 1e-5;

/// The fraction that a file's decimal number stands for: whole, over 2 (12.5), over 1001 (NTSC), or over 1000, in lowest
/// terms.
pub(crate) fn from_hz(hz: f64) -> Option<(u32, u32)> {
    if !(hz.is_finite() && hz > 0.0 && hz < 1e6) {
        return None;
    }
    let over = |seconds: u32| ((hz * f64::from(seconds)).round() as u32, seconds);
    let fits = |rate: &(u32, u32)| {
        rate.0 > 0 && (f64::from(rate.0) / f64::from(rate.1) - hz).abs() <= TOLERANCE * hz
    };
    [1, 2, 1001, 1000].into_iter().map(over).find(fits).map(lowest_terms)
}

fn lowest_terms((frames, seconds): (u32, u32)) -> (u32, u32) {
    let (mut a, mut b) = (frames, seconds);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    (frames / a, seconds / a)
}

#[cfg(test)]
mod tests {
    use super::from_hz;

    #[test]
    fn a_decimal_number_becomes_the_rate_it_stands_for() {
        let cases = [
            (25.0, (25, 1)),
            (12.5, (25, 2)),
            (29.97, (30000, 1001)),
            (23.976, (24000, 1001)),
            (119.88, (120_000, 1001)),
            (14.985, (15000, 1001)),
            (7.25, (29, 4)),
        ];
        for (hz, rate) in cases {
            assert_eq!(from_hz(hz), Some(rate), "{hz} Hz");
        }
        assert_eq!([0.0, -1.0, f64::NAN, f64::INFINITY].map(from_hz), [None; 4]);
    }
}
