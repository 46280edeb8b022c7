//! From radiance to something a screen can show.
//!
//! A fixed curve, as of a film: radiance times two to the power of the exposure, compressed by Reinhard's `L (1 + L /
//! W^2) / (1 + L)` (Reinhard, Stark, Shirley, Ferwerda, Photographic Tone Reproduction for Digital Images, 2002, Eq.
//! 4), then the sRGB transfer function, 8 bits. L is the largest channel and all three are scaled alike, so that bright
//! lights keep their hue; W is always the same, so that a pixel does not depend on the others.

/// Luminance that the middle of an image becomes where nothing else is asked for: middle grey.
const MIDDLE_GREY: f64 = 0.18;
/// Exposed radiance from which on the brightest channel is full: 6.5 stops above middle grey.
const WHITE: f64 = 16.0;
/// Share of the mean luminance below which pixels are taken for background, which nobody exposes for.
const BACKGROUND: f64 = 1e-3;
/// Steps in which exposures are metered, per stop: noise does not show in them, and a person can type them.
const STEPS_PER_STOP: f64 = 10.0;

/// Rec. 709 luminance of linear RGB.
pub fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Exposure in stops (EV): radiance is doubled by each before it is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposure(pub f64);

impl Exposure {
    /// The exposure that makes the log-average luminance of an image middle grey, to a tenth of a stop; pixels a
    /// thousand times darker than the mean do not count. 0 for a black image.
    pub fn metered(pixels: impl Iterator<Item = [f64; 3]> + Clone) -> Self {
        let luminances = pixels.map(luminance).filter(|luminance| *luminance > 0.0 && luminance.is_finite());
        let (sum, count) =
            luminances.clone().fold((0.0, 0.0), |(sum, count), luminance| (sum + luminance, count + 1.0));
        let logs = luminances.filter(|luminance| *luminance >= BACKGROUND * sum / count).map(f64::ln);
        let (sum, count) = logs.fold((0.0, 0.0), |(sum, count), log| (sum + log, count + 1.0));
        if count == 0.0 {
            return Self(0.0);
        }
        let stops = MIDDLE_GREY.log2() - sum / count / core::f64::consts::LN_2;
        Self((STEPS_PER_STOP * stops).round() / STEPS_PER_STOP)
    }

    /// The pixel as sRGB.
    pub fn encode(self, rgb: [f64; 3]) -> [u8; 3] {
        let exposed = rgb.map(|channel| self.0.exp2() * channel.max(0.0));
        let largest = exposed.into_iter().fold(0.0, f64::max);
        let shown = if largest < WHITE { (1.0 + largest / (WHITE * WHITE)) / (1.0 + largest) } else { 1.0 / largest };
        exposed.map(|channel| srgb(shown * channel))
    }
}

impl core::fmt::Display for Exposure {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{:+} EV", self.0)
    }
}

/// The sRGB transfer function (IEC 61966-2-1), rounded to 8 bits; what is not a number is black.
fn srgb(linear: f64) -> u8 {
    let clamped = linear.clamp(0.0, 1.0);
    let encoded = if clamped <= 0.003_130_8 { 12.92 * clamped } else { 1.055 * clamped.powf(1.0 / 2.4) - 0.055 };
    (255.0 * encoded).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_log_average_becomes_middle_grey() {
        let pixels = [[1e-2; 3], [1e-2; 3], [1.0; 3], [1e-2; 3], [0.0; 3], [1e-6; 3]];
        let Exposure(stops) = Exposure::metered(pixels.into_iter());
        let expected = (MIDDLE_GREY / 10.0_f64.powf(-1.5)).log2();
        assert!((stops - expected).abs() <= 0.05 + 1e-12, "{stops} EV, expected {expected}");
        assert_eq!(Exposure::metered(pixels.iter().map(|rgb| rgb.map(|x| 1.01 * x))).0, stops, "noise does not show");
    }

    #[test]
    fn brighter_pixels_are_brighter_up_to_white() {
        let levels: Vec<_> = (0..60).map(|i| Exposure(1.0).encode([3e-5 * 1.3_f64.powi(i); 3])[0]).collect();
        assert!(levels.is_sorted(), "{levels:?}");
        assert_eq!((levels[0], levels[59]), (0, 255));
        assert_eq!(Exposure(-3.0).encode([8.0 * WHITE; 3]), [255; 3]);
        assert!(Exposure(0.0).encode([0.9 * WHITE; 3])[0] < 255);
    }

    #[test]
    fn a_stop_is_a_factor_of_two() {
        for rgb in [[0.1, 0.2, 0.05], [3.0, 0.5, 90.0]] {
            assert_eq!(Exposure(3.0).encode(rgb), Exposure(0.0).encode(rgb.map(|x| 8.0 * x)));
        }
        assert_eq!(Exposure(2.0).to_string(), "+2 EV");
        assert_eq!(Exposure(-1.3).to_string(), "-1.3 EV");
    }

    #[test]
    fn bright_lights_keep_their_hue() {
        // Ratios of the channels, as far as eight bits tell.
        let linear = |byte: u8| {
            let encoded = f64::from(byte) / 255.0;
            if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
        };
        for strength in [0.1, 1.0, 10.0, 1e3, 1e6] {
            let shown = Exposure(0.0).encode([strength, 0.5 * strength, 0.25 * strength]).map(linear);
            assert!((shown[1] / shown[0] - 0.5).abs() < 0.03, "{shown:?} of {strength}");
            assert!((shown[2] / shown[0] - 0.25).abs() < 0.03, "{shown:?} of {strength}");
        }
    }

    #[test]
    fn a_black_image_stays_black() {
        let exposure = Exposure::metered([[0.0; 3]; 4].into_iter());
        assert_eq!((exposure, exposure.encode([0.0; 3])), (Exposure(0.0), [0; 3]));
    }
}
