//! A field within its [even part](super::known): a medium of one extinction, for eight rows.
//!
//! To the bit what [`FieldX8`](super::FieldX8) says of segments that stay there, so that it does not matter which of
//! them a batch was asked of; but neither points in cells nor strata have to be found.

use glam::DVec3;
use wide::f32x8;

use super::Field;
use super::axis::{FieldAxis, LEAST_DEPTH};
use super::known::EvenPart;
use super::map::Map;
use crate::lanes;
use crate::media::lanes::Crowding;
use crate::media::{AxisX8, MediumX8};
use crate::transcendental::neg_ln;
use crate::vec3::Vec3x8;

/// The even part of a field in one channel per row.
#[derive(Clone, Copy)]
pub struct EvenX8<'a> {
    field: &'a Field,
    /// Extinction where the hue is 1 [1/m].
    extinction: f32x8,
    /// Extinction over that of the field.
    hue: f32x8,
    /// The same over that of the clearest channel.
    over_clearest: f32x8,
    /// Largest optical depth of a segment.
    most_depth: f32x8,
}

/// Eight segments in it, and how far seeds have got on them.
#[derive(Clone, Copy)]
pub struct EvenAxis<'a> {
    medium: EvenX8<'a>,
    /// Length `[m]`.
    length: f32x8,
    /// The place reached, as a share of the length.
    place: f32x8,
}

impl<'a> EvenX8<'a> {
    /// That of a `field` in channels of which the extinction is `hue` of the field's. A field without an even part has an
    /// empty one, of any extinction.
    #[inline(always)]
    pub fn new(field: &'a Field, hue: f32x8) -> Self {
        Self {
            field,
            extinction: f32x8::splat(field.even.as_ref().map_or(0.0, |even| even.extinction)),
            hue,
            over_clearest: hue * f32x8::splat(1.0 / field.clearest()),
            most_depth: field.most_depth(hue),
        }
    }

    /// Optical depth of segments of this `length` `[m]`.
    #[inline(always)]
    pub fn depth(self, length: f32x8) -> f32x8 {
        (self.extinction * length * self.hue).fast_max(f32x8::splat(LEAST_DEPTH))
    }

    /// Which segments, from a point along all of a `way` `[m]`, stay in the part, and their optical depths.
    #[inline(always)]
    pub fn stays(self, from: Vec3x8, way: Vec3x8) -> (f32x8, f32x8) {
        if self.field.even.is_none() {
            return (f32x8::ZERO, f32x8::ZERO);
        }
        let start = self.field.in_cells(from);
        let stays = self.field.in_even_part(start, start + self.field.to_cells.directions(way));
        (stays, self.depth(way.length_squared().sqrt()))
    }

    /// Which segments let through just what weights take them for: those that stay in the part and are not too deep. Of
    /// these nothing is left to estimate.
    #[inline(always)]
    pub fn settles(self, from: Vec3x8, way: Vec3x8) -> f32x8 {
        let (stays, depth) = self.stays(from, way);
        stays & depth.simd_le(self.most_depth)
    }
}

impl<'a> MediumX8 for EvenX8<'a> {
    type Axis = EvenAxis<'a>;
    type Ray = FieldAxis<'a>;
    type Even = Self;

    const VARIES: bool = true;

    #[inline(always)]
    fn axis(self, _: Vec3x8, _: Vec3x8, length: f32x8) -> EvenAxis<'a> {
        EvenAxis { medium: self, length, place: f32x8::ZERO }
    }

    #[inline(always)]
    fn ray(self, from: Vec3x8, direction: Vec3x8) -> FieldAxis<'a> {
        // It leaves the part.
        FieldAxis::ray(self.field, self.hue, from, direction)
    }

    #[inline(always)]
    fn optical_depth(self, _: Vec3x8, _: Vec3x8, length: f32x8) -> f32x8 {
        self.depth(length).fast_min(self.most_depth)
    }

    #[inline(always)]
    fn optical_depth_along(self, _: f32x8, summed: f32x8) -> f32x8 {
        summed * self.hue
    }

    #[inline(always)]
    fn over_clearest(self) -> f32x8 {
        self.over_clearest
    }

    #[inline(always)]
    fn extinction(self, _: Vec3x8) -> f32x8 {
        self.extinction * self.hue
    }

    #[inline(always)]
    fn crowding(self, edges: usize, arc: f32x8, depth: f32x8, log_extinction: f32x8) -> Crowding {
        Crowding::with_hue(self.hue, edges, arc, depth, log_extinction)
    }

    #[inline(always)]
    fn log_extinction_along(self, events: usize, log_extinction: f32x8) -> f32x8 {
        f32x8::splat(-(events as f32)) * neg_ln(self.hue) + log_extinction
    }

    #[inline(always)]
    fn is_even_at(self, _: Vec3x8) -> f32x8 {
        lanes::mask(lanes::ALL)
    }

    #[inline(always)]
    fn as_even(self) -> Self {
        self
    }
}

