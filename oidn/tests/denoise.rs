//! The library of this machine, if there is one.

use fogbow_oidn::{Images, Library};

#[path = "../../tests/support/src/not_run.rs"]
mod not_run;

const SIDE: usize = 48;

/// A number in [0, 1) that looks random.
fn noise(seed: usize) -> f32 {
    let hash = (seed as u32 ^ 0x9e37_79b9).wrapping_mul(0x85eb_ca6b);
    ((hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35) >> 8) as f32 / (1 << 24) as f32
}

/// Grey of radiance `level` with noise of as much, of one albedo and one normal.
fn images(level: f32) -> [Vec<[f32; 3]>; 3] {
    let colour = (0..SIDE * SIDE).map(|i| [2.0 * level * noise(i); 3]).collect();
    [colour, vec![[0.5; 3]; SIDE * SIDE], vec![[0.0, 0.0, 1.0]; SIDE * SIDE]]
}

#[test]
fn noise_goes_and_the_mean_stays_whatever_the_brightness() {
    let library = match Library::load() {
        Ok(library) => library,
        Err(error) => return not_run::not_run(error),
    };
    assert!(library.version().expect("a version").starts_with("2."));
    for level in [1e-4, 1.0, 1e4] {
        let [colour, albedo, normal] = images(level);
        let images = Images { width: SIDE, height: SIDE, colour: &colour, albedo: &albedo, normal: &normal };
        let found = library.denoise(&images, 1).expect("an image");
        let deviation = |image: &[[f32; 3]]| {
            let mean = image.iter().map(|rgb| rgb[1]).sum::<f32>() / image.len() as f32;
            (mean, (image.iter().map(|rgb| (rgb[1] - mean).powi(2)).sum::<f32>() / image.len() as f32).sqrt())
        };
        let ((mean, before), (denoised, after)) = (deviation(&colour), deviation(&found));
        assert!(after < 0.2 * before, "{level}: {before} to {after}");
        assert!((denoised / mean - 1.0).abs() < 0.1, "{level}: {mean} to {denoised}");
    }
}

#[test]
fn a_library_that_is_missing_says_so() {
    if let Err(error) = Library::load() {
        assert!(error.to_string().contains("OpenImageDenoise"), "{error}");
    }
}
