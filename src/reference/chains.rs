//! Whole paths from a point to a light, as vertices: for whoever wants to see what a technique makes.

use fogbow_kernels::connect::Technique;
use fogbow_kernels::emission::reference as emission;
use fogbow_kernels::surface::reference as surface_stage;
use fogbow_kernels::{extend, medium_sample, random};
use glam::DVec3;

use super::Walk;
use super::connect::Joined;
use crate::frame::Frame;

/// A path that ends on a light.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// Where it began, its vertices, and the point on the light `[m]`.
    pub vertices: Vec<DVec3>,
    /// How many of them path tracing made, that where the path began included; all of them but for the last where the
    /// path met the light by itself.
    pub walked: usize,
    /// The emitter that it ends on.
    pub emitter: usize,
    /// Whether nothing is in the way.
    pub is_free: bool,
}

/// What one step of a walk came to.
enum Step {
    /// Another vertex.
    Vertex,
    /// The front of an emitter.
    Light(usize, DVec3),
    /// Nothing that sends it on.
    End,
}

/// The path with random numbers `sample` that leaves `from` in the unit `direction`, is traced for `walk` vertices, at
/// least one, and is then joined with a light by `technique`. None if it ends before, or nothing joins.
pub fn connected(
    frame: &Frame,
    from: DVec3,
    direction: DVec3,
    sample: u32,
    walk: u32,
    technique: Technique,
) -> Option<Chain> {
    let mut path = Walk::leaving(frame, (0, sample), from, direction);
    for _ in 0..walk.max(1) {
        let Step::Vertex = path.step() else { return None };
    }
    let Frame { techniques, lengths, lights, .. } = frame;
    let own = techniques.connections(*lengths, lights).filter(|connection| connection.technique == technique);
    let Joined { emitter, rest, .. } = own.into_iter().find_map(|connection| path.join(&connection))?;
    let is_free = path.is_free(emitter, &[&[path.last()], rest.as_slice()].concat());
    let walked = path.path.len();
    Some(Chain { vertices: [path.path, rest].concat(), walked, emitter, is_free })
}

/// The path with random numbers `sample` that leaves `from` in the unit `direction` and is traced until it meets the
/// front of a light, within the longest path of the frame. None if it does not.
pub fn traced(frame: &Frame, from: DVec3, direction: DVec3, sample: u32) -> Option<Chain> {
    let mut path = Walk::leaving(frame, (0, sample), from, direction);
    for _ in 0..frame.lengths.max {
        match path.step() {
            Step::Vertex => {}
            Step::End => return None,
            Step::Light(emitter, point) => {
                let walked = path.path.len();
                let mut vertices = path.path;
                vertices.push(point);
                return Some(Chain { vertices, walked, emitter, is_free: true });
            }
        }
    }
    None
}

impl Walk<'_> {
    /// Flies to whatever comes next.
    fn step(&mut self) -> Step {
        let Frame { lights, surfaces, medium, seed, .. } = self.frame;
        let words = medium_sample::reference::words(self.pixel, self.sample, self.depth(), *seed);
        let (flight, u) = (self.fly(random::uniform(words[0])), [words[1], words[2]].map(random::uniform));
        let met = extend::reference::meet(lights, surfaces, self.last(), self.direction, flight, flight);
        if let Some((index, distance)) = met.lights.first().copied().filter(|(_, distance)| *distance < flight) {
            let point = self.last() + distance * self.direction;
            let shines = emission::cosine(&lights.emitters()[index], point, self.direction) > 0.0;
            return if shines { Step::Light(index, point) } else { Step::End };
        }
        match met.surface {
            Some(hit) if surface_stage::is_black(surfaces, hit, self.direction) => return Step::End,
            Some(hit) => self.reflect(hit, u),
            None if medium.never_scatters() || flight.is_infinite() => return Step::End,
            None => self.scatter(flight, u),
        }
        Step::Vertex
    }
}
