//! Writes the geometry of every scene: `cargo run --release -p fogbow-scenes -- [OUTPUT_DIR]`.

use std::path::{Path, PathBuf};

use fogbow_scenes::{glb, models};

fn main() -> std::io::Result<()> {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("this crate stands among the scenes");
    let output = std::env::args_os().nth(1).map_or(scenes.to_path_buf(), PathBuf::from);
    for model in models() {
        let folder = output.join(model.name);
        std::fs::create_dir_all(&folder)?;
        let file = folder.join(format!("{}.glb", model.name));
        std::fs::write(&file, glb::encode(&model)?)?;
        println!("{}: {} triangles", file.display(), model.triangles());
    }
    Ok(())
}
