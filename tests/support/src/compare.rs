//! Tables saved as plain data, put back, and compared row by row, with evidence.

use std::collections::BTreeMap;
use std::fmt::Write;

use fogbow_kernels::accumulate::Dropped;
use fogbow_kernels::columns::parts::PartTable;
use fogbow_kernels::columns::paths::{
    FeatureColumns, ImmersionColumns, LastSurfaceColumns, OutlookColumns, PassageColumns, PathColumns, RayColumns,
    RayTable, VertexColumns, VertexTable,
};
use fogbow_kernels::columns::queues::{
    CandidateQueue, ChainTable, EndQueue, FlightTable, HitQueue, SurfaceHitQueue, WorthTable,
};
use fogbow_kernels::columns::trail::TrailTable;
use fogbow_kernels::columns::{Column, ColumnMut, ColumnRef, ColumnSet, Spectrum};
use fogbow_kernels::connect::nee::in_place::Tally;
use fogbow_kernels::lanes::LaneSet;

use crate::tolerances::{EXACT, Tolerance};

/// The columns of one table: names and bits.
type SavedColumns = Vec<(&'static str, bool, Vec<u32>)>;

/// Everything that a table holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Saved {
    /// One entry per slot of a ring or vertex of a chain; one for other tables.
    tables: Vec<SavedColumns>,
    /// Batches of a set of lanes.
    set: Vec<u32>,
    /// Rows of a queue.
    pub len: usize,
}

/// A quantity of a row: a number, a vector of three, or an index.
#[derive(Clone, Debug, PartialEq)]
pub enum Quantity {
    /// One or three real numbers.
    Real(Vec<f32>),
    /// An index, counter or bits.
    Index(u32),
}

/// One row, by field name.
pub type Row = BTreeMap<&'static str, Quantity>;

impl Saved {
    fn new(tables: Vec<SavedColumns>) -> Self {
        Self { tables, set: Vec::new(), len: 0 }
    }

    /// Row `row` of table `table`.
    pub fn row(&self, table: usize, row: usize) -> Row {
        let mut found = Row::new();
        for (name, real, bits) in &self.tables[table] {
            if !real {
                found.insert(name, Quantity::Index(bits[row]));
                continue;
            }
            match found.entry(name).or_insert_with(|| Quantity::Real(Vec::new())) {
                Quantity::Real(reals) => reals.push(f32::from_bits(bits[row])),
                Quantity::Index(_) => unreachable!("{name} is both real and index"),
            }
        }
        found
    }

    /// Number of tables: slots of a ring, vertices of a chain.
    pub fn tables(&self) -> usize {
        self.tables.len()
    }

    /// The same with row `order[i]` in row `i`, sets included.
    pub fn permuted(&self, order: &[usize]) -> Self {
        let mut permuted = self.clone();
        for (to, from) in permuted.tables.iter_mut().flatten().zip(self.tables.iter().flatten()) {
            order.iter().enumerate().for_each(|(i, row)| to.2[i] = from.2[*row]);
        }
        if !self.set.is_empty() {
            permuted.set.fill(0);
            let members = order.iter().enumerate().filter(|(_, row)| self.contains(**row));
            members.for_each(|(i, _)| permuted.set[i / 8] |= 1 << (i % 8));
        }
        permuted
    }

    /// The same with NaN in the real columns of the rows that are `dead`, and senseless words in the others.
    pub fn poisoned(&self, dead: impl Fn(usize) -> bool) -> Self {
        let mut poisoned = self.clone();
        for (_, real, bits) in poisoned.tables.iter_mut().flatten() {
            let poison = if *real { f32::NAN.to_bits() } else { 0xdead_beef };
            bits.iter_mut().enumerate().filter(|(row, _)| dead(*row)).for_each(|(_, bits)| *bits = poison);
        }
        poisoned
    }

    /// Makes every row of a column zero: it does not count.
    pub fn forget(&mut self, name: &str) {
        self.tables.iter_mut().flatten().filter(|column| column.0 == name).for_each(|column| column.2.fill(0));
    }

    /// The rows in use of an index column.
    pub fn indices(&self, name: &str) -> &[u32] {
        let column = self.tables[0].iter().find(|column| column.0 == name);
        &column.unwrap_or_else(|| panic!("no column {name}")).2[..self.len]
    }

    /// Whether there is a column of this name.
    pub fn has(&self, name: &str) -> bool {
        self.tables[0].iter().any(|column| column.0 == name)
    }

    /// The first component of a real column.
    pub fn reals(&self, name: &str) -> Vec<f32> {
        let column = self.tables[0].iter().find(|column| column.0 == name);
        let column = column.unwrap_or_else(|| panic!("no column {name}"));
        column.2.iter().map(|bits| f32::from_bits(*bits)).collect()
    }

