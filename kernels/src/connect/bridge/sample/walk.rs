//! The free walks of eight bridges, each chosen among all that pieces make.
//!
//! ```text
//! U_1 .. U_M = walks of the first N / 2 edges along z, with a turn at their end;   V_1 .. V_M = walks of the others along z
//! for all i, j:  y_N = end of U_i + R_i (end of V_j)         R_i: from z and its frame to the end of U_i and its frame
//!                S_ij = how well the angles of first and last edge to y_N suit
//! p_ij = (1 - eps) S_ij / sum of all S + eps / M^2,          resampling weight = 1 / (M^2 p_ij)
//! ```
//!
//! 1. Alternatives share lengths and azimuths, but for a share of a turn, so that one block of numbers makes an edge of
//!    all. What is drawn of all edges waits in their places: edges need each other's directions, but not each other's
//!    numbers, whose logarithms would hold up the turns.
//! 2. Alternatives are walked in lockstep: one edge of each, so that none waits for the turns of another.
//! 3. Angles are the same in every frame: seen from the end of U_i, a walk is a sum of two vectors.

use bumpalo::Bump;
use wide::f32x8;

use crate::connect::bridge::{INDIFFERENT, MOST_ALTERNATIVES};
use crate::connect::sequence::Sequence;
use crate::phase::{PhaseX8, PlaneAngle};
use crate::random;
use crate::transcendental::{neg_ln, sin_cos_turn};
use crate::vec3::Vec3x8;

/// Alternatives of eight rows.
type Each<T> = [T; MOST_ALTERNATIVES];

/// An edge of eight walks in all their alternatives.
#[derive(Clone, Copy)]
struct Edge {
    /// Length, in mean free paths.
    length: f32x8,
    /// Numbers behind the cosine of the turn at its end.
    cosine: Each<f32x8>,
    /// Sine and cosine of the azimuth of the turn, in the first alternative.
    azimuth: [f32x8; 2],
    /// Where it ends.
    end: Each<Vec3x8>,
}

impl Edge {
    const EMPTY: Self = Self {
        length: f32x8::ZERO,
        cosine: [f32x8::ZERO; MOST_ALTERNATIVES],
        azimuth: [f32x8::ZERO; 2],
        end: [Vec3x8::ZERO; MOST_ALTERNATIVES],
    };
}

/// Room for the walks of eight bridges.
pub struct Pieces<'q> {
    edges: &'q mut [Edge],
}

impl<'q> Pieces<'q> {
    /// Room for bridges of `longest` inserted vertices.
    pub fn new_in(arena: &'q Bump, longest: usize) -> Self {
        Self { edges: arena.alloc_slice_fill_copy(longest + 1, Edge::EMPTY) }
    }
}

/// A free walk that leaves along z, chosen among those of `M` alternatives.
pub(super) struct FreeWalk<'p, const M: usize> {
    /// Where it ends, y_N.
    pub end: Vec3x8,
    /// Unit direction of its last edge.
    pub last: Vec3x8,
    /// Resampling weight, > 0.
    pub resampling: f32x8,
    /// The number behind which end comes first.
    pub choice: f32x8,
    /// The edges of the walks it is chosen from.
    edges: &'p [Edge],
    /// Which alternatives its pieces are.
    pieces: [f32x8; 2],
    /// Where the first ends.
    joint: Joint,
}

/// Where a piece ends.
#[derive(Clone, Copy)]
struct Joint {
    position: Vec3x8,
    /// Unit vectors that turn along with the walk, the last of which is the direction in which it goes on.
    frame: [Vec3x8; 3],
}

impl Joint {
    /// Where pieces begin.
    const START: Self = Self {
        position: Vec3x8::ZERO,
        frame: [
            Vec3x8 { x: f32x8::ONE, y: f32x8::ZERO, z: f32x8::ZERO },
            Vec3x8 { x: f32x8::ZERO, y: f32x8::ONE, z: f32x8::ZERO },
            Vec3x8 { x: f32x8::ZERO, y: f32x8::ZERO, z: f32x8::ONE },
        ],
    };

    /// What a piece that goes on from here calls the vector `v`.
    #[inline(always)]
    fn seen_from_here(&self, v: Vec3x8) -> Vec3x8 {
        let [x, y, z] = self.frame;
        Vec3x8::new(x.dot(v), y.dot(v), z.dot(v))
    }

    /// `to`, and the vector that a piece that goes on from here calls `v`.
    #[inline(always)]
    fn add(&self, v: Vec3x8, to: Vec3x8) -> Vec3x8 {
        self.frame[0].mul_add(v.x, self.frame[1].mul_add(v.y, self.frame[2].mul_add(v.z, to)))
    }
}

