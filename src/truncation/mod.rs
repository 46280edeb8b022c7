//! What a limit on the length of paths leaves out.
//!
//! No error bar shows it, so it is estimated before a render begins: looks at the image, small, sum light by the length
//! of its paths. They do not depend on the limit, so that a limit which is offered is found to do when it is used.
//!
//! Short paths are found by bridges from the first vertices. Few long bridges have nearly all the weight, as they are
//! scaled from free walks that hardly ever return to where they began; so longer paths are found by long walks that
//! connect to a light from every vertex by short bridges. Straight lines would be cheaper, but where light goes on as it
//! came a few of them decide the estimate; they serve where bridges may be cut short, by the bounds of volumes, and where
//! there is nothing to build one to. To walks, small lights in open fog are as wide as half a mean free path: after so
//! many turns that is all the same, and connections of a vertex close to a small light would decide it, too.
//!
//! Where there are volumes either kind may miss light that the other finds: bridges from the first vertices leave the
//! volume, and walks end, absorbed, before they come near a light deep inside. So short paths are those of whoever sees
//! more of them, beyond noise, and what is beyond is only known if walks find light at lengths at which bridges do.
//!
//! Looks are taken as the frame is rendered otherwise, with the roulette on contributions that the pilot found to pay:
//! where transmittances have to be estimated, nearly all of their time would go to what counts next to nothing.
//!
//! What is beyond the longest walk is extrapolated: every doubling of the length is taken to bring as much less than
//! the one before as the last ones did. Where nothing is absorbed, light that wanders through endless fog falls with
//! the power -3/2 of the length, so that every doubling brings at least 1 - 1/sqrt(2) less than the one before. Where
//! the last doublings bring more than that, light still grows, and how much is beyond is not known. What has bounds is
//! left in the end, however thick and white it is: there light falls exponentially, and every doubling brings less than
//! its part of the one before, as much less as the last ones tell.

mod light;
mod lights;
mod tail;

use core::fmt;
use std::sync::Arc;

use fogbow_kernels::connect::Techniques;
use fogbow_kernels::connect::bridge::counts::CountTable;
use fogbow_kernels::connect::bridge::{Bridge, Roll};
use fogbow_kernels::pipeline::WIDEST;
use fogbow_kernels::survival::Survival;
use fogbow_kernels::{LONGEST_PATH, PathLengths};

use crate::figures::number;
use crate::film::Film;
use crate::frame::Frame;
use crate::render::{Monitor, Renderer};
use crate::stats::{LightByLength, Stats};
use light::Light;
use tail::Fate;

/// Share of the light that may be left out without a word.
pub const TOLERATED: f64 = 0.01;

/// Longest side of the small image in pixels, for bridges and for walks.
const SIDES: [u32; 2] = [32, 16];
/// Looks whose spread tells how well light is known.
const LOOKS: u32 = 8;
/// Longest paths, in segments, that bridges look for.
const SHORT: u32 = 32;
/// Most edges of bridges from the vertices of walks.
const NEAR: u32 = 8;
/// How bridges look where nothing is solid, and where something is.
const BRIDGES: [Way; 2] = [
    Way { starts: 1, survival: Survival::CERTAIN, samples: 8 << 10 },
    Way { starts: 2, survival: Survival::Constant(0.9), samples: 4 << 10 },
];
/// How walks that connect by bridges look where nothing is solid, and where something is.
const BRIDGED_WALKS: [Way; 2] = [
    Way { starts: u32::MAX, survival: Survival::CERTAIN, samples: 256 },
    Way { starts: u32::MAX, survival: Survival::Constant(0.99), samples: 256 },
];
/// How walks that connect by straight lines look.
const STRAIGHT_WALKS: [Way; 2] = [
    Way { starts: u32::MAX, survival: Survival::CERTAIN, samples: 8 << 10 },
    Way { starts: u32::MAX, survival: Survival::Constant(0.99), samples: 2 << 10 },
];
/// Least probability that a walk goes on where absorption decides it.
const LEAST_SURVIVAL: f32 = 0.5;
/// The power of the albedo with which walks go on that alone find light on long paths: a few that got there would not
/// tell how much they may have missed.
const LATE: f32 = 0.5;
/// Lengths of walks, in segments; the longer ones are taken where the shorter do not see where light ends, or leave open
/// whether a limit beyond them leaves out more than is tolerated.
const LONGEST: [u32; 3] = [256, 1024, 1 << 14];
/// Octave of depth from which on the longest walks end, so that their cost grows with the fourth root of the length
/// while what they find stays as certain: see [`pilot`](crate::pilot).
const FADING: usize = 6;
/// The seed of its samples.
const SEED: u32 = 0x6c07_8965;

