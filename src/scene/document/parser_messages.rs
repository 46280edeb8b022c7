//! What the parsers say, in words of someone who writes a scene rather than Rust.

/// What is found where a number has no digit before or after its point, or after its e.
pub const DIGITS_MISSING: &str = "digits of a number are missing here";

/// What is wrong with a value, and what would be right where that is short.
#[derive(Debug, PartialEq, Eq)]
pub struct Words {
    /// What was found; begins with a verb if it is about the key and not about its value.
    pub finding: String,
    /// What would be right.
    pub remedy: Option<String>,
}

impl Words {
    /// The finding about the value at `path`, which is empty for that of the whole document.
    pub fn at(&self, path: &str) -> String {
        let Self { finding, .. } = self;
        match path {
            "" => finding.clone(),
            _ if finding.starts_with("has ") => format!("{path} {finding}"),
            _ => format!("{path}: {finding}"),
        }
    }
}

/// `message` of the TOML parser or of a type, with keys and lists for fields and sequences.
pub fn words(message: &str) -> Words {
    let Some((found, expected)) = message.rsplit_once(", expected ") else {
        return Words { finding: message.replacen("missing field", "missing key", 1), remedy: None };
    };
    if expected == "digits" {
        let remedy = "give a number digits before and after its point, and after its e, as 0.3, 3.0 and 1e5; put text, \
                      such as a path, in quotes";
        return Words { finding: DIGITS_MISSING.into(), remedy: Some(remedy.into()) };
    }
    let expected = plain_expected(expected);
    match out_of_range(found) {
        Some(number) => {
            Words { finding: format!("{number} is out of range"), remedy: Some(format!("give {expected}")) }
        }
        None => Words { finding: format!("{}, expected {expected}", plain_found(found)), remedy: None },
    }
}

/// The whole number that is refused for being too small or too large.
fn out_of_range(found: &str) -> Option<&str> {
    let number = found.strip_prefix("invalid value: integer `").and_then(|rest| rest.strip_suffix('`'));
    number.or_else(|| found.strip_prefix("invalid type: integer `")?.strip_suffix("` as i128"))
}

fn plain_found(found: &str) -> String {
    match found {
        "invalid type: map" => return "this is a table".into(),
        "invalid type: sequence" => return "this is a list".into(),
        "invalid type: unit variant" => return "this is not a name".into(),
        _ => {}
    }
    let prefixes = [
        ("unknown field", "unknown key"),
        ("unknown variant", "unknown name"),
        ("invalid type: floating point", "this is the number"),
        ("invalid type: integer", "this is the whole number"),
        ("invalid type:", "this is the"),
        ("invalid value:", "this is the"),
    ];
    let prefix = prefixes.iter().find_map(|(theirs, ours)| Some((found.strip_prefix(theirs)?, ours)));
    prefix.map_or_else(|| found.into(), |(rest, ours)| format!("{ours}{rest}"))
}

fn plain_expected(expected: &str) -> String {
    match expected {
        "u32" => "a whole number from 0 to 4294967295".into(),
        "i32" => "a whole number from -2147483648 to 2147483647".into(),
        "f64" => "a number".into(),
        "a sequence" => "a list".into(),
        "string only" => "a name".into(),
        "any valid TOML value" => "a number of at most 64 bits".into(),
        _ if expected.starts_with("struct ") => "a table".into(),
        _ => expected.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_rust_become_words() {
        let cases = [
            ("unknown field `g`, expected one of `a`, `b`", "unknown key `g`, expected one of `a`, `b`"),
            ("invalid type: integer `3`, expected struct Camera", "this is the whole number `3`, expected a table"),
            ("missing field `camera`", "missing key `camera`"),
            ("invalid value: string \"few\", expected a number", "this is the string \"few\", expected a number"),
        ];
        for (theirs, ours) in cases {
            assert_eq!(words(theirs), Words { finding: ours.into(), remedy: None });
        }
    }

    #[test]
    fn numbers_out_of_range_come_with_the_range() {
        for (theirs, number, range) in [
            ("invalid value: integer `-1`, expected u32", "-1", "a whole number from 0 to 4294967295"),
            (
                "invalid value: integer `99999999999`, expected i32",
                "99999999999",
                "a whole number from -2147483648 to 2147483647",
            ),
            ("invalid value: integer `0`, expected a whole number from 1 to 9", "0", "a whole number from 1 to 9"),
            (
                "invalid type: integer `99999999999999999999` as i128, expected any valid TOML value",
                "99999999999999999999",
                "a number of at most 64 bits",
            ),
        ] {
            let Words { finding, remedy } = words(theirs);
            assert_eq!((finding, remedy), (format!("{number} is out of range"), Some(format!("give {range}"))));
        }
    }

    #[test]
    fn numbers_that_lack_digits_are_told_so() {
        for text in ["a = .3", "a = 3.", "a = -.3", "a = 1e", "a = [1, 1.e5]", "a = ../b.vdb"] {
            let error = text.parse::<toml::Table>().expect_err("no TOML");
            let Words { finding, remedy } = words(error.message());
            assert_eq!(finding, DIGITS_MISSING, "{text}: {error}");
            assert!(remedy.is_some_and(|remedy| remedy.contains("0.3, 3.0 and 1e5; put text")), "{text}");
        }
    }

    #[test]
    fn findings_about_a_key_follow_it() {
        assert_eq!(words("has 3 entries, not 2").at("film.size"), "film.size has 3 entries, not 2");
        assert_eq!(words("unknown field `g`, expected `a`").at("film"), "film: unknown key `g`, expected `a`");
        assert_eq!(words("missing field `light`").at(""), "missing key `light`");
    }

    #[test]
    fn what_the_author_wrote_stays_as_it_is() {
        let theirs = r#"invalid type: string "map, expected u32", expected f64"#;
        assert_eq!(words(theirs).finding, r#"this is the string "map, expected u32", expected a number"#);
    }
}
