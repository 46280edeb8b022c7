//! The full density of next event estimation, in f64.
//!
//! ```text
//! p(x_n | x_{n-1}) = p_A P_l(x_{n-1})        (area measure) [1/m^2]
//! ```
//!
//! The connection is always attempted, so nothing else enters; one that needs inserted vertices, or that starts behind
//! the light, is never made.

use glam::DVec3;

use crate::connect::density::Density;

/// Density of making `chain`, the vertices from the start to the point on the light.
///
/// `normal` is the light's; `light_density` is p_A P_l at the start.
pub fn density(chain: &[DVec3], normal: DVec3, light_density: f64) -> Density {
    let [start, point] = chain else {
        return Density::ZERO;
    };
    if (*start - *point).dot(normal) <= 0.0 {
        return Density::ZERO;
    }
    Density::new(light_density)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_straight_connections_to_the_front_are_made() {
        let chain = [DVec3::ZERO, DVec3::new(0.5, 0.0, 1.0), DVec3::new(0.0, 0.0, 2.0)];
        assert_eq!(density(&chain[1..], -DVec3::Z, 0.25).value(), 0.25);
        assert_eq!(density(&chain[1..], DVec3::Z, 0.25).value(), 0.0);
        assert_eq!(density(&chain, -DVec3::Z, 0.25).value(), 0.0);
        assert_eq!(density(&[DVec3::ZERO; 2], -DVec3::Z, 0.25).value(), 0.0);
    }
}
