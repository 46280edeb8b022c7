//! Whether single precision tells where volumes are: positions are counted from the camera, and in the cells that all
//! volumes share.

use fogbow_kernels::media::field::{Volume as Placed, Voxels};
use glam::DVec3;

use super::Volume;
use crate::error::Result;
use crate::figures::extent;
use crate::gltf::quoted;
use crate::scene::schema;
use crate::warning::Warning;

/// Places that single precision must tell along every edge, as seen from the camera: with 16, what it absorbs is right to
/// a hundredth or two; with two, wrong by a sixth.
const FEWEST_PLACES: f64 = 16.0;
/// The same along a mean free path: with 42 of them MVNEE was .6 % too bright in a block of ten, with 8 of them 5 %.
const FEWEST_PLACES_OF_A_FLIGHT: f64 = 32.0;
/// Places that single precision must tell from a voxel to the next, as seen from the camera.
const FEWEST_PLACES_OF_A_VOXEL: f64 = 2.0;

impl Volume<'_> {
    /// An error if single precision does not tell where it begins and ends, and a warning if it hardly does: positions are
    /// counted from the camera.
    pub(super) fn must_have_an_inside(&self, placed: &Placed, origin: DVec3) -> Result<()> {
        let [low, high] = placed.bounds();
        let bounds = placed.bounds().map(|corner| (corner + origin).to_array());
        let path = &self.table;
        let finding = |what: &str| {
            format!(
                "{path} is from {} m, too far from the camera for its size: single precision, in which positions \
                 are counted from there, knows {what}",
                extent(bounds)
            )
        };
        let remedy = "move it nearer to the camera, or make it larger";
        if !low.as_vec3().cmplt(high.as_vec3()).all() {
            return Err(self.document.error(path, finding("no difference"), remedy));
        }
        let away = DVec3::ZERO.clamp(low, high).length();
        if (high - low).min_element() < FEWEST_PLACES * f64::from(f32::EPSILON) * away {
            let few = format!("fewer than {FEWEST_PLACES} places along it, so that its image may be wrong; {remedy}");
            (self.warn)(Warning::new(self.document.place(path), finding(&few)));
        }
        Ok(())
    }

    /// Warns of a volume that scatters light after distances which single precision hardly tells: positions are counted
    /// from the camera.
    pub(super) fn warn_if_coarse(&self, placed: &Placed, most: f64) {
        let [low, high] = placed.bounds();
        let away = DVec3::ZERO.clamp(low, high).length();
        let coarse = FEWEST_PLACES_OF_A_FLIGHT * f64::from(f32::EPSILON) * away;
        if most * coarse > 1.0 && !self.medium.never_scatters() {
            let path = &self.table;
            let flight = 1.0 / most;
            let finding = format!(
                "{path} is {away:.3e} m away from the camera, with mean free paths of {flight:.3e} m where it is densest: \
                 single precision hardly tells them there, so that its image may be wrong; move it nearer to the camera"
            );
            (self.warn)(Warning::new(self.document.place(path), finding));
        }
    }

    /// Warns of voxels, `edge` from one to the next, which single precision hardly tells apart somewhere within bounds:
    /// positions are counted from the camera.
    pub(super) fn warn_if_blurred(&self, table: &str, grid: &schema::Grid, [low, high]: [DVec3; 2], edge: f64) {
        let away = low.abs().max(high.abs()).length();
        if edge < FEWEST_PLACES_OF_A_VOXEL * f64::from(f32::EPSILON) * away {
            let file = quoted(&grid.file);
            self.warn(
                &format!("{table}.file"),
                format!(
                    "{file}, a grid whose voxels are {edge:.3e} m apart and up to {away:.3e} m from the camera: single \
                     precision hardly tells one from the next there, so that its image may be wrong; move it nearer to \
                     the camera, or make it larger"
                ),
            );
        }
    }

    /// An error if it is so small next to the box around all volumes that single precision does not tell where it begins and
    /// ends in there, and a warning if it hardly does.
    pub(super) fn must_be_resolved_within(&self, all: [DVec3; 2], placed: &Placed, origin: DVec3) -> Result<()> {
        let [low, high] = placed.bounds();
        let place = f64::from(f32::EPSILON) * (all[1] - all[0]);
        let places = ((high - low) / place).min_element();
        // Voxels may be turned: the shortest of their edges, along the axis with the coarsest places.
        let edge = placed.all_voxels().map(Voxels::edge).fold(f64::INFINITY, f64::min);
        let places_of_a_voxel = edge / place.max_element();
        let path = &self.table;
        let finding = |what: &str| {
            let [own, all] = [[low, high], all].map(|bounds| extent(bounds.map(|at| (at + origin).to_array())));
            format!(
                "{path} is from {own} m, too small next to all volumes, which are from {all} m: single precision, in which \
                 positions are counted in parts of the box around them, knows {what}"
            )
        };
        let remedy = "make it larger, or the other volumes smaller";
        if places < 1.0 {
            return Err(self.document.error(path, finding("no difference"), remedy));
        }
        let few = if places < FEWEST_PLACES {
            format!("fewer than {FEWEST_PLACES} places along it")
        } else if places_of_a_voxel < FEWEST_PLACES_OF_A_VOXEL {
            format!("fewer than {FEWEST_PLACES_OF_A_VOXEL} places from a voxel to the next")
        } else {
            return Ok(());
        };
        let few = format!("{few}, so that its image may be wrong; {remedy}");
        (self.warn)(Warning::new(self.document.place(path), finding(&few)));
        Ok(())
    }
}
