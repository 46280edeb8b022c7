//! Paths from a point to a light, drawn to scale in a plane.

use plotters::prelude::*;

use crate::figures::{csv_line, plain};

/// Paths of one technique, on the plane of the drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// What stands above them.
    pub title: String,
    /// Each as its vertices `[m]`.
    pub paths: Vec<Vec<[f64; 2]>>,
    /// Outlines of lights `[m]`.
    pub lights: Vec<Vec<[f64; 2]>>,
    /// The colour of the paths.
    pub colour: [u8; 3],
    /// The direction in which they arrive at their start, or set out from it; an arrow shows it.
    pub arrow: Option<[f64; 2]>,
    /// Whether what leaves the view of the other panels is cut off.
    pub is_cut: bool,
}

/// Width of a drawing in pixels, and the least and largest height of a panel.
const WIDTH: u32 = 960;
const HEIGHTS: [f64; 2] = [140.0, 480.0];
/// Width over height below which panels stand side by side, in two columns.
const NARROW: f64 = 1.6;
/// Room for what stands above a panel, and around it.
const TITLE: u32 = 30;
const MARGIN: f64 = 24.0;
/// Share of a panel's width that the scale bar has at most.
const BAR: f64 = 0.25;
/// Length of arrows as a share of what is shown from left to right.
const ARROW: f64 = 0.09;
/// Vertices of a path, in the mean of a panel, beyond which their marks would hide the paths.
const MOST_MARKS: usize = 40;

/// What all panels share: the part of the plane that they show, and its scale.
struct View {
    low: [f64; 2],
    high: [f64; 2],
    /// Pixels per metre.
    scale: f64,
    /// Panels in a row, and pixels of each.
    columns: u32,
    width: u32,
    height: u32,
    /// Length of arrows `[m]`.
    arrow: f64,
}

impl View {
    fn of(panels: &[Panel]) -> Self {
        let is_whole = |panel: &&Panel| !panel.is_cut || panels.iter().all(|panel| panel.is_cut);
        let paths = panels.iter().filter(is_whole).flat_map(|panel| &panel.paths);
        let points = paths.chain(panels.iter().flat_map(|panel| &panel.lights)).flatten().copied();
        let bounds = |points: &mut dyn Iterator<Item = [f64; 2]>, from: [[f64; 2]; 2]| {
            let finite = points.filter(|point| point.iter().all(|place| place.is_finite()));
            finite.fold(from, |[low, high], point| {
                [[0, 1].map(|axis| low[axis].min(point[axis])), [0, 1].map(|axis| high[axis].max(point[axis]))]
            })
        };
        let [mut low, mut high] = bounds(&mut points.into_iter(), [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]]);
        if low[0] > high[0] {
            (low, high) = ([0.0; 2], [1.0; 2]);
        }
        let arrow = ARROW * (high[0] - low[0]).max(1e-9);
        let tails = panels.iter().filter_map(|panel| panel.arrow_of(arrow)).map(|[tail, _]| tail);
        [low, high] = bounds(&mut tails.into_iter(), [low, high]);
        let extent = [0, 1].map(|axis| (high[axis] - low[axis]).max(1e-9));
        let columns = if panels.len() > 1 && extent[0] < NARROW * extent[1] { 2 } else { 1 };
        let width = WIDTH / columns;
        let scale = ((f64::from(width) - 2.0 * MARGIN) / extent[0]).min((HEIGHTS[1] - 2.0 * MARGIN) / extent[1]);
        let height = (scale * extent[1] + 2.0 * MARGIN).clamp(HEIGHTS[0], HEIGHTS[1]).ceil();
        Self { low, high, scale, columns, width, height: height as u32, arrow }
    }

    /// Left and upper edge of panel `index`, below its title.
    fn corner(&self, index: usize) -> [u32; 2] {
        let (column, row) = (index as u32 % self.columns, index as u32 / self.columns);
        [column * self.width, row * (TITLE + self.height) + TITLE]
    }

    /// Pixels of a drawing of so many panels.
    fn size(&self, panels: usize) -> (u32, u32) {
        (WIDTH, (TITLE + self.height) * (panels as u32).div_ceil(self.columns))
    }

    /// The pixel of a point, that of the middle of what is shown in the middle of the panel.
    fn pixel(&self, point: [f64; 2], corner: [u32; 2]) -> (i32, i32) {
        rounded(self.place(point, corner))
    }

    /// The same, not rounded.
    fn place(&self, point: [f64; 2], [left, top]: [u32; 2]) -> [f64; 2] {
        let middle = [0, 1].map(|axis| 0.5 * (self.low[axis] + self.high[axis]));
        let x = f64::from(left) + 0.5 * f64::from(self.width) + self.scale * (point[0] - middle[0]);
        let y = f64::from(top) + 0.5 * f64::from(self.height) - self.scale * (point[1] - middle[1]);
        [x, y]
    }

    /// The parts of a path that are within a panel, as pixels.
    fn within(&self, path: &[[f64; 2]], corner: [u32; 2]) -> Vec<Vec<(i32, i32)>> {
        let ends = [corner.map(f64::from), [corner[0] + self.width, corner[1] + self.height].map(f64::from)];
        let mut parts: Vec<Vec<[f64; 2]>> = Vec::new();
        for pair in path.windows(2) {
            let Some([a, b]) = clipped([self.place(pair[0], corner), self.place(pair[1], corner)], ends) else {
                continue;
            };
            match parts.last_mut() {
                Some(part) if part.last() == Some(&a) => part.push(b),
                _ => parts.push(vec![a, b]),
            }
        }
        parts.into_iter().map(|part| part.into_iter().map(rounded).collect()).collect()
    }

    /// A round length `[m]` for the scale bar.
    fn bar(&self) -> f64 {
        let most = BAR * f64::from(self.width) / self.scale;
        let power = 10.0_f64.powf(most.log10().floor());
        [5.0, 2.0, 1.0].into_iter().map(|digit| digit * power).find(|length| *length <= most).unwrap_or(power)
    }
}

