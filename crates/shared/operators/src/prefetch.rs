//! Asking for memory before it is needed.
#![allow(
    unsafe_code,
    reason = "the columns of a small front are too short for the processor to foresee the next; only the intrinsic tells it, \
              and a prefetch changes nothing but time: it cannot fault, whatever the address"
)]

/// Asks for the cache line around a value; a place that is none does nothing.
#[inline(always)]
pub(crate) fn prefetch(values: &[f64], place: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        unsafe { _mm_prefetch::<_MM_HINT_T0>(values.as_ptr().wrapping_add(place).cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (values, place);
}
