//! The table of stages: one function pointer each.

mod joint;

use crate::connect::{bridge, light_sample, light_survey, lis, mvnee, nee, omnee};
use crate::{
    accumulate, extend, features, first_flight, first_surface, flight_hue, flight_weight, generate, glow, light_hit,
    medium_sample, mis_weight, occlusion, outline, passage, phase_quotient, prune, remember, roulette, scatter, sift,
    spectral_weight, surface, transmittance,
};

pub use joint::Joint;

/// Declares the table once: field, name, kernel type, and the module that holds `simd` and `reference`.
macro_rules! pipeline {
    ($( $(#[$doc:meta])* $stage:ident ($Stage:ident) : $Kernel:ty = $simd:path, $reference:path; )*) => {
        /// One kernel per stage.
        #[derive(Clone, Copy)]
        pub struct Pipeline { $( $(#[$doc])* pub $stage: $Kernel, )* }

        /// The name of a stage.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Stage { $( $(#[$doc])* $Stage, )* }

        impl Stage {
            /// Every stage, in the order in which data meets them.
            pub const ALL: &[Self] = &[$( Self::$Stage ),*];

            /// The stage's name in code, flags and statistics.
            pub const fn name(self) -> &'static str {
                match self { $( Self::$Stage => stringify!($stage), )* }
            }
        }

        /// Eight rows at a time, f32.
        pub const SIMD: Pipeline = Pipeline { $( $stage: $simd, )* };

        /// The twins: one row at a time, f64.
        pub const REFERENCE: Pipeline = Pipeline { $( $stage: $reference, )* };

        impl Pipeline {
            /// The same table with one stage replaced by its twin.
            pub fn with_reference(mut self, stage: Stage) -> Self {
                match stage { $( Stage::$Stage => self.$stage = REFERENCE.$stage, )* }
                self
            }
        }
    };
}

pipeline! {
    /// Camera rays for the lanes that are refilled.
    generate (Generate): generate::Kernel = generate::simd::run, generate::reference::run;
    /// Rays through cells of the pixels that outlines of lamps pass through.
    outline (Outline): outline::Kernel = outline::simd::run, outline::reference::run;
    /// The vertices that paths leave go into the trail.
    remember (Remember): remember::Kernel = remember::simd::run, remember::reference::run;
    /// Free flights.
    medium_sample (MediumSample): medium_sample::Kernel = medium_sample::simd::run, medium_sample::reference::run;
    /// What the camera sees first.
    features (Features): features::Kernel = features::simd::run, features::reference::run;
    /// First flights towards the lights.
    first_flight (FirstFlight): first_flight::Kernel = first_flight::simd::run, first_flight::reference::run;
    /// Closest light and closest triangle within the flight.
    extend (Extend): extend::Kernel = extend::simd::run, extend::reference::run;
    /// What media emit along flights reaches their paths.
    glow (Glow): glow::Kernel = glow::simd::run, glow::reference::run;
    /// Hits become candidates, and end paths.
    light_hit (LightHit): light_hit::Kernel = light_hit::simd::run, light_hit::reference::run;
    /// Paths that have come far enough end.
    prune (Prune): prune::Kernel = prune::simd::run, prune::reference::run;
    /// What first flights count that end on a surface.
    first_surface (FirstSurface): first_surface::Kernel = first_surface::simd::run, first_surface::reference::run;
    /// What first flights count goes to the throughput.
    flight_weight (FlightWeight): flight_weight::Kernel = flight_weight::simd::run, flight_weight::reference::run;
    /// What flights say of their channels goes to the throughput.
    spectral_weight (SpectralWeight): spectral_weight::Kernel = spectral_weight::simd::run, spectral_weight::reference::run;
    /// What flights leave out of other channels goes to the throughput.
    flight_hue (FlightHue): flight_hue::Kernel = flight_hue::simd::run, flight_hue::reference::run;
    /// Next vertex and direction.
    scatter (Scatter): scatter::Kernel = scatter::simd::run, scatter::reference::run;
    /// Reflection, for paths that met a surface.
    surface (Surface): surface::Kernel = surface::simd::run, surface::reference::run;
    /// What paths have passed through.
    passage (Passage): passage::Kernel = passage::simd::run, passage::reference::run;
    /// What vertices know of the lights.
    light_survey (LightSurvey): light_survey::Kernel = light_survey::simd::run, light_survey::reference::run;
    /// A light point for every vertex that may connect.
    light_sample (LightSample): light_sample::Kernel = light_sample::simd::run, light_sample::reference::run;
    /// Next event estimation at once, where nothing else connects.
    nee (Nee): nee::in_place::Kernel = nee::in_place::simd::run, nee::in_place::reference::run;
    /// How many vertices each MVNEE connection inserts.
    mvnee_count (MvneeCount): mvnee::sample::CountKernel = mvnee::sample::simd::count, mvnee::sample::reference::count;
    /// Where MVNEE's inserted vertices are.
    mvnee_build (MvneeBuild): mvnee::sample::BuildKernel = mvnee::sample::simd::build, mvnee::sample::reference::build;
    /// Where OMNEE's inserted vertex is.
    omnee_build (OmneeBuild): omnee::sample::BuildKernel = omnee::sample::simd::build, omnee::sample::reference::build;
    /// How many edges each bridge has.
    bridge_count (BridgeCount): bridge::sample::CountKernel = bridge::sample::simd::count, bridge::sample::reference::count;
    /// Where the inserted vertices of bridges are.
    bridge_build (BridgeBuild): bridge::sample::BuildKernel = bridge::sample::simd::build, bridge::sample::reference::build;
    /// A vertex from the light for every connection of light importance sampling.
    lis_vertex (LisVertex): lis::sample::VertexKernel = lis::sample::simd::vertex, lis::sample::reference::vertex;
    /// The light points behind these vertices.
    lis_join (LisJoin): lis::sample::JoinKernel = lis::sample::simd::join, lis::sample::reference::join;
    /// Connections that cannot count are dropped before they are weighed.
    sift (Sift): sift::Kernel = sift::simd::run, sift::reference::run;
    /// One weight per candidate.
    mis_weight (MisWeight): mis_weight::Kernel = mis_weight::simd::run, mis_weight::reference::run;
    /// What turns count by the phase function of the medium that they are in.
    phase_quotient (PhaseQuotient): phase_quotient::Kernel = phase_quotient::simd::run, phase_quotient::reference::run;
    /// Faint connections are dropped before they are traced.
    roulette (Roulette): roulette::Kernel = roulette::simd::run, roulette::reference::run;
    /// Blocked connections count nothing.
    occlusion (Occlusion): occlusion::Kernel = occlusion::simd::run, occlusion::reference::run;
    /// What comes through where nobody knows how much.
    transmittance (Transmittance): transmittance::Kernel = transmittance::simd::run, transmittance::reference::run;
    /// Contributions reach their paths.
    accumulate (Accumulate): accumulate::Kernel = accumulate::simd::run, accumulate::reference::run;
}

/// [`SIMD`] for the widest registers that the processor has: the same bits, and sixteen rows at a time where that pays.
pub const WIDEST: Pipeline = Pipeline {
    medium_sample: medium_sample::simd::run_widest,
    extend: extend::simd::run_widest,
    scatter: scatter::simd::run_widest,
    nee: nee::in_place::simd::run_widest,
    ..SIMD
};

impl core::str::FromStr for Stage {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Self::ALL.iter().copied().find(|stage| stage.name() == name).ok_or_else(|| {
            let names: Vec<_> = Self::ALL.iter().map(|stage| stage.name()).collect();
            format!("there is no stage {name:?}; stages are {}", names.join(", "))
        })
    }
}
