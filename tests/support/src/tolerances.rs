//! How far a kernel may be from its twin, and why.
//!
//! A kernel computes in f32 (24 bits, half a unit in the last place is 6e-8), the twin in f64 from the same f32
//! columns.

use core::f64::consts::TAU;

use fogbow_kernels::media::Medium;
use fogbow_kernels::phase::PhaseFunction;
use glam::DVec3;

/// Allowed distance of two numbers or vectors: `absolute + relative * size`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Part that does not depend on the size.
    pub absolute: f64,
    /// Part in proportion to the size.
    pub relative: f64,
}

const fn tolerance(absolute: f64, relative: f64) -> Tolerance {
    Tolerance { absolute, relative }
}

/// What is copied must be equal to the bit.
pub const EXACT: Tolerance = tolerance(0.0, 0.0);

/// Free flights: three roundings and a polynomial good to 1.5 units in the last place.
pub const FLIGHT: Tolerance = tolerance(0.0, 4e-7);

/// Tracked flights: sums over the cells that they cross.
pub const TRACKED: Tolerance = tolerance(1e-5, 1e-4);

/// Optical depths of a coarse field, and logarithms of extinctions.
pub const PASSAGE: Tolerance = tolerance(1e-4, 1e-4);

/// Optical depths through known shapes. A ray that grazes a ball by a chord of c diameters magnifies the rounding of its
/// place, 1e-7 diameters, by 1 / c: one ray in ten thousand has c = 0.01.
pub const KNOWN_DEPTH: Tolerance = tolerance(2e-5, 1e-6);

/// Transmittances of known shapes, and quotients of theirs: `exp` of these depths.
pub const KNOWN_SHAPE: Tolerance = tolerance(1e-12, 2e-5);

/// `known` where a medium has a field of which everything is known, otherwise `plain`.
pub fn through(medium: &Medium, known: Tolerance, plain: Tolerance) -> Tolerance {
    if medium.field().is_some_and(|field| field.is_known()) { known } else { plain }
}

/// Estimated transmittances, over what weights take them for.
pub const ESTIMATE: Tolerance = tolerance(1e-4, 2e-3);

/// Emission along flights: sums over points, whose places are good to the rounding of positions in voxels.
pub const GLOW: Tolerance = tolerance(1e-5, 1e-3);

/// Aimed flights: a tangent of an angle up to pi, magnified where it nears its pole.
pub const AIMED_FLIGHT: Tolerance = tolerance(2e-5, 2e-5);

/// Weights of aimed flights: exp of an optical depth, over the densities of all lights.
pub const AIMED_WEIGHT: Tolerance = tolerance(1e-12, 2e-5);

/// Positions: one fused product and sum per component, of numbers of the size of the scene.
pub const POSITION: Tolerance = tolerance(1e-6, 3e-7);

/// The same of points at infinity, which stand for directions: sine and cosine of an azimuth are good to 4e-7.
pub const DISTANT_POSITION: Tolerance = tolerance(1e-6, 2e-6);

/// Directions: the turn's cosine is good to five roundings of a number up to 2, sine and azimuth to about as much.
pub const DIRECTION: Tolerance = tolerance(2e-6, 0.0);

/// What the angle of a turn by this cosine may be off by where the distribution of cosines is inverted by a search or a
/// table: that is good to 5e-7 of all events, as the phase functions' own tests claim. 0 for Henyey-Greenstein, which
/// has a formula.
pub fn turn(phase: &PhaseFunction, cosine: f64) -> f64 {
    if matches!(phase, PhaseFunction::HenyeyGreenstein(_)) {
        return 0.0;
    }
    let off = 5e-7 / (TAU * phase.twin().density(cosine));
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    // Next to a pole a small change of the cosine is a large one of the angle.
    (off / sine.max(1e-12)).min((2.0 * off).sqrt())
}

/// The vertex of a connection of one, at the turn by this cosine, between ends at this distance `[m]`: from a start that is
/// far away, kernel and twin sum what is as large as the distance.
pub fn turned_vertex(phase: &PhaseFunction, cosine: f64, distance: f64) -> Tolerance {
    let Tolerance { absolute, relative } = CHAIN;
    tolerance(absolute + distance * (POSITION.relative + turn(phase, cosine)), relative)
}

/// Lengths of paths so far: one sum.
pub const ARC: Tolerance = tolerance(0.0, 2e-7);

/// Normalisation of the light selection: a sum of quotients.
pub const LIGHT_SUM: Tolerance = tolerance(0.0, 1e-6);

/// Distances to disks: the quotient of two scalar products whose terms cancel where a ray grazes the plane.
pub const DISTANCE: Tolerance = tolerance(1e-5, 1e-5);

/// Distances along the camera's axis: a length times a scalar product of two directions.
pub const DEPTH: Tolerance = tolerance(1e-6, 1e-6);

/// Normals: those of spheres have the rounding of positions, over the radius.
pub const NORMAL: Tolerance = tolerance(2e-5, 0.0);

/// Barycentric weights of a hit: quotients of areas, as a ray that grazes a triangle magnifies their rounding.
pub const BARYCENTRIC: Tolerance = tolerance(2e-5, 0.0);

/// Points of triangles, kept off them by the bound of their rounding, of which kernel and twin have one each.
pub const SURFACE_POSITION: Tolerance = tolerance(2e-6, 1e-6);

/// Perturbed vertices: a GGX offset `sqrt(u / (1 - u))` magnifies the rounding of sums of squares a little.
pub const CHAIN: Tolerance = tolerance(2e-6, 4e-6);

