//! Reading the table, in f64.
//!
//! ```text
//! P(N) = sum over the four knots around (mu_t s, h(gamma)) of their bilinear weight times their P(N)
//! ```

use super::{CountTable, SURFACE, TURNS, distance_of};
use crate::phase::HenyeyGreenstein;

/// The place of a start in the table: knots with their weights, which add up to one.
pub type Cell = [(usize, f64); 4];

/// The cell of an optical distance mu_t s and of a turn to the axis of the given cosine, None at a surface, in the
/// table of a phase function with this lobe.
pub fn cell(table: &CountTable, lobe: HenyeyGreenstein, distance: f64, cosine: Option<f64>) -> Cell {
    let distances: Vec<f64> = (0..super::DISTANCES).map(distance_of).collect();
    let g = f64::from(lobe.g);
    let (i, u) = locate(&distances, distance);
    let (j, v) = match cosine {
        None => (SURFACE, 0.0),
        Some(cosine) => {
            let turns: Vec<f64> = (0..SURFACE).map(|k| 2.0_f64.powi(k as i32)).collect();
            locate(&turns, (1.0 + g * g - 2.0 * g * cosine) * f64::from(table.inverse_least_h))
        }
    };
    let at = |i: usize, j: usize| i * TURNS + j;
    let next = if v > 0.0 { j + 1 } else { j };
    [
        (at(i, j), (1.0 - u) * (1.0 - v)),
        (at(i, next), (1.0 - u) * v),
        (at(i + 1, j), u * (1.0 - v)),
        (at(i + 1, next), u * v),
    ]
}

/// The last knot but one that does not exceed `value`, and the place between it and the next, [0, 1].
fn locate(knots: &[f64], value: f64) -> (usize, f64) {
    let value = value.clamp(knots[0], knots[knots.len() - 1]);
    let below = knots.partition_point(|knot| *knot <= value).clamp(1, knots.len() - 1) - 1;
    (below, (value - knots[below]) / (knots[below + 1] - knots[below]))
}

/// P(`edges`) in a cell.
pub fn probability(table: &CountTable, cell: &Cell, edges: u32) -> f64 {
    match table.probabilities.get(edges as usize - 1) {
        Some(slab) => cell.iter().map(|(knot, weight)| weight * f64::from(slab[*knot])).sum(),
        None => 0.0,
    }
}

