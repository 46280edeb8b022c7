//! A choice in constant time: Walker's alias table, filled by Vose's method (Vose, A Linear Algorithm for Generating
//! Random Numbers with a Given Distribution, 1991).

/// A table over the entries `0 .. n`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AliasTable {
    slots: Vec<Slot>,
}

/// One of n equally likely slots.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Slot {
    /// Share of the slot that its own entry keeps, in 2^-32.
    own: u32,
    /// Entry that has the rest.
    other: u32,
}

impl AliasTable {
    /// A table that chooses entries in proportion to `weights`, finite, >= 0, one of them above 0.
    pub fn new(weights: &[f64]) -> Self {
        let scale = weights.len() as f64 / weights.iter().sum::<f64>();
        let mut shares: Vec<f64> = weights.iter().map(|weight| weight * scale).collect();
        let mut slots: Vec<Slot> = (0..weights.len()).map(|i| Slot { own: u32::MAX, other: i as u32 }).collect();
        let (mut small, mut large): (Vec<_>, Vec<_>) = (0..weights.len()).partition(|i| shares[*i] < 1.0);
        while let (Some(poor), Some(rich)) = (small.pop(), large.last().copied()) {
            slots[poor] = Slot { own: (shares[poor] * 2.0_f64.powi(32)) as u32, other: rich as u32 };
            shares[rich] -= 1.0 - shares[poor];
            if shares[rich] < 1.0 {
                large.pop();
                small.push(rich);
            }
        }
        Self { slots }
    }

    /// Bytes per entry.
    pub const BYTES: usize = size_of::<Slot>();

    /// The entry for two random words: one for the slot, which is all that is left to chance where entries are many,
    /// and one for what is in it.
    #[inline]
    pub fn choose_with(&self, index: u32, share: u32) -> u32 {
        let index = ((u64::from(index) * self.slots.len() as u64) >> 32) as u32;
        let slot = self.slots[index as usize];
        if share < slot.own { index } else { slot.other }
    }

    /// The entry for a random word.
    #[inline]
    pub fn choose(&self, word: u32) -> u32 {
        let scaled = u64::from(word) * self.slots.len() as u64;
        let (index, rest) = ((scaled >> 32) as u32, scaled as u32);
        let slot = self.slots[index as usize];
        if rest < slot.own { index } else { slot.other }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_chosen_in_proportion_to_their_weights() {
        for weights in [vec![1.0], vec![0.0, 3.0], vec![1.0, 2.0, 0.0, 5.0, 0.5], vec![7.0; 9]] {
            let table = AliasTable::new(&weights);
            let mut counts = vec![0.0; weights.len()];
            let draws = 1 << 20;
            (0..draws).for_each(|i| counts[table.choose((i << 12) + 77) as usize] += 1.0);
            let sum: f64 = weights.iter().sum();
            for (count, weight) in counts.iter().zip(&weights) {
                let expected = f64::from(draws) * weight / sum;
                // Evenly spaced words miss the share of a slot by less than one word each.
                assert!((count - expected).abs() <= 2.0 * weights.len() as f64, "{counts:?} for {weights:?}");
            }
        }
    }
}
