//! Bricks of both forms.

use super::*;
use crate::random;

/// A leaf of densities about 1, in which one of 512 voxels is as dense as this.
fn spiky(most: f32) -> [Leaf; 1] {
    let value = |voxel: u32| 0.5 + random::uniform(random::words(voxel, 1, 2, 3)[0]) as f32;
    let values = core::array::from_fn(|voxel| if voxel == 219 { most } else { value(voxel as u32) });
    [Leaf { origin: [0; 3], values: Arc::new(values) }]
}

#[test]
fn what_is_next_to_something_far_denser_keeps_its_density() {
    for most in [2.0, 90.0, 1e3, 1e4, 1e6, 1e8] {
        let leaves = spiky(most);
        let tolerance = 1e-3 * (1.0 + f64::from(most) / 512.0);
        for (bricks, voxel) in Bricks::both(&leaves).iter().flat_map(|form| (0..512).map(move |voxel| (form, voxel))) {
            // The first brick is the one before, with the leaf's first layers in its apron.
            let place = [voxel % 8, voxel / 8 % 8, voxel / 64].map(|component| component + 8);
            let expected = f64::from(leaves[0].values[voxel]);
            let at = Vec3x8::splat(place.map(|component| component as f32));
            let [smooth, nearest] = [true, false].map(|smooth| f64::from(bricks.density(at, smooth).to_array()[0]));
            for found in [bricks.value(place.map(|component| component as i64)), smooth, nearest] {
                // Of the densest, as many digits as an f32 has.
                let rounded = if voxel == 219 { 1e-6 * expected } else { 0.0 };
                let difference = (found - expected).abs();
                assert!(difference < tolerance + rounded, "{most}: {found} instead of {expected} at {place:?}");
            }
        }
    }
}

#[test]
fn only_bricks_with_something_far_denser_take_more_memory() {
    let bytes = |leaves: &[Leaf]| Bricks::both(leaves).map(|form| form.bytes());
    let [even, dense, most] = [2.0, 90.0, 1e3].map(|most| bytes(&spiky(most)));
    let far = Leaf { origin: [80, 0, 0], ..spiky(2.0)[0].clone() };
    let [both, alone] = [bytes(&[spiky(1e4)[0].clone(), far.clone()]), bytes(&[spiky(2.0)[0].clone(), far])];
    for form in 0..2 {
        assert_eq!(even[form], dense[form]);
        assert!(most[form] > even[form], "{} bytes, {} of the others", most[form], even[form]);
    }
    for form in 0..2 {
        assert_eq!(both[form] - alone[form], 1024, "the 512 values of one brick of sixteen have fine shares");
    }
}

#[test]
fn extents_hold_all_densities_between_voxels() {
    for (most, form) in [2.0, 1e4, 1e7].into_iter().flat_map(|most| [(most, 0), (most, 1)]) {
        let bricks = &Bricks::both(&spiky(most))[form];
        for seed in 0..2000 {
            let words = random::words(seed, 5, 6, 7);
            let first = [0, 1, 2].map(|axis| words[axis] % 16);
            let at = [0, 1, 2].map(|axis| first[axis] as f32 + (words[axis] >> 8) as f32 / (1 << 24) as f32);
            let density = bricks.density(Vec3x8::splat(at), true).to_array()[0];
            let Extent { least, most, mean } = bricks.extent(first, 1, true);
            assert!((least..=most).contains(&density), "{density} at {at:?}, {least} to {most}");
            assert!((least..=most).contains(&mean), "{mean}, {least} to {most}");
        }
    }
}

#[test]
fn more_values_than_can_be_told_apart_are_too_many() {
    for leaves in [shell(2.0), shell(42.0)] {
        let (_, boxes) = Maker::new(&leaves).boxes();
        let at_most = |most: usize| Bricks::of_at_most(&leaves, most);
        assert_eq!(at_most(boxes.pool_len()), Some(Bricks::new(&leaves)));
        assert_eq!(at_most(boxes.pool_len() - 1), None);
    }
}

