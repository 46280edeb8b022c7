//! What light there is beyond the longest paths that were seen.

/// Greatest factor by which the next doubling of the length brings less: that of a power -3/2 of the length.
pub const SLOWEST: f64 = core::f64::consts::FRAC_1_SQRT_2;

/// What becomes of light that wanders on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// There is no end to what it wanders through: it may fall with a power of the length.
    Stays,
    /// It leaves what has bounds: in the end it falls exponentially.
    Leaves,
}

/// Light beyond what was seen: of the last doubling of the length, and of those behind it, each over the one before,
///
/// ```text
/// B,   r_k = y_k (1 + y_k),   y_(k+1) = y_k^c
/// ```
///
/// Light that falls exponentially has c = 2: with y = exp(-a n), that of lengths from n to 2 n is y - y^2, that of the next
/// doubling y^2 - y^4. A power of the length has c = 1, the same ratio from doubling to doubling.
#[derive(Clone, Copy)]
pub struct Tail {
    /// B.
    last: f64,
    /// y_0, of the last doubling over the one before.
    fall: f64,
    /// c.
    curve: f64,
}

/// Doublings that are added up.
const DOUBLINGS: usize = 128;

impl Tail {
    /// That of light of which the last three doublings are known. Power laws go by the square of a ratio, that of the last
    /// doubling over the last but two, as one of neighbours is noisier.
    pub fn of([early, middle, last]: [f64; 3], fate: Fate) -> Self {
        let ratio = |before: f64, after: f64| if before > 0.0 { after / before } else { 1.0 };
        let fall = |ratio: f64| 0.5 * ((1.0 + 4.0 * ratio).sqrt() - 1.0);
        match fate {
            Fate::Stays => Self { last, fall: fall(ratio(early, last).sqrt().min(SLOWEST)), curve: 1.0 },
            Fate::Leaves => {
                let (before, now) = (fall(ratio(early, middle)), fall(ratio(middle, last).min(SLOWEST)));
                let curve = if before < 1.0 { (now.ln() / before.ln()).clamp(1.0, 2.0) } else { 2.0 };
                Self { last, fall: now, curve }
            }
        }
    }

    /// Light beyond so many times the length that was seen, at least 1: in between powers of two as powers of the length
    /// and exponentials are.
    pub fn beyond(&self, times: f64) -> f64 {
        let doublings = times.log2().floor();
        let further = times.log2() - doublings;
        let part = match self.curve {
            1.0 => further,
            c => (c.powf(further) - 1.0) / (c - 1.0),
        };
        let [before, after] = [doublings, doublings + 1.0].map(|skipped| self.after(skipped as usize));
        if after > 0.0 { before * (after / before).powf(part) } else { before * (1.0 - part) }
    }

    /// Light beyond so many more doublings.
    pub fn after(&self, skipped: usize) -> f64 {
        if let 1.0 = self.curve {
            // A geometric series.
            let ratio = self.fall * (1.0 + self.fall);
            return self.last * ratio.powf(skipped as f64 + 1.0) / (1.0 - ratio);
        }
        let falls = core::iter::successors(Some(self.fall), |fall| Some(fall.powf(self.curve))).skip(1);
        let amounts = falls.scan(self.last, |amount, fall| {
            *amount *= fall * (1.0 + fall);
            Some(*amount)
        });
        amounts.skip(skipped).take(DOUBLINGS).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The series by itself is what its terms add up to, from whichever doubling on.
    #[test]
    fn a_power_law_is_a_geometric_series() {
        for amounts in [[1.0, 0.5, 0.25], [1.0, 0.9, 0.8], [8.0, 0.1, 1e-3], [1.0, 0.0, 0.0]] {
            let tail = Tail::of(amounts, Fate::Stays);
            let ratio = tail.fall * (1.0 + tail.fall);
            let terms: Vec<f64> = (1..200).map(|k| amounts[2] * ratio.powi(k)).collect();
            for skipped in [0, 1, 7, 100] {
                let (found, sum) = (tail.after(skipped), terms[skipped..].iter().sum::<f64>());
                assert!((found - sum).abs() <= 1e-12 * sum, "{found} of {sum}, {amounts:?}, without {skipped}");
            }
        }
    }

    /// Of a few bright samples the last doubling may have much more than those before, or all.
    #[test]
    fn no_luck_makes_a_tail_grow() {
        let amounts = [0.0, 1e-6, 0.1, 1.0, 100.0];
        let triples = amounts.iter().flat_map(|a| amounts.iter().flat_map(|b| amounts.map(|c| [*a, *b, c])));
        for [early, middle, last] in triples {
            for fate in [Fate::Stays, Fate::Leaves] {
                let tail = Tail::of([early, middle, last], fate).after(0);
                let most = last * SLOWEST / (1.0 - SLOWEST);
                assert!((0.0..=most * (1.0 + 1e-9)).contains(&tail), "{tail} of {early}, {middle}, {last}, {fate:?}");
            }
        }
    }
}
