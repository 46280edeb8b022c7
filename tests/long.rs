//! The long suite: statistics that take minutes.
//!
//! ```text
//! cargo test --release --features long --test long
//! ```

use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

use fogbow::frame::Frame;
use fogbow::pilot;
use fogbow::render::{Monitor, Renderer};
use fogbow::scene::{self, document::Override};
use fogbow::truncation::{self, Truncation};
use fogbow::volume::Leaf;
use fogbow_kernels::connect::Techniques;
use fogbow_kernels::connect::bridge::Bridge;
use fogbow_kernels::connect::bridge::counts::CountTable;
use fogbow_kernels::random;
use fogbow_kernels::tables::lights::Selection;
use fogbow_testing::agreement::assert_equal_means;
use fogbow_testing::frames::{self, Active};
use fogbow_testing::meshes;
use fogbow_testing::rays::{Departures, depart, leaks};
use fogbow_testing::render::{WORKERS, green, render};
use fogbow_testing::statistics::{p_of_counts, p_of_uniformity, p_of_z, z_of_means};
use fogbow_testing::truths;
use fogbow_testing::{volume_writer, volumes};
use glam::DVec3;

/// Mean of a scene to a standard error of `goal`, against a published one of error `known`.
fn assert_mean(name: &str, frame: &Frame, expected: f64, known: f64, goal: f64) {
    let size = [64, 64];
    let mut samples = 1000;
    loop {
        let (mean, error) = green(&render(frame, size, 0..samples).0);
        if error <= goal {
            let z = (mean - expected) / error.hypot(known);
            println!("{name}: {mean:.5} +- {error:.5}, expected {expected} +- {known}, z = {z:.2}");
            assert!(z.abs() < 3.5, "{name}: {mean} +- {error}");
            return;
        }
        samples = (f64::from(samples) * (error / goal).powi(2) * 1.1) as u32;
    }
}

#[test]
fn means_of_fog_facing_are_those_of_independent_programs() {
    let size = [64, 64];
    for active in Active::ALL {
        let with = |near: f64, g: f32| frames::with_techniques(&frames::fog_facing(near, g, size), active, 4.0);
        assert_mean(&format!("near 1, g .9, {active:?}"), &with(1.0, 0.9), 1.7004, 0.0005, 0.001);
        assert_mean(&format!("near 0, g .9, {active:?}"), &with(0.0, 0.9), 1.2838, 0.0004, 0.001);
        assert_mean(&format!("near 1, g 0, {active:?}"), &with(1.0, 0.0), 0.1847, 0.0002, 0.0005);
    }
    let tight = |name: &str, frame: &Frame, expected: f64, known: f64| {
        assert_mean(&format!("{name}, tight"), frame, expected, known, 0.0004);
    };
    let mvnee = |near: f64| frames::fog_facing(near, 0.9, size);
    tight("near 1, g .9, Mvnee", &mvnee(1.0), 1.7004, 0.0005);
    tight("near 0, g .9, Mvnee", &mvnee(0.0), 1.2838, 0.0004);
    for starts in [1, 4, u32::MAX] {
        let bridge = |near: f64| frames::with_techniques(&mvnee(near), Active::Bridge, 4.0).with_walk(starts, 1.0);
        tight(&format!("near 1, g .9, Bridge, {starts} starts"), &bridge(1.0), 1.7004, 0.0005);
        tight(&format!("near 0, g .9, Bridge, {starts} starts"), &bridge(0.0), 1.2838, 0.0004);
    }
}

/// What a shipped scene leaves out, with these settings.
fn left_out(folder: &str, settings: &[&str]) -> Option<Truncation> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(folder);
    let overrides = settings.iter().map(|setting| Override::parse(setting).expect("a key and a value")).collect();
    let scene = scene::load(&folder, overrides).unwrap_or_else(|error| panic!("{error}"));
    let renderer = Renderer::new(WORKERS).expect("threads start");
    truncation::estimate(&scene.frame, scene.scene.film.size, &renderer, &Monitor::default())
}

