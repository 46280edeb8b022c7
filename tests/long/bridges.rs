//! Variances of bridges.

use std::sync::Arc;

use fogbow::frame::Frame;
use fogbow::scene::{self, document::Override};
use fogbow_kernels::connect::Techniques;
use fogbow_kernels::connect::bridge::Bridge;
use fogbow_kernels::connect::bridge::counts::CountTable;
use fogbow_testing::render::render;

/// Side of the image of the small light in pixels.
const SMALL_LIGHT_SIDE: u32 = 32;

/// The small light in fog with bridges from the first vertex.
fn small_light(settings: &[&str]) -> Frame {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/fog-small");
    let size = format!("film.size=[{SMALL_LIGHT_SIDE}, {SMALL_LIGHT_SIDE}]");
    let settings = [&["render.technique=bridge", "render.starts=1", &size], settings].concat();
    let overrides = settings.iter().map(|setting| Override::parse(setting).expect("a key and a value")).collect();
    scene::load(&folder, overrides).unwrap_or_else(|error| panic!("{error}")).frame
}

/// Variances of a sample, mean over pixels, of ten seeds of a million samples each, in order of size.
fn variances(frame: &Frame) -> Vec<f64> {
    const SAMPLES: u32 = 1_000_000 / (SMALL_LIGHT_SIDE * SMALL_LIGHT_SIDE);
    let variance = |seed: u32| {
        let film = render(&Frame { seed, ..frame.clone() }, [SMALL_LIGHT_SIDE; 2], 0..SAMPLES).0;
        let sum: f64 = film.pixels().map(|pixel| pixel.standard_error[1].powi(2)).sum();
        sum * f64::from(SAMPLES) / f64::from(SMALL_LIGHT_SIDE * SMALL_LIGHT_SIDE)
    };
    let mut variances: Vec<_> = (1..=10).map(variance).collect();
    variances.sort_by(f64::total_cmp);
    variances
}

/// How far the largest of sorted numbers is from the one in the middle, as a factor.
fn instability(sorted: &[f64]) -> f64 {
    sorted[sorted.len() - 1] / sorted[sorted.len() / 2]
}

#[test]
fn no_rare_sample_decides_the_variance_of_bridges() {
    let variances = variances(&small_light(&[]));
    println!("fog-small, variances of ten seeds: {variances:.2?}");
    assert!(instability(&variances) < 2.0, "{variances:.2?}");
}

#[test]
fn counts_without_a_defensive_part_leave_long_detours_to_luck() {
    // Few mean free paths from the light Poisson counts hardly ever insert as many vertices as light in albedo 1 likes
    // to visit.
    let near = [
        "light[0].center=[0, 0, 2]",
        "light[0].radius=1",
        "light[0].radiance=20",
        "medium.scattering=1",
        "medium.phase.g=0",
        "render.min_segments=6",
    ];
    let frame = small_light(&near);
    let tabled = frame.techniques.bridge.clone().expect("a frame with bridges");
    let poisson = Bridge { counts: Arc::new(CountTable::poisson(frame.medium.phase.twin().lobe())), ..tabled.clone() };
    let [tabled, poisson] = [tabled, poisson].map(|bridge| {
        [bridge.defensive, 0.0].map(|defensive| {
            let bridge = Some(Bridge { defensive, ..bridge.clone() });
            variances(&Frame { techniques: Techniques { bridge, ..Techniques::default() }, ..frame.clone() })
        })
    });
    println!("long detours, variances of ten seeds, with and without uniform counts:");
    println!("table {tabled:.1?}\nPoisson {poisson:.1?}");
    // A few samples decide the worst run with Poisson counts alone: by how much it is worse differs, that it is far
    // worse does not.
    let [[tabled, _], [mixed, alone]] = &[tabled, poisson];
    assert!(alone[9] > 50.0 * tabled[9], "worst runs");
    assert!(alone[5] > 5.0 * tabled[5], "medians");
    assert!(alone[9] > 5.0 * mixed[9], "worst runs of Poisson counts");
    assert!(tabled[5] < mixed[5], "medians with uniform counts");
}
