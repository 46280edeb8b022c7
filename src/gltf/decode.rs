//! PNG and JPEG.

use std::io::Cursor;

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::fault::{Checked, Fault};
use fogbow_kernels::tables::textures::Image;

const STORE_AGAIN: &str = "save the image again as PNG or JPEG";

/// Formats that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Png,
    Jpeg,
}

/// How files of formats begin that some models have, but that are not read: name, offset, bytes.
const OTHERS: [(&str, usize, &[u8]); 8] = [
    ("KTX2", 0, b"\xabKTX 20\xbb"),
    ("WebP", 8, b"WEBP"),
    ("DDS", 0, b"DDS "),
    ("GIF", 0, b"GIF8"),
    ("BMP", 0, b"BM"),
    ("TIFF", 0, b"II*\0"),
    ("TIFF", 0, b"MM\0*"),
    ("AVIF", 4, b"ftyp"),
];

/// The format of an image, by its content: media types and file names are often wrong.
pub fn format(bytes: &[u8]) -> Checked<Format> {
    if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        return Ok(Format::Png);
    }
    if bytes.starts_with(b"\xff\xd8\xff") {
        return Ok(Format::Jpeg);
    }
    let begins = |offset: usize, magic: &[u8]| bytes.get(offset..).is_some_and(|rest| rest.starts_with(magic));
    let finding = match OTHERS.iter().find(|(_, offset, magic)| begins(*offset, magic)) {
        Some((name, ..)) => format!("is in {name} format, which is not supported"),
        None => "is neither PNG nor JPEG".into(),
    };
    Err(Fault::new(finding, STORE_AGAIN))
}

/// Width and height, from the header alone; both > 0.
pub fn size(format: Format, bytes: &[u8]) -> Checked<[u32; 2]> {
    let [width, height] = match format {
        Format::Png => {
            let mut decoder = png_decoder(bytes);
            let header = decoder.read_header_info().map_err(corrupt_png)?;
            [header.width, header.height]
        }
        Format::Jpeg => {
            let mut decoder = jpeg_decoder(bytes);
            decoder.decode_headers().map_err(corrupt_jpeg)?;
            let header = decoder.info().ok_or_else(|| corrupt("JPEG", "it has no header"))?;
            [header.width.into(), header.height.into()]
        }
    };
    if width == 0 || height == 0 {
        return Err(Fault::new(format!("has {width} x {height} texels"), STORE_AGAIN));
    }
    Ok([width, height])
}

/// The image. Alpha and colour profiles are left out, 16 bits become 8.
pub fn image(format: Format, bytes: &[u8]) -> Checked<Image> {
    match format {
        Format::Png => png(bytes),
        Format::Jpeg => jpeg(bytes),
    }
}

fn png_decoder(bytes: &[u8]) -> png::Decoder<Cursor<&[u8]>> {
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder
}

fn png(bytes: &[u8]) -> Checked<Image> {
    let mut reader = png_decoder(bytes).read_info().map_err(corrupt_png)?;
    let size = reader.output_buffer_size().ok_or_else(|| corrupt("PNG", "it is too large"))?;
    let mut buffer = vec![0; size];
    let frame = reader.next_frame(&mut buffer).map_err(corrupt_png)?;
    let channels = &buffer[..frame.buffer_size()];
    let texels = match frame.color_type {
        png::ColorType::Grayscale => channels.iter().map(|grey| [*grey; 3]).collect(),
        png::ColorType::GrayscaleAlpha => channels.as_chunks::<2>().0.iter().map(|[grey, _]| [*grey; 3]).collect(),
        png::ColorType::Rgb => channels.as_chunks::<3>().0.to_vec(),
        png::ColorType::Rgba => channels.as_chunks::<4>().0.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect(),
        png::ColorType::Indexed => return Err(corrupt("PNG", "its palette is missing")),
    };
    whole("PNG", [frame.width, frame.height], texels)
}

fn jpeg_decoder(bytes: &[u8]) -> JpegDecoder<ZCursor<&[u8]>> {
    let largest = usize::from(u16::MAX);
    let options = DecoderOptions::new_safe()
        .set_max_width(largest)
        .set_max_height(largest)
        .set_strict_mode(true)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    JpegDecoder::new_with_options(ZCursor::new(bytes), options)
}

fn jpeg(bytes: &[u8]) -> Checked<Image> {
    let mut decoder = jpeg_decoder(bytes);
    let channels = decoder.decode().map_err(corrupt_jpeg)?;
    let header = decoder.info().ok_or_else(|| corrupt("JPEG", "it has no header"))?;
    whole("JPEG", [header.width.into(), header.height.into()], channels.as_chunks::<3>().0.to_vec())
}

/// The image, if all its texels are there.
fn whole(format: &str, [width, height]: [u32; 2], texels: Vec<[u8; 3]>) -> Checked<Image> {
    if texels.len() as u64 != u64::from(width) * u64::from(height) {
        return Err(corrupt(format, "some of its texels are missing"));
    }
    Ok(Image { width, height, texels })
}

fn corrupt_png(error: png::DecodingError) -> Fault {
    corrupt("PNG", &error.to_string())
}

fn corrupt_jpeg(error: zune_jpeg::errors::DecodeErrors) -> Fault {
    corrupt("JPEG", &format!("{error:?}"))
}

fn corrupt(format: &str, why: &str) -> Fault {
    Fault::new(format!("is a corrupt {format} image: {}", why.trim_matches('"')), STORE_AGAIN)
}
