//! Mixtures in f64.
//!
//! ```text
//! phase(c)  = w a(c) + (1 - w) b(c)                                   [1/sr]
//! c(u)      = c_a(u / w) if u < w, else c_b((u - w) / (1 - w))
//! F         = w F_a + (1 - w) F_b,   <c> = w <c>_a + (1 - w) <c>_b
//! 2 pi p(psi) = w r_a + (1 - w) r_b                                   the roll of bridges about an axis
//! ```
//!
//! In the forward hemisphere, `w F_a / F` takes the place of w.

use super::Mixture;
use crate::phase::reference::Phase;

impl<A: Phase, B: Phase> Mixture<A, B> {
    /// Shares of the first and of the second.
    fn shares(&self) -> (f64, f64) {
        let weight = f64::from(self.weight);
        (weight, 1.0 - weight)
    }
}

impl<A: Phase, B: Phase> Phase for Mixture<A, B> {
    fn density(&self, cosine: f64) -> f64 {
        let (a, b) = self.shares();
        a * self.first.density(cosine) + b * self.second.density(cosine)
    }

    fn sample_cosine(&self, u: f64) -> f64 {
        let (a, b) = self.shares();
        if u < a { self.first.sample_cosine(u / a) } else { self.second.sample_cosine((u - a) / b) }
    }

    fn forward_share(&self) -> f64 {
        let (a, b) = self.shares();
        a * self.first.forward_share() + b * self.second.forward_share()
    }

    fn sample_forward_cosine(&self, u: f64) -> f64 {
        let a = self.shares().0 * self.first.forward_share() / self.forward_share();
        if u < a {
            self.first.sample_forward_cosine(u / a)
        } else {
            self.second.sample_forward_cosine((u - a) / (1.0 - a))
        }
    }

    fn mean_cosine(&self) -> f64 {
        let (a, b) = self.shares();
        a * self.first.mean_cosine() + b * self.second.mean_cosine()
    }

    fn roll_lobes(&self) -> Vec<(f64, f64)> {
        let (a, b) = self.shares();
        let of = |share: f64, lobes: Vec<(f64, f64)>| lobes.into_iter().map(move |(part, g)| (share * part, g));
        of(a, self.first.roll_lobes()).chain(of(b, self.second.roll_lobes())).collect()
    }
}