fn rounded([x, y]: [f64; 2]) -> (i32, i32) {
    (x.round() as i32, y.round() as i32)
}

/// The part of a segment that is within a rectangle, given by two corners.
fn clipped([a, b]: [[f64; 2]; 2], [low, high]: [[f64; 2]; 2]) -> Option<[[f64; 2]; 2]> {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let length = b[axis] - a[axis];
        let at = [low[axis], high[axis]].map(|end| (end - a[axis]) / length);
        if length == 0.0 {
            if !(low[axis]..=high[axis]).contains(&a[axis]) {
                return None;
            }
            continue;
        }
        (from, to) = (from.max(at[0].min(at[1])), to.min(at[0].max(at[1])));
    }
    let at = |share: f64| match share {
        0.0 => a,
        1.0 => b,
        _ => [0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis])),
    };
    (from <= to).then(|| [at(from), at(to)])
}

impl Panel {
    /// Tail and tip of its arrow of this `length`: it ends at the start.
    fn arrow_of(&self, length: f64) -> Option<[[f64; 2]; 2]> {
        let (tip, direction) = (*self.paths.first()?.first()?, self.arrow?);
        Some([[0, 1].map(|axis| tip[axis] - length * direction[axis]), tip])
    }
}

/// The panels, one above the other, all to one scale, as SVG with titles and a scale bar.
///
/// # Errors
/// What the plotting library says.
pub fn paths_svg(panels: &[Panel]) -> Result<String, String> {
    let view = View::of(panels);
    let mut text = String::new();
    let size = view.size(panels.len());
    draw(SVGBackend::with_string(&mut text, size).into_drawing_area(), panels, &view, true)
        .map_err(|error| error.to_string())?;
    Ok(text)
}

/// The same as RGB bytes, with their width and height, without letters.
///
/// # Errors
/// What the plotting library says.
pub fn paths_png(panels: &[Panel]) -> Result<(Vec<u8>, [u32; 2]), String> {
    let view = View::of(panels);
    let (width, height) = view.size(panels.len());
    let mut pixels = vec![255; 3 * (width * height) as usize];
    let backend = BitMapBackend::with_buffer(&mut pixels, (width, height));
    draw(backend.into_drawing_area(), panels, &view, false).map_err(|error| error.to_string())?;
    Ok((pixels, [width, height]))
}

/// All vertices as CSV, in metres.
pub fn paths_csv(panels: &[Panel]) -> String {
    let mut text = csv_line(["panel", "path", "vertex", "right [m]", "up [m]"]);
    for Panel { title, paths, .. } in panels {
        for (path, vertices) in paths.iter().enumerate() {
            for (vertex, [right, up]) in vertices.iter().enumerate() {
                let numbers = [path.to_string(), vertex.to_string(), plain(*right), plain(*up)];
                text += &csv_line([title.to_string()].iter().chain(&numbers));
            }
        }
    }
    text
}

