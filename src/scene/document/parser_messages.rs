//! What the parsers say, in words of someone who writes a scene rather than Rust.

/// `message` of the TOML parser or of a type, with keys and lists for fields and sequences.
pub fn in_plain_words(message: &str) -> String {
    let Some((found, expected)) = message.rsplit_once(", expected ") else {
        return message.replacen("missing field", "missing key", 1);
    };
    format!("{}, expected {}", plain_found(found), plain_expected(expected))
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
        ("invalid value: integer", "this is the whole number"),
        ("invalid type:", "this is the"),
        ("invalid value:", "this is the"),
        ("invalid length", "the number of entries is"),
    ];
    let prefix = prefixes.iter().find_map(|(theirs, ours)| Some((found.strip_prefix(theirs)?, ours)));
    prefix.map_or_else(|| found.into(), |(rest, ours)| format!("{ours}{}", rest.trim_end_matches(" as i128")))
}

fn plain_expected(expected: &str) -> String {
    match expected {
        "u32" => "a whole number from 0 to 4294967295".into(),
        "f64" => "a number".into(),
        "a sequence" => "a list".into(),
        "string only" => "a name".into(),
        "fewer elements in array" => "fewer".into(),
        "any valid TOML value" => "a number of at most 64 bits".into(),
        _ if expected.starts_with("struct ") => "a table".into(),
        _ => expected.replacen("an array of length", "a list of length", 1).replacen("an array of", "a list of", 1),
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
            ("invalid length 4, expected fewer elements in array", "the number of entries is 4, expected fewer"),
            ("missing field `camera`", "missing key `camera`"),
            ("invalid value: string \"few\", expected a number", "this is the string \"few\", expected a number"),
            (
                "invalid type: integer `99999999999999999999` as i128, expected any valid TOML value",
                "this is the whole number `99999999999999999999`, expected a number of at most 64 bits",
            ),
        ];
        for (theirs, ours) in cases {
            assert_eq!(in_plain_words(theirs), ours);
        }
    }

    #[test]
    fn what_the_author_wrote_stays_as_it_is() {
        let theirs = r#"invalid type: string "map, expected u32", expected f64"#;
        assert_eq!(in_plain_words(theirs), r#"this is the string "map, expected u32", expected a number"#);
    }
}
