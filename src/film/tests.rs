use super::*;
use crate::image;

/// Index of a layer that no render has: one channel, without squares.
const DEPTH: usize = 1;

/// Radiance and the made-up layer.
fn two_layers() -> [Layer; 2] {
    let unit = Unit::for_largest(100.0);
    [
        Layer { name: "radiance", channels: 3, unit, squares: true, kind: Kind::Mean, planes: &["R", "G", "B"] },
        Layer {
            name: "depth",
            channels: 1,
            unit: Unit::for_largest(1e4),
            squares: false,
            kind: Kind::Mean,
            planes: &["depth.Z"],
        },
    ]
}

const REGION: Region = Region { x0: 3, y0: 2, x1: 20, y1: 13 };
const SAMPLES: u32 = 8;

/// The values of a sample of pixel (x, y), with few enough digits that sums of them are exact in f64, too.
fn sample(x: u32, y: u32, number: u32) -> ([f32; 3], [f32; 1]) {
    let value = |channel: u32| ((7 * x + 31 * y + 13 * number + 5 * channel) % 97) as f32;
    ([value(0) / 8.0, value(1), value(2) * 0.5], [100.0 * value(3)])
}

/// Adds these samples to all pixels of `film`, in their order.
fn add(film: &Film, samples: impl Iterator<Item = u32> + Clone) {
    for index in 0..film.tile_count() {
        let mut tile = film.tile(index);
        let region = tile.region();
        for number in samples.clone() {
            for (y, x) in region.rows().flat_map(|y| region.columns().map(move |x| (y, x))) {
                let (radiance, depth) = sample(x, y, number);
                tile.add(region.place(x, y), &[radiance.as_slice(), &depth]);
            }
            tile.count(1);
        }
    }
}

fn film(layers: &[Layer], tile_size: u32, samples: impl Iterator<Item = u32> + Clone) -> Film {
    let film = Film::try_new(layers, REGION, tile_size).expect("memory");
    add(&film, samples);
    film
}

#[test]
fn samples_that_are_added_together_add_up_to_the_same() {
    let layers = &two_layers()[..1];
    let [mut together, mut apart] = [(); 2].map(|()| Tile::new(layers, REGION));
    for place in 0..REGION.pixels() as usize {
        // Of all sizes up to more than a sum can hold, and nothing.
        let value = |channel: usize, i: usize| match (place + i) % 11 {
            0 => 0.0,
            k => 10.0_f32.powi(4 * k as i32 - 9) * (1.0 + 0.37 * (place + channel) as f32),
        };
        let values = |channel: usize| core::array::from_fn::<f32, 8, _>(|i| value(channel, i));
        together.add_radiance(place, values);
        (0..8).for_each(|i| apart.add(place, &[[0, 1, 2].map(|channel| value(channel, i))]));
    }
    assert!(together == apart);
}

/// All that is known of a layer's channel, row by row from the top.
fn estimates(film: &Film, layer: usize, channel: usize) -> Vec<Estimate> {
    let pixels = REGION.rows().flat_map(|y| REGION.columns().map(move |x| (x, y)));
    pixels.map(|(x, y)| film.estimate(layer, channel, x, y)).collect()
}

/// The mean of a value over the samples, row by row from the top.
fn means(value: impl Fn([f32; 3], [f32; 1]) -> f32) -> Vec<f64> {
    let pixels = REGION.rows().flat_map(|y| REGION.columns().map(move |x| (x, y)));
    let one = |(x, y), number| {
        let (radiance, depth) = sample(x, y, number);
        f64::from(value(radiance, depth))
    };
    pixels.map(|at| (0..SAMPLES).map(|number| one(at, number)).sum::<f64>() / f64::from(SAMPLES)).collect()
}