type Area<B> = DrawingArea<B, plotters::coord::Shift>;
type Outcome<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

fn draw<B: DrawingBackend>(area: Area<B>, panels: &[Panel], view: &View, letters: bool) -> Outcome<B> {
    area.fill(&WHITE)?;
    for (index, panel) in panels.iter().enumerate() {
        let corner = view.corner(index);
        draw_panel(&area, panel, view, corner)?;
        if letters {
            let title = ("sans-serif", 18).into_font().color(&BLACK);
            area.draw(&Text::new(
                panel.title.clone(),
                (corner[0] as i32 + MARGIN as i32, corner[1] as i32 - 22),
                title,
            ))?;
        }
    }
    draw_bar(&area, view, letters)?;
    area.present()
}

fn draw_panel<B: DrawingBackend>(area: &Area<B>, panel: &Panel, view: &View, corner: [u32; 2]) -> Outcome<B> {
    let [r, g, b] = panel.colour;
    let colour = RGBColor(r, g, b);
    let pixels = |points: &[[f64; 2]]| points.iter().map(|point| view.pixel(*point, corner)).collect::<Vec<_>>();
    for light in &panel.lights {
        area.draw(&PathElement::new(pixels(light), RGBColor(230, 159, 0).stroke_width(3)))?;
    }
    let vertices: usize = panel.paths.iter().map(Vec::len).sum();
    let has_marks = vertices <= MOST_MARKS * panel.paths.len();
    for path in &panel.paths {
        for part in view.within(path, corner) {
            area.draw(&PathElement::new(part, colour.mix(0.75).stroke_width(1)))?;
        }
        for vertex in path.iter().skip(1).filter(|_| has_marks) {
            area.draw(&Circle::new(view.pixel(*vertex, corner), 2, colour.filled()))?;
        }
    }
    if let Some(arrow) = panel.arrow_of(view.arrow) {
        draw_arrow(area, arrow.map(|end| view.place(end, corner)))?;
    }
    match panel.paths.first().and_then(|path| path.first()) {
        Some(start) => area.draw(&Circle::new(view.pixel(*start, corner), 4, BLACK.filled())),
        None => Ok(()),
    }
}

/// An arrow, whose tip leaves room for the mark of the start.
fn draw_arrow<B: DrawingBackend>(area: &Area<B>, [tail, tip]: [[f64; 2]; 2]) -> Outcome<B> {
    let [x, y] = [tip[0] - tail[0], tip[1] - tail[1]];
    let length = x.hypot(y).max(1e-9);
    let [x, y] = [x / length, y / length];
    let back = |along: f64, aside: f64| rounded([tip[0] - along * x - aside * y, tip[1] - along * y + aside * x]);
    area.draw(&PathElement::new(vec![rounded(tail), back(14.0, 0.0)], BLACK.stroke_width(2)))?;
    area.draw(&Polygon::new(vec![back(5.0, 0.0), back(16.0, 5.0), back(16.0, -5.0)], BLACK.filled()))
}