#[test]
fn the_limit_offered_for_a_shipped_scene_does() {
    let scenes = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    for folder in std::fs::read_dir(scenes).expect("scenes").map(|entry| entry.expect("an entry")) {
        if !folder.path().join("scene.toml").exists() {
            continue;
        }
        let name = folder.file_name().into_string().expect("UTF-8");
        for size in ["film.size=[256, 256]", "film.size=[8, 8]", "film.size=[1, 1]"] {
            let found = left_out(&name, &[size]).expect("fog");
            println!("{name}, {size}: {found:?}");
            let Some(limit) = found.sufficient else { continue };
            let enough = left_out(&name, &[size, &format!("render.max_segments={limit}")]).expect("fog");
            assert!(!enough.matters(), "{name}, {size}: {found:?}, then {enough:?}");
        }
    }
}

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

#[test]
fn light_across_the_view_has_the_mean_of_an_independent_program() {
    for active in Active::ALL {
        let frame = frames::with_techniques(&frames::fog(1.0, 0.6, DVec3::Y, [64, 64]), active, 4.0);
        assert_mean(&format!("fog-perpendicular, {active:?}"), &frame, 0.23981, 0.00026, 0.0006);
    }
    let bridge = frames::with_techniques(&frames::fog(1.0, 0.6, DVec3::Y, [64, 64]), Active::Bridge, 4.0);
    assert_mean("fog-perpendicular, Bridge, tight", &bridge, 0.23981, 0.00026, 0.0002);
}

#[test]
fn techniques_agree_tile_by_tile_and_their_p_values_are_uniform() {
    let size = [32, 32];
    for (name, base, mesc) in [
        ("fog-facing", frames::fog_facing(1.0, 0.8, size), 4.0),
        ("three lights", frames::three_lights(0.6, Selection::IntensityDistance, size), 2.5),
    ] {
        for segments in [2, 3, 5, 8] {
            let with = |active: Active| {
                let frame = Frame { seed: 7 + active as u32, ..frames::with_techniques(&base, active, mesc) };
                let film = render(&frames::with_length(&frame, segments), size, 0..4000).0;
                // Means of tiles of 8 x 8 pixels.
                let tile = |x: u32, y: u32| {
                    let pixels =
                        (y..y + 8).flat_map(|y| (x..x + 8).map(move |x| (x, y))).map(|(x, y)| film.pixel(x, y));
                    let (mut mean, mut variance) = (0.0, 0.0);
                    pixels.for_each(|pixel| {
                        mean += pixel.mean[1] / 64.0;
                        variance += (pixel.standard_error[1] / 64.0).powi(2);
                    });
                    (mean, variance.sqrt())
                };
                (0..32)
                    .step_by(8)
                    .flat_map(|y| (0..32).step_by(8).map(move |x| (x, y)))
                    .map(|(x, y)| tile(x, y))
                    .collect::<Vec<_>>()
            };
            let nee = with(Active::Nee);
            for active in Active::ALL.into_iter().filter(|active| ![Active::Path, Active::Nee].contains(active)) {
                let p_values: Vec<_> = with(active).iter().zip(&nee).map(|(a, b)| p_of_z(z_of_means(*a, *b))).collect();
                let p = p_of_uniformity(&p_values);
                println!("{name}, {segments} segments, {active:?}: p-values uniform with p = {p:.3}");
                assert!(p > 1e-4, "{name}, {segments} segments, {active:?}: {p_values:?}");
            }
        }
    }
}

#[test]
fn all_techniques_have_equal_means_for_every_lobe() {
    let size = [16, 16];
    for g in [-0.9, -0.5, 0.3, 0.9, 0.97] {
        let base = frames::three_lights(g, Selection::IntensityDistance, size);
        let with = |active: Active| {
            let frame = Frame { seed: 1000 + active as u32, ..frames::with_techniques(&base, active, 3.0) };
            render(&frame, size, 0..40_000).0.mean()
        };
        let truth = with(Active::Path);
        for active in Active::ALL.into_iter().filter(|active| *active != Active::Path) {
            let (mean, error) = with(active);
            let z = [0, 1, 2].map(|i| z_of_means((mean[i], error[i]), (truth.0[i], truth.1[i])));
            println!("g {g}, {active:?}: z = {z:.2?}");
            assert!(z.iter().all(|z| z.abs() < 4.0), "g {g}, {active:?}: z = {z:?}");
        }
    }
}

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

