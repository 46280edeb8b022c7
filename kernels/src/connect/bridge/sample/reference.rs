//! Making bridges, in f64 (Schuessler, Hanika, Dachsbacher, EGSR 2024; the aligned roll is our own).
//!
//! ```text
//! count:  u < e:  N = 1 + floor(v room);      else  N from the table at mu_t s and gamma
//! walk:   y_0 = 0,  d_0 = z;      y_{k+1} = y_k - ln(1 - u) d_k,    d_{k+1} = d_k turned by the phase function
//! ends:   y_k = y_N - y_{N-k}  if  u >= P(first)
//! bridge: x_k = x + s / |y_N| * ((y_k . e) w + (y_k . p) a + (y_k . q) b)
//! roll:   tan(psi / 2) = sqrt((a - b) / (a + b)) tan(pi (u - 1/2)),       a = 1 + g^2 - 2 g cos beta cos gamma,
//!                                                                         b = 2 g sin beta sin gamma
//! ```
//!
//! where e points to the end of the walk, p is the unit part of its first direction across e, and q = e x p. Of several
//! lobes by which the phase function rolls, u first selects the one of g in proportion to their shares, and is
//! stretched to (0, 1).

use core::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3};

use crate::columns::paths::LastSurfaceColumns;
use crate::connect::bridge::reference::{Start, cell, first_share, roll_coefficients, room};
use crate::connect::bridge::{Bridge, Roll, counts};
use crate::connect::buckets::{self, BuildColumns, CountColumns};
use crate::connect::sequence::Draws;
use crate::media::reference::Medium;
use crate::phase::reference::{Phase, frame};
use crate::{PathLengths, Step, random};

/// The twin; see [`CountKernel`](super::CountKernel).
pub fn count(step: Step, columns: CountColumns<'_, '_, Bridge>) {
    let CountColumns { technique: bridge, medium, lengths, solid, paths, immersion, last_surface, .. } = columns;
    let CountColumns { connections, count, .. } = columns;
    for row in 0..connections.len {
        let connection = connections.row(row);
        let lane = connection.lane as usize;
        let [start, arriving, point] =
            [connection.start, connection.arriving, connection.point].map(|v| DVec3::from(v.map(f64::from)));
        let draws = Draws::new(step, paths, lane);
        let on_surface = solid && is_on_surface(last_surface, lane, draws.depth);
        let from = Start { depth: draws.depth, position: start, arriving, on_surface };
        let medium = medium.twin_of_connections(immersion.hero.rows()[lane] as usize);
        let inserted = count_edges(bridge, &medium, lengths, &from, point, &draws);
        count.rows_mut()[row] = inserted.unwrap_or(buckets::DROPPED);
    }
}

/// The twin; see [`BuildKernel`](super::BuildKernel).
pub fn build(step: Step, columns: BuildColumns<'_, '_, Bridge>) {
    let BuildColumns { technique: bridge, medium, solid, paths, last_surface, .. } = columns;
    let BuildColumns { connections, buckets, candidates, chains, .. } = columns;
    let mut inserted = Vec::new();
    for bucket in buckets.buckets() {
        for row in bucket.rows() {
            let connection = connections.row(buckets.order.rows()[row] as usize);
            let lane = connection.lane as usize;
            let [start, arriving, point] =
                [connection.start, connection.arriving, connection.point].map(|v| DVec3::from(v.map(f64::from)));
            // A length that is off by a rounding of f32 would hide how sharply the roll depends on small angles.
            let arriving = arriving.normalize();
            let draws = Draws::new(step, paths, lane);
            inserted.clear();
            inserted.resize(bucket.inserted, DVec3::ZERO);
            let on_surface = solid && is_on_surface(last_surface, lane, draws.depth);
            let from = Start { depth: draws.depth, position: start, arriving, on_surface };
            place(bridge, medium.phase.twin(), &from, point, &draws, &mut inserted);

            candidates.set_row(row, connection);
            for (vertex, position) in chains.vertices.iter_mut().zip(&inserted) {
                vertex.set_row(row, position.as_vec3().to_array());
            }
        }
    }
}

/// Whether the start at `depth` is on a surface.
fn is_on_surface(last_surface: &LastSurfaceColumns<'_>, lane: usize, depth: u32) -> bool {
    last_surface.depth.rows()[lane] == depth
}

