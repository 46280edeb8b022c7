//! Media that emit light: closed forms, furnaces, and what must hold for all.

use std::sync::Arc;

use fogbow::frame::Frame;
use fogbow::render::Workers;
use fogbow_kernels::PathLengths;
use fogbow_kernels::media::field::{Apart, Field, Interpolation, Shape, Volume, Voxels};
use fogbow_kernels::media::glow::Source;
use fogbow_kernels::media::reference::Medium as _;
use fogbow_kernels::media::{Glow, Medium};
use fogbow_kernels::phase::PhaseFunction;
use fogbow_kernels::pipeline::SIMD;
use fogbow_kernels::tables::camera::Camera;
use fogbow_kernels::tables::lights::{Lights, Selection};
use fogbow_kernels::tables::surfaces::Material;
use fogbow_testing::agreement::{assert_stages_agree, assert_whole_paths_agree};
use fogbow_testing::frames::clouds::{ball, centred, cloud, leaves, lumps, solid, with_field};
use fogbow_testing::frames::{self, Active, with_all_layers};
use fogbow_testing::render::{WORKERS, render, render_with};
use fogbow_testing::statistics::z_of_means;
use fogbow_testing::suite::half;
use glam::DVec3;

const SMALL: [u32; 2] = [16, 16];
const EMISSION: [f32; 3] = [4.0, 2.0, 0.5];
/// Extinction per channel over the largest, where it is coloured.
const HUES: [f32; 3] = [0.5, 1.0, 0.2];

/// A camera so narrow that it is one ray along +z.
fn ray_camera() -> Camera {
    Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 1e-6, 0.0, [1, 1])
}

/// One ray through `medium`, which is all that shines.
fn ray_through(medium: Medium, longest: u32) -> Frame {
    frames::plain(ray_camera(), medium, Lights::new(Vec::new(), Selection::Uniform), longest, 3)
}

/// A medium of `field` that absorbs, with what its volumes emit.
fn absorbing(field: Field, sources: Vec<Source>) -> Medium {
    let glow = Glow::of_field(&field, [0.0; 3], sources);
    Medium::of_field(field, [0.0; 3], PhaseFunction::isotropic()).with_glow(glow)
}

/// A lone volume that emits the same everywhere.
fn lone(volume: Volume) -> Medium {
    absorbing(Field::new(vec![volume], 0.0), vec![Source::constant(EMISSION)])
}

/// Fog of this extinction and albedo that emits the same everywhere.
fn fog(extinction: f32, albedo: f32, emission: [f32; 3]) -> Medium {
    coloured_fog([extinction; 3], [albedo; 3], emission)
}

/// The same in colour.
fn coloured_fog(extinction: [f32; 3], albedo: [f32; 3], emission: [f32; 3]) -> Medium {
    Medium::coloured(extinction, albedo, PhaseFunction::henyey_greenstein(0.5)).with_glow(Glow::everywhere(emission))
}

/// The lumps of the cloud in other units, as densities.
fn flame(center: DVec3, size: f64) -> Voxels {
    Voxels::new(&leaves(3, lumps), &centred(24, size, center), Interpolation::Trilinear)
}

/// What the only pixel of `frame` shows is `truth` times the emission, within the noise and rounding.
fn assert_radiance(case: &str, frame: &Frame, samples: u32, emission: [f32; 3], truth: f64) {
    assert_radiances(case, frame, samples, emission.map(|emission| f64::from(emission) * truth));
}

/// The same of radiances per channel.
fn assert_radiances(case: &str, frame: &Frame, samples: u32, expected: [f64; 3]) {
    let (film, stats) = render(frame, [1, 1], 0..samples);
    assert_eq!(stats.dropped.count, 0);
    let pixel = film.pixel(0, 0);
    for (c, expected) in expected.into_iter().enumerate() {
        let (mean, error) = (pixel.mean[c], pixel.standard_error[c]);
        let off = (mean - expected).abs();
        assert!(off < 4.2 * error + 1e-5 * expected, "{case}, channel {c}: {mean} +- {error}, expected {expected}");
        assert!(error < 0.02 * expected, "{case}: {mean} +- {error} says little");
    }
}

