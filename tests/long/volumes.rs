//! Volumes: files, memory, diffusion, and techniques at all lengths.

use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

use fogbow::frame::Frame;
use fogbow::render::{Monitor, Renderer};
use fogbow::scene::document::Override;
use fogbow::volume::Leaf;
use fogbow::{pilot, scene};
use fogbow_kernels::{LONGEST_PATH, PathLengths};
use fogbow_testing::agreement::{assert_equal_means, assert_equal_means_of};
use fogbow_testing::random::Random;
use fogbow_testing::render::{WORKERS, green, render};
use fogbow_testing::statistics::Moments;
use fogbow_testing::{frames, null_vertices, volume_writer, volumes};
use statrs::function::erf::erfc;

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
        Leaf { origin, values: Arc::new(core::array::from_fn(|i| density(at(i)))) }
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

/// The other way to weigh paths through a cloud has the same mean: weights that are exact for paths with their null
/// vertices. Its variance stands beside that of weights that go by a coarse field.
#[test]
fn weights_by_null_vertices_have_the_same_mean_in_a_cloud() {
    const SAMPLES: u32 = 400;
    let size = [32, 32];
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cloud-box");
    let settings =
        ["render.technique=nee", "render.starts=all", "render.survival=1", "render.roulette=0", "film.size=[32, 32]"];
    let overrides = settings.iter().map(|setting| Override::parse(setting).expect("a key and a value")).collect();
    let frame = scene::load(&folder, overrides).unwrap_or_else(|error| panic!("{error}")).frame;
    // Without the lamp as it is seen, whose edge makes most of the variance.
    let frame = Frame { lengths: PathLengths { min: 2, ..frame.lengths }, ..frame };
    let [mut sum, mut squares] = [0.0; 2];
    for pixel in 0..size[0] * size[1] {
        let values = (0..SAMPLES).map(|sample| {
            let random = Random::new(u64::from(pixel) << 32 | u64::from(sample) << 8);
            null_vertices::radiance(&frame, pixel, sample, random)
        });
        let mut pixel = Moments::default();
        values.for_each(|value| pixel.add(value));
        (sum, squares) = (sum + pixel.mean(), squares + pixel.variance());
    }
    let pixels = f64::from(size[0] * size[1]);
    let (mean, variance) = (sum / pixels, squares / pixels);
    let error = (variance / (pixels * f64::from(SAMPLES))).sqrt();
    let (own, own_error) = green(&render(&frame, size, 0..SAMPLES).0);
    let own_variance = own_error.powi(2) * pixels * f64::from(SAMPLES);
    println!("null vertices {mean} +- {error}, variance {variance}; coarse field {own} +- {own_error}, {own_variance}");
    assert!((mean - own).abs() < 3.5 * error.hypot(own_error), "{mean} +- {error}, {own} +- {own_error}");
}

/// Far from a small source in endless white fog the fluence is that of diffusion, P / (4 pi D r) with D = 1 / (3 mu_s'),
/// and with absorption it falls by e^(-kappa r). Radiance at the angles of cosine +- 1 / sqrt 3 to the source, whose mean
/// is free of the first three harmonics, is the fluence over 4 pi. The source takes back a thousandth of its light: one of
/// four times its radius, as bright in all, took back a fiftieth.
///
/// Without absorption, light that has come a way s is of age s in the equation of diffusion, and erf(r / (2 sqrt(D s)))
/// of it comes later: beyond the longest paths that there are, a twenty-fourth of all. Absorption leaves none of that.
#[test]
fn light_diffuses_from_a_point_in_endless_fog() {
    let (radius, radiance, distance) = (0.005_f64, 16_000.0, 1.0);
    let (scattering, reduced) = (20.0, 20.0 * 0.3); // [1/m], the second times one minus the mean cosine
    let power = 4.0 * core::f64::consts::PI.powi(2) * radius.powi(2) * radiance;
    for absorption in [0.0_f64, 0.06] {
        let diffusion = 1.0 / (3.0 * (reduced + absorption));
        let fluence = power * (-(absorption / diffusion).sqrt() * distance).exp()
            / (4.0 * core::f64::consts::PI * diffusion * distance);
        let longest = f64::from(LONGEST_PATH) / scattering;
        let seen = if absorption == 0.0 { erfc(distance / (2.0 * (diffusion * longest).sqrt())) } else { 1.0 };
        let expected = seen * fluence / (4.0 * core::f64::consts::PI);
        let [toward, away] = [1.0, -1.0].map(|side: f64| {
            let look_at = format!("camera.look_at=[{}, 0.81649658093, 0]", side / 3.0_f64.sqrt());
            let settings = [look_at, format!("medium.absorption={absorption:?}")];
            let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/point");
            let overrides =
                settings.iter().map(|setting| Override::parse(setting).expect("a key and a value")).collect();
            let scene = scene::load(&folder, overrides).unwrap_or_else(|error| panic!("{error}"));
            let (renderer, size) = (Renderer::new(WORKERS).expect("threads start"), scene.scene.film.size);
            let frame = pilot::choose(&scene.frame, size, scene.choices(), &renderer, &Monitor::default()).0;
            green(&render(&frame, size, 0..1500).0)
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

/// Paths of some lengths through the media of the scenes. Path tracing meets the sun and the moon too seldom to know by how
/// much it may be wrong: here they are large, and shine as much.
#[test]
fn all_techniques_have_the_same_means_in_the_scenes_by_length() {
    let scenes: [(&str, &[&str]); 5] = [
        ("cloud-box", &[]),
        (
            "cloud-sky",
            &["light=[{type=\"sun\",direction=[0.75,-0.55,-0.38],irradiance=[8,7.4,6.4],angular_radius_deg=25}]"],
        ),
        (
            "smoke-fire",
            &["light=[{type=\"disk\",center=[34,38,-30],normal=[-34,-36,30],radius=40,radiance=[0.34,0.52,0.86]}]"],
        ),
        ("wax", &[]),
        ("milk", &[]),
    ];
    for (name, settings) in scenes {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
        let settings = ["film.size=[16,16]"].iter().chain(settings);
        let settings = settings.map(|setting| Override::parse(setting).expect("a key and a value")).collect();
        let scene = scene::load(&folder, settings).unwrap_or_else(|error| panic!("{error}"));
        for segments in [1, 2, 3, 4, 6, 10, 20] {
            assert_equal_means(name, &scene.frame, segments..=segments);
        }
        // Elsewhere, and on longer paths in wax, there is little light.
        let long: &[_] = match name {
            "wax" => &[PathLengths { min: 21, max: 60 }],
            "milk" => &[PathLengths { min: 21, max: 60 }, PathLengths { min: 61, max: 250 }],
            _ => &[],
        };
        for lengths in long.iter().copied() {
            let frame = Frame { lengths, ..scene.frame.clone() };
            assert_equal_means_of(&format!("{name}, {lengths:?}"), &frame, &frame);
        }
    }
}
