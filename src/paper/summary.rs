//! A summary of the report in Markdown, with small pictures, for those who read it in the repository.

use core::fmt::Write;
use std::fs;
use std::path::Path;

use super::folder::Folder;
use super::section::{Gallery, Section, Table};
use super::{CITATION, ITEMS};
use crate::error::{Error, Result};
use crate::image::tone::Exposure;
use crate::image::{Image, exr, png};
use crate::output;

/// Longest side of a picture in pixels.
const SIDE: usize = 112;
/// Pictures in a row.
const ROW: usize = 5;
/// Pixels between pictures.
const GAP: usize = 4;

/// Writes `README.md` and its pictures to the folder at `to`, which is made if it is not there.
///
/// # Errors
/// If something cannot be read or written.
pub fn write(folder: &Folder, to: &Path) -> Result<()> {
    fs::create_dir_all(to).map_err(|error| {
        let finding = format!("cannot be made: {error}");
        Error::failure(format!("--summary {}", to.display()), finding, "give a folder that can be written")
    })?;
    let mut text = format!(
        "# The paper, reproduced\n\n{CITATION}.\n\nThis page is written by fogbow itself, with the pictures beside it:\n\
         \n```\ncargo run --release -- paper -o out/paper --summary docs/paper\n```\n\n`out/paper/index.html` is then the \
         whole report, with pictures to compare by flip and wipe, error maps, exposure and all data. Our cameras are \
         right-handed, so that pictures are mirror images of those in the paper.\n"
    );
    for section in ITEMS.iter().filter_map(|item| folder.section(item.name)) {
        add(&mut text, &section, folder, to)?;
    }
    folder.write(&to.join("README.md"), &text)
}

fn add(text: &mut String, section: &Section, folder: &Folder, to: &Path) -> Result<()> {
    // Writing to a text cannot fail.
    let _ = writeln!(text, "\n## {}", section.title);
    for paragraph in &section.text {
        let _ = writeln!(text, "\n{paragraph}");
    }
    for claim in &section.claims {
        let verdict = claim.verdict.text();
        let why = if claim.why.is_empty() { String::new() } else { format!(" {}", claim.why) };
        let _ = writeln!(
            text,
            "\n- **{verdict}** - published: {} ({}) Found: {}{why}",
            claim.published, claim.source, claim.found
        );
    }
    for (index, gallery) in section.galleries.iter().enumerate() {
        let name = format!("{}-{}.png", section.item, index + 1);
        write_strip(folder, gallery, &to.join(&name))?;
        let names: Vec<_> =
            gallery.pictures.iter().map(|picture| format!("{} ({})", picture.name, picture.note)).collect();
        let _ = writeln!(
            text,
            "\n![{}]({name})\n\n{} From left to right: {}.",
            gallery.caption,
            gallery.caption,
            names.join("; ")
        );
    }
    for table in &section.tables {
        add_table(text, table);
    }
    for plot in section.plots.iter().filter(|plot| plot.file.ends_with(".svg")) {
        let name = format!("{}-{}", section.item, plot.file);
        let from = folder.path(&format!("{}/{}", section.item, plot.file));
        let drawing = fs::read_to_string(&from).map_err(|error| {
            Error::failure(from.display(), format!("cannot be read: {error}"), "run the command again")
        })?;
        folder.write(&to.join(&name), &drawing)?;
        let _ = writeln!(text, "\n![{}]({name})\n\n{}", plot.caption, plot.caption);
    }
    let made = &section.made;
    let _ = writeln!(text, "\n{}, {}, {} threads.", made.date, made.processor, made.threads);
    Ok(())
}

fn add_table(text: &mut String, table: &Table) {
    let line = |cells: &[String]| {
        format!("| {} |", cells.iter().map(|cell| cell.replace('|', "\\|")).collect::<Vec<_>>().join(" | "))
    };
    let titles: Vec<_> = table.titles().into_iter().map(String::from).collect();
    let rule = vec!["---".to_string(); titles.len()];
    let _ = writeln!(text, "\n{}\n\n{}\n{}", table.caption, line(&titles), line(&rule));
    for row in table.texts() {
        let _ = writeln!(text, "{}", line(&row));
    }
}

/// The pictures of a gallery in rows, small.
fn write_strip(folder: &Folder, gallery: &Gallery, to: &Path) -> Result<()> {
    let images: Vec<Image> =
        gallery.pictures.iter().map(|picture| exr::read_image(&folder.path(&picture.file))).collect::<Result<_>>()?;
    let small: Vec<Small> = images.iter().map(|image| Small::of(image, Exposure(gallery.exposure))).collect();
    let [width, height] = [0, 1].map(|axis| small.iter().map(|small| small.size[axis]).max().unwrap_or(1));
    let (columns, rows) = (small.len().clamp(1, ROW), small.len().div_ceil(ROW).max(1));
    let size = [columns * (width + GAP) - GAP, rows * (height + GAP) - GAP];
    let mut pixels = vec![[255_u8; 3]; size[0] * size[1]];
    for (index, small) in small.iter().enumerate() {
        let (left, top) = (index % ROW * (width + GAP), index / ROW * (height + GAP));
        for (y, row) in small.pixels.chunks(small.size[0]).enumerate() {
            let start = (top + y) * size[0] + left;
            pixels[start..start + row.len()].copy_from_slice(row);
        }
    }
    let lines = pixels.chunks(size[0]).map(|row| row.iter().flatten().copied());
    output::write(to, || false, |file| png::write_rows(file, size.map(|length| length as u32), lines, &[]))
}

/// A small picture.
struct Small {
    size: [usize; 2],
    pixels: Vec<[u8; 3]>,
}

impl Small {
    /// Means of radiances, exposed.
    fn of(image: &Image, exposure: Exposure) -> Self {
        let full = [image.width, image.height];
        let longest = full[0].max(full[1]);
        let size = full.map(|length| if longest > SIDE { (length * SIDE / longest).max(1) } else { length });
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
        Self { size, pixels }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::section::{Cell, Column, Show};

    #[test]
    fn small_pictures_are_means() {
        let (width, height) = (2 * SIDE, SIDE);
        let plane = |scale: f32| (0..width * height).map(|i| scale * (i % 2) as f32).collect::<Vec<_>>();
        let channels = [("R", 2.0), ("G", 1.0), ("B", 0.0)].map(|(name, scale)| (name.to_string(), plane(scale)));
        let small = Small::of(&Image { width, height, channels: channels.into(), header: vec![] }, Exposure(0.0));
        assert_eq!(small.size, [SIDE, SIDE / 2]);
        assert!(small.pixels.iter().all(|pixel| *pixel == Exposure(0.0).encode([1.0, 0.5, 0.0])));
    }

    #[test]
    fn tables_are_markdown() {
        let mut text = String::new();
        let columns = Column::all([("a", Show::Digits(2)), ("|z| > 1", Show::Digits(2))]);
        add_table(
            &mut text,
            &Table { caption: "All.".into(), columns, rows: vec![[1.0, 2.0].map(Cell::from).to_vec()] },
        );
        assert_eq!(text, "\nAll.\n\n| a | \\|z\\| > 1 |\n| --- | --- |\n| 1 | 2 |\n");
    }
}
