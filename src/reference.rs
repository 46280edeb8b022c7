//! One path at a time, in f64: the whole renderer as a chain of the stages' twins.
//!
//! It draws the same random bits as the wavefront, so the two agree sample by sample, but for rounding. A walk of
//! segments j = 0, 1, .. tries, in this order, at each of them
//!
//! 1. to meet a light: a view from the camera by expectation, later a candidate path of j + 1 segments;
//! 2. to scatter, unless the flight ended on a disk;
//! 3. to connect the new vertex x_{j+1} with a light, once per active technique.
//!
//! Whatever made it, a candidate path X counts `C(X) = Le T / (1 + sum of ratios)`.

use fogbow_kernels::connect::light_sample::{Reach, reference as light_sample};
use fogbow_kernels::connect::mvnee::Mvnee;
use fogbow_kernels::connect::mvnee::sample::reference as mvnee_sample;
use fogbow_kernels::connect::nee;
use fogbow_kernels::{accumulate, extend, generate, light_hit, medium_sample, mis_weight, occlusion, random, scatter};
use glam::DVec3;

use crate::frame::Frame;

/// What made a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Technique {
    /// The walk itself, which met a light.
    Path,
    /// Next event estimation.
    Nee,
    /// Multiple-vertex next event estimation.
    Mvnee,
}

/// What one complete path adds to its pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contribution {
    /// Segments of the path, camera and light segment included.
    pub segments: u32,
    /// What made it.
    pub technique: Technique,
    /// Weighted radiance per channel [W/(m^2 sr)].
    pub radiance: [f64; 3],
}

/// The value of one sample: the sum of its [`contributions`], per channel [W/(m^2 sr)].
pub fn radiance(frame: &Frame, pixel: u32, sample: u32) -> [f64; 3] {
    contributions(frame, pixel, sample).iter().fold([0.0; 3], |sum: [f64; 3], contribution| {
        core::array::from_fn(|channel| sum[channel] + contribution.radiance[channel])
    })
}

/// Everything that the path of `sample` of `pixel` finds.
pub fn contributions(frame: &Frame, pixel: u32, sample: u32) -> Vec<Contribution> {
    let (origin, direction) = generate::reference::camera_ray(&frame.camera, pixel, sample, frame.seed);
    let mut walk =
        Walk { frame, pixel, sample, path: vec![origin], direction, throughput: [1.0; 3], found: Vec::new() };
    for segment in 0..frame.walk_segments() {
        let words = medium_sample::reference::words(pixel, sample, segment, frame.seed);
        let flight = medium_sample::reference::flight(walk.extinction(), random::uniform(words[0]));
        if walk.meet_light(segment, flight) || segment + 1 == frame.walk_segments() {
            break;
        }
        walk.scatter(flight, [words[1], words[2]].map(random::uniform));
        if frame.techniques.nee {
            walk.connect_straight();
        }
        if let Some(mvnee) = &frame.techniques.mvnee {
            walk.connect_through_medium(mvnee);
        }
    }
    walk.found
}

/// The state of the path.
struct Walk<'a> {
    frame: &'a Frame,
    pixel: u32,
    sample: u32,
    /// Vertices so far, the camera first.
    path: Vec<DVec3>,
    /// Direction of the ray that leaves the last vertex.
    direction: DVec3,
    /// Product of the albedos so far.
    throughput: [f64; 3],
    found: Vec<Contribution>,
}

