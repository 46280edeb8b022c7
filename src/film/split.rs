//! Parts of a sample that add up to it exactly.
//!
//! The radiance of a path is the f32 sum of what it found, and so is each part, every sum rounded for itself. In units
//! of the film the parts are therefore a little off the whole. The largest part makes up for that: it gets what the
//! others leave of the whole. So the exact sums of the parts are that of the radiance, to the bit, for any number of
//! samples.

use super::sums::Sums;

/// Adds a sample whose radiance has these `values` to the `parts` of a split of the pixel at `place`, whose own values
/// are in `shares`. All are layers of one unit and as many channels.
pub fn add(parts: &mut [Sums], place: usize, values: &[f32], shares: &[impl AsRef<[f32]>]) {
    let Some(layer) = parts.first().map(Sums::layer) else { return };
    let (channels, unit) = (layer.channels, layer.unit);
    for (channel, whole) in values.iter().enumerate().take(channels) {
        let mut left = unit.units(*whole);
        if left == 0 {
            continue;
        }
        let value = |part: usize| shares[part].as_ref()[channel];
        let largest = (0..parts.len()).max_by(|a, b| value(*a).total_cmp(&value(*b))).expect("at least one part");
        for part in (0..parts.len()).filter(|part| *part != largest) {
            let units = unit.units(value(part)).min(left);
            left -= units;
            if units > 0 {
                parts[part].add_units(place, channel, units);
            }
        }
        parts[largest].add_units(place, channel, left);
    }
}