/// The number of inserted vertices, N - 1, for numbers that choose the knots along distance and turn and the number.
pub fn draw(table: &CountTable, cell: &Cell, [along, across]: [f64; 2], number: f64) -> u32 {
    let [near, near_next, far, far_next] = cell;
    let u = far.1 + far_next.1;
    let v = near_next.1 + far_next.1;
    let (knot, _) = match (along < u, across < v) {
        (false, false) => near,
        (false, true) => near_next,
        (true, false) => far,
        (true, true) => far_next,
    };
    let mut sum = 0.0;
    (0..table.edges)
        .find(|n| {
            sum += f64::from(table.probabilities[*n][*knot]);
            sum > number
        })
        .map_or(table.edges as u32, |n| n as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connect::bridge::counts::{DISTANCES, knots};
    use crate::media::Medium;
    use crate::phase::PhaseFunction;
    use crate::phase::reference::{Phase, turn};
    use crate::random;
    use glam::DVec3;

    fn medium(g: f32, albedo: f32) -> Medium {
        Medium::homogeneous(1.0, [albedo; 3], PhaseFunction::henyey_greenstein(g))
    }

    #[test]
    fn probabilities_add_up_to_one_everywhere() {
        for (g, albedo, longest) in [(0.9, 1.0, 15), (0.0, 0.5, 30), (-0.6, 0.0, 4), (0.99, 1.0, 400), (0.5, 1.0, 1)] {
            let table = CountTable::new(&medium(g, albedo), longest);
            for (distance, turn) in
                [(0.0, Some(1.0)), (3e-3, Some(-1.0)), (2.0, Some(0.3)), (1e4, Some(0.9)), (5.0, None)]
            {
                let cell = cell(&table, HenyeyGreenstein { g }, distance, turn);
                let sum: f64 = (1..=table.edges() as u32).map(|n| probability(&table, &cell, n)).sum();
                assert!((sum - 1.0).abs() < 1e-6, "g = {g} at {distance}, {turn:?}: {sum}");
            }
        }
    }

    /// A knot has its own probabilities, and the middle between two their mean.
    #[test]
    fn the_table_is_bilinear_between_its_knots() {
        let lobe = HenyeyGreenstein { g: 0.8 };
        let table = CountTable::from_weights(lobe, 2, |knot| vec![knot.index as f64 + 1.0, 1.0]);
        let knots: Vec<_> = knots(lobe).collect();
        let of = |index: usize| (index as f64 + 1.0) / (index as f64 + 2.0);
        let found = |distance: f64, turn: Option<f64>| probability(&table, &cell(&table, lobe, distance, turn), 1);
        for (index, knot) in knots.iter().enumerate() {
            // The steepest turns of the table are beyond half a turn here, and clamped to it.
            if knot.cosine != Some(-1.0) {
                assert!((found(knot.distance, knot.cosine) - of(index)).abs() < 1e-5, "{knot:?}");
            }
        }
        let (low, high) = (knots[5 * TURNS + 3], knots[6 * TURNS + 4]);
        let middle = |a: f64, b: f64| 0.5 * (a + b);
        let cosine = middle(low.cosine.expect("a turn"), high.cosine.expect("a turn"));
        let mean = [5 * TURNS + 3, 5 * TURNS + 4, 6 * TURNS + 3, 6 * TURNS + 4].map(of).iter().sum::<f64>() / 4.0;
        assert!((found(middle(low.distance, high.distance), Some(cosine)) - mean).abs() < 1e-5);
        assert_eq!(found(0.0, Some(1.0)), found(knots[0].distance, Some(1.0)));
        assert_eq!(found(1e9, None), found(knots[(DISTANCES - 1) * TURNS].distance, None));
    }

    /// For one and two edges the means have closed forms, up to a quadrature.
    #[test]
    fn light_by_one_edge_and_by_two_is_in_proportion() {
        for (g, albedo, distance, turn) in [(0.6, 1.0, 1.5, 0.2), (0.0, 0.7, 0.75, 1.0), (0.9, 1.0, 3.0, 0.9)] {
            let (table, phase) = (CountTable::new(&medium(g, albedo), 3), HenyeyGreenstein { g });
            let cell = cell(&table, phase, distance, Some(turn));
            let found = probability(&table, &cell, 2) / probability(&table, &cell, 1);
            let expected = f64::from(albedo) * two_edges(&phase, distance, turn)
                / (phase.density(turn) * (-distance).exp() / (distance * distance));
            assert!((found / expected - 1.0).abs() < 0.15, "g = {g}: {found}, expected {expected}");
        }
    }

    /// The integral over the inserted vertex of `phase phase exp(-L) / (l1^2 l2^2)`, for ends `distance` apart, in
    /// bipolar coordinates: dV = l1^2 l2^2 / distance dalpha dbeta dphi.
    fn two_edges(phase: &dyn Phase, distance: f64, turn: f64) -> f64 {
        use core::f64::consts::{PI, TAU};
        let (turns, shares, azimuths) = (400, 200, 32);
        let mut sum = 0.0;
        for (i, j) in (0..turns).flat_map(|i| (0..shares).map(move |j| (i, j))) {
            let theta = PI * (f64::from(i) + 0.5) / f64::from(turns);
            let alpha = theta * (f64::from(j) + 0.5) / f64::from(shares);
            let length = distance * ((theta - alpha).sin() + alpha.sin()) / theta.sin();
            for k in 0..azimuths {
                let azimuth = TAU * f64::from(k) / f64::from(azimuths);
                let first = alpha.cos() * turn + alpha.sin() * (1.0 - turn * turn).sqrt() * azimuth.cos();
                sum += phase.density(first) * phase.density(theta.cos()) * (-length).exp() * theta;
            }
        }
        sum / distance * PI * TAU / f64::from(turns * shares * azimuths)
    }

    /// Ends of the N-th flights of random walks from the start are as dense, in volume, as light by N edges is strong.
    #[test]
    fn light_by_more_edges_is_in_the_proportion_that_walks_see() {
        let (phase, distance, turns) = (HenyeyGreenstein { g: 0.5 }, 2.0, [0.4, 0.8]);
        let (low, high) = (0.8 * distance, 1.2 * distance);
        let mut seen = [0.0; 4];
        for walk in 0..400_000 {
            let (mut position, mut direction) = (DVec3::ZERO, DVec3::Z);
            for (n, seen) in seen.iter_mut().enumerate() {
                let numbers = random::words(walk, n as u32, 0, 1).map(random::uniform);
                let turned = turn(direction, phase.sample_cosine(numbers[1]), numbers[2]);
                (position, direction) = (position - (1.0 - numbers[0]).ln() * turned, turned);
                let (length, cosine) = (position.length(), position.z / position.length());
                *seen += f64::from(u8::from((low..high).contains(&length) && (turns[0]..turns[1]).contains(&cosine)));
            }
        }
        let table = CountTable::new(&medium(phase.g, 1.0), 5);
        // By one edge that density is phase exp(-s) / s^2, and the volume s^2 ds dcos.
        let (mut expected, steps) = ([0.0; 4], 24);
        for (i, j) in (0..steps).flat_map(|i| (0..steps).map(move |j| (i, j))) {
            let between = |low: f64, high: f64, k: i32| low + (high - low) * (f64::from(k) + 0.5) / f64::from(steps);
            let (s, cosine) = (between(low, high, i), between(turns[0], turns[1], j));
            let cell = cell(&table, phase, s, Some(cosine));
            let single = phase.density(cosine) * (-s).exp();
            let scale = single / probability(&table, &cell, 1);
            (0..4).for_each(|n| expected[n] += scale * probability(&table, &cell, n as u32 + 1));
        }
        for n in 1..4 {
            let (found, expected) = (seen[n] / seen[0], expected[n] / expected[0]);
            assert!((found / expected - 1.0).abs() < 0.1, "{} edges: {expected}, walks see {found}", n + 1);
        }
    }

    #[test]
    fn paths_that_turn_or_come_from_far_have_more_edges() {
        let (table, lobe) = (CountTable::new(&medium(0.9, 1.0), 60), HenyeyGreenstein { g: 0.9 });
        let mean = |distance: f64, turn: Option<f64>| {
            let cell = cell(&table, lobe, distance, turn);
            (1..60).map(|n| f64::from(n) * probability(&table, &cell, n)).sum::<f64>()
        };
        let growing = [(0.1, Some(1.0)), (4.0, Some(1.0)), (4.0, Some(0.7)), (4.0, Some(-1.0)), (12.0, Some(-1.0))];
        let means = growing.map(|(distance, turn)| mean(distance, turn));
        assert!(means.is_sorted() && means[0] < 1.5, "{means:.2?}");
        // More is absorbed of what is scattered often.
        let absorbing = CountTable::new(&medium(0.9, 0.5), 60);
        let cell = cell(&absorbing, lobe, 4.0, Some(0.7));
        assert!((1..60).map(|n| f64::from(n) * probability(&absorbing, &cell, n)).sum::<f64>() < means[2] - 1.0);
    }

    #[test]
    fn the_counts_of_the_paper_are_poisson_numbers() {
        let lobe = HenyeyGreenstein { g: 0.3 };
        let table = CountTable::poisson(lobe);
        let cell = cell(&table, lobe, 3.0, Some(0.4));
        for (n, expected) in [(1, 1.0), (2, 3.0), (3, 4.5), (5, 3.375)] {
            let found = probability(&table, &cell, n);
            assert!((found - expected * (-3.0_f64).exp()).abs() < 1e-6, "{n} edges: {found}");
        }
    }
}
