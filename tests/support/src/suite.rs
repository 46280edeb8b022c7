//! Which points of a proof a suite looks at.

/// Whether all of them: `--features long`.
pub const IS_LONG: bool = cfg!(feature = "long");

/// Half of `samples`, which tells the same to 1.4 times the error; all of them in the long suite.
pub const fn half(samples: u32) -> u32 {
    if IS_LONG { samples } else { samples / 2 }
}

/// Of the points of a proof every `stride`th from number `first` on, so that proofs of a kind can take turns; all of
/// them in the long suite.
pub fn some<T>(points: impl IntoIterator<Item = T>, first: usize, stride: usize) -> impl Iterator<Item = T> {
    let taken = move |number: usize| IS_LONG || number % stride == first % stride;
    points.into_iter().enumerate().filter(move |(number, _)| taken(*number)).map(|(_, point)| point)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_leave_no_point_out() {
        let of_turn = |first: usize| some(0..7, first, 3).collect::<Vec<_>>();
        if IS_LONG {
            assert_eq!(of_turn(1), [0, 1, 2, 3, 4, 5, 6]);
        } else {
            assert_eq!([0, 1, 5].map(of_turn), [vec![0, 3, 6], vec![1, 4], vec![2, 5]]);
        }
    }
}
