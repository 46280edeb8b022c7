//! Columns along z, and the layers of triangles in each.

use core::ops::Range;

use glam::DVec3;

use super::facet::Facet;
use super::overlap::Block;

/// Columns per triangle: more would hold shorter layers, and more copies of each triangle.
const PER_TRIANGLE: f64 = 1.0;
/// Columns of the smallest surface, about.
const FEWEST: f64 = 1024.0;
/// Most columns along an axis.
const MOST: f64 = 2048.0;
/// How much larger triangles and boxes are taken to be, of the surface's extent: more than rounding of places and
/// edges.
const SLACK: f64 = 1.0 / (1 << 20) as f64;

/// A lattice of columns over the bounds of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns {
    /// Least x and y `[m]`.
    origin: [f32; 2],
    /// Columns per metre along x and y.
    density: [f32; 2],
    /// Columns along x and y.
    dims: [u32; 2],
    /// By how much triangles and boxes are made larger `[m]`.
    slack: f64,
    /// First layer of each column, x fastest, and the end of the last one's.
    starts: Vec<u32>,
    /// Layers of all columns, from the highest down.
    layers: Vec<Layer>,
    /// Triangles of all layers.
    members: Vec<u32>,
}

/// Triangles of a column between two heights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Height of the lowest corner `[m]`.
    pub low: f32,
    /// Height of the highest corner `[m]`.
    pub high: f32,
    /// Signed crossings above points under the layer.
    pub below: i32,
    /// First of its members; they end where those of the next layer begin.
    first: u32,
}

impl Columns {
    /// The columns of `facets` within `bounds`.
    ///
    /// # Panics
    /// If there are 2^32 facets or more, or as many of their copies.
    pub fn new(facets: &[Facet], bounds: [[f32; 3]; 2]) -> Self {
        let mut columns = Self::empty(facets.len(), bounds);
        let lists = columns.lists(facets, bounds);
        for (column, list) in lists.into_iter().enumerate() {
            columns.starts.push(count(columns.layers.len()));
            columns.add_layers(column, list, facets);
        }
        columns.starts.push(count(columns.layers.len()));
        columns.layers.push(Layer { low: 0.0, high: 0.0, below: 0, first: count(columns.members.len()) });
        columns
    }

    fn empty(facets: usize, [low, high]: [[f32; 3]; 2]) -> Self {
        let width = [0, 1].map(|axis| f64::from(high[axis]) - f64::from(low[axis]));
        // Not less than a few of the numbers that coordinates have there.
        let farthest = [low, high].as_flattened().iter().fold(0.0, |far: f32, x| far.max(x.abs()));
        let least = SLACK * f64::from(farthest);
        let side = (width[0] * width[1] / (PER_TRIANGLE * facets as f64 + FEWEST)).sqrt().max(least);
        let dims = width.map(|width| if side > 0.0 { (width / side).ceil().clamp(1.0, MOST) } else { 1.0 });
        let density = [0, 1].map(|axis| if width[axis] > 0.0 { (dims[axis] / width[axis]) as f32 } else { 0.0 });
        let extent = (0..3).map(|axis| f64::from(high[axis]) - f64::from(low[axis])).fold(0.0, f64::max);
        Self {
            origin: [low[0], low[1]],
            density,
            dims: dims.map(|dim| dim as u32),
            slack: SLACK * extent,
            starts: Vec::new(),
            layers: Vec::new(),
            members: Vec::new(),
        }
    }

    /// The triangles that touch each column.
    fn lists(&self, facets: &[Facet], bounds: [[f32; 3]; 2]) -> Vec<Vec<u32>> {
        let mut lists = vec![Vec::new(); self.dims.iter().map(|dim| *dim as usize).product()];
        for (index, facet) in facets.iter().enumerate() {
            let [xs, ys] = [0, 1].map(|axis| self.places(axis, facet.extent(axis)));
            let is_alone = xs.len() == 1 && ys.len() == 1;
            for (x, y) in ys.flat_map(|y| xs.clone().map(move |x| (x, y))) {
                if is_alone || self.block([x, y], bounds).touches(facet.triangle()) {
                    lists[self.index([x, y])].push(count(index));
                }
            }
        }
        lists
    }