impl Walk<'_> {
    fn extinction(&self) -> f64 {
        f64::from(self.frame.medium.extinction)
    }

    /// Depth of the last vertex.
    fn depth(&self) -> u32 {
        self.path.len() as u32 - 1
    }

    fn last(&self) -> DVec3 {
        self.path[self.path.len() - 1]
    }

    /// Adds what the current ray sees of a light, and tells whether the path ends on a disk.
    fn meet_light(&mut self, segment: u32, flight: f64) -> bool {
        let lights = &self.frame.lights;
        let bound = if segment == 0 { f64::INFINITY } else { flight };
        let Some((disk, distance)) = extend::reference::closest(lights, self.last(), self.direction, bound) else {
            return false;
        };
        if light_hit::reference::shows_front(&lights.disks()[disk], self.direction) {
            let point = self.last() + distance * self.direction;
            let weight = match segment {
                0 => light_hit::reference::transmittance(self.extinction(), distance),
                _ => self.weigh(disk, &[point]),
            };
            self.add(Technique::Path, disk, weight, 0);
        }
        light_hit::reference::ends(flight, distance)
    }

    /// Appends the vertex at the end of the flight.
    fn scatter(&mut self, flight: f64, u: [f64; 2]) {
        let medium = &self.frame.medium;
        let event = scatter::reference::scatter(f64::from(medium.phase.g), self.last(), self.direction, flight, u);
        self.path.push(event.position);
        self.direction = event.direction;
        for (throughput, albedo) in self.throughput.iter_mut().zip(medium.albedo) {
            *throughput *= f64::from(albedo);
        }
    }

    /// Connects the last vertex by next event estimation.
    fn connect_straight(&mut self) {
        if let Some((light, point)) = self.light_point(nee::REACH) {
            self.try_connection(Technique::Nee, light, &[point]);
        }
    }

    /// Connects the last vertex by multiple-vertex next event estimation.
    fn connect_through_medium(&mut self, mvnee: &Mvnee) {
        let Some((light, point)) = self.light_point(mvnee.reach()) else {
            return;
        };
        let (start, extinction) = (self.last(), self.extinction());
        let draws =
            mvnee_sample::Draws { pixel: self.pixel, sample: self.sample, depth: self.depth(), seed: self.frame.seed };
        let distance = (point - start).length();
        let Some(inserted) = mvnee_sample::count_seeds(extinction, distance, self.frame.lengths, &draws) else {
            return;
        };
        let mut rest = vec![point; inserted as usize + 1];
        mvnee_sample::place(&mvnee.into(), extinction, start, point, &draws, &mut rest[..inserted as usize]);
        self.try_connection(Technique::Mvnee, light, &rest);
    }

    /// The light, and the point on it, that a technique connects the last vertex with.
    fn light_point(&self, reach: Reach) -> Option<(usize, DVec3)> {
        let u = light_sample::uniforms(self.pixel, self.sample, self.depth(), reach.purpose, self.frame.seed);
        light_sample::connect(&self.frame.lights, reach, self.last(), u)
    }

    /// Adds the path that goes on from the last vertex through `rest`, whose last point is on the light, if it is free.
    fn try_connection(&mut self, technique: Technique, light: usize, rest: &[DVec3]) {
        let weight = self.weigh(light, rest);
        let mut chain = vec![self.last()];
        chain.extend_from_slice(rest);
        if !occlusion::reference::is_occluded(&self.frame.lights, light, &chain) {
            self.add(technique, light, weight, rest.len() - 1);
        }
    }

    /// The weight of the path that goes on from the last vertex through `rest`.
    fn weigh(&self, light: usize, rest: &[DVec3]) -> f64 {
        let Frame { medium, lights, techniques, .. } = self.frame;
        let path = [self.path.as_slice(), rest].concat();
        // Without surfaces every vertex but the camera may start a connection.
        mis_weight::reference::weight(medium, lights, techniques, &path, 1, light)
    }

    /// Adds a candidate with `inserted` vertices after the last one.
    fn add(&mut self, technique: Technique, light: usize, weight: f64, inserted: usize) {
        let Frame { medium, lights, lengths, .. } = self.frame;
        if weight == 0.0 || !accumulate::reference::counts(*lengths, self.depth(), inserted) {
            return;
        }
        let emitted = lights.disks()[light].radiance.map(f64::from);
        let albedo = medium.albedo.map(f64::from);
        let radiance = accumulate::reference::contribution(weight, emitted, self.throughput, albedo, inserted);
        if radiance.iter().all(|channel| channel.is_finite()) {
            self.found.push(Contribution { segments: self.depth() + inserted as u32 + 1, technique, radiance });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fogbow_kernels::PathLengths;
    use fogbow_kernels::connect::Techniques;
    use fogbow_kernels::connect::mvnee::Offset;
    use fogbow_kernels::phase::HenyeyGreenstein;
    use fogbow_kernels::tables::camera::Camera;
    use fogbow_kernels::tables::lights::{Disk, Lights, Selection};
    use fogbow_kernels::tables::media::Medium;

    fn frame(albedo: f32, lengths: PathLengths) -> Frame {
        let medium = Medium { extinction: 0.5, albedo: [albedo; 3], phase: HenyeyGreenstein { g: 0.5 } };
        let disk = |z: f64, normal: DVec3| Disk::new(DVec3::new(0.0, 0.0, z), normal, 2.0, [1.0, 2.0, 3.0]);
        Frame {
            camera: Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 0.02, 0.0, [4, 4]),
            medium,
            lights: Lights::new(vec![disk(3.0, -DVec3::Z), disk(4.0, DVec3::Z)], Selection::IntensityDistance),
            techniques: Techniques { nee: true, mvnee: Some(Mvnee::new(&medium, 8.0, Offset::Ggx)) },
            lengths,
            seed: 7,
        }
    }

    #[test]
    fn a_light_behind_an_absorber_is_attenuated_in_every_sample() {
        let frame = frame(0.0, PathLengths { min: 1, max: 9 });
        for sample in 0..20 {
            let [red, _, blue] = radiance(&frame, 5, sample);
            assert!((red / (-1.5_f64).exp() - 1.0).abs() < 1e-4 && (blue / red - 3.0).abs() < 1e-12, "{red} {blue}");
        }
    }

    #[test]
    fn contributions_keep_to_the_path_lengths() {
        let frame = frame(1.0, PathLengths { min: 2, max: 5 });
        let found: Vec<_> = (0..400).flat_map(|sample| contributions(&frame, 9, sample)).collect();
        assert!(found.iter().all(|contribution| (2..=5).contains(&contribution.segments)));
        for technique in [Technique::Path, Technique::Nee, Technique::Mvnee] {
            for segments in 2..=5 {
                let made = |c: &&Contribution| c.technique == technique && c.segments == segments;
                assert!(found.iter().filter(made).count() > 0, "{technique:?} makes no path of {segments} segments");
            }
        }
    }
}