#[test]
fn every_technique_has_the_mean_that_every_scene_promises_among_surfaces() {
    for (name, size, expected, known, certainty) in [
        ("dense-plate", [64, 64], 0.1864, 0.0002, 0.12),
        ("cornell-fog", [64, 64], 0.2233, 0.0003, 0.12),
        ("cornell-fog-thin", [64, 64], 0.14504, 0.00009, 0.06),
        ("spotlight", [64, 64], 0.0897, 0.00035, 0.3),
        ("colonnade", [80, 36], 0.808, 0.004, 0.05),
    ] {
        for active in Active::ALL {
            let (mean, error) = green(&render(&frames::shipped(name, size, active), size, 0..600).0);
            let z = (mean - expected) / error.hypot(known);
            assert!(z.abs() < 4.0, "{name}, {active:?}: {mean} +- {error}, expected {expected}, z = {z}");
            assert!(error < certainty * expected, "{name}, {active:?}: {mean} +- {error} says little");
        }
    }
}

#[test]
fn every_technique_has_the_mean_of_an_independent_program_in_a_cloud() {
    let (name, size) = ("cloud-box", [64, 64]);
    // Mitsuba 3.9 with the same numbers in its grid: scenes/cloud-box/in_mitsuba.py.
    let (expected, known) = ([0.81802, 0.81846, 0.77027], [0.00035, 0.00034, 0.00034]);
    for active in frames::clouds::IN_FIELDS {
        let (mean, error) = render(&frames::shipped(name, size, active), size, 0..1500).0.mean();
        let z = [0, 1, 2].map(|i| (mean[i] - expected[i]) / error[i].hypot(known[i]));
        assert!(z.iter().all(|z| z.abs() < 4.0), "{active:?}: {mean:?} +- {error:?}, z = {z:?}");
        assert!(error[1] < 0.001, "{active:?}: {error:?} is too uncertain");
    }
}

#[test]
fn every_technique_has_the_mean_of_an_independent_program_behind_a_perforated_plate() {
    let (name, size) = ("dense-plate", [64, 64]);
    let (expected, known) = truths::mean(name);
    assert!((expected[1] - 0.1864).abs() < 0.000_05 && known[1] < 0.000_065, "{name}: {expected:?} +- {known:?}");
    let shipped = |active: Active| frames::shipped(name, size, active);
    // Most connections are blocked by the plate: roulette before they are traced pays with many starts.
    let all_starts = Frame { roulette: 0.1, ..shipped(Active::Bridge) };
    let one_start = Frame { seed: 20, ..shipped(Active::Bridge) }.with_walk(1, 1.0);
    for (technique, frame, samples, goal) in [
        ("path", shipped(Active::Path), 18_000, 0.0006),
        ("mvnee", shipped(Active::Mvnee), 8000, 0.0004),
        ("bridge, one start", one_start, 9000, 0.00012),
        ("bridge, all starts", all_starts, 3000, 0.00012),
        ("lis", shipped(Active::Lis), 1600, 0.0005),
        ("omnee and nee", shipped(Active::Omnee), 5000, 0.0006),
        ("nee", shipped(Active::Nee), 9000, 0.0007),
    ] {
        let (mean, error) = render(&frame, size, 0..samples).0.mean();
        let z = [0, 1, 2].map(|i| (mean[i] - expected[i]) / error[i].hypot(known[i]));
        println!("{name}, {technique}: {mean:.5?} +- {error:.5?}, z = {z:.2?}");
        assert!(z.iter().all(|z| z.abs() < 3.5), "{name}, {technique}: {mean:?} +- {error:?}, z = {z:?}");
        assert!(error[1] < goal, "{name}, {technique}: {error:?} is too uncertain");
    }
}

#[test]
fn ten_million_rays_stay_in_closed_meshes() {
    assert_eq!(leaks(&meshes::cube(), 0.9, 3_000_000, 101), 0);
    assert_eq!(leaks(&meshes::sphere(4), 0.9, 3_000_000, 102), 0);
    assert_eq!(leaks(&meshes::bumpy_sphere(6), 0.6, 4_000_000, 103), 0);
}

