//! The pilot: what it chooses, and what it leaves alone.

use std::path::Path;

use fogbow::frame::Frame;
use fogbow::pilot::{self, Setting, Trial};
use fogbow::render::{Monitor, Renderer};
use fogbow::scene::{self, LoadedScene, document::Override};
use fogbow_kernels::random::lis_seed;
use fogbow_testing::frames::clouds::white_ball;
use fogbow_testing::render::{WORKERS, green, render};
use fogbow_testing::statistics::z_of_means;

/// The scene in `folder` with other settings.
fn scene(folder: &str, settings: &[&str]) -> LoadedScene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(folder);
    let overrides = settings.iter().map(|setting| Override::parse(setting).expect("a key and a value")).collect();
    scene::load(&folder, overrides).unwrap_or_else(|error| panic!("{error}"))
}

/// What the pilot makes of `scene`.
fn piloted(scene: &LoadedScene) -> (Frame, Vec<Trial>) {
    let renderer = Renderer::new(WORKERS).expect("threads start");
    pilot::choose(&scene.frame, scene.scene.film.size, scene.choices(), &renderer, &Monitor::default())
}

#[test]
fn few_starts_are_chosen_for_a_light_in_open_fog() {
    for seed in 1..=5 {
        let (frame, trials) = piloted(&scene("fog-facing", &[&format!("render.seed={seed}")]));
        assert!(frame.walk.starts <= 4, "seed {seed}: {} starts of {trials:#?}", frame.walk.starts);
        let efficiency = |starts: u32| {
            let trial =
                trials.iter().find(|trial| trial.setting.starts == starts && trial.setting.survival.is_certain());
            trial.map_or_else(|| panic!("no trial of {starts} starts"), Trial::efficiency)
        };
        let (chosen, all) = (efficiency(frame.walk.starts), efficiency(u32::MAX));
        assert!(chosen > 2.0 * all, "seed {seed}: efficiency {chosen}, all starts {all}");
    }
}

/// Bridges from the first vertex would have to stay in the cloud, and hardly ever do.
#[test]
fn every_vertex_connects_where_there_are_volumes() {
    let (frame, trials) = piloted(&scene("cloud-box", &["render.technique=bridge", "film.size=[16, 16]"]));
    assert_eq!(frame.walk.starts, u32::MAX);
    assert!(trials.iter().all(|trial| trial.setting.starts == u32::MAX), "{trials:#?}");
}

/// Deep in the ball the few walks of an early end would count as much as all of those that did not get there.
#[test]
fn walks_through_volumes_end_by_their_depth() {
    let ball = r#"
        medium = { scattering = 0.3, phase.g = 0.6 }
        camera = { position = [0, 0, -8], look_at = [0, 0, 0], vertical_fov_deg = 40 }
        light = [{ type = "disk", center = [3, 4, -3], normal = [-3, -4, 3], radius = 0.5, radiance = 20 }]
        film = { size = [32, 32] }
        render = { technique = "bridge", max_segments = 40, seed = 1 }

        [[volume]]
        name = "ball"
        shape = { type = "sphere", center = [0, 0, 0], radius = 1 }
        scattering = 8
        phase.g = 0.3
    "#;
    let scene = scene::parse("ball.toml", ball).unwrap_or_else(|error| panic!("{error}"));
    let survival = piloted(&scene).0.walk.survival;
    assert!(survival.constant().is_none(), "the same probability at every depth");
    assert!((1..=3).all(|depth| survival.at(depth) == 1.0), "an early end");
}

/// A sample of a white ball of 1000 mean free paths takes 65536 segments, and a trial would take minutes.
#[test]
fn what_takes_too_long_is_not_tried() {
    let (frame, trials) = piloted(&white_ball(1000.0, 32));
    assert!(trials.is_empty() && frame.walk.survival.at(1000) == 1.0, "{trials:?}");
}

