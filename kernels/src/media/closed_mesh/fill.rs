//! Boxes that are all inside, or all outside.

use glam::DVec3;

use super::ClosedMesh;
use super::overlap::Block;

/// How much of a box is inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fill {
    /// All of it.
    Inside,
    /// Nothing.
    Outside,
    /// The surface touches it, or almost.
    Part,
}

impl ClosedMesh {
    /// How much of the box from corner `low` to corner `high` `[m]` is inside. A box that no triangle touches is as any
    /// of its points is.
    pub fn fills(&self, low: [f32; 3], high: [f32; 3]) -> Fill {
        let [least, most] = self.bounds;
        let slack = self.columns.slack() as f32;
        if (0..3).any(|axis| high[axis] < least[axis] - slack || low[axis] > most[axis] + slack) {
            return Fill::Outside;
        }
        // What is beyond the bounds touches nothing.
        let low = [0, 1, 2].map(|axis| low[axis].max(least[axis] - 2.0 * slack));
        let high = [0, 1, 2].map(|axis| high[axis].min(most[axis] + 2.0 * slack));
        if self.touches([low, high].map(|corner| self.view.place(corner))) {
            return Fill::Part;
        }
        let middle = [0, 1, 2].map(|axis| low[axis] + 0.5 * (high[axis] - low[axis]));
        let within = (0..3).all(|axis| (least[axis]..=most[axis]).contains(&middle[axis]));
        if within && self.winds_around(middle) { Fill::Inside } else { Fill::Outside }
    }

    /// Whether a triangle touches a box of the view.
    fn touches(&self, [low, high]: [[f32; 3]; 2]) -> bool {
        let slack = self.columns.slack();
        let block = Block::new([low, high].map(|corner| DVec3::from(corner.map(f64::from))), slack);
        let [xs, ys] = [0, 1].map(|axis| self.columns.places(axis, [low[axis], high[axis]]));
        let mut columns = ys.flat_map(|y| xs.clone().map(move |x| [x, y]));
        let [bottom, top] = [low[2] - slack as f32, high[2] + slack as f32];
        columns.any(|column| {
            let layers = self.columns.layers(self.columns.index(column));
            let mut layers =
                layers.skip_while(|(layer, _)| layer.low > top).take_while(|(layer, _)| layer.high >= bottom);
            layers
                .any(|(_, members)| members.iter().any(|facet| block.touches(self.facets[*facet as usize].triangle())))
        })
    }
}
