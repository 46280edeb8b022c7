//! The weight of first flights, in f64.
//!
//! ```text
//! T' = T weight,      of the paths that have just left the camera and go on
//! ```

use super::Columns;
use crate::Step;

/// The twin; see [`Kernel`](super::Kernel).
pub fn run(_: Step, columns: Columns<'_, '_>) {
    let Columns { requested, live, weight, throughput } = columns;
    for lane in requested.each().filter(|lane| live.contains(*lane)) {
        let weight = f64::from(weight.rows()[lane]);
        for channel in throughput.channels_mut() {
            let throughput = &mut channel.rows_mut()[lane];
            *throughput = (f64::from(*throughput) * weight) as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::{Column, Spectrum};
    use crate::lanes::LaneSet;
    use bumpalo::Bump;

    /// The throughputs of two lanes that are neither requested nor live, of two that are requested, of two that are
    /// live, and of two that are both.
    fn after(channels: usize) -> [[f32; 3]; 8] {
        let arena = Bump::new();
        let [mut requested, mut live] = [(); 2].map(|()| LaneSet::new_in(&arena, 8));
        let mut weight = Column::new_in(&arena, 8);
        let mut throughput = Spectrum::new_in(&arena, 8, channels);
        for lane in 0..8 {
            throughput.set_row(lane, [1.0, 0.5, 0.25]);
            weight.rows_mut()[lane] = 1.25;
        }
        [2, 3, 6, 7].into_iter().for_each(|lane| requested.insert(lane));
        [4, 5, 6, 7].into_iter().for_each(|lane| live.insert(lane));
        // An aimed flight so long that free flights never are.
        weight.rows_mut()[7] = 0.0;
        let columns = Columns { requested: &requested, live: &live, weight: &weight, throughput: &mut throughput };
        run(Step { seed: 1, clock: 40 }, columns);
        core::array::from_fn(|lane| throughput.row(lane))
    }

    #[test]
    fn only_requested_paths_that_go_on_are_weighed() {
        let [others @ .., weighed, lost] = after(3);
        assert_eq!(others, [[1.0, 0.5, 0.25]; 6]);
        assert_eq!([weighed, lost], [[1.25, 0.625, 0.3125], [0.0; 3]]);
    }

    #[test]
    fn grey_paths_are_weighed_too() {
        assert_eq!(after(1)[5..], [[1.0; 3], [1.25; 3], [0.0; 3]]);
    }
}
