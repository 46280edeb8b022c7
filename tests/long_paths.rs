//! Paths that no number of segments ends: what they bring in dense media, and what they cost.

use std::path::Path;

use bumpalo::Bump;
use fogbow::frame::Frame;
use fogbow::pilot;
use fogbow::render::{Monitor, Renderer};
use fogbow::scene::{self, LoadedScene, document::Override};
use fogbow::wavefront::{Wavefront, default_lanes};
use fogbow_kernels::pipeline::SIMD;
use fogbow_kernels::survival::{OCTAVES, Survival};
use fogbow_kernels::{LONGEST_PATH, MOST_INSERTED, PathLengths};
use fogbow_testing::agreement::assert_stages_agree;
use fogbow_testing::checked::{CHECKED, take_log};
use fogbow_testing::frames::clouds::IN_FIELDS;
use fogbow_testing::frames::{self, Active};
use fogbow_testing::render::{WORKERS, green, render, render_here};
use fogbow_testing::statistics::z_of_means;
use fogbow_testing::suite::{half, some};
use fogbow_testing::truths::{sheet, slabs};

fn scene(folder: &str, settings: &[String]) -> LoadedScene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let overrides = settings.iter().map(|setting| Override::parse(setting).expect("a key and a value")).collect();
    scene::load(&folder, overrides).unwrap_or_else(|error| panic!("{error}"))
}

/// The frame of a scene as the pilot would have it rendered.
fn piloted(scene: &LoadedScene) -> Frame {
    let renderer = Renderer::new(WORKERS).expect("threads start");
    pilot::choose(&scene.frame, scene.scene.film.size, scene.choices(), &renderer, &Monitor::default()).0
}

/// `frame` with paths of any length, walks that end by octaves of depth, and connections of one technique.
fn endless(frame: &Frame, active: Active, fall: f64) -> Frame {
    let lengths = PathLengths { max: 4096, ..frame.lengths };
    let mut frame = frames::with_techniques(&Frame { lengths, ..frame.clone() }, active, 4.0);
    frame.techniques.limit_inserted(6);
    frame.with_walk(u32::MAX, Survival::from_reach(core::array::from_fn::<f64, OCTAVES, _>(|k| fall.powi(k as i32))))
}

/// Absorbing fog, whose light is all on paths of a few dozen segments.
fn absorbing(size: [u32; 2]) -> Frame {
    let fog = frames::fog_facing(0.0, 0.8, size);
    let mut medium = fog.medium.clone();
    medium.albedo = [0.7; 3];
    Frame { medium, aimed: 0.0, ..fog }
}

#[test]
fn stages_agree_with_their_twins_on_walks_that_end_by_depth() {
    let size = [16, 16];
    for active in Active::ALL {
        let frame = endless(&absorbing(size), active, 0.6);
        render_here(&frame, &CHECKED, 128, size, 8);
        let log = take_log();
        assert!(log.failures.is_empty(), "{active:?}: {}", log.failures[0]);
    }
}

/// Thin endless fog that absorbs nothing, around a ball and a box of other phase functions and a lamp: paths wander off
/// and come back over distances next to which their first and last segments are nothing.
fn wandering() -> Frame {
    let text = r#"
        camera = { position = [0, 0, -8], look_at = [0, 0, 0], vertical_fov_deg = 20 }
        film = { size = [16, 16] }
        medium = { scattering = 0.05 }

        [[light]]
        type = "disk"
        center = [1.5, 0.5, 0]
        normal = [-0.6, 0, -0.8]
        radius = 0.4
        radiance = 20

        [[volume]]
        shape = { type = "sphere", center = [0, 0, 0], radius = 0.8 }
        scattering = 3
        phase = { type = "henyey_greenstein", g = 0.8 }

        [[volume]]
        shape = { type = "box", min = [-3, -1.5, 1], max = [3, -0.8, 4] }
        scattering = 1.5
        phase = { type = "rayleigh" }
    "#;
    let scene = scene::parse("wandering.toml", text).unwrap_or_else(|error| panic!("{error}"));
    let frame = piloted(&scene);
    assert!(frame.lengths.max > 1000 && frame.walk.survival.reach(200) > 0.01, "{:?}", frame.lengths);
    frame
}

