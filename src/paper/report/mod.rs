//! The report: one HTML file with everything in it, that asks for no network.

mod embed;
mod page;

use super::folder::Folder;
use super::{ITEMS, Section};
use crate::error::Result;

/// Writes the report of all sections that are in `folder`, in the order of the items, and says how many these are.
///
/// # Errors
/// If a picture cannot be read, or the report not be written.
pub fn write(folder: &Folder) -> Result<usize> {
    let sections: Vec<Section> = ITEMS.iter().filter_map(|item| folder.section(item.name)).collect();
    let text = page::page(folder, &sections)?;
    folder.write(&folder.report(), &text)?;
    Ok(sections.len())
}
