//! A pipeline in which every stage checks itself: it runs its kernel and its twin on the same queues of a real frame
//! and compares what they filled. The frame goes on with what the kernel found.
//!
//! Stages are function pointers without state, so what they find is collected per thread; see [`take_log`].

use std::cell::RefCell;

use fogbow_kernels::columns::Column3;
use fogbow_kernels::columns::paths::PathColumns;
use fogbow_kernels::columns::queues::{Bucket, CandidateQueue, ChainTable};
use fogbow_kernels::columns::trail::TrailTable;
use fogbow_kernels::connect::bridge::{Bridge, sample as bridge_sample};
use fogbow_kernels::connect::buckets::{BucketTable, BuildColumns, CountColumns, DROPPED};
use fogbow_kernels::connect::light_sample;
use fogbow_kernels::connect::light_sample::reference;
use fogbow_kernels::connect::light_survey;
use fogbow_kernels::connect::lis::sample as lis_sample;
use fogbow_kernels::connect::mvnee::{Mvnee, sample as mvnee_sample};
use fogbow_kernels::connect::nee::{self, in_place};
use fogbow_kernels::connect::omnee::sample as omnee_sample;
use fogbow_kernels::emission::reference::cosine;
use fogbow_kernels::lanes::{LANES, LaneSet};
use fogbow_kernels::media::Medium;
use fogbow_kernels::pipeline::{Pipeline, REFERENCE, SIMD};
use fogbow_kernels::tables::lights::Lights;
use fogbow_kernels::{
    Step, accumulate, extend, features, first_flight, first_surface, flight_hue, flight_weight, generate, glow,
    light_hit, medium_sample, mis_weight, occlusion, outline, passage, phase_quotient, prune, remember, roulette,
    scatter, sift, spectral_weight, surface, transmittance,
};

use crate::compare::{Save, Saved, difference};
use crate::tolerances::{self, Tolerance};

/// What the checked stages found.
#[derive(Clone, Debug, Default)]
pub struct Log {
    /// Rows compared.
    pub rows: u64,
    /// Rows about which kernel and twin decided differently.
    pub decisions: u64,
    /// What weighed candidates bring.
    pub worth: f64,
    /// By how much kernel and twin disagree about it where they decided differently.
    pub disputed: f64,
    /// Rows that are further apart than their tolerance.
    pub failures: Vec<String>,
}

impl Log {
    /// Takes in what was found elsewhere.
    pub fn merge(&mut self, other: Self) {
        self.rows += other.rows;
        self.decisions += other.decisions;
        self.worth += other.worth;
        self.disputed += other.disputed;
        self.failures.extend(other.failures);
    }

    /// Of real frames: rows that were decided differently are no harm only if they bring little, and one in a million may
    /// bring more than all others.
    pub fn assert_little_is_disputed(&self, name: &str) {
        let Self { worth, disputed, .. } = self;
        assert!(*disputed <= tolerances::DISPUTED_WORTH * worth, "{name}: {disputed:e} of {worth:e} are disputed");
    }
}

thread_local! {
    static LOG: RefCell<Log> = RefCell::new(Log::default());
}

/// What the checked stages of this thread found since the last call.
pub fn take_log() -> Log {
    LOG.take()
}

fn count_rows(rows: usize) {
    LOG.with_borrow_mut(|log| log.rows += rows as u64);
}

fn count_decisions(rows: usize) {
    LOG.with_borrow_mut(|log| log.decisions += rows as u64);
}

/// Counts what a candidate brings by kernel and twin.
fn count_worth(kernel: f64, twin: f64) {
    LOG.with_borrow_mut(|log| log.worth += kernel.max(twin));
}

/// The same where they decided differently.
fn count_disputed(kernel: f64, twin: f64) {
    count_decisions(1);
    LOG.with_borrow_mut(|log| log.disputed += (kernel - twin).abs());
}

fn fail(stage: &str, row: usize, text: &str) {
    LOG.with_borrow_mut(|log| log.failures.push(format!("{stage}, row {row}:\n{text}")));
}

/// Every stage, checked.
pub const CHECKED: Pipeline = Pipeline {
    generate: walk::check_generate,
    outline: walk::check_outline,
    remember: walk::check_remember,
    medium_sample: flights::check_medium_sample,
    features: first::check_features,
    first_flight: flights::check_first_flight,
    extend: walk::check_extend,
    glow: walk::check_glow,
    light_hit: walk::check_light_hit,
    prune: walk::check_prune,
    first_surface: flights::check_first_surface,
    flight_weight: flights::check_flight_weight,
    spectral_weight: flights::check_spectral_weight,
    flight_hue: flights::check_flight_hue,
    scatter: walk::check_scatter,
    surface: walk::check_surface,
    passage: walk::check_passage,
    light_survey: connect::check_light_survey,
    light_sample: connect::check_light_sample,
    nee: connect::check_nee,
    mvnee_count: connect::check_mvnee_count,
    mvnee_build: connect::check_mvnee_build,
    omnee_build: connect::check_omnee_build,
    bridge_count: connect::check_bridge_count,
    bridge_build: connect::check_bridge_build,
    lis_vertex: connect::check_lis_vertex,
    lis_join: connect::check_lis_join,
    sift: weigh::check_sift,
    mis_weight: weigh::check_mis_weight,
    phase_quotient: weigh::check_phase_quotient,
    roulette: weigh::check_roulette,
    occlusion: weigh::check_occlusion,
    transmittance: weigh::check_transmittance,
    accumulate: weigh::check_accumulate,
};