    /// A column between the bounds.
    fn block(&self, column: [u32; 2], [low, high]: [[f32; 3]; 2]) -> Block {
        let edge = |axis: usize, place: u32| {
            let width = if self.density[axis] > 0.0 { 1.0 / f64::from(self.density[axis]) } else { 0.0 };
            f64::from(self.origin[axis]) + f64::from(place) * width
        };
        let corner =
            |further: u32, z: f32| DVec3::new(edge(0, column[0] + further), edge(1, column[1] + further), f64::from(z));
        Block::new([corner(0, low[2]), corner(1, high[2])], self.slack)
    }

    /// Adds the layers of the next column, which is touched by the triangles of `list`.
    fn add_layers(&mut self, column: usize, mut list: Vec<u32>, facets: &[Facet]) {
        let extent = |facet: u32| facets[facet as usize].extent(2);
        list.sort_by(|a, b| extent(*b)[1].total_cmp(&extent(*a)[1]));
        let mut below = 0;
        while let Some(first) = list.first() {
            let [mut low, high] = extent(*first);
            let end = list.iter().position(|facet| {
                let [bottom, top] = extent(*facet);
                let is_beyond = top < low;
                low = if is_beyond { low } else { low.min(bottom) };
                is_beyond
            });
            let rest = list.split_off(end.unwrap_or(list.len()));
            let under = self.middle(column, low);
            below += list.iter().map(|facet| facets[*facet as usize].crossings(under)).sum::<i32>();
            self.layers.push(Layer { low, high, below, first: count(self.members.len()) });
            self.members.append(&mut list);
            list = rest;
        }
    }

    /// A point in the middle of a column, below everything that is not under `low`.
    fn middle(&self, column: usize, low: f32) -> [f32; 3] {
        let place = [column as u32 % self.dims[0], column as u32 / self.dims[0]];
        let at = |axis: usize| match self.density[axis] {
            0.0 => self.origin[axis],
            density => self.origin[axis] + (place[axis] as f32 + 0.5) / density,
        };
        [at(0), at(1), low.next_down()]
    }

    /// The column of a point within the bounds.
    #[inline(always)]
    pub fn find(&self, at: [f32; 3]) -> usize {
        self.index([self.place(0, at[0]), self.place(1, at[1])])
    }

    /// The layers of a column, from the highest down, each with its triangles.
    #[inline(always)]
    pub fn layers(&self, column: usize) -> impl Iterator<Item = (&Layer, &[u32])> {
        let range = self.starts[column] as usize..self.starts[column + 1] as usize;
        range.map(|layer| {
            let [this, next] = [&self.layers[layer], &self.layers[layer + 1]];
            (this, &self.members[this.first as usize..next.first as usize])
        })
    }

    /// By how much triangles and boxes are made larger `[m]`.
    pub fn slack(&self) -> f64 {
        self.slack
    }

    /// Places along x or y of the columns that a range `[m]` touches.
    pub fn places(&self, axis: usize, [low, high]: [f32; 2]) -> Range<u32> {
        let slack = self.slack as f32;
        self.place(axis, low - slack)..self.place(axis, high + slack) + 1
    }

    /// Index of a column by its places.
    #[inline(always)]
    pub fn index(&self, [x, y]: [u32; 2]) -> usize {
        y as usize * self.dims[0] as usize + x as usize
    }

    /// Never falls where the coordinate rises, so that what is between two coordinates is between their columns.
    #[inline(always)]
    fn place(&self, axis: usize, coordinate: f32) -> u32 {
        (((coordinate - self.origin[axis]) * self.density[axis]) as u32).min(self.dims[axis] - 1)
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        let Self { starts, layers, members, .. } = self;
        size_of_val(starts.as_slice()) + size_of_val(layers.as_slice()) + size_of_val(members.as_slice())
    }
}

fn count(rows: usize) -> u32 {
    u32::try_from(rows).expect("fewer than 2^32 rows")
}
