//! From radiance to something a screen can show.
//!
//! Photographic tone reproduction (Reinhard, Stark, Shirley, Ferwerda 2002): the log-average luminance becomes middle
//! grey, 0.18, and luminances are compressed by `L (1 + L / W^2) / (1 + L)` (Eq. 4), with W the brightest luminance of the
//! image, which becomes white. Then the sRGB transfer function, 8 bits.

/// Luminance that the log-average becomes.
const MIDDLE_GREY: f64 = 0.18;

/// Rec. 709 luminance of linear RGB.
pub fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// The settings of the curve for one image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToneCurve {
    /// Factor on radiance.
    pub exposure: f64,
    /// Luminance, after exposure, that becomes white.
    pub white: f64,
}

impl ToneCurve {
    /// The curve for the given pixels; black pixels do not count.
    pub fn for_pixels(pixels: impl Iterator<Item = [f64; 3]>) -> Self {
        let (mut logs, mut count, mut brightest) = (0.0, 0_u64, 0.0_f64);
        for luminance in pixels.map(luminance).filter(|luminance| *luminance > 0.0 && luminance.is_finite()) {
            logs += luminance.ln();
            count += 1;
            brightest = brightest.max(luminance);
        }
        if count == 0 {
            return Self { exposure: 1.0, white: 1.0 };
        }
        let exposure = MIDDLE_GREY / (logs / count as f64).exp();
        Self { exposure, white: (exposure * brightest).max(1.0) }
    }

    /// The pixel as sRGB.
    pub fn encode(&self, rgb: [f64; 3]) -> [u8; 3] {
        let light = self.exposure * luminance(rgb).max(0.0);
        let scale = self.exposure * (1.0 + light / (self.white * self.white)) / (1.0 + light);
        rgb.map(|channel| srgb(scale * channel))
    }
}

/// The sRGB transfer function (IEC 61966-2-1), rounded to 8 bits; what is no number is black.
fn srgb(linear: f64) -> u8 {
    let clamped = linear.clamp(0.0, 1.0);
    let encoded = if clamped <= 0.003_130_8 { 12.92 * clamped } else { 1.055 * clamped.powf(1.0 / 2.4) - 0.055 };
    (255.0 * encoded).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_log_average_becomes_middle_grey_and_the_brightest_white() {
        let pixels = [[1e-3; 3], [1e-3; 3], [10.0; 3], [1e-3; 3], [0.0; 3]];
        let curve = ToneCurve::for_pixels(pixels.into_iter());
        assert!((curve.exposure * 1e-2 / MIDDLE_GREY - 1.0).abs() < 1e-12);
        assert_eq!(curve.encode([10.0; 3]), [255; 3]);
        assert_eq!(curve.encode([0.0; 3]), [0; 3]);
        let levels: Vec<_> = (0..50).map(|i| curve.encode([1e-4 * 1.3_f64.powi(i); 3])[0]).collect();
        assert!(levels.is_sorted(), "{levels:?}");
    }

    #[test]
    fn a_black_image_stays_black() {
        let curve = ToneCurve::for_pixels([[0.0; 3]; 4].into_iter());
        assert_eq!(curve.encode([0.0; 3]), [0; 3]);
    }
}