/// Vertices of a bridge, given with its ends `[m]`: rounding of the free walk grows with every turn and is scaled with it.
/// What a turn is off by moves all that follows, and is blown up with the walk if it ends near its beginning.
pub fn bridge_vertex(phase: &PhaseFunction, bridge: &[DVec3]) -> Tolerance {
    let [start, .., point] = bridge else { unreachable!("a bridge has two ends") };
    let distance = start.distance(*point);
    let extent = bridge.iter().map(|vertex| vertex.distance(*start)).fold(0.0, f64::max);
    let turned = bridge.windows(3).map(|v| {
        let cosine = (v[1] - v[0]).normalize_or_zero().dot((v[2] - v[1]).normalize_or_zero());
        turn(phase, cosine) * v[1].distance(*point)
    });
    let blown_up = turned.sum::<f64>() * extent / distance;
    tolerance(2e-6 + 2e-5 * extent + blown_up, 4e-6)
}

/// Resampling weights of bridges: a handful of sharp turns and of mean cosines.
pub const RESAMPLING: Tolerance = tolerance(1e-12, 1e-3);

/// Transmittances of views: `exp` of an f32 whose rounding counts with its size, up to about 20.
pub const TRANSMITTANCE: Tolerance = tolerance(1e-12, 4e-6);

/// Lights seen directly: transmittance, and the profile of a spotlight at a cosine that is good to a few roundings,
/// over what its steepest cone here leaves of them.
pub const VIEW: f64 = 2e-5;

/// Contributions and products of albedos: a handful of factors.
pub const CONTRIBUTION: Tolerance = tolerance(1e-12, 2e-6);

/// Quotients of channels: `exp` of a difference of optical depths, as that of transmittances.
pub const QUOTIENT: Tolerance = tolerance(1e-12, 1e-5);

/// Logarithms of the probabilities of channels: sums of a few optical depths, of which the largest differ.
pub const LOG_POSTERIOR: Tolerance = tolerance(4e-6, 1e-6);

/// Weights of well-conditioned candidates: ratios are products of some 10 factors per inserted vertex, among them
/// differences of projections, which lose digits where an edge stands across the axis. To this comes
/// what the candidate's shortest segment makes of the rounding of positions, see [`weight_conditioning`].
pub const WEIGHT: Tolerance = tolerance(1e-30, 1e-4);

/// Relative error of a weight that follows from positions being f32. Rounding turns a segment of length `shortest`, at
/// `distance` from the origin, by `6e-8 distance / shortest`. A lobe of width 1 - |g| turns that into a relative error
/// of the phase function three times as large over the width, light that arrives at `cos_light` into one over that
/// cosine, as often as its power enters; a candidate may have several such factors. The kernel takes the phase function
/// of a walk's vertex from the directions that were sampled, the twin from the positions, so nothing cancels.
pub fn weight_conditioning(g: f64, distance: f64, shortest: f64, cos_light: f64) -> f64 {
    3.0 * 6e-8 * distance / shortest.max(1e-12) * (1.0 / (1.0 - g.abs()) + 1.0 / cos_light.max(1e-12))
}

/// The same of the profile of a light with the `window` of a cone, `clamp(a cos_light + b, 0, 1)^2`: rounding of
/// positions and of the cosine counts with its slope over what is left at the edge.
pub fn cone_conditioning([a, b]: [f32; 2], distance: f64, shortest: f64, cos_light: f64) -> f64 {
    let fall = f64::from(a) * cos_light + f64::from(b);
    if a == 0.0 || fall >= 1.01 {
        return 0.0;
    }
    let cosine = 3.0 * 6e-8 * (1.0 + distance / shortest.max(1e-12));
    2.0 * (f64::from(a) * cosine + 6e-8 * f64::from(b.abs())) / fall.abs().max(1e-12)
}

/// Where a ray passes the outline of a triangle: 12 units of rounding of the largest coordinates, as derived in
/// `trace::ray`, along each of two axes.
pub const EDGE: Tolerance = tolerance(0.0, 2.0 * 12.0 * 6e-8);

/// Distances along rays over the largest coordinates and over the cosine at which triangles are met: a corner is
/// misplaced by 7 units of rounding along each of two axes, and a mean of three numbers adds a few.
pub const RAY_DISTANCE: Tolerance = tolerance(0.0, 20.0 * 6e-8);

/// Share of random rays in which kernel and twin may decide differently: those that pass an edge within rounding.
pub const DIFFERENT_HITS: f64 = 4e-5;

/// Share of rows in which kernel and twin may decide differently: a ray that grazes the rim of a disk, a seed next to
/// the light, a start at the limit of reach.
pub const DIFFERENT_DECISIONS: f64 = 2e-5;

/// Share of what weighed candidates bring that kernel and twin may find differently where they decided differently.
pub const DISPUTED_WORTH: f64 = 2e-4;

/// Whole paths: share of samples in which rounding may have led to another path. A path of 15 segments makes some 60
/// decisions; with needle-sharp lobes the error of a direction grows at every turn.
pub const DIFFERENT_PATHS: f64 = 2e-3;

/// Whole paths that took the same decisions: what is left of f32 after a few dozen operations per segment.
pub const RADIANCE: Tolerance = tolerance(1e-9, 2e-3);

/// Bytes of a PNG: half a step of rounding, and a little for radiances that were rounded to single precision before
/// they were written elsewhere.
pub const SRGB_BYTE: f64 = 0.51;

/// Radiance under a shining plane: error of the quadrature, measured by a finer one, and what a disk leaves out of a
/// plane.
pub const HALF_SPACE: f64 = 1e-3;

/// Light that was scattered once on its way from a disk: what finer steps along the ray and over the disk change.
pub const SCATTERED_ONCE: f64 = 5e-4;

/// Radiance in [W/(m^2 sr)] of lights of about 1: what the film's sums resolve, 4e-15 of the brightest light, is less.
pub const FAINTEST: f64 = 1e-13;
