//! A summary of the report in Markdown, with small pictures, for those who read it in the repository.

use core::fmt::Write;
use std::fs;
use std::path::Path;

use super::folder::Folder;
use super::section::{Section, Table};
use super::{CITATION, ITEMS, REMARKS, strip};
use crate::error::{Error, Result};
use crate::output;

/// Most bytes of all strips together: with the map of differences pictures stay below 3 MB.
const MOST_BYTES: usize = 2_700_000;
/// Galleries of an item beyond which its pictures are smaller.
const MANY: f64 = 3.0;

/// The page.
const PAGE: &str = "README.md";

/// Makes the folder at `to` if it is not there, and fails if nothing can be written there.
///
/// # Errors
/// Which are those.
pub fn check(to: &Path) -> Result<()> {
    fs::create_dir_all(to).map_err(|error| {
        let finding = format!("cannot be made: {error}");
        Error::failure(format!("--summary {}", to.display()), finding, "give a folder that can be written")
    })?;
    output::check(&to.join(PAGE))
}

/// Writes the page and its pictures to the folder at `to`, which is made if it is not there.
///
/// # Errors
/// If something cannot be read or written.
pub fn write(folder: &Folder, to: &Path) -> Result<()> {
    check(to)?;
    let mut text = format!(
        "# The paper, reproduced\n\n{CITATION}.\n\nThis page is written by fogbow itself, with the pictures beside it:\n\
         \n```\ncargo run --release -- paper --references 15min -o out/paper --summary docs/paper\n```\n\n\
         `out/paper/index.html` is then the whole report, with pictures to compare by flip and wipe, error maps, \
         exposure and all data. Our cameras are right-handed, so that pictures are mirror images of those in the paper.\n"
    );
    for remark in REMARKS {
        // Writing to a text cannot fail.
        let _ = writeln!(text, "\n{remark}");
    }
    let sections: Vec<Section> = ITEMS.iter().filter_map(|item| folder.section(item.name)).collect();
    for section in &sections {
        add(&mut text, section, folder, to)?;
    }
    for (name, bytes) in strips(folder, &sections, MOST_BYTES)? {
        write_bytes(&to.join(name), &bytes)?;
    }
    folder.write(&to.join(PAGE), &text)
}

/// What the strip of a gallery is called.
fn name(section: &Section, gallery: usize) -> String {
    format!("{}-{}.png", section.item, gallery + 1)
}

/// All galleries as strips, by their names, so large that together they have at most `most` bytes.
fn strips(folder: &Folder, sections: &[Section], most: usize) -> Result<Vec<(String, Vec<u8>)>> {
    let mut scale = 1.0;
    loop {
        let mut all = Vec::new();
        for section in sections {
            let own = scale * (MANY / section.galleries.len() as f64).sqrt().min(1.0);
            for (index, gallery) in section.galleries.iter().enumerate() {
                let bytes = strip::png(folder, gallery, own)?;
                let failed = |error| Error::failure("--summary", error, "this is a fault of fogbow; report it");
                all.push((name(section, index), bytes.map_err(failed)?));
            }
        }
        let bytes: usize = all.iter().map(|(_, bytes)| bytes.len()).sum();
        if bytes <= most || scale < 0.1 {
            return Ok(all);
        }
        scale *= 0.95 * (most as f64 / bytes as f64).sqrt();
    }
}

fn write_bytes(to: &Path, bytes: &[u8]) -> Result<()> {
    output::write(to, || false, |file| file.write_all(bytes).map_err(|error| error.to_string()))
}

fn add(text: &mut String, section: &Section, folder: &Folder, to: &Path) -> Result<()> {
    let _ = writeln!(text, "\n## {}", section.title);
    if let Some(warning) = section.made.busy() {
        let _ = writeln!(text, "\n**Warning:** {warning}.");
    }
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
        let names: Vec<_> = gallery.pictures.iter().map(|picture| picture.name.as_str()).collect();
        let name = name(section, index);
        let _ = writeln!(text, "\n![{}]({name})\n\n{}", names.join("; "), gallery.caption);
    }
    for table in &section.tables {
        add_table(text, table);
    }
    for plot in &section.plots {
        let name = format!("{}-{}", section.item, plot.file);
        let from = folder.path(&format!("{}/{}", section.item, plot.file));
        let drawing = fs::read(&from).map_err(|error| {
            Error::failure(from.display(), format!("cannot be read: {error}"), "run the command again")
        })?;
        write_bytes(&to.join(&name), &drawing)?;
        let _ = writeln!(text, "\n![{}]({name})\n\n{}", plot.caption, plot.caption);
    }
    let _ = writeln!(text, "\n{}", section.made.line());
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::bench::write_planes;
    use crate::paper::section::{Cell, Column, Gallery, Picture, Show};

    /// A folder with a gallery of noise, which hardly any compression makes smaller.
    fn noise(folder: &Folder) -> Section {
        let size = [240_u32, 240];
        let value =
            |i: u32| [(i * 7919 % 101) as f32 / 50.0, (i * 104_729 % 103) as f32 / 50.0, (i % 97) as f32 / 50.0];
        let pixels: Vec<_> = (0..size[0] * size[1]).map(value).collect();
        let pictures = ["a", "b", "c", "d", "e"].map(|name| {
            let file = format!("fig8/{name}.exr");
            write_planes(&folder.file("fig8", &format!("{name}.exr")).expect("a folder"), size, &pixels)
                .expect("a file");
            Picture { file, name: name.into(), note: "noise".into(), rmse: None }
        });
        let gallery =
            Gallery { caption: "Noise.".into(), exposure: 0.0, pictures: pictures.into(), has_reference: false };
        Section { item: "fig8".into(), galleries: vec![gallery], ..Section::default() }
    }

    #[test]
    fn pictures_shrink_until_all_of_them_fit() {
        let root = tempfile::tempdir().expect("a folder");
        let folder = Folder::open(root.path()).expect("a folder");
        let sections = [noise(&folder)];
        let bytes =
            |most| strips(&folder, &sections, most).expect("strips").iter().map(|one| one.1.len()).sum::<usize>();
        let all = bytes(usize::MAX);
        assert!(all > 10_000 && (all / 4..all / 2).contains(&bytes(all / 2)), "{all} {}", bytes(all / 2));
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