/// How a look is taken.
#[derive(Clone, Copy)]
struct Way {
    /// Vertices that connect.
    starts: u32,
    /// Probability of going on from a vertex.
    survival: Survival,
    /// Least number of samples of all pixels together.
    samples: u32,
}

/// What is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truncation {
    /// The limit, in segments.
    pub max_segments: u32,
    /// How much of the light longer paths would bring.
    pub share: Share,
    /// A limit that leaves out no more than [`TOLERATED`], surely; none if there is none up to [`LONGEST_PATH`], or
    /// none is known.
    pub sufficient: Option<u32>,
    /// A limit that leaves out about as much, as far as the estimate says; none likewise.
    pub likely: Option<u32>,
}

/// A share of all light, as far as it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Share {
    /// About so much.
    About {
        /// The share, [0, 1].
        share: f64,
        /// Its standard error.
        error: f64,
    },
    /// At least so much, [0, 1]: light still grows with the length of the longest paths that there are.
    AtLeast(f64),
    /// Next to no light was found.
    Unknown,
}

impl Truncation {
    /// What a limit leaves out of which nothing is known.
    pub fn unknown(max_segments: u32) -> Self {
        Self { max_segments, share: Share::Unknown, sufficient: None, likely: None }
    }

    /// Whether it is worth a word: more than is tolerated, or perhaps so.
    pub fn matters(&self) -> bool {
        match self.share {
            Share::About { share, .. } | Share::AtLeast(share) => share > TOLERATED,
            Share::Unknown => true,
        }
    }

    /// For headers: the share, the limit, and a limit that would do.
    pub fn entry(&self) -> String {
        let share = match self.share {
            Share::About { share, error } => format!("{} +- {}", number(share, 2), number(error, 1)),
            Share::AtLeast(share) => format!("at least {}", number(share, 2)),
            Share::Unknown => "unknown".into(),
        };
        let enough = match (self.sufficient, self.likely) {
            (Some(limit), _) => format!("no more than {TOLERATED} beyond {limit}"),
            (None, Some(limit)) => format!("about {TOLERATED} beyond {limit}"),
            (None, None) => "no sufficient limit known".into(),
        };
        format!("{share} beyond {} segments, {enough}", self.max_segments)
    }
}

impl Share {
    /// Whether its error is not much smaller than itself.
    fn is_vague(self) -> bool {
        matches!(self, Self::About { share, error } if error > 0.5 * share)
    }
}

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::About { share, .. } if self.is_vague() => {
                write!(f, "perhaps {:.0} % of the light, which a short look does not tell", 100.0 * share)
            }
            Self::About { share, error } => {
                let decimals = usize::from(error < 0.0095);
                let [share, error] = [share, error].map(|value| 100.0 * value);
                write!(f, "about {share:.decimals$} +- {error:.decimals$} % of the light")
            }
            // Rounded down: it is a bound.
            Self::AtLeast(share) => write!(f, "at least {} % of the light", (1000.0 * share).floor() / 10.0),
            Self::Unknown => write!(f, "an unknown share of the light, of which a short look found next to nothing"),
        }
    }
}

