//! A field as weights see it.
//!
//! In a coloured field, everything is that of one channel times its hue; where channels are [apart](super::Apart),
//! connections go by their mean.

use wide::{f32x8, u32x8};

use super::Field;
use super::axis::{FieldAxis, LEAST_DEPTH, MOST_DEPTH};
use super::even::EvenX8;
use crate::lanes;
use crate::media::lanes::Crowding;
use crate::media::spectral::CHANNELS;
use crate::media::{AxisX8, MediumLanes, MediumX8};
use crate::transcendental::neg_ln;
use crate::vec3::Vec3x8;

/// A field of the same extinction in all channels.
#[derive(Clone, Copy)]
pub struct FieldLanes<'a>(&'a Field);

/// A field of coloured extinction, before it is known which channel counts for each row.
#[derive(Clone, Copy)]
pub struct ColouredFieldLanes<'a>(&'a Field);

/// A field in one channel per row.
#[derive(Clone, Copy)]
pub struct FieldX8<'a> {
    field: &'a Field,
    /// Extinction over that of the field.
    hue: f32x8,
}

impl<'a> FieldLanes<'a> {
    /// Those of a grey `field`.
    #[inline(always)]
    pub fn new(field: &'a Field) -> Self {
        Self(field)
    }
}

impl<'a> MediumLanes for FieldLanes<'a> {
    type Channel = FieldX8<'a>;

    const COLOURED: bool = false;

    #[inline(always)]
    fn in_channel(&self, _: impl FnOnce() -> u32x8) -> FieldX8<'a> {
        self.own()
    }

    #[inline(always)]
    fn own(&self) -> FieldX8<'a> {
        FieldX8::of(self.0)
    }

    fn hues(&self) -> [f32; CHANNELS] {
        [1.0; CHANNELS]
    }
}

impl<'a> ColouredFieldLanes<'a> {
    /// Those of a coloured `field`.
    #[inline(always)]
    pub fn new(field: &'a Field) -> Self {
        Self(field)
    }
}

impl<'a> MediumLanes for ColouredFieldLanes<'a> {
    type Channel = FieldX8<'a>;

    const COLOURED: bool = true;

    #[inline(always)]
    fn in_channel(&self, channel: impl FnOnce() -> u32x8) -> FieldX8<'a> {
        if self.0.apart.is_some() {
            return self.own();
        }
        let hues = self.0.hues;
        let hue = f32x8::new(channel().to_array().map(|channel| hues[(channel as usize).min(CHANNELS - 1)]));
        FieldX8 { field: self.0, hue }
    }

    #[inline(always)]
    fn channel(&self, channel: usize) -> FieldX8<'a> {
        let (field, hue) = self.0.channel(channel);
        FieldX8 { field, hue: f32x8::splat(hue) }
    }

    #[inline(always)]
    fn own(&self) -> FieldX8<'a> {
        FieldX8::of(self.0)
    }

    #[inline(always)]
    fn of_sum(&self, sum: usize) -> FieldX8<'a> {
        FieldX8::of(self.0.of_sum(sum))
    }

    fn hues(&self) -> [f32; CHANNELS] {
        self.0.hues
    }

    /// Of channels that are multiples of one of them, it alone is asked.
    #[inline(always)]
    fn passed(&self, rows: u32, from: Vec3x8, to: Vec3x8, length: f32x8) -> [[f32x8; 2]; CHANNELS] {
        if self.0.apart.is_some() {
            return core::array::from_fn(|channel| self.channel(channel).passed(rows, from, to, length));
        }
        let own = self.own().passed(rows, from, to, length);
        self.0.hues.map(|hue| own.map(|quantity| quantity * f32x8::splat(hue)))
    }
}

impl<'a> MediumX8 for FieldX8<'a> {
    type Axis = FieldAxis<'a>;
    type Ray = FieldAxis<'a>;
    type Even = EvenX8<'a>;

    const VARIES: bool = true;

    #[inline(always)]
    fn axis(self, from: Vec3x8, to: Vec3x8, length: f32x8) -> FieldAxis<'a> {
        FieldAxis::new(self.field, self.hue, from, to, length)
    }

    #[inline(always)]
    fn ray(self, from: Vec3x8, direction: Vec3x8) -> FieldAxis<'a> {
        FieldAxis::ray(self.field, self.hue, from, direction)
    }

    #[inline(never)]
    fn optical_depth(self, from: Vec3x8, to: Vec3x8, length: f32x8) -> f32x8 {
        if self.stays_even([from, to], lanes::ALL) {
            return self.as_even().optical_depth(from, to, length);
        }
        let most = self.field.most_depth(self.hue);
        self.axis(from, to, length).depth(most).fast_min(most)
    }

    #[inline(always)]
    fn optical_depth_along(self, _: f32x8, summed: f32x8) -> f32x8 {
        summed * self.hue
    }

    #[inline(always)]
    fn over_clearest(self) -> f32x8 {
        self.hue * f32x8::splat(1.0 / self.field.clearest())
    }

    #[inline(always)]
    fn extinction(self, at: Vec3x8) -> f32x8 {
        self.field.extinction(at) * self.hue
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
    fn is_even_at(self, at: Vec3x8) -> f32x8 {
        self.field.even.as_ref().map_or(f32x8::ZERO, |even| even.holds(self.field.in_cells(at)))
    }

    #[inline(always)]
    fn as_even(self) -> EvenX8<'a> {
        EvenX8::new(self.field, self.hue)
    }
}

impl<'a> FieldX8<'a> {
    /// A `field` in the channel in which its extinction is largest.
    #[inline(always)]
    pub fn of(field: &'a Field) -> Self {
        Self { field, hue: f32x8::ONE }
    }
}

impl Field {
    /// Most optical depth that weights count for a segment, in channels of these hues.
    #[inline(always)]
    pub(super) fn most_depth(&self, hue: f32x8) -> f32x8 {
        if self.is_known() {
            return f32x8::splat(f32::INFINITY);
        }
        (hue * f32x8::splat(MOST_DEPTH)).fast_max(f32x8::splat(LEAST_DEPTH))
    }
}
