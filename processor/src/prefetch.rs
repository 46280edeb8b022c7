//! Asking for memory before it is needed.

/// Bytes that come from memory together.
#[cfg(target_arch = "x86_64")]
const LINE: usize = 64;

/// Asks for a row that will be read soon, and does not wait for it. A hint, which changes no result; elsewhere than on
/// x86-64 it does nothing.
#[inline(always)]
pub fn prefetch<T>(row: &T) {
    #[cfg(target_arch = "x86_64")]
    {
        use core::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let start = core::ptr::from_ref(row).cast::<i8>();
        for offset in (0..size_of::<T>()).step_by(LINE) {
            // SAFETY: every processor of this architecture has the instruction, and it reads nothing; the address is
            // within the row.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(start.add(offset)) };
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = row;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_any_size_may_be_asked_for_and_stay_what_they_are() {
        let (small, large) = (7_u8, [3_u64; 40]);
        prefetch(&());
        prefetch(&small);
        prefetch(&large);
        assert_eq!((small, large), (7, [3; 40]));
    }
}
