//! Images that are not images, or only parts of some.

use serde_json::json;

use super::super::support::{everything, rgb};
use super::super::textures::{JPEGS, jpeg};

/// What is said about an image with these bytes.
fn image_error(bytes: &[u8]) -> String {
    let mut file = everything();
    let view = file.view(bytes);
    file.json["images"][0] = json!({ "bufferView": view, "mimeType": "image/png", "name": "rust" });
    file.error()
}

#[test]
fn images() {
    let png = rgb(8, 8, &[[1, 2, 3]; 64]);
    let baseline = jpeg(JPEGS[0].0);
    let progressive = jpeg(JPEGS[1].0);
    let mut flipped = png.clone();
    flipped[45] ^= 0x40;
    let cases: [(&[u8], &str); 12] = [
        (b"", "is neither PNG nor JPEG\n"),
        (b"solid", "is neither PNG nor JPEG\n"),
        (b"\xabKTX 20\xbb\r\n\x1a\n", "is in KTX2 format, which is not supported\n"),
        (b"RIFF\x10\0\0\0WEBPVP8 ", "is in WebP format, which is not supported\n"),
        (b"GIF89a", "is in GIF format, which is not supported\n"),
        (&png[..8], "is a corrupt PNG image: "),
        (&png[..60], "is a corrupt PNG image: "),
        (&flipped, "is a corrupt PNG image: "),
        (&baseline[..3], "is a corrupt JPEG image: "),
        (&baseline[..100], "is a corrupt JPEG image: "),
        (&baseline[..baseline.len() - 6], "is a corrupt JPEG image: "),
        (&progressive[..300], "is a corrupt JPEG image: "),
    ];
    for (bytes, expected) in cases {
        let error = image_error(bytes);
        let expected = format!("error: test.glb: image 0 \"rust\": {expected}");
        assert!(error.starts_with(&expected) && error.contains("\n  help: "), "{error}\nexpected {expected}");
    }
}

/// A PNG file that says it has this size, with a right checksum.
fn png_that_claims(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = rgb(1, 1, &[[0; 3]]);
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    let checksum = checksum(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&checksum.to_be_bytes());
    bytes
}

/// CRC-32, bit by bit.
fn checksum(bytes: &[u8]) -> u32 {
    let step = |crc: u32| (crc >> 1) ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 };
    !bytes.iter().fold(u32::MAX, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |crc, _| step(crc)))
}

#[test]
fn images_that_claim_to_be_huge() {
    let error = image_error(&png_that_claims(1 << 30, 1 << 30));
    assert!(
        error.starts_with("error: test.glb: image 0 \"rust\", 1073741824 x 1073741824: brings the texels"),
        "{error}"
    );
    let error = image_error(&png_that_claims(8000, 8000));
    assert!(error.starts_with("error: test.glb: image 0 \"rust\": is a corrupt PNG image: "), "{error}");
    let mut large = jpeg(JPEGS[2].0);
    let start_of_frame = large.windows(2).position(|marker| marker == [0xff, 0xc0]).expect("a marker");
    large[start_of_frame + 5..start_of_frame + 9].fill(0xff);
    let error = image_error(&large);
    assert!(error.contains("image 0 \"rust\", 65535 x 65535: brings the texels of all images to"), "{error}");
}
