//! Charts: curves, points and bars over two axes.

use plotters::prelude::*;

use super::axes::{Axis, Range};
use crate::figures::{csv_line, plain};

/// Pixels of a chart.
const SIZE: (u32, u32) = (720, 420);
/// Size of its letters, in pixels.
const LETTERS: u32 = 15;

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// As a line.
    Line,
    /// As a line with a mark at every point.
    MarkedLine,
    /// As marks.
    Marks,
    /// As steps from the first axis up, as a histogram has them; points are the left ends of its bins.
    Steps,
}

/// A series of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// What the legend calls it; several curves of a name and colour share an entry.
    pub name: String,
    /// Its points.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub look: Look,
    /// In which colour.
    pub colour: [u8; 3],
}

impl Curve {
    /// A curve.
    pub fn new(name: impl Into<String>, points: Vec<(f64, f64)>, look: Look, colour: [u8; 3]) -> Self {
        Self { name: name.into(), points, look, colour }
    }
}

/// A chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// What it shows.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// What is drawn.
    pub curves: Vec<Curve>,
    /// Whether the vertical axis begins at 0, unless it is logarithmic.
    pub from_zero: bool,
    /// Where the legend is.
    pub legend: Corner,
}

/// A place in a chart where no curve is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corner {
    /// Where steep falls leave room.
    UpperRight,
    /// Where peaks on either side leave room.
    UpperMiddle,
    /// Where curves rise.
    UpperLeft,
    /// Where curves fall.
    LowerLeft,
}

impl Chart {
    /// All points as CSV: curve, how it is drawn, and both coordinates, called as the axes are.
    pub fn csv(&self) -> String {
        let mut text = csv_line(["curve", "look", &self.x.title, &self.y.title]);
        for Curve { name, points, look, .. } in &self.curves {
            for (x, y) in points {
                text += &csv_line([name, look.name(), &plain(*x), &plain(*y)]);
            }
        }
        text
    }
}

impl Look {
    fn name(self) -> &'static str {
        match self {
            Self::Line => "line",
            Self::MarkedLine => "marked line",
            Self::Marks => "marks",
            Self::Steps => "steps",
        }
    }
}

impl Corner {
    fn position(self) -> SeriesLabelPosition {
        match self {
            Self::UpperRight => SeriesLabelPosition::UpperRight,
            Self::UpperMiddle => SeriesLabelPosition::UpperMiddle,
            Self::UpperLeft => SeriesLabelPosition::UpperLeft,
            Self::LowerLeft => SeriesLabelPosition::LowerLeft,
        }
    }
}

/// The chart as SVG.
///
/// # Errors
/// What the plotting library says.
pub fn chart(chart: &Chart) -> Result<String, String> {
    let mut text = String::new();
    draw(SVGBackend::with_string(&mut text, SIZE).into_drawing_area(), chart).map_err(|error| error.to_string())?;
    Ok(text)
}

type Outcome<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

fn draw<B: DrawingBackend>(area: DrawingArea<B, plotters::coord::Shift>, chart: &Chart) -> Outcome<B> {
    let Chart { title, x, y, curves, from_zero, legend } = chart;
    let curves: Vec<Vec<(f64, f64)>> = curves.iter().map(|curve| placed(curve, x, y)).collect();
    let all = || curves.iter().flatten();
    let across = x.widened(x.range(all().map(|point| point.0)), 0.02);
    let up = y.range(all().map(|point| point.1));
    let up = y.widened(if *from_zero && !y.is_logarithmic { up.from_zero() } else { up }, 0.04);
    area.fill(&WHITE)?;
    let mut context = ChartBuilder::on(&area)
        .caption(title, ("sans-serif", LETTERS + 3))
        .margin(10)
        .x_label_area_size(44)
        .y_label_area_size(66)
        .build_cartesian_2d(x.coordinate(across), y.coordinate(up))?;
    context
        .configure_mesh()
        .light_line_style(WHITE.mix(0.0))
        .bold_line_style(BLACK.mix(0.12))
        .x_desc(&x.title)
        .y_desc(&y.title)
        .x_label_formatter(&|place| x.label(*place))
        .y_label_formatter(&|place| y.label(*place))
        .label_style(("sans-serif", LETTERS))
        .draw()?;
    for (index, (curve, points)) in chart.curves.iter().zip(curves).enumerate() {
        let is_named =
            chart.curves[..index].iter().all(|other| (&other.name, other.colour) != (&curve.name, curve.colour));
        let [r, g, b] = curve.colour;
        let style = ShapeStyle { color: RGBColor(r, g, b).to_rgba(), filled: true, stroke_width: 2 };
        if curve.look != Look::Marks {
            let line = context.draw_series(LineSeries::new(points.iter().copied(), style))?;
            if is_named {
                line.label(&curve.name).legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], style));
            }
        }
        if matches!(curve.look, Look::Marks | Look::MarkedLine) {
            let marks = context.draw_series(points.iter().map(|point| Circle::new(*point, 3, style)))?;
            if curve.look == Look::Marks && is_named {
                marks.label(&curve.name).legend(move |(x, y)| Circle::new((x + 9, y), 3, style));
            }
        }
    }
    if chart.curves.len() > 1 {
        context
            .configure_series_labels()
            .position(legend.position())
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK.mix(0.3))
            .label_font(("sans-serif", LETTERS))
            .draw()?;
    }
    drop(context);
    area.present()
}

