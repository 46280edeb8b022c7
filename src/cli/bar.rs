//! The progress bar: one line of a terminal of any width.

use core::fmt::Write;
use std::sync::{Arc, Mutex, PoisonError};

use console::Term;
use indicatif::{ProgressBar, ProgressState, ProgressStyle};

/// Steps of the bar.
const STEPS: u64 = 10_000;
/// Columns of the longest name in front of the bar.
const LONGEST_NAME: usize = 24;
/// Widths from which on there is room for a short outlook, for a long one, and for the name besides.
const WIDTHS: [usize; 3] = [56, 80, 104];

/// What is to stand behind the bar, in short and at length.
pub struct Outlooks {
    pub short: String,
    pub long: String,
}

impl Outlooks {
    /// The same for all widths.
    pub fn of(text: &str) -> Self {
        Self { short: text.into(), long: text.into() }
    }
}

/// What stands behind the bar.
type Outlook = Arc<Mutex<String>>;

/// A bar on standard error.
pub struct Bar {
    bar: ProgressBar,
    outlook: Outlook,
    term: Term,
    /// Columns that it was made for.
    columns: usize,
    /// Whether it was drawn at all.
    is_drawn: bool,
}

impl Bar {
    /// A bar with this name.
    pub fn new(name: &str) -> Self {
        let term = Term::stderr();
        let columns = width(&term);
        let name = console::truncate_str(name, LONGEST_NAME, "..").into_owned();
        // Built up before it is drawn for the first time.
        let outlook = Arc::default();
        let bar = ProgressBar::new(STEPS).with_style(style(columns, &outlook)).with_prefix(name);
        Self { bar, outlook, term, columns, is_drawn: false }
    }

    /// No bar.
    pub fn hidden() -> Self {
        let (bar, outlook) = (ProgressBar::hidden(), Arc::default());
        Self { bar, outlook, term: Term::stderr(), columns: 0, is_drawn: false }
    }

    /// Draws it anew, `fraction` of it full.
    pub fn update(&mut self, fraction: f64, outlooks: Outlooks) {
        let columns = width(&self.term);
        if columns != self.columns {
            self.resize(columns);
        }
        let outlook = if columns < WIDTHS[1] { outlooks.short } else { outlooks.long };
        // Whatever changes the bar draws it: the outlook has to be the new one by then.
        *self.outlook.lock().unwrap_or_else(PoisonError::into_inner) = outlook;
        self.bar.update(|state| state.set_pos((fraction * STEPS as f64) as u64));
        self.is_drawn = true;
    }

    /// Prints lines above it.
    pub fn above(&self, print: impl FnOnce()) {
        self.bar.suspend(print);
    }

    /// Removes it.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// Fits it into `columns`. What was drawn in a wider terminal now goes over several rows, of which the bar takes
    /// only the last one away.
    fn resize(&mut self, columns: usize) {
        let rows_above = if self.is_drawn { self.columns.div_ceil(columns.max(1)).saturating_sub(1) } else { 0 };
        self.bar.suspend(|| {
            if rows_above > 0 {
                let _ = self.term.move_cursor_up(rows_above).and_then(|()| self.term.clear_to_end_of_screen());
            }
        });
        self.columns = columns;
        self.bar.set_style(style(columns, &self.outlook));
    }
}

/// Columns of the terminal; many where there is none.
fn width(term: &Term) -> usize {
    term.size_checked().map_or(WIDTHS[2], |(_, columns)| usize::from(columns))
}

/// The bar and whatever else has room in `columns`.
fn style(columns: usize, outlook: &Outlook) -> ProgressStyle {
    let template = match columns {
        columns if columns < WIDTHS[0] => "[{wide_bar}] {percent:>3} %",
        columns if columns < WIDTHS[2] => "[{wide_bar}] {percent:>3} %  {outlook}",
        _ => "{prefix} [{wide_bar}] {percent:>3} %  {outlook}",
    };
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    let outlook = Arc::clone(outlook);
    let write = move |_: &ProgressState, to: &mut dyn Write| {
        let _ = to.write_str(&outlook.lock().unwrap_or_else(PoisonError::into_inner));
    };
    style.with_key("outlook", write).progress_chars("=> ")
}
