//! Charts: curves, points and bars over two axes.

use plotters::prelude::*;

use super::axes::{Axis, Range};
use crate::figures::{csv_line, plain};

/// Pixels of a chart.
const SIZE: (u32, u32) = (720, 420);
/// Room on the left of the names of curves.
const MARGIN: u32 = 66;
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

    fn style(&self) -> ShapeStyle {
        let [r, g, b] = self.colour;
        ShapeStyle { color: RGBColor(r, g, b).to_rgba(), filled: true, stroke_width: 2 }
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
    fn has_line(self) -> bool {
        self != Self::Marks
    }

    fn has_marks(self) -> bool {
        matches!(self, Self::Marks | Self::MarkedLine)
    }

    fn name(self) -> &'static str {
        match self {
            Self::Line => "line",
            Self::MarkedLine => "marked line",
            Self::Marks => "marks",
            Self::Steps => "steps",
        }
    }
}

/// The chart as SVG.
///
/// # Errors
/// What the plotting library says.
pub fn chart(chart: &Chart) -> Result<String, String> {
    let mut text = String::new();
    let legend = Legend::of(&chart.curves);
    let size = (SIZE.0, SIZE.1 + legend.height());
    draw(SVGBackend::with_string(&mut text, size).into_drawing_area(), chart, &legend)
        .map_err(|error| error.to_string())?;
    Ok(text)
}

type Outcome<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

type Area<B> = DrawingArea<B, plotters::coord::Shift>;

fn draw<B: DrawingBackend>(whole: Area<B>, chart: &Chart, legend: &Legend<'_>) -> Outcome<B> {
    let Chart { title, x, y, curves, from_zero } = chart;
    let curves: Vec<Vec<(f64, f64)>> = curves.iter().map(|curve| placed(curve, x, y)).collect();
    let all = || curves.iter().flatten();
    let across = x.widened(x.range(all().map(|point| point.0)), 0.02);
    let up = y.range(all().map(|point| point.1));
    let up = y.widened(if *from_zero && !y.is_logarithmic { up.from_zero() } else { up }, 0.04);
    whole.fill(&WHITE)?;
    let (area, below) = whole.split_vertically(SIZE.1);
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
    for (curve, points) in chart.curves.iter().zip(curves) {
        if curve.look.has_line() {
            context.draw_series(LineSeries::new(points.iter().copied(), curve.style()))?;
        }
        if curve.look.has_marks() {
            context.draw_series(points.iter().map(|point| Circle::new(*point, 3, curve.style())))?;
        }
    }
    drop(context);
    legend.draw(&below)?;
    whole.present()
}

/// The names of curves, below the chart, where they hide nothing.
struct Legend<'a> {
    /// Every name once, with left edge and row.
    entries: Vec<(&'a Curve, u32, u32)>,
    rows: u32,
}

/// Pixels of a row of the legend, of the sample of a curve beside its name, and of a letter, about.
const ROW: u32 = 22;
const SAMPLE: u32 = 34;
const LETTER: u32 = 8;

impl<'a> Legend<'a> {
    /// That of `curves`; nothing if there is one alone.
    fn of(curves: &'a [Curve]) -> Self {
        let (mut entries, mut left, mut row) = (Vec::new(), MARGIN, 0);
        for (index, curve) in curves.iter().enumerate() {
            let is_known = |other: &Curve| (&other.name, other.colour) == (&curve.name, curve.colour);
            if curves.len() < 2 || curves[..index].iter().any(is_known) {
                continue;
            }
            let width = SAMPLE + LETTER * curve.name.chars().count() as u32;
            if left + width > SIZE.0 && left > MARGIN {
                (left, row) = (MARGIN, row + 1);
            }
            entries.push((curve, left, row));
            left += width;
        }
        let rows = if entries.is_empty() { 0 } else { row + 1 };
        Self { entries, rows }
    }

    fn height(&self) -> u32 {
        self.rows * ROW
    }

    fn draw<B: DrawingBackend>(&self, area: &Area<B>) -> Outcome<B> {
        for (curve, left, row) in &self.entries {
            let (left, middle, style) = (*left as i32, (row * ROW + ROW / 2) as i32, curve.style());
            if curve.look.has_line() {
                area.draw(&PathElement::new(vec![(left, middle), (left + 18, middle)], style))?;
            }
            if curve.look.has_marks() {
                area.draw(&Circle::new((left + 9, middle), 3, style))?;
            }
            let letters = ("sans-serif", LETTERS).into_font().color(&BLACK);
            area.draw(&Text::new(curve.name.clone(), (left + 23, middle - LETTERS as i32 / 2 - 1), letters))?;
        }
        Ok(())
    }
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
        };
        assert_eq!(chart.csv(), "curve,look,time [s],RMSE\n\"a, b\",marks,0.5,0.001\n\"a, b\",marks,1000,2\n");
    }

    #[test]
    fn names_stand_below_the_chart_each_of_them_once() {
        let curve = |name: &str, look| Curve::new(name, vec![(0.0, 0.0), (1.0, 1.0)], look, [1, 2, 3]);
        let names = ["a technique with a long name", "another one with as long a name", "and a third one of this kind"];
        let curves: Vec<_> =
            names.iter().flat_map(|name| [curve(name, Look::Line), curve(name, Look::Marks)]).collect();
        let legend = Legend::of(&curves);
        let places: Vec<_> =
            legend.entries.iter().map(|(curve, left, row)| (curve.name.as_str(), *left, *row)).collect();
        assert_eq!(places, [(names[0], 66, 0), (names[1], 324, 0), (names[2], 66, 1)]);
        assert_eq!((legend.height(), Legend::of(&curves[..1]).height()), (44, 0));
    }
}
