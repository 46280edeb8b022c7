//! Figures as people read them, and as programs do.

use fogbow_kernels::survival::Survival;

/// A number with `digits` significant digits, whole numbers without a point, very large and small ones with an
/// exponent.
pub fn number(value: f64, digits: usize) -> String {
    if !value.is_finite() || (value.fract() == 0.0 && value.abs() < 1e6) {
        return value.to_string();
    }
    let after_first = digits.saturating_sub(1);
    let scientific = format!("{value:.after_first$e}");
    // That of the rounded number: 9.9999 with three digits has the exponent of 10.
    let exponent = scientific.rsplit('e').next().and_then(|exponent| exponent.parse().ok()).unwrap_or(0);
    match exponent {
        -4..6 => format!("{value:.*}", (after_first as i32 - exponent).max(0) as usize),
        _ => scientific,
    }
}

/// Digits of a length.
const DIGITS: usize = 6;
/// Digits that tell all doubles apart.
const MOST_DIGITS: usize = 17;

/// A length without zeros at its end.
pub fn length(metres: f64) -> String {
    length_of(metres, DIGITS)
}

fn length_of(metres: f64, digits: usize) -> String {
    let text = number(metres, digits);
    text.parse::<f64>().map_or(text, |rounded| rounded.to_string())
}

/// The corners of a box, with as many digits as show its shortest edge that is not 0 to a thousandth, wherever it is.
pub fn extent([low, high]: [[f64; 3]; 2]) -> String {
    let farthest = low.into_iter().chain(high).fold(0.0, |farthest: f64, x| farthest.max(x.abs()));
    let edges = low.into_iter().zip(high).map(|(low, high)| (high - low).abs());
    let shortest = edges.filter(|edge| *edge > 0.0).fold(f64::INFINITY, f64::min);
    let digits = (farthest / shortest).log10().ceil().max(0.0) as usize + 3;
    let length = |x| length_of(x, digits.clamp(DIGITS, MOST_DIGITS));
    let [low, high] = [low, high].map(|corner| corner.map(length).join(", "));
    format!("[{low}] to [{high}]")
}

/// How many vertices connect.
pub fn starts(starts: u32) -> String {
    if starts == u32::MAX { "all".into() } else { starts.to_string() }
}

/// How readily walks go on: a number, or one for every octave of depth.
pub fn survival(survival: &Survival) -> String {
    match survival.constant() {
        Some(constant) => constant.to_string(),
        None => survival.octaves().map(|octave| octave.to_string()).join(" "),
    }
}

/// The same for people: of walks that end by depth, how far they get, where paths have `longest` segments at most.
pub fn survival_in_words(survival: &Survival, longest: u32) -> String {
    if let Some(constant) = survival.constant() {
        return format!("survival {constant}");
    }
    let last = |share: f64| {
        let (mut near, mut far) = (1, longest + 1);
        while far - near > 1 {
            let middle = near + (far - near) / 2;
            if survival.reach(middle) >= share { near = middle } else { far = middle }
        }
        near
    };
    let [half, few] = [0.5, 0.01].map(last);
    let share = |vertex: u32| percent(survival.reach(vertex));
    if half == longest {
        format!("{} of all walks get to the last vertex", share(longest))
    } else if few == longest {
        format!("half of all walks get to vertex {half}, {} to the last", share(longest))
    } else {
        format!("half of all walks get to vertex {half}, 1 % to vertex {few}")
    }
}

/// A share in percent.
pub fn percent(share: f64) -> String {
    format!("{} %", number(100.0 * share, 3))
}

/// A rate with its unit.
pub fn rate(samples_per_second: f64) -> String {
    match samples_per_second {
        rate if rate >= 1e6 => format!("{:.2} M samples/s", rate / 1e6),
        rate if rate >= 1e3 => format!("{:.1} k samples/s", rate / 1e3),
        rate => format!("{rate:.0} samples/s"),
    }
}

/// A duration with one or two units.
pub fn duration(seconds: f64) -> String {
    match seconds {
        ..0.001 => "less than 1 ms".into(),
        ..0.0995 => format!("{:.0} ms", 1e3 * seconds),
        ..9.95 => format!("{seconds:.1} s"),
        _ => long_duration(seconds.round().min(LONGEST_DURATION) as u64),
    }
}

/// The longest duration that is told `[s]`, and one from which on days are not counted.
const LONGEST_DURATION: f64 = 1e10;
const YEAR: u64 = 365 * 24 * 60 * 60;