#[test]
fn small_images_have_tiles_for_several_workers() {
    let tiles = |width: u32, height: u32| {
        let region = Region::whole(width, height);
        (tile_size(region), region.tiles(tile_size(region)).count())
    };
    assert_eq!(tiles(1920, 1080), (32, 2040));
    assert_eq!(tiles(100, 100), (16, 49));
    assert_eq!(tiles(32, 32), (8, 16));
    assert_eq!(tiles(1, 1), (8, 1));
}

#[test]
fn every_layer_takes_only_what_it_keeps() {
    let layers = two_layers();
    assert_eq!(Film::bytes(&layers[..1], 1000), 1000 * 3 * 28);
    assert_eq!(Film::bytes(&layers, 1000), 1000 * (3 * 28 + 12));
    let grey = Layer { channels: 1, ..layers[RADIANCE] };
    assert_eq!(Film::bytes(&[grey], 1000), 1000 * 28);
}

#[test]
fn every_layer_has_the_exact_means_of_its_samples() {
    let film = film(&two_layers(), 8, 0..SAMPLES);
    let found = |layer, channel| estimates(&film, layer, channel).iter().map(|found| found.mean).collect::<Vec<_>>();
    for channel in 0..3 {
        assert_eq!(found(RADIANCE, channel), means(|radiance, _| radiance[channel]), "channel {channel}");
    }
    assert_eq!(found(DEPTH, 0), means(|_, depth| depth[0]));
    assert!(estimates(&film, RADIANCE, 0).iter().all(|found| found.standard_error.is_finite()));
    assert!(estimates(&film, DEPTH, 0).iter().all(|found| found.standard_error.is_infinite()), "no squares are kept");
}

#[test]
fn a_film_is_black_until_one_pixel_is_not() {
    let film = film(&two_layers(), 8, 0..0);
    let (x, y) = (REGION.x1 - 1, REGION.y1 - 1);
    let sample = |radiance: [f32; 3]| {
        let mut tile = film.tile(film.tile_count() - 1);
        let place = tile.region().place(x, y);
        tile.add(place, &[radiance.as_slice(), &[2.0]]);
        tile.count(1);
    };
    assert!(film.is_black() && film.samples_of(x, y) == 0);
    sample([0.0; 3]);
    assert!(film.is_black() && film.samples_of(x, y) == 1, "what is deep may be black");
    sample([0.0, 0.0, 1.0]);
    assert!(!film.is_black() && film.samples_of(x, y) == 2 && film.samples_of(REGION.x0, y) == 0);
}

#[test]
fn order_tiles_and_merging_leave_no_trace_in_any_layer() {
    let radiance = |film: &Film| [0, 1, 2].map(|channel| estimates(film, RADIANCE, channel));
    let layers = two_layers();
    let usual = film(&layers, 8, 0..SAMPLES);
    let mut merged = film(&layers, 5, [7, 3].into_iter());
    merged.merge(&film(&layers, 5, [0, 6, 1].into_iter()));
    merged.merge(&film(&layers, 5, [5, 4, 2].into_iter()));
    for other in [film(&layers, 64, 0..SAMPLES), film(&layers, 3, (0..SAMPLES).rev()), merged] {
        assert_eq!(radiance(&usual), radiance(&other));
        assert_eq!(estimates(&usual, DEPTH, 0), estimates(&other, DEPTH, 0));
        assert_eq!(usual.samples(), other.samples());
    }
}

#[test]
fn a_film_keeps_radiance_the_same_whatever_other_layers_it_has() {
    let layers = two_layers();
    let (alone, among) = (film(&layers[..=RADIANCE], 8, 0..SAMPLES), film(&layers, 8, 0..SAMPLES));
    assert!(alone.pixels().eq(among.pixels()));
}

#[test]
#[should_panic = "same shape"]
fn films_of_different_layers_are_not_merged() {
    let layers = two_layers();
    film(&layers, 8, 0..1).merge(&film(&layers[..=RADIANCE], 8, 1..2));
}