#[test]
fn the_best_trial_is_chosen_and_nothing_is_tried_twice() {
    for (folder, settings) in [
        ("fog-facing", &["render.seed=3"][..]),
        ("fog-perpendicular", &[]),
        ("fog-facing", &["render.starts=all"]),
        ("fog-facing", &["render.starts=4", "medium.scattering=6"]),
        ("fog-small", &["render.survival=0.9"]),
    ] {
        let scene = scene(folder, settings);
        let (frame, trials) = piloted(&scene);
        let best = pilot::best(&trials).expect("trials");
        assert_eq!(
            frame,
            scene.frame.clone().with_walk(best.setting.starts, best.setting.survival),
            "{folder}, {settings:?}: the walk alone changes, to the best of {trials:#?}"
        );
        let mut tried: Vec<_> =
            trials.iter().map(|trial| (trial.setting.starts, trial.setting.survival.at(1).to_bits())).collect();
        tried.sort_unstable();
        tried.dedup();
        assert_eq!(tried.len(), trials.len(), "{folder}, {settings:?}: something was tried twice");
    }
}

#[test]
fn what_the_scene_fixes_is_kept() {
    let (frame, trials) = piloted(&scene("fog-facing", &["render.starts=3"]));
    assert_eq!(frame.walk.starts, 3);
    assert!(trials.len() > 1 && trials.iter().all(|trial| trial.setting.starts == 3), "{trials:#?}");
    let (frame, trials) = piloted(&scene("fog-facing", &["render.starts=\"all\""]));
    assert_eq!(frame.walk.starts, u32::MAX);
    assert!(trials.len() > 1 && trials.iter().all(|trial| trial.setting.starts == u32::MAX), "{trials:#?}");
    let (frame, trials) = piloted(&scene("fog-facing", &["render.survival=0.8"]));
    assert_eq!(frame.walk.survival.constant(), Some(0.8));
    assert!(
        trials.len() > 1 && trials.iter().all(|trial| trial.setting.survival.constant() == Some(0.8)),
        "{trials:#?}"
    );
    let both = scene("fog-facing", &["render.survival=0.8", "render.starts=2"]);
    assert_eq!(piloted(&both), (both.frame.clone(), vec![]));
    assert_eq!((both.frame.walk.starts, both.frame.walk.survival.constant()), (2, Some(0.8)));
}

#[test]
fn scenes_without_a_choice_are_left_alone() {
    for settings in [
        &["render.technique=path"][..],
        &["render.technique=nee,omnee"],
        &["render.technique=mvnee", "render.roulette=0"],
        &["render.max_segments=1"],
        &["render.max_segments=2"],
        &["medium.scattering=0"],
        &["medium.scattering=0", "medium.absorption=1.7"],
    ] {
        let scene = scene("fog-facing", settings);
        let (frame, trials) = piloted(&scene);
        assert_eq!(frame, scene.frame, "{settings:?}");
        assert!(trials.is_empty(), "{settings:?}: {trials:?}");
    }
}

#[test]
fn roulette_is_played_below_a_part_of_the_mean_where_that_pays() {
    let roulette = |folder: &str, settings: &[&str]| {
        let (frame, trials) = piloted(&scene(folder, &[&["render.starts=1", "render.survival=1"], settings].concat()));
        let tried: Vec<_> = trials.iter().map(|trial| trial.setting.roulette).collect();
        (frame.roulette, tried)
    };
    let (chosen, tried) = roulette("dense-plate", &[]);
    assert!((0.03..0.07).contains(&chosen) && tried == [0.0, chosen], "{chosen} of {tried:?}");
    // A tenth of the cost counts where nothing is lost.
    let (chosen, tried) = roulette("dense-plate", &["render.technique=nee"]);
    assert!((0.03..0.07).contains(&chosen) && tried == [0.0, chosen], "{chosen} of {tried:?}");
    assert_eq!(roulette("dense-plate", &["render.roulette=0.01"]), (0.01, vec![]));
    assert_eq!(roulette("fog-facing", &[]), (0.0, vec![]));
    // Nothing is traced there, but the weights of MVNEE are dear.
    let (chosen, tried) = roulette("fog-facing", &["render.technique=mvnee", "render.starts=\"all\""]);
    assert!((0.2..0.4).contains(&chosen) && tried == [0.0, chosen], "{chosen} of {tried:?}");
}

