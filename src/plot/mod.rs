//! Plots: curves, points and paths as SVG pictures.

mod axes;
mod charts;
mod paths;

pub use axes::{Axis, Range};
pub use charts::{Chart, Curve, Look, bars, chart};
pub use paths::{Panel, paths_csv, paths_png, paths_svg};

/// Colours that tell series apart, also for people who see red and green alike (Okabe, Ito 2008).
pub const COLOURS: [[u8; 3]; 8] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [86, 180, 233],
    [230, 159, 0],
    [90, 90, 90],
    [0, 0, 0],
];

/// The colour of what is called `name` if that is a technique, so that it is the same in all plots, with a shade of its
/// own for each of its variants; otherwise that of series `index`.
pub fn colour(name: &str, index: usize) -> [u8; 3] {
    let known = [("path", 6), ("nee", 1), ("mvnee", 0), ("omnee", 5), ("bridge", 2), ("lis", 3)];
    let shades =
        [("-2", 0.5), ("fast", 0.4), ("lis", 0.4), ("-6", -0.35), ("-8", -0.6), ("aligned", -0.4), ("any", -0.5)];
    let name = name.to_lowercase();
    let word = name.split([' ', '-', ',']).next().unwrap_or(&name);
    let word = word.trim_end_matches('s');
    let Some((_, place)) = known.iter().find(|(technique, _)| technique.trim_end_matches('s') == word) else {
        return COLOURS[index % COLOURS.len()];
    };
    let variant = &name[word.len()..];
    let shade: f64 = shades.iter().rfind(|(part, _)| variant.contains(part)).map_or(0.0, |(_, shade)| *shade);
    COLOURS[*place].map(|channel| {
        let towards = if shade > 0.0 { 255.0 } else { 0.0 };
        (f64::from(channel) + shade.abs() * (towards - f64::from(channel))).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn techniques_have_colours_of_their_own() {
        let names =
            ["path tracing", "NEE", "MVNEE-2", "MVNEE-4", "MVNEE-6", "MVNEE-8", "OMNEE", "bridges", "bridges, aligned"];
        let colours = names.map(|name| colour(name, 0));
        for (place, first) in colours.iter().enumerate() {
            assert!(!colours[..place].contains(first), "{} has the colour of another", names[place]);
        }
        assert_eq!((colour("bridge", 0), colour("mvnee", 3)), (colour("bridges", 5), colour("MVNEE-4", 1)));
        assert_eq!(colour("ours", 9), COLOURS[1]);
    }
}