impl AxisX8 for EvenAxis<'_> {
    const VARIES: bool = true;

    #[inline(always)]
    fn depth(&self, _: f32x8) -> f32x8 {
        self.medium.depth(self.length)
    }

    #[inline(always)]
    fn depths(&self, along: f32x8, most: f32x8) -> [f32x8; 2] {
        let until = self.medium.extinction * (along / self.length) * self.length * self.medium.hue;
        [until, self.depth(most)]
    }

    #[inline(always)]
    fn extinction(&self, _: f32x8) -> f32x8 {
        self.medium.extinction * self.medium.hue
    }

    #[inline(always)]
    fn advance(&mut self, depth: f32x8) -> f32x8 {
        let from = self.place;
        self.place += depth / (self.length * self.medium.hue) / self.medium.extinction;
        (self.place - from) * self.length
    }

    #[inline(always)]
    fn even(&self) -> (f32x8, f32x8) {
        (lanes::mask(lanes::ALL), self.reached())
    }

    #[inline(always)]
    fn reached(&self) -> f32x8 {
        self.medium.extinction * self.medium.hue
    }
}

/// How far segments in the even part of a field may go before they are deeper than some limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// The part.
    part: EvenPart,
    /// From the world to the cells in which it counts.
    to_cells: Map,
    /// Longest segment `[m]`.
    distance: f32,
}

/// By how much longer: which segments are within a limit exactly is for others to decide.
const SLACK: f32 = 1.001;

impl Reach {
    /// That of segments of no more than `depth` in the clearest channel of a `field`; none if there is no even part, or
    /// no limit.
    pub fn new(field: &Field, depth: f32) -> Option<Self> {
        let part = field.even.filter(|_| depth.is_finite())?;
        Some(Self { part, to_cells: field.to_cells, distance: SLACK * depth / (part.extinction * field.clearest()) })
    }

    /// Which segments are not known to be deeper: short ones, and all that are not in the even part.
    #[inline(always)]
    pub fn may_hold(&self, from: Vec3x8, to: Vec3x8, squared_length: f32x8) -> f32x8 {
        let near = squared_length.simd_le(f32x8::splat(self.distance * self.distance));
        let [from, to] = [from, to].map(|end| self.part.holds(self.to_cells.points(end)));
        near | !(from & to)
    }

    /// Whether a segment is not known to be deeper, for twins.
    pub fn may_hold_one(&self, from: DVec3, to: DVec3) -> bool {
        let holds = |end: DVec3| self.part.holds_one(self.to_cells.point(end));
        from.distance(to) <= f64::from(self.distance) || !(holds(from) && holds(to))
    }
}

#[cfg(test)]
mod tests {
    use wide::u32x8;

    use super::*;
    use crate::media::MediumLanes as _;
    use crate::media::field::reference::FieldTwin;
    use crate::media::field::{ColouredFieldLanes, Interpolation, Leaf, Shape, Volume, Voxels};
    use crate::media::reference::Medium as _;
    use crate::phase::HenyeyGreenstein;
    use crate::random::{self, Stream};
    use crate::transmittance;

    /// A cube of 32^3 voxels of one density, from -1 to 1 m along each axis.
    fn grid(extinction: f32) -> Field {
        let origins = (0..64).map(|leaf| [0, 1, 2].map(|axis: usize| 8 * (leaf >> (2 * axis) & 3)));
        let leaves: Vec<Leaf> = origins.map(|origin| Leaf { origin, values: [1.0; 512].into() }).collect();
        let to_index = [0, 1, 2].map(|axis| {
            let mut row = [0.0, 0.0, 0.0, 15.5];
            row[axis] = 16.0;
            row
        });
        Field::grid(Voxels::new(&leaves, &to_index, Interpolation::Trilinear), extinction)
    }

    /// One, and a box.
    fn fields() -> [Field; 2] {
        let shape = Shape::block([[-1.0; 3], [1.0, 0.9, 0.8]]);
        let solid = Field::new(vec![Volume { shape: Some(shape), voxels: None, extinction: 40.0 }], 0.1);
        [grid(3.0), solid].map(|field| field.coloured([0.5, 1.0, 0.25]))
    }

    /// Numbers within +-`size`, other ones for every `seed`.
    fn points(seed: u32, size: f32) -> Vec3x8 {
        let numbers = |axis: u32| {
            f32x8::new(core::array::from_fn(|lane| {
                let [word, ..] = random::words(seed, lane as u32, axis, 7);
                size * (2.0 * random::uniform(word) - 1.0) as f32
            }))
        };
        Vec3x8::new(numbers(0), numbers(1), numbers(2))
    }

