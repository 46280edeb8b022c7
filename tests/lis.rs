//! Light importance sampling: what its kernels make against the densities of the twins.

use core::f64::consts::TAU;

use fogbow::frame::Frame;
use fogbow_kernels::PathLengths;
use fogbow_kernels::connect::Techniques;
use fogbow_kernels::connect::bridge::reference::Start;
use fogbow_kernels::connect::bridge::{Bridge, Roll};
use fogbow_kernels::connect::lis::reference::{density, vertex_density};
use fogbow_kernels::connect::lis::{Connector, Lis};
use fogbow_kernels::connect::mvnee::{self, Mvnee, Offset};
use fogbow_kernels::emission::reference::normal;
use fogbow_kernels::media::field::Shape;
use fogbow_kernels::media::reference::{Homogeneous, Medium as _, depth_until};
use fogbow_kernels::phase::reference::Phase;
use fogbow_kernels::tables::lights::{Emitter, Lights, Selection};
use fogbow_testing::frames;
use fogbow_testing::frames::clouds::{ball, solid, with_volumes};
use fogbow_testing::recorded;
use fogbow_testing::statistics::{Moments, p_of_counts, p_of_uniformity, p_of_z};
use fogbow_testing::walks::{after_walks, vector};
use glam::DVec3;
use rayon::prelude::*;

/// Samples that a distribution is tested with.
const SAMPLES: usize = 1 << 18;
/// P-value below which a distribution is refused.
const SUSPICIOUS: f64 = 1e-4;
/// Extinction of the medium [1/m].
const EXTINCTION: f64 = 0.5;

/// A frame whose starts see a light of this exponent from all sides, at distances of some mean free paths.
fn frame(g: f32, exponent: Option<f64>, connector: impl Fn(&Frame) -> Connector) -> Frame {
    let plain = Emitter::disk(DVec3::new(0.3, -0.2, 4.0), DVec3::new(0.3, 0.5, -1.0), 0.6, [80.0; 3]);
    let disk = exponent.map_or(plain, |exponent| plain.focused(exponent));
    lit(g, Lights::new(vec![disk], Selection::Uniform), connector)
}

/// The same with other lights.
fn lit(g: f32, lights: Lights, connector: impl Fn(&Frame) -> Connector) -> Frame {
    let mut frame = frames::with_extinction(&frames::fog_facing(0.0, g, [64, 64]), EXTINCTION as f32);
    frame.lengths = PathLengths { min: 1, max: 60 };
    frame.lights = lights;
    frame.techniques = Techniques::default();
    frame.techniques.lis = Some(Lis::new(&frame.medium, connector(&frame)));
    frame
}

/// The same with a ball and a box in thinner fog: extinction that varies along the flights from the light.
fn in_volumes(frame: &Frame, connector: impl Fn(&Frame) -> Connector) -> Frame {
    let block = Shape::block([[-0.5, -1.0, 2.4], [1.5, 0.6, 3.0]]);
    let volumes = vec![ball(DVec3::new(0.4, 0.2, 3.4), 0.5, 1.5), solid(block, 0.9)];
    let mut frame = with_volumes(frame, volumes, 0.8 * EXTINCTION as f32);
    frame.techniques.lis = Some(Lis::new(&frame.medium, connector(&frame)));
    frame
}

fn settings(frame: &Frame) -> Lis {
    frame.techniques.lis.clone().expect("a frame with light importance sampling")
}

/// Connections from the vertices after two scattering events, built by the kernels: the direction in which the path
/// arrives, and the chain from the start to the light point.
fn connections(frame: &Frame, samples: usize, mut visit: impl FnMut(DVec3, &[DVec3])) {
    after_walks(frame, samples, 2, |wavefront| {
        recorded::build_lis(wavefront, &settings(frame));
        for bucket in wavefront.buckets.buckets() {
            for row in bucket.rows() {
                let candidate = wavefront.candidates.bridged.row(row);
                let inserted = &wavefront.chains.vertices[..=bucket.inserted];
                let inserted = inserted.iter().map(|vertex| vector(vertex.row(row)));
                let ends = [candidate.start, candidate.point].map(vector);
                let chain: Vec<_> = [ends[0]].into_iter().chain(inserted).chain([ends[1]]).collect();
                visit(vector(candidate.arriving), &chain);
            }
        }
    });
}

