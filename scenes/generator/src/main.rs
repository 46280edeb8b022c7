//! Writes the geometry of every scene, and the sky of one: `cargo run --release -p fogbow-scenes -- [OUTPUT_DIR]`.

use std::error::Error;
use std::path::{Path, PathBuf};

use exr::prelude::{Encoding, Image, Layer, LayerAttributes, SpecificChannels, Vec2, WritableImage, f16};
use fogbow_scenes::{cloud_sky, glb, models};

fn main() -> Result<(), Box<dyn Error>> {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("this crate stands among the scenes");
    let output = std::env::args_os().nth(1).map_or(scenes.to_path_buf(), PathBuf::from);
    for model in models() {
        let folder = output.join(model.name);
        std::fs::create_dir_all(&folder)?;
        let file = folder.join(format!("{}.glb", model.name));
        std::fs::write(&file, glb::encode(&model)?)?;
        println!("{}: {} triangles", file.display(), model.triangles());
    }
    write_sky(&output.join("cloud-sky").join("sky.exr"))
}

/// Half floats do for a sky.
fn write_sky(file: &Path) -> Result<(), Box<dyn Error>> {
    let ([width, height], pixels) = (cloud_sky::SKY_SIZE, cloud_sky::sky());
    let pixel = |at: Vec2<usize>| pixels[at.y() * width + at.x()].map(f16::from_f32).into();
    let channels = SpecificChannels::rgb(pixel);
    let layer = Layer::new((width, height), LayerAttributes::default(), Encoding::SMALL_LOSSLESS, channels);
    Image::from_layer(layer).write().to_file(file)?;
    println!("{}: {width}x{height} pixels", file.display());
    Ok(())
}