#[test]
fn what_absorbs_and_emits_shines_as_the_closed_form_says() {
    let (center, absorption) = (DVec3::new(0.0, 0.0, 3.0), 0.7_f64);
    let through = |length: f64| (1.0 - (-absorption * length).exp()) / absorption;
    let extinction = absorption as f32;
    let block = Shape::block([[-1.0, -1.0, 2.0], [1.0, 1.0, 4.5]]);
    let media = [
        ("ball", lone(ball(center, 1.5, extinction)), through(3.0)),
        ("box", lone(solid(block, extinction)), through(2.5)),
        ("box around the camera", lone(solid(Shape::block([[-2.0; 3], [2.0; 3]]), extinction)), through(2.0)),
        ("endless fog", fog(extinction, 0.0, EMISSION), 1.0 / absorption),
    ];
    for (case, medium, truth) in media {
        assert_radiance(case, &ray_through(medium, 5), 40_000, EMISSION, truth);
    }
}

/// Every channel has the closed form of its own extinction, although only a third of the flights are its own.
#[test]
fn what_absorbs_in_colour_shines_as_the_closed_form_says_in_every_channel() {
    let (center, block) = (DVec3::new(0.0, 0.0, 3.0), Shape::block([[-1.0, -1.0, 2.0], [1.0, 1.0, 4.5]]));
    let extinction = HUES.map(|hue| 0.7 * hue);
    let lone = |volume: Volume| {
        let field = Field::new(vec![volume], 0.0).coloured(HUES);
        absorbing(field, vec![Source::constant(EMISSION)])
    };
    let in_haze = |hues: [f32; 3]| {
        let block = solid(Shape::block([[-1.0, -1.0, 0.0], [1.0, 1.0, 2.5]]), 0.7);
        absorbing(Field::of_colours(vec![block], &[HUES], hues), vec![Source::constant(EMISSION)])
    };
    for (case, medium, length) in [
        ("ball", lone(ball(center, 1.5, 0.7)), 3.0),
        ("box before haze of another colour", in_haze([1.0, 0.2, 0.0]), 2.5),
        ("box", lone(solid(block, 0.7)), 2.5),
        ("box around the camera", lone(solid(Shape::block([[-2.0; 3], [2.0; 3]]), 0.7)), 2.0),
        ("endless fog", coloured_fog(extinction, [0.0; 3], EMISSION), f64::INFINITY),
    ] {
        let expected = [0, 1, 2].map(|c| {
            let [emission, extinction] = [EMISSION[c], extinction[c]].map(f64::from);
            emission * (1.0 - (-extinction * length).exp()) / extinction
        });
        assert_radiances(case, &ray_through(medium, 5), 60_000, expected);
    }
}

#[test]
fn flames_need_no_extinction() {
    let block = lone(solid(Shape::block([[-1.0, -1.0, 2.0], [1.0, 1.0, 4.5]]), 0.0));
    assert_radiance("box", &ray_through(block, 5), 8, EMISSION, 2.5);
    let ball = lone(ball(DVec3::new(0.0, 0.0, 3.0), 1.5, 0.0));
    assert_radiance("ball", &ray_through(ball, 5), 4_000, EMISSION, 3.0);
}

/// In a hall of a hundred times its size: the way through what does not emit takes none of its points.
#[test]
fn a_small_flame_in_much_smoke_has_no_noise() {
    let volumes = vec![
        solid(Shape::block([[-0.2, -0.2, 2.0], [0.2, 0.2, 2.5]]), 0.0),
        solid(Shape::block([[-30.0; 3], [30.0; 3]]), 0.0),
    ];
    let medium = absorbing(Field::new(volumes, 0.0), vec![Source::constant(EMISSION), Source::NONE]);
    assert_radiance("a flame in a hall", &ray_through(medium, 3), 8, EMISSION, 0.5);
}

#[test]
fn the_first_of_several_volumes_emits() {
    let center = DVec3::new(0.0, 0.0, 3.0);
    let volumes = vec![ball(center, 0.5, 0.0), ball(center, 1.5, 0.0)];
    let sources = vec![Source::constant([3.0, 3.0, 3.0]), Source::constant([1.0, 1.0, 1.0])];
    let medium = absorbing(Field::new(volumes, 0.0), sources);
    assert_radiance("a core in a hull", &ray_through(medium, 3), 4_000, [1.0; 3], 3.0 + 2.0);
}

