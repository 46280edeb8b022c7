//! Frames to test with: the scenes of the published evaluation, and variations that visit every branch.

pub mod clouds;
mod crowd;
mod in_place;
mod layers;
mod lights;
pub mod skies;
mod variety;

use std::path::Path;
use std::sync::Arc;

use fogbow::film::aov::Aovs;
use fogbow::frame::Frame;
use fogbow::scene::{self, document::Override};
use fogbow_kernels::connect::Techniques;
use fogbow_kernels::connect::bridge::{Bridge, Roll};
use fogbow_kernels::connect::lis::{Connector, Lis};
use fogbow_kernels::connect::mvnee::{Mvnee, Offset, Seeds};
use fogbow_kernels::media::{Kind, Medium};
use fogbow_kernels::phase::PhaseFunction;
use fogbow_kernels::tables::camera::Camera;
use fogbow_kernels::tables::geometry::{FEW, Geometry};
use fogbow_kernels::tables::lights::{Emitter, Lights, Selection};
use fogbow_kernels::tables::surfaces::{Material, Surfaces};
use fogbow_kernels::{LONGEST_BRIDGED_PATH, MOST_INSERTED, PathLengths, WalkLimits};
use glam::DVec3;

pub use crowd::crowded;
pub use in_place::connected_in_place;
pub use layers::{WALL_ALBEDO, WALL_DISTANCE, in_front_of_a_wall, seen_first, seen_first_in_volumes, with_all_layers};
pub use lights::{focused, swarm, three_lights, two_lights, wall_of_lights, with_cones};
pub use variety::variety;

/// Opening angle whose image plane is 1 x 1 at distance 1.
pub const UNIT_FOV: f64 = 0.927_295_218_001_612_2;

/// The active techniques by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Active {
    /// Path tracing alone.
    Path,
    /// Next event estimation.
    Nee,
    /// Multiple-vertex next event estimation with GGX offsets.
    Mvnee,
    /// The same with Gaussian offsets.
    MvneeGaussian,
    /// The same with GGX offsets and fast seeds, which differ in volumes.
    MvneeFast,
    /// Next event estimation and its multiple-vertex form together.
    Both,
    /// Next event estimation through one vertex, with plain next event estimation for company.
    Omnee,
    /// Aligned bridges.
    Bridge,
    /// Bridges rolled uniformly.
    BridgeUniform,
    /// Everything there is.
    Every,
    /// Light importance sampling, joined by bridges, with its companion.
    Lis,
    /// The same joined by MVNEE.
    LisMvnee,
}

impl Active {
    /// Every combination.
    pub const ALL: [Self; 11] = [
        Self::Path,
        Self::Nee,
        Self::Mvnee,
        Self::MvneeGaussian,
        Self::Both,
        Self::Omnee,
        Self::Bridge,
        Self::BridgeUniform,
        Self::Every,
        Self::Lis,
        Self::LisMvnee,
    ];

    /// The settings for `medium`, paths of at most `longest` segments and at most `mesc` expected segments.
    pub fn techniques(self, medium: &Medium, longest: u32, mesc: f64) -> Techniques {
        let bridge_of = |roll: Roll| Bridge::new(roll, medium, longest);
        let mvnee = match self {
            Self::Mvnee | Self::Both | Self::Every => Some(Mvnee::new(medium, mesc, Offset::Ggx)),
            Self::MvneeGaussian => Some(Mvnee::new(medium, mesc, Offset::Gaussian)),
            Self::MvneeFast => Some(Mvnee { seeds: Seeds::Fast, ..Mvnee::new(medium, mesc, Offset::Ggx) }),
            _ => None,
        };
        let bridge = match self {
            Self::Bridge | Self::Every => Some(bridge_of(Roll::Aligned)),
            Self::BridgeUniform => Some(bridge_of(Roll::Uniform)),
            _ => None,
        };
        let connector = match self {
            Self::Lis | Self::Every => Some(Connector::Bridge(bridge_of(Roll::Aligned))),
            Self::LisMvnee => Some(Connector::Mvnee(Mvnee::new(medium, mesc, Offset::Ggx))),
            _ => None,
        };
        let lis = connector.map(|connector| Lis::new(medium, connector));
        let nee = matches!(self, Self::Nee | Self::Both | Self::Omnee | Self::Every);
        Techniques { nee, mvnee, omnee: matches!(self, Self::Omnee | Self::Every), bridge, lis }
    }
}

/// `frame` with other techniques; MVNEE is limited to `mesc` expected segments, and on long paths all are to what scenes
/// let them insert.
pub fn with_techniques(frame: &Frame, active: Active, mesc: f64) -> Frame {
    let longest = frame.lengths.max;
    let mut techniques = active.techniques(&frame.medium, longest.min(LONGEST_BRIDGED_PATH), mesc);
    if longest > LONGEST_BRIDGED_PATH {
        techniques.limit_inserted(MOST_INSERTED);
    }
    Frame { techniques, ..frame.clone() }
}

