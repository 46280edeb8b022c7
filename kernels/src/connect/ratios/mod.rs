//! The ratios of all techniques, one term each.
//!
//! `mis_weight` adds up `reach(i) r_i` over starts `i` and techniques. Here stands whose ratios `r_i` these are, and what
//! each of them is told of the path; their formulas stand in the techniques' folders.

pub mod reference;
pub mod simd;
