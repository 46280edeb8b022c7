//! Values over time (glTF 2.0, appendix C).

use glam::{DQuat, DVec4};

/// What is between keyframes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// The value of the keyframe before.
    Step,
    /// Straight lines; arcs for rotations.
    Linear,
    /// Cubic Hermite splines: every keyframe has an arriving tangent, a value and a leaving tangent.
    CubicSpline,
}

impl Interpolation {
    pub fn values_per_keyframe(self) -> usize {
        if self == Self::CubicSpline { 3 } else { 1 }
    }
}

/// A curve with one keyframe or more.
#[derive(Clone, Debug)]
pub struct Curve<const N: usize> {
    /// Times of the keyframes, which increase `[s]`.
    pub times: Vec<f64>,
    /// [`Interpolation::values_per_keyframe`] for each of them.
    pub values: Vec<[f64; N]>,
    pub interpolation: Interpolation,
}

/// A time among keyframes: at the one with this index, or so far on the way to the next.
#[derive(Clone, Copy, Debug)]
struct Between {
    index: usize,
    /// Share of the way, in [0, 1).
    share: f64,
    /// Time from this keyframe to the next `[s]`.
    length: f64,
}

impl<const N: usize> Curve<N> {
    /// The value at `time`; that of the first keyframe before it, and of the last one after it.
    pub fn at(&self, time: f64) -> [f64; N] {
        let Between { index, share, length } = self.between(time);
        let value = |index| self.value(index);
        match self.interpolation {
            _ if share == 0.0 => value(index),
            Interpolation::Step => value(index),
            Interpolation::Linear => weighted([(1.0 - share, value(index)), (share, value(index + 1))]),
            Interpolation::CubicSpline => {
                let (t, t2, t3) = (share, share * share, share * share * share);
                weighted([
                    (2.0 * t3 - 3.0 * t2 + 1.0, value(index)),
                    (length * (t3 - 2.0 * t2 + t), self.values[3 * index + 2]),
                    (3.0 * t2 - 2.0 * t3, value(index + 1)),
                    (length * (t3 - t2), self.values[3 * (index + 1)]),
                ])
            }
        }
    }

    fn between(&self, time: f64) -> Between {
        let after = self.times.partition_point(|keyframe| *keyframe <= time);
        let index = after.saturating_sub(1);
        match self.times.get(after) {
            Some(next) if after > 0 => {
                let length = next - self.times[index];
                Between { index, share: (time - self.times[index]) / length, length }
            }
            _ => Between { index, share: 0.0, length: 0.0 },
        }
    }

    /// The value of a keyframe.
    fn value(&self, index: usize) -> [f64; N] {
        match self.interpolation {
            Interpolation::CubicSpline => self.values[3 * index + 1],
            _ => self.values[index],
        }
    }
}

impl Curve<4> {
    /// The same as [`Self::at`] for quaternions, x, y, z, w: between keyframes of length 1, by the shorter arc. None
    /// where that is no rotation.
    pub fn rotation_at(&self, time: f64) -> Option<[f64; 4]> {
        let Between { index, share, .. } = self.between(time);
        if share == 0.0 || self.interpolation == Interpolation::Step {
            return Some(self.value(index));
        }
        let unit = |value| DVec4::from_array(value).try_normalize();
        let rotation = match self.interpolation {
            Interpolation::Linear => {
                let [from, to] = [self.value(index), self.value(index + 1)].map(unit);
                DQuat::from_vec4(from?).slerp(DQuat::from_vec4(to?), share).into()
            }
            _ => DVec4::from_array(self.at(time)),
        };
        unit(rotation.to_array()).map(|rotation| rotation.to_array())
    }
}

/// The sum of `terms`, each a weight and a value.
fn weighted<const N: usize, const TERMS: usize>(terms: [(f64, [f64; N]); TERMS]) -> [f64; N] {
    core::array::from_fn(|axis| terms.iter().map(|(weight, value)| weight * value[axis]).sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_8, PI};

    fn near<const N: usize>(a: [f64; N], b: [f64; N]) -> bool {
        a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12)
    }

    #[test]
    fn curves_pass_their_keyframes_and_stay_at_their_ends() {
        let value = |x: f64| [x, 2.0 * x];
        for interpolation in [Interpolation::Step, Interpolation::Linear, Interpolation::CubicSpline] {
            let tangents = interpolation == Interpolation::CubicSpline;
            let values = [1.0, 5.0, -2.0].into_iter().flat_map(|x| match tangents {
                true => vec![[9.0; 2], value(x), [9.0; 2]],
                false => vec![value(x)],
            });
            let curve = Curve { times: vec![1.0, 2.0, 4.0], values: values.collect(), interpolation };
            for (time, expected) in [(-1.0, 1.0), (1.0, 1.0), (2.0, 5.0), (4.0, -2.0), (9.0, -2.0)] {
                assert_eq!(curve.at(time), value(expected), "{interpolation:?} at {time}");
            }
        }
    }

    #[test]
    fn between_keyframes_values_are_those_of_their_interpolation() {
        let curve = |interpolation, values| Curve { times: vec![1.0, 3.0], values, interpolation };
        assert_eq!(curve(Interpolation::Step, vec![[1.0], [2.0]]).at(2.999), [1.0]);
        assert_eq!(curve(Interpolation::Linear, vec![[1.0], [2.0]]).at(1.5), [1.25]);
        // The spline of a cubic polynomial is that polynomial.
        let (f, slope) = (|t: f64| t * t * t - 2.0 * t, |t: f64| 3.0 * t * t - 2.0);
        let values = [1.0, 3.0].into_iter().flat_map(|t| [[slope(t)], [f(t)], [slope(t)]]).collect();
        let spline = curve(Interpolation::CubicSpline, values);
        for time in [1.0, 1.25, 2.0, 2.9] {
            assert!(near(spline.at(time), [f(time)]), "{:?} at {time}", spline.at(time));
        }
    }

    #[test]
    fn rotations_go_evenly_by_the_shorter_arc() {
        let about_x = |angle: f64| [(angle / 2.0).sin(), 0.0, 0.0, (angle / 2.0).cos()];
        let curve =
            |to| Curve { times: vec![0.0, 1.0], values: vec![about_x(0.0), to], interpolation: Interpolation::Linear };
        for share in [0.125, 0.5, 0.9] {
            let expected = about_x(share * PI / 2.0);
            let quarter = curve([FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2]).rotation_at(share).expect("a rotation");
            assert!(near(quarter, expected), "{quarter:?} at {share}");
            // The same rotation by the other quaternion.
            let other = curve([-FRAC_1_SQRT_2, 0.0, 0.0, -FRAC_1_SQRT_2]).rotation_at(share).expect("a rotation");
            assert!(near(other, expected), "{other:?} at {share}");
        }
        let spline = [[0.0; 4], about_x(0.0), [0.0; 4], [0.0; 4], about_x(PI / 2.0), [0.0; 4]].to_vec();
        let spline = Curve { values: spline, interpolation: Interpolation::CubicSpline, ..curve([0.0; 4]) };
        assert!(near(spline.rotation_at(0.5).expect("a rotation"), about_x(2.0 * FRAC_PI_8)), "half the way");
        assert_eq!(curve([0.0; 4]).rotation_at(0.5), None);
    }
}
