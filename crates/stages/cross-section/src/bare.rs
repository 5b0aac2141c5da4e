//! Which pixels beside a wrinkle's paint show bare skin.

use crate::Picture;
use crate::curve::Curve;
use crate::paint::{DISTANCES, EROSION, Pixel, Ratios, Window, bright, distance, is_usable, median};
use crate::ridge::half_width;
use nalgebra::Vector2;

/// Paint that reaches less far to both sides, px, shows too little of a valley: the skin beside it is asked as well …
const NARROW_PX: f64 = 8.0;
/// … told by the paint at places so far apart, px.
const ALONG_PX: f64 = 10.0;
/// Skin is looked at so far beyond the paint, px.
const BESIDE_PX: f64 = 14.0;
/// Log-ratios of skin differ by no more.
const SKIN_DISTANCE: f64 = 0.2;
/// Skin lies at least so far from what is none, px.
const CLEAR: i64 = 3;

/// The skin beside narrow paint; none where there is none, or where the paint is wide.
///
/// Its colour is what most of the surroundings show that is not this paint; what lies near another colour (other paint, dots, lips, brows)
/// is left out.
pub(crate) fn bare_skin(
    picture: &Picture,
    light: &[f64; 256],
    curve: &Curve,
    paint: &[Pixel],
    ratios: &Ratios,
) -> Option<Vec<Pixel>> {
    let half = half_width(paint.iter().map(|pixel| ((pixel.x / ALONG_PX) as usize, pixel.p)));
    if half >= NARROW_PX {
        return None;
    }
    let widest = paint.iter().map(|pixel| pixel.p.abs()).fold(0.0, f64::max);
    let reach = BESIDE_PX + widest + EROSION as f64;
    let window = Window::around(curve, reach, picture)?;
    let is_skin = alike(picture, &window, paint, ratios);
    let codes = |index: usize| {
        let [x, y] = window.place(index);
        picture.at(x, y)
    };
    let placed = (0..is_skin.len()).filter(|&index| is_clear(&window, &is_skin, index)).filter_map(|index| {
        let [x, y] = window.place(index);
        let foot = curve.foot(Vector2::new(x as f64, y as f64)).filter(|foot| foot.p.abs() <= reach)?;
        let lights = codes(index).map(|code| light[usize::from(code)]);
        Some((lights, Pixel { x: foot.x, p: foot.p, light: 0.0, ratio: 0.0, place: [x as u32, y as u32] }))
    });
    let placed: Vec<([f64; 3], Pixel)> = placed.collect();
    let color = bright(placed.iter().map(|(lights, _)| *lights))?;
    let weight = color.iter().map(|light| light * light).sum::<f64>();
    let lit = |(lights, pixel): ([f64; 3], Pixel)| {
        let sum: f64 = lights.iter().zip(color).map(|(light, color)| light * color).sum();
        Pixel { light: sum / weight, ..pixel }
    };
    Some(placed.into_iter().map(lit).collect())
}

/// Per pixel of the window whether it has the colour of most that is not this paint.
fn alike(picture: &Picture, window: &Window, paint: &[Pixel], ratios: &Ratios) -> Vec<bool> {
    let middle = |found: &[[f64; 2]]| -> [f64; 2] {
        [0, 1].map(|k| median(&mut found.iter().map(|ratio| ratio[k]).collect::<Vec<_>>()))
    };
    let at = |pixel: &Pixel| ratios.at(picture.at(pixel.place[0] as usize, pixel.place[1] as usize));
    let painted = middle(&paint.iter().map(at).collect::<Vec<_>>());
    let seen = |index: usize| {
        let [x, y] = window.place(index);
        let codes = picture.at(x, y);
        is_usable(codes).then(|| ratios.at(codes))
    };
    let seen: Vec<Option<[f64; 2]>> = (0..window.size[0] * window.size[1]).map(seen).collect();
    let others = seen.iter().flatten().copied().filter(|ratio| distance(ratio, &painted) > DISTANCES[1]);
    let skin = middle(&others.collect::<Vec<_>>());
    seen.iter().map(|ratio| ratio.is_some_and(|ratio| distance(&ratio, &skin) < SKIN_DISTANCE)).collect()
}

/// Whether a pixel and all around it are skin.
fn is_clear(window: &Window, is_skin: &[bool], index: usize) -> bool {
    let [x, y] = window.place(index).map(|place| place as i64);
    let is_far = |dx: i64, dy: i64| dx * dx + dy * dy > CLEAR * CLEAR;
    let is_there = |dx: i64, dy: i64| window.index([x + dx, y + dy]).is_some_and(|index| is_skin[index]);
    is_skin[index] && (-CLEAR..=CLEAR).all(|dy| (-CLEAR..=CLEAR).all(|dx| is_far(dx, dy) || is_there(dx, dy)))
}
