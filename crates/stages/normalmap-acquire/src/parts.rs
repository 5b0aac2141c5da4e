//! Parts of a face that are no skin, by the numbers of well-known sets of landmarks.

/// A part: a closed line of landmark ids, and how far its border is pushed out, io.
pub type Part = (Vec<String>, f64);

/// MediaPipe's face mesh, 468 or 478 points, 0-based.
const MESH: [(&[u16], f64); 5] = [
    (&[61, 185, 40, 39, 37, 0, 267, 269, 270, 409, 291, 375, 321, 405, 314, 17, 84, 181, 91, 146], 0.03),
    (&[33, 246, 161, 160, 159, 158, 157, 173, 133, 155, 154, 153, 145, 144, 163, 7], 0.09),
    (&[263, 466, 388, 387, 386, 385, 384, 398, 362, 382, 381, 380, 374, 373, 390, 249], 0.09),
    (&[70, 63, 105, 66, 107, 55, 65, 52, 53, 46], 0.03),
    (&[300, 293, 334, 296, 336, 285, 295, 282, 283, 276], 0.03),
];
/// Its nostrils, and the tip of the nose, whose highlight wanders as the lips pull at it.
const MESH_NOSTRILS: (&[u16], f64) =
    (&[98, 97, 2, 326, 327, 294, 278, 344, 1, 115, 48, 64, 4, 5, 45, 275], 0.03);
/// Its inner line of the lips: an open mouth tears it from the outer one.
const MESH_INNER_LIPS: [u16; 20] =
    [78, 191, 80, 81, 82, 13, 312, 311, 310, 415, 308, 324, 318, 402, 317, 14, 87, 178, 88, 95];
/// The irises look about.
const MESH_IRISES: std::ops::Range<u16> = 468..478;

/// ibug's 68 points, 1-based as in its files.
const IBUG: [(&[u16], f64); 5] = [
    (&[49, 50, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60], 0.03),
    (&[37, 38, 39, 40, 41, 42], 0.09),
    (&[43, 44, 45, 46, 47, 48], 0.09),
    (&[18, 19, 20, 21, 22], 0.06),
    (&[23, 24, 25, 26, 27], 0.06),
];

/// Names of landmarks around parts, before a number: `eye_l_01` … is a line around the subject's left eye.
const NAMED: [(&str, f64); 6] = [
    ("lips_", 0.03),
    ("eye_l_", 0.09),
    ("eye_r_", 0.09),
    ("brow_edge_l_", 0.02),
    ("brow_edge_r_", 0.02),
    ("nostrils_", 0.03),
];
/// Those of the opening of the mouth, which tears from the skin around.
const NAMED_MOUTH: &str = "mouth_in_";

/// What is known of a set of landmarks.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scheme {
    /// Its name.
    pub name: Option<&'static str>,
    /// Parts that are no skin.
    pub parts: Vec<Part>,
    /// Landmarks that move without the skin around them.
    pub loose: Vec<String>,
    /// The pupils; where there is none, the corners of each eye.
    pub eyes: [Vec<String>; 2],
}

fn names(ids: &[u16]) -> Vec<String> {
    ids.iter().map(u16::to_string).collect()
}

impl Scheme {
    /// The scheme of a set of ids: MediaPipe's mesh (`0` … `467`, `477`), ibug's (`1` … `68`), WebMorph's (`0` … `188`), ids that name
    /// parts (`eye_l_01`, `lips_01`, `brow_edge_r_01`, `nostrils_01`, `mouth_in_01`), or none.
    #[must_use]
    pub fn of<'a>(ids: impl Iterator<Item = &'a str> + Clone) -> Self {
        let all = |range: std::ops::RangeInclusive<u16>| {
            let count = ids.clone().count();
            let numbers = ids.clone().filter_map(|id| id.parse::<u16>().ok());
            count == range.len() && numbers.filter(|number| range.contains(number)).count() == count
        };
        let part = |(ids, out): &(&[u16], f64)| (names(ids), *out);
        if all(0..=467) || all(0..=477) {
            let eyes = if all(0..=477) { [&[468][..], &[473]] } else { [&[33, 133][..], &[362, 263]] };
            let loose: Vec<u16> = MESH_INNER_LIPS.into_iter().chain(MESH_IRISES).collect();
            return Self {
                name: Some("mediapipe"),
                parts: MESH.iter().chain([&MESH_NOSTRILS]).map(part).collect(),
                loose: names(&loose),
                eyes: eyes.map(names),
            };
        }
        if all(1..=68) {
            let loose: Vec<u16> = (61..=68).collect();
            let eyes = [&[37, 40][..], &[43, 46]].map(names);
            return Self {
                name: Some("ibug"),
                parts: IBUG.iter().map(part).collect(),
                loose: names(&loose),
                eyes,
            };
        }
        if let Some(scheme) = Self::named(ids.clone()) {
            return scheme;
        }
        // WebMorph's templates begin with the pupils.
        let eyes = if all(0..=188) { [names(&[0]), names(&[1])] } else { [vec![], vec![]] };
        Self { name: all(0..=188).then_some("webmorph"), eyes, ..Self::default() }
    }

    /// The scheme of ids that name parts, if any does.
    fn named<'a>(ids: impl Iterator<Item = &'a str> + Clone) -> Option<Self> {
        let around = |prefix: &str| -> Vec<String> {
            ids.clone().filter(|id| id.starts_with(prefix)).map(str::to_string).collect()
        };
        let parts: Vec<Part> = NAMED
            .iter()
            .map(|(prefix, out)| (around(prefix), *out))
            .filter(|(ids, _)| ids.len() > 2)
            .collect();
        (!parts.is_empty()).then(|| Self {
            name: Some("named parts"),
            parts,
            loose: around(NAMED_MOUTH),
            eyes: [around("eye_l_"), around("eye_r_")],
        })
    }
}