/// The same by every technique, with short connections.
fn wandering_by_all() -> impl Iterator<Item = (Active, Frame)> {
    let frame = wandering();
    IN_FIELDS.into_iter().map(move |active| {
        let mut frame = frames::with_techniques(&frame, active, 4.0);
        frame.techniques.limit_inserted(6);
        (active, frame)
    })
}

#[test]
fn stages_agree_with_their_twins_where_walks_wander_off() {
    assert_stages_agree("wandering", wandering_by_all().map(|(_, frame)| frame), 1);
}

#[test]
fn every_technique_has_the_same_mean_where_walks_wander_off() {
    let size = [16, 16];
    let truth = green(&render(&frames::with_techniques(&wandering(), Active::Nee, 4.0), size, 0..400).0);
    for (active, frame) in wandering_by_all() {
        let found = green(&render(&Frame { seed: 5, ..frame }, size, 0..60).0);
        let z = z_of_means(found, truth);
        assert!(z.abs() < 4.2, "{active:?}: {found:?} instead of {truth:?}, z = {z}");
        assert!(found.1 < 0.05 * truth.0, "{active:?}: {found:?} says little");
    }
}

#[test]
fn every_technique_has_the_mean_of_all_lengths() {
    let size = [12, 12];
    let stated = frames::with_techniques(&absorbing(size), Active::Bridge, 4.0);
    let stated = Frame { lengths: PathLengths { min: 1, max: 60 }, seed: 77, ..stated };
    let truth = green(&render(&stated, size, 0..half(4000)).0);
    for (turn, active) in Active::ALL.into_iter().enumerate() {
        for fall in some([0.4, 0.5], turn, 2) {
            let found = green(&render(&endless(&absorbing(size), active, fall), size, 0..half(1500)).0);
            let z = z_of_means(found, truth);
            assert!(z.abs() < 4.2, "{active:?}, {fall}: {found:?} instead of {truth:?}, z = {z}");
        }
    }
}

/// Radiance along the normal of a slab over what it is lit with, from `side`, and its standard error.
fn slab(albedo: f64, g: f64, tau: f64, reflected: bool, samples: u32) -> (f64, f64) {
    let [distance, normal] = if reflected { [-0.1, 1.0] } else { [1.01, -1.0] };
    let settings = [
        format!("volume[0].scattering={:?}", albedo * tau),
        format!("volume[0].absorption={:?}", (1.0 - albedo) * tau),
        format!("volume[0].phase.g={g:?}"),
        format!("light[0].center=[0,0,{distance:?}]"),
        format!("light[0].normal=[0,0,{normal:?}]"),
        "render.technique=nee".into(),
    ];
    let scene = scene("tests/data/slab", &settings);
    green(&render(&piloted(&scene), scene.scene.film.size, 0..samples).0)
}

/// The disk and the slab end at 20 thicknesses, and light that comes at less than half a degree is missing: a
/// thousandth.
#[test]
fn slabs_reflect_and_transmit_as_adding_and_doubling_says() {
    let [white, milky, dark] = [(1.0, 0.0, 2.0), (1.0, 0.7, 20.0), (0.99, 0.7, 20.0)];
    for (albedo, g, tau) in [white, milky, dark] {
        let truth =
            slabs().into_iter().find(|slab| (slab.albedo, slab.g, slab.tau) == (albedo, g, tau)).expect("a row");
        for (is_reflected, truth) in [(true, truth.reflected), (false, truth.transmitted)] {
            let (mean, error) = slab(albedo, g, tau, is_reflected, 600);
            let off = (mean - truth).abs();
            assert!(off < 4.0 * error + 0.002 * truth, "{albedo} {g} {tau}: {mean} +- {error} instead of {truth}");
            assert!(error < 0.02 * truth, "{albedo} {g} {tau}: {mean} +- {error} says little");
        }
    }
}