/// What kernel and twin left or are.
type Both<T> = (T, T);

/// Runs kernel and twin of a stage on the same columns; gives what each left in the named tables. The columns go on
/// with what the kernel left.
macro_rules! run_both {
    ($stage:ident($step:expr), $tables:tt, $columns:expr) => {
        run_both!((SIMD.$stage, REFERENCE.$stage)($step), $tables, $columns)
    };
    (($simd:expr, $reference:expr)($step:expr), [$($table:ident),*], $columns:expr) => {{
        let before = [$($table.save()),*];
        ($simd)($step, $columns);
        let kernel = [$($table.save()),*];
        run_both!(@restore before, $($table),*);
        ($reference)($step, $columns);
        let twin = [$($table.save()),*];
        run_both!(@restore kernel, $($table),*);
        let mut twin = twin.into_iter();
        kernel.map(|kernel| (kernel, twin.next().expect("as many tables")))
    }};
    (@restore $saved:ident, $($table:ident),*) => {
        let mut saved = $saved.iter();
        $( $table.restore(saved.next().expect("as many tables")); )*
    };
}

mod connect;
mod first;
mod flights;
mod walk;
mod weigh;

type Tolerances<'a> = &'a [(&'a str, Tolerance)];

/// Compares row `row` of table `table`.
fn check_row(stage: &str, (table, row): (usize, usize), (kernel, twin): &Both<Saved>, tolerances: Tolerances<'_>) {
    count_rows(1);
    if let Some(text) = difference(&kernel.row(table, row), &twin.row(table, row), tolerances) {
        fail(stage, row, &text);
    }
}

/// The same for what is found in a grid, where the cell that a point is in, or whether a candidate is a collision, is a
/// decision: a row that is further off is another decision.
fn check_found((table, row): (usize, usize), both: &Both<Saved>, tolerances: Tolerances<'_>) {
    count_rows(1);
    if difference(&both.0.row(table, row), &both.1.row(table, row), tolerances).is_some() {
        count_decisions(1);
    }
}

/// Compares the rows of two queues that have the same lane and, where rows have emitters, the same one; a row that only
/// one of them lists is another decision.
fn check_rows(stage: &str, (kernel, twin): &Both<Saved>, tolerances: Tolerances<'_>) {
    let (kernel_lanes, twin_lanes) = (kernel.indices("lane"), twin.indices("lane"));
    let emitters = kernel.has("emitter").then(|| [kernel, twin].map(|queue| queue.indices("emitter")));
    for (at, lane) in kernel_lanes.iter().enumerate() {
        // A path has several rows only where it meets several lights at infinity, all different.
        let several = twin_lanes.iter().filter(|other| *other == lane).count() > 1;
        let same = |other: usize| !several || emitters.is_none_or(|[own, its]| own[at] == its[other]);
        let Some(other) = (0..twin_lanes.len()).find(|other| twin_lanes[*other] == *lane && same(*other)) else {
            count_decisions(1);
            continue;
        };
        count_rows(1);
        if let Some(text) = difference(&kernel.row(0, at), &twin.row(0, other), tolerances) {
            fail(stage, at, &text);
        }
    }
    count_decisions(twin_lanes.iter().filter(|lane| !kernel_lanes.contains(lane)).count());
}

/// The same, where rows are to be in lane order.
fn check_queue(stage: &str, both: &Both<Saved>, tolerances: Tolerances<'_>) {
    check_rows(stage, both, tolerances);
    if [&both.0, &both.1].into_iter().any(|queue| !queue.indices("lane").is_sorted()) {
        fail(stage, 0, "    rows are not in lane order");
    }
}

/// How far points of `lights` may be apart.
fn light_point(lights: &Lights) -> Tolerance {
    if lights.has_distant() { tolerances::DISTANT_POSITION } else { tolerances::POSITION }
}

/// Compares two sets of paths that go on.
fn check_set(stage: &str, (kernel, twin): &Both<Saved>) {
    if let Some(lane) = kernel.first_difference(twin) {
        fail(stage, lane, "    only one of kernel and twin has the path in a set");
    }
}

/// All lanes, in the set or not.
fn lanes(set: &LaneSet<'_>) -> core::ops::Range<usize> {
    0..set.batches() * LANES
}

/// The slot of `clock` in a ring of so many.
fn slot(clock: u32, slots: usize) -> usize {
    clock as usize % slots
}
