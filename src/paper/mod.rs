//! The tables and figures of "Multiple Vertex Next Event Estimation" (Weber, Hanika, Dachsbacher 2017), reproduced, and
//! what lies beyond them.
//!
//! Every [`Item`] makes pictures, data, plots and a [`Section`], which says all that the report shows of it. A report
//! is made of the sections that a folder holds, so that items can be made one at a time, and an item that is there for
//! the same settings is not made again.

mod again;
pub mod bench;
pub mod folder;
mod items;
pub mod load;
pub mod measure;
pub mod ratio;
pub mod reference;
pub mod report;
pub mod rmse;
pub mod run;
pub mod scenes;
pub mod section;
pub mod size;
mod strip;
pub mod summary;
pub mod table;
pub mod turns;

use std::time::Duration;

use crate::error::{Error, Result};
use bench::Bench;
pub use section::Section;

/// Rendering time of all items together, if nothing else is asked for. With what is not counted, preparing scenes and
/// writing the report, it comes to about a quarter of an hour.
pub const DEFAULT_BUDGET: Duration = Duration::from_secs(11 * 60);

/// Authors, title and year of the paper.
pub const CITATION: &str = "Weber, Hanika, Dachsbacher: Multiple Vertex Next Event Estimation, 2017";

/// What has to be known of all numbers, in paragraphs.
pub const REMARKS: [&str; 3] = [
    "Published numbers stand beside ours, with their source. Where ours are ratios, the numbers in brackets are the \
     ends of their confidence interval of 95 %, from the turns that renders take; `turns.csv` in the folder of an item \
     has them all. A claim is not decided where that covers both answers. Where a published number has a size, a claim \
     agrees if ours has the same, to within its interval and 5 %, and in part if only the side of one is the same.",
    "Times, rates, errors and efficiencies are those of rendering alone. What goes before the first sample, choosing \
     settings by a small render of the scene, stands beside them as preparation; the last column of a table has the \
     efficiency with it, for a render of that length. It is the same for a render of an hour.",
    "Renders at equal time take turns, and pictures are so small that the slowest has some samples in every turn; the \
     time of each is on its picture.",
];

/// Something to make.
#[derive(Clone, Copy)]
pub struct Item {
    /// What it is called.
    pub name: &'static str,
    /// What it shows.
    pub title: &'static str,
    /// Its part of the budget, as a weight; 0 if it takes no time to speak of.
    pub share: f64,
    /// The scenes that it renders.
    pub scenes: &'static [&'static str],
    make: fn(&Bench<'_>) -> Result<Section>,
    /// Whether what it may have lacked is there now.
    is_there: fn() -> bool,
}

/// An item that lacks nothing.
const fn item(
    name: &'static str,
    title: &'static str,
    share: f64,
    scenes: &'static [&'static str],
    make: fn(&Bench<'_>) -> Result<Section>,
) -> Item {
    Item { name, title, share, scenes, make, is_there: || false }
}

/// All items, in the order of the report.
pub const ITEMS: [Item; 11] = [
    item("fig1", "Figure 1: the colonnade, and ten paths by each technique", 2.5, &["colonnade"], items::fig1::make),
    item("table1", "Table 1: widths of the perturbation", 0.0, &[], items::table1::make),
    item("fig3", "Figure 3: a scattering event on a plane", 0.0, &[], items::fig3::make),
    item("fig7", "Figure 7: correctness", 1.0, &["cornell-fog"], items::fig7::make),
    item("fig8", "Figure 8: light through a perforated plate, at equal time", 2.5, &["dense-plate"], items::fig8::make),
    item(
        "fig9",
        "Figure 9: phase functions, and lights that face the camera or not",
        2.5,
        &["fog-facing", "fog-perpendicular"],
        items::fig9::make,
    ),
    item("fig10", "Figure 10: a cloud in a box", 2.0, &["cloud-box"], items::fig10::make),
    item("fig11", "Figure 11: a spotlight", 1.5, &["spotlight"], items::fig11::make),
    item("fig12", "Figure 12: paths of 100 vertices", 0.0, &[], items::fig12::make),
    Item {
        is_there: items::peers::is_there,
        ..item("peers", "Beside Mitsuba 3", 2.0, &items::peers::SCENES, items::peers::make)
    },
    item("scaling", "What a sample costs", 1.5, &["fog-facing", "dense-plate"], items::scaling::make),
];

