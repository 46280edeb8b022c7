//! Making the connections: first how many vertices each inserts, then, bucket by bucket, where they are.

pub mod reference;
pub mod simd;

use super::Mvnee;
use crate::Step;
pub use crate::connect::buckets::{BuildColumns, CountColumns};

/// Counts the seeds of every connection: flights along the axis, in what [`Seeds`](super::Seeds) says, until its length
/// is exceeded.
///
/// Seed `k` takes word `k mod 4` of block `k div 4` of `MVNEE_FLIGHTS`, with the depth of the start. A connection that
/// would make the path longer than `lengths.max` segments is marked as dropped.
pub type CountKernel = fn(Step, CountColumns<'_, '_, Mvnee>);

/// Places the inserted vertices of every connection.
///
/// Seed `k` takes words `2 (k mod 2)` (radius) and `2 (k mod 2) + 1` (azimuth) of block `k div 2` of `MVNEE_OFFSETS`,
/// with the depth of the start. The radius is `alpha sqrt(u / (1 - u))` or `sigma sqrt(-2 ln(1 - u))`; the azimuth `2
/// pi u` counts from the tangent towards the bitangent of the axis' [frame](crate::vec3::Vec3x8::frame).
pub type BuildKernel = fn(Step, BuildColumns<'_, '_, Mvnee>);
