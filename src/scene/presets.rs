//! Media by name: what `medium.preset` stands for.

mod table;

use serde::Serialize;

use super::document::Document;
use super::schema::{Medium, Phase, Scene, Spectrum};
use crate::error::{Error, Result};
pub use table::PRESETS;

/// A medium with a name.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Preset {
    /// Its name in scene files.
    pub name: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// Scattering coefficient of the red, green and blue channel [1/m].
    pub scattering: [f64; 3],
    /// Absorption coefficient of the red, green and blue channel [1/m].
    pub absorption: [f64; 3],
    /// How a scattering event redirects light.
    pub phase: Phase,
    /// Who published the numbers, or what they rest on.
    pub source: &'static str,
    /// What was done to the published numbers.
    pub conversion: &'static str,
}

impl Preset {
    /// The one called `name`.
    pub fn named(name: &str) -> Option<&'static Self> {
        PRESETS.iter().find(|preset| preset.name == name)
    }

    /// Mean free path of the red, green and blue channel `[m]`.
    pub fn mean_free_path(&self) -> [f64; 3] {
        core::array::from_fn(|channel| 1.0 / (self.scattering[channel] + self.absorption[channel]))
    }
}

/// Puts the coefficients of the preset that a medium of `scene` names in the place of the name, and its phase function
/// unless the scene has one. What becomes of the scene then depends on numbers only: an image can be repeated although a
/// preset was improved since.
///
/// # Errors
/// If there is no such preset, or the medium has coefficients beside it.
pub fn resolve(scene: &mut Scene, document: &Document) -> Result<()> {
    if let Some(medium) = &mut scene.medium {
        resolve_at("medium", medium, document)?;
    }
    for (index, volume) in scene.volume.iter_mut().enumerate() {
        let mut medium = volume.medium();
        resolve_at(&format!("volume[{index}]"), &mut medium, document)?;
        volume.set_medium(medium);
    }
    Ok(())
}

/// The same for the medium at `table`.
fn resolve_at(table: &str, medium: &mut Medium, document: &Document) -> Result<()> {
    let Some(name) = medium.preset.take() else { return Ok(()) };
    let key = format!("{table}.preset");
    let Some(preset) = Preset::named(&name) else {
        let names: Vec<_> = PRESETS.iter().map(|preset| preset.name).collect();
        let remedy = format!("choose one of {}; fogbow presets describes them", names.join(", "));
        return Err(document.error(&key, format!("{key} is {name:?}, but no preset has that name"), remedy));
    };
    let coefficients = ["scattering", "absorption"].map(|coefficient| format!("{table}.{coefficient}"));
    if let Some(path) = coefficients.iter().find(|path| document.has(path)) {
        return Err(contradiction(document, table, path, &name));
    }
    medium.scattering = Spectrum(preset.scattering);
    medium.absorption = Spectrum(preset.absorption);
    if !document.has(&format!("{table}.phase")) {
        medium.phase = preset.phase.clone();
    }
    Ok(())
}

/// The error that the coefficient at `path` stands beside the preset called `name` of the medium at `table`.
fn contradiction(document: &Document, table: &str, path: &str, name: &str) -> Error {
    let key = format!("{table}.preset");
    if document.is_set_by_flag(&key) {
        let remedy = format!("replace the whole medium: --set '{table}={{ preset = {name:?} }}'");
        return document.error(&key, format!("{key} is {name:?}, but {path} is given, too"), remedy);
    }
    let remedy = "leave out one of the two: a preset has its own scattering and absorption";
    document.error(path, format!("{path} is given, but {key} is {name:?}"), remedy)
}

#[cfg(test)]
mod tests {
    use super::super::schema::OneOrTwo;
    use super::*;

    /// `value` with four significant digits.
    fn rounded(value: f64) -> f64 {
        format!("{value:.3e}").parse().expect("a number")
    }

    fn preset(name: &str) -> &'static Preset {
        Preset::named(name).unwrap_or_else(|| panic!("{name} is missing"))
    }

    fn g(preset: &Preset) -> f64 {
        match preset.phase.g {
            Some(OneOrTwo::One(g)) => g,
            _ => panic!("{} has not one lobe", preset.name),
        }
    }

    #[test]
    fn names_are_unique_and_everything_is_sourced() {
        for (index, preset) in PRESETS.iter().enumerate() {
            assert!(PRESETS[..index].iter().all(|other| other.name != preset.name), "{} twice", preset.name);
            assert!(preset.source.len() > 40 && preset.conversion.len() > 20, "{}", preset.name);
            let numbers = preset.scattering.iter().chain(&preset.absorption);
            assert!(numbers.clone().all(|x| *x > 0.0 && rounded(*x) == *x), "{}: {numbers:?}", preset.name);
        }
    }

    #[test]
    fn reduced_scattering_is_what_was_published() {
        for (name, reduced, absorption) in [
            ("milk", [2.55, 3.21, 3.77], [0.0011, 0.0024, 0.014]),
            ("skim_milk", [0.70, 1.22, 1.90], [0.0014, 0.0025, 0.0142]),
            ("skin", [0.74, 0.88, 1.01], [0.032, 0.17, 0.48]),
            ("pale_skin", [1.09, 1.59, 1.79], [0.013, 0.070, 0.145]),
        ] {
            let preset = preset(name);
            let scattering = reduced.map(|per_mm: f64| rounded(1e3 * per_mm / (1.0 - g(preset))));
            assert_eq!(preset.scattering, scattering, "{name}");
            assert_eq!(preset.absorption, absorption.map(|per_mm: f64| rounded(1e3 * per_mm)), "{name}");
        }
    }

    #[test]
    fn mean_cosines_are_what_was_published() {
        let mean = |g: [f64; 3]| rounded(g.iter().sum::<f64>() / 3.0);
        let regular_milk = [0.75, 0.714, 0.681];
        assert_eq!([g(preset("milk")), g(preset("skim_milk"))], [mean(regular_milk); 2]);
        let van_gemert: f64 = 0.62 + 0.29e-3 * 550.0;
        assert_eq!([g(preset("skin")), g(preset("pale_skin"))], [(100.0 * van_gemert).round() / 100.0; 2]);
        assert_eq!(g(preset("espresso")), (1e3 * mean([0.907, 0.896, 0.880])).round() / 1e3);
        assert_eq!(g(preset("apple_juice")), mean([0.947, 0.949, 0.945]));
    }

    #[test]
    fn the_particles_of_sea_water_scatter_what_its_molecules_do_not() {
        let water = preset("sea_water");
        let molecules = [0.0013, 0.0019, 0.0041];
        let particles = rounded(0.037 - 0.0025);
        assert_eq!(water.scattering, molecules.map(|b: f64| rounded(b + particles)));
        let share = particles / water.scattering[1];
        assert_eq!(water.phase.weight, Some((1e3 * share).round() / 1e3));
        assert_eq!(water.phase.g, Some(OneOrTwo::Two([0.924, 0.0])));
    }
}
