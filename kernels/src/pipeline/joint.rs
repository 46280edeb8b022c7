//! How two points are joined by as many vertices as a technique draws.

use super::{Pipeline, Stage};
use crate::Step;
use crate::connect::bridge::{self, Bridge};
use crate::connect::buckets::{BuildColumns, CountColumns};
use crate::connect::mvnee::{self, Mvnee};

/// A technique that first counts the vertices that each connection inserts, and then, bucket by bucket, places them.
pub trait Joint: Sized {
    /// The stage that counts.
    const COUNT: Stage;
    /// The stage that places.
    const BUILD: Stage;

    /// The kernel that counts.
    fn count_kernel(pipeline: &Pipeline) -> fn(Step, CountColumns<'_, '_, Self>);
    /// The kernel that places.
    fn build_kernel(pipeline: &Pipeline) -> fn(Step, BuildColumns<'_, '_, Self>);
}

impl Joint for Mvnee {
    const COUNT: Stage = Stage::MvneeCount;
    const BUILD: Stage = Stage::MvneeBuild;

    fn count_kernel(pipeline: &Pipeline) -> mvnee::sample::CountKernel {
        pipeline.mvnee_count
    }

    fn build_kernel(pipeline: &Pipeline) -> mvnee::sample::BuildKernel {
        pipeline.mvnee_build
    }
}

impl Joint for Bridge {
    const COUNT: Stage = Stage::BridgeCount;
    const BUILD: Stage = Stage::BridgeBuild;

    fn count_kernel(pipeline: &Pipeline) -> bridge::sample::CountKernel {
        pipeline.bridge_count
    }

    fn build_kernel(pipeline: &Pipeline) -> bridge::sample::BuildKernel {
        pipeline.bridge_build
    }
}
