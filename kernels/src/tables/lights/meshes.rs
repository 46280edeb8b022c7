//! Meshes as lights: what holds them, and what is done with many.

use glam::DVec3;

use super::{Emitter, neighbours};

/// Most meshes that are lights of their own, a power of two. Under the rules that look at distances every start looks at
/// every light.
const MOST: usize = 64;

/// What the choice of an emitter among those of its light is proportional to [W/sr]: area times radiance. Where nothing
/// shines, anything will do.
pub fn weight(emitter: &Emitter) -> f64 {
    emitter.intensity()
}

/// Centre of a ball that holds all emitters, and its radius `[m]`.
pub fn bounds(emitters: &[Emitter]) -> (DVec3, f64) {
    if let [only] = emitters {
        return only.bounds();
    }
    let balls = || emitters.iter().map(Emitter::bounds);
    let total: f64 = emitters.iter().map(weight).sum();
    let even = 1.0 / emitters.len() as f64;
    let share = |emitter: &Emitter| if total > 0.0 { weight(emitter) / total } else { even };
    let center: DVec3 = emitters.iter().zip(balls()).map(|(emitter, (center, _))| center * share(emitter)).sum();
    let radius = balls().map(|(at, radius)| (at - center).length() + radius).fold(0.0, f64::max);
    (center, radius)
}

/// The same triangles in at most [`MOST`] meshes: the meshes as they are, or clusters of neighbours.
pub fn few(meshes: Vec<Vec<Emitter>>) -> Vec<Vec<Emitter>> {
    if meshes.len() <= MOST {
        return meshes;
    }
    let all = meshes.concat();
    neighbours::groups(&all, &neighbours::order(&all), MOST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_meshes_become_clusters_of_neighbours() {
        let mesh = |i: u32| {
            let x = i as f32;
            vec![Emitter::triangle([[x, 0.0, 0.0], [x + 0.5, 0.0, 0.0], [x, 0.5, 0.0]], i, false, [1.0; 3])]
        };
        assert_eq!(few((0..64).map(mesh).collect()).len(), 64);
        let clusters = few((0..1000).map(mesh).collect());
        assert_eq!(clusters.len(), MOST);
        assert_eq!(clusters.iter().map(Vec::len).sum::<usize>(), 1000);
        let widest = clusters.iter().map(|cluster| bounds(cluster).1).fold(0.0, f64::max);
        assert!(widest < 10.0, "{widest}");
    }
}
