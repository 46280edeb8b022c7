//! The pictures of a gallery in one small file, side by side, each with its name and note below it.

use embedded_graphics::mono_font::MonoTextStyle;
use embedded_graphics::mono_font::ascii::{FONT_6X10, FONT_7X13_BOLD};
use embedded_graphics::pixelcolor::Rgb888;
use embedded_graphics::prelude::*;
use embedded_graphics::text::{Baseline, Text};

use super::folder::Folder;
use super::section::{Gallery, Picture};
use crate::error::Result;
use crate::image::tone::Exposure;
use crate::image::{Image, exr, png};

/// Width of a strip of several pictures, of one of them at most, and of a picture by itself, in pixels.
const WIDTH: usize = 1200;
const WIDEST: usize = 320;
const ALONE: usize = 640;
/// Most pictures in a row.
const ROW: usize = 5;
/// Pixels between pictures.
const GAP: usize = 6;
/// Height of a line of letters and width of a letter, of the name and of the note.
const LINES: [usize; 2] = [14, 11];
const LETTERS: [usize; 2] = [7, 6];
/// Colours of a file: noise in few colours takes a third of what it takes in all.
const COLOURS: usize = 256;
/// One in so many pixels is looked at to choose them.
const LOOK: i32 = 7;

/// Red, green and blue of pixels, row by row.
struct Canvas {
    size: [usize; 2],
    pixels: Vec<[u8; 3]>,
}

impl OriginDimensions for Canvas {
    fn size(&self) -> Size {
        let [width, height] = self.size.map(|length| length as u32);
        Size::new(width, height)
    }
}

impl DrawTarget for Canvas {
    type Color = Rgb888;
    type Error = core::convert::Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(&mut self, pixels: I) -> core::result::Result<(), Self::Error> {
        let [width, height] = self.size;
        for Pixel(Point { x, y }, colour) in pixels {
            let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { continue };
            if x < width && y < height {
                self.pixels[y * width + x] = [colour.r(), colour.g(), colour.b()];
            }
        }
        Ok(())
    }
}

impl Canvas {
    fn white(size: [usize; 2]) -> Self {
        Self { size, pixels: vec![[255; 3]; size[0] * size[1]] }
    }

    fn paste(&mut self, other: &Self, [left, top]: [usize; 2]) {
        for (y, row) in other.pixels.chunks(other.size[0]).enumerate() {
            let start = (top + y) * self.size[0] + left;
            self.pixels[start..start + row.len()].copy_from_slice(row);
        }
    }

    /// Writes `name`, and below it the lines of `note`.
    fn label(&mut self, name: &str, note: &[String], [left, top]: [usize; 2]) {
        let ink = Rgb888::new(29, 29, 27);
        let mut write = |text: &str, y: usize, style| {
            let place = Point::new(left as i32, y as i32);
            let Ok(_) = Text::with_baseline(text, place, style, Baseline::Top).draw(self);
        };
        write(name, top, MonoTextStyle::new(&FONT_7X13_BOLD, ink));
        for (index, line) in note.iter().enumerate() {
            write(line, top + LINES[0] + index * LINES[1], MonoTextStyle::new(&FONT_6X10, ink));
        }
    }

    /// As PNG in few colours.
    fn png(&self) -> core::result::Result<Vec<u8>, String> {
        let opaque: Vec<u8> = self.pixels.iter().flat_map(|[r, g, b]| [*r, *g, *b, 255]).collect();
        let colours = color_quant::NeuQuant::new(LOOK, COLOURS, &opaque);
        let indices: Vec<u8> = opaque.chunks(4).map(|pixel| colours.index_of(pixel) as u8).collect();
        let mut bytes = Vec::new();
        png::write_indexed(&mut bytes, self.size.map(|length| length as u32), &colours.color_map_rgb(), &indices)?;
        Ok(bytes)
    }
}

/// How large the pictures of a gallery are: at most `of_one` pixels wide and high, in rows of `columns`.
struct Layout {
    columns: usize,
    of_one: usize,
}

impl Layout {
    /// That of so many `pictures`, all of them `scale` times smaller than there is room for.
    fn of(pictures: usize, scale: f64) -> Self {
        // Rows as full as each other.
        let columns = pictures.div_ceil(pictures.div_ceil(ROW).max(1)).max(1);
        let room = if pictures == 1 { ALONE } else { (WIDTH / columns - GAP).min(WIDEST) };
        Self { columns, of_one: ((scale * room as f64) as usize).max(1) }
    }
}

/// The gallery as a PNG file, `scale` times smaller than there is room for.
///
/// # Errors
/// If a picture cannot be read.
pub fn png(folder: &Folder, gallery: &Gallery, scale: f64) -> Result<core::result::Result<Vec<u8>, String>> {
    let images: Vec<Image> =
        gallery.pictures.iter().map(|picture| exr::read_image(&folder.path(&picture.file))).collect::<Result<_>>()?;
    Ok(strip(&images, &gallery.pictures, Exposure(gallery.exposure), scale).png())
}

