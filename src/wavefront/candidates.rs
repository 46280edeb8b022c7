//! The candidates of one bounce, by where they come from.

use fogbow_kernels::columns::queues::CandidateQueue;

/// Complete paths, and those about to be completed.
pub struct Candidates<'q> {
    /// Lights seen by the camera.
    pub views: CandidateQueue<'q>,
    /// Lights hit by scattered paths.
    pub light_hits: CandidateQueue<'q>,
    /// Starts and light points of the technique at hand; complete if it inserts as many vertices into each.
    pub connections: CandidateQueue<'q>,
    /// Connections with inserted vertices, bucket by bucket.
    pub bridged: CandidateQueue<'q>,
}

/// Where candidates come from: the queue that they are in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// [`Candidates::views`].
    Views,
    /// [`Candidates::light_hits`].
    LightHits,
    /// [`Candidates::connections`].
    Connections,
    /// [`Candidates::bridged`].
    Bridged,
}

impl<'q> Candidates<'q> {
    /// Those of `source`.
    pub fn of(&self, source: Source) -> &CandidateQueue<'q> {
        match source {
            Source::Views => &self.views,
            Source::LightHits => &self.light_hits,
            Source::Connections => &self.connections,
            Source::Bridged => &self.bridged,
        }
    }

    /// Those of `source`, to change.
    pub fn of_mut(&mut self, source: Source) -> &mut CandidateQueue<'q> {
        match source {
            Source::Views => &mut self.views,
            Source::LightHits => &mut self.light_hits,
            Source::Connections => &mut self.connections,
            Source::Bridged => &mut self.bridged,
        }
    }
}
