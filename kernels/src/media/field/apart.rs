//! Fields of which the volumes differ in colour: their extinctions in the three channels are fields of their own.
//!
//! Where all media of a scene share the quotients of extinction between channels, one field and three *hues* are all that
//! there is to know. Otherwise no channel follows from another, and each has a field: the same volumes, in the same cells,
//! with the extinctions of that channel. Flights are tracked, transmittances estimated and optical depths added up in
//! them as in any grey field.
//!
//! What a flight of the hero h leaves out of another channel c is `T_c / T_h`, the transmittance of `mu_c - mu_h`. Where
//! that is nearly nothing, as in a grey cloud, it must not be estimated as a quotient of two unlikely events. So each pair
//! of channels has a field of its own, too, whose extinctions may be negative: only transmittances are estimated there.
//!
//! Connections ask for one extinction, by which they choose how many vertices they make and where: that is the mean of the
//! channels, whatever the hero. So their densities are the same in all channels, and only those of walks are told apart.

use glam::DVec3;
use wide::{f32x8, u32x8};

use super::reference::FieldTwin;
use super::tracking::RaysX8;
use super::tracking::simd::{factor, transmittances};
use super::{CHANNELS, Field, FieldX8, Volume};
use crate::columns::queues::EstimateColumns;
use crate::columns::{Column, Column3};
use crate::lanes;
use crate::media::MediumX8;
use crate::media::reference::Medium as _;
use crate::phase::HenyeyGreenstein;
use crate::vec3::Vec3x8;

/// The fields of channels, and of what lies between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Apart {
    /// Extinctions of every channel.
    channels: [Field; CHANNELS],
    /// Extinctions of every channel, in the sequence of [`others`] of every hero, less those of the hero.
    between: Vec<Field>,
}

/// What has to be estimated of one channel: its transmittance, or that over the one of a hero, whose flight has got
/// through.
#[derive(Clone, Copy)]
pub struct Unknown<'a> {
    /// The field of which it is the transmittance.
    pub field: &'a Field,
    /// The channel.
    pub channel: usize,
    /// The hero.
    pub hero: Option<usize>,
    apart: &'a Apart,
}

/// The channels that are not `hero`.
pub fn others(hero: usize) -> [usize; CHANNELS - 1] {
    [(hero + 1) % CHANNELS, (hero + 2) % CHANNELS]
}

impl Apart {
    /// Those of `volumes`, whose extinctions per channel are `hues` of their own, in what is `around` [1/m]; `make` gives the
    /// field of one set of extinctions.
    pub fn new(
        volumes: &[Volume],
        hues: &[[f32; CHANNELS]],
        around: [f32; CHANNELS],
        make: impl Fn(Vec<Volume>, f32) -> Field,
    ) -> Self {
        let field = |of: &dyn Fn([f32; CHANNELS]) -> f32| {
            let coloured = volumes.iter().zip(hues).map(|(volume, hues)| Volume {
                extinction: of(hues.map(|hue| hue * volume.extinction)),
                ..volume.clone()
            });
            make(coloured.collect(), of(around))
        };
        let pairs = (0..CHANNELS).flat_map(|hero| others(hero).map(|channel| (hero, channel)));
        Self {
            channels: [0, 1, 2].map(|c| field(&|extinctions| extinctions[c])),
            between: pairs.map(|(hero, c)| field(&|extinctions| extinctions[c] - extinctions[hero])).collect(),
        }
    }

    /// The field of a channel.
    #[inline(always)]
    pub fn channel(&self, channel: usize) -> &Field {
        &self.channels[channel.min(CHANNELS - 1)]
    }

    /// The transmittances of all channels.
    pub fn transmittances(&self) -> impl Iterator<Item = Unknown<'_>> {
        let of = |(channel, field)| Unknown { field, channel, hero: None, apart: self };
        self.channels.iter().enumerate().map(of)
    }

    /// For every hero, those of the others over its own.
    pub fn beyond_flights(&self) -> impl Iterator<Item = Unknown<'_>> {
        let pairs = (0..CHANNELS).flat_map(|hero| others(hero).map(|channel| (channel, hero)));
        let of = |(field, (channel, hero))| Unknown { field, channel, hero: Some(hero), apart: self };
        self.between.iter().zip(pairs).map(of)
    }

    /// The same of other fields.
    pub fn each(&self, mut other: impl FnMut(Field) -> Field) -> Self {
        Self {
            channels: self.channels.clone().map(&mut other),
            between: self.between.iter().cloned().map(other).collect(),
        }
    }

    /// Hands everything that extinctions depend on, but for the volumes, to `digest`.
    pub fn digest(&self, digest: &mut dyn FnMut(&[u8])) {
        for field in &self.channels {
            digest(&field.around.to_le_bytes());
            field.volumes.iter().for_each(|placed| digest(&placed.volume.extinction.to_le_bytes()));
        }
    }

    /// Bytes that means and bounds take.
    pub fn bytes(&self) -> usize {
        self.channels.iter().chain(&self.between).map(Field::bytes_of_cells).sum()
    }
}

impl Unknown<'_> {
    /// Estimates it along `rays`, each for one row of the columns, which are product and depth of [`EstimateColumns`].
    #[inline(always)]
    pub fn estimate(
        &self,
        rays: impl Iterator<Item = RaysX8<1>>,
        product: &mut Column3<'_>,
        depth: &mut Column<'_, f32>,
    ) {
        transmittances(self.field, rays, |row, [left]: [f32; 1], known| {
            product.x.rows_mut()[row] = left;
            depth.rows_mut()[row] = known;
        });
    }

    /// What has been estimated of batch `b`, whose rays went from `from` to `to`, at this `length` `[m]`, over what weights
    /// take it for.
    #[inline(always)]
    pub fn factor(&self, b: usize, estimates: &EstimateColumns<'_>, from: Vec3x8, to: Vec3x8, length: f32x8) -> f32x8 {
        factor(estimates.product.x.batch(b), f32x8::ONE, estimates.depth.batch(b), self.depth(from, to, length))
    }

    /// The optical depths that weights take it for, from `from` to `to`, at this `length` `[m]`: the channel's, less the
    /// hero's.
    #[inline(always)]
    fn depth(&self, from: Vec3x8, to: Vec3x8, length: f32x8) -> f32x8 {
        let of = |channel| FieldX8::of(self.apart.channel(channel)).optical_depth(from, to, length);
        self.hero.map_or(of(self.channel), |hero| of(self.channel) - of(hero))
    }

    /// The same for one segment, for twins.
    pub fn depth_between(&self, from: DVec3, to: DVec3) -> f64 {
        let twin =
            |channel| FieldTwin { field: self.apart.channel(channel), hue: 1.0, phase: &HenyeyGreenstein { g: 0.0 } };
        let of = |channel| twin(channel).optical_depth(from, to);
        self.hero.map_or(of(self.channel), |hero| of(self.channel) - of(hero))
    }

    /// The rows for whose heroes it is asked.
    #[inline(always)]
    pub fn asked(&self, heroes: u32x8) -> u32 {
        self.hero.map_or(lanes::ALL, |hero| lanes::equal(heroes, hero))
    }
}