/// The scale bar, below the last panel.
fn draw_bar<B: DrawingBackend>(area: &Area<B>, view: &View, letters: bool) -> Outcome<B> {
    let (length, bottom) = (view.bar(), area.dim_in_pixel().1 as i32 - 8);
    let left = MARGIN as i32;
    let right = left + (view.scale * length).round() as i32;
    area.draw(&PathElement::new(vec![(left, bottom), (right, bottom)], BLACK.stroke_width(2)))?;
    if !letters {
        return Ok(());
    }
    let text = format!("{} m", crate::figures::number(length, 1));
    area.draw(&Text::new(text, (right + 6, bottom - 9), ("sans-serif", 14).into_font().color(&BLACK)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel() -> Panel {
        Panel {
            title: "two & two".into(),
            paths: vec![vec![[0.0, 0.0], [1.0, 1.0], [4.0, 0.0]], vec![[0.0, 0.0], [4.0, 0.1]]],
            lights: vec![vec![[4.0, -0.5], [4.0, 0.5]]],
            colour: [0, 114, 178],
            arrow: None,
            is_cut: false,
        }
    }

    #[test]
    fn paths_are_drawn_to_scale() {
        let panels = [panel(), panel()];
        let view = View::of(&panels);
        let [origin, right, up] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|point| view.pixel(point, [0, 10]));
        assert!((right.0 - origin.0 - (origin.1 - up.1)).abs() <= 1 && right.1 == origin.1 && up.0 == origin.0);
        assert!(view.scale > 0.0 && view.bar() == 1.0);
        let text = paths_svg(&panels).expect("a drawing");
        assert_eq!(text.matches("two &amp; two").count(), 2);
        assert!(text.contains("1 m"), "{text}");
        let data = paths_csv(&panels);
        assert_eq!(data.lines().count(), 1 + 2 * 5);
        assert_eq!(data.lines().nth(5), Some("two & two,1,1,4,0.1"), "{data}");
    }

    #[test]
    fn narrow_panels_stand_side_by_side() {
        let narrow = Panel { paths: vec![vec![[0.0, 0.0], [1.0, 3.0]]], lights: vec![], ..panel() };
        let view = View::of(&[narrow.clone(), narrow.clone(), narrow.clone()]);
        assert_eq!((view.columns, view.corner(1)[0], view.corner(2)[0]), (2, WIDTH / 2, 0));
        assert_eq!(view.size(3).1, 2 * (TITLE + view.height));
        assert_eq!(View::of(&[narrow]).columns, 1, "a single one has all of the width");
    }

    #[test]
    fn a_picture_has_ink_of_the_paths() {
        let (pixels, [width, height]) = paths_png(&[panel()]).expect("a drawing");
        assert_eq!(pixels.len() as u32, 3 * width * height);
        let dark = pixels.chunks(3).filter(|rgb| rgb.iter().any(|channel| *channel < 128)).count();
        assert!(dark > 500, "{dark} dark pixels");
    }

    #[test]
    fn an_arrow_ends_at_the_start_and_is_in_sight() {
        let panel = Panel { arrow: Some([0.6, 0.8]), ..panel() };
        let (view, plain) =
            (View::of(core::slice::from_ref(&panel)), View::of(&[Panel { arrow: None, ..panel.clone() }]));
        let [tail, tip] = panel.arrow_of(view.arrow).expect("an arrow");
        assert!(tip == [0.0, 0.0] && tail[0] < plain.low[0] && view.low[0] == tail[0], "{tail:?}");
        assert!((0.8 * tail[0] - 0.6 * tail[1]).abs() < 1e-9 && tail[1] < 0.0, "{tail:?}");
        let [with, without] =
            [panel.clone(), Panel { arrow: None, ..panel }].map(|panel| paths_svg(&[panel]).expect("SVG"));
        assert_eq!(with.matches("<polygon").count(), without.matches("<polygon").count() + 1);
    }

    #[test]
    fn marks_are_left_out_where_paths_have_too_many_of_them() {
        let path = |vertices: usize| (0..vertices).map(|k| [k as f64, 0.0]).collect::<Vec<_>>();
        let marks = |paths: Vec<Vec<[f64; 2]>>| {
            paths_svg(&[Panel { paths, ..panel() }]).expect("SVG").matches("<circle").count()
        };
        assert_eq!(marks(vec![path(60), path(5), path(5)]), 1 + 59 + 4 + 4, "one long path hides no others");
        assert_eq!(marks(vec![path(60), path(60)]), 1, "the start alone");
    }

    #[test]
    fn what_leaves_the_view_is_cut_off() {
        let far =
            Panel { paths: vec![vec![[0.0, 0.0], [2.0, 0.5], [40.0, 0.5], [2.0, -0.5]]], is_cut: true, ..panel() };
        let view = View::of(&[panel(), far.clone()]);
        assert_eq!(view.high[0], 4.0);
        let parts = view.within(&far.paths[0], [0, 30]);
        assert_eq!(parts.len(), 2, "{parts:?}");
        let (width, height) = view.size(1);
        let is_within = |(x, y): &(i32, i32)| (0..=width as i32).contains(x) && (30..=height as i32).contains(y);
        assert!(parts.iter().flatten().all(is_within), "{parts:?}");
        assert_eq!(View::of(&[far]).high[0], 40.0, "nothing else to show");
        assert_eq!(clipped([[-1.0, 0.5], [-1.0, 0.7]], [[0.0; 2], [1.0; 2]]), None);
        assert_eq!(clipped([[-1.0, 0.5], [3.0, 0.5]], [[0.0; 2], [1.0; 2]]), Some([[0.0, 0.5], [1.0, 0.5]]));
    }
}
