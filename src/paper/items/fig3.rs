//! A scattering event on a plane: what arrives, and the curves that are fitted to it.

use fogbow_kernels::connect::mvnee::slope::projection::{PIXELS, Ring, fit, gaussian, ggx, rings};
use fogbow_kernels::phase::henyey_greenstein::reference::density;

use super::table1::side;
use crate::error::Result;
use crate::figures::number;
use crate::paper::bench::{Bench, write_planes};
use crate::paper::section::{Cell, Column, Gallery, Picture, Plot, Section, Show, Table};
use crate::plot::{self, Axis, Chart, Curve, Look};

const NAME: &str = "fig3";
const COSINES: [f64; 6] = [0.0, 0.3, 0.6, 0.9, 0.95, 0.99];

/// The curves that fit the rings of a mean cosine.
struct Fitted {
    g: f64,
    rings: Vec<Ring>,
    /// Width and height of a Gaussian and of GGX, and their misfits: root mean squares over the height.
    curves: [(f64, f64, f64); 2],
}

impl Fitted {
    fn of(g: f64) -> Self {
        let rings = rings(g, 1.0, side(g));
        let height = rings.first().map_or(1.0, |ring| ring.1);
        let curve = |shape: fn(f64) -> f64| {
            let found = fit(&rings, shape);
            let misfit = |ring: &Ring| (found.height * shape(ring.0 / found.width) - ring.1).powi(2);
            let misfit = (rings.iter().map(misfit).sum::<f64>() / rings.len() as f64).sqrt() / height;
            (found.width, found.height, misfit)
        };
        let curves = [curve(gaussian), curve(ggx)];
        Self { g, rings, curves }
    }
}

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let all: Vec<_> = COSINES.into_iter().map(Fitted::of).collect();
    let plots: Result<Vec<_>> = all.iter().map(|fitted| chart(bench, fitted)).collect();
    Ok(Section {
        text: vec![
            "What one scattering event throws on a plane one mean free path ahead, and the Gaussian and the GGX \
             distribution that fit it best. GGX has a heavier tail, as the phase function does, and misses less of it."
                .into(),
        ],
        tables: vec![table(&all)],
        plots: plots?,
        galleries: vec![spots(bench)?],
        ..Section::default()
    })
}

fn table(all: &[Fitted]) -> Table {
    let row = |fitted: &Fitted| {
        let [(sigma, _, of_gaussian), (alpha, _, of_ggx)] = fitted.curves;
        [fitted.g, sigma, alpha, 100.0 * of_gaussian, 100.0 * of_ggx].map(Cell::from).to_vec()
    };
    Table {
        caption: "Fits, and how far they are from the rings: root mean square over the value in the middle.".into(),
        columns: Column::all([
            ("g", Show::Digits(2)),
            ("sigma of the Gaussian [m]", Show::Digits(4)),
            ("alpha of GGX [m]", Show::Digits(4)),
            ("misfit of the Gaussian [%]", Show::Digits(3)),
            ("misfit of GGX [%]", Show::Digits(3)),
        ]),
        rows: all.iter().map(row).collect(),
    }
}

fn chart(bench: &Bench<'_>, fitted: &Fitted) -> Result<Plot> {
    let Fitted { g, rings, curves: [(sigma, top, _), (alpha, peak, _)] } = fitted;
    let reach = 5.0 * sigma;
    let shown: Vec<_> = rings.iter().copied().take_while(|ring| ring.0 <= reach).collect();
    let reach = shown.last().map_or(reach, |ring| ring.0);
    let along = |height: f64, width: f64, shape: fn(f64) -> f64| {
        (0..=200).map(|k| reach * f64::from(k) / 200.0).map(|radius| (radius, height * shape(radius / width))).collect()
    };
    let chart = Chart {
        title: format!("g = {g}"),
        x: Axis::linear("distance from the middle [m]"),
        y: Axis::linear("irradiance [1/m^2]"),
        curves: vec![
            Curve::new("scattering event", shown, Look::Marks, plot::COLOURS[6]),
            Curve::new("Gaussian", along(*top, *sigma, gaussian), Look::Line, plot::COLOURS[0]),
            Curve::new("GGX", along(*peak, *alpha, ggx), Look::Line, plot::COLOURS[1]),
        ],
        from_zero: true,
    };
    bench.plot(NAME, &format!("profile-g{}", (100.0 * g).round()), format!("g = {g}, mean free path 1 m."), &chart)
}

/// The planes themselves, each divided by its largest value.
fn spots(bench: &Bench<'_>) -> Result<Gallery> {
    let size = PIXELS as u32;
    let mut pictures = Vec::new();
    for g in COSINES {
        let pixel = side(g) / PIXELS as f64;
        let center = |i: usize| (i as f64 + 0.5 - 0.5 * PIXELS as f64) * pixel;
        let at = |i: usize| {
            let squared = 1.0 + center(i % PIXELS).powi(2) + center(i / PIXELS).powi(2);
            density(g, 1.0 / squared.sqrt()) / squared
        };
        let largest = at(PIXELS / 2 * PIXELS + PIXELS / 2);
        let values: Vec<_> = (0..PIXELS * PIXELS).map(|i| [(at(i) / largest) as f32; 3]).collect();
        let name = format!("spot-g{}.exr", (100.0 * g).round());
        write_planes(&bench.folder.file(NAME, &name)?, [size, size], &values)?;
        let note = format!("{} mean free paths wide", number(side(g), 2));
        pictures.push(Picture { file: format!("{NAME}/{name}"), name: format!("g = {g}"), note, rmse: None });
    }
    let caption = "The irradiance on the plane, relative to that in the middle.".into();
    Ok(Gallery { caption, exposure: 1.0, pictures, has_reference: false })
}
