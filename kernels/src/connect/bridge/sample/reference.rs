//! Making bridges, in f64 (Schuessler, Hanika, Dachsbacher, EGSR 2024; the aligned roll is our own).
//!
//! ```text
//! count:  u < e:  N = 1 + floor(v room);      else  N from the table at mu_t s and gamma
//! walk:   y_0 = 0,  d_0 = z;      y_{k+1} = y_k - ln(1 - u) d_k,    d_{k+1} = d_k turned by the phase function
//! choice: p_ij = (1 - e) S_ij / sum S + e / M^2,   weight = 1 / (M^2 p_ij),   S = G(first) F(last) + G(last) F(first)
//! ends:   y_k = y_N - y_{N-k}  if  u >= P(first)
//! bridge: x_k = x + s / |y_N| * ((y_k . e) w + (y_k . p) a + (y_k . q) b)
//! roll:   tan(psi / 2) = sqrt((a - b) / (a + b)) tan(pi (u - 1/2)),       a = 1 + g^2 - 2 g cos beta cos gamma,
//!                                                                         b = 2 g sin beta sin gamma
//! ```
//!
//! The walk is chosen among M^2: alternative i of the turns of its first N / 2 edges, rounded down, with alternative j of
//! those of the others. There e is [`INDIFFERENT`].
//!
//! In the bridge, e points to the end of the walk, p is the unit part of its first direction across e, and q = e x p.
//! Of several lobes by which the phase function rolls, u first selects the one of g in proportion to their shares, and
//! is stretched to (0, 1).

use core::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3};

use crate::columns::paths::LastSurfaceColumns;
use crate::columns::queues::Candidate;
use crate::connect::bridge::reference::{Start, cell, first_share, roll_coefficients, room};
use crate::connect::bridge::suit::{LEAST_COSINE, SHORTER_SIDE};
use crate::connect::bridge::{Bridge, INDIFFERENT, MOST_ALTERNATIVES, Roll, counts};
use crate::connect::buckets::{self, BuildColumns, CountColumns};
use crate::connect::sequence::Draws;
use crate::emission::reference::normal;
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
        let draws = Draws::new(step, paths, lane);
        let on_surface = solid && is_on_surface(last_surface, lane, draws.depth);
        let (from, point) = start_and_point(&connection, draws.depth, on_surface);
        let medium = medium.twin_of_connections(immersion.hero.rows()[lane] as usize);
        let inserted = count_edges(bridge, &medium, lengths, &from, point, &draws);
        count.rows_mut()[row] = inserted.unwrap_or(buckets::DROPPED);
    }
}

/// The twin; see [`BuildKernel`](super::BuildKernel).
pub fn build(step: Step, columns: BuildColumns<'_, '_, Bridge>) {
    let BuildColumns { technique: bridge, medium, lights, solid, paths, last_surface, .. } = columns;
    let BuildColumns { connections, buckets, candidates, chains, .. } = columns;
    let mut inserted = Vec::new();
    for bucket in buckets.buckets() {
        for row in bucket.rows() {
            let connection = connections.row(buckets.order.rows()[row] as usize);
            let lane = connection.lane as usize;
            let draws = Draws::new(step, paths, lane);
            inserted.clear();
            inserted.resize(bucket.inserted, DVec3::ZERO);
            let on_surface = solid && is_on_surface(last_surface, lane, draws.depth);
            let (from, point) = start_and_point(&connection, draws.depth, on_surface);
            let normal = lights
                .map(|lights| normal(&lights.emitters()[connection.emitter as usize], point, point - from.position));
            let (phase, end) = (medium.phase.twin(), End { point, normal });
            let weight = place(bridge, phase, &from, &end, &draws, &mut inserted);

            candidates.set_row(row, connection);
            chains.resampling.rows_mut()[row] = weight as f32;
            for (vertex, position) in chains.vertices.iter_mut().zip(&inserted) {
                vertex.set_row(row, position.as_vec3().to_array());
            }
        }
    }
}

