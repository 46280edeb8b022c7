//! Widths of the perturbation, from the published experiment.

use fogbow_kernels::connect::mvnee::GGX_WIDTH;
use fogbow_kernels::connect::mvnee::slope::projection::{SIDE, fit, gaussian, ggx, rings};
use fogbow_kernels::connect::mvnee::slope::{PUBLISHED, TABLE};

use super::claim;
use crate::error::Result;
use crate::figures::{number, percent};
use crate::paper::bench::Bench;
use crate::paper::section::{Cell, Column, Plot, Section, Show, Table, Verdict};
use crate::plot::{self, Axis, Chart, Corner, Curve, Look};

const NAME: &str = "table1";
/// Largest deviation from the published table that is called agreement: what the width of rings and the way of fitting
/// leave open.
const AGREEMENT: f64 = 0.012;

/// A row of the table.
pub struct Row {
    /// Mean cosine.
    pub g: f64,
    /// The published sigma for a mean free path of 1 m `[m]`.
    pub published: Option<f64>,
    /// Sigma for mean free paths of 1 m and 10 m `[m]`.
    pub sigma: [f64; 2],
    /// Width of GGX over sigma.
    pub ggx: f64,
}

/// All rows: the published ones on the published plane, the others on one that shrinks with the spot.
pub fn rows() -> Vec<Row> {
    let row = |(index, (g, value)): (usize, &(f64, f64))| {
        let side = side(*g);
        let [near, far] = [1.0, 10.0].map(|mean_free_path| rings(*g, mean_free_path, side));
        let [sigma, far] = [&near, &far].map(|rings| fit(rings, gaussian).width);
        let published = (index < PUBLISHED).then_some(*value);
        Row { g: *g, published, sigma: [sigma, far], ggx: fit(&near, ggx).width / sigma }
    };
    TABLE.iter().enumerate().map(row).collect()
}

/// Side of the plane in mean free paths.
pub fn side(g: f64) -> f64 {
    if g > 0.9 { 80.0 * (1.0 - g) } else { SIDE }
}

/// c_GGX: the mean ratio of both widths over the published rows.
pub fn ggx_width(rows: &[Row]) -> f64 {
    let published = rows.iter().filter(|row| row.published.is_some());
    published.clone().map(|row| row.ggx).sum::<f64>() / published.count() as f64
}

/// Largest deviation of a row from the published one, relative to that.
pub fn deviation(rows: &[Row]) -> f64 {
    let deviation = |row: &Row| row.published.map(|published| (row.sigma[0] / published - 1.0).abs());
    rows.iter().filter_map(deviation).fold(0.0, f64::max)
}

pub fn make(bench: &Bench<'_>) -> Result<Section> {
    let rows = rows();
    let (deviation, width) = (deviation(&rows), ggx_width(&rows));
    Ok(Section {
        text: vec![
            "One scattering event throws light on a plane one mean free path ahead, 8 x 8 mean free paths, 256 x 256 \
             pixels (Eq. 4). A Gaussian is fitted to the mean over rings; its sigma per unit of distance is what \
             MVNEE perturbs by."
                .into(),
            "A mean free path of 10 m gives ten times the sigma, exactly: it is a slope. Of the second column only \
             what is computed here is shown."
                .into(),
            "Beyond g = 0.9 the spot is a few pixels wide; there the plane is 80 (1 - g) mean free paths wide, so \
             that it shrinks with the spot."
                .into(),
        ],
        claims: vec![
            claim(
                "The ten values of sigma.",
                "Table 1 of the paper, mean free path 1 m",
                Verdict::of(deviation <= AGREEMENT),
                format!("The largest deviation is {}.", percent(deviation)),
                "The fit depends on how rings are averaged, which is not published.",
            ),
            claim(
                &format!("c_GGX = {GGX_WIDTH}: alpha of GGX over sigma."),
                PUBLISHED_WIDTH,
                Verdict::of((width / GGX_WIDTH - 1.0).abs() < 0.005),
                format!("The mean of the ten ratios is {}.", number(width, 5)),
                "The fit depends on how rings are averaged, which is not published.",
            ),
        ],
        tables: vec![table(&rows)],
        plots: vec![chart(bench, &rows)?],
        ..Section::default()
    })
}

const PUBLISHED_WIDTH: &str = "the paper";

fn table(rows: &[Row]) -> Table {
    let row = |row: &Row| {
        let Row { g, published, sigma: [near, far], ggx } = row;
        let deviation = published.map(|published| 100.0 * (near / published - 1.0));
        let numbers = [Some(*g), *published, Some(*near), deviation, Some(*far), Some(far / near), Some(*ggx)];
        numbers.map(Cell::from).to_vec()
    };
    Table {
        caption: "Standard deviations for mean free paths (MFP) of 1 m and 10 m. Rows above g = 0.9 are not published."
            .into(),
        columns: Column::all([
            ("g", Show::Digits(2)),
            ("published sigma, MFP 1 m [m]", Show::Digits(6)),
            ("our sigma [m]", Show::Digits(5)),
            ("deviation [%]", Show::Digits(2)),
            ("our sigma, MFP 10 m [m]", Show::Digits(5)),
            ("ratio of both", Show::Digits(5)),
            ("GGX alpha over sigma", Show::Digits(5)),
        ]),
        rows: rows.iter().map(row).collect(),
    }
}

fn chart(bench: &Bench<'_>, rows: &[Row]) -> Result<Plot> {
    let ours = rows.iter().map(|row| (row.g, row.sigma[0])).collect();
    let published = rows.iter().filter_map(|row| Some((row.g, row.published?))).collect();
    let chart = Chart {
        title: "sigma per unit of distance".into(),
        x: Axis::linear("mean cosine g"),
        y: Axis::logarithmic("sigma [m], MFP 1 m"),
        curves: vec![
            Curve::new("ours", ours, Look::Line, plot::COLOURS[0]),
            Curve::new("published", published, Look::Marks, plot::COLOURS[1]),
        ],
        from_zero: false,
        legend: Corner::LowerLeft,
    };
    bench.plot(NAME, "sigma", "The published values, and ours up to g = 0.99.", &chart)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fit_is_the_published_table() {
        let rows = rows();
        assert_eq!(rows.iter().filter(|row| row.published.is_some()).count(), 10);
        assert_eq!((rows[0].published, rows[9].published), (Some(1.07526), Some(0.0830828)));
        assert!(deviation(&rows) < AGREEMENT, "{}", deviation(&rows));
        assert!((ggx_width(&rows) / 1.637_618_734 - 1.0).abs() < 0.005, "{}", ggx_width(&rows));
        assert!(rows.windows(2).all(|pair| pair[1].sigma[0] < pair[0].sigma[0]));
        assert_eq!(rows.last().map(|row| row.g), Some(0.99));
    }
}