    /// Bits of what is asked of a medium about segments.
    fn answers(medium: impl MediumX8, from: Vec3x8, to: Vec3x8) -> Vec<[u32; 8]> {
        let length = (to - from).length_squared().sqrt();
        let mut axis = medium.axis(from, to, length);
        let (along, most) = (length * f32x8::splat(0.3), f32x8::splat(f32::INFINITY));
        let Crowding { log, scale } = medium.crowding(3, length, f32x8::splat(2.5), f32x8::splat(1.5));
        let [until, whole] = axis.depths(along, most);
        let depth = axis.depth(most);
        let at_once = { axis }.first_advance(depth * f32x8::splat(0.3), most);
        let steps = [0.1, 0.4, 0.2].map(|share| axis.advance(depth * f32x8::splat(share)));
        let [first, second, third] = steps;
        let (is_even, even) = axis.even();
        let found = [depth, until, whole, log, scale, first, second, third, is_even, even, axis.reached()];
        let [on_ray, _] = medium.ray(from, (to - from) * (f32x8::ONE / length)).depths(along, most);
        let more = [
            on_ray,
            axis.extinction(along),
            medium.extinction(to),
            medium.optical_depth(from, to, length),
            medium.optical_depth_along(length, depth),
            medium.over_clearest(),
            medium.log_extinction_along(4, f32x8::splat(1.5)),
        ];
        found.into_iter().chain(more).chain(at_once).map(|lanes| lanes.to_array().map(f32::to_bits)).collect()
    }

    #[test]
    fn it_says_the_same_as_the_field_to_the_bit() {
        for (number, field) in fields().iter().enumerate() {
            for seed in 0..500 {
                let [from, to] = [2 * seed, 2 * seed + 1].map(|seed| points(seed, 0.4));
                let medium = ColouredFieldLanes::new(field).in_channel(|| u32x8::splat(seed % 3));
                assert!(medium.stays_even([from, to], lanes::ALL), "field {number}, points {seed}");
                assert_eq!(answers(medium.as_even(), from, to), answers(medium, from, to), "field {number}, {seed}");
                // Where another row leaves the even part, strata are added up.
                let mut outside = to.x.to_array();
                outside[3] = 9.0;
                let mixed = Vec3x8::new(f32x8::new(outside), to.y, to.z);
                assert!(
                    !medium.stays_even([from, mixed], lanes::ALL) && medium.stays_even([from, mixed], lanes::ALL & !8)
                );
                for (even, mixed) in answers(medium.as_even(), from, to).iter().zip(answers(medium, from, mixed)) {
                    assert_eq!(even[..3], mixed[..3], "field {number}, {seed}");
                }
            }
        }
    }

    #[test]
    fn what_it_settles_lets_through_what_weights_take_it_for() {
        let [shallow, solid] = fields();
        for (number, field) in [shallow, solid, grid(100.0)].iter().enumerate() {
            let [mut settled, mut deep] = [0, 0];
            for seed in 0..400 {
                let [from, to] = [2 * seed, 2 * seed + 1].map(|seed| points(seed, 1.2));
                let settles = lanes::bits(EvenX8::new(field, f32x8::ONE).settles(from, to - from));
                for lane in 0..lanes::LANES {
                    let ends = [from, to]
                        .map(|v| DVec3::from([v.x, v.y, v.z].map(|component| f64::from(component.to_array()[lane]))));
                    let stream = Stream::new(seed, lane as u32, 1, 2, 3);
                    let estimate = transmittance::reference::estimate(field, None, ends[0], ends[1], stream);
                    if settles >> lane & 1 == 1 {
                        settled += 1;
                        assert!(
                            estimate.iter().all(|factor| (factor - 1.0).abs() < 1e-6),
                            "field {number}, {ends:?}: {estimate:?}"
                        );
                    } else if field.even_between(ends[0], ends[1]).is_some() {
                        deep += 1;
                        assert!(estimate[1] < 1.0, "field {number}, {ends:?}: {estimate:?}");
                    }
                }
            }
            assert!(settled > 30 && (deep > 100) == (number == 2), "field {number}: {settled}, {deep} too deep");
        }
    }

    #[test]
    fn reach_refuses_what_is_known_to_be_deeper_and_nothing_else() {
        for field in fields() {
            let twin =
                FieldTwin { field: &field, hue: f64::from(field.clearest()), phase: &HenyeyGreenstein { g: 0.0 } };
            let reach = Reach::new(&field, 0.4).expect("an even part");
            let mut refused = 0;
            for seed in 0..400 {
                let [from, to] = [2 * seed, 2 * seed + 1].map(|seed| points(seed, 1.2));
                let holds = reach.may_hold(from, to, (to - from).length_squared()).to_array();
                for (lane, holds) in holds.map(|mask| mask.to_bits() != 0).into_iter().enumerate() {
                    let [from, to] = [from, to]
                        .map(|v| DVec3::from([v.x, v.y, v.z].map(|component| f64::from(component.to_array()[lane]))));
                    assert_eq!(holds, reach.may_hold_one(from, to), "{from} to {to}");
                    assert!(holds || twin.optical_depth(from, to) > 0.4, "{from} to {to}");
                    refused += u32::from(!holds);
                }
            }
            assert!(refused > 100, "{refused} segments");
            assert_eq!(Reach::new(&field, f32::INFINITY), None);
        }
    }
}