#[test]
fn vertices_made_from_lights_follow_emission_and_flight() {
    // Cells of equal probability: side, and shares of the density's integrals over cosine, azimuth and flight.
    const CELLS: usize = 8;
    let bridge = |frame: &Frame| Connector::Bridge(Bridge::new(Roll::Aligned, &frame.medium, frame.lengths.max));
    let disks = [None, Some(0.0), Some(3.0), Some(50.0), Some(5000.0)].map(|exponent| frame(0.6, exponent, bridge));
    let sphere = Emitter::sphere(DVec3::new(0.3, -0.2, 4.0), 0.6, [80.0; 3]);
    let sphere = lit(0.6, Lights::new(vec![sphere], Selection::Uniform), bridge);
    let corners = [[0.0, 0.0, 4.0], [1.0, 0.2, 4.0], [0.3, 1.0, 4.5]];
    let panel = |both: bool| {
        let triangle = Emitter::triangle(corners, 0, both, [80.0; 3]);
        lit(0.6, Lights::with_meshes(Vec::new(), vec![vec![triangle]], Selection::Uniform), bridge)
    };
    let beams = [&disks[2], &disks[3], &sphere].map(|frame| in_volumes(frame, bridge));
    for frame in disks.into_iter().chain([sphere, panel(false), panel(true)]).chain(beams) {
        let medium = frame.medium.twin(0);
        let emitter = &frame.lights.emitters()[0];
        let mut found = vec![0.0; if emitter.double_sided { 2 } else { 1 } * CELLS.pow(3)];
        connections(&frame, SAMPLES, |_, chain| {
            let [.., vertex, point] = chain else { unreachable!("a vertex and a light point") };
            let (t, w) = (vertex.distance(*point), (*vertex - *point).normalize());
            let normal = normal(emitter, *point, -w).normalize();
            let (tangent, bitangent) = normal.any_orthonormal_pair();
            let back = w.dot(normal) > 0.0 && normal.dot(vector(emitter.normal)) < 0.0;
            // 1 - cos^{k + 2}, from the sine: a narrow beam has cosines of nearly one.
            let sine_squared = w.cross(normal).length_squared();
            let cosine = -(0.5 * (f64::from(emitter.exponent) + 2.0) * (-sine_squared).ln_1p()).exp_m1();
            let azimuth = w.dot(bitangent).atan2(w.dot(tangent)).rem_euclid(TAU) / TAU;
            let passed = depth_until(&medium.strata_of_ray(*point, w), t);
            let shares = [cosine, azimuth, (-passed).exp()];
            let cell = |share: f64| ((share * CELLS as f64) as usize).min(CELLS - 1);
            found[shares.map(cell).into_iter().fold(usize::from(back), |index, cell| index * CELLS + cell)] += 1.0;
        });
        let total: f64 = found.iter().sum();
        let p = p_of_counts(&found, &vec![total / found.len() as f64; found.len()]);
        assert!(p > SUSPICIOUS && total > 2e5, "{emitter:?}: p = {p} of {total} vertices");
    }
}

/// Another density of a vertex from the light: directions closer to the normal, shorter flights.
fn other_vertex_density(disk: &Emitter, point: DVec3, vertex: DVec3) -> f64 {
    let narrow = Emitter { exponent: disk.exponent + 1.0, ..*disk };
    vertex_density(&narrow, &Homogeneous::isotropic(1.5 * EXTINCTION), point, vertex).value()
}

