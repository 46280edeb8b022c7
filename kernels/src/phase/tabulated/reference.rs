//! Tabulated phase functions in f64: linear between rows (c_i, f_i) [1/sr].
//!
//! ```text
//! u(c)  = 2 pi integral of f over -1 .. c
//! c(u)  = c_i + d (c_(i+1) - c_i),   d = m (f_i + f_(i+1)) / (f_i + sqrt((1 - m) f_i^2 + m f_(i+1)^2))
//! m     = (u - u_i) / (u_(i+1) - u_i)                                 of the interval with u_i <= u < u_(i+1)
//! <c>   = sum of (c_(i+1) - c_i) / 6 (c_i f_i + 4 c f + c_(i+1) f_(i+1)) 2 pi,   c, f in the middle
//! ```
//!
//! d is the root of the quadratic in [0, 1], in the form that does not cancel. Simpson's rule for the mean is exact.

use core::f64::consts::{PI, TAU};

use super::Tabulated;
use crate::phase::HenyeyGreenstein;
use crate::phase::reference::Phase;

/// Largest mean cosine, of either sign, for which a lobe stands in for the table.
const LARGEST_MEAN: f64 = 0.9999;

impl Tabulated {
    fn intervals(&self) -> impl Iterator<Item = [(f64, f64); 2]> {
        self.rows.windows(2).map(|pair| [pair[0], pair[1]])
    }
}

/// Share of all events between two rows.
fn share([(c0, f0), (c1, f1)]: [(f64, f64); 2]) -> f64 {
    PI * (f0 + f1) * (c1 - c0)
}

impl Phase for Tabulated {
    fn density(&self, cosine: f64) -> f64 {
        let cosine = cosine.clamp(-1.0, 1.0);
        let found = self.intervals().find(|[_, (end, _)]| cosine <= *end);
        let [(c0, f0), (c1, f1)] = found.expect("the last row is at 1");
        f0 + (f1 - f0) * (cosine - c0) / (c1 - c0)
    }

    fn sample_cosine(&self, u: f64) -> f64 {
        let mut below = 0.0;
        for interval in self.intervals() {
            let share = share(interval);
            if u < below + share {
                let [(c0, f0), (c1, f1)] = interval;
                let m = (u - below) / share;
                let root = ((1.0 - m) * f0 * f0 + m * f1 * f1).sqrt();
                let d = if m > 0.0 { m * (f0 + f1) / (f0 + root) } else { 0.0 };
                return c0 + d * (c1 - c0);
            }
            below += share;
        }
        // The shares' sum rounded to less than u.
        1.0
    }

    fn forward_share(&self) -> f64 {
        let from_zero = |[(c0, f0), (c1, f1)]: [(f64, f64); 2]| {
            let start = if c0 < 0.0 { (0.0, f0 - (f1 - f0) * c0 / (c1 - c0)) } else { (c0, f0) };
            share([start, (c1, f1)])
        };
        self.intervals().filter(|[_, (end, _)]| *end > 0.0).map(from_zero).sum()
    }

    fn mean_cosine(&self) -> f64 {
        let part =
            |[(c0, f0), (c1, f1)]: [(f64, f64); 2]| (c1 - c0) / 6.0 * (c0 * f0 + (c0 + c1) * (f0 + f1) + c1 * f1);
        TAU * self.intervals().map(part).sum::<f64>()
    }

    fn lobe(&self) -> HenyeyGreenstein {
        HenyeyGreenstein { g: self.mean_cosine().clamp(-LARGEST_MEAN, LARGEST_MEAN) as f32 }
    }
}