/// The integral of emission times transmittance along the camera's ray, per channel.
fn quadrature(medium: &Medium, length: f64) -> [f64; 3] {
    const STEPS: u32 = 100_000;
    let (field, glow) = (medium.field().expect("a field"), medium.glow.as_ref().expect("emission"));
    let (step, mut depths, mut sums) = (length / f64::from(STEPS), [0.0_f64; 3], [0.0; 3]);
    for i in 0..STEPS {
        let at = (f64::from(i) + 0.5) * step * DVec3::Z;
        let (who, _) = field.here(field.cells_of(at));
        for (c, emission) in glow.at_point(who, at).into_iter().enumerate() {
            let passed = medium.twin(c).extinction(at) * step;
            sums[c] += emission * (-depths[c] - 0.5 * passed).exp() * step;
            depths[c] += passed;
        }
    }
    sums
}

#[test]
fn grids_of_emission_shine_as_quadrature_says() {
    let (center, place) = (DVec3::new(0.2, 0.1, 2.0), DVec3::new(0.0, 0.2, 2.3));
    let lumpy = || Source { emission: EMISSION, voxels: Some(flame(place, 2.5)) };
    let own = Shape::Voxels(Arc::new(flame(place, 2.5)));
    let media = [
        ("in a cloud", absorbing(cloud(3.0, center, 2.0, Interpolation::Trilinear), vec![lumpy()])),
        ("in a ball", absorbing(Field::new(vec![ball(center, 1.0, 0.8)], 0.0), vec![lumpy()])),
        ("by itself", absorbing(Field::new(vec![solid(own, 0.5)], 0.0), vec![lumpy()])),
        ("in fog", absorbing(Field::new(vec![ball(center, 1.0, 0.0)], 0.3), vec![lumpy()])),
        (
            "in a coloured cloud",
            absorbing(cloud(3.0, center, 2.0, Interpolation::Trilinear).coloured(HUES), vec![lumpy()]),
        ),
        (
            "in a coloured ball in other haze",
            absorbing(Field::of_colours(vec![ball(center, 1.0, 0.8)], &[HUES], [0.3, 0.05, 0.2]), vec![lumpy()]),
        ),
    ];
    for (case, medium) in media {
        let truth = quadrature(&medium, 8.0);
        assert!((0..3).all(|c| truth[c] > 0.05 * f64::from(EMISSION[c])), "{case}: {truth:?}");
        assert_radiances(case, &ray_through(medium, 3), 60_000, truth);
    }
}

/// In a medium of one temperature everything is as bright as a black body, whatever is scattered and reflected.
#[test]
fn furnaces_are_as_bright_as_black_bodies() {
    let (extinction, albedo, brightness) = (1.2_f32, 0.7_f32, 2.5_f32);
    let emission = [extinction * (1.0 - albedo) * brightness; 3];
    let medium = || fog(extinction, albedo, emission);
    let truth = f64::from(1.0 / (extinction * (1.0 - albedo)));
    assert_radiance("endless fog", &ray_through(medium(), 60), 20_000, emission, truth);
    let (extinctions, albedos) = (HUES.map(|hue| hue * extinction), [0.7, 0.3, 0.6]);
    let emissions = [0, 1, 2].map(|c| extinctions[c] * (1.0 - albedos[c]) * brightness);
    let coloured = ray_through(coloured_fog(extinctions, albedos, emissions), 60);
    assert_radiances("endless coloured fog", &coloured, 60_000, [f64::from(brightness); 3]);
    let wall = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0], [-1.0, 2.0, 0.0]];
    let [a, b, c, d] = wall;
    let mut white: Vec<_> = frames::walls().into_iter().flatten().collect();
    white.extend([[a, b, c], [a, c, d]]);
    let surfaces = frames::surfaces(&[(Material::plain([1.0; 3], true), white)]);
    let camera =
        Camera::new(DVec3::new(0.1, 1.2, 0.5), DVec3::new(0.3, -0.2, 1.0).normalize(), DVec3::Y, 1e-6, 0.0, [1, 1]);
    let room = Frame { surfaces, camera, ..ray_through(medium(), 200) };
    assert_radiance("white room", &room, 20_000, emission, truth);
    let gone = room.clone().with_walk(u32::MAX, 0.9);
    assert_radiance("white room, walks that end early", &gone, 60_000, emission, truth);
}

/// A cloud of this `extinction` where it is densest [1/m].
fn a_cloud(extinction: f32) -> Field {
    cloud(4.0, DVec3::new(0.1, 0.0, 1.6), extinction, Interpolation::Trilinear)
}