fn strip(images: &[Image], pictures: &[Picture], exposure: Exposure, scale: f64) -> Canvas {
    let Layout { columns, of_one } = Layout::of(images.len(), scale);
    let small: Vec<Canvas> = images.iter().map(|image| small(image, exposure, of_one)).collect();
    let [width, height] = [0, 1].map(|axis| small.iter().map(|small| small.size[axis]).max().unwrap_or(1));
    let names = pictures.iter().map(|picture| LETTERS[0] * picture.name.chars().count());
    let width = width.max(names.max().unwrap_or(0));
    let notes: Vec<Vec<String>> = pictures.iter().map(|picture| wrapped(&picture.note, width / LETTERS[1])).collect();
    let lines = notes.iter().map(Vec::len).max().unwrap_or(0);
    let below = LINES[0] + lines * LINES[1];
    let (cell, rows) = ([width + GAP, height + 2 + below + GAP], small.len().div_ceil(columns).max(1));
    let mut canvas = Canvas::white([columns * cell[0] - GAP, rows * cell[1] - GAP]);
    for (index, (small, (picture, note))) in small.iter().zip(pictures.iter().zip(&notes)).enumerate() {
        let corner = [index % columns * cell[0], index / columns * cell[1]];
        canvas.paste(small, corner);
        canvas.label(&picture.name, note, [corner[0], corner[1] + height + 2]);
    }
    canvas
}

/// `text` in lines of at most so many letters, broken at blanks.
fn wrapped(text: &str, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.len() + 1 + word.len() <= most => *line = format!("{line} {word}"),
            _ => lines.push(word.into()),
        }
    }
    lines
}

/// The means of radiances, exposed, in at most `most` pixels across; small pictures are enlarged by whole numbers.
fn small(image: &Image, exposure: Exposure, most: usize) -> Canvas {
    let full = [image.width, image.height];
    let longest = full[0].max(full[1]);
    let side = |length: usize| {
        if longest > most { (length * most / longest).max(1) } else { length * (most / longest) }
    };
    let size = full.map(side);
    let planes = ["R", "G", "B"].map(|name| image.channel(name).unwrap_or_default());
    let span = |place: usize, axis: usize| {
        let edge = |place: usize| place * full[axis] / size[axis];
        edge(place)..edge(place + 1).max(edge(place) + 1)
    };
    let mean = |plane: &[f32], x: usize, y: usize| {
        let places = span(y, 1).flat_map(|row| span(x, 0).map(move |column| row * full[0] + column));
        let (sum, count) = places.fold((0.0, 0.0), |(sum, count), place| {
            (sum + plane.get(place).copied().map_or(0.0, f64::from), count + 1.0)
        });
        sum / count
    };
    let pixel = |(y, x): (usize, usize)| exposure.encode(planes.map(|plane| mean(plane, x, y)));
    let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (y, x))).map(pixel).collect();
    Canvas { size, pixels }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image([width, height]: [usize; 2]) -> Image {
        let plane = |scale: f32| (0..width * height).map(|i| scale * (i % 2) as f32).collect::<Vec<_>>();
        let channels = [("R", 2.0), ("G", 1.0), ("B", 0.0)].map(|(name, scale)| (name.to_string(), plane(scale)));
        Image { width, height, channels: channels.into(), header: vec![] }
    }

    #[test]
    fn small_pictures_are_means_and_large_ones_of_whole_pixels() {
        let means = small(&image([200, 100]), Exposure(0.0), 100);
        assert_eq!(means.size, [100, 50]);
        assert!(means.pixels.iter().all(|pixel| *pixel == Exposure(0.0).encode([1.0, 0.5, 0.0])));
        let large = small(&image([30, 20]), Exposure(0.0), 100);
        assert_eq!(large.size, [90, 60]);
        assert_eq!(large.pixels[..3], [[0; 3]; 3]);
    }

    #[test]
    fn notes_are_broken_into_lines() {
        assert_eq!(wrapped("RMSE 0.072, 38 samples in 5.4 s", 16), ["RMSE 0.072, 38", "samples in 5.4 s"]);
        assert_eq!(wrapped("", 16), [""; 0]);
    }

    #[test]
    fn every_picture_has_its_name_below_it() {
        let picture =
            |name: &str| Picture { file: String::new(), name: name.into(), note: "a note".into(), rmse: None };
        let (images, pictures) = (vec![image([64, 32]); 9], ["NEE"; 9].map(picture));
        let canvas = strip(&images, &pictures, Exposure(0.0), 1.0);
        // Five in a row, each three times as large, above two lines of letters.
        let cell = [192 + GAP, 96 + 2 + LINES[0] + LINES[1] + GAP];
        assert_eq!(canvas.size, [5 * cell[0] - GAP, 2 * cell[1] - GAP]);
        let ink = |column: usize, row: usize| {
            let [left, top] = [column * cell[0], row * cell[1] + 96 + 2];
            let places = (top..top + LINES[0]).flat_map(|y| (left..left + 60).map(move |x| (x, y)));
            places.filter(|(x, y)| canvas.pixels[y * canvas.size[0] + x] != [255; 3]).count()
        };
        assert!((0..5).all(|column| ink(column, 0) > 20) && ink(3, 1) > 20 && ink(4, 1) == 0);
        let columns = [1, 3, 5, 6, 7, 10, 11].map(|pictures| Layout::of(pictures, 1.0).columns);
        assert_eq!(columns, [1, 3, 5, 3, 4, 5, 4]);
        let bytes = canvas.png().expect("a file");
        let reader = ::png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
        assert_eq!(reader.info().color_type, ::png::ColorType::Indexed);
    }
}
