//! Meshes as lights: what holds them, and what is done with many.

use glam::DVec3;

use super::Emitter;

/// Most meshes that are lights of their own. Under the rules that look at distances every start looks at every light.
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
    let mut clusters = Vec::new();
    split(meshes.into_iter().flatten().collect(), MOST, &mut clusters);
    clusters
}

/// Halves `emitters` at the middle of their longest side until there are `parts` clusters, a power of two.
fn split(mut emitters: Vec<Emitter>, parts: usize, clusters: &mut Vec<Vec<Emitter>>) {
    if parts == 1 || emitters.len() < 2 {
        clusters.push(emitters);
        return;
    }
    let center = |emitter: &Emitter| emitter.bounds().0;
    let (least, most) = emitters
        .iter()
        .map(center)
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
    let axis = (most - least).max_position();
    let middle = emitters.len() / 2;
    emitters.select_nth_unstable_by(middle, |a, b| {
        (center(a)[axis], a.triangle).partial_cmp(&(center(b)[axis], b.triangle)).expect("coordinates are finite")
    });
    let rest = emitters.split_off(middle);
    split(emitters, parts / 2, clusters);
    split(rest, parts / 2, clusters);
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
