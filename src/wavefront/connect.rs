//! The connections of one bounce: light points, counts, chains, one technique after the other.

use fogbow_kernels::columns::queues::Bucket;
use fogbow_kernels::connect::buckets::{BuildColumns, CountColumns};
use fogbow_kernels::connect::light_sample::Scope;
use fogbow_kernels::connect::lis::{self, Connector, Lis};
use fogbow_kernels::connect::{Technique, nee, omnee};
use fogbow_kernels::pipeline::Joint;
use fogbow_kernels::random::{self, Purpose};
use fogbow_kernels::{PathLengths, Step};

use super::stages::rows;
use super::{Source, Wavefront};

impl Wavefront<'_> {
    /// Everything that connects from the current vertices.
    pub fn connect(&mut self) {
        let (frame, lengths) = (self.frame, self.frame.lengths);
        let techniques = &frame.techniques;
        if !techniques.any() {
            return;
        }
        if frame.lights.selection_depends_on_start() || techniques.near().is_finite() {
            self.light_survey();
        }
        if let Some(mvnee) = &techniques.mvnee {
            self.connect_by(Technique::Mvnee, mvnee, mvnee.scope());
        }
        if techniques.nee {
            self.connect_straight(Technique::Nee, nee::SCOPE);
        }
        if techniques.omnee {
            self.connect_once_more(omnee::scope(lengths));
        }
        if let Some(bridge) = &techniques.bridge {
            self.connect_by(Technique::Bridge, bridge, bridge.scope());
        }
        if let Some(lis) = &techniques.lis {
            self.connect_from_light(lis, lis::scope(lengths));
        }
        if let Some(scope) = techniques.companion() {
            self.connect_straight(Technique::Lis, scope);
        }
    }

    /// Connections in a straight line.
    fn connect_straight(&mut self, technique: Technique, scope: Scope) {
        self.light_sample(scope);
        let bucket = self.candidates.connections.direct();
        self.stats.connections(technique).tried += bucket.len as u64;
        self.settle(technique, scope.purpose, Source::Connections, bucket);
    }

    /// Connections through one vertex.
    fn connect_once_more(&mut self, scope: Scope) {
        self.light_sample(scope);
        self.omnee_build();
        let bucket = Bucket { inserted: 1, ..self.candidates.connections.direct() };
        self.stats.connections(Technique::Omnee).tried += bucket.len as u64;
        self.settle(Technique::Omnee, scope.purpose, Source::Connections, bucket);
    }

    /// Connections through as many vertices as the technique draws.
    fn connect_by<T: Joint>(&mut self, technique: Technique, settings: &T, scope: Scope) {
        self.light_sample(scope);
        self.join(settings, self.frame.lengths, self.step);
        self.settle_buckets(technique, scope.purpose, 0);
    }

    /// Connections to a vertex made from the light.
    fn connect_from_light(&mut self, lis: &Lis, scope: Scope) {
        self.light_sample(scope);
        self.join_from_light(lis);
        self.settle_buckets(Technique::Lis, scope.purpose, 1);
    }

    /// Makes a vertex from the light for every connection and joins it with the start; a bucket's rows then insert one
    /// vertex more than it says.
    pub fn join_from_light(&mut self, lis: &Lis) {
        self.lis_vertex(lis);
        let step = Step { seed: random::lis_seed(self.step.seed), ..self.step };
        let lengths = lis::before_last(self.frame.lengths);
        match &lis.connector {
            Connector::Bridge(bridge) => self.join(bridge, lengths, step),
            Connector::Mvnee(mvnee) => self.join(mvnee, lengths, step),
        }
        self.lis_join();
    }

    /// Counts and places the vertices between the ends of the connections, for paths of `lengths` up to there.
    pub fn join<T: Joint>(&mut self, technique: &T, lengths: PathLengths, step: Step) {
        let connections = &self.candidates.connections;
        let (medium, solid) = (self.frame.medium(), self.frame.is_solid());
        let (paths, immersion, last_surface) = (&self.paths, &self.immersion, &self.last_surface);
        self.stats.run(T::COUNT, rows(connections.len), || {
            let count = &mut self.buckets.count;
            let columns =
                CountColumns { technique, medium, lengths, solid, paths, immersion, last_surface, connections, count };
            T::count_kernel(&self.pipeline)(step, columns);
        });
        let candidates = &mut self.candidates.bridged;
        candidates.len = self.buckets.sort(connections.len);
        self.stats.run(T::BUILD, rows(candidates.len), || {
            let (buckets, chains) = (&self.buckets, &mut self.chains);
            let columns = BuildColumns {
                technique,
                medium,
                solid,
                paths,
                immersion,
                last_surface,
                connections,
                buckets,
                candidates,
                chains,
            };
            T::build_kernel(&self.pipeline)(step, columns);
        });
    }

    /// What becomes of connections that were sorted and built, to light points of `purpose`; `appended` vertices were
    /// inserted since they were sorted.
    fn settle_buckets(&mut self, technique: Technique, purpose: Purpose, appended: usize) {
        self.stats.connections(technique).tried += self.candidates.connections.len as u64;
        for index in 0..self.buckets.buckets().len() {
            let bucket = self.buckets.buckets()[index];
            if bucket.len > 0 {
                let bucket = Bucket { inserted: bucket.inserted + appended, ..bucket };
                self.settle(technique, purpose, Source::Bridged, bucket);
            }
        }
    }
}