/// The points of a curve that the axes can show.
fn placed(curve: &Curve, x: &Axis, y: &Axis) -> Vec<(f64, f64)> {
    let points: Vec<_> = curve.points.iter().copied().filter(|(across, up)| x.shows(*across) && y.shows(*up)).collect();
    if curve.look != Look::Steps {
        return points;
    }
    points.windows(2).flat_map(|pair| [pair[0], (pair[1].0, pair[0].1)]).chain(points.last().copied()).collect()
}

/// Counts of values in `bins` bins over `range`, as densities: they integrate to one, where all values are within.
/// Points are left ends of bins, and one more at the end.
pub fn bars(values: &[f64], range: Range, bins: usize) -> Vec<(f64, f64)> {
    let width = range.length() / bins as f64;
    let mut counts = vec![0_u64; bins];
    for value in values.iter().filter(|value| value.is_finite()) {
        let bin = ((value - range.low) / width).floor();
        if bin >= 0.0 && bin < bins as f64 {
            counts[bin as usize] += 1;
        }
    }
    let scale = 1.0 / (values.len().max(1) as f64 * width);
    let heights = counts.into_iter().map(|count| count as f64 * scale).chain([0.0]);
    heights.enumerate().map(|(bin, height)| (range.low + bin as f64 * width, height)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_are_densities() {
        let bars = bars(&[0.1, 0.2, 0.9, 0.5, 7.0], Range { low: 0.0, high: 1.0 }, 2);
        assert_eq!(bars, [(0.0, 0.8), (0.5, 0.8), (1.0, 0.0)]);
    }

    #[test]
    fn a_chart_shows_titles_names_and_curves() {
        let curve = |name: &str, look| Curve {
            name: name.into(),
            points: vec![(1.0, 1e-3), (2.0, 1.0), (4.0, 10.0)],
            look,
            colour: [1, 2, 3],
        };
        let looks = [("a < b", Look::Line), ("dots", Look::Marks), ("both", Look::MarkedLine), ("bins", Look::Steps)];
        let text = chart(&Chart {
            title: "What it shows".into(),
            x: Axis::linear("length [m]"),
            y: Axis::logarithmic("radiance"),
            curves: looks.map(|(name, look)| curve(name, look)).into(),
            from_zero: false,
            legend: Corner::UpperLeft,
        })
        .expect("a chart");
        for part in ["What it shows", "length [m]", "radiance", "a &lt; b", "dots", "<circle", "#010203"] {
            assert!(text.contains(part), "{part} is missing in {text}");
        }
    }

    #[test]
    fn data_are_plain_numbers_below_the_names_of_the_axes() {
        let chart = Chart {
            title: "not in it".into(),
            x: Axis::linear("time [s]"),
            y: Axis::logarithmic("RMSE"),
            curves: vec![Curve::new("a, b", vec![(0.5, 1e-3), (1000.0, 2.0)], Look::Marks, [0; 3])],
            from_zero: false,
            legend: Corner::UpperLeft,
        };
        assert_eq!(chart.csv(), "curve,look,time [s],RMSE\n\"a, b\",marks,0.5,0.001\n\"a, b\",marks,1000,2\n");
    }
}
