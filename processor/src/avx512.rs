//! Registers of 512 bits.
//!
//! A build for all processors with AVX2 puts eight rows into a register. Many processors could take sixteen, so loops
//! that gain from it are compiled a second time, and run where the processor has what they need.

/// The proof that this processor has AVX-512: its foundation, and the instructions on vectors of all lengths, on bytes
/// and words, and on double and quadruple words.
#[derive(Clone, Copy, Debug)]
pub struct Avx512(());

impl Avx512 {
    /// Asks the processor; the answer is remembered, so that asking again costs nothing.
    #[inline]
    pub fn detect() -> Option<Self> {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
        {
            return Some(Self(()));
        }
        None
    }

    /// Runs `kernel`, compiled for AVX-512 with everything that is inlined into it.
    #[inline(always)]
    pub fn run<R>(self, kernel: impl FnOnce() -> R) -> R {
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = "avx512f,avx512vl,avx512bw,avx512dq")]
            fn compiled<R>(kernel: impl FnOnce() -> R) -> R {
                kernel()
            }
            // SAFETY: `self` only exists where the processor has these instructions.
            unsafe { compiled(kernel) }
        }
        #[cfg(not(target_arch = "x86_64"))]
        kernel()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loop_gives_the_same_for_either() {
        let Some(avx512) = Avx512::detect() else {
            println!("this processor has no AVX-512: nothing to compare");
            return;
        };
        let numbers: Vec<f32> = (0..100_u16).map(|i| f32::from(i).mul_add(0.37, 0.1)).collect();
        let roots = || numbers.iter().map(|x| (x * x - 0.5 * x).abs().sqrt()).collect::<Vec<_>>();
        assert_eq!(avx512.run(roots), roots());
    }
}
