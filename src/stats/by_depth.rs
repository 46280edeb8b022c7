//! What walks find, and how many of them get there, by octave of depth.

use fogbow_kernels::survival::{OCTAVES, octave};

/// Steps of contributions that are told apart, from the first on: quarters of binary exponents.
const STEPS: usize = 1024;
const FIRST_STEP: i32 = -512;
/// By which factor contributions of one step may differ: the fourth root of 2.
const STEP: f64 = 1.189_207_115_002_721;

/// Vertices and the contributions made at them, by octave of depth. They are counted, by the step that they are on, so that
/// the result does not depend on the order of work.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ByDepth {
    /// Vertices.
    pub vertices: [u64; OCTAVES],
    contributions: Vec<[u64; STEPS]>,
}

impl ByDepth {
    /// None so far.
    pub fn new() -> Self {
        Self { vertices: [0; OCTAVES], contributions: vec![[0; STEPS]; OCTAVES] }
    }

    /// Adds a vertex at `depth`, >= 1.
    pub fn add_vertex(&mut self, depth: u32) {
        self.vertices[octave(depth)] += 1;
    }

    /// Adds a contribution, >= 0, made at `depth`, >= 1.
    pub fn add(&mut self, depth: u32, contribution: f64) {
        if contribution > 0.0 && contribution.is_finite() {
            let step = (4.0 * contribution.log2()).floor() as i32 - FIRST_STEP;
            self.contributions[octave(depth)][step.clamp(0, STEPS as i32 - 1) as usize] += 1;
        }
    }

    /// About the sums of the contributions and of their squares, by octave.
    pub fn sums(&self) -> [[f64; 2]; OCTAVES] {
        // Of numbers between 1 and s that are all alike.
        let [mean, mean_square] = [(1.0 + STEP) / 2.0, (1.0 + STEP + STEP * STEP) / 3.0];
        let add = |[sum, squares]: [f64; 2], (step, count): (usize, &u64)| {
            let (scale, count) = (STEP.powi(step as i32 + FIRST_STEP), *count as f64);
            [sum + count * mean * scale, squares + count * mean_square * scale * scale]
        };
        core::array::from_fn(|k| self.contributions[k].iter().enumerate().fold([0.0; 2], add))
    }

    pub(super) fn merge(&mut self, other: &Self) {
        self.vertices.iter_mut().zip(other.vertices).for_each(|(sum, other)| *sum += other);
        for (sum, other) in self.contributions.as_flattened_mut().iter_mut().zip(other.contributions.as_flattened()) {
            *sum += other;
        }
    }
}

impl Default for ByDepth {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contributions_add_up_whatever_the_order() {
        let values = || (1..4000).map(|i| (1 + i % 9, f64::from(i) * 0.37));
        let [mut all, mut odd, mut even] = [(); 3].map(|()| ByDepth::new());
        values().for_each(|(depth, value)| all.add(depth, value));
        for (i, (depth, value)) in values().enumerate() {
            if i % 2 == 0 { &mut even } else { &mut odd }.add(depth, value);
        }
        even.merge(&odd);
        assert_eq!(all, even);
        let exact = |power: i32| -> f64 {
            values().filter(|(depth, _)| (4..8).contains(depth)).map(|(_, value)| value.powi(power)).sum()
        };
        for (found, exact) in all.sums()[2].into_iter().zip([exact(1), exact(2)]) {
            assert!((found / exact - 1.0).abs() < 0.1, "{found} of {exact}");
        }
    }
}