impl Draws {
    /// The numbers that choose between the two distributions of the count, from the chosen one, and the knot in optical
    /// depth.
    pub fn count(&self) -> [f64; 3] {
        let [which, count, _, along] = self.uniforms(random::BRIDGE_COUNT);
        [which, count, along]
    }

    /// The number behind the roll about the axis.
    pub fn roll(&self) -> f64 {
        self.uniforms(random::BRIDGE_COUNT)[2]
    }

    /// The numbers behind the length of edge `k`, counted from 0, and behind cosine and azimuth of the turn at its end.
    pub fn edge(&self, k: usize) -> [f64; 3] {
        let [length, cosine, azimuth, _] = self.uniforms(random::BRIDGE_WALK.nth(k as u32));
        [length, cosine, azimuth]
    }

    /// The number behind which end of a walk of several `edges` comes first.
    pub fn end(&self, edges: usize) -> f64 {
        self.uniforms(random::BRIDGE_WALK.nth(edges as u32 - 1))[3]
    }
}

/// Number of vertices to insert, one less than edges, from `start` to the light `point` `[m]`; None if that exceeds
/// the room.
pub fn count_edges(
    bridge: &Bridge,
    medium: &dyn Medium,
    lengths: PathLengths,
    start: &Start,
    point: DVec3,
    draws: &Draws,
) -> Option<u32> {
    let room = room(bridge, lengths.max, start.depth);
    let [which, count, along] = draws.count();
    if room == 0 || medium.optical_depth(start.position, point) > f64::from(bridge.max_depth) * medium.over_clearest() {
        return None;
    }
    if which < f64::from(bridge.defensive) {
        return Some((count * f64::from(room)).floor() as u32);
    }
    let across = (which - f64::from(bridge.defensive)) / (1.0 - f64::from(bridge.defensive));
    let cell = cell(bridge, medium, start, point);
    let inserted = counts::reference::draw(&bridge.counts, &cell, [along, across], count);
    (inserted < room).then_some(inserted)
}

/// Fills `inserted` with the inner vertices of a bridge from `start` to `point` `[m]`.
pub fn place(bridge: &Bridge, phase: &dyn Phase, from: &Start, point: DVec3, draws: &Draws, inserted: &mut [DVec3]) {
    let Start { position: start, arriving, .. } = *from;
    let axis = (point - start).normalize_or_zero();
    let walk = suited_walk(phase, inserted.len() + 1, from.roll(bridge), arriving, axis, draws);
    let reached = walk[inserted.len()];
    let (end, first) = (reached.normalize(), walk[0].normalize());
    let across_end = (first - first.dot(end) * end).try_normalize().unwrap_or_else(|| frame(end).0);
    let third = end.cross(across_end);

    let (tangent, bitangent) = frame(axis);
    let arriving_azimuth = arriving.dot(bitangent).atan2(arriving.dot(tangent));
    // Any roll will do to measure the angle between first edge and axis, which is that between it and the walk's end.
    let unrolled = first.dot(end) * axis + first.dot(across_end) * tangent;
    let azimuth = arriving_azimuth + psi(from.roll(bridge), phase, arriving, axis, unrolled, draws.roll());
    let side = azimuth.cos() * tangent + azimuth.sin() * bitangent;
    let other_side = axis.cross(side);

    let scale = (point - start).length() / reached.length();
    for (vertex, free) in inserted.iter_mut().zip(&walk) {
        *vertex = start + scale * (free.dot(end) * axis + free.dot(across_end) * side + free.dot(third) * other_side);
    }
}

/// The ends of the edges of a free walk, the end first that suits a bridge along `axis` from a start at which the path
/// is `arriving`.
fn suited_walk(phase: &dyn Phase, edges: usize, roll: Roll, arriving: DVec3, axis: DVec3, draws: &Draws) -> Vec<DVec3> {
    let walk = free_walk(phase, edges, draws);
    let [.., before, reached] = walk[..] else {
        return walk;
    };
    let end = reached.normalize();
    let frame_of = |axis: DVec3| {
        let (tangent, bitangent) = frame(axis);
        DMat3::from_cols(tangent, bitangent, axis)
    };
    // The frame does not matter: only angles to the axis are asked for.
    let to_axis = frame_of(axis) * frame_of(end).transpose();
    let [first, last] = [walk[0], reached - before].map(|edge| to_axis * edge.normalize());
    let kept = match roll {
        Roll::Uniform => true,
        Roll::Aligned => draws.end(edges) < first_share(phase, arriving, axis, first, last),
    };
    let turned = |k: usize| if k == edges { reached } else { reached - walk[edges - 1 - k] };
    if kept { walk } else { (1..=edges).map(turned).collect() }
}