#[test]
fn images_of_extreme_shape_are_tried_too() {
    for size in ["[1, 1]", "[5000, 1]", "[1, 5000]", "[3, 2]"] {
        let scene = scene("fog-facing", &[&format!("film.size={size}")]);
        let (frame, trials) = piloted(&scene);
        assert!(trials.len() >= 3, "one start, two, and all, of {size}: {trials:?}");
        assert!(trials.iter().all(|trial| trial.variance > 0.0 && trial.cost > 0.0), "{size}: {trials:?}");
        assert_eq!(frame.camera, scene.frame.camera, "the frame keeps its own size");
    }
}

fn trial(starts: u32, variance: f64, cost: f64) -> Trial {
    let setting = Setting { starts, survival: 1.0.into(), roulette: 0.0 };
    Trial { setting, samples: 32, variance, variance_error: 0.0, cost, mean: 1.0, mean_error: 0.01 }
}

#[test]
fn efficiency_is_one_over_the_worst_variance_times_cost() {
    assert_eq!(trial(1, 4.0, 0.5).efficiency(), 0.5);
    assert_eq!(trial(1, 0.25, 100.0).efficiency(), 0.04);
    assert_eq!(trial(1, 0.0, 100.0).efficiency(), 0.0, "what found nothing is worth nothing");
    assert_eq!(Trial { variance_error: 2.0, ..trial(1, 4.0, 0.5) }.efficiency(), 0.25);
}

#[test]
fn the_best_trial_is_efficient_agrees_and_has_most_starts_of_those_as_good() {
    let chosen = |trials: &[Trial]| pilot::best(trials).map(|trial| trial.setting.starts);
    let full = trial(u32::MAX, 1.0, 20.0);
    assert_eq!(chosen(&[]), None);
    assert_eq!(chosen(&[trial(1, 4.0, 1.0), trial(2, 3.0, 2.0), full]), Some(1));
    assert_eq!(chosen(&[trial(1, 4.0, 1.0), trial(2, 2.2, 2.0), full]), Some(2), "nearly as good");
    let doubtful = Trial { variance_error: 4.0, ..trial(1, 4.0, 1.0) };
    assert_eq!(chosen(&[doubtful, trial(2, 3.0, 2.0), full]), Some(2));
    let elsewhere = Trial { mean: 0.92, ..trial(1, 4.0, 1.0) };
    assert_eq!(chosen(&[elsewhere, trial(2, 3.0, 2.0), full]), Some(2), "five standard errors off");
    let near = Trial { mean: 0.94, ..trial(1, 4.0, 1.0) };
    assert_eq!(chosen(&[near, trial(2, 3.0, 2.0), full]), Some(1));
}

#[test]
fn what_is_far_from_the_best_ends_early_and_starts_are_tried_until_they_are_worse() {
    let (frame, trials) = piloted(&scene("fog-facing", &["render.survival=1"]));
    let tried: Vec<_> = trials.iter().map(|trial| trial.setting.starts).collect();
    assert_eq!(tried, [1, u32::MAX, 2], "{trials:#?}");
    // All starts have an eighth of the efficiency of the best.
    assert_eq!((frame.walk.starts, trials[1].samples, trials[2].samples), (1, 16, 32), "{trials:#?}");
}

/// By the variances of renders of 200 samples per pixel, and what stages take, two to four starts are best in both scenes,
/// and a single one or eight have 0.6 to 0.8 of their efficiency.
#[test]
fn among_surfaces_the_choice_does_not_depend_on_luck() {
    for folder in ["cornell-fog", "dense-plate"] {
        for seed in 0..5 {
            let (frame, trials) = piloted(&scene(folder, &[&format!("render.seed={seed}")]));
            assert!((2..=4).contains(&frame.walk.starts), "{folder}, seed {seed}: {trials:#?}");
        }
    }
}

/// The roulette that is chosen: 0, at a cost of 20, or 1, with another mean and cost.
fn roulette_or_none(mean: f64, cost: f64) -> f32 {
    let without = trial(u32::MAX, 1.0, 20.0);
    let with = Trial { setting: Setting { roulette: 1.0, ..without.setting }, mean, cost, ..without };
    pilot::best(&[without, with]).expect("trials").setting.roulette
}

