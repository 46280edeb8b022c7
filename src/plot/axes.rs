//! Axes of plots.

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;

/// The values that an axis shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Left or lower end.
    pub low: f64,
    /// Right or upper end.
    pub high: f64,
}

impl Range {
    /// From the least to the largest of `values` that are finite; 0 to 1 if there are none, and never empty.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let finite = values.into_iter().filter(|value| value.is_finite());
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (f64::min(low, value), f64::max(high, value))
        });
        match (low, high) {
            (low, high) if low < high => Self { low, high },
            (low, _) if low.is_finite() => {
                Self { low: low - 0.5 * low.abs().max(1.0), high: low + 0.5 * low.abs().max(1.0) }
            }
            _ => Self { low: 0.0, high: 1.0 },
        }
    }

    /// Wider by a `share` of itself at both ends.
    pub fn widened(self, share: f64) -> Self {
        let margin = share * (self.high - self.low);
        Self { low: self.low - margin, high: self.high + margin }
    }

    /// The same from 0 on.
    pub fn from_zero(self) -> Self {
        Self { low: self.low.min(0.0), ..self }
    }

    /// Its length.
    pub fn length(self) -> f64 {
        self.high - self.low
    }
}

/// An axis of a plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What it shows, with its unit.
    pub title: String,
    /// Whether its values are shown by their logarithms; they are then > 0.
    pub is_logarithmic: bool,
}

impl Axis {
    /// A linear axis.
    pub fn linear(title: impl Into<String>) -> Self {
        Self { title: title.into(), is_logarithmic: false }
    }

    /// A logarithmic axis.
    pub fn logarithmic(title: impl Into<String>) -> Self {
        Self { title: title.into(), is_logarithmic: true }
    }

    /// What it shows of `values`, never empty.
    pub fn range(&self, values: impl IntoIterator<Item = f64>) -> Range {
        if !self.is_logarithmic {
            return Range::of(values);
        }
        let logs = Range::of(values.into_iter().map(f64::ln));
        Range { low: logs.low.exp(), high: logs.high.exp() }
    }

    /// Whether it can show a value.
    pub fn shows(&self, value: f64) -> bool {
        value.is_finite() && (!self.is_logarithmic || value > 0.0)
    }

    /// The values of `range` as the plotting library asks for them.
    pub(super) fn coordinate(&self, range: Range) -> Coordinate {
        Coordinate { range, is_logarithmic: self.is_logarithmic }
    }

    /// Wider than `range` by a share of what it looks like.
    pub fn widened(&self, range: Range, share: f64) -> Range {
        if !self.is_logarithmic {
            return range.widened(share);
        }
        let wide = Range { low: range.low.ln(), high: range.high.ln() }.widened(share);
        Range { low: wide.low.exp(), high: wide.high.exp() }
    }

    /// The label of a value.
    pub fn label(&self, value: f64) -> String {
        // What is left of rounding is no label.
        let value = if value.abs() < 1e-12 && !self.is_logarithmic { 0.0 } else { value };
        if value != 0.0 && !(1e-3..1e5).contains(&value.abs()) {
            return format!("{value:.0e}");
        }
        let text = format!("{value:.4}");
        text.trim_end_matches('0').trim_end_matches('.').to_string()
    }
}

/// An axis as the plotting library asks for it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Coordinate {
    range: Range,
    is_logarithmic: bool,
}

impl Coordinate {
    /// 1, 2 and 5 times powers of ten, or powers alone if that were more than `most`.
    fn decades(&self, most: usize) -> Vec<f64> {
        let Range { low, high } = self.range;
        let powers = low.log10().floor() as i32..=high.log10().ceil() as i32;
        let values = |digits: &[f64], step: usize| -> Vec<f64> {
            let all =
                powers.clone().step_by(step).flat_map(|power| digits.iter().map(move |d| d * 10.0_f64.powi(power)));
            all.filter(|value| (low..=high).contains(value)).collect()
        };
        let choices = [values(&[1.0, 2.0, 5.0], 1), values(&[1.0], 1), values(&[1.0], 2), values(&[1.0], 4)];
        choices.iter().find(|values| values.len() <= most.max(2)).unwrap_or(&choices[3]).clone()
    }
}

impl Ranged for Coordinate {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (first, last): (i32, i32)) -> i32 {
        let place = |value: f64| if self.is_logarithmic { value.ln() } else { value };
        let (low, high) = (place(self.range.low), place(self.range.high));
        let share = (place(*value) - low) / (high - low);
        first + (share * f64::from(last - first)).round() as i32
    }

    fn key_points<H: KeyPointHint>(&self, hint: H) -> Vec<f64> {
        let most = hint.max_num_points();
        if self.is_logarithmic { self.decades(most) } else { RangedCoordf64::from(self.range()).key_points(most) }
    }

    fn range(&self) -> core::ops::Range<f64> {
        self.range.low..self.range.high
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_never_empty() {
        assert_eq!(Range::of([2.0, f64::NAN, -1.0]), Range { low: -1.0, high: 2.0 });
        assert_eq!(Range::of([]), Range { low: 0.0, high: 1.0 });
        for value in [0.0, 7.0, -3e9] {
            let range = Range::of([value; 3]);
            assert!(range.low < value && value < range.high, "{range:?}");
        }
        assert_eq!(Range { low: 2.0, high: 4.0 }.from_zero().widened(0.25), Range { low: -1.0, high: 5.0 });
    }

    #[test]
    fn labels_are_short() {
        let axis = Axis::linear("m");
        assert_eq!([0.3, -2.0, 1e-15, 12.5].map(|value| axis.label(value)), ["0.3", "-2", "0", "12.5"]);
        assert_eq!([1e-6, 0.1, 1.0, 1000.0, 1e7].map(|value| axis.label(value)), ["1e-6", "0.1", "1", "1000", "1e7"]);
    }

    #[test]
    fn logarithmic_axes_are_marked_at_round_numbers() {
        let marks = |low, high, most| Axis::logarithmic("s").coordinate(Range { low, high }).decades(most);
        assert_eq!(marks(0.4, 12.0, 8), [0.5, 1.0, 2.0, 5.0, 10.0]);
        assert_eq!(marks(3e-3, 2e3, 8), [0.01, 0.1, 1.0, 10.0, 100.0, 1000.0]);
        let coordinate = Axis::logarithmic("s").coordinate(Range { low: 1.0, high: 100.0 });
        assert_eq!([1.0, 10.0, 100.0].map(|value| coordinate.map(&value, (0, 200))), [0, 100, 200]);
    }
}