/// Density of the inner vertices of `chain` as a free walk that sets out along the axis.
fn walk_density(phase: &dyn Phase, chain: &[DVec3]) -> f64 {
    let way = chain[chain.len() - 1] - chain[0];
    let (mean, mut direction, mut density) = (0.3 * way.length(), way.normalize(), 1.0);
    for ends in chain[..chain.len() - 1].windows(2) {
        let (length, next) = (ends[0].distance(ends[1]), (ends[1] - ends[0]).normalize());
        density *= phase.density(direction.dot(next)) * (-length / mean).exp() / (mean * length * length);
        direction = next;
    }
    density
}

/// Another density of the inner vertices between start and vertex, where the connector has any.
fn other_connector_density(frame: &Frame, to_vertex: &[DVec3]) -> f64 {
    match &settings(frame).connector {
        Connector::Bridge(_) => walk_density(frame.medium.phase.twin(), to_vertex),
        Connector::Mvnee(mvnee) => {
            let settings = mvnee::reference::Settings::from(mvnee);
            let other =
                mvnee::reference::Settings { offset: Offset::Gaussian, slope: 0.8 * settings.slope, ..settings };
            let made = mvnee::reference::density(&other, &frame.medium.twin(0), to_vertex, 1.0).value();
            // Given the number of edges: it is Poisson-distributed.
            let mean = EXTINCTION * to_vertex[0].distance(to_vertex[to_vertex.len() - 1]);
            let count: f64 = (1..to_vertex.len() - 1).map(|m| mean / m as f64).product();
            made / (count * (-mean).exp())
        }
    }
}

#[test]
fn any_density_over_that_of_the_connections_has_mean_one() {
    // E[h / p] = 1 for every density h of a number of inserted vertices, where p is the twin's density of what the
    // kernels make, and connections with another number of vertices count as nothing.
    let bridge = |frame: &Frame| {
        let bridge = Bridge::new(Roll::Aligned, &frame.medium, frame.lengths.max);
        Connector::Bridge(Bridge { defensive: 1.0, max_inserted: 5, ..bridge })
    };
    let mvnee = |frame: &Frame| Connector::Mvnee(Mvnee::new(&frame.medium, f64::INFINITY, Offset::Ggx));
    let frames = [
        frame(0.5, None, bridge),
        frame(0.4, Some(20.0), bridge),
        in_volumes(&frame(0.4, Some(5.0), bridge), bridge),
        frame(0.6, None, mvnee),
        frame(0.6, Some(20.0), mvnee),
    ];
    let p_values_of = |frame: &Frame| {
        let (disk, medium) = (&frame.lights.emitters()[0], frame.medium.twin(0));
        let mut quotients = [Moments::default(); 8];
        connections(frame, 16 * SAMPLES, |arriving, chain| {
            let (to_vertex, edges) = (&chain[..chain.len() - 1], chain.len() - 1);
            let from = Start { depth: 2, position: chain[0], arriving, on_surface: false };
            let made = density(&settings(frame), &medium, disk, frame.lengths.max, &from, chain, 1.0).value();
            let other = other_vertex_density(disk, chain[edges], chain[edges - 1]);
            for (count, quotient) in quotients.iter_mut().enumerate() {
                // Very short edges may be rounded to nothing.
                let counts = count == edges && made > 0.0;
                quotient.add(if counts { other * other_connector_density(frame, to_vertex) / made } else { 0.0 });
            }
        });
        let connector = settings(frame).connector;
        let p_value = |(edges, quotient): (usize, &Moments)| {
            let (mean, error) = (quotient.mean(), quotient.standard_error());
            let z = (mean - 1.0) / error;
            assert!(z.abs() < 4.0 && error < 0.05, "{connector:?}, {edges} edges: {mean} +- {error}");
            p_of_z(z)
        };
        quotients.iter().enumerate().skip(2).map(p_value).collect::<Vec<_>>()
    };
    let p_values: Vec<_> = frames.par_iter().flat_map_iter(p_values_of).collect();
    assert!(p_values.len() == 30 && p_of_uniformity(&p_values) > SUSPICIOUS, "{p_values:?}");
}
