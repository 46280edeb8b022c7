//! Where flags say that images and drawings go.

use std::ffi::{OsStr, OsString};
use std::path::PathBuf;

use super::values::refuse;
use crate::error::Result;
use crate::image::Format;
use crate::output;

/// An image to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImageOutput {
    /// Where to.
    pub path: PathBuf,
    /// As what.
    pub format: Format,
}

impl ImageOutput {
    /// An image whose name says its format, or else the word before a colon, as in `png:/dev/stdout`.
    fn parse(text: OsString) -> Result<Self> {
        if let Some(image) = Self::prefixed("--output", &text)? {
            return Ok(image);
        }
        let path = PathBuf::from(text);
        let Some(format) = Format::of(&path) else {
            let remedy = "end the name in .exr or .png, or put the format before it, as in png:/dev/stdout";
            return refuse("--output", &path.to_string_lossy(), "does not name an image format", remedy);
        };
        Ok(Self { path, format })
    }

    /// The image that `text`, the value of `flag`, names after its format and a colon; none if it is written otherwise.
    fn prefixed(flag: &str, text: &OsStr) -> Result<Option<Self>> {
        let parts = text.to_str().and_then(|text| text.split_once(':'));
        let Some((format, path)) = parts.and_then(|(name, path)| Some((Format::named(name)?, path))) else {
            return Ok(None);
        };
        if path.is_empty() {
            let remedy = "put the path of a file after the colon, as in png:/dev/stdout";
            return refuse(flag, &text.to_string_lossy(), "does not name a file", remedy);
        }
        Ok(Some(Self { path: path.into(), format }))
    }
}

/// `--output`
pub fn image() -> impl clap::builder::TypedValueParser<Value = ImageOutput> {
    use clap::builder::{OsStringValueParser, TypedValueParser};
    OsStringValueParser::new().try_map(ImageOutput::parse)
}

/// A drawing of paths to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DrawingOutput {
    /// Where to.
    pub path: PathBuf,
    /// As what.
    pub format: DrawingFormat,
}

/// What drawings of paths are written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawingFormat {
    /// A drawing with letters.
    Svg,
    /// A picture without letters.
    Png,
    /// The vertices as a table.
    Csv,
}

/// `--output` of drawings.
pub fn drawing() -> impl clap::builder::TypedValueParser<Value = DrawingOutput> {
    use clap::builder::{OsStringValueParser, TypedValueParser};
    OsStringValueParser::new().try_map(|text: OsString| {
        let known = [("svg", DrawingFormat::Svg), ("png", DrawingFormat::Png), ("csv", DrawingFormat::Csv)];
        let path = PathBuf::from(text);
        let ending = path.extension().and_then(OsStr::to_str).unwrap_or_default().to_ascii_lowercase();
        match known.into_iter().find(|(name, _)| *name == ending) {
            Some((_, format)) => Ok(DrawingOutput { path, format }),
            None => {
                let remedy = "end the name in .svg, .png or .csv";
                refuse("--output", &path.to_string_lossy(), "names neither a drawing nor a table", remedy)
            }
        }
    })
}

/// `--png`
pub fn difference() -> impl clap::builder::TypedValueParser<Value = PathBuf> {
    use clap::builder::{OsStringValueParser, TypedValueParser};
    OsStringValueParser::new().try_map(difference_path)
}

/// The path of a PNG image, by its name or the word before a colon; pipes have no ending that could say so.
fn difference_path(text: OsString) -> Result<PathBuf> {
    let path = match ImageOutput::prefixed("--png", &text)? {
        Some(ImageOutput { path, format: Format::Png }) => return Ok(path),
        Some(_) => None,
        None => Some(PathBuf::from(&text)),
    };
    let is_fit = |path: &PathBuf| Format::of(path) == Some(Format::Png) || output::is_stream(path);
    path.filter(is_fit).map_or_else(
        || {
            let remedy = "end the name in .png, or put png: before it";
            refuse("--png", &text.to_string_lossy(), "does not name a PNG image", remedy)
        },
        Ok,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_have_the_format_of_their_name_or_of_the_word_before_it() {
        let parsed = |text: &str| ImageOutput::parse(text.into()).ok().map(|image| (image.path, image.format));
        for (text, path, format) in [
            ("a.exr", "a.exr", Format::Exr),
            ("dir:1/b.PNG", "dir:1/b.PNG", Format::Png),
            ("png:/dev/stdout", "/dev/stdout", Format::Png),
            ("EXR:a.png", "a.png", Format::Exr),
        ] {
            assert_eq!(parsed(text), Some((path.into(), format)), "{text}");
        }
        assert_eq!([".exr", "a", "jpg:a", "/dev/stdout"].map(parsed), [None, None, None, None]);
    }
}
