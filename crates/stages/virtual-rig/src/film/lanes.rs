//! Four numbers side by side, one per time of the exposure. Plain loops over four, which compilers turn into one vector
//! instruction, and which give the same bits on every machine.

pub(super) const LANES: usize = 4;
pub(super) type Lanes = [f32; LANES];

#[inline(always)]
pub(super) fn map(f: impl Fn(usize) -> f32) -> Lanes {
    std::array::from_fn(f)
}

#[inline(always)]
pub(super) fn lowest(values: Lanes) -> f32 {
    values[0].min(values[1]).min(values[2].min(values[3]))
}

#[inline(always)]
pub(super) fn highest(values: Lanes) -> f32 {
    values[0].max(values[1]).max(values[2].max(values[3]))
}
