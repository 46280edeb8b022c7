use glam::DVec3;
use wide::{f32x8, u32x8};

use crate::media::reference::Medium as _;
use crate::media::spectral::{Hues, largest};
use crate::media::{Medium, MediumLanes, MediumX8};
use crate::phase::PhaseFunction;
use crate::transcendental::neg_ln;
use crate::vec3::Vec3x8;
use crate::{with_homogeneous, with_medium};

const EXTINCTION: [f32; 3] = [0.2, 1.0, 3.0];
/// Channels of eight rows; rows that are not in use may ask for anything.
const CHANNELS: [u32; 8] = [0, 1, 2, 2, 1, 0, u32::MAX, 0xdead_beef];

fn close(found: f32, expected: f64) {
    assert!((f64::from(found) / expected - 1.0).abs() < 2e-6, "{found} instead of {expected}");
}

#[test]
fn lanes_are_those_of_the_twin_in_every_channel() {
    let grey = Medium::homogeneous(1.7, [1.0; 3], PhaseFunction::isotropic());
    let coloured = Medium::coloured(EXTINCTION, [1.0; 3], PhaseFunction::isotropic());
    for medium in [grey, coloured] {
        let (from, to) = ([0.0, 0.0, 1.0], [3.0, 0.0, 5.0]);
        let [flight, depth, along, extinction] = with_homogeneous!(medium, |lanes| {
            let lanes = lanes.in_channel(|| u32x8::new(CHANNELS));
            let [from, to] = [from, to].map(Vec3x8::splat);
            let depth = lanes.optical_depth(from, to, f32x8::splat(5.0));
            let along = lanes.optical_depth_along(f32x8::splat(5.0), f32x8::ZERO);
            let flight = neg_ln(f32x8::splat(0.25)) * lanes.mean_free_path();
            [flight, depth, along, lanes.extinction(from)].map(f32x8::to_array)
        });
        let [from, to] = [from, to].map(|v| DVec3::from(v.map(f64::from)));
        for row in 0..6 {
            let twin = medium.homogeneous_twin(CHANNELS[row] as usize);
            close(flight[row], twin.flight(0.75));
            close(depth[row], twin.optical_depth(from, to));
            close(along[row], twin.optical_depth(from, to));
            close(extinction[row], twin.extinction(to));
        }
    }
}

#[test]
fn hues_are_quotients_of_densities_of_walks() {
    let medium = Medium::coloured(EXTINCTION, [1.0; 3], PhaseFunction::isotropic());
    let (vertices, length) = (4, 2.5_f64);
    for (own, reference) in EXTINCTION.into_iter().enumerate() {
        let hues = with_medium!(medium, |lanes| Hues::new(lanes, u32x8::splat(own as u32)));
        let depth = f64::from(reference) * length;
        let found = hues.quotients(f32x8::splat(vertices as f32), f32x8::splat(depth as f32));
        let density = |channel: usize| {
            let extinction = f64::from(EXTINCTION[channel]);
            extinction.powi(vertices) * (-extinction * length).exp()
        };
        for (channel, found) in found.into_iter().enumerate() {
            close(found.to_array()[3] / 4.0, density(channel) / density(own) / 4.0);
        }
        for (found, extinction) in hues.depths(f32x8::splat(depth as f32)).into_iter().zip(EXTINCTION) {
            close(found.to_array()[5], f64::from(extinction) * length);
        }
    }
}

#[test]
fn the_largest_of_three_is_found_and_the_first_of_equals() {
    let values = [[1.0, 2.0, 3.0], [3.0, 2.0, 1.0], [1.0, 3.0, 2.0], [2.0, 2.0, 1.0], [1.0, 2.0, 2.0], [0.0; 3]];
    for (values, expected) in values.into_iter().zip([2, 0, 1, 0, 1, 0]) {
        assert_eq!(largest(values.map(f32x8::splat)).to_array(), [expected; 8], "{values:?}");
    }
}

#[test]
fn a_clear_channel_is_a_millionth_of_the_densest() {
    let medium = Medium::coloured([0.0, 2.0, 1.0], [0.0; 3], PhaseFunction::isotropic());
    assert_eq!(medium.extinctions(), [2e-6, 2.0, 1.0]);
    assert!(medium.is_coloured() && !Medium::vacuum().is_coloured());
    assert_eq!(Medium::coloured([0.0; 3], [0.0; 3], PhaseFunction::isotropic()), Medium::vacuum());
}
