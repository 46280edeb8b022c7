//! The full density of light importance sampling, in f64 (after Weber, Hanika, Dachsbacher 2017).
//!
//! The last inner vertex y of a chain x_i .. y, x_n is made from the point x_n on the light, the others by a connection
//! from x_i to y as if y were on a light. With w and t the direction and distance from x_n to y, theta the angle
//! between w and the normal, and k the exponent of the light,
//!
//! ```text
//! p = p_A P_l * p_dir(w) mu~(t) exp(-tau~(t)) / t^2 * q(x_i .. y)   (volume and area measure)
//! p_dir(w) = (k + 2) / (2 pi) cos^{k+1} theta                       (solid angle, over the hemisphere of the front,
//!                                                                    half of it on either side where both shine)
//! ```
//!
//! where mu~(t) and tau~(t) are extinction and optical depth at and up to t along the ray from x_n in the direction w, as
//! weights see it, and q is the density of a bridge or of MVNEE without that of its light point. The companion has that
//! of next event estimation, within its distance.

use glam::DVec3;

use super::{Connector, Lis};
use crate::connect::bridge::reference::Start;
use crate::connect::density::Density;
use crate::connect::{bridge, mvnee, nee};
use crate::emission::reference::direction_density;
use crate::media::reference::{Medium, depth_until, extinction_along};
use crate::tables::lights::Emitter;

/// Density of making `vertex` from `point` on the emitter (volume measure) [1/m^3].
pub fn vertex_density(emitter: &Emitter, medium: &dyn Medium, point: DVec3, vertex: DVec3) -> Density {
    let flight = (vertex - point).length();
    if flight == 0.0 {
        return Density::ZERO;
    }
    let direction = (vertex - point) / flight;
    let strata = medium.strata_of_ray(point, direction);
    Density::new(direction_density(emitter, point, direction))
        .times(extinction_along(&strata, flight) / (flight * flight))
        .times_exp(-depth_until(&strata, flight))
}

/// Density of making `chain`, the vertices from the start to the point on the light, in a path of at most `longest`
/// segments; `light_density` is p_A P_l at the start. Zero unless a vertex is inserted.
pub fn density(
    lis: &Lis,
    medium: &dyn Medium,
    emitter: &Emitter,
    longest: u32,
    start: &Start,
    chain: &[DVec3],
    light_density: f64,
) -> Density {
    let [to_vertex @ .., point] = chain else {
        return Density::ZERO;
    };
    let [_, .., vertex] = to_vertex else {
        return Density::ZERO;
    };
    let made = vertex_density(emitter, medium, *point, *vertex);
    let joined = match &lis.connector {
        Connector::Mvnee(mvnee) => mvnee::reference::density(&mvnee.into(), medium, to_vertex, light_density),
        Connector::Bridge(bridge) => {
            // One of the segments comes after the vertex.
            let longest = longest.saturating_sub(1);
            bridge::reference::density(bridge, medium, longest, start, to_vertex, light_density)
        }
    };
    joined.product(made)
}

