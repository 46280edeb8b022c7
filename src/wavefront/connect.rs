//! The connections of one bounce: light points, counts, chains, one technique after the other.

use fogbow_kernels::columns::queues::Bucket;
use fogbow_kernels::connect::bridge::{Bridge, sample as bridge_sample};
use fogbow_kernels::connect::light_sample::{self, Reach};
use fogbow_kernels::connect::lis::{self, Lis, Shape, sample as lis_sample};
use fogbow_kernels::connect::mvnee::{Mvnee, sample as mvnee_sample};
use fogbow_kernels::connect::nee;
use fogbow_kernels::connect::omnee::{self, sample as omnee_sample};
use fogbow_kernels::pipeline::{Pipeline, Stage};
use fogbow_kernels::random::{self, Purpose};
use fogbow_kernels::{PathLengths, Step};

use super::settle::Settle;
use super::{Wavefront, rows};
use crate::frame::Frame;
use crate::stats::{Connector, Stats};

impl Wavefront<'_> {
    /// Everything that connects from the current vertices.
    pub(super) fn connect(&mut self, frame: &Frame, pipeline: &Pipeline, stats: &mut Stats) {
        // MVNEE first: it notes which vertices are near a light, and the weights of all candidates rely on that.
        if let Some(mvnee) = &frame.techniques.mvnee {
            self.connect_mvnee(frame, pipeline, mvnee, stats);
        }
        if frame.techniques.nee {
            self.connect_straight(Connector::Nee, nee::REACH, frame, pipeline, stats);
        }
        if frame.techniques.omnee {
            self.connect_omnee(frame, pipeline, stats);
        }
        if let Some(bridge) = &frame.techniques.bridge {
            self.connect_bridge(frame, pipeline, bridge, stats);
        }
        if let Some(lis) = &frame.techniques.lis {
            self.connect_lis(frame, pipeline, lis, stats);
        }
        if let Some(reach) = frame.techniques.companion() {
            self.connect_straight(Connector::Lis, reach, frame, pipeline, stats);
        }
    }

    /// A light point for every vertex within reach.
    fn sample_lights(&mut self, frame: &Frame, pipeline: &Pipeline, reach: Reach, stats: &mut Stats) {
        let Self { paths, vertices, rays, connections, step, .. } = self;
        connections.len = 0;
        let size = stats.lane_rows(&paths.live);
        let reach = reach.from_first(frame.walk.starts);
        stats.run(Stage::LightSample, size, || {
            let columns = light_sample::Columns { paths, vertices, rays, connections };
            (pipeline.light_sample)(&frame.lights, reach, *step, columns);
        });
    }

    fn connect_straight(
        &mut self,
        connector: Connector,
        reach: Reach,
        frame: &Frame,
        pipeline: &Pipeline,
        stats: &mut Stats,
    ) {
        self.sample_lights(frame, pipeline, reach, stats);
        let Self { connections, vertices, trail, paths, chains, suffix, step, .. } = self;
        stats.connections(connector).tried += connections.len as u64;
        let bucket = connections.direct();
        let mut settle = Settle { frame, pipeline, step: *step, paths, vertices, trail, chains, suffix, stats };
        settle.connection(connector, reach.purpose, bucket, connections);
    }

    fn connect_mvnee(&mut self, frame: &Frame, pipeline: &Pipeline, mvnee: &Mvnee, stats: &mut Stats) {
        self.sample_lights(frame, pipeline, mvnee.reach(), stats);
        self.join_by_mvnee(frame, pipeline, mvnee, (frame.lengths, self.step), stats);
        self.settle_buckets(Connector::Mvnee, random::MVNEE_LIGHT, 0, frame, pipeline, stats);
    }

    fn connect_bridge(&mut self, frame: &Frame, pipeline: &Pipeline, bridge: &Bridge, stats: &mut Stats) {
        self.sample_lights(frame, pipeline, bridge.reach(), stats);
        self.join_by_bridge(frame, pipeline, bridge, (frame.lengths, self.step), stats);
        self.settle_buckets(Connector::Bridge, random::BRIDGE_LIGHT, 0, frame, pipeline, stats);
    }

    /// Counts and places the seeds between the ends of the connections, for paths of `lengths` up to there.
    fn join_by_mvnee(
        &mut self,
        frame: &Frame,
        pipeline: &Pipeline,
        mvnee: &Mvnee,
        (lengths, step): (PathLengths, Step),
        stats: &mut Stats,
    ) {
        let Self { connections, buckets, bridged, paths, chains, .. } = self;
        stats.run(Stage::MvneeCount, rows(connections.len), || {
            let columns = mvnee_sample::CountColumns { paths, connections, buckets };
            (pipeline.mvnee_count)(&frame.medium, lengths, step, columns);
        });
        bridged.len = buckets.sort(connections.len);
        stats.run(Stage::MvneeBuild, rows(bridged.len), || {
            let columns = mvnee_sample::BuildColumns { paths, connections, buckets, candidates: bridged, chains };
            (pipeline.mvnee_build)(&frame.medium, mvnee, step, columns);
        });
    }

    /// Counts and places the vertices of bridges between the ends of the connections, for paths of `lengths` up to there.
    fn join_by_bridge(
        &mut self,
        frame: &Frame,
        pipeline: &Pipeline,
        bridge: &Bridge,
        (lengths, step): (PathLengths, Step),
        stats: &mut Stats,
    ) {
        let Self { connections, buckets, bridged, paths, chains, .. } = self;
        stats.run(Stage::BridgeCount, rows(connections.len), || {
            let columns = bridge_sample::CountColumns { paths, connections, buckets };
            (pipeline.bridge_count)(&frame.medium, bridge, lengths, step, columns);
        });
        bridged.len = buckets.sort(connections.len);
        stats.run(Stage::BridgeBuild, rows(bridged.len), || {
            let columns = bridge_sample::BuildColumns { paths, connections, buckets, candidates: bridged, chains };
            (pipeline.bridge_build)(&frame.medium, bridge, step, columns);
        });
    }

    fn connect_lis(&mut self, frame: &Frame, pipeline: &Pipeline, lis: &Lis, stats: &mut Stats) {
        self.sample_lights(frame, pipeline, lis::reach(frame.lengths), stats);
        let Self { connections, ends, paths, step, .. } = self;
        stats.run(Stage::LisVertex, rows(connections.len), || {
            let columns = lis_sample::VertexColumns { paths, connections, ends };
            (pipeline.lis_vertex)(&frame.medium, &frame.lights, lis, *step, columns);
        });
        let step = Step { seed: random::lis_seed(self.step.seed), ..self.step };
        let under = (lis::before_last(frame.lengths), step);
        match &lis.shape {
            Shape::Bridge(bridge) => self.join_by_bridge(frame, pipeline, bridge, under, stats),
            Shape::Mvnee(mvnee) => self.join_by_mvnee(frame, pipeline, mvnee, under, stats),
        }
        let Self { ends, buckets, bridged, chains, .. } = self;
        stats.run(Stage::LisJoin, rows(bridged.len), || {
            (pipeline.lis_join)(lis_sample::JoinColumns { buckets, ends, candidates: bridged, chains });
        });
        self.settle_buckets(Connector::Lis, random::LIS_LIGHT, 1, frame, pipeline, stats);
    }

    fn connect_omnee(&mut self, frame: &Frame, pipeline: &Pipeline, stats: &mut Stats) {
        self.sample_lights(frame, pipeline, omnee::reach(frame.lengths), stats);
        let Self { connections, vertices, trail, paths, chains, suffix, step, .. } = self;
        stats.connections(Connector::Omnee).tried += connections.len as u64;
        stats.run(Stage::OmneeBuild, rows(connections.len), || {
            let columns = omnee_sample::BuildColumns { paths, connections, chains };
            (pipeline.omnee_build)(&frame.medium, *step, columns);
        });
        let bucket = Bucket { inserted: 1, ..connections.direct() };
        let mut settle = Settle { frame, pipeline, step: *step, paths, vertices, trail, chains, suffix, stats };
        settle.connection(Connector::Omnee, random::OMNEE_LIGHT, bucket, connections);
    }

    /// What becomes of connections that were sorted and built, to light points of `purpose`; `appended` vertices were
    /// inserted since they were sorted.
    fn settle_buckets(
        &mut self,
        connector: Connector,
        purpose: Purpose,
        appended: usize,
        frame: &Frame,
        pipeline: &Pipeline,
        stats: &mut Stats,
    ) {
        let Self { connections, buckets, bridged, vertices, trail, paths, chains, suffix, step, .. } = self;
        stats.connections(connector).tried += connections.len as u64;
        let mut settle = Settle { frame, pipeline, step: *step, paths, vertices, trail, chains, suffix, stats };
        for bucket in buckets.buckets().iter().filter(|bucket| bucket.len > 0) {
            let bucket = Bucket { inserted: bucket.inserted + appended, ..*bucket };
            settle.connection(connector, purpose, bucket, bridged);
        }
    }
}
