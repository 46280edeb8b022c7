//! Random numbers.

use fogbow_kernels::random;
use fogbow_testing::statistics::{p_of_counts, p_of_uniformity, p_of_z};

/// Keys whose neighbours differ by one in pixel, sample or dimension.
fn neighbours(key: [u32; 3]) -> [[u32; 3]; 4] {
    let [pixel, sample, block] = key;
    [
        [pixel + 1, sample, block],
        [pixel, sample + 1, block],
        [pixel, sample, block + 1],
        [pixel, sample, block + (1 << 16)],
    ]
}

fn uniforms([pixel, sample, block]: [u32; 3], seed: u32) -> [f64; 4] {
    random::words(pixel, sample, block, seed).map(random::uniform)
}

#[test]
fn random_words_are_uniform_and_independent_of_their_neighbours() {
    let keys = || (0..1 << 10).flat_map(|pixel| (0..1 << 10).map(move |i| [pixel, i % 64, (i / 64) << 16 | (i % 7)]));
    let cell = |u: f64| (u * 32.0) as usize;
    let mut p_values = Vec::new();
    for seed in [0, 1, 12345] {
        for word in 0..4 {
            let mut counts = vec![0.0; 4096];
            keys().for_each(|key| counts[(uniforms(key, seed)[word] * 4096.0) as usize] += 1.0);
            p_values.push(p_of_counts(&counts, &[f64::from(1 << 20) / 4096.0; 4096]));
        }
        for (a, b) in [(0, 1), (0, 2), (1, 2), (2, 3), (0, 3), (1, 3)] {
            let mut counts = vec![0.0; 1024];
            keys().for_each(|key| {
                let u = uniforms(key, seed);
                counts[32 * cell(u[a]) + cell(u[b])] += 1.0;
            });
            p_values.push(p_of_counts(&counts, &[f64::from(1 << 20) / 1024.0; 1024]));
        }
        for neighbour in 0..4 {
            for (a, b) in [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2)] {
                let mut counts = vec![0.0; 1024];
                let mut correlation = 0.0;
                keys().for_each(|key| {
                    let (u, v) = (uniforms(key, seed)[a], uniforms(neighbours(key)[neighbour], seed)[b]);
                    counts[32 * cell(u) + cell(v)] += 1.0;
                    correlation += 12.0 * (u - 0.5) * (v - 0.5);
                });
                p_values.push(p_of_counts(&counts, &[f64::from(1 << 20) / 1024.0; 1024]));
                p_values.push(p_of_z(correlation / f64::from(1 << 20).sqrt()));
            }
        }
    }
    let (least, p) = (p_values.iter().fold(1.0, |least: f64, p| least.min(*p)), p_of_uniformity(&p_values));
    println!("{} tests, least p {least:.2e}, uniform with p = {p:.3}", p_values.len());
    assert!(least > 1e-5 && p > 1e-4, "least p-value {least}, uniformity {p}");
}