#[test]
fn every_layer_is_in_the_file_under_its_own_names() {
    let film = film(&two_layers(), 8, 0..SAMPLES);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("layers.exr");
    let file = std::fs::File::create(&path).expect("a file");
    image::exr::write_film(std::io::BufWriter::new(file), &film, [32, 32], &[]).expect("written");
    let image = image::exr::read_image(&path).expect("an image");
    let names: Vec<_> = image.channels.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["B", "G", "N", "R", "SE.B", "SE.G", "SE.R", "depth.Z"]);
    assert_eq!((image.width, image.height), (17, 11));
    let plane = |name: &str| image.channel(name).expect("a plane").to_vec();
    let shown = |layer, channel, part: fn(&Estimate) -> f64| {
        estimates(&film, layer, channel).iter().map(|estimate| part(estimate) as f32).collect::<Vec<_>>()
    };
    for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
        assert_eq!(plane(name), shown(RADIANCE, channel, |estimate| estimate.mean));
        assert_eq!(plane(&format!("SE.{name}")), shown(RADIANCE, channel, |estimate| estimate.standard_error));
    }
    assert_eq!(plane("depth.Z"), shown(DEPTH, 0, |estimate| estimate.mean));
    assert_eq!(plane("N"), vec![SAMPLES as f32; 17 * 11]);
}

/// A split of the radiance in two, both layers like it, and a signed one.
fn layers_with_parts() -> [Layer; 4] {
    let [radiance, depth] = two_layers();
    let part = Layer { name: "part", squares: false, kind: Kind::Part(aov::Split::Technique), ..radiance };
    [radiance, Layer { name: "height", kind: Kind::Signed, unit: Unit::for_exponent(0), ..depth }, part, part]
}

#[test]
fn parts_add_up_however_they_are_rounded() {
    let tile = &mut Tile::new(&layers_with_parts(), Region::whole(1, 1));
    // Parts that are too small, too large, larger than the whole, nothing at all, and beyond what units resolve.
    let samples = [
        (1.0, 0.3, 0.6),
        (1.0, 0.7, 0.4),
        (1e-3, 5.0, 4.0),
        (2.0, 0.0, 0.0),
        (1e-12, 0.7e-12, 0.6e-12),
        (3e9, 1e9, 2e9),
        (0.0, 1.0, 0.0),
    ];
    for (whole, a, b) in samples {
        tile.add(0, &[[whole; 3], [0.0; 3], [a; 3], [b; 3]]);
    }
    let mut sum = tile.exact(2, 1, 0, 0);
    sum.sum.merge(&tile.exact(3, 1, 0, 0).sum);
    assert_eq!(sum.sum, tile.exact(RADIANCE, 1, 0, 0).sum);
}

#[test]
fn means_of_signed_layers_may_be_negative() {
    let tile = &mut Tile::new(&layers_with_parts(), Region::whole(1, 1));
    for value in [-1.0, -0.5, 0.25, 0.0] {
        tile.add(0, &[[0.0; 3], [value; 3], [0.0; 3], [0.0; 3]]);
        tile.count(1);
    }
    assert_eq!(tile.estimate(1, 0, 0, 0).mean, -0.3125);
    let empty = Tile::new(&layers_with_parts(), Region::whole(1, 1));
    assert_eq!(empty.estimate(1, 0, 0, 0).mean, 0.0, "nothing is known");
}

#[test]
fn means_over_some_samples_know_how_many() {
    let [radiance, depth] = two_layers();
    let depth = Layer { channels: 2, kind: Kind::OfSome, ..depth };
    let tile = &mut Tile::new(&[radiance, depth], Region::whole(2, 1));
    for (value, has) in [(4.0, 1.0), (0.0, 0.0), (2.0, 1.0), (0.0, 0.0)] {
        tile.add(0, &[[0.0; 3], [value, has, 0.0]]);
        tile.count(1);
    }
    let known = |x, channel| tile.estimate(1, channel, x, 0).mean;
    assert_eq!([known(0, 0), known(0, 1), known(1, 0), known(1, 1)], [3.0, 0.5, 0.0, 0.0]);
}
