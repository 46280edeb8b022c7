//! The connections of a vertex, one technique after the other.

use fogbow_kernels::connect::bridge::Bridge;
use fogbow_kernels::connect::bridge::sample::reference::{self as bridge_sample, End};
use fogbow_kernels::connect::light_sample::{Scope, reference as light_sample};
use fogbow_kernels::connect::lis::{Connector, Lis, sample::reference as lis_sample};
use fogbow_kernels::connect::mvnee::Mvnee;
use fogbow_kernels::connect::mvnee::sample::reference as mvnee_sample;
use fogbow_kernels::connect::omnee::sample::reference as omnee_sample;
use fogbow_kernels::connect::sequence::Draws;
use fogbow_kernels::connect::{Chain, Connection, bridge, lis};
use fogbow_kernels::emission::reference::normal;
use fogbow_kernels::random;
use fogbow_kernels::{PathLengths, occlusion, phase_quotient, roulette};
use glam::DVec3;

use super::Walk;
use crate::frame::Frame;

/// What joins a vertex with an emitter.
pub(super) struct Joined {
    /// The emitter.
    pub emitter: usize,
    /// The vertices after the joined one, the last of which is the point on the emitter.
    pub rest: Vec<DVec3>,
    /// Resampling weight: 1 where they were not chosen among others.
    pub resampling: f64,
}

/// Inserted vertices, and their resampling weight.
type Inserted = (Vec<DVec3>, f64);

