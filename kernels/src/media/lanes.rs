//! What stages ask of a medium, for eight rows.

use wide::{f32x8, u32x8};

use crate::lanes;
use crate::transcendental::neg_ln;
use crate::vec3::Vec3x8;

/// Least extinction that densities of walks count at a vertex [1/m]. What is clear in one channel may scatter in another:
/// so connections that make a vertex there are still told how probable their starts were in the first.
pub const LEAST_EVENT: f32 = 1e-30;

/// ln of the extinction at a vertex of a path, as densities of walks count it.
#[inline(always)]
pub fn log_event(extinction: f32x8) -> f32x8 {
    -neg_ln(extinction.fast_max(f32x8::splat(LEAST_EVENT)))
}

/// A medium before it is known which channel counts for each row.
pub trait MediumLanes: Copy {
    /// The medium in one channel per row.
    type Channel: MediumX8;

    /// Whether extinction differs between channels.
    const COLOURED: bool;

    /// The medium by which connections are made and weighed whose rows have these channels, which are asked for only
    /// where that matters: the medium in these channels or, where they are [apart](super::field::Apart), their mean.
    fn in_channel(&self, channel: impl FnOnce() -> u32x8) -> Self::Channel;

    /// The medium in one channel, as walks see it.
    #[inline(always)]
    fn channel(&self, channel: usize) -> Self::Channel {
        self.in_channel(|| u32x8::splat(channel as u32))
    }

    /// The medium in the channel of which the others are multiples, that of [`Self::hues`] 1, or, where they are apart,
    /// their mean.
    fn own(&self) -> Self::Channel;

    /// The medium of one of the running sums that paths keep: its own, or where channels are apart, that of one of them.
    #[inline(always)]
    fn of_sum(&self, _: usize) -> Self::Channel {
        self.own()
    }

    /// Extinction per channel, over that of any one of them, the same everywhere; not asked for where channels are
    /// apart.
    fn hues(&self) -> [f32; 3];

    /// [`MediumX8::passed`], per channel.
    #[inline(always)]
    fn passed(&self, rows: u32, from: Vec3x8, to: Vec3x8, length: f32x8) -> [[f32x8; 2]; 3] {
        core::array::from_fn(|channel| self.channel(channel).passed(rows, from, to, length))
    }
}

/// A medium in one channel per row.
pub trait MediumX8: Copy {
    /// A segment as weights see the medium along it.
    type Axis: AxisX8;
    /// A ray as weights see the medium along it.
    type Ray: AxisX8;
    /// The medium within a part of it that is even.
    type Even: MediumX8;

    /// Whether extinction differs from place to place, so that paths keep running sums of what they pass through.
    const VARIES: bool;

    /// The segment from `from` to `to`, of this `length` `[m]`, as weights see the medium along it.
    fn axis(self, from: Vec3x8, to: Vec3x8, length: f32x8) -> Self::Axis;

    /// The ray from `from` in the unit `direction`, which has no end, as weights see the medium along it.
    fn ray(self, from: Vec3x8, direction: Vec3x8) -> Self::Ray;

    /// Optical depth of the straight segment from `from` to `to`, of this `length` `[m]`, as weights count it: exact in
    /// a homogeneous medium.
    fn optical_depth(self, from: Vec3x8, to: Vec3x8, length: f32x8) -> f32x8;

    /// Optical depth of a way through vertices of a path, of which the length is `arc` `[m]`; `summed` are the depths
    /// of its segments in the [own channel](MediumLanes::own), known where extinction varies.
    fn optical_depth_along(self, arc: f32x8, summed: f32x8) -> f32x8;

    /// Extinction of each row's channel over that of the clearest one, in which limits on optical depths count; 1 where
    /// limits are on lengths.
    fn over_clearest(self) -> f32x8;

    /// Extinction at a point [1/m].
    fn extinction(self, at: Vec3x8) -> f32x8;

    /// `(tau / L)^N / M` [1/m] of a way of N `edges`, of length L = `arc` `[m]` and optical depth tau = `depth`, with M
    /// the product of the extinctions at its N - 1 inner vertices and `log_extinction` its logarithm in the
    /// [own channel](MediumLanes::own), known where extinction varies: in a homogeneous medium the extinction itself.
    fn crowding(self, edges: usize, arc: f32x8, depth: f32x8, log_extinction: f32x8) -> Crowding;

    /// ln of the product of the extinctions at so many inner vertices of a way, of which `log_extinction` is that in the
    /// [own channel](MediumLanes::own); where extinction varies, for nobody asks elsewhere.
    fn log_extinction_along(self, events: usize, log_extinction: f32x8) -> f32x8;