impl<'p, const M: usize> FreeWalk<'p, M> {
    /// A walk of so many `edges`, two or more, chosen among those of which the angles of first and last edge to the axis
    /// `suit` the bridge as well as the function says, > 0.
    #[inline(always)]
    pub fn new(
        sequence: &Sequence,
        phase: &impl PhaseX8,
        pieces: &'p mut Pieces<'_>,
        edges: usize,
        suit: impl Fn(PlaneAngle, PlaneAngle) -> f32x8,
    ) -> Self {
        let edges = &mut pieces.edges[..edges];
        let [walk, end] = draw(sequence, edges);
        let (before, behind) = edges.split_at_mut(edges.len() / 2);
        let (inner, last) = behind.split_at_mut(behind.len() - 1);
        let (firsts, mut seconds) = (follow::<M>(phase, before), follow::<M>(phase, inner));
        for Joint { position, frame } in &mut seconds {
            *position = frame[2].mul_add(last[0].length, *position);
        }
        let (pieces, resampling) = choose(&firsts, &seconds, walk, suit);
        let (joint, second) = (pick_joint(pieces[0], &firsts), pick_joint(pieces[1], &seconds));
        Self {
            end: joint.add(second.position, joint.position),
            last: joint.add(second.frame[2], Vec3x8::ZERO),
            resampling,
            choice: end,
            edges,
            pieces,
            joint,
        }
    }

    /// Where its inner vertex `k` is, counted from 0.
    #[inline(always)]
    pub fn vertex(&self, k: usize) -> Vec3x8 {
        let ([first, second], end) = (self.pieces, &self.edges[k].end[..M]);
        if k < self.edges.len() / 2 { pick(first, end) } else { self.joint.add(pick(second, end), self.joint.position) }
    }
}

/// Draws all edges, and the numbers that choose a walk and the end that comes first: those of the last edge that make no
/// turn.
#[inline(always)]
fn draw(sequence: &Sequence, edges: &mut [Edge]) -> [f32x8; 2] {
    let mut spare = [f32x8::ZERO; MOST_ALTERNATIVES];
    for (k, edge) in (0..).zip(edges) {
        let [length, azimuth, cosine @ ..] = sequence.uniforms(random::BRIDGE_WALK.nth(k));
        let (sin, cos) = sin_cos_turn(azimuth);
        (edge.length, edge.cosine, edge.azimuth) = (neg_ln(f32x8::ONE - length), cosine, [sin, cos]);
        spare = cosine;
    }
    spare
}

/// Follows all alternatives of a piece along its edges, and says where they go on.
#[inline(always)]
fn follow<const M: usize>(phase: &impl PhaseX8, edges: &mut [Edge]) -> [Joint; M] {
    let mut joints = [Joint::START; M];
    for Edge { length, cosine, azimuth: [sin, cos], end } in edges {
        let azimuths = [(*sin, *cos), (-*sin, -*cos)];
        for m in 0..M {
            let Joint { position, frame } = &mut joints[m];
            *position = frame[2].mul_add(*length, *position);
            *frame = phase.sample(cosine[m]).carry(*frame, azimuths[m]);
            end[m] = *position;
        }
    }
    joints
}

/// Chooses one of the walks by the number u. Gives which alternatives its pieces are, and its resampling weight.
#[inline(always)]
fn choose<const M: usize>(
    firsts: &[Joint; M],
    seconds: &[Joint; M],
    u: f32x8,
    suit: impl Fn(PlaneAngle, PlaneAngle) -> f32x8,
) -> ([f32x8; 2], f32x8) {
    if M == 1 {
        return ([f32x8::ZERO; 2], f32x8::ONE);
    }
    let mut suits = [[f32x8::ZERO; M]; M];
    let mut sum = f32x8::ZERO;
    for (joint, suits) in firsts.iter().zip(&mut suits) {
        let before = joint.seen_from_here(joint.position);
        let first = joint.seen_from_here(Joint::START.frame[2]);
        for (second, walk) in seconds.iter().zip(suits) {
            let (_, along) = (before + second.position).length_and_direction();
            let [first, last] = [first, second.frame[2]].map(|edge| PlaneAngle::between(edge, along));
            *walk = suit(first, last);
            sum += *walk;
        }
    }
    let mean = sum * f32x8::splat(1.0 / (M * M) as f32);
    let [suited, any] = [1.0 - INDIFFERENT, INDIFFERENT].map(f32x8::splat);
    let (bar, mut below) = (u * sum, f32x8::ZERO);
    let (mut pieces, mut own) = ([f32x8::ZERO; 2], f32x8::ONE);
    for (i, suits) in suits.iter().enumerate() {
        for (j, suit) in suits.iter().enumerate() {
            let (reached, share) = (bar.simd_ge(below), suit.mul_add(suited, mean * any));
            own = reached.select(share, own);
            pieces[0] = reached.select(f32x8::splat(i as f32), pieces[0]);
            pieces[1] = reached.select(f32x8::splat(j as f32), pieces[1]);
            below += share;
        }
    }
    (pieces, mean / own)
}

/// The alternative of this number.
#[inline(always)]
fn pick(number: f32x8, of: &[Vec3x8]) -> Vec3x8 {
    let mut picked = of[0];
    for (m, other) in of.iter().enumerate().skip(1) {
        picked = Vec3x8::select(number.simd_eq(f32x8::splat(m as f32)), *other, picked);
    }
    picked
}

/// The same of joints.
#[inline(always)]
fn pick_joint<const M: usize>(number: f32x8, of: &[Joint; M]) -> Joint {
    let axis = |axis: usize| pick(number, &of.map(|joint| joint.frame[axis]));
    Joint { position: pick(number, &of.map(|joint| joint.position)), frame: [axis(0), axis(1), axis(2)] }
}
