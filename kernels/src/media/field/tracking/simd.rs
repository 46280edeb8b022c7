//! ```text
//! repeat for each of eight rays:
//!     while budget > rate * (t_next - t):  budget -= rate * (t_next - t),  t = t_next,  into the next block
//!     t += budget / rate;    ask the density there;    a new budget
//! ```
//!
//! 1. Rays cross blocks until most of them have a candidate or are through; then the density is asked for all of those
//!    at once, and the others go on where they are.
//! 2. Rays come in batches, which are set out and taken to their first candidates as such: many end there. Of the
//!    others, each takes a lane whose ray has ended, so that none waits for the longest one. What becomes of a ray does
//!    not depend on its lane or its neighbours.
//! 3. A ray of unit direction has t in metres, a segment t in [0, 1]: rates are per unit of t.
//! 4. Before a ray enters the box of all cells, and after it leaves it, its way is through what is around them: of that
//!    everything is known.
//! 5. A block with a core has bounds of its own before the core, in it and after it: rays cross it in up to three pieces.
//! 6. In a block of one extinction, density need not be asked. A field that is one shape needs no walk at all
//!    (`one_shape`), and neither does a ray that ends in the even part in which it began: it would have no candidate but
//!    the last, and that where it is known to be.

use wide::{f32x8, i32x8, u32x8};

use super::quest::{Flight, Quest, Transmittance};
use super::rays::{Ended, Lanes};
use super::{FlightsX8, RaysX8, first_budgets, one_shape};
use crate::lanes::{self, LANES};
use crate::media::field::{EvenX8, Field};
use crate::transcendental::{exp, neg_ln};

/// So many rays that still cross blocks do not keep the others waiting.
const FEW: u32 = 3;

/// Hands the lengths of all flights to `end`, some of a batch at a time: the row in lane 0, lanes and lengths, infinite
/// where a flight leaves all there is. `stream` has what those of a batch draw from, by the row in lane 0.
pub fn flights(
    field: &Field,
    flights: impl Iterator<Item = FlightsX8>,
    stream: impl Fn(usize) -> [u32x8; 4],
    mut end: impl FnMut(usize, u32, f32x8),
) {
    if let Some(shape) = &field.one {
        return flights.for_each(|batch| end(batch.first, batch.live, one_shape::flights(field, shape, &batch)));
    }
    let end = core::cell::RefCell::new(end);
    let rays = flights.filter_map(|batch| {
        let (ended, flown) = end_in_even_part(field, &batch);
        if ended != 0 {
            end.borrow_mut()(batch.first, ended, flown);
        }
        let live = batch.live & !ended;
        (live != 0).then(|| (batch.rays(live, stream(batch.first)), batch.budget))
    });
    track::<1, Flight>(field, rays, f32::INFINITY, |row, ended| {
        let flown = if ended.collided { ended.t } else { f32::INFINITY };
        end.borrow_mut()(row - row % LANES, 1 << (row % LANES), f32x8::splat(flown));
    });
}

/// The lanes of a batch whose flights end in the even part in which they began, and their lengths.
#[inline(always)]
fn end_in_even_part(field: &Field, batch: &FlightsX8) -> (u32, f32x8) {
    let Some(even) = &field.even else { return (0, f32x8::ZERO) };
    let (start, way) = (field.in_cells(batch.origin), field.to_cells.directions(batch.direction));
    let rate = batch.direction.length_squared().sqrt() * batch.hue * f32x8::splat(even.extinction);
    let flight = batch.budget / rate;
    // Convex: what begins and ends in it stays in it.
    let ended = even.holds(start) & even.holds(way.mul_add(flight, start));
    (lanes::bits(ended) & batch.live, flight)
}

