//! The points by which a scan is laid onto the average face.

/// A point of the face that people can find.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Landmark {
    /// Its id; `_l` and `_r` are the subject's sides.
    pub name: &'static str,
    /// Where it is.
    pub what: &'static str,
    /// (s, t) on the unrolled average face, mm.
    pub at: [f64; 2],
}

const fn landmark(name: &'static str, what: &'static str, at: [f64; 2]) -> Landmark {
    Landmark { name, what, at }
}

/// All landmarks that a scan may name. None is needed in particular, but [`LEAST`] in all; a scan with closed lids or
/// lips leaves out the edges that it does not show.
pub const LANDMARKS: [Landmark; 42] = [
    landmark("eye_inner_l", "inner corner of the eye", [19.0, 35.3]),
    landmark("eye_inner_r", "inner corner of the eye", [-19.0, 35.3]),
    landmark("eye_outer_l", "outer corner of the eye", [47.0, 36.7]),
    landmark("eye_outer_r", "outer corner of the eye", [-47.0, 36.7]),
    landmark("lid_upper_l", "middle of the upper lid's edge, the eye open", [33.0, 41.4]),
    landmark("lid_upper_r", "middle of the upper lid's edge, the eye open", [-33.0, 41.4]),
    landmark("lid_lower_l", "middle of the lower lid's edge", [33.0, 32.0]),
    landmark("lid_lower_r", "middle of the lower lid's edge", [-33.0, 32.0]),
    landmark("brow_inner_l", "inner end of the brow, half its height", [12.0, 54.0]),
    landmark("brow_inner_r", "inner end of the brow, half its height", [-12.0, 54.0]),
    landmark("brow_mid_l", "highest part of the brow, half its height", [34.0, 58.0]),
    landmark("brow_mid_r", "highest part of the brow, half its height", [-34.0, 58.0]),
    landmark("brow_outer_l", "outer end of the brow", [54.0, 52.0]),
    landmark("brow_outer_r", "outer end of the brow", [-54.0, 52.0]),
    landmark("forehead", "middle of the forehead, half way from the brows to the hair", [0.0, 80.0]),
    landmark("forehead_l", "as high as `forehead`, above the outer third of the brow", [42.0, 80.0]),
    landmark("forehead_r", "as high as `forehead`, above the outer third of the brow", [-42.0, 80.0]),
    landmark("temple_l", "hollow of the temple", [68.0, 56.0]),
    landmark("temple_r", "hollow of the temple", [-68.0, 56.0]),
    landmark("nose_root", "deepest point between the eyes", [0.0, 41.9]),
    landmark("nose_tip", "foremost point of the nose", [0.0, 4.4]),
    landmark("nose_wing_l", "outermost point of the nostril's wing", [17.0, 2.0]),
    landmark("nose_wing_r", "outermost point of the nostril's wing", [-17.0, 2.0]),
    landmark("nose_base", "where the nose meets the upper lip", [0.0, -9.0]),
    landmark("nasolabial_l", "in the fold, half way from the wing to the corner of the mouth", [26.0, -11.0]),
    landmark(
        "nasolabial_r",
        "in the fold, half way from the wing to the corner of the mouth",
        [-26.0, -11.0],
    ),
    landmark("cheekbone_l", "most prominent point of the cheekbone", [48.0, 18.0]),
    landmark("cheekbone_r", "most prominent point of the cheekbone", [-48.0, 18.0]),
    landmark(
        "mouth_corner_l",
        "corner of the mouth; where it was cut open, the end of the cut",
        [25.0, -27.9],
    ),
    landmark(
        "mouth_corner_r",
        "corner of the mouth; where it was cut open, the end of the cut",
        [-25.0, -27.9],
    ),
    landmark("lip_upper", "middle of the red lip's upper edge", [0.0, -21.6]),
    landmark("lip_line", "middle of the closed lips' line", [0.0, -27.8]),
    landmark("lip_upper_inner", "middle of the upper lip's lower edge, the lips parted", [0.0, -27.2]),
    landmark("lip_lower_inner", "middle of the lower lip's upper edge, the lips parted", [0.0, -28.4]),
    landmark("lip_lower", "middle of the red lip's lower edge", [0.0, -37.3]),
    landmark("chin_crease", "deepest point between lip and chin", [0.0, -44.5]),
    landmark("chin", "foremost point of the chin", [0.0, -57.8]),
    landmark("chin_under", "lowest point of the chin", [0.0, -72.0]),
    landmark("jaw_l", "edge of the jaw, half way from the chin to its angle", [45.0, -62.0]),
    landmark("jaw_r", "edge of the jaw, half way from the chin to its angle", [-45.0, -62.0]),
    landmark("jaw_angle_l", "angle of the jaw, below the ear", [82.0, -41.0]),
    landmark("jaw_angle_r", "angle of the jaw, below the ear", [-82.0, -41.0]),
];

/// The landmark whose name takes the fewest changes of a letter.
pub(super) fn closest_name(name: &str) -> &'static str {
    let changes = |other: &str| {
        let other: Vec<char> = other.chars().collect();
        let mut row: Vec<usize> = (0..=other.len()).collect();
        for (i, letter) in name.chars().enumerate() {
            let mut corner = row[0];
            row[0] = i + 1;
            for j in 0..other.len() {
                let changed = corner + usize::from(other[j] != letter);
                corner = row[j + 1];
                row[j + 1] = changed.min(row[j] + 1).min(corner + 1);
            }
        }
        row[other.len()]
    };
    LANDMARKS.iter().map(|landmark| landmark.name).min_by_key(|other| changes(other)).unwrap_or_default()
}