/// The items called `names`, in the order of the report; all of them if none is named.
///
/// # Errors
/// If there is no item of a name.
pub fn named(names: &[String]) -> Result<Vec<Item>> {
    if let Some(unknown) = names.iter().find(|name| ITEMS.iter().all(|item| item.name != name.as_str())) {
        let known: Vec<_> = ITEMS.iter().map(|item| item.name).collect();
        let remedy = format!("name some of {}, or none for all", known.join(", "));
        return Err(Error::usage(format!("ITEM {unknown}"), "is not an item of the paper", remedy));
    }
    let is_meant = |item: &Item| names.is_empty() || names.iter().any(|name| name == item.name);
    Ok(ITEMS.into_iter().filter(is_meant).collect())
}

/// The rendering time of each of `items`, of a budget for all of them; without one, its part of what all items of the
/// report take.
pub fn budgets(items: &[Item], budget: Option<Duration>) -> Vec<Duration> {
    let sum = |items: &[Item]| items.iter().map(|item| item.share).sum::<f64>();
    let (whole, all) = budget.map_or((DEFAULT_BUDGET, sum(&ITEMS)), |budget| (budget, sum(items)));
    let part = |item: &Item| if item.share > 0.0 { whole.mul_f64(item.share / all) } else { Duration::ZERO };
    items.iter().map(part).collect()
}

/// What is told while items are made.
pub trait Tell {
    /// A line for people.
    fn line(&self, text: &str);

    /// Whether somebody wants it to end.
    fn stops(&self) -> bool;
}

/// What became of an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Made {
    /// It was made.
    Now,
    /// It was there.
    Before,
    /// Somebody stopped it; there is nothing of it.
    Interrupted,
}

impl Item {
    /// Makes it, unless it is there.
    ///
    /// # Errors
    /// If a scene cannot be read, or something cannot be written.
    pub fn make(&self, bench: &Bench<'_>) -> Result<Made> {
        let key = bench.key(self)?;
        let is_current = |section: Section| section.key == key && !section.lacks.is_some_and(|_| (self.is_there)());
        if bench.folder.section(self.name).is_some_and(is_current) {
            return Ok(Made::Before);
        }
        // What it found before is not about the pictures that it makes now.
        bench.folder.forget(self.name)?;
        let (start, watch) = (std::time::Instant::now(), load::Watch::begin());
        let section = (self.make)(bench)?;
        if bench.tell.stops() {
            return Ok(Made::Interrupted);
        }
        let made = section::Making::now(bench.threads(), start.elapsed(), watch.load());
        if let Some(warning) = made.busy() {
            bench.tell.line(&format!("  warning: {warning}"));
        }
        let head = (self.name.to_string(), self.title.to_string());
        bench.folder.write_section(&Section { item: head.0, title: head.1, key, made, ..section })?;
        Ok(Made::Now)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn budgets_are_shared_among_the_items_that_are_made() {
        let items = named(&["fig8".into(), "fig7".into(), "table1".into()]).expect("items");
        assert_eq!(items.iter().map(|item| item.name).collect::<Vec<_>>(), ["table1", "fig7", "fig8"]);
        let seconds = budgets(&items, Some(Duration::from_secs(70))).iter().map(Duration::as_secs).collect::<Vec<_>>();
        assert_eq!(seconds, [0, 20, 50]);
        let all: Duration = budgets(&ITEMS, None).into_iter().sum();
        assert!((all.as_secs_f64() - DEFAULT_BUDGET.as_secs_f64()).abs() < 1e-3);
        assert_eq!(budgets(&items, None)[1], budgets(&ITEMS, None)[3], "the same, whatever else is made");
    }
}
