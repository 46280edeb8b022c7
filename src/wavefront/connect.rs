//! The connections of one bounce: light points, counts, chains, one technique after the other.

use fogbow_kernels::columns::queues::Bucket;
use fogbow_kernels::connect::buckets::{BuildColumns, CountColumns, LookBack, Since};
use fogbow_kernels::connect::lis::{self, Connector, Lis};
use fogbow_kernels::connect::nee::in_place::Tally;
use fogbow_kernels::connect::{Chain, Connection, Technique};
use fogbow_kernels::pipeline::Joint;
use fogbow_kernels::random;
use fogbow_kernels::tables::lights::Lights;
use fogbow_kernels::{PathLengths, Step};

use super::stages::rows;
use super::{Source, Wavefront};
use crate::film::aov::Origin;
use crate::stats::Stats;

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
        if self.connects_in_place() {
            return self.connect_in_place();
        }
        for connection in techniques.connections(lengths, &frame.lights) {
            self.light_sample(connection.scope);
            match connection.chain {
                Chain::Straight => self.settle_direct(&connection, 0),
                Chain::OnceMore => {
                    self.omnee_build();
                    self.settle_direct(&connection, 1);
                }
                Chain::Mvnee(mvnee) => self.join_and_settle(&connection, mvnee),
                Chain::Bridge(bridge) => self.join_and_settle(&connection, bridge),
                Chain::FromLight(lis) => {
                    self.join_from_light(lis);
                    self.settle_buckets(&connection, 1);
                }
            }
        }
    }

    /// Next event estimation, weighed at once; what can be blocked is traced then.
    fn connect_in_place(&mut self) {
        let blocked = self.frame.is_solid() || !self.frame.lights.are_clear();
        let Tally { tried, weighted, kept } = self.nee(blocked);
        let mut free = kept;
        if blocked {
            let bucket = self.candidates.connections.direct();
            self.occlusion(Source::Connections, bucket);
            self.contribute(Origin::Connection(Technique::Nee), Source::Connections, bucket);
            free = self.worth.count(bucket);
        }
        let detailed = u64::from(self.stats.detailed);
        let stats = self.stats.connections(Technique::Nee);
        stats.tried += tried;
        stats.weighted += detailed * weighted;
        stats.faint += detailed * (weighted - kept);
        stats.occluded += detailed * (kept - free);
    }

    /// Whether connections are weighed as soon as they are drawn: nobody asks for more of them than the radiance that they
    /// bring.
    fn connects_in_place(&self) -> bool {
        let Stats { work, light_by_length, by_depth, .. } = &self.stats;
        let is_asked = work.is_some() || light_by_length.is_some() || by_depth.is_some() || !self.parts.is_empty();
        !is_asked && self.frame.connects_in_place()
    }

    /// What becomes of connections that all insert the same number of vertices.
    fn settle_direct(&mut self, connection: &Connection<'_>, inserted: usize) {
        let bucket = Bucket { inserted, ..self.candidates.connections.direct() };
        self.stats.connections(connection.technique).tried += bucket.len as u64;
        self.settle(connection, Source::Connections, bucket);
    }

    /// Joins through as many vertices as the technique draws.
    fn join_and_settle<T: Joint>(&mut self, connection: &Connection<'_>, settings: &T) {
        let frame = self.frame;
        self.join(settings, Some(&frame.lights), frame.lengths, self.step);
        self.settle_buckets(connection, 0);
    }

    /// Makes a vertex from the light for every connection and joins it with the start; a bucket's rows then insert one
    /// vertex more than it says.
    pub fn join_from_light(&mut self, lis: &Lis) {
        self.lis_vertex(lis);
        let step = Step { seed: random::lis_seed(self.step.seed), ..self.step };
        let lengths = lis::before_last(self.frame.lengths);
        match &lis.connector {
            Connector::Bridge(bridge) => self.join(bridge, None, lengths, step),
            Connector::Mvnee(mvnee) => self.join(mvnee, None, lengths, step),
        }
        self.lis_join();
    }

    /// Counts and places the vertices between the ends of the connections, which are on `lights` if there are any, for
    /// paths of `lengths` up to there.
    pub fn join<T: Joint>(&mut self, technique: &T, lights: Option<&Lights>, lengths: PathLengths, step: Step) {
        let connections = &self.candidates.connections;
        let (medium, solid) = (&self.frame.medium, self.frame.is_solid());
        let (paths, immersion, last_surface) = (&self.paths, &self.immersion, &self.last_surface);
        self.stats.run(T::COUNT, rows(connections.len), || {
            let count = &mut self.buckets.count;
            let columns =
                CountColumns { technique, medium, lengths, solid, paths, immersion, last_surface, connections, count };
            T::count_kernel(&self.pipeline)(step, columns);
        });
        let candidates = &mut self.candidates.bridged;
        let since = if self.frame.techniques.look_back_near() {
            Since::Near(&self.outlook)
        } else if solid {
            Since::Surface(last_surface)
        } else {
            Since::Birth
        };
        let look_back = LookBack { clock: self.step.clock, connections, paths, since };
        candidates.len = self.buckets.sort(connections.len, |b| look_back.of(b));
        self.stats.run(T::BUILD, rows(candidates.len), || {
            let (buckets, chains, pieces) = (&self.buckets, &mut self.chains, &mut self.pieces);
            let columns = BuildColumns {
                technique,
                medium,
                lights,
                solid,
                paths,
                immersion,
                last_surface,
                connections,
                buckets,
                candidates,
                chains,
                pieces,
            };
            T::build_kernel(&self.pipeline)(step, columns);
        });
    }

    /// What becomes of connections that were sorted and built; `appended` vertices were inserted since they were sorted.
    fn settle_buckets(&mut self, connection: &Connection<'_>, appended: usize) {
        self.stats.connections(connection.technique).tried += self.candidates.connections.len as u64;
        for index in 0..self.buckets.buckets().len() {
            let bucket = self.buckets.buckets()[index];
            let bucket = Bucket { inserted: bucket.inserted + appended, ..bucket };
            self.settle(connection, Source::Bridged, bucket);
        }
    }
}
