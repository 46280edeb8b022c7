//! The far end of a connection: a light, and a point on it, for every vertex that may connect.

pub(crate) mod lights;
pub mod reference;
pub mod selection;
pub mod simd;

use crate::Step;
use crate::columns::paths::{LastSurfaceColumns, OutlookColumns, PathColumns, RayColumns, VertexColumns};
use crate::columns::queues::CandidateQueue;
use crate::lanes::LaneSet;
use crate::media::field::Reach;
use crate::random::Purpose;
use crate::tables::lights::Lights;

/// Which pairs of start and light point a technique connects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scope {
    /// The random dimension of the technique's light point.
    pub purpose: Purpose,
    /// Longest distance between start and light point `[m]`; infinite if there is no limit.
    pub max_distance: f32,
    /// How long connections may be in the even part of a field, where their depth is limited.
    pub reach: Option<Reach>,
    /// Whether lights at infinity are connected with, instead of all others.
    pub distant: bool,
    /// Whether the start must lie in front of the light: true of a technique that connects in a straight line.
    pub facing: bool,
    /// Vertices that connect, counted from the camera or the last surface, >= 1; `u32::MAX` for all.
    pub starts: u32,
    /// Largest depth of a start; `u32::MAX` for no limit.
    pub max_depth: u32,
}

impl Scope {
    /// Every start and every light point, with `purpose` as the random dimension.
    pub const fn new(purpose: Purpose) -> Self {
        Self {
            purpose,
            max_distance: f32::INFINITY,
            reach: None,
            distant: false,
            facing: false,
            starts: u32::MAX,
            max_depth: u32::MAX,
        }
    }

    /// The same for the first `starts` vertices only, unless it is about lights at infinity, with which all connect.
    pub fn from_first(self, starts: u32) -> Self {
        if self.distant { self } else { Self { starts, ..self } }
    }
}

/// What this stage may touch.
pub struct Columns<'a, 'q> {
    /// The lights, and how connections choose among them.
    pub lights: &'a Lights,
    /// Which pairs of start and light point connect.
    pub scope: Scope,
    /// The paths whose vertices may connect.
    pub live: &'a LaneSet<'q>,
    /// Read: pixel, sample and birth.
    pub paths: &'a PathColumns<'q>,
    /// Read: its depth.
    pub last_surface: &'a LastSurfaceColumns<'q>,
    /// Read where the selection depends on the start: its light sum.
    pub outlook: &'a OutlookColumns<'q>,
    /// Read: position of the starts.
    pub vertex: &'a VertexColumns<'q>,
    /// Read: the ray that arrives there.
    pub before: &'a RayColumns<'q>,
    /// Filled, in lane order: every connection within the scope.
    pub connections: &'a mut CandidateQueue<'q>,
}

/// Draws a light for the current vertex of every live path that may start a connection and a point on it, uniform in
/// area. A vertex may if `depth <= max_depth` and `depth - first < starts`, where `first` is the depth of the last
/// surface vertex, or 1.
///
/// The first word of the block picks the light, the first of the emitter's block one of its emitters. The second and
/// third of the block, u and v, pick the point: on a disk the squared radius `R^2 u` and the azimuth `2 pi v` from the
/// tangent towards the bitangent; on a sphere the height `R (1 - 2 u)` along z and the azimuth from x towards y; on a
/// triangle the corners' weights `1 - sqrt(u)`, `sqrt(u) (1 - v)` and `sqrt(u) v`.
///
/// Of a light at infinity they pick a direction ([`distant`](super::distant)): in a cap the share u of `1 - cos` and the
/// azimuth `2 pi v` from the tangent towards the bitangent; in the pixel of an image, which the emitter's block picks,
/// the share u of the cosines and the share v of the azimuths. The point is [`FAR`](crate::tables::lights::FAR) away.
pub type Kernel = fn(Step, Columns<'_, '_>);
