//! What a look costs, as counted work: the same on every machine.

use crate::frame::Frame;
use crate::stats::Stats;

/// Work in units of about a nanosecond on one core: what stages were measured to cost per row. Only how settings of one
/// scene compare matters, and costs are fitted to that: see BENCHMARKS.
///
/// Paths of eight lanes that all go to the end meet the same at the same time. Where some end early, a segment costs
/// more.
pub(super) fn cost(stats: &Stats, frame: &Frame) -> f64 {
    const SAMPLE: f64 = 10.0;
    const SEGMENT: f64 = 5.0;
    const CONNECTION: f64 = 60.0;
    const EDGE: f64 = 8.0;
    const ALTERNATIVE: f64 = 5.0;
    const TERM: f64 = 7.0;
    const TRACED_IN_STEP: f64 = 17.0;
    const TRACED: f64 = 29.0;
    const SHADOW_RAY: f64 = 20.0;
    const TRACKED: f64 = 100.0;
    const ESTIMATED: f64 = 150.0;
    const EMITTED: f64 = 350.0;
    let work = stats.work.expect("looks count work");
    let where_that = |happens: bool, count: u64| if happens { count as f64 } else { 0.0 };
    let traced = if frame.walk.survival.is_certain() { TRACED_IN_STEP } else { TRACED };
    SAMPLE * stats.samples as f64
        + SEGMENT * stats.segments as f64
        + CONNECTION * work.connections as f64
        + EDGE * work.edges as f64
        + ALTERNATIVE
            * where_that(frame.techniques.bridge.as_ref().is_some_and(|bridge| bridge.alternatives > 1), work.edges)
        + TERM * work.terms as f64
        + traced * where_that(frame.is_solid(), stats.segments)
        + SHADOW_RAY * where_that(frame.is_solid(), work.traced)
        + TRACKED * where_that(frame.varies(), stats.segments)
        + ESTIMATED * where_that(frame.varies(), work.traced)
        + EMITTED * where_that(frame.varies() && frame.emits(), stats.segments)
}