/// The ends of `edges` edges of a walk that starts at the origin along z, with flights of unit rate. Azimuths are those
/// of a frame that turns with the walk, and is that of the axes in the beginning.
fn free_walk(phase: &dyn Phase, edges: usize, draws: &Draws) -> Vec<DVec3> {
    let (mut position, mut frame) = (DVec3::ZERO, DMat3::IDENTITY);
    let mut ends = Vec::with_capacity(edges);
    for k in 0..edges {
        let [length, cosine, azimuth] = draws.edge(k);
        position -= (1.0 - length).ln() * frame.z_axis;
        ends.push(position);
        frame *= DMat3::from_rotation_z(TAU * azimuth) * DMat3::from_rotation_y(phase.sample_cosine(cosine).acos());
    }
    ends
}

/// psi: the angle about the axis from the direction of arrival to the first edge, in (-pi, pi), for a number in (0, 1).
/// `first` is a unit vector at the first edge's angle to the axis, however it is rolled.
pub fn psi(roll: Roll, phase: &dyn Phase, arriving: DVec3, axis: DVec3, first: DVec3, u: f64) -> f64 {
    match roll {
        Roll::Uniform => TAU * (u - 0.5),
        Roll::Aligned => {
            let (g, u) = select(&phase.roll_lobes(), u);
            let (a, b) = roll_coefficients(g, arriving, axis, first);
            2.0 * (((a - b) / (a + b)).sqrt() * (PI * (u - 0.5)).tan()).atan()
        }
    }
}

