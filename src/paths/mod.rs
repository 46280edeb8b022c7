//! Connections to look at: paths that a technique makes from a point to a light, and their drawing.

mod drawing;

use fogbow_kernels::connect::Technique;
use fogbow_kernels::emission::reference as emission;
use fogbow_kernels::tables::lights::Shape;
use glam::DVec3;

use crate::frame::Frame;
use crate::reference::chains::{self, Chain};
pub use drawing::{csv, panel};

/// Random numbers that are tried for every path that is asked for.
const TRIES_PER_PATH: u32 = 100_000;

/// The paths that are asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Where they begin `[m]`.
    pub from: DVec3,
    /// The unit direction in which they leave from there.
    pub direction: DVec3,
    /// How many of them.
    pub count: u32,
    /// What joins them with a light; none for path tracing alone, which goes on until it meets one.
    pub technique: Option<Technique>,
    /// Vertices that path tracing makes before that, at least one.
    pub walk: u32,
    /// The light that they end on, by its place in the scene; none for any.
    pub light: Option<u32>,
}

/// The paths that were found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// At most as many as were asked for.
    pub paths: Vec<Chain>,
    /// How many were tried.
    pub tried: u32,
}

/// The first paths of `frame` that `request` asks for.
pub fn find(frame: &Frame, request: &Request) -> Found {
    let Request { from, direction, count, technique, walk, light } = *request;
    let mut found = Found { paths: Vec::new(), tried: 0 };
    while found.paths.len() < count as usize && found.tried < count.saturating_mul(TRIES_PER_PATH) {
        let sample = found.tried;
        let path = match technique {
            Some(technique) => chains::connected(frame, from, direction, sample, walk, technique),
            None => chains::traced(frame, from, direction, sample),
        };
        found.tried += 1;
        let is_meant = |path: &Chain| {
            let emitter = &frame.lights.emitters()[path.emitter];
            let is_light =
                light.is_none_or(|light| frame.lights.given()[light as usize].contains(&(path.emitter as u32)));
            let [.., before, point] = path.vertices.as_slice() else { return false };
            // What arrives at the back of a light counts nothing.
            is_light && path.is_free && emission::cosine(emitter, *point, *point - *before) > 0.0
        };
        found.paths.extend(path.filter(is_meant));
    }
    found
}

/// The middle of what a frame's lights are, `light` or all of them `[m]`; none if nothing shines from a place.
pub fn middle(frame: &Frame, light: Option<u32>) -> Option<DVec3> {
    let lights = frame.lights.given();
    let all = light.map_or(0..lights.len(), |light| light as usize..light as usize + 1);
    let centers: Vec<_> = lights.get(all)?.iter().map(|light| frame.lights.center(light)).collect();
    (!centers.is_empty()).then(|| centers.iter().sum::<DVec3>() / centers.len() as f64)
}

/// Points around the outlines of the emitters, as they are drawn `[m]`.
fn outlines(frame: &Frame) -> Vec<Vec<DVec3>> {
    const STEPS: u32 = 48;
    let point = |v: [f32; 3]| DVec3::from(v.map(f64::from));
    let near = frame.lights.emitters().iter().take(frame.lights.first_distant() as usize);
    near.map(|emitter| {
        let [origin, tangent, bitangent] = [emitter.origin, emitter.tangent, emitter.bitangent].map(point);
        if emitter.shape == Shape::Triangle {
            return vec![origin, origin + tangent, origin + bitangent, origin];
        }
        let around = |k: u32| {
            let (sin, cos) = (core::f64::consts::TAU * f64::from(k) / f64::from(STEPS)).sin_cos();
            origin + f64::from(emitter.radius) * (cos * tangent + sin * bitangent)
        };
        (0..=STEPS).map(around).collect()
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;

    fn frame(keys: &str) -> Frame {
        let text = format!(
            "[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, 1]\nvertical_fov_deg = 50\n\
             [medium]\nscattering = 1.0\nphase = {{ type = \"henyey_greenstein\", g = 0.8 }}\n[[light]]\n\
             type = \"disk\"\ncenter = [0, 0, 6]\nnormal = [0, 0, -1]\nradius = 0.5\nradiance = 1.0\n{keys}"
        );
        scene::parse("test.toml", &text).unwrap_or_else(|error| panic!("{error}")).frame
    }

    fn request(technique: Option<Technique>) -> Request {
        let direction = DVec3::new(0.6, 0.0, 0.8);
        Request { from: DVec3::ZERO, direction, count: 10, technique, walk: 1, light: None }
    }

    #[test]
    fn paths_leave_as_asked_and_end_on_the_light() {
        for technique in ["path", "nee", "mvnee", "omnee", "bridge", "lis"] {
            let frame = frame(&format!("[render]\ntechnique = \"{technique}\"\nmax_segments = 30"));
            let technique = Technique::ALL.into_iter().find(|known| known.name() == technique);
            let found = find(&frame, &request(technique));
            assert_eq!(found.paths.len(), 10, "{technique:?}");
            assert!(found.tried >= 10);
            for path in found.paths {
                let [first, second, .., end] = path.vertices.as_slice() else { panic!("{technique:?}: {path:?}") };
                assert_eq!(*first, DVec3::ZERO);
                let direction = (*second - *first).normalize();
                assert!(direction.distance(request(technique).direction) < 1e-6, "{technique:?}: {direction}");
                assert!((end.z - 6.0).abs() < 1e-5 && end.truncate().length() < 0.5 + 1e-5, "{technique:?}: {end}");
            }
        }
    }

    #[test]
    fn walks_are_as_long_as_asked() {
        let frame = frame("[render]\ntechnique = \"nee\"\nmax_segments = 30");
        let walked = Request { walk: 7, ..request(Some(Technique::Nee)) };
        let paths = find(&frame, &walked).paths;
        assert!(paths.len() == 10 && paths.iter().all(|path| path.vertices.len() == 9 && path.walked == 8));
    }

    #[test]
    fn paths_end_on_the_light_that_is_asked_for() {
        let more = "[[light]]\ntype = \"sphere\"\ncenter = [4, 0, 0]\nradius = 0.5\nradiance = 1.0\n[render]\n\
                    technique = \"bridge\"";
        let frame = frame(more);
        for (light, center) in [(0, DVec3::new(0.0, 0.0, 6.0)), (1, DVec3::new(4.0, 0.0, 0.0))] {
            let asked = Request { light: Some(light), ..request(Some(Technique::Bridge)) };
            assert_eq!(middle(&frame, Some(light)), Some(center));
            for path in find(&frame, &asked).paths {
                assert!(path.vertices[path.vertices.len() - 1].distance(center) < 0.5 + 1e-5);
            }
        }
        assert_eq!(middle(&frame, None), Some(DVec3::new(2.0, 0.0, 3.0)));
    }
}