#[test]
fn millions_of_rays_leave_surfaces_to_the_side_they_go_to() {
    assert_eq!(depart(&meshes::cube(), 3_000_000, 104), Departures::default());
    assert_eq!(depart(&meshes::sphere(5), 3_000_000, 105), Departures::default());
}

#[test]
fn a_hundred_thousand_damaged_volumes_are_grids_or_errors() {
    println!("{:?}", volumes::damage(1 << 32, 100_000));
}

/// Voxels along the edge of a large grid, which is mostly empty: 3.5 GB if it were not.
const LARGE: i32 = 960;
/// Memory that such a grid is read in [KiB]: of addresses, which is more than is ever used of them.
const ENOUGH_MEMORY: u64 = 8 << 20;

/// Ten clouds in a large grid, of densities that no two neighbours share.
fn clouds_far_apart() -> Vec<Leaf> {
    const RADIUS: f64 = 100.0;
    let centres: [[i32; 3]; 10] =
        core::array::from_fn(|i| [0, 1, 2].map(|axis| 104 + 94 * ((i * [1, 3, 7][axis]) % 9) as i32));
    let density = |[x, y, z]: [i32; 3]| {
        let from = |c: &[i32; 3]| [x - c[0], y - c[1], z - c[2]].map(f64::from).iter().map(|d| d * d).sum::<f64>();
        let thickness = centres.iter().map(|centre| 1.0 - from(centre).sqrt() / RADIUS).fold(0.0, f64::max);
        (thickness * (1.0 + f64::from((x * 7 + y * 5 + z * 3) % 16) / 16.0)) as f32
    };
    let bricks = LARGE / 8;
    let origins = (0..bricks.pow(3)).map(|i| [i / bricks / bricks, i / bricks % bricks, i % bricks].map(|x| 8 * x));
    let is_near = |origin: &[i32; 3]| {
        centres.iter().any(|centre| (0..3).all(|axis| (origin[axis] + 4 - centre[axis]).abs() <= RADIUS as i32 + 4))
    };
    let leaves = origins.filter(is_near).map(|origin| {
        let at = |i: usize| [0, 1, 2].map(|axis| origin[axis] + [i & 7, i >> 3 & 7, i >> 6][axis] as i32);
        Leaf { origin, values: Box::new(core::array::from_fn(|i| density(at(i)))) }
    });
    leaves.filter(|leaf| leaf.values.iter().any(|value| *value > 0.0)).collect()
}