/// The mean cosine of the lobe in whose interval `u` falls, when intervals as long as the shares are laid end to end,
/// and the place in there, (0, 1).
///
/// Where rounding keeps the shares from adding up to one, the last lobe gets what is left.
fn select(lobes: &[(f64, f64)], u: f64) -> (f64, f64) {
    let (mut below, last) = (0.0, lobes.len() - 1);
    for (share, g) in &lobes[..last] {
        if u < below + share {
            return (*g, (u - below) / share);
        }
        below += share;
    }
    let (share, g) = lobes[last];
    (g, (u - below) / share)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connect::bridge::reference::{count_probability, density, roll_density};
    use crate::media::Medium;
    use crate::media::reference::Homogeneous;
    use crate::phase::HenyeyGreenstein;
    use crate::phase::PhaseFunction;
    use crate::phase::henyey_greenstein::reference as lobe;

    fn bridge(g: f32) -> Bridge {
        let phase = PhaseFunction::henyey_greenstein(g);
        Bridge::new(Roll::Aligned, &Medium::homogeneous(1.0, [1.0; 3], phase), 30)
    }

    fn start(arriving: DVec3) -> Start {
        Start { depth: 2, position: DVec3::ZERO, arriving, on_surface: false }
    }

    fn draws(pixel: u32) -> Draws {
        Draws { pixel, sample: 3, depth: 2, seed: 1 }
    }

    #[test]
    fn counts_follow_their_probabilities() {
        let samples = 40_000;
        let limited = Bridge { max_inserted: 2, ..bridge(0.6) };
        let medium = &Homogeneous::new(1.0, &HenyeyGreenstein { g: 0.6 });
        for (bridge, way, max) in [(bridge(0.6), 2.4, 30), (bridge(0.6), 13.5, 8), (limited, 2.4, 30)] {
            let (lengths, way) = (PathLengths { min: 1, max }, way * DVec3::X);
            for start in [start(DVec3::Y), Start { on_surface: true, ..start(DVec3::Y) }] {
                let mut made = [0; 31];
                for pixel in 0..samples {
                    let inserted = count_edges(&bridge, medium, lengths, &start, way, &draws(pixel));
                    inserted.into_iter().for_each(|inserted| made[inserted as usize + 1] += 1);
                }
                for (edges, made) in made.into_iter().enumerate() {
                    let p = count_probability(&bridge, medium, max, &start, way, edges as u32);
                    let (expected, deviation) = (p * f64::from(samples), (p * f64::from(samples)).sqrt());
                    let case = format!("{edges} edges: {made}, not {expected}");
                    assert!((f64::from(made) - expected).abs() <= 4.5 * deviation, "{case}");
                }
            }
        }
    }

    #[test]
    fn without_room_bridges_are_dropped() {
        let count = |max: u32| {
            let lengths = PathLengths { min: 1, max };
            let medium = &Homogeneous::new(1.0, &HenyeyGreenstein { g: 0.5 });
            count_edges(&bridge(0.5), medium, lengths, &start(DVec3::X), DVec3::ZERO, &draws(0))
        };
        assert_eq!([1, 2, 3].map(count), [None, None, Some(0)]);
    }

    /// A phase function that rolls by three lobes.
    struct Mixture;

    impl Phase for Mixture {
        fn density(&self, cosine: f64) -> f64 {
            self.roll_lobes().into_iter().map(|(share, g)| share * lobe::density(g, cosine)).sum()
        }

        fn sample_cosine(&self, _: f64) -> f64 {
            unreachable!("only rolls are drawn")
        }

        fn forward_share(&self) -> f64 {
            self.roll_lobes().into_iter().map(|(share, g)| share * lobe::forward_share(g)).sum()
        }

        fn mean_cosine(&self) -> f64 {
            self.roll_lobes().into_iter().map(|(share, g)| share * g).sum()
        }

        fn roll_lobes(&self) -> Vec<(f64, f64)> {
            vec![(0.5, 0.9), (0.2, -0.7), (0.3, 0.0)]
        }
    }

    /// The share of rolls below an angle, drawn by an even spread of numbers, against the integral of the density.
    #[test]
    fn rolls_by_several_lobes_follow_their_density() {
        let (arriving, axis) = (DVec3::new(0.6, 0.0, 0.8), DVec3::Z);
        let first = |psi: f64| DVec3::new(0.9_f64.sin() * psi.cos(), 0.9_f64.sin() * psi.sin(), 0.9_f64.cos());
        let (numbers, steps) = (100_000, 8192);
        let roll = |u: f64| psi(Roll::Aligned, &Mixture, arriving, axis, first(0.0), u);
        let mut rolls: Vec<_> = (0..numbers).map(|k| roll((f64::from(k) + 0.5) / f64::from(numbers))).collect();
        rolls.sort_by(f64::total_cmp);
        let (width, mut share) = (TAU / f64::from(steps), 0.0);
        for k in 0..steps {
            let angle = -PI + (f64::from(k) + 0.5) * width;
            share += roll_density(&Mixture, arriving, axis, first(angle)) / f64::from(steps);
            let below = rolls.partition_point(|roll| *roll < angle + 0.5 * width);
            let found = below as f64 / f64::from(numbers);
            assert!((found - share).abs() < 5e-5, "{found} of all rolls are below {angle}, not {share}");
        }
    }

    /// What a share u of all rolls does not exceed, against the integral of the density.
    #[test]
    fn rolls_follow_their_density() {
        let (phase, arriving, axis) = (HenyeyGreenstein { g: 0.8 }, DVec3::new(0.6, 0.0, 0.8), DVec3::Z);
        let first = |psi: f64| DVec3::new(0.9_f64.sin() * psi.cos(), 0.9_f64.sin() * psi.sin(), 0.9_f64.cos());
        let width = TAU / 8192.0;
        let mut share = 0.0;
        for k in 0..8191 {
            let angle = -PI + (f64::from(k) + 0.5) * width;
            share += roll_density(&phase, arriving, axis, first(angle)) * width / TAU;
            if k % 512 == 511 {
                let found = psi(Roll::Aligned, &phase, arriving, axis, first(0.0), share);
                assert!((found - (angle + 0.5 * width)).abs() < 1e-4, "{found} at {angle}");
            }
        }
    }

    #[test]
    fn the_first_edge_is_rolled_away_from_the_direction_of_arrival() {
        let (start, point) = (DVec3::new(0.3, -1.0, 2.0), DVec3::new(1.1, 0.5, -0.7));
        let phase = HenyeyGreenstein { g: 0.6 };
        let (axis, arriving) = ((point - start).normalize(), DVec3::new(0.4, 0.5, -0.6).normalize());
        for (pixel, roll) in (0..50).flat_map(|pixel| [(pixel, Roll::Aligned), (pixel, Roll::Uniform)]) {
            let draws = draws(pixel);
            let mut inserted = [DVec3::ZERO; 3];
            let from = Start { position: start, ..self::start(arriving) };
            place(&Bridge { roll, ..bridge(0.6) }, &phase, &from, point, &draws, &mut inserted);
            let first = (inserted[0] - start).normalize();
            let across = |v: DVec3| (v - v.dot(axis) * axis).normalize();
            let (from, to) = (across(arriving), across(first));
            let found = from.cross(to).dot(axis).atan2(from.dot(to));
            let expected = psi(roll, &phase, arriving, axis, first, draws.roll());
            assert!((found - expected).abs() < 1e-9, "{found}, not {expected}");
        }
    }

    #[test]
    fn bridges_keep_the_shape_of_their_walk_from_one_of_its_ends() {
        let (start, point) = (DVec3::new(0.1, -0.4, 2.0), DVec3::new(1.0, 3.0, -1.0));
        let (bridge, phase) = (bridge(0.5), HenyeyGreenstein { g: 0.5 });
        let from = Start { position: start, ..self::start(DVec3::X) };
        let mut turned = 0;
        for pixel in 0..50 {
            let mut chain = [start; 6];
            place(&bridge, &phase, &from, point, &draws(pixel), &mut chain[1..5]);
            chain[5] = point;
            let walk = [vec![DVec3::ZERO], free_walk(&phase, 5, &draws(pixel))].concat();
            let scale = (point - start).length() / walk[5].length();
            let keeps = |at: &dyn Fn(usize) -> DVec3| {
                let pairs = (0..6).flat_map(|i| (0..i).map(move |j| (i, j)));
                let distances = pairs.map(|(i, j)| ((chain[i] - chain[j]).length(), (at(i) - at(j)).length()));
                // Handedness: a mirror image has the same distances.
                let volume = |at: &dyn Fn(usize) -> DVec3| (at(1) - at(0)).cross(at(2) - at(1)).dot(at(3) - at(2));
                let same_hand = volume(&|k| chain[k]) * volume(at) > 0.0;
                let mut far = distances.map(|(found, free)| (found - scale * free).abs() / (scale * free.max(1.0)));
                same_hand && far.all(|error| error < 1e-9)
            };
            let [as_drawn, from_its_end] = [keeps(&|k| walk[k]), keeps(&|k| walk[5] - walk[5 - k])];
            assert!(as_drawn != from_its_end, "{pixel}");
            turned += u32::from(from_its_end);
        }
        assert!((10..40).contains(&turned), "{turned} of 50");
    }

    /// E[h / p] = 1 for a density h of the inserted vertices: each uniform in a ball between the ends, small enough for
    /// the ratio to vary little, and nearer to one of them, which walks from the other end are not.
    #[test]
    fn bridges_follow_their_density() {
        let (start, point) = (DVec3::ZERO, DVec3::new(0.0, 0.6, 0.8));
        let arriving = DVec3::new(0.8, 0.0, 0.6);
        let (center, radius) = (start.lerp(point, 0.3), 0.5_f64);
        let h = 1.0 / (4.0 / 3.0 * PI * radius.powi(3));
        for (roll, g, inserted) in
            [(Roll::Uniform, 0.3, 1), (Roll::Aligned, 0.5, 1), (Roll::Aligned, -0.4, 1), (Roll::Aligned, 0.25, 2)]
        {
            let (bridge, from) = (Bridge { roll, ..bridge(g) }, self::start(arriving));
            let phase = HenyeyGreenstein { g };
            let medium = &Homogeneous::new(1.0, &phase);
            // Pairs of vertices are rarely both in the ball.
            let samples = if inserted == 1 { 100_000 } else { 1_000_000 };
            let (mut sum, mut squares) = (0.0, 0.0);
            // Given the number of edges, so without its probability.
            let probability = count_probability(&bridge, medium, 9, &from, point, inserted as u32 + 1);
            for pixel in 0..samples {
                let mut chain = vec![start; inserted + 2];
                place(&bridge, &phase, &from, point, &draws(pixel), &mut chain[1..=inserted]);
                chain[inserted + 1] = point;
                if chain[1..=inserted].iter().any(|vertex| (*vertex - center).length() > radius) {
                    continue;
                }
                let p = density(&bridge, medium, 9, &from, &chain, 1.0 / probability).value();
                let ratio = h.powi(inserted as i32) / p;
                sum += ratio;
                squares += ratio * ratio;
            }
            let samples = f64::from(samples);
            let mean = sum / samples;
            let error = ((squares / samples - mean * mean) / samples).sqrt();
            let case = format!("{roll:?}, g = {g}, {inserted} inserted: {mean} +- {error}");
            assert!((mean - 1.0).abs() < 4.0 * error && error < 0.03, "{case}");
        }
    }
}