impl fmt::Display for Truncation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { max_segments, share, sufficient, likely } = self;
        let segments = if *max_segments == 1 { "segment" } else { "segments" };
        write!(f, "paths of more than {max_segments} {segments} are left out, and with them {share}: ")?;
        match (sufficient, likely, share) {
            (Some(limit), ..) => write!(f, "--max-segments {limit} would leave out 1 % or less"),
            _ if *max_segments < LONGEST_PATH && (share.is_vague() || *share == Share::Unknown) => {
                write!(f, "--max-segments auto leaves out as little as can be")
            }
            (None, Some(limit), _) => write!(f, "--max-segments {limit} would leave out about 1 %"),
            (None, None, Share::About { .. }) => {
                write!(f, "even {LONGEST_PATH}, the largest possible limit, may leave out more than 1 %")
            }
            (None, None, Share::Unknown) => write!(
                f,
                "either there is hardly any in view, or it needs more than {LONGEST_PATH} segments, the largest possible \
                 limit"
            ),
            (None, None, Share::AtLeast(_)) => {
                write!(f, "most of it may need more than {LONGEST_PATH} segments, the largest possible limit")
            }
        }
    }
}

/// What `frame`, whose image has `size` pixels, leaves out; `None` where nothing is left out, as nothing turns light.
/// If `monitor` says stop, nothing is known.
pub fn estimate(frame: &Frame, size: [u32; 2], renderer: &Renderer, monitor: &Monitor) -> Option<Truncation> {
    if frame.stays_straight() || (frame.lights.largest_radiance() == 0.0 && !frame.emits()) {
        return None;
    }
    let looker = Looker { frame, size, renderer, monitor: &monitor.of_looks() };
    let limit = frame.lengths.max;
    let Some(light) = looker.look() else { return Some(Truncation::unknown(limit)) };
    if light.is_black() && frame.medium.never_scatters() {
        return None;
    }
    let (sufficient, likely) = (light.sufficient(), light.likely());
    Some(Truncation { max_segments: limit, share: light.share(limit), sufficient, likely })
}

/// Looks at the light of a frame.
#[derive(Clone, Copy)]
struct Looker<'a> {
    frame: &'a Frame,
    size: [u32; 2],
    renderer: &'a Renderer,
    monitor: &'a Monitor,
}

impl Looker<'_> {
    /// Light by length, with walks as long as they must be; none if it was stopped.
    fn look(&self) -> Option<Light> {
        let Frame { surfaces, lights, medium, .. } = self.frame;
        let solid = usize::from(!surfaces.is_empty());
        let dark = lights.emitters().is_empty();
        let straight = Techniques { nee: !dark, ..Techniques::default() };
        let is_straight = dark || medium.never_scatters();
        let short = if is_straight { straight.clone() } else { bridges(self.frame, SHORT - 1) };
        let short = self.take(short, &BRIDGES[solid], SHORT)?;
        let [near, far, farthest] = LONGEST;
        let wide = Frame { lights: lights::widened(self.frame), ..self.frame.clone() };
        let may_miss = !is_straight && (self.frame.varies() || lights.has_distant());
        let (connections, ways) =
            if is_straight || may_miss { (straight, STRAIGHT_WALKS) } else { (bridges(&wide, NEAR), BRIDGED_WALKS) };
        let walks = self.absorbed(ways[solid], if may_miss { LATE } else { 1.0 });
        let walker = Looker { frame: &wide, ..*self };
        let join = if may_miss { Light::of_the_better } else { Light::new };
        let has_bounds = medium.field().is_some_and(|field| field.around() == 0.0);
        let fate = if has_bounds { Fate::Leaves } else { Fate::Stays };
        let with_walks =
            |longest: u32, way: &Way| Some(join(&short, &walker.take(connections.clone(), way, longest)?, fate));
        // As many segments, so fewer walks.
        let fewer = Way { samples: walks.samples * near / far, ..walks };
        let fading = Way { survival: Survival::fading(FADING), ..fewer };
        let limit = self.frame.lengths.max;
        let is_enough = |light: &Light, longest: u32| light.is_known() && (limit <= longest || light.is_enough(limit));
        let light = with_walks(near, &walks)?;
        if is_enough(&light, near) {
            return Some(light);
        }
        let light = with_walks(far, &fewer)?;
        if is_enough(&light, far) { Some(light) } else { with_walks(farthest, &fading) }
    }

    /// Walks that end about where the medium absorbs them, but for a `power` of the probability.
    fn absorbed(&self, walks: Way, power: f32) -> Way {
        let medium = &self.frame.medium;
        let albedo = if medium.never_scatters() { 1.0 } else { medium.albedo.into_iter().fold(0.0, f32::max) };
        Way { survival: (walks.survival.at(1) * albedo.clamp(LEAST_SURVIVAL, 1.0).powf(power)).into(), ..walks }
    }

    /// Light of a sample at each length up to `longest`, look by look; none if they were stopped.
    fn take(&self, techniques: Techniques, way: &Way, longest: u32) -> Option<Vec<Vec<f64>>> {
        let side = SIDES[usize::from(longest > SHORT)];
        let (frame, region) = self.frame.small(self.size, side);
        let samples = way.samples.div_ceil(region.pixels() as u32);
        let lengths = PathLengths { max: longest, ..frame.lengths };
        let frame = Frame { lengths, techniques, seed: SEED, ..frame }.with_walk(way.starts, way.survival);
        let film = Film::new(&frame, region, side);
        let counted = Stats::new(false).by_length(&frame);
        let looks = self.renderer.looks(&counted, &frame, &WIDEST, &film, (LOOKS, samples), self.monitor)?;
        let light = |stats: &Stats| {
            let light = stats.light_by_length.as_ref().map_or_else(Vec::new, LightByLength::values);
            light.into_iter().map(|light| light / stats.samples as f64).collect()
        };
        Some(looks.iter().map(light).collect())
    }
}

