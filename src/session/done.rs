//! Whether a render has been done before: what its image says of it.

use std::path::Path;

use super::Session;
use super::identity::{self, PILOTED};
use super::limits::{End, Limits};
use super::report::LEVELS;
use crate::image::exr::exact;

/// Entries that have to be the same besides those that samples depend on.
const MORE: [&str; 3] = ["adaptive", "region", "cpu_features"];

impl Session {
    /// Whether the EXR image at `path` is that of this render, not begun yet, done until `limits`.
    pub fn is_rendered(&self, path: &Path, limits: Limits) -> bool {
        let Ok(about) = exact::about(path) else { return false };
        let mut own = self.identity();
        own.retain(|(name, _)| !PILOTED.contains(&name.as_str()));
        own.push(("adaptive".into(), self.is_adaptive().to_string()));
        let is_same = |name: &str| identity::text(&about.header, name) == identity::text(&own, name);
        let has = if self.is_adaptive() {
            about.entry(LEVELS).and_then(|levels| levels.parse().ok()).unwrap_or_default()
        } else {
            about.coverage.clone()
        };
        let begins = has.hull().is_some_and(|hull| hull.samples.start == self.settings.first_sample);
        let is_whole = about.entry("ended_by").is_some_and(|end| end != End::Interrupted.to_string());
        let is_asked = about.entry("limits") == Some(limits.to_string().as_str());
        // Exposure and number of samples are in the settings alone.
        identity::difference(&about.header, &own, &MORE).is_none()
            && is_same("settings")
            && begins
            && is_whole
            && is_asked
    }
}