/// Hands an estimate of every segment's transmittance to `end`, as products and the optical depth of the coarse field
/// where the hue is 1: for each of N hues, `T' = product e^{-hue depth}`.
pub fn transmittances<const N: usize>(
    field: &Field,
    segments: impl Iterator<Item = RaysX8<N>>,
    mut end: impl FnMut(usize, [f32; N], f32),
) {
    if let Some(shape) = &field.one {
        return segments.for_each(|batch| one_shape::transmittances(field, shape, &batch, &mut end));
    }
    let end = core::cell::RefCell::new(end);
    let segments = segments.filter_map(|batch| {
        let (stays, depths) = EvenX8::new(field, f32x8::ONE).stays(batch.origin, batch.direction);
        let known = lanes::bits(stays) & batch.live;
        for lane in lanes::each(known) {
            end.borrow_mut()(batch.first + lane, [1.0; N], depths.to_array()[lane]);
        }
        let live = batch.live & !known;
        (live != 0).then(|| (RaysX8 { live, ..batch }, first_budgets(batch.stream)))
    });
    track::<N, Transmittance>(field, segments, 1.0, |row, ended| end.borrow_mut()(row, ended.results, ended.known));
}

#[inline(always)]
fn track<const N: usize, Q: Quest<N>>(
    field: &Field,
    mut rays: impl Iterator<Item = (RaysX8<N>, f32x8)>,
    longest: f32,
    mut end: impl FnMut(usize, Ended<N>),
) {
    let (mut lanes, mut waiting) = (Lanes::<N>::empty(), Lanes::<N>::empty());
    loop {
        while lanes.live != lanes::ALL {
            if waiting.live == 0 {
                let Some(batch) = rays.next() else { break };
                waiting.set_out::<Q>(field, batch, longest, &mut end);
                if waiting.live == 0 {
                    continue;
                }
                waiting.go_on::<Q>(field, longest, &mut end);
            }
            lanes.take(&mut waiting);
        }
        if lanes.live == 0 {
            return;
        }
        lanes.go_on::<Q>(field, longest, &mut end);
    }
}

impl<const N: usize> Lanes<N> {
    /// Goes on with all rays until most have met a candidate or are through, and hands those that end to `end`.
    #[inline(always)]
    fn go_on<Q: Quest<N>>(&mut self, field: &Field, longest: f32, end: &mut impl FnMut(usize, Ended<N>)) {
        let ended = self.cross_and_meet::<Q>(field);
        self.leave::<Q>(field, longest);
        self.end(ended, self.through, end);
        self.live &= !ended;
    }

    /// Sets a batch out. Rays that miss the cells, or end before, end at once.
    #[inline(always)]
    fn set_out<Q: Quest<N>>(
        &mut self,
        field: &Field,
        (batch, budget): (RaysX8<N>, f32x8),
        longest: f32,
        end: &mut impl FnMut(usize, Ended<N>),
    ) {
        self.enter::<Q>(field, &batch, budget, longest);
        let mut missed = batch.live & !lanes::bits(self.t.simd_lt(self.exit));
        let mut early = 0;
        if field.around() != 0.0 {
            (missed, early) = self.approach::<Q>(field, batch.live, missed, longest);
        }
        self.end(missed | early, missed, end);
        self.live = batch.live & !missed & !early;
    }

    /// Takes the rays `fresh` through what is around the cells, up to these or, if they have `missed` them, to their
    /// ends. Gives those that have come to their ends, and those that have collided.
    #[inline(always)]
    fn approach<Q: Quest<N>>(&mut self, field: &Field, fresh: u32, missed: u32, longest: f32) -> (u32, u32) {
        let fresh_lanes = lanes::mask(fresh);
        let rate = f32x8::splat(field.around()) * self.scale;
        let until = lanes::mask(missed).select(f32x8::splat(longest), self.start + self.t);
        let depth = rate * until;
        if !Q::FLIES {
            self.known = fresh_lanes.select(depth, self.known);
            return (missed, 0);
        }
        let early = fresh_lanes & depth.simd_ge(self.budget);
        self.t = early.select(self.budget / rate, self.t);
        self.start = early.select(f32x8::ZERO, self.start);
        self.budget = (fresh_lanes & !early).select(self.budget - depth, self.budget);
        let early = lanes::bits(early);
        (missed & !early, early)
    }

