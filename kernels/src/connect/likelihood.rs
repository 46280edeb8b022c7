//! What lengths of walks say of their number of edges.

use wide::f32x8;

use crate::transcendental::{exp, neg_ln};

/// What a walk's length says of its number of edges N: the density x^N e^-x / (N-1)!, up to a factor 1/x.
#[derive(Clone, Copy, Debug)]
pub struct LengthLikelihood {
    edges: f32,
    inverse_edges: f32,
    /// c_N = N - N ln N + ln (N - 1)!
    scale: f32,
}

impl LengthLikelihood {
    /// That of `edges` edges, >= 1.
    pub fn new(edges: usize) -> Self {
        let n = edges as f64;
        let log_factorial: f64 = (1..edges).map(|k| (k as f64).ln()).sum();
        let scale = n - n * n.ln() + log_factorial;
        Self { edges: n as f32, inverse_edges: (1.0 / n) as f32, scale: scale as f32 }
    }

    /// `(N-1)! e^x / x^N e^log` for x = `depth`, the optical length of a path.
    #[inline(always)]
    pub fn inverse(&self, depth: f32x8, log: f32x8) -> f32x8 {
        let [n, inverse, scale] = [self.edges, self.inverse_edges, self.scale].map(f32x8::splat);
        let y = depth * inverse;
        exp((y - f32x8::ONE + neg_ln(y)).mul_add(n, scale) + log)
    }
}
