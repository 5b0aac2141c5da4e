//! Numbers side by side: four, one per time of the exposure, and sixteen, four samples at each time. Plain loops, which
//! compilers turn into vector instructions of the width that the processor has, and which give the same bits on every
//! machine.

pub(super) const LANES: usize = 4;
pub(super) type Lanes = [f32; LANES];

/// Samples of a quarter of the finest pattern, or all of the coarser one: lane `4 · block + time`.
pub(super) const WIDE: usize = 16;
pub(super) type Wide = [f32; WIDE];

#[inline(always)]
pub(super) fn map(f: impl Fn(usize) -> f32) -> Lanes {
    std::array::from_fn(f)
}

#[inline(always)]
pub(super) fn map_wide(f: impl Fn(usize) -> f32) -> Wide {
    let mut wide = [0.0; WIDE];
    for (lane, value) in wide.iter_mut().enumerate() {
        *value = f(lane);
    }
    wide
}

/// Each time's number in all samples of this time.
#[inline(always)]
pub(super) fn spread(lanes: &Lanes) -> Wide {
    map_wide(|lane| lanes[lane % LANES])
}

#[inline(always)]
pub(super) fn lowest(values: Lanes) -> f32 {
    lower(lower(values[0], values[1]), lower(values[2], values[3]))
}

#[inline(always)]
pub(super) fn highest(values: Lanes) -> f32 {
    higher(higher(values[0], values[1]), higher(values[2], values[3]))
}

/// The lower of two numbers that are numbers: one instruction, unlike `f32::min`.
#[inline(always)]
pub(super) fn lower(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The higher of two numbers that are numbers.
#[inline(always)]
pub(super) fn higher(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