#[test]
fn leaves_may_be_where_the_first_numbers_are() {
    let far = Leaf { origin: [i32::MIN, 0, i32::MIN + 8], ..spiky(2.0)[0].clone() };
    for bricks in Bricks::both(&[far]) {
        let before = [i64::from(i32::MIN) - 8, -8, i64::from(i32::MIN)];
        assert_eq!((bricks.origin, bricks.dims), (before, [2; 3]));
        assert!(bricks.value([8; 3]) > 0.4 && bricks.value([16, 8, 8]) == 0.0);
        let beyond = bricks.extent_between([i64::MIN; 3], [i64::MAX; 3], true);
        assert!(beyond.least == 0.0 && beyond.most > 1.9, "{beyond:?}");
    }
}

/// Leaves of a shell of this thickness, in voxels, of densities about 1; every fourth of its leaves has one density.
fn shell(thickness: f64) -> Vec<Leaf> {
    let leaf = |number: u32| {
        let origin = [number % 7, number / 7 % 7, number / 49].map(|along| 8 * along as i32 - 24);
        let value = |voxel: usize| {
            let at = [voxel % 8, voxel / 8 % 8, voxel / 64];
            let from_centre = (0..3).map(|axis| f64::from(origin[axis]) + at[axis] as f64 - 3.7).map(|d| d * d);
            let inside = (from_centre.sum::<f64>().sqrt() - 21.0).abs() < thickness / 2.0;
            let varied = random::uniform(random::words(number, voxel as u32, 8, 9)[0]) as f32;
            let density = if number.is_multiple_of(4) { 0.5 } else { 0.5 + varied };
            if inside { density } else { 0.0 }
        };
        Leaf { origin, values: Arc::new(core::array::from_fn(value)) }
    };
    (0..343).map(leaf).filter(|leaf| leaf.values.iter().any(|value| *value != 0.0)).collect()
}

#[test]
fn thin_shells_take_little_more_than_their_voxels() {
    for (thickness, thin) in [(2.0, true), (4.0, true), (42.0, false)] {
        let leaves = shell(thickness);
        let bricks = Bricks::new(&leaves);
        assert_eq!(matches!(bricks.form, Form::Masks(_)), thin, "a shell of {thickness} voxels");
        let voxels = 4 * values(&leaves).filter(|value| *value != 0.0).count();
        let share = bricks.bytes() as f64 / voxels as f64;
        assert!(share <= 1.3, "a shell of {thickness} voxels: {share}");
    }
}

#[test]
fn densities_of_thin_shells_are_those_of_boxes() {
    let mut leaves = shell(2.0);
    // Every fifth leaf has something far denser, and fine shares.
    for leaf in leaves.iter_mut().step_by(5) {
        let value = Arc::make_mut(&mut leaf.values).iter_mut().rfind(|value| **value != 0.0);
        *value.expect("a voxel of the shell") = 300.0;
    }
    let [boxes, masks] = Bricks::both(&leaves);
    let mut filled = 0;
    for seed in 0..20_000 {
        // Over the borders, too.
        let words = random::words(seed, 1, 4, 9);
        let along = |axis: u32| {
            let word = |lane: usize| random::words(seed, axis, lane as u32, 8)[0];
            f32x8::new(crate::lanes::per_lane(|lane| 66.0 * random::uniform(word(lane)) as f32 - 1.0))
        };
        let at = Vec3x8::new(along(0), along(1), along(2));
        for smooth in [true, false] {
            let [expected, found] = [&boxes, &masks].map(|form| form.density(at, smooth).to_array());
            for (expected, found) in expected.into_iter().zip(found) {
                assert!((found - expected).abs() < 1e-4, "{found} instead of {expected} at {at:?}");
                filled += u32::from(found > 0.0);
            }
        }
        let (place, side) = (words.map(|word| word % 50), 1 << (words[3] % 4));
        let first = [place[0], place[1], place[2]].map(|along| along / side * side);
        for smooth in [true, false] {
            let [expected, found] = [&boxes, &masks].map(|form| form.extent(first, side, smooth));
            for (expected, found) in
                [expected.least, expected.most, expected.mean].into_iter().zip([found.least, found.most, found.mean])
            {
                assert!((found - expected).abs() < 1e-4, "{found} instead of {expected} from {first:?} on");
            }
        }
        let voxel = [place[0], place[1], place[2]].map(i64::from);
        assert!((boxes.value(voxel) - masks.value(voxel)).abs() < 1e-4, "at {voxel:?}");
    }
    assert!(filled > 16_000, "{filled} points in the shell");
}
