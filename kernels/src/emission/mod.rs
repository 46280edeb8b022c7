//! What lights emit: radiance by direction, and directions drawn in proportion to it.
//!
//! The radiance of an emitter at an angle theta to the normal of a side that shines is its `radiance` times its
//! *profile*: 1, or for focused ones a power `(k + 1) / (2 pi) cos^k theta`, or a cone. Directions are drawn by the
//! cosine law that fits the power, `p_dir = (k + 2) / (2 pi) cos^{k + 1} theta`; where both sides shine, either is
//! taken.

pub mod reference;
mod simd;