/// A sheet of this preset, with its light at a distance along an axis and facing up or down it.
fn sheet_of(preset: &str, [distance, normal]: [f64; 2], more: &[String]) -> LoadedScene {
    let settings = [
        format!("volume[0].preset={preset}"),
        format!("light[0].center=[0,0,{distance:?}]"),
        format!("light[0].normal=[0,0,{normal:?}]"),
    ];
    scene("tests/data/sheet", &[&settings, more].concat())
}

/// An image of 16 x 16 pixels has few samples, too few of which get through to tell how far walks should go if it has no
/// more than others for each.
#[test]
fn small_images_know_how_deep_light_comes_from() {
    for seed in 1..=6 {
        let frame = piloted(&sheet_of("milk", [0.00505, -1.0], &[format!("render.seed={seed}")]));
        let reach = frame.walk.survival.reach(100);
        assert!(reach > 0.3, "seed {seed}: {reach} of all walks get to 100 segments");
    }
}

/// Light goes through hundreds of scatterings in milk, which absorbs little, and extinctions differ by channel.
#[test]
fn sheets_of_milk_and_wax_reflect_and_transmit_as_adding_and_doubling_says() {
    for (preset, samples) in [("milk", 600), ("wax", 300)] {
        for (truths, light) in sheet(preset).into_iter().zip([[-0.0005, 1.0], [0.00505, -1.0]]) {
            let scene = sheet_of(preset, light, &[]);
            let (means, errors) = render(&piloted(&scene), scene.scene.film.size, 0..samples).0.mean();
            for ((mean, error), truth) in means.into_iter().zip(errors).zip(truths) {
                let off = (mean - truth).abs();
                assert!(off < 4.0 * error + 0.002 * truth, "{preset}: {mean} +- {error} instead of {truth}");
                assert!(error < 0.02 * truth, "{preset}: {mean} +- {error} says little");
            }
        }
    }
}

/// Bytes that a worker takes for `frame`.
fn bytes(frame: &Frame) -> usize {
    let arena = Bump::new();
    let lanes = default_lanes(frame);
    let wavefront = Wavefront::new_in(&arena, frame, &SIMD, lanes);
    assert!(wavefront.trail.slots() <= MOST_INSERTED as usize + 2);
    arena.allocated_bytes() * 2048 / lanes
}

#[test]
fn memory_does_not_grow_with_the_length_of_paths() {
    let of = |segments: u32| scene("scenes/fog-facing", &[format!("render.max_segments={segments}")]).frame;
    let [short, long] = [2048, LONGEST_PATH].map(|segments| bytes(&of(segments)));
    assert_eq!(short, long);
    assert!(long < 64 << 20, "{} MiB", long >> 20);
}

/// Twice as thick a slab has longer paths; what a segment of them takes stays the same.
#[test]
fn work_grows_no_faster_than_paths() {
    let work = |tau: f64| {
        let settings = [format!("volume[0].scattering={tau:?}"), "render.survival=1.0".into()];
        let frame = Frame { seed: 3, ..scene("tests/data/slab", &settings).frame };
        let film = fogbow::film::Film::new(&frame, fogbow::film::Region::whole(16, 16), 16);
        let renderer = Renderer::new(WORKERS).expect("threads start");
        let empty = fogbow::stats::Stats::new(false).with_work();
        let stats = renderer.render_counting(empty, &frame, &SIMD, &film, 0..16, &Monitor::default());
        let work = stats.work.expect("it was asked for");
        let per_segment = |count: u64| count as f64 / stats.segments as f64;
        (stats.segments as f64 / stats.samples as f64, per_segment(work.terms), per_segment(work.edges))
    };
    let (few, many) = (work(10.0), work(80.0));
    assert!(many.0 > 3.0 * few.0, "{few:?}, {many:?}");
    let most = f64::from(MOST_INSERTED + 1);
    assert!(many.1 <= most && many.2 <= most && many.2 < 1.5 * few.2, "{few:?}, {many:?}");
}
