//! URIs of buffers and images: data in the text, or a file beside the model.

use std::path::{Component, Path, PathBuf};

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

use super::fault::{Checked, Fault, quoted, require};

/// Base64 as RFC 4648 has it, with or without the padding, which some exporters leave out.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

const BESIDE: &str = "put the file in the folder of the model or below, and refer to it by its relative path";

/// What a URI stands for.
#[derive(Debug)]
pub enum Target {
    /// The data that it contains.
    Data(Vec<u8>),
    /// A path relative to the model's folder that does not lead out of it; the same for all spellings of the URI.
    File(PathBuf),
}

/// What `uri` stands for.
pub fn resolve(uri: &str) -> Checked<Target> {
    match split_scheme(uri) {
        Some(("data", rest)) => data(rest).map(Target::Data),
        Some((scheme, _)) => {
            let finding = format!("its URI {} has scheme {}, which is not supported", quoted(uri), quoted(scheme));
            Err(Fault::new(finding, BESIDE))
        }
        None => relative(uri).map(Target::File),
    }
}

/// The path that `uri` stands for, if it stands for one.
pub fn file(uri: &str) -> Option<PathBuf> {
    if split_scheme(uri).is_some() { None } else { relative(uri).ok() }
}

/// Scheme and rest, if there is a scheme; drive letters of Windows are schemes too.
fn split_scheme(uri: &str) -> Option<(&str, &str)> {
    let (scheme, rest) = uri.split_once(':')?;
    let is_scheme = scheme.starts_with(|first: char| first.is_ascii_alphabetic())
        && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c));
    is_scheme.then_some((scheme, rest))
}

/// The content of a data URI after its scheme: a media type, `;base64,` and the text.
fn data(rest: &str) -> Checked<Vec<u8>> {
    let remedy = "write data:application/octet-stream;base64, followed by the bytes in base64";
    let Some((media_type, text)) = rest.split_once(',') else {
        return Err(Fault::new(format!("its data URI {} has no comma", quoted(rest)), remedy));
    };
    let finding = || format!("its data URI of type {} is not base64", quoted(media_type));
    require(media_type.ends_with(";base64"), finding, remedy)?;
    BASE64.decode(text).map_err(|error| Fault::new(format!("its data URI is not valid base64: {error}"), remedy))
}

/// The path that a relative URI means. A backslash separates folders on some systems, so what it could lead to counts
/// too.
fn relative(uri: &str) -> Checked<PathBuf> {
    let Ok(path) = percent_decode_str(uri).decode_utf8() else {
        let finding = format!("its URI {} is not UTF-8 when decoded", quoted(uri));
        return Err(Fault::new(finding, "percent-encode the bytes of the name in UTF-8"));
    };
    let finding = || format!("its URI {} is an absolute path", quoted(uri));
    require(!path.starts_with(['/', '\\']), finding, BESIDE)?;
    let finding = || format!("its URI {} leads out of the model's folder", quoted(uri));
    require(path.split(['/', '\\']).all(|part| part != ".."), finding, BESIDE)?;
    let mut normal = PathBuf::new();
    for component in Path::new(path.as_ref()).components() {
        match component {
            Component::Normal(part) => normal.push(part),
            Component::CurDir => {}
            _ => return Err(Fault::new(finding(), BESIDE)),
        }
    }
    require(!normal.as_os_str().is_empty(), || format!("its URI {} does not name a file", quoted(uri)), BESIDE)?;
    Ok(normal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings_of_a_path_are_one() {
        for uri in ["a b/c.bin", "a%20b/c.bin", "./a%20b//%63.bin", "a b/./c.bin"] {
            assert!(matches!(resolve(uri), Ok(Target::File(path)) if path == Path::new("a b/c.bin")), "{uri}");
        }
    }

    #[test]
    fn base64_may_lack_its_padding() {
        for uri in ["data:;base64,AQI=", "data:application/gltf-buffer;base64,AQI"] {
            assert!(matches!(resolve(uri), Ok(Target::Data(bytes)) if bytes == [1, 2]), "{uri}");
        }
    }

    #[test]
    fn what_is_not_beside_the_model_is_refused() {
        for uri in
            ["", ".", "/a", "\\a", "../a", "a/../../b", "a\\..\\b", "%2e%2e/a", "C:\\a", "file:///a", "http://a/b"]
        {
            assert!(resolve(uri).is_err(), "{uri}");
        }
    }
}
