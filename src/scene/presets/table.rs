//! The presets: numbers, where they come from, and what was done to them.
//!
//! A new one needs a publication, or says plainly that it is an estimate and what that rests on. Numbers have four
//! significant digits at most, so that what `fogbow presets` prints is what is rendered; tests repeat the conversions.

use super::super::schema::{OneOrTwo, Phase, PhaseKind};
use super::Preset;

/// Where reduced scattering and absorption of several presets come from.
macro_rules! jensen {
    ($column:literal) => {
        concat!(
            "H. W. Jensen, S. R. Marschner, M. Levoy, P. Hanrahan, \"A Practical Model for Subsurface Light \
             Transport\", SIGGRAPH 2001, table of Figure 5, ",
            $column
        )
    };
}

/// Where scattering, absorption and mean cosines of several presets come from.
macro_rules! narasimhan {
    ($row:literal) => {
        concat!(
            "S. G. Narasimhan, M. Gupta, C. Donner, R. Ramamoorthi, S. K. Nayar, H. W. Jensen, \"Acquiring Scattering \
             Properties of Participating Media by Dilution\", ACM Transactions on Graphics 25(3) (SIGGRAPH 2006), \
             table of measured media, ",
            $row
        )
    };
}

/// Where the mean cosine of skin comes from.
macro_rules! van_gemert {
    () => {
        "M. J. C. van Gemert, S. L. Jacques, H. J. C. M. Sterenborg, W. M. Star, \"Skin Optics\", IEEE Transactions on \
         Biomedical Engineering 36(12), 1989"
    };
}

const OF_MILK: &str = "sigma_s = sigma_s' / (1 - g), from 1/mm to 1/m; g is the mean over red, green and blue \
                       (0.750, 0.714, 0.681)";
const OF_SKIN: &str = "sigma_s = sigma_s' / (1 - g), from 1/mm to 1/m; g = 0.62 + 0.00029 per nm, at 550 nm";

/// All presets.
pub static PRESETS: [Preset; 8] = [
    Preset {
        name: "milk",
        meaning: "whole milk",
        scattering: [8947.0, 11260.0, 13230.0],
        absorption: [1.1, 2.4, 14.0],
        phase: henyey_greenstein(0.715),
        source: concat!(jensen!("wholemilk"), "; g: ", narasimhan!("regular milk")),
        conversion: OF_MILK,
    },
    Preset {
        name: "skim_milk",
        meaning: "skimmed milk",
        scattering: [2456.0, 4281.0, 6667.0],
        absorption: [1.4, 2.5, 14.2],
        phase: henyey_greenstein(0.715),
        source: concat!(
            jensen!("skimmilk"),
            "; g, measured for regular milk and taken for this one, too: ",
            narasimhan!("regular milk")
        ),
        conversion: OF_MILK,
    },
    Preset {
        name: "sea_water",
        meaning: "clear ocean",
        scattering: [0.0358, 0.0364, 0.0386],
        absorption: [0.289, 0.0638, 0.0156],
        phase: two_lobe([0.924, 0.0], 0.948),
        source: "R. C. Smith, K. S. Baker, \"Optical properties of the clearest natural waters (200-800 nm)\", Applied \
                 Optics 20(2), 1981, table of absorption and molecular scattering of pure sea water; particles: T. J. \
                 Petzold, \"Volume Scattering Functions for Selected Ocean Waters\", SIO Ref. 72-78, Scripps \
                 Institution of Oceanography, 1972, clear ocean (Bahamas), with the mean cosine of his average \
                 particles in C. D. Mobley, \"Light and Water\", Academic Press, 1994",
        conversion: "at 610, 550 and 460 nm, near the dominant wavelengths of the sRGB primaries; particles, grey: the \
                     0.037/m measured at 514 nm less the 0.0025/m of molecules there; the second lobe stands for the \
                     molecules, its share is that at 550 nm",
    },
    Preset {
        name: "skin",
        meaning: "human skin",
        scattering: [3364.0, 4000.0, 4591.0],
        absorption: [32.0, 170.0, 480.0],
        phase: henyey_greenstein(0.78),
        source: concat!(jensen!("skin1"), "; g: ", van_gemert!()),
        conversion: OF_SKIN,
    },
    Preset {
        name: "pale_skin",
        meaning: "paler human skin",
        scattering: [4955.0, 7227.0, 8136.0],
        absorption: [13.0, 70.0, 145.0],
        phase: henyey_greenstein(0.78),
        source: concat!(jensen!("skin2"), "; g: ", van_gemert!()),
        conversion: OF_SKIN,
    },
    Preset {
        name: "wax",
        meaning: "yellowish candle wax; an estimate, not a measurement",
        scattering: [1500.0, 1500.0, 1500.0],
        absorption: [30.0, 100.0, 200.0],
        phase: henyey_greenstein(0.8),
        source: "albedo and g: the candle of the scene \"still life\" in J. Krivanek, I. Georgiev, T. Hachisuka, P. \
                 Vevoda, M. Sik, D. Nowrouzezahrai, W. Jarosz, \"Unifying Points, Beams, and Paths in Volumetric Light \
                 Transport Simulation\", ACM Transactions on Graphics 33(4) (SIGGRAPH 2014), as its authors published \
                 the scene; nothing says that they were measured",
        conversion: "the scene names no unit of length: 1 unit is taken as 1 mm, which makes the transport mean free \
                     path 2 to 3 mm",
    },
    Preset {
        name: "espresso",
        meaning: "espresso coffee",
        scattering: [7783.0, 8130.0, 8539.0],
        absorption: [4798.0, 6575.0, 8849.0],
        phase: henyey_greenstein(0.894),
        source: narasimhan!("espresso"),
        conversion: "measured in water, scaled to the undiluted drink, from 1/mm to 1/m; g is the mean over red, \
                     green and blue (0.907, 0.896, 0.880)",
    },
    Preset {
        name: "apple_juice",
        meaning: "apple juice",
        scattering: [2.57, 3.11, 4.13],
        absorption: [12.96, 23.74, 52.18],
        phase: henyey_greenstein(0.947),
        source: narasimhan!("apple juice"),
        conversion: "measured in water, scaled to the undiluted drink, from 1/mm to 1/m; g is the mean over red, \
                     green and blue (0.947, 0.949, 0.945)",
    },
];

const fn henyey_greenstein(g: f64) -> Phase {
    lobes(PhaseKind::HenyeyGreenstein, OneOrTwo::One(g), None)
}

const fn two_lobe(g: [f64; 2], weight: f64) -> Phase {
    lobes(PhaseKind::TwoLobe, OneOrTwo::Two(g), Some(weight))
}

const fn lobes(kind: PhaseKind, g: OneOrTwo, weight: Option<f64>) -> Phase {
    Phase { kind, g: Some(g), weight, alpha: None, diameter_um: None, file: None }
}
