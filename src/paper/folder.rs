//! The folder of a report: a folder per item with its data, converged references, and the report itself.

use std::fs;
use std::path::{Path, PathBuf};

use super::section::Section;
use crate::error::{Error, Result};
use crate::output;

/// The file that says what an item found.
const DATA: &str = "data.json";
/// The folder of references, of which several items use some.
const REFERENCES: &str = "references";

/// The folder.
#[derive(Clone, Debug)]
pub struct Folder {
    root: PathBuf,
}

impl Folder {
    /// The folder at `root`, which is made if it is not there.
    ///
    /// # Errors
    /// If it cannot be made, or nothing can be written there.
    pub fn open(root: &Path) -> Result<Self> {
        let folder = Self { root: root.to_path_buf() };
        folder.make(REFERENCES)?;
        output::check(&folder.report())?;
        Ok(folder)
    }

    /// The report.
    pub fn report(&self) -> PathBuf {
        self.root.join("index.html")
    }

    /// What is at `path` in it.
    pub fn path(&self, path: &str) -> PathBuf {
        self.root.join(path)
    }

    /// The file `name` of `item`, whose folder is made if it is not there.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn file(&self, item: &str, name: &str) -> Result<PathBuf> {
        Ok(self.make(item)?.join(name))
    }

    /// The reference called `name`.
    pub fn reference(&self, name: &str) -> String {
        format!("{REFERENCES}/{name}.exr")
    }

    fn make(&self, name: &str) -> Result<PathBuf> {
        let folder = self.root.join(name);
        fs::create_dir_all(&folder).map_err(|error| {
            let finding = format!("cannot be made: {error}");
            Error::failure(folder.display(), finding, "give -o a folder that can be written")
        })?;
        Ok(folder)
    }

    /// What `item` found, if it was made and all its files are there.
    pub fn section(&self, item: &str) -> Option<Section> {
        let text = fs::read_to_string(self.root.join(item).join(DATA)).ok()?;
        let section: Section = serde_json::from_str(&text).ok()?;
        let pictures = section.galleries.iter().flat_map(|gallery| &gallery.pictures);
        let plots = section.plots.iter().map(|plot| format!("{item}/{}", plot.file));
        let mut files = pictures.map(|picture| picture.file.clone()).chain(plots);
        files.all(|file| self.root.join(file).is_file()).then_some(section)
    }

    /// Removes what an item found.
    ///
    /// # Errors
    /// If it is there and cannot be removed.
    pub fn forget(&self, item: &str) -> Result<()> {
        let path = self.root.join(item).join(DATA);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                let finding = format!("cannot be removed: {error}");
                Err(Error::failure(path.display(), finding, "check its permissions"))
            }
            _ => Ok(()),
        }
    }

    /// Writes what an item found: all of it as JSON, and its tables as CSV. JSON comes last, so that what is there is
    /// complete.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write_section(&self, section: &Section) -> Result<()> {
        for (index, table) in section.tables.iter().enumerate() {
            self.write(&self.file(&section.item, &format!("table{}.csv", index + 1))?, &table.csv())?;
        }
        if !section.turns.rows.is_empty() {
            self.write(&self.file(&section.item, "turns.csv")?, &section.turns.csv())?;
        }
        let text = serde_json::to_string_pretty(section).expect("a section is made of numbers and names");
        self.write(&self.file(&section.item, DATA)?, &text)
    }

    /// Writes `text` to `path`.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, path: &Path, text: &str) -> Result<()> {
        output::write(path, || false, |file| file.write_all(text.as_bytes()).map_err(|error| error.to_string()))
    }
}
