//! How noisy the samples of tiles are, from a few samples of every pixel.
//!
//! A few samples of a pixel know its mean badly, and the quotient of deviation and mean is then far too small. So means
//! and variances are those of cells of 4x4 pixels. Otherwise noise is what [`crate::film::Film::relative_noise`] says:
//! dark cells count as a tenth of the median, and the noisiest hundredth of them does not count.

use crate::film::{DARK, NOISIEST, Pixel, Region, Tile};

/// Side of a cell in pixels.
const SIDE: u32 = 4;

/// What samples say of a few pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Length of the mean radiance, an RGB vector [W/(m^2 sr)].
    pub mean: f64,
    /// Variance of a sample, summed over channels and in the mean of the pixels [(W/(m^2 sr))^2].
    pub variance: f64,
}

/// The cells of a tile.
pub fn cells(tile: &Tile) -> Vec<Cell> {
    tile.region().tiles(SIDE).map(|cell| of_region(tile, cell)).collect()
}

fn of_region(tile: &Tile, region: Region) -> Cell {
    let (mut mean, mut variance) = ([0.0; 3], 0.0);
    for (y, x) in region.rows().flat_map(|y| region.columns().map(move |x| (y, x))) {
        let Pixel { mean: rgb, standard_error, samples } = tile.pixel(x, y);
        mean.iter_mut().zip(rgb).for_each(|(mean, value)| *mean += value);
        variance += samples as f64 * standard_error.into_iter().map(|error| error * error).sum::<f64>();
    }
    let (length, pixels) = (mean.into_iter().map(|x| x * x).sum::<f64>().sqrt(), region.pixels() as f64);
    Cell { mean: length / pixels, variance: variance / pixels }
}

/// Variance of samples relative to the square of their pixel's mean, in the mean of the cells of every tile.
pub fn variances(tiles: &[Vec<Cell>]) -> Vec<f64> {
    let mut means: Vec<_> = tiles.iter().flatten().map(|cell| cell.mean).filter(|mean| *mean > 0.0).collect();
    if means.is_empty() {
        return vec![0.0; tiles.len()];
    }
    let middle = means.len() / 2;
    let floor = DARK * *means.select_nth_unstable_by(middle, f64::total_cmp).1;
    let relative = |cell: &Cell| cell.variance / cell.mean.max(floor).powi(2);
    let mut all: Vec<_> = tiles.iter().flatten().map(relative).collect();
    let counted = all.len() - 1 - all.len() / NOISIEST;
    let most = *all.select_nth_unstable_by(counted, f64::total_cmp).1;
    let of_tile = |cells: &Vec<Cell>| {
        let counted: Vec<_> = cells.iter().map(relative).filter(|variance| *variance <= most).collect();
        if counted.is_empty() { most } else { counted.iter().sum::<f64>() / counted.len() as f64 }
    };
    tiles.iter().map(of_tile).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(mean: f64, variance: f64) -> Cell {
        Cell { mean, variance }
    }

    #[test]
    fn it_is_variance_over_the_square_of_the_mean() {
        let tiles = [vec![cell(1.0, 4.0); 64], vec![cell(10.0, 100.0); 64]];
        assert_eq!(variances(&tiles), [4.0, 1.0]);
        assert_eq!(variances(&[vec![cell(0.0, 0.0); 4], vec![]]), [0.0, 0.0], "nothing but black");
    }

    #[test]
    fn neither_a_rim_nor_the_dark_counts_for_much() {
        let mut tiles = vec![vec![cell(1.0, 1.0); 64]; 8];
        tiles[2][5] = cell(50.0, 1e9);
        tiles[3] = vec![cell(1e-9, 1e-4); 64];
        let found = variances(&tiles);
        assert_eq!((found[2], found[1]), (1.0, 1.0));
        assert!((found[3] - 1e-4 / DARK.powi(2)).abs() < 1e-9, "{found:?}");
    }
}
