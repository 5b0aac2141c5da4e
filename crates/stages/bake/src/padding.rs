//! Texels beyond the edges of what is unwrapped.

/// Lets the set texels of a square picture of `size` grow by rings of one texel, `rings` times: a new texel is the mean of the set ones
/// among its eight neighbours.
pub(crate) fn grow(values: &mut [[f64; 4]], mut is_set: Vec<bool>, size: usize, rings: usize) {
    let mut rim: Vec<usize> = (0..values.len()).filter(|&at| is_set[at]).collect();
    for _ in 0..rings {
        let mut next: Vec<usize> =
            rim.iter().flat_map(|&at| neighbors(at, size)).filter(|&at| !is_set[at]).collect();
        next.sort_unstable();
        next.dedup();
        let means: Vec<[f64; 4]> = next.iter().map(|&at| mean(values, &is_set, at, size)).collect();
        for (&at, mean) in next.iter().zip(means) {
            values[at] = mean;
            is_set[at] = true;
        }
        rim = next;
    }
}

fn mean(values: &[[f64; 4]], is_set: &[bool], at: usize, size: usize) -> [f64; 4] {
    let set = neighbors(at, size).filter(|&other| is_set[other]);
    let (sum, count) = set.fold(([0.0; 4], 0.0), |(sum, count), other| {
        (std::array::from_fn(|k| sum[k] + values[other][k]), count + 1.0)
    });
    sum.map(|value: f64| value / f64::max(count, 1.0))
}

fn neighbors(at: usize, size: usize) -> impl Iterator<Item = usize> {
    let (row, column) = (at / size, at % size);
    let rows = row.saturating_sub(1)..(row + 2).min(size);
    rows.flat_map(move |y| (column.saturating_sub(1)..(column + 2).min(size)).map(move |x| y * size + x))
        .filter(move |&other| other != at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_grows_by_as_many_rings_as_it_is_told() {
        let mut values = vec![[0.0; 4]; 81];
        let mut is_set = vec![false; 81];
        (values[40], is_set[40]) = ([1.0, 2.0, 3.0, 4.0], true);
        grow(&mut values, is_set, 9, 2);
        for (at, value) in values.iter().enumerate() {
            let away = (at / 9).abs_diff(4).max((at % 9).abs_diff(4));
            assert_eq!(*value, if away <= 2 { [1.0, 2.0, 3.0, 4.0] } else { [0.0; 4] });
        }
    }
}
