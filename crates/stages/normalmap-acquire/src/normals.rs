//! Unit normals from slopes, and between others.

use crate::plane::Plane;

/// Normals laid into a larger picture.
pub(crate) fn over(ground: &Plane, part: &Plane, [left, top]: [usize; 2]) -> Plane {
    let mut whole = ground.clone();
    for (row, line) in part.values.chunks(part.width).enumerate() {
        let first = (top + row) * whole.width + left;
        whole.values[first..first + part.width].copy_from_slice(line);
    }
    whole
}

/// Unit normals of slopes (x right, y down), laid over the neutral ones.
pub(crate) fn tilted([x, y]: &[Plane; 2], neutral: Option<&[Plane; 3]>) -> [Plane; 3] {
    let ground = |axis: usize, at: usize| match neutral {
        // The neutral skin's own slopes are added.
        Some(neutral) => neutral[axis].values[at] / neutral[2].values[at].max(0.05),
        None => 0.0,
    };
    let place = |column: usize, row: usize| row * x.width + column;
    let tilt_x =
        Plane::from_fn(x.width, x.height, |column, row| ground(0, place(column, row)) - x.at(column, row));
    let tilt_y =
        Plane::from_fn(x.width, x.height, |column, row| ground(1, place(column, row)) + y.at(column, row));
    let z = tilt_x.with(&tilt_y, |x, y| 1.0 / (1.0 + x * x + y * y).sqrt());
    [tilt_x.with(&z, |x, z| x * z), tilt_y.with(&z, |y, z| y * z), z]
}

/// Normals between the neutral ones and the found ones, by weight.
pub(crate) fn mixed(found: &[Plane; 3], neutral: Option<&[Plane; 3]>, weight: &Plane) -> [Plane; 3] {
    let mut out = [0, 1, 2].map(|axis| found[axis].clone());
    for at in 0..weight.values.len() {
        let share = weight.values[at];
        if share >= 1.0 {
            continue;
        }
        let ground =
            neutral.map_or([0.0, 0.0, 1.0], |neutral| [0, 1, 2].map(|axis| neutral[axis].values[at]));
        let ground = unit(ground);
        let sum = [0, 1, 2].map(|axis| ground[axis] + share * (out[axis].values[at] - ground[axis]));
        let normal = if share > 0.0 { unit(sum) } else { ground };
        (0..3).for_each(|axis| out[axis].values[at] = normal[axis]);
    }
    out
}

fn unit(vector: [f64; 3]) -> [f64; 3] {
    let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-9);
    vector.map(|x| x / length)
}