/// What the program prints to standard output and error with `args`, in as much memory as is enough.
fn in_enough_memory(folder: &Path, args: &[&str]) -> [String; 2] {
    let script = format!("ulimit -v {ENOUGH_MEMORY}; exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &script, env!("CARGO_BIN_EXE_fogbow")]).args(args).current_dir(folder).stdin(Stdio::null());
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("a shell");
    // What it prints is less than a pipe holds.
    let (status, mut peak) = (format!("/proc/{}/status", child.id()), String::new());
    while child.try_wait().expect("a child").is_none() {
        let status = std::fs::read_to_string(&status).unwrap_or_default();
        peak = status.lines().find(|line| line.starts_with("VmHWM")).map_or(peak, String::from);
        std::thread::sleep(Duration::from_millis(20));
    }
    println!("{args:?}: {peak}");
    let output = child.wait_with_output().expect("a child");
    let texts = [output.stdout, output.stderr].map(|text| String::from_utf8(text).expect("UTF-8"));
    assert!(output.status.success(), "{args:?}: {texts:?}");
    texts
}

#[test]
fn a_large_grid_takes_the_memory_of_what_is_in_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let leaves = clouds_far_apart();
    volume_writer::write(&folder.path().join("clouds.vdb"), 0.01, &leaves);
    let active = leaves.iter().flat_map(|leaf| leaf.values.iter()).filter(|value| **value > 0.0).count();
    drop(leaves);
    let share = active as f64 / f64::from(LARGE).powi(3);
    println!("{active} voxels, {:.1} % of all", 100.0 * share);
    assert!((0.02..0.06).contains(&share), "{share}");
    let scene = "camera = { position = [4.8, 4.8, -9], look_at = [4.8, 4.8, 0], vertical_fov_deg = 60 }\n\
                 film = { size = [16, 16] }\nenvironment = { radiance = 1 }\n[[volume]]\nscattering = 0.5\n\
                 grid = { file = \"clouds.vdb\" }\n";
    std::fs::write(folder.path().join("scene.toml"), scene).expect("a file");
    let render = |style: &str| {
        let args = ["render", "scene.toml", "-o", "a.exr", "--samples", "1", "--progress", style];
        let [_, told] = in_enough_memory(folder.path(), &args);
        println!("{told}");
        told
    };
    let told = render("json");
    assert!(told.contains(r#""phase":"loading","file":"clouds.vdb","fraction":"#), "{told}");
    let told = render("plain");
    assert!(told.lines().next().is_some_and(|line| line.contains(" %  ") && line.ends_with(" clouds.vdb")), "{told}");
    let [described, _] = in_enough_memory(folder.path(), &["info", "scene.toml"]);
    println!("{described}");
    assert!(described.contains(&format!(", {active} active voxels, ")), "{described}");
    let field = described.lines().find(|line| line.contains(" cells, ")).and_then(|line| line.strip_suffix(" KiB"));
    let kib = field.and_then(|line| line.rsplit(' ').next()?.parse::<f64>().ok());
    let kib = kib.expect("the memory of the field");
    assert!(kib * 1024.0 <= 1.3 * 4.0 * active as f64, "{kib} KiB for {active} voxels");
}

/// Far from a small source in endless white fog the fluence is that of diffusion, P / (4 pi D r) with D = 1 / (3 mu_s'),
/// and with absorption it falls by e^(-kappa r). Radiance at the angles of cosine +- 1 / sqrt 3 to the source, whose mean
/// is free of the first three harmonics, is the fluence over 4 pi. The source takes back a hundredth of its light.
#[test]
fn light_diffuses_from_a_point_in_endless_fog() {
    let (radius, radiance, scattering, distance) = (0.02_f64, 1000.0, 20.0 * 0.3, 1.0);
    let power = 4.0 * core::f64::consts::PI.powi(2) * radius.powi(2) * radiance;
    for absorption in [0.0_f64, 0.06] {
        let diffusion = 1.0 / (3.0 * (scattering + absorption));
        let fluence = power * (-(absorption / diffusion).sqrt() * distance).exp()
            / (4.0 * core::f64::consts::PI * diffusion * distance);
        let expected = fluence / (4.0 * core::f64::consts::PI);
        let [toward, away] = [1.0, -1.0].map(|side: f64| {
            let look_at = format!("camera.look_at=[{}, 0.81649658093, 0]", side / 3.0_f64.sqrt());
            let settings = [look_at, format!("medium.absorption={absorption:?}")];
            let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/point");
            let overrides =
                settings.iter().map(|setting| Override::parse(setting).expect("a key and a value")).collect();
            let scene = scene::load(&folder, overrides).unwrap_or_else(|error| panic!("{error}"));
            let (renderer, size) = (Renderer::new(WORKERS).expect("threads start"), scene.scene.film.size);
            let frame = pilot::choose(&scene.frame, size, scene.choices(), &renderer, &Monitor::default()).0;
            green(&render(&frame, size, 0..4000).0)
        });
        let (mean, error) = (0.5 * (toward.0 + away.0), 0.5 * toward.1.hypot(away.1));
        println!("absorption {absorption}: {mean} +- {error}, diffusion {expected}");
        assert!(error < 0.03 * expected, "{mean} +- {error} says little");
        assert!((mean - expected).abs() < 3.5 * error + 0.03 * expected, "{mean} +- {error} instead of {expected}");
    }
}

/// Paths through several volumes, a coloured ball and a coloured cloud that are longer than the short suite has time for.
#[test]
fn all_techniques_have_the_same_means_in_volumes_at_all_lengths() {
    for (name, frame) in frames::clouds::volumes([16, 16]) {
        assert_equal_means(name, &frame, 1..=8);
    }
    for (name, frame) in frames::clouds::clouds([16, 16]) {
        assert_equal_means(name, &frame, 1..=8);
    }
}
