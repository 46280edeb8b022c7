//! Where the scenes of the paper are.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::scene::document::Override;
use crate::scene::{self, LoadedScene};

/// A folder that holds scenes by their names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scenes {
    root: PathBuf,
    /// Whether somebody named it.
    is_named: bool,
}

/// A scene that every folder of scenes has.
const MARK: &str = "fog-facing/scene.toml";

impl Scenes {
    /// The folder that is named; otherwise `scenes` in the current folder, or in one above the program, where it is if
    /// that was built in the repository.
    pub fn find(named: Option<&Path>) -> Self {
        if let Some(root) = named {
            return Self { root: root.to_path_buf(), is_named: true };
        }
        let program = std::env::current_exe().unwrap_or_default();
        let above = program.ancestors().skip(1).map(|folder| folder.join("scenes"));
        let mut all = core::iter::once(PathBuf::from("scenes")).chain(above);
        let root = all.find(|folder| folder.join(MARK).is_file()).unwrap_or_else(|| "scenes".into());
        Self { root, is_named: false }
    }

    /// The scene called `name` with some keys changed.
    ///
    /// # Errors
    /// If it is not there, or cannot be read.
    pub fn load(&self, name: &str, changes: &[(&str, toml::Value)]) -> Result<LoadedScene> {
        let path = self.root.join(name);
        if !path.join("scene.toml").is_file() {
            let finding = format!("there is no scene {name} in {}", self.root.display());
            let remedy = "name the folder of fogbow's scenes with --scenes DIR; they come with its sources";
            let place = if self.is_named { format!("--scenes {}", self.root.display()) } else { "paper".into() };
            return Err(Error::failure(place, finding, remedy));
        }
        let change = |(key, value): &(&str, toml::Value)| {
            let flag = format!("{key} = {value}");
            Override { key: (*key).into(), value: value.clone(), flag, is_dedicated: false }
        };
        scene::load(&path, changes.iter().map(change).collect())
    }

    /// The folder of the scene called `name`.
    pub fn folder(&self, name: &str) -> PathBuf {
        self.root.join(name)
    }
}
