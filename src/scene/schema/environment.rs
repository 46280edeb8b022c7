//! `[environment]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Spectrum;

/// `[environment]`
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Environment {
    /// Radiance from all directions [W/(m^2 sr)], >= 0. An environment has either a radiance or an image.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radiance: Option<Spectrum>,
    /// An OpenEXR image with channels R, G and B or a Radiance (.hdr) image, relative to this file, whose pixels are
    /// radiances [W/(m^2 sr)] by longitude and latitude: +y at the top, -z in the middle, +x to the right of it. All
    /// directions in a pixel have its radiance: nothing is interpolated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "file"))]
    pub image: Option<String>,
    /// Turn of the image about +y in degrees, -360 to 360, counterclockwise as seen from above. Absent: 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "number"))]
    pub rotation_deg: Option<f64>,
    /// What the pixels of the image are multiplied by, > 0. Absent: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-format" = "number"))]
    pub scale: Option<f64>,
}