/// The same of whole seconds.
fn long_duration(seconds: u64) -> String {
    let pair = |number: u64, [large, small]: [&str; 2], size: u64| match (number / size, number % size) {
        (0, rest) => format!("{rest} {small}"),
        (whole, 0) => format!("{whole} {large}"),
        (whole, rest) => format!("{whole} {large} {rest} {small}"),
    };
    // Of the rounded number: a second less than a day is a day.
    let rounded = |unit: u64| (seconds + unit / 2) / unit;
    match (rounded(60), rounded(60 * 60)) {
        _ if seconds < 60 * 60 => pair(seconds, ["min", "s"], 60),
        (minutes, _) if minutes < 24 * 60 => pair(minutes, ["h", "min"], 60),
        (_, hours) if seconds < YEAR => pair(hours, ["d", "h"], 24),
        _ => format!("{} years", number(seconds as f64 / YEAR as f64, 3)),
    }
}

/// A number that any program reads, as short as it can be without loss.
pub fn plain(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude != 0.0 && !(1e-4..1e15).contains(&magnitude) { format!("{value:e}") } else { value.to_string() }
}

/// A line of CSV: texts with commas or quotes are quoted.
pub fn csv_line<T: AsRef<str>>(cells: impl IntoIterator<Item = T>) -> String {
    let quoted = |text: &str| {
        if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_string() }
    };
    cells.into_iter().map(|cell| quoted(cell.as_ref())).collect::<Vec<_>>().join(",") + "\n"
}

#[cfg(test)]
mod tests {
    use fogbow_kernels::LONGEST_PATH;

    use super::*;

    #[test]
    fn numbers_are_as_long_as_they_say_something() {
        let cases = [(0.0, "0"), (1.23456, "1.235"), (-64.0, "-64"), (123_456.0, "123456"), (1e-3, "0.001000")];
        for (value, text) in cases {
            assert_eq!(number(value, 4), text);
        }
        assert_eq!(number(1.5e-7, 3), "1.50e-7");
        assert_eq!([9.999_99, 10.000_01, 0.999_96].map(|value| number(value, 4)), ["10.00", "10.00", "1.000"]);
        assert_eq!(number(f64::INFINITY, 3), "inf");
    }

    #[test]
    fn boxes_far_away_show_how_large_they_are() {
        assert_eq!(extent([[-1.0, 0.0, 0.5], [1.0, 2.0, 1.0 / 3.0]]), "[-1, 0, 0.5] to [1, 2, 0.333333]");
        let far = extent([[1e8, 0.0, 0.0], [1e8 + 0.25, 1.0, 1.0]]);
        assert_eq!(far, "[100000000, 0, 0] to [100000000.25, 1, 1]");
        assert_eq!(extent([[7.0; 3]; 2]), "[7, 7, 7] to [7, 7, 7]");
    }

    #[test]
    fn walks_that_end_by_depth_are_told_by_how_far_they_get() {
        assert_eq!(survival_in_words(&Survival::Constant(0.75), LONGEST_PATH), "survival 0.75");
        let told = survival_in_words(&Survival::fading(3), LONGEST_PATH);
        // 2^4 + 5 and 2^11 + 1758, as the share falls evenly from one octave to the next.
        assert_eq!(told, "half of all walks get to vertex 21, 1 % to vertex 3806");
        let told = survival_in_words(&Survival::fading(12), LONGEST_PATH);
        assert_eq!(told, "half of all walks get to vertex 10922, 12.5 % to the last");
        assert_eq!(survival_in_words(&Survival::fading(16), LONGEST_PATH), "100 % of all walks get to the last vertex");
        // As far as paths may go.
        let told = survival_in_words(&Survival::fading(3), 100);
        assert!(told.starts_with("half of all walks get to vertex 21, ") && told.ends_with(" % to the last"), "{told}");
    }

    #[test]
    fn rates_and_durations_read_well() {
        assert_eq!(rate(12_345_678.0), "12.35 M samples/s");
        assert_eq!(rate(1_500.0), "1.5 k samples/s");
        assert_eq!(duration(0.0123), "12 ms");
        assert_eq!(duration(3.21), "3.2 s");
        assert_eq!(duration(9.96), "10 s");
        assert_eq!(duration(41.4), "41 s");
        assert_eq!([59.6, 75.2].map(duration), ["1 min", "1 min 15 s"]);
        assert_eq!([7500.0, 86_399.0, 8_000_113.0].map(duration), ["2 h 5 min", "1 d", "92 d 14 h"]);
        assert_eq!([1e8, f64::INFINITY].map(duration), ["3.17 years", "317 years"]);
    }
}