impl Walk<'_> {
    /// Tries every active technique from the last vertex.
    pub(super) fn connect(&mut self) {
        let Frame { techniques, lengths, lights, .. } = self.frame;
        for connection in techniques.connections(*lengths, lights) {
            self.try_technique(&connection);
        }
    }

    /// Draws a light point and joins the last vertex with it.
    fn try_technique(&mut self, connection: &Connection<'_>) {
        if let Some(joined) = self.join(connection) {
            self.try_connection(connection, &joined);
        }
    }

    /// Joins the last vertex with an emitter.
    pub(super) fn join(&self, connection: &Connection<'_>) -> Option<Joined> {
        let Frame { lengths, seed, .. } = *self.frame;
        let (emitter, point) = self.light_point(connection.scope)?;
        let (mut rest, resampling) = match connection.chain {
            Chain::Straight => (Vec::new(), 1.0),
            Chain::OnceMore => (vec![self.once_more(point)], 1.0),
            Chain::Mvnee(mvnee) => self.seeds_to(mvnee, point, lengths, seed)?,
            Chain::Bridge(bridge) => self.bridge_to(bridge, Some(emitter), point, lengths, seed)?,
            Chain::FromLight(lis) => self.vertices_from_light(lis, emitter, point)?,
        };
        rest.push(point);
        Some(Joined { emitter, rest, resampling })
    }

    /// The vertex that once-more next event estimation inserts between the last one and `point`.
    fn once_more(&self, point: DVec3) -> DVec3 {
        let u = omnee_sample::uniforms(self.pixel, self.sample, self.depth(), self.frame.seed);
        omnee_sample::place(self.frame.medium.phase.twin(), self.last(), point, u)
    }

    /// The vertices that multiple-vertex next event estimation inserts between the last one and `point`, in a path of
    /// `lengths` up to there.
    fn seeds_to(&self, mvnee: &Mvnee, point: DVec3, lengths: PathLengths, seed: u32) -> Option<Inserted> {
        let (start, medium) = (self.last(), self.medium());
        let draws = Draws { seed, ..self.draws() };
        let count = mvnee_sample::count_seeds(&mvnee.into(), &medium, start, point, lengths, &draws)?;
        let mut inserted = vec![point; count as usize];
        mvnee_sample::place(&mvnee.into(), &medium, start, point, &draws, &mut inserted);
        Some((inserted, 1.0))
    }

    /// The vertices of a bridge between the last one and `point`, which is on an emitter if there is one, in a path of
    /// `lengths` up to there.
    fn bridge_to(
        &self,
        bridge: &Bridge,
        emitter: Option<usize>,
        point: DVec3,
        lengths: PathLengths,
        seed: u32,
    ) -> Option<Inserted> {
        let (start, medium) = (self.last(), self.medium());
        let draws = Draws { seed, ..self.draws() };
        let arriving = self.arriving();
        let on_surface = self.is_on_surface();
        let from = bridge::reference::Start { depth: self.depth(), position: start, arriving, on_surface };
        let count = bridge_sample::count_edges(bridge, &medium, lengths, &from, point, &draws)?;
        let mut inserted = vec![point; count as usize];
        let end = End {
            point,
            normal: emitter.map(|emitter| normal(&self.frame.lights.emitters()[emitter], point, point - start)),
        };
        let phase = self.frame.medium.phase.twin();
        let resampling = bridge_sample::place(bridge, phase, &from, &end, &draws, &mut inserted);
        Some((inserted, resampling))
    }

    /// The vertices between the last one and `point` on a light, of which the last is made from there.
    fn vertices_from_light(&self, lis: &Lis, emitter: usize, point: DVec3) -> Option<Inserted> {
        let Frame { lights, lengths, seed, .. } = self.frame;
        let u = lis_sample::uniforms(self.pixel, self.sample, self.depth(), *seed);
        let vertex = lis_sample::place(&lights.emitters()[emitter], &self.medium(), point, u)?;
        if !lis_sample::is_within_reach(lis, self.last(), vertex) {
            return None;
        }
        let (lengths, seed) = (lis::before_last(*lengths), random::lis_seed(*seed));
        let (mut inserted, resampling) = match &lis.connector {
            Connector::Bridge(bridge) => self.bridge_to(bridge, None, vertex, lengths, seed),
            Connector::Mvnee(mvnee) => self.seeds_to(mvnee, vertex, lengths, seed),
        }?;
        inserted.push(vertex);
        Some((inserted, resampling))
    }

    /// The light, and the point on it, that a technique connects the last vertex with, if that is a start.
    fn light_point(&self, scope: Scope) -> Option<(usize, DVec3)> {
        if !light_sample::may_start(scope.from_first(self.frame.walk.starts), self.depth(), self.first_start()) {
            return None;
        }
        let u = light_sample::uniforms(self.pixel, self.sample, self.depth(), scope.purpose, self.frame.seed);
        light_sample::connect(&self.frame.lights, scope, self.last(), u)
    }

    /// Adds the path that goes on from the last vertex as it was `joined`, if it survives the roulette and is free.
    fn try_connection(&mut self, connection: &Connection<'_>, joined: &Joined) {
        let Connection { technique, scope: Scope { purpose, .. }, .. } = *connection;
        let Joined { emitter, ref rest, resampling } = *joined;
        let mut worth = self.weigh(emitter, rest);
        let mut chain = vec![self.last()];
        chain.extend_from_slice(rest);
        let quotient = self.turns(&chain);
        worth.factor = worth.factor.map(|factor| factor * quotient * resampling);
        let contribution = roulette::reference::largest(&self.contribution(emitter, worth));
        let survival = roulette::reference::survival(f64::from(self.frame.roulette), contribution);
        let (pixel, sample, seed) = (self.pixel, self.sample, self.frame.seed);
        if roulette::reference::uniform(pixel, sample, self.depth(), purpose, seed) >= survival {
            return;
        }
        worth.weight /= survival;
        if self.is_free(emitter, &chain) {
            let through = self.comes_through(&chain, purpose, None);
            worth.factor = [0, 1, 2].map(|c| worth.factor[c] * through[c]);
            self.add(Some(technique), emitter, worth, rest.len() - 1);
        }
    }

    /// Whether nothing is in the way of a chain to a point on an `emitter`.
    pub(super) fn is_free(&self, emitter: usize, chain: &[DVec3]) -> bool {
        let Frame { lights, surfaces, .. } = self.frame;
        !occlusion::reference::is_occluded(lights, emitter, chain)
            && !occlusion::reference::is_hidden(lights, surfaces, emitter, chain)
    }

    /// What the turns of a chain from the last vertex count by the phase functions of the media that they are in.
    fn turns(&self, chain: &[DVec3]) -> f64 {
        let arriving = (!self.is_on_surface()).then(|| self.arriving());
        let medium = &self.frame.medium;
        medium.phases.as_ref().map_or(1.0, |_| phase_quotient::reference::quotient(medium, arriving, chain))
    }
}