/// Density of the companion making `chain`.
pub fn companion_density(lis: &Lis, chain: &[DVec3], normal: DVec3, light_density: f64) -> Density {
    match chain {
        [start, point] if start.distance(*point) <= f64::from(lis.near) => {
            nee::reference::density(chain, normal, light_density)
        }
        _ => Density::ZERO,
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use super::*;
    use crate::connect::bridge::{Bridge, Roll};
    use crate::connect::mvnee::{Mvnee, Offset};
    use crate::emission::reference::normal;
    use crate::media::Medium;
    use crate::media::reference::Homogeneous;
    use crate::phase::{HenyeyGreenstein, PhaseFunction};
    use core::f64::consts::{FRAC_PI_2, PI};

    const PHASE: HenyeyGreenstein = HenyeyGreenstein { g: 0.5 };
    const MEDIUM: Medium = Medium::homogeneous(0.75, [1.0; 3], PhaseFunction::HenyeyGreenstein(PHASE));
    const FOG: Homogeneous<'_> = Homogeneous::new(0.75, &PHASE);
    const START: Start = Start { depth: 1, position: DVec3::ZERO, arriving: DVec3::X, on_surface: false };

    fn disk(exponent: Option<f64>) -> Emitter {
        let plain = Emitter::disk(DVec3::new(0.3, -1.0, 2.0), DVec3::new(0.2, -0.4, 0.9), 0.5, [1.0; 3]);
        exponent.map_or(plain, |exponent| plain.focused(exponent))
    }

    fn connectors() -> [Lis; 2] {
        let bridge = Connector::Bridge(Bridge::new(Roll::Aligned, &MEDIUM, 9));
        [bridge, Connector::Mvnee(Mvnee::new(&MEDIUM, f64::INFINITY, Offset::Ggx))]
            .map(|connector| Lis::new(&MEDIUM, connector))
    }

    fn made(lis: &Lis, longest: u32, chain: &[DVec3]) -> f64 {
        density(lis, &FOG, &disk(Some(3.0)), longest, &START, chain, 2.0).value()
    }

    #[test]
    fn the_vertex_of_the_light_has_a_density_that_integrates_to_one() {
        let corners = [[1.0, 1.0, 1.0], [2.0, 1.0, 1.0], [1.0, 2.0, 1.5]];
        let panel = Emitter::triangle(corners, 0, true, [1.0; 3]);
        let sphere = Emitter::sphere(DVec3::ONE - 0.5 * DVec3::Y, 0.5, [1.0; 3]);
        let disks = [None, Some(0.0), Some(1.5), Some(50.0)].map(disk);
        for emitter in disks.into_iter().chain([panel, sphere]) {
            let normal = normal(&emitter, DVec3::ONE, DVec3::ZERO);
            let side = normal.any_orthonormal_vector();
            let widest = if emitter.double_sided { PI } else { FRAC_PI_2 };
            let (angles, flights) = (2000, 400);
            let mut sum = 0.0;
            for (i, j) in (0..angles).flat_map(|i| (0..flights).map(move |j| (i, j))) {
                let theta = widest * (f64::from(i) + 0.5) / f64::from(angles);
                // t = v / (1 - v), dt = dv / (1 - v)^2.
                let v = (f64::from(j) + 0.5) / f64::from(flights);
                let t = v / (1.0 - v);
                let vertex = DVec3::ONE + t * (theta.cos() * normal + theta.sin() * side);
                let volume = TAU * t * t * theta.sin() * widest / f64::from(angles) / (1.0 - v).powi(2);
                sum += vertex_density(&emitter, &FOG, DVec3::ONE, vertex).value() * volume / f64::from(flights);
            }
            assert!((sum - 1.0).abs() < 1e-4, "{emitter:?}: {sum}");
        }
    }

    #[test]
    fn nothing_is_made_behind_the_light_or_at_its_point() {
        let (disk, point) = (disk(Some(2.0)), DVec3::ONE);
        let normal = DVec3::from(disk.normal.map(f64::from));
        let made = |vertex: DVec3| vertex_density(&disk, &FOG, point, vertex).value() > 0.0;
        assert!(made(point + normal) && !made(point - normal) && !made(point));
        assert!(!made(point + normal.any_orthonormal_vector() - 1e-3 * normal));
    }

    #[test]
    fn the_chain_is_that_of_the_shape_and_one_vertex_from_the_light() {
        let normal = DVec3::from(disk(None).normal.map(f64::from));
        let point = DVec3::ONE;
        let vertex = point + 0.5 * normal + 0.1 * DVec3::X;
        let between = DVec3::new(0.2, 0.3, 0.9);
        let made_vertex = vertex_density(&disk(Some(3.0)), &FOG, point, vertex).value();
        for lis in connectors() {
            for inner in [vec![], vec![between]] {
                let to_vertex = [vec![DVec3::ZERO], inner, vec![vertex]].concat();
                let chain = [to_vertex.clone(), vec![point]].concat();
                let joined = match &lis.connector {
                    Connector::Bridge(bridge) => bridge::reference::density(bridge, &FOG, 7, &START, &to_vertex, 2.0),
                    Connector::Mvnee(mvnee) => mvnee::reference::density(&mvnee.into(), &FOG, &to_vertex, 2.0),
                };
                let found = made(&lis, 8, &chain);
                assert!((found / (joined.value() * made_vertex) - 1.0).abs() < 1e-12, "{lis:?}: {found}");
            }
        }
    }

    #[test]
    fn straight_connections_and_bridges_without_room_are_never_made() {
        let normal = DVec3::from(disk(None).normal.map(f64::from));
        let (point, vertex) = (DVec3::ONE, DVec3::ONE + 0.5 * normal);
        let chain = [DVec3::ZERO, vertex, point];
        for lis in connectors() {
            assert!(made(&lis, 3, &chain) > 0.0 && made(&lis, 8, &[DVec3::ZERO, point]) == 0.0, "{lis:?}");
            assert_eq!(made(&lis, 8, &[DVec3::ZERO, DVec3::ONE - normal, point]), 0.0, "{lis:?}");
        }
        assert_eq!(made(&connectors()[0], 2, &chain), 0.0);
    }

    #[test]
    fn the_companion_is_next_event_estimation_within_four_mean_free_paths() {
        let [lis, _] = connectors();
        let near = 4.0 / 0.75;
        let made = |distance: f64, normal: DVec3| {
            companion_density(&lis, &[DVec3::ZERO, distance * DVec3::Z], normal, 2.0).value()
        };
        assert_eq!([made(0.99 * near, -DVec3::Z), made(1.01 * near, -DVec3::Z)], [2.0, 0.0]);
        assert_eq!(made(0.5 * near, DVec3::Z), 0.0);
        assert_eq!(companion_density(&lis, &[DVec3::ZERO, DVec3::X, DVec3::Z], -DVec3::Z, 2.0).value(), 0.0);
    }
}