#[test]
fn roulette_is_played_if_it_pays_at_all() {
    assert_eq!([19.9, 20.1].map(|cost| roulette_or_none(1.0, cost)), [1.0, 0.0]);
}

#[test]
fn a_roulette_that_finds_another_image_is_not_played() {
    assert_eq!([0.96, 0.9].map(|mean| roulette_or_none(mean, 2.0)), [1.0, 0.0]);
}

/// Where scattering is all but straight back, light comes by many segments, and few starts find it rarely or not at
/// all: five looks out of six that one start takes see next to nothing, with so little variance that it would be the
/// most efficient by far. That no more than two of twelve do has a probability of 10^-6.
#[test]
fn what_misses_the_light_is_not_chosen() {
    let mut tempting = 0;
    for seed in 1..=12 {
        let settings = [
            "medium.phase.g=-0.9999",
            "light[0].radius=1.5",
            "light[0].center=[0, 0, 3]",
            &format!("render.seed={seed}"),
        ];
        let (frame, trials) = piloted(&scene("fog-facing", &settings));
        let fullest =
            trials.iter().find(|trial| (trial.setting.starts, trial.setting.survival.at(1)) == (u32::MAX, 1.0));
        let fullest = fullest.expect("all starts are tried");
        let misses =
            |trial: &Trial| (trial.mean - fullest.mean).abs() > 5.0 * trial.mean_error.hypot(fullest.mean_error);
        let setting = (frame.walk.starts, frame.walk.survival);
        let chosen = trials.iter().find(|trial| (trial.setting.starts, trial.setting.survival) == setting);
        let chosen = chosen.expect("what is chosen was tried");
        assert!(!misses(chosen), "seed {seed}: {chosen:?} is far from {fullest:?}");
        let most = trials.iter().max_by(|a, b| a.efficiency().total_cmp(&b.efficiency())).expect("trials");
        tempting += u32::from(misses(most));
    }
    assert!(tempting > 2, "only {tempting} of 12 looks are tempted by what misses the light");
}

#[test]
fn the_pilot_looks_at_other_samples_than_those_that_are_kept() {
    // As large as the pilot's own image, so that both would be the same under the same seed.
    let size = [24, 24];
    let scene = scene("fog-facing", &["film.size=[24, 24]", "render.min_segments=2", "render.seed=5"]);
    let (_, trials) = piloted(&scene);
    for trial in &trials {
        let with = |seed: u32| {
            let walk = scene.frame.clone().with_walk(trial.setting.starts, trial.setting.survival);
            let frame = Frame { roulette: trial.setting.roulette, seed, ..walk };
            green(&render(&frame, size, 0..trial.samples).0)
        };
        let close = |(mean, _): (f64, f64)| (mean / trial.mean - 1.0).abs() < 1e-9;
        assert!(close(with(pilot::seed(5))), "{trial:?} has its own samples");
        let kept = with(5);
        assert!(!close(kept) && !close(with(lis_seed(5))), "{trial:?} has the samples of the frame");
        let z = z_of_means(kept, (trial.mean, trial.mean_error));
        assert!(z.abs() < 5.0, "{trial:?} is another image than {kept:?}");
    }
    assert!(trials.len() > 2, "{trials:?}");
    assert!([16, 32].iter().all(|samples| trials.iter().any(|trial| trial.samples == *samples)), "{trials:?}");
}

#[test]
fn the_pilot_has_a_seed_of_its_own_for_every_seed() {
    for seed in (0..1000).chain((0..32).map(|bit| 1 << bit)).chain([u32::MAX, pilot::seed(0), lis_seed(0)]) {
        let mut seeds = [seed, lis_seed(seed), pilot::seed(seed), lis_seed(pilot::seed(seed))];
        seeds.sort_unstable();
        assert!(seeds.windows(2).all(|pair| pair[0] != pair[1]), "of {seed}: {seeds:?}");
    }
}