/// Bridges with N edges, N = 1 .. `edges`, in proportion to 1 / N: as many in every doubling. Their walks are as drawn: to
/// choose among several takes longer and leaves looks as uncertain.
fn bridges(frame: &Frame, edges: u32) -> Techniques {
    let weights: Vec<f64> = (1..=edges).map(|n| 1.0 / f64::from(n)).collect();
    let counts = CountTable::from_weights(frame.medium.phase.twin().lobe(), edges as usize, |_| weights.clone());
    let bridge = Bridge { max_inserted: edges - 1, ..Bridge::with_counts(Roll::Aligned, Arc::new(counts)).as_drawn() };
    Techniques { bridge: Some(bridge), ..Techniques::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_told_is_as_exact_as_what_is_known() {
        let told = |share, sufficient, likely| {
            let found = Truncation { max_segments: 15, share, sufficient, likely };
            (found.to_string(), found.entry())
        };
        let (text, entry) = told(Share::About { share: 0.0893, error: 0.0102 }, Some(448), Some(320));
        assert!(
            text.ends_with("about 9 +- 1 % of the light: --max-segments 448 would leave out 1 % or less"),
            "{text}"
        );
        assert_eq!(entry, "0.089 +- 0.01 beyond 15 segments, no more than 0.01 beyond 448");
        let (text, _) = told(Share::About { share: 0.0893, error: 0.0042 }, None, None);
        assert!(text.contains("about 8.9 +- 0.4 % of the light: even 65536, the largest possible"), "{text}");
        let (text, entry) = told(Share::About { share: 0.0893, error: 0.0102 }, None, Some(320));
        assert!(text.ends_with("of the light: --max-segments 320 would leave out about 1 %"), "{text}");
        assert_eq!(entry, "0.089 +- 0.01 beyond 15 segments, about 0.01 beyond 320");
        let (text, entry) = told(Share::About { share: 0.17, error: 0.17 }, None, Some(16));
        let ending = "perhaps 17 % of the light, which a short look does not tell: --max-segments auto leaves out as little \
                      as can be";
        assert!(text.ends_with(ending), "{text}");
        assert_eq!(entry, "0.17 +- 0.2 beyond 15 segments, about 0.01 beyond 16");
        let (text, entry) = told(Share::AtLeast(0.9999), None, None);
        assert!(text.contains("at least 99.9 % of the light: most of it may need more than 65536"), "{text}");
        assert_eq!(entry, "at least 1.0 beyond 15 segments, no sufficient limit known");
        let (text, entry) = told(Share::Unknown, None, None);
        let ending = "an unknown share of the light, of which a short look found next to nothing: --max-segments auto leaves \
                      out as little as can be";
        assert!(text.ends_with(ending), "{text}");
        assert!(entry.starts_with("unknown beyond 15 segments"), "{entry}");
    }
}
