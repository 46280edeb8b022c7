//! What a build for many processors leaves to the one on which it runs: wider registers where it has them ([`Avx512`]),
//! and a word to it on what memory will be read next ([`prefetch()`]).

mod avx512;
mod prefetch;

pub use avx512::Avx512;
pub use prefetch::prefetch;
