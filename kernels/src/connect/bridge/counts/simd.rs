//! ```text
//! cell: knots i, j below mu_t s and h(gamma), and the places u, v between them and the next, from exponent and mantissa
//! P(N) = (1-u) ((1-v) P_ij + v P_i,j+1) + u ((1-v) P_i+1,j + v P_i+1,j+1)
//! draw: i + [a < u], j + [b < v], then N - 1 = the number of cumulative probabilities that c is not below
//! ```
//!
//! 1. Knots are powers of two, or the middles between them: exponent and first bits of a float's mantissa are the cell,
//!    the others the place in it. No logarithm is taken.
//! 2. All lanes of a weight have the same N, so the table for one N is a slab that stays close. A draw reads one row
//!    per lane, eight entries at a time.

use wide::{f32x8, u32x8};

use super::{CountTable, DISTANCES, NEAREST, SURFACE, TURNS};
use crate::lanes;
use crate::lanes::LANES;

/// Places of eight starts in the table.
#[derive(Clone, Copy)]
pub struct CellX8 {
    /// Index of the knot below in both.
    knot: u32x8,
    /// Place between that and the next optical distance, [0, 1).
    u: f32x8,
    /// Place between that and the next turn, [0, 1).
    v: f32x8,
}

/// Among `knots` knots, `2^SPLIT` per octave from 1 on: the last that is not above `value`, except the very last, and
/// the place of `value` between it and the next, [0, 1).
#[inline(always)]
fn locate<const SPLIT: u32>(value: f32x8, knots: u32) -> (u32x8, f32x8) {
    const MANTISSA: u32 = f32::MANTISSA_DIGITS - 1;
    let (place_bits, first) = (MANTISSA - SPLIT, 1.0_f32.to_bits());
    let last = f32x8::splat(f32::from_bits(first + ((knots - 1) << place_bits) - 1));
    let bits: u32x8 = bytemuck::cast(value.fast_max(f32x8::ONE).fast_min(last));
    let place = lanes::to_f32(bits & u32x8::splat((1 << place_bits) - 1));
    ((bits >> place_bits) - u32x8::splat(first >> place_bits), place * f32x8::splat(1.0 / (1 << place_bits) as f32))
}

impl CountTable {
    /// The cells of optical distances `distance`, mu_t s, and of turns to the axis by `h`; those `on_surface` have
    /// none.
    #[inline(always)]
    pub fn cell(&self, distance: f32x8, h: f32x8, on_surface: f32x8) -> CellX8 {
        let (i, u) = locate::<1>(distance * f32x8::splat(1.0 / NEAREST), DISTANCES as u32);
        let (j, v) = locate::<0>(h * f32x8::splat(self.inverse_least_h), SURFACE as u32);
        let j = lanes::as_integer_mask(on_surface).select(u32x8::splat(SURFACE as u32), j);
        CellX8 { knot: i * u32x8::splat(TURNS as u32) + j, u, v: on_surface.select(f32x8::ZERO, v) }
    }

    /// P(`edges`) in the given cells.
    #[inline(always)]
    pub fn probability(&self, edges: usize, cell: &CellX8) -> f32x8 {
        let Some(slab) = self.probabilities.get(edges - 1) else {
            return f32x8::ZERO;
        };
        // Whatever dead rows hold stays inside.
        let knot = (cell.knot & u32x8::splat((DISTANCES * TURNS - 1) as u32)).to_array();
        let corner = |offset: usize| f32x8::new(core::array::from_fn(|lane| slab[knot[lane] as usize + offset]));
        let between = |low: f32x8, high: f32x8, place: f32x8| place.mul_add(high - low, low);
        let near = between(corner(0), corner(1), cell.v);
        let far = between(corner(TURNS), corner(TURNS + 1), cell.v);
        between(near, far, cell.u)
    }

    /// Numbers of inserted vertices, N - 1, for uniform numbers that choose the knots and the number.
    #[inline(always)]
    pub fn draw(&self, cell: &CellX8, choices: [f32x8; 2], number: f32x8) -> u32x8 {
        let step = |choice: f32x8, place: f32x8, by: usize| {
            lanes::as_integer_mask(choice.simd_lt(place)) & u32x8::splat(by as u32)
        };
        let knot = cell.knot + step(choices[0], cell.u, TURNS) + step(choices[1], cell.v, 1);
        let knot = (knot & u32x8::splat((DISTANCES * TURNS - 1) as u32)).to_array();
        let number = number.to_array();
        u32x8::new(core::array::from_fn(|lane| {
            let row = &self.cumulative[knot[lane] as usize * self.stride..][..self.stride];
            let number = f32x8::splat(number[lane]);
            let below = |batch: &[f32; LANES]| number.simd_ge(f32x8::new(*batch)).to_bitmask().count_ones();
            row.as_chunks().0.iter().map(below).sum()
        }))
    }
}
