//! Connections to lights at infinity: one straight line from every vertex, towards a direction.
//!
//! What is at infinity is the same from everywhere, so that a light point is a direction w and the last segment of a
//! path has no length that matters. Each of these lights is a cap of the sphere of directions; one is chosen with the
//! probability P_l, which is its share in their flux or the same for all, and a direction from it with the density
//!
//! ```text
//! p_dir(w) = 1 / (4 pi S)              uniform in a cap that has the share S = sin^2 (theta / 2) of the sphere
//! p_dir(w) = L(w) / integral of L      from an image, by pixel
//! ```
//!
//! Path tracing finds w with `p_w e^-tau`, so that next event estimation's ratio has neither length nor cosine:
//!
//! ```text
//! r_{n-1} = p_dir P_l e^tau / p_w,      r_i = 0 for all other starts
//! ```
//!
//! These connections go with whatever techniques connect, beside them: from every vertex, as walks have no other way
//! to the sky but their last flight. Techniques that insert vertices do not reach infinity; they choose among what has
//! a place, and make no path that ends elsewhere.
//!
//! A candidate's light point is [`FAR`](crate::tables::lights::FAR) from its start. What traces or tracks the segment
//! sees nothing else of infinity.

pub mod reference;
pub mod simd;

use super::light_sample::Scope;
use crate::random;

/// Every start connects, whatever starts other techniques have.
pub const SCOPE: Scope = Scope { distant: true, ..Scope::new(random::DISTANT_LIGHT) };
