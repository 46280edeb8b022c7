//! The connections of a vertex, one technique after the other.

use fogbow_kernels::connect::bridge::Bridge;
use fogbow_kernels::connect::bridge::sample::reference as bridge_sample;
use fogbow_kernels::connect::light_sample::{Scope, reference as light_sample};
use fogbow_kernels::connect::lis::{Connector, Lis, sample::reference as lis_sample};
use fogbow_kernels::connect::mvnee::Mvnee;
use fogbow_kernels::connect::mvnee::sample::reference as mvnee_sample;
use fogbow_kernels::connect::omnee::sample::reference as omnee_sample;
use fogbow_kernels::connect::sequence::Draws;
use fogbow_kernels::connect::{Technique, bridge, lis, nee, omnee};
use fogbow_kernels::random::{self, Purpose};
use fogbow_kernels::{PathLengths, occlusion, roulette};
use glam::DVec3;

use super::Walk;
use crate::frame::Frame;

impl Walk<'_> {
    /// Tries every active technique from the last vertex.
    pub(super) fn connect(&mut self) {
        let techniques = &self.frame.techniques;
        if techniques.nee {
            self.connect_straight(Technique::Nee, nee::SCOPE);
        }
        if let Some(mvnee) = &techniques.mvnee {
            self.connect_through_medium(mvnee);
        }
        if techniques.omnee {
            self.connect_once_more();
        }
        if let Some(bridge) = &techniques.bridge {
            self.connect_by_bridge(bridge);
        }
        if let Some(lis) = &techniques.lis {
            self.connect_from_light(lis);
        }
        if let Some(scope) = techniques.companion() {
            self.connect_straight(Technique::Lis, scope);
        }
    }

    /// Connects the last vertex in a straight line.
    fn connect_straight(&mut self, technique: Technique, scope: Scope) {
        if let Some((emitter, point)) = self.light_point(scope) {
            self.try_connection(technique, scope.purpose, emitter, &[point]);
        }
    }

    /// Connects the last vertex by multiple-vertex next event estimation.
    fn connect_through_medium(&mut self, mvnee: &Mvnee) {
        let Some((emitter, point)) = self.light_point(mvnee.scope()) else {
            return;
        };
        if let Some(mut rest) = self.seeds_to(mvnee, point, self.frame.lengths, self.frame.seed) {
            rest.push(point);
            self.try_connection(Technique::Mvnee, random::MVNEE_LIGHT, emitter, &rest);
        }
    }

    /// The vertices that multiple-vertex next event estimation inserts between the last one and `point`, in a path of
    /// `lengths` up to there.
    fn seeds_to(&self, mvnee: &Mvnee, point: DVec3, lengths: PathLengths, seed: u32) -> Option<Vec<DVec3>> {
        let (start, medium) = (self.last(), self.medium());
        let draws = Draws { pixel: self.pixel, sample: self.sample, depth: self.depth(), seed };
        let count = mvnee_sample::count_seeds(&medium, (point - start).length(), lengths, &draws)?;
        let mut inserted = vec![point; count as usize];
        mvnee_sample::place(&mvnee.into(), &medium, start, point, &draws, &mut inserted);
        Some(inserted)
    }

    /// Connects the last vertex through one inserted vertex.
    fn connect_once_more(&mut self) {
        let Some((emitter, point)) = self.light_point(omnee::scope(self.frame.lengths)) else {
            return;
        };
        let u = omnee_sample::uniforms(self.pixel, self.sample, self.depth(), self.frame.seed);
        let vertex = omnee_sample::place(self.frame.medium().phase.twin(), self.last(), point, u);
        self.try_connection(Technique::Omnee, random::OMNEE_LIGHT, emitter, &[vertex, point]);
    }

    /// Connects the last vertex by a bridge.
    fn connect_by_bridge(&mut self, bridge: &Bridge) {
        let Some((emitter, point)) = self.light_point(bridge.scope()) else {
            return;
        };
        if let Some(mut rest) = self.bridge_to(bridge, point, self.frame.lengths, self.frame.seed) {
            rest.push(point);
            self.try_connection(Technique::Bridge, random::BRIDGE_LIGHT, emitter, &rest);
        }
    }

    /// The vertices of a bridge between the last one and `point`, in a path of `lengths` up to there.
    fn bridge_to(&self, bridge: &Bridge, point: DVec3, lengths: PathLengths, seed: u32) -> Option<Vec<DVec3>> {
        let (start, medium) = (self.last(), self.medium());
        let draws = Draws { pixel: self.pixel, sample: self.sample, depth: self.depth(), seed };
        let arriving = (start - self.path[self.path.len() - 2]).normalize();
        let on_surface = self.first_start() == self.depth() && self.last_surface.is_some();
        let from = bridge::reference::Start { depth: self.depth(), position: start, arriving, on_surface };
        let count = bridge_sample::count_edges(bridge, &medium, lengths, &from, point, &draws)?;
        let mut inserted = vec![point; count as usize];
        bridge_sample::place(bridge, medium.phase, &from, point, &draws, &mut inserted);
        Some(inserted)
    }

    /// Connects the last vertex with one made from a light.
    fn connect_from_light(&mut self, lis: &Lis) {
        let Frame { lights, lengths, seed, .. } = self.frame;
        let Some((emitter, point)) = self.light_point(lis::scope(*lengths)) else {
            return;
        };
        let u = lis_sample::uniforms(self.pixel, self.sample, self.depth(), *seed);
        let vertex = lis_sample::place(&lights.emitters()[emitter], &self.medium(), point, u);
        if !lis_sample::is_within_reach(lis, self.last(), vertex) {
            return;
        }
        let (lengths, seed) = (lis::before_last(*lengths), random::lis_seed(*seed));
        let inserted = match &lis.connector {
            Connector::Bridge(bridge) => self.bridge_to(bridge, vertex, lengths, seed),
            Connector::Mvnee(mvnee) => self.seeds_to(mvnee, vertex, lengths, seed),
        };
        if let Some(mut rest) = inserted {
            rest.extend([vertex, point]);
            self.try_connection(Technique::Lis, random::LIS_LIGHT, emitter, &rest);
        }
    }

    /// The light, and the point on it, that a technique connects the last vertex with, if that is a start.
    fn light_point(&self, scope: Scope) -> Option<(usize, DVec3)> {
        if !light_sample::may_start(scope.from_first(self.frame.walk.starts), self.depth(), self.first_start()) {
            return None;
        }
        let u = light_sample::uniforms(self.pixel, self.sample, self.depth(), scope.purpose, self.frame.seed);
        light_sample::connect(&self.frame.lights, scope, self.last(), u)
    }

    /// Adds the path that goes on from the last vertex through `rest`, whose last point is on the light, if it survives
    /// the roulette and is free. `purpose` is the random dimension of the technique's light point.
    fn try_connection(&mut self, technique: Technique, purpose: Purpose, emitter: usize, rest: &[DVec3]) {
        let mut worth = self.weigh(emitter, rest);
        let contribution = roulette::reference::largest(&self.contribution(emitter, worth));
        let survival = roulette::reference::survival(f64::from(self.frame.roulette), contribution);
        let (pixel, sample, seed) = (self.pixel, self.sample, self.frame.seed);
        if roulette::reference::uniform(pixel, sample, self.depth(), purpose, seed) >= survival {
            return;
        }
        worth.weight /= survival;
        let mut chain = vec![self.last()];
        chain.extend_from_slice(rest);
        let Frame { lights, surfaces, .. } = self.frame;
        let occluded = occlusion::reference::is_occluded(lights, emitter, &chain);
        if !occluded && !occlusion::reference::is_hidden(lights, surfaces, emitter, &chain) {
            self.add(Some(technique), emitter, worth, rest.len() - 1);
        }
    }
}