/// Fog, a room and a cloud that emit among lights, and a flame that is all there is; in coloured extinction, a room, a
/// cloud, and a block in haze of another colour.
fn variety() -> [(&'static str, Frame); 7] {
    let lights = frames::three_lights(0.6, Selection::IntensityDistance, SMALL);
    let room = frames::room(0.5, Selection::IntensityDistance, SMALL);
    let glowing = |frame: &Frame, glow: Glow| frames::with_medium(frame, frame.medium.clone().with_glow(glow));
    let field = Field::new(
        vec![ball(DVec3::new(0.2, 0.1, 1.4), 0.7, 2.5), solid(Shape::block([[-1.2, -0.6, 0.9], [0.3, 0.2, 2.2]]), 0.0)],
        0.25,
    );
    let flame = || Source { emission: EMISSION, voxels: Some(flame(DVec3::new(0.1, 0.0, 1.6), 3.0)) };
    let glow = Glow::of_field(&field, [0.2, 0.1, 0.3], vec![Source::constant([1.0, 0.5, 0.2]), flame()]);
    let cloudy = a_cloud(9.0);
    let fire = Glow::of_field(&cloudy, [0.0; 3], vec![flame()]);
    let of = |frame: &Frame, field: Field, glow: Glow| {
        let Medium { albedo, phase, .. } = frame.medium.clone();
        frames::with_medium(frame, Medium::of_field(field, albedo, phase).with_glow(glow))
    };
    let [_, (_, coloured_room)] = frames::coloured(SMALL);
    let tinted = cloudy.clone().coloured(HUES);
    let flames = Glow::of_field(&tinted, [0.0; 3], vec![flame()]);
    let block = solid(Shape::block([[-0.6, 0.2, 0.6], [0.5, 1.3, 2.0]]), 1.0);
    let block = Field::of_colours(vec![block], &[HUES], [0.05, 0.1, 0.6]);
    let embers = Glow::of_field(&block, [0.0, 0.1, 0.0], vec![flame()]);
    let dark = Frame { lights: Lights::new(Vec::new(), Selection::Uniform), ..lights.clone() };
    [
        ("fog", glowing(&lights, Glow::everywhere([0.5, 0.2, 0.1]))),
        ("room", glowing(&room, Glow::everywhere([0.1, 0.2, 0.3]))),
        ("volumes", of(&lights, field, glow)),
        ("fire", of(&dark, cloudy, fire)),
        ("coloured room", glowing(&coloured_room, Glow::everywhere([0.1, 0.2, 0.3]))),
        ("coloured cloud", of(&lights, tinted, flames)),
        ("coloured block in haze", of(&room, block, embers)),
    ]
}

/// Techniques for `frame`: none without lights.
fn with(frame: &Frame, active: Active) -> Frame {
    let active = if frame.lights.lights().is_empty() { Active::Path } else { active };
    frames::with_techniques(frame, active, 4.0)
}

const TECHNIQUES: [Active; 5] = [Active::Path, Active::Nee, Active::Both, Active::Bridge, Active::Lis];

#[test]
fn every_stage_agrees_with_its_twin() {
    for (name, frame) in variety() {
        assert_stages_agree(
            name,
            TECHNIQUES.map(|active| with_all_layers(&with(&frame, active).with_walk(u32::MAX, 0.9))).into_iter(),
            8,
        );
    }
}

#[test]
fn whole_paths_agree_with_the_scalar_integrator() {
    for (name, frame) in variety() {
        for active in TECHNIQUES {
            let frame = with(&frame, active).with_walk(u32::MAX, 0.9);
            assert!(assert_whole_paths_agree(&format!("{name}, {active:?}"), &frame) > 0.0, "{name}, {active:?}");
        }
    }
}

/// Mean of the image and its standard error, summed over channels.
fn mean(frame: &Frame, samples: u32) -> (f64, f64) {
    let (film, stats) = render(frame, SMALL, 0..samples);
    assert_eq!(stats.dropped.count, 0, "{:?}", stats.dropped.first);
    let (mean, error) = film.mean();
    (mean.iter().sum(), error.iter().map(|error| error * error).sum::<f64>().sqrt())
}

/// `frame` in grey extinction: that of one channel.
fn grey(frame: &Frame, channel: usize) -> Frame {
    let Some(field) = frame.medium.field() else {
        let Medium { albedo, phase, glow, .. } = frame.medium.clone();
        let medium = Medium::homogeneous(frame.medium.extinctions()[channel], albedo, phase);
        return frames::with_medium(frame, Medium { glow, ..medium });
    };
    let of_channel = |apart: &Apart| apart.channel(channel).clone();
    with_field(frame, field.apart().map_or_else(|| a_cloud(9.0 * field.hues()[channel]), of_channel))
}

/// All light, that of lamps and of flames, is in every channel what it is in grey extinction.
#[test]
fn coloured_media_are_as_bright_as_grey_ones_in_every_channel() {
    let per_channel = |frame: &Frame, samples: u32| render(frame, SMALL, 0..samples).0.mean();
    for (name, frame) in variety().into_iter().filter(|(_, frame)| frame.medium.is_coloured()) {
        let truth = [0, 1, 2].map(|c| {
            let grey = Frame { seed: 77 + c as u32, ..with(&grey(&frame, c), Active::Nee) };
            let (mean, error) = per_channel(&grey, half(2000));
            (mean[c], error[c])
        });
        for active in TECHNIQUES {
            let (mean, error) = per_channel(&with(&frame, active).with_walk(u32::MAX, 0.9), half(1000));
            for c in 0..3 {
                let z = z_of_means((mean[c], error[c]), truth[c]);
                let found = (mean[c], error[c]);
                assert!(z.abs() < 4.2, "{name}, {active:?}, channel {c}: {found:?} for {:?}, z = {z}", truth[c]);
            }
        }
    }
}

#[test]
fn no_technique_and_no_end_of_walks_changes_a_mean() {
    for (name, frame) in variety().into_iter().take(3) {
        for segments in 1..=4 {
            let only = frames::with_length(&frame, segments);
            let truth = mean(&with(&only, Active::Nee), 1024);
            for (active, survival) in
                [(Active::Path, 0.7), (Active::Both, 1.0), (Active::Bridge, 1.0), (Active::Bridge, 0.8)]
            {
                // One start: walks would end after it if bridges reached everything.
                let starts = if active == Active::Bridge { 1 } else { u32::MAX };
                let found = mean(&with(&only, active).with_walk(starts, survival), 1024);
                let z = z_of_means(found, truth);
                assert!(z.abs() < 4.2, "{name}, {active:?}, {segments} segments: {found:?} and {truth:?}, z = {z}");
            }
        }
    }
}

#[test]
fn flights_count_as_light_of_their_paths() {
    let frame = ray_through(fog(1.0, 0.6, [1.0; 3]), 8);
    let lengths = |min: u32, max: u32| Frame { lengths: PathLengths { min, max }, ..frame.clone() };
    for (min, max) in [(1, 1), (2, 2), (1, 3), (3, 8)] {
        let truth: f64 = (min..=max).map(|n| 0.6_f64.powi(n as i32 - 1)).sum();
        assert_radiance("fog", &lengths(min, max), 20_000, [1.0; 3], truth);
    }
}

#[test]
fn aimed_flights_are_not_asked_for_where_media_emit() {
    let [(_, fog), ..] = variety();
    let aimed = Frame { aimed: 0.4, ..with(&fog, Active::Bridge) };
    assert!(!aimed.aims() && aimed.emits());
}

#[test]
fn threads_leave_no_trace() {
    for (name, frame) in variety() {
        let frame = with(&frame, Active::Bridge);
        let pixels = |threads: usize| {
            let workers = Workers { threads, ..WORKERS };
            render_with(&frame, &SIMD, workers, SMALL, 8, 0..8).0.pixels().collect::<Vec<_>>()
        };
        assert_eq!(pixels(1), pixels(3), "{name}");
    }
}

#[test]
fn sums_hold_the_faintest_and_the_brightest_emission() {
    for scale in [1e-18_f32, 1e-6, 1e6, 1e18] {
        let emission = EMISSION.map(|channel| channel * scale);
        assert_radiance("fog", &ray_through(fog(0.5, 0.0, emission), 2), 20_000, emission, 2.0);
        let block = solid(Shape::block([[-1.0, -1.0, 2.0], [1.0, 1.0, 4.5]]), 0.0);
        let medium = absorbing(Field::new(vec![block], 0.0), vec![Source::constant(emission)]);
        assert_radiance("box", &ray_through(medium, 2), 8, emission, 2.5);
        let extinctions = HUES.map(|hue| 0.5 * hue);
        let expected = [0, 1, 2].map(|c| f64::from(emission[c] / extinctions[c]));
        let coloured = coloured_fog(extinctions, [0.0; 3], emission);
        assert_radiances("coloured fog", &ray_through(coloured, 2), 60_000, expected);
    }
}