/// The start of a connection, at `depth`, and its light point `[m]`. A direction whose length is off by a rounding of f32
/// would hide how sharply counts and rolls depend on small turns.
fn start_and_point(connection: &Candidate, depth: u32, on_surface: bool) -> (Start, DVec3) {
    let exact = |v: [f32; 3]| DVec3::from(v.map(f64::from));
    let (position, arriving) = (exact(connection.start), exact(connection.arriving).normalize());
    (Start { depth, position, arriving, on_surface }, exact(connection.point))
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

    /// The numbers behind the length of edge `k`, counted from 0, and behind cosine and azimuth of the turn at its end,
    /// in one of its alternatives.
    pub fn edge(&self, k: usize, alternative: usize) -> [f64; 3] {
        let [length, azimuth, cosines @ ..] = self.uniforms(random::BRIDGE_WALK.nth(k as u32));
        [length, cosines[alternative], azimuth + alternative as f64 / MOST_ALTERNATIVES as f64]
    }

    /// The numbers behind which walk of several `edges` is chosen, and which end of it comes first.
    pub fn choices(&self, edges: usize) -> [f64; 2] {
        let [_, _, choices @ ..] = self.uniforms(random::BRIDGE_WALK.nth(edges as u32 - 1));
        choices
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

/// Where a bridge ends.
#[derive(Clone, Copy, Debug)]
pub struct End {
    /// The point `[m]`.
    pub point: DVec3,
    /// Unit normal of the light that it is on, on the side where the bridge arrives.
    pub normal: Option<DVec3>,
}

/// What a walk has to suit: the corner between the direction of arrival at the start and a bridge's axis, and the light.
struct Corner<'p> {
    phase: &'p dyn Phase,
    /// Unit direction in which the path arrives.
    arriving: DVec3,
    /// Unit direction from the start to the light point.
    axis: DVec3,
    /// Unit normal of the light.
    normal: Option<DVec3>,
}

/// Fills `inserted` with the inner vertices of a bridge. Returns its resampling weight.
pub fn place(
    bridge: &Bridge,
    phase: &dyn Phase,
    from: &Start,
    end: &End,
    draws: &Draws,
    inserted: &mut [DVec3],
) -> f64 {
    if inserted.is_empty() {
        return 1.0;
    }
    let (Start { position: start, arriving, .. }, End { point, normal }) = (*from, *end);
    let axis = (point - start).normalize_or_zero();
    let corner = Corner { phase, arriving, axis, normal };
    let edges = inserted.len() + 1;
    let (walk, weight) = chosen_walk(&corner, bridge.alternatives_of(edges), edges, draws);
    let walk = if from.roll(bridge) == Roll::Aligned { suited_end_first(&corner, walk, draws) } else { walk };
    let reached = walk[inserted.len()];
    let (end, first) = (reached.normalize(), walk[0].normalize());
    let across_end = (first - first.dot(end) * end).try_normalize().unwrap_or_else(|| frame(end).0);
    let third = end.cross(across_end);

    let (tangent, bitangent) = frame(axis);
    let arriving_azimuth = arriving.dot(bitangent).atan2(arriving.dot(tangent));
    let leaving = unrolled(first, end, axis);
    let azimuth = arriving_azimuth + psi(from.roll(bridge), phase, arriving, axis, leaving, draws.roll());
    let side = azimuth.cos() * tangent + azimuth.sin() * bitangent;
    let other_side = axis.cross(side);

    let scale = (point - start).length() / reached.length();
    for (vertex, free) in inserted.iter_mut().zip(&walk) {
        *vertex = start + scale * (free.dot(end) * axis + free.dot(across_end) * side + free.dot(third) * other_side);
    }
    weight
}

/// One of the free walks of several `edges`, as [`free_walk`] gives it, that so many `alternatives` of their pieces make,
/// and the resampling weight `1 / (M^2 p)` of its choice.
fn chosen_walk(corner: &Corner<'_>, alternatives: usize, edges: usize, draws: &Draws) -> (Vec<DVec3>, f64) {
    let pieces = (0..alternatives).flat_map(|i| (0..alternatives).map(move |j| [i, j]));
    let mut walks: Vec<_> = pieces.map(|pieces| free_walk(corner.phase, edges, pieces, draws)).collect();
    let suits: Vec<_> = walks.iter().map(|walk| walk_suit(corner, walk)).collect();
    let probabilities = probabilities(&suits);
    let chosen = choose(&probabilities, draws.choices(edges)[0]);
    (walks.swap_remove(chosen), 1.0 / (suits.len() as f64 * probabilities[chosen]))
}

/// S: how well a walk suits.
fn walk_suit(corner: &Corner<'_>, walk: &[DVec3]) -> f64 {
    let Corner { phase, arriving, axis, normal } = *corner;
    let [first, last] = unrolled_ends(walk, axis);
    let turns = |end: DVec3| {
        let g = f64::from(phase.lobe().g);
        let (a, b) = roll_coefficients(g, arriving, axis, end);
        1.0 / ((a - b) * (a + b + 1.0 - g * g))
    };
    let arrives = |end: DVec3| normal.map_or(1.0, |normal| facing(end, -normal, axis));
    turns(first) * arrives(last) + turns(last) * arrives(first)
}

/// F: about the mean cosine of the direction `end`, if it is turned about the `axis` to all sides, to a `normal`.
fn facing(end: DVec3, normal: DVec3, axis: DVec3) -> f64 {
    let u = end.dot(axis) * normal.dot(axis);
    let t = 2.0 / PI * end.cross(axis).length() * normal.cross(axis).length();
    let [longer, shorter] = if u.abs() > t { [u.abs(), t] } else { [t, u.abs()] };
    (u + longer + f64::from(SHORTER_SIDE) * shorter) / 2.0 + f64::from(LEAST_COSINE)
}

/// The probabilities of walks that suit as well as this: in proportion to that, but for a share of [`INDIFFERENT`],
/// which is theirs alike.
fn probabilities(suits: &[f64]) -> Vec<f64> {
    let (sum, indifferent) = (suits.iter().sum::<f64>(), f64::from(INDIFFERENT));
    suits.iter().map(|suit| (1.0 - indifferent) * suit / sum + indifferent / suits.len() as f64).collect()
}

/// The last place before which the probabilities add up to `u` at most.
fn choose(probabilities: &[f64], u: f64) -> usize {
    let (mut before, mut chosen) = (0.0, 0);
    for (place, probability) in probabilities.iter().enumerate() {
        if before <= u {
            chosen = place;
        }
        before += probability;
    }
    chosen
}

/// The ends of the edges of a `walk` of several, the end first that suits the corner.
fn suited_end_first(corner: &Corner<'_>, walk: Vec<DVec3>, draws: &Draws) -> Vec<DVec3> {
    let edges = walk.len();
    let [first, last] = unrolled_ends(&walk, corner.axis);
    let share = first_share(corner.phase, corner.arriving, corner.axis, first, last);
    let kept = draws.choices(edges)[1] < share;
    let reached = walk[edges - 1];
    let turned = |k: usize| if k == edges { reached } else { reached - walk[edges - 1 - k] };
    if kept { walk } else { (1..=edges).map(turned).collect() }
}

/// The directions of the first and the last edge of a walk of several, as they are to the `axis` of its bridge, each at
/// any azimuth.
fn unrolled_ends(walk: &[DVec3], axis: DVec3) -> [DVec3; 2] {
    let reached = walk[walk.len() - 1];
    let edges = [walk[0], reached - walk[walk.len() - 2]];
    edges.map(|edge| unrolled(edge.normalize(), reached.normalize(), axis))
}

/// A direction at the angle to a bridge's `axis` that the walk's `edge` has to its `end`, at any azimuth; all are unit
/// vectors.
fn unrolled(edge: DVec3, end: DVec3, axis: DVec3) -> DVec3 {
    edge.dot(end) * axis + edge.cross(end).length() * frame(axis).0
}

/// The ends of `edges` edges of a walk that starts at the origin along z, with flights of unit rate. Half of the edges,
/// rounded down, are of the alternative `pieces[0]`, those behind them of `pieces[1]`. Azimuths are those of a frame
/// that turns with the walk, and is that of the axes in the beginning.
fn free_walk(phase: &dyn Phase, edges: usize, pieces: [usize; 2], draws: &Draws) -> Vec<DVec3> {
    let (mut position, mut frame) = (DVec3::ZERO, DMat3::IDENTITY);
    let mut ends = Vec::with_capacity(edges);
    for k in 0..edges {
        let alternative = pieces[usize::from(k >= edges / 2)];
        let [length, cosine, azimuth] = draws.edge(k, alternative);
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
mod tests;