    /// All components of a real column in `row`.
    pub fn vector(&self, name: &str, row: usize) -> Vec<f32> {
        let columns = self.tables[0].iter().filter(|column| column.0 == name);
        columns.map(|column| f32::from_bits(column.2[row])).collect()
    }

    /// Whether `lane` is in the set.
    pub fn contains(&self, lane: usize) -> bool {
        self.set[lane / 8] >> (lane % 8) & 1 == 1
    }

    /// The first lane that is in only one of two sets.
    pub fn first_difference(&self, other: &Self) -> Option<usize> {
        (0..8 * self.set.len()).find(|lane| self.contains(*lane) != other.contains(*lane))
    }
}

/// What can be saved and put back.
pub trait Save {
    /// Everything that it holds.
    fn save(&self) -> Saved;
    /// Puts back what was saved.
    fn restore(&mut self, saved: &Saved);
}

fn save_columns(table: &dyn ColumnSet) -> SavedColumns {
    let mut columns = Vec::new();
    table.visit(&mut |name, column| {
        columns.push(match column {
            ColumnRef::F32(values) => (name, true, values.iter().map(|value| value.to_bits()).collect()),
            ColumnRef::U32(values) => (name, false, values.to_vec()),
        });
    });
    columns
}

fn restore_columns(table: &mut dyn ColumnSet, saved: &SavedColumns) {
    let mut columns = saved.iter();
    table.visit_mut(&mut |_, column| {
        let (_, _, bits) = columns.next().expect("a table has the columns that were saved");
        match column {
            ColumnMut::F32(to) => to.iter_mut().zip(bits).for_each(|(to, bits)| *to = f32::from_bits(*bits)),
            ColumnMut::U32(to) => to.copy_from_slice(bits),
        }
    });
}

macro_rules! save_table {
    ($($table:ty),*) => {$(
        impl Save for $table {
            fn save(&self) -> Saved {
                Saved::new(vec![save_columns(self)])
            }

            fn restore(&mut self, saved: &Saved) {
                restore_columns(self, &saved.tables[0]);
            }
        }
    )*};
}

save_table!(
    PathColumns<'_>,
    ImmersionColumns<'_>,
    LastSurfaceColumns<'_>,
    OutlookColumns<'_>,
    VertexColumns<'_>,
    RayColumns<'_>,
    FlightTable<'_>,
    WorthTable<'_>,
    FeatureColumns<'_>,
    PartTable<'_>,
    Spectrum<'_>
);

impl Save for [PassageColumns<'_>] {
    fn save(&self) -> Saved {
        Saved::new(self.iter().map(|table| save_columns(table)).collect())
    }

    fn restore(&mut self, saved: &Saved) {
        self.iter_mut().zip(&saved.tables).for_each(|(table, saved)| restore_columns(table, saved));
    }
}

macro_rules! save_queue {
    ($queue:ty) => {
        impl Save for $queue {
            fn save(&self) -> Saved {
                Saved { len: self.len, ..Saved::new(vec![save_columns(self)]) }
            }

            fn restore(&mut self, saved: &Saved) {
                restore_columns(self, &saved.tables[0]);
                self.len = saved.len;
            }
        }
    };
}

