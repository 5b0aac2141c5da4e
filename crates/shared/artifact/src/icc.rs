//! What an ICC profile says of codes: the curve of each channel and how much each adds to luminance.

/// A profile of curves, as displays and cameras have.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Profile {
    pub(crate) curves: [Curve; 3],
    /// Luminance of each full channel; they add up to about 1.
    pub(crate) luma: [f64; 3],
}

/// From a code, 0–1, to linear light.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Curve {
    /// At even places from 0 to 1.
    Table(Vec<f64>),
    /// ICC's parametric curve, written as type 4: g a b c d e f.
    Parametric([f64; 7]),
}

impl Curve {
    pub(crate) fn light(&self, code: f64) -> f64 {
        match self {
            Self::Table(table) => {
                let place = code.clamp(0.0, 1.0) * (table.len() - 1) as f64;
                let at = (place as usize).min(table.len().saturating_sub(2));
                let next = (at + 1).min(table.len() - 1);
                table[at] + (place - at as f64) * (table[next] - table[at])
            }
            Self::Parametric([g, a, b, c, d, e, f]) => match code >= *d {
                true => (a * code + b).max(0.0).powf(*g) + e,
                false => c * code + f,
            },
        }
    }
}

/// Reads a profile; what it lacks is said.
pub(crate) fn parse(bytes: &[u8]) -> Result<Profile, &'static str> {
    let space = bytes.get(16..20).ok_or("is cut")?;
    match space {
        b"RGB " => {
            let curve = |name: &[u8]| tag(bytes, name).and_then(curve);
            let read = |names: [&[u8]; 3]| Some([curve(names[0])?, curve(names[1])?, curve(names[2])?]);
            let curves = read([b"rTRC", b"gTRC", b"bTRC"])
                .ok_or("has no curves that are known (it works by tables)")?;
            let bright = |name: &[u8]| fixed(tag(bytes, name)?, 12);
            let luma = [bright(b"rXYZ"), bright(b"gXYZ"), bright(b"bXYZ")];
            let [Some(r), Some(g), Some(b)] = luma else {
                return Err("does not say how bright its primaries are");
            };
            Ok(Profile { curves, luma: [r, g, b] })
        }
        b"GRAY" => {
            let gray = tag(bytes, b"kTRC").and_then(curve).ok_or("has no curve")?;
            Ok(Profile { curves: [gray.clone(), gray.clone(), gray], luma: [0.0, 1.0, 0.0] })
        }
        b"CMYK" => Err("is one for print (CMYK)"),
        _ => Err("is of a colour space that is not known"),
    }
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

/// A number of 16 bits before and after the point.
fn fixed(bytes: &[u8], at: usize) -> Option<f64> {
    Some(f64::from(word(bytes, at)? as i32) / 65536.0)
}

fn tag<'a>(bytes: &'a [u8], name: &[u8]) -> Option<&'a [u8]> {
    let count = word(bytes, 128)?.min(256) as usize;
    let entry = (0..count).map(|i| 132 + 12 * i).find(|&at| bytes.get(at..at + 4) == Some(name))?;
    let (at, size) = (word(bytes, entry + 4)? as usize, word(bytes, entry + 8)? as usize);
    bytes.get(at..at.checked_add(size)?)
}

fn curve(bytes: &[u8]) -> Option<Curve> {
    match bytes.get(..4)? {
        b"curv" => {
            let count = word(bytes, 8)? as usize;
            let entry = |i: usize| {
                Some(f64::from(u16::from_be_bytes(bytes.get(12 + 2 * i..14 + 2 * i)?.try_into().ok()?)))
            };
            match count {
                0 => Some(power(1.0)),
                1 => Some(power(entry(0)? / 256.0)),
                _ => {
                    Some(Curve::Table((0..count).map(|i| Some(entry(i)? / 65535.0)).collect::<Option<_>>()?))
                }
            }
        }
        b"para" => {
            let kind = u16::from_be_bytes(bytes.get(8..10)?.try_into().ok()?);
            let p = |i: usize| fixed(bytes, 12 + 4 * i);
            let g = p(0)?;
            Some(match kind {
                0 => power(g),
                1 => Curve::Parametric([g, p(1)?, p(2)?, 0.0, -p(2)? / p(1)?, 0.0, 0.0]),
                2 => Curve::Parametric([g, p(1)?, p(2)?, 0.0, -p(2)? / p(1)?, p(3)?, p(3)?]),
                3 => Curve::Parametric([g, p(1)?, p(2)?, p(3)?, p(4)?, 0.0, 0.0]),
                4 => Curve::Parametric([g, p(1)?, p(2)?, p(3)?, p(4)?, p(5)?, p(6)?]),
                _ => return None,
            })
        }
        _ => None,
    }
}

fn power(gamma: f64) -> Curve {
    Curve::Parametric([gamma, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A profile with given tags.
    fn profile(space: &[u8; 4], tags: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
        let mut bytes = vec![0; 128];
        bytes[16..20].copy_from_slice(space);
        bytes.extend((tags.len() as u32).to_be_bytes());
        let mut at = 132 + 12 * tags.len();
        for (name, data) in tags {
            bytes.extend(*name);
            bytes.extend((at as u32).to_be_bytes());
            bytes.extend((data.len() as u32).to_be_bytes());
            at += data.len();
        }
        tags.iter().for_each(|(_, data)| bytes.extend(data));
        bytes
    }

    fn para(kind: u16, numbers: &[f64]) -> Vec<u8> {
        let fixed = numbers.iter().flat_map(|x| ((x * 65536.0).round() as i32).to_be_bytes());
        [b"para\0\0\0\0".as_slice(), &kind.to_be_bytes(), &[0, 0]].concat().into_iter().chain(fixed).collect()
    }

    #[test]
    fn curves_become_light() {
        let srgb = para(3, &[2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045]);
        let gamma = [b"curv\0\0\0\0".as_slice(), &[0, 0, 0, 1, 2, 51]].concat();
        let table = [b"curv\0\0\0\0".as_slice(), &[0, 0, 0, 3, 0, 0, 64, 0, 255, 255]].concat();
        let xyz = |y: f64| {
            let y = ((y * 65536.0) as i32).to_be_bytes();
            [b"XYZ \0\0\0\0".as_slice(), &[0; 4], &y, &[0; 4]].concat()
        };
        let bytes = profile(
            b"RGB ",
            &[
                (b"rTRC", srgb),
                (b"gTRC", gamma),
                (b"bTRC", table),
                (b"rXYZ", xyz(0.25)),
                (b"gXYZ", xyz(0.6875)),
                (b"bXYZ", xyz(0.0625)),
            ],
        );
        let found = parse(&bytes).unwrap();
        assert_eq!(found.luma, [0.25, 0.6875, 0.0625]);
        let light = |channel: usize, code: f64| found.curves[channel].light(code);
        assert!((light(0, 0.5) - 0.21404).abs() < 1e-4 && (light(0, 0.02) - 0.02 / 12.92).abs() < 1e-4);
        assert!((light(1, 0.5) - 0.5f64.powf(2.0 + 51.0 / 256.0)).abs() < 1e-9);
        assert!((light(2, 0.25) - 0.5 * 16384.0 / 65535.0).abs() < 1e-9);
    }

    #[test]
    fn what_cannot_be_used_is_said() {
        assert!(parse(&profile(b"CMYK", &[])).unwrap_err().contains("CMYK"));
        assert!(parse(&profile(b"RGB ", &[])).unwrap_err().contains("tables"));
        assert!(parse(b"short").is_err());
    }
}