/// A phase function of every kind but one lobe of Henyey and Greenstein, by name.
pub fn phase_functions() -> [(&'static str, PhaseFunction); 6] {
    let table = [(-1.0, 0.4), (-0.2, 0.05), (0.5, 0.5), (0.9, 2.0), (1.0, 20.0)];
    [
        ("rayleigh", PhaseFunction::rayleigh()),
        ("two lobes", PhaseFunction::two_lobe([0.9, -0.4], 0.7)),
        ("draine", PhaseFunction::draine(0.6, 3.0)),
        ("droplets of 6 um", PhaseFunction::droplets(6.0)),
        ("droplets of 30 um", PhaseFunction::droplets(30.0)),
        ("table", PhaseFunction::tabulated(&table).expect("a valid table")),
    ]
}

/// `frame` with another phase function; techniques have to be set anew.
pub fn with_phase(frame: &Frame, phase: PhaseFunction) -> Frame {
    with_medium(frame, Medium { phase, ..frame.medium.clone() })
}

/// `frame` in another medium; techniques have to be set anew.
pub fn with_medium(frame: &Frame, medium: Medium) -> Frame {
    Frame { medium, ..frame.clone() }
}

/// `frame` in grey extinction of another density [1/m]; techniques have to be set anew.
pub fn with_extinction(frame: &Frame, extinction: f32) -> Frame {
    let Medium { albedo, phase, .. } = frame.medium.clone();
    with_medium(frame, Medium::homogeneous(extinction, albedo, phase))
}

/// Frames of coloured extinction, by name: fog with three lights, and a room of which one channel is nearly clear.
pub fn coloured(size: [u32; 2]) -> [(&'static str, Frame); 2] {
    let tint = |frame: &Frame, extinction: [f32; 3]| {
        let Medium { albedo, phase, .. } = frame.medium.clone();
        with_medium(frame, Medium::coloured(extinction, albedo, phase))
    };
    let lights = three_lights(0.6, Selection::IntensityDistance, size);
    let room = room(0.5, Selection::IntensityDistance, size);
    [("coloured lights", tint(&lights, [0.3, 0.9, 2.2])), ("coloured room", tint(&room, [1.6, 0.5, 0.05]))]
}

/// `frame` with only paths of `segments` segments.
pub fn with_length(frame: &Frame, segments: u32) -> Frame {
    Frame { lengths: PathLengths { min: segments, max: segments }, ..frame.clone() }
}

/// A path-traced frame without surfaces, of paths of up to `longest` segments.
pub fn plain(camera: Camera, medium: Medium, lights: Lights, longest: u32, seed: u32) -> Frame {
    Frame {
        camera,
        medium,
        lights,
        surfaces: Arc::new(Surfaces::none()),
        techniques: Techniques::default(),
        walk: WalkLimits::ALL,
        aimed: 0.0,
        roulette: 0.0,
        lengths: PathLengths { min: 1, max: longest },
        seed,
        outlines: None,
        aovs: Aovs::default(),
    }
}

/// The fog scenes: a disk at (0, 0, 5) that faces `normal`, seen through fog of mean free path 1/1.7 m, K = 15.
pub fn fog(near: f64, g: f32, normal: DVec3, size: [u32; 2]) -> Frame {
    let medium = Medium::homogeneous(1.7, [1.0; 3], PhaseFunction::henyey_greenstein(g));
    let disk = Emitter::disk(DVec3::new(0.0, 0.0, 5.0), normal, 0.5, [80.0; 3]);
    let camera = Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, UNIT_FOV, near, size);
    let frame = plain(camera, medium, Lights::new(vec![disk], Selection::Uniform), 15, 1);
    with_techniques(&frame, Active::Mvnee, 4.0)
}

/// The fog scene whose light faces the camera.
pub fn fog_facing(near: f64, g: f32, size: [u32; 2]) -> Frame {
    fog(near, g, DVec3::NEG_Z, size)
}

/// A quadrilateral as two triangles whose front sees its corners counterclockwise.
fn quad(corners: [[f32; 3]; 4]) -> [[[f32; 3]; 3]; 2] {
    let [a, b, c, d] = corners;
    [[a, b, c], [a, c, d]]
}

/// Triangles as surfaces, each group with its material.
pub fn surfaces(groups: &[(Material, Vec<[[f32; 3]; 3]>)]) -> Arc<Surfaces> {
    let triangles: Vec<_> = groups.iter().flat_map(|(_, triangles)| triangles.iter().flatten().copied()).collect();
    let corners = (0..triangles.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let material_of = (0..).zip(groups).flat_map(|(i, (_, triangles))| vec![i; triangles.len()]).collect();
    let materials = groups.iter().map(|(material, _)| *material).collect();
    Arc::new(Surfaces::new(Geometry::new(triangles, corners), materials, material_of))
}

/// The walls of a box from -1 to 1, 0 to 2 and 0 to 3, seen from inside, without the one at z = 0: floor, ceiling,
/// left, right, back.
pub fn walls() -> [Vec<[[f32; 3]; 3]>; 5] {
    let wall = |corners: [[f32; 3]; 4]| quad(corners).to_vec();
    [
        wall([[-1.0, 0.0, 0.0], [-1.0, 0.0, 3.0], [1.0, 0.0, 3.0], [1.0, 0.0, 0.0]]),
        wall([[-1.0, 2.0, 0.0], [1.0, 2.0, 0.0], [1.0, 2.0, 3.0], [-1.0, 2.0, 3.0]]),
        wall([[-1.0, 0.0, 0.0], [-1.0, 2.0, 0.0], [-1.0, 2.0, 3.0], [-1.0, 0.0, 3.0]]),
        wall([[1.0, 0.0, 0.0], [1.0, 0.0, 3.0], [1.0, 2.0, 3.0], [1.0, 2.0, 0.0]]),
        wall([[-1.0, 0.0, 3.0], [-1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [1.0, 0.0, 3.0]]),
    ]
}

/// A room of coloured walls in a coloured medium, with a lamp, a spotlight, and two panels in between: one that is the
/// same from both sides, and one with a black back.
pub fn room(g: f32, selection: Selection, size: [u32; 2]) -> Frame {
    let [floor, ceiling, left, right, back] = walls();
    let matte = Material::plain;
    let panel =
        |x: f32, y: f32| quad([[x, y, 1.2], [x + 0.5, y, 1.2], [x + 0.5, y + 0.4, 1.5], [x, y + 0.4, 1.5]]).to_vec();
    let surfaces = surfaces(&[
        (matte([0.7, 0.6, 0.5], false), floor),
        (matte([0.9, 0.9, 0.9], false), ceiling),
        (matte([0.1, 0.8, 0.1], false), left),
        (matte([0.8, 0.1, 0.1], true), right),
        (matte([0.0; 3], false), back),
        (matte([0.5, 0.5, 0.9], true), panel(-0.7, 1.0)),
        (matte([0.9, 0.5, 0.1], false), panel(0.2, 0.6)),
    ]);
    let lights = vec![
        Emitter::disk(DVec3::new(0.1, 1.9, 1.8), DVec3::new(0.1, -1.0, 0.0), 0.3, [10.0, 9.0, 8.0]),
        Emitter::disk(DVec3::new(-0.8, 1.5, 0.4), DVec3::new(1.0, -0.8, 0.9), 0.2, [40.0, 60.0, 90.0]).focused(6.0),
    ];
    let medium = Medium::homogeneous(0.8, [0.95, 0.9, 0.8], PhaseFunction::henyey_greenstein(g));
    let camera = Camera::new(DVec3::new(0.0, 1.0, -1.5), DVec3::Z, DVec3::Y, 1.0, 0.2, size);
    let frame = plain(camera, medium, Lights::new(lights, selection), 7, 5);
    with_techniques(&Frame { surfaces, ..frame }, Active::Every, 3.0)
}

/// The faces of an octahedron, seen from outside.
fn octahedron(center: [f32; 3], radius: f32) -> Vec<[[f32; 3]; 3]> {
    let corner = |axis: usize, side: f32| {
        let mut corner = center;
        corner[axis] += side * radius;
        corner
    };
    let face = |sides: [f32; 3]| {
        let [x, y, z] = [0, 1, 2].map(|axis| corner(axis, sides[axis]));
        if sides[0] * sides[1] * sides[2] > 0.0 { [x, y, z] } else { [x, z, y] }
    };
    let side = |i: u32, axis: u32| if i >> axis & 1 == 0 { 1.0 } else { -1.0 };
    (0..8).map(|i| face([0, 1, 2].map(|axis| side(i, axis)))).collect()
}

/// Those of the triangles of `surfaces`, as emitters of `radiance`.
pub fn shining(surfaces: &Surfaces, triangles: core::ops::Range<u32>, radiance: [f32; 3]) -> Vec<Emitter> {
    let emitter = |i: u32| {
        let double_sided = surfaces.material(i).double_sided;
        Emitter::triangle(surfaces.geometry().corners(i as usize), i, double_sided, radiance)
    };
    triangles.map(emitter).collect()
}

/// A room with a floor in a coloured medium, and what else shines: a sphere, a closed mesh that also reflects, and a
/// panel that shines to both sides; and a disk. `unit` stands for a metre everywhere, in the mean free path too.
pub fn lamps(unit: f64, g: f32, selection: Selection, size: [u32; 2]) -> Frame {
    let [floor, _, left, ..] = walls();
    let panel = quad([[0.2, 0.5, 1.9], [0.8, 0.6, 1.7], [0.8, 1.2, 1.8], [0.2, 1.1, 2.0]]).to_vec();
    let matte = Material::plain;
    let lamp = octahedron([-0.3, 0.7, 1.4], 0.25);
    let groups = [
        (matte([0.7, 0.6, 0.5], false), floor),
        (matte([0.1, 0.8, 0.1], false), left),
        (matte([0.5, 0.5, 0.9], false), lamp),
        (matte([0.8, 0.5, 0.1], true), panel),
    ];
    let scaled = |corner: [f32; 3]| corner.map(|x| (unit * f64::from(x)) as f32);
    let groups = groups.map(|(material, faces)| (material, faces.into_iter().map(|face| face.map(scaled)).collect()));
    let surfaces = surfaces(&groups);
    let meshes = vec![shining(&surfaces, 4..12, [3.0, 2.0, 5.0]), shining(&surfaces, 12..14, [1.0, 4.0, 2.0])];
    let at = |x: f64, y: f64, z: f64| unit * DVec3::new(x, y, z);
    let bodies = vec![
        Emitter::sphere(at(0.4, 1.6, 1.0), 0.2 * unit, [10.0, 9.0, 2.0]),
        Emitter::disk(at(-0.6, 1.9, 1.8), DVec3::new(0.1, -1.0, 0.0), 0.3 * unit, [5.0, 9.0, 8.0]),
    ];
    let extinction = (0.8 / unit) as f32;
    let medium = Medium::homogeneous(extinction, [0.95, 0.9, 0.8], PhaseFunction::henyey_greenstein(g));
    let camera = Camera::new(at(0.0, 1.0, -1.0), DVec3::Z, DVec3::Y, 1.0, 0.1 * unit, size);
    let frame = plain(camera, medium, Lights::with_meshes(bodies, meshes, selection), 7, 9);
    with_techniques(&Frame { surfaces, ..frame }, Active::Every, 3.0)
}

/// The parallelogram from `corner` along two edges, cut into `2 n^2` triangles.
fn cut(corner: DVec3, edges: [DVec3; 2], n: u32) -> Vec<[[f32; 3]; 3]> {
    let at = |i: u32, j: u32| {
        let point = corner + edges[0] * f64::from(i) / f64::from(n) + edges[1] * f64::from(j) / f64::from(n);
        point.as_vec3().to_array()
    };
    let cells = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

/// A floor in fog under a lamp of `2 n^2` triangles, with a small disk beside it.
pub fn panel(n: u32, size: [u32; 2]) -> Frame {
    let medium = Medium::homogeneous(0.6, [0.9; 3], PhaseFunction::henyey_greenstein(0.6));
    let [floor, ..] = walls();
    let lamp = cut(DVec3::new(-0.4, 1.9, 1.0), [0.8 * DVec3::X, DVec3::Z], n);
    let surfaces = surfaces(&[(Material::plain([0.5; 3], false), floor), (Material::plain([0.2; 3], false), lamp)]);
    let mesh = shining(&surfaces, 2..2 + 2 * n * n, [5.0; 3]);
    let camera = Camera::new(DVec3::new(0.0, 1.0, -1.0), DVec3::Z, DVec3::Y, 1.0, 0.0, size);
    let disk = Emitter::disk(DVec3::new(0.8, 1.0, 0.5), -DVec3::X, 0.1, [9.0; 3]);
    let lights = Lights::with_meshes(vec![disk], vec![mesh], Selection::IntensityDistance);
    let frame = plain(camera, medium, lights, 6, 7);
    with_techniques(&Frame { surfaces, ..frame }, Active::Bridge, 3.0)
}

/// A scene that ships, at another size and with other techniques.
pub fn shipped(name: &str, size: [u32; 2], active: Active) -> Frame {
    shipped_with(name, &[format!("film.size=[{}, {}]", size[0], size[1])], active)
}

/// The same with changes of any keys.
pub fn shipped_with(name: &str, changes: &[String], active: Active) -> Frame {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name);
    let changes = changes.iter().map(|change| Override::parse(change).expect("has a =")).collect();
    let frame = scene::load(&folder, changes).unwrap_or_else(|error| panic!("{error}")).frame;
    with_techniques(&Frame { seed: 3 + active as u32, ..frame }, active, 4.0)
}