save_queue!(HitQueue<'_>);
save_queue!(SurfaceHitQueue<'_>);
save_queue!(CandidateQueue<'_>);
save_queue!(EndQueue<'_>);

impl Save for LaneSet<'_> {
    fn save(&self) -> Saved {
        let set = (0..self.batches()).map(|b| self.batch(b)).collect();
        Saved { set, ..Saved::new(Vec::new()) }
    }

    fn restore(&mut self, saved: &Saved) {
        self.clear();
        saved.set.iter().enumerate().for_each(|(b, bits)| self.insert_batch(b, *bits));
    }
}

macro_rules! save_ring {
    ($ring:ty) => {
        impl Save for $ring {
            fn save(&self) -> Saved {
                Saved::new((0..self.slots() as u32).map(|slot| save_columns(self.at(slot))).collect())
            }

            fn restore(&mut self, saved: &Saved) {
                (0..).zip(&saved.tables).for_each(|(slot, table)| restore_columns(self.at_mut(slot), table));
            }
        }
    };
}

save_ring!(VertexTable<'_>);
save_ring!(RayTable<'_>);

impl Save for Column<'_, f32> {
    fn save(&self) -> Saved {
        Saved::new(vec![vec![("values", true, self.rows().iter().map(|value| value.to_bits()).collect())]])
    }

    fn restore(&mut self, saved: &Saved) {
        let bits = &saved.tables[0][0].2;
        self.rows_mut().iter_mut().zip(bits).for_each(|(to, bits)| *to = f32::from_bits(*bits));
    }
}

impl Save for Column<'_, u32> {
    fn save(&self) -> Saved {
        Saved::new(vec![vec![("values", false, self.rows().to_vec())]])
    }

    fn restore(&mut self, saved: &Saved) {
        self.rows_mut().copy_from_slice(&saved.tables[0][0].2);
    }
}

/// One table per slot.
impl Save for TrailTable<'_> {
    fn save(&self) -> Saved {
        let slot = |clock: u32| {
            let numbers: Vec<[f32; 8]> = (0..self.lanes()).map(|lane| self.numbers(lane, clock)).collect();
            (0..8).map(|i| ("trail", true, numbers.iter().map(|row| row[i].to_bits()).collect())).collect()
        };
        Saved::new((0..self.slots() as u32).map(slot).collect())
    }

    fn restore(&mut self, saved: &Saved) {
        for (clock, columns) in (0..).zip(&saved.tables) {
            for lane in 0..self.lanes() {
                let numbers = core::array::from_fn(|i| f32::from_bits(columns[i].2[lane]));
                self.set_numbers(lane, clock, numbers);
            }
        }
    }
}

/// One table per vertex, and behind them one of the resampling weights.
impl Save for ChainTable<'_> {
    fn save(&self) -> Saved {
        let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        let vertex = |vertex: &fogbow_kernels::columns::Column3<'_>| {
            vertex.channels().map(|channel| ("vertex", true, bits(channel.rows()))).to_vec()
        };
        let resampling = vec![("resampling", true, bits(self.resampling.rows()))];
        Saved::new(self.vertices.iter().map(vertex).chain([resampling]).collect())
    }

    fn restore(&mut self, saved: &Saved) {
        let channels = self.vertices.iter_mut().flat_map(|vertex| vertex.channels_mut()).chain([&mut self.resampling]);
        for (column, (_, _, bits)) in channels.zip(saved.tables.iter().flatten()) {
            column.rows_mut().iter_mut().zip(bits).for_each(|(to, bits)| *to = f32::from_bits(*bits));
        }
    }
}

impl Save for Dropped {
    fn save(&self) -> Saved {
        let (pixel, sample) = self.first.unwrap_or((u32::MAX, u32::MAX));
        let column = vec![pixel, sample, self.count as u32, u32::from(self.first.is_some())];
        Saved::new(vec![vec![("dropped", false, column)]])
    }

    fn restore(&mut self, saved: &Saved) {
        let column = &saved.tables[0][0].2;
        *self = Self { count: u64::from(column[2]), first: (column[3] == 1).then_some((column[0], column[1])) };
    }
}

impl Save for Tally {
    fn save(&self) -> Saved {
        let column = [self.tried, self.weighted, self.kept].map(|count| u32::try_from(count).expect("few connections"));
        Saved { len: column.len(), ..Saved::new(vec![vec![("tally", false, column.to_vec())]]) }
    }

    fn restore(&mut self, saved: &Saved) {
        let count = |i: usize| u64::from(saved.tables[0][0].2[i]);
        *self = Self { tried: count(0), weighted: count(1), kept: count(2) };
    }
}

impl Quantity {
    fn is_close(&self, other: &Self, tolerance: Tolerance) -> bool {
        let (Self::Real(a), Self::Real(b)) = (self, other) else { return self == other };
        if a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits()) {
            return true;
        }
        let length = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>().sqrt();
        let size = |values: &[f32]| length(&mut values.iter().map(|x| f64::from(*x)));
        let distance = length(&mut a.iter().zip(b).map(|(a, b)| f64::from(*a) - f64::from(*b)));
        distance <= tolerance.absolute + tolerance.relative * size(a).max(size(b))
    }
}

/// What two rows have that is further apart than `tolerances` allow, if anything. Columns without a tolerance must be
/// equal.
pub fn difference(kernel: &Row, twin: &Row, tolerances: &[(&str, Tolerance)]) -> Option<String> {
    let tolerance = |name: &str| tolerances.iter().find(|(field, _)| *field == name).map_or(EXACT, |(_, t)| *t);
    let is_close = |name: &str| kernel[name].is_close(&twin[name], tolerance(name));
    if kernel.keys().all(|name| is_close(name)) {
        return None;
    }
    let mut text = String::new();
    for name in kernel.keys() {
        let mark = if is_close(name) { "" } else { "<-- apart" };
        let _ = writeln!(text, "    {name:16} kernel {:?}  twin {:?} {mark}", kernel[name], twin[name]);
    }
    Some(text)
}
