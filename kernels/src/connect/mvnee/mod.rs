//! Multiple-vertex next event estimation (Weber, Hanika, Dachsbacher 2017).
//!
//! From a start x toward a light point at distance s along the axis w: free flights along the axis until s is exceeded
//! give the seeds, m of them; the last of the m + 1 segments d is cut at the light. Each seed j is then moved within
//! the plane perpendicular to w by an isotropic offset whose width follows from the segments on either side, `sigma_j^2
//! = slope^2 L_j R_j / (L_j + R_j)`, `L_j = sum_{k <= j} d_k^2`, `R_j = sum_{k > j} d_k^2` (Eqs. 5-7).
//!
//! The ratio to path tracing for a given suffix, reprojected on the axis from its start, is
//!
//! ```text
//! r_i = p_A P_l exp(mu_t (L_i - s_i)) l_{n-1}^2 / (p_w(i) cos_light) * prod_j offset_density_j l_{i+j-1}^2 / phase_{i+j}
//! ```
//!
//! and 0 if s_i or m exceeds its limit or the projections do not increase strictly from the start to the light.
//!
//! Where extinction varies, the axis passes the coarse field, of extinction `mu~(t)` and optical depth `tau~`, and
//! [`Seeds`] says how seeds are spread over it: their density takes the place of `mu_t^m exp(-mu_t s)`. Weights need
//! that density, so flights are not tracked through the field itself, as they are in the paper. Extinctions at the
//! vertices that the seeds end up at are the true ones; a connection with a vertex in vacuum counts nothing.

pub mod sample;
pub mod slope;

pub mod reference;
pub(crate) mod simd;

use super::light_sample::Scope;
use super::{Densities, Row};
use crate::media::Medium;
use crate::media::field::Reach;
use crate::random;

/// How far a seed is moved off the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Offset {
    /// `alpha^2 / (pi (alpha^2 + r^2)^2)` with alpha = 1.637618734 sigma: heavy tails, no fireflies.
    Ggx,
    /// `exp(-r^2 / (2 sigma^2)) / (2 pi sigma^2)`.
    Gaussian,
}

impl Offset {
    /// Least sigma of a density, over the distance of the light point from the origin and from the start.
    ///
    /// What was drawn more exactly than positions are rounded is not so exact any more, and the density must not say so:
    /// a seed next to the light, whose width is 0 and whose offset is not, would have been made by nobody. More than
    /// rounding does makes densities of short first edges too small, less leaves what it moved several sigma away to
    /// nobody: next to nothing with heavy tails, everything without.
    pub const fn grain(self) -> f32 {
        match self {
            Self::Ggx => 2e-8,
            Self::Gaussian => 6e-8,
        }
    }
}

/// How seeds are spread over an axis along which extinction varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seeds {
    /// Flights through the coarse field: `prod_j mu~(t_j) exp(-tau~(s))`.
    Coarse,
    /// The first flight through the coarse field, and all others as if extinction went on as at the first seed:
    /// `mu~(t_1)^m exp(-tau~(t_1) - mu~(t_1) (s - t_1))`, or `exp(-tau~(s))` without seeds. Weights ask the field for one
    /// extinction instead of one per seed (after section 4 of the paper, whose first flight is a Woodcock flight
    /// through the field itself; the density of one through the coarse field is known, so that the weight is exact).
    Fast,
}

/// Width of the GGX offset over that of the Gaussian with the same core (Weber et al. 2017; rederived in
/// [`slope`]'s tests).
pub const GGX_WIDTH: f64 = 1.637_618_734;

/// The settings of the technique.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mvnee {
    /// Longest connection `[m]`: the limit on its expected number of segments (MESC) times the mean free path.
    pub max_distance: f32,
    /// Largest optical depth of a connection's axis: the same limit where extinction varies, or else infinite.
    pub max_depth: f32,
    /// How far that reaches in the even part of a field.
    pub reach: Option<Reach>,
    /// Most seeds; `u32::MAX` for no limit but that of the path.
    pub max_inserted: u32,
    /// Shape of the perturbation.
    pub offset: Offset,
    /// How seeds are spread where extinction varies.
    pub seeds: Seeds,
    /// Standard deviation of the perturbation per unit of distance (sigma_phi).
    pub slope: f32,
}

impl Mvnee {
    /// The settings for `medium`, with at most `mesc` expected segments in a connection, in the clearest channel;
    /// infinite for no limit.
    pub fn new(medium: &Medium, mesc: f64, offset: Offset) -> Self {
        let max_depth = medium.longest_depth(mesc);
        Self {
            max_distance: (mesc * medium.mean_free_path()) as f32,
            max_depth,
            reach: medium.field().and_then(|field| Reach::new(field, max_depth)),
            max_inserted: u32::MAX,
            offset,
            seeds: Seeds::Coarse,
            slope: slope::of(medium.phase.mean_cosine()) as f32,
        }
    }

    /// What others must know of it.
    pub fn row(&self) -> Row {
        Row {
            most_inserted: self.max_inserted,
            looks_back: true,
            most_edges: 1,
            most_edges_near: self.max_inserted.saturating_add(1) as usize,
            densities: Densities::All,
            near: self.max_distance,
        }
    }

    /// Every start within the distance limit connects, whichever way the light faces.
    pub fn scope(&self) -> Scope {
        Scope { max_distance: self.max_distance, reach: self.reach, ..Scope::new(random::MVNEE_LIGHT) }
    }
}