    /// Which points are in a convex part of the medium that is known to have one extinction.
    fn is_even_at(self, at: Vec3x8) -> f32x8;

    /// The medium for rows that stay in that part: it says the same of them to the bit, and sooner.
    fn as_even(self) -> Self::Even;

    /// Whether this pays: extinction varies, and all `points` of these `rows` are in that part.
    #[inline(always)]
    fn stays_even(self, points: impl IntoIterator<Item = Vec3x8>, rows: u32) -> bool {
        Self::VARIES && points.into_iter().all(|at| rows & !lanes::bits(self.is_even_at(at)) == 0)
    }

    /// [`Self::optical_depth`] of these `rows`, which may be known sooner than that of all eight.
    #[inline(always)]
    fn optical_depth_of(self, rows: u32, from: Vec3x8, to: Vec3x8, length: f32x8) -> f32x8 {
        if self.stays_even([from, to], rows) {
            return self.as_even().optical_depth(from, to, length);
        }
        self.optical_depth(from, to, length)
    }

    /// [`Self::optical_depth`] of these `rows`, and [`Self::extinction`] at the ends of their segments [1/m].
    #[inline(always)]
    fn passed(self, rows: u32, from: Vec3x8, to: Vec3x8, length: f32x8) -> [f32x8; 2] {
        if self.stays_even([from, to], rows) {
            let even = self.as_even();
            return [even.optical_depth(from, to, length), even.extinction(to)];
        }
        [self.optical_depth(from, to, length), self.extinction(to)]
    }
}

/// A medium for batches that [stay in its even part](MediumX8::stays_even).
#[derive(Clone, Copy)]
pub struct Even<M>(pub M);

impl<M: MediumLanes> MediumLanes for Even<M> {
    type Channel = <M::Channel as MediumX8>::Even;

    const COLOURED: bool = M::COLOURED;

    #[inline(always)]
    fn in_channel(&self, channel: impl FnOnce() -> u32x8) -> Self::Channel {
        self.0.in_channel(channel).as_even()
    }

    #[inline(always)]
    fn own(&self) -> Self::Channel {
        self.0.own().as_even()
    }

    fn hues(&self) -> [f32; 3] {
        self.0.hues()
    }
}

/// A segment as weights see the medium along it: its optical depth is exact in a homogeneous medium. Seeds are spread
/// over it from its start.
pub trait AxisX8: Copy {
    /// Whether extinction differs from place to place.
    const VARIES: bool;

    /// Optical depth; some depth above `most` where it is more than that, which may be known sooner.
    fn depth(&self, most: f32x8) -> f32x8;

    /// Optical depths of its part up to a distance `along` it `[m]`, and of all of it; some above `most` for the second,
    /// and anything for the first, where the second is more than that. Of a ray, only the first has a meaning.
    fn depths(&self, along: f32x8, most: f32x8) -> [f32x8; 2];

    /// Extinction at a distance `along` it [1/m].
    fn extinction(&self, along: f32x8) -> f32x8;

    /// Goes on by an optical `depth` from the place reached, at first its start: the distance passed `[m]`, which may
    /// lead beyond its end.
    fn advance(&mut self, depth: f32x8) -> f32x8;

    /// [`Self::advance`] from its start, and [`Self::depth`], in one go: the distance passed `[m]`, which is anything
    /// where it is deeper than `most`, and the depth.
    #[inline(always)]
    fn first_advance(&mut self, depth: f32x8, most: f32x8) -> [f32x8; 2] {
        [self.advance(depth), self.depth(most)]
    }

    /// Where its extinction is known to be the same from its start to its end, and which it is then [1/m].
    fn even(&self) -> (f32x8, f32x8);

    /// Extinction at the place reached [1/m]: 0 where a depth is never reached, on a ray that leaves everything.
    fn reached(&self) -> f32x8;
}

/// `e^log scale` [1/m]: a factor that may be neither very large nor very small as a whole.
#[derive(Clone, Copy, Debug)]
pub struct Crowding {
    /// Goes to the exponent of what it is multiplied with.
    pub log: f32x8,
    /// The rest [1/m].
    pub scale: f32x8,
}

impl Crowding {
    /// That where extinction varies, in a channel with `hue` of it.
    #[inline(always)]
    pub fn with_hue(hue: f32x8, edges: usize, arc: f32x8, depth: f32x8, log_extinction: f32x8) -> Self {
        // Extinctions count without hue, and the depth with it: one hue of all too many is left.
        let log = f32x8::splat(-(edges as f32)) * neg_ln(depth / (arc * hue)) - log_extinction;
        Self { log, scale: hue }
    }
}