    /// Takes the rays that are through the cells on, through what is around these.
    #[inline(always)]
    fn leave<Q: Quest<N>>(&mut self, field: &Field, longest: f32) {
        if field.around() == 0.0 || self.through == 0 {
            return;
        }
        let through = lanes::mask(self.through);
        let rate = f32x8::splat(field.around()) * self.scale;
        if Q::FLIES {
            self.t = through.select(self.exit + self.budget / rate, self.t);
            self.through = 0;
        } else {
            let rest = rate * (f32x8::splat(longest) - (self.start + self.exit));
            self.known = through.select(self.known + rest, self.known);
        }
    }

    /// Takes most rays to their next candidates; gives the lanes whose rays end.
    #[inline(always)]
    fn cross_and_meet<Q: Quest<N>>(&mut self, field: &Field) -> u32 {
        let live = lanes::mask(self.live);
        let (mut moving, mut through) = (live, f32x8::ZERO);
        let (mut row, mut rates);
        loop {
            let mut border = self.next.x.fast_min(self.next.y).fast_min(self.next.z).fast_min(self.exit);
            row = self.block;
            if let Some(cores) = &field.blocks.cores {
                (row, border) = cores.ahead(row, [self.origin, self.direction], self.t, border);
            }
            rates = Q::rates(&field.blocks, row);
            let length = (border - self.t).fast_max(f32x8::ZERO) * self.scale;
            let spent = rates[0] * length;
            let crosses = moving & spent.simd_lt(self.budget);
            self.budget = crosses.select(self.budget - spent, self.budget);
            if !Q::FLIES {
                self.known = crosses.select(rates[1].mul_add(length, self.known), self.known);
            }
            self.t = crosses.select(border.fast_max(self.t), self.t);
            let goes_on = crosses & border.simd_lt(self.exit);
            self.step(goes_on, border);
            through |= crosses & !goes_on;
            moving = goes_on;
            if lanes::bits(moving).count_ones() <= FEW {
                break;
            }
        }
        self.through = lanes::bits(through);
        let arrived = live & !through & !moving;
        if !arrived.any() {
            return self.through;
        }
        let way = self.budget / rates[0];
        // However dense a block is, no candidate is where the last one was: there might be no end to them.
        let ahead = (way / self.scale + self.t).fast_max(next_up(self.t));
        self.t = arrived.select(ahead, self.t);
        self.known = arrived.select(rates[1].mul_add(way, self.known), self.known);
        let (even, mut extinction) = Q::even(&field.blocks, row, rates);
        if (arrived & !even).any() {
            let at = self.direction.mul_add(self.t, self.origin);
            extinction = even.select(extinction, field.at(at).0);
        }
        let [u, first] = self.draw();
        let (results, ends) = Q::meet(self.results, self.hues, extinction, rates, u);
        for (result, after) in self.results.iter_mut().zip(results) {
            *result = arrived.select(after, *result);
        }
        self.budget = arrived.select(neg_ln(f32x8::ONE - first), self.budget);
        self.candidates += bytemuck::cast::<f32x8, u32x8>(arrived) & u32x8::splat(1);
        self.through | lanes::bits(arrived & ends)
    }

    /// Takes the rays in `crosses` across the next `border` that they come to, at edges and corners across all of them.
    #[inline(always)]
    fn step(&mut self, crosses: f32x8, border: f32x8) {
        let delta = [self.delta.x, self.delta.y, self.delta.z];
        for (axis, next) in [&mut self.next.x, &mut self.next.y, &mut self.next.z].into_iter().enumerate() {
            let here = crosses & next.simd_le(border);
            *next = here.select(*next + delta[axis], *next);
            self.block += bytemuck::cast::<f32x8, i32x8>(here) & self.stride[axis];
        }
    }
}

/// The next larger numbers, of `x` >= 0.
#[inline(always)]
fn next_up(x: f32x8) -> f32x8 {
    bytemuck::cast(bytemuck::cast::<f32x8, u32x8>(x) + u32x8::splat(1))
}

/// `T' e^{hue depth}` for an estimate of the transmittance as [`transmittances`] gives it, and the `depth` that weights
/// counted.
#[inline(always)]
pub fn factor(product: f32x8, hue: f32x8, known: f32x8, depth: f32x8) -> f32x8 {
    product * exp(hue * (depth - known))
}
