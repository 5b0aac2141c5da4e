//! Asking for memory before it is needed.
#![allow(
    unsafe_code,
    reason = "the columns of a small front are too short for the processor to foresee the next; only the intrinsic tells it, \
              and a prefetch changes nothing but time: it cannot fault, whatever the address"
)]

/// Values on a cache line.
#[cfg(target_arch = "x86_64")]
const LINE: usize = 8;

/// Asks for `count` values from place `start` on, as far as there are any.
#[inline(always)]
pub(crate) fn prefetch(values: &[f64], start: usize, count: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let end = (start + count).min(values.len());
        for line in (start..end).step_by(LINE) {
            unsafe { _mm_prefetch::<_MM_HINT_T0>(values.as_ptr().wrapping_add(line).cast()) };
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (values, start, count);
}
