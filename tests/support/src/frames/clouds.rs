//! Frames with grids of densities.

use fogbow::scene::LoadedScene;
use fogbow_kernels::media::closed_mesh::ClosedMesh;
use fogbow_kernels::media::field::{Field, Interpolation, Leaf, Shape, ToIndex, Volume, Voxels};

use super::*;

/// The middle of a white ball of this `radius` in mean free paths of a metre, under a sky of radiance 1, in `side` x `side`
/// pixels: every pixel is 1, by paths of about as many segments as the square of the radius.
///
/// # Panics
/// If that is no scene.
pub fn white_ball(radius: f64, side: u32) -> LoadedScene {
    let text = format!(
        r#"
        camera = {{ position = [0, 0, 0], look_at = [0, 0, 1], vertical_fov_deg = 50 }}
        film = {{ size = [{side}, {side}] }}
        environment = {{ radiance = 1 }}

        [[volume]]
        shape = {{ type = "sphere", center = [0, 0, 0], radius = {radius:?} }}
        scattering = 1
        "#
    );
    scene::parse("ball.toml", &text).unwrap_or_else(|error| panic!("{error}"))
}

/// The leaves of a cube of `side` leaves, of densities at index coordinates.
pub fn leaves(side: i32, density: impl Fn([i32; 3]) -> f32) -> Vec<Leaf> {
    let places = (0..side).flat_map(|z| (0..side).flat_map(move |y| (0..side).map(move |x| [x, y, z])));
    let leaf = |place: [i32; 3]| {
        let origin = place.map(|component| 8 * component);
        let voxel = |i: usize| density([0, 1, 2].map(|axis| origin[axis] + (i >> (3 * axis) & 7) as i32));
        Leaf { origin, values: Arc::new(core::array::from_fn(voxel)) }
    };
    places.map(leaf).collect()
}

/// The map to index coordinates of a cube of `voxels` along each edge, of `size` `[m]`, about `center` `[m]`.
pub fn centred(voxels: i32, size: f64, center: DVec3) -> ToIndex {
    let scale = f64::from(voxels) / size;
    let row = |axis: usize| {
        let mut row = [0.0; 4];
        row[axis] = scale;
        row[3] = f64::from(voxels) / 2.0 - 0.5 - scale * center[axis];
        row
    };
    [row(0), row(1), row(2)]
}

/// A lumpy cloud in 24^3 voxels, with holes, and nothing towards the border.
pub fn lumps(place: [i32; 3]) -> f32 {
    let at = place.map(|component| (f64::from(component) - 11.5) / 11.5);
    let fade = (1.0 - at.map(|x| x * x).iter().sum::<f64>()).max(0.0);
    let waves = (7.0 * at[0]).sin() * (5.0 * at[1] + 1.0).sin() * (6.0 * at[2] - 0.5).sin();
    (fade * (0.3 + waves).max(0.0)) as f32
}

/// [`lumps`] in a cube of `size` about `center` `[m]`, with this extinction where they are densest [1/m].
pub fn cloud(size: f64, center: DVec3, extinction: f32, interpolation: Interpolation) -> Field {
    Field::grid(Voxels::new(&leaves(3, lumps), &centred(24, size, center), interpolation), extinction)
}

/// `frame` with the medium's extinction in a grid.
pub fn with_field(frame: &Frame, grid: Field) -> Frame {
    let medium = Medium { kind: Kind::Field(Arc::new(grid)), ..frame.medium.clone() };
    with_medium(frame, medium)
}

/// A cloud among lights in the open, and one in a room; techniques have to be set anew.
pub fn clouds(size: [u32; 2]) -> [(&'static str, Frame); 2] {
    let lights = three_lights(0.6, Selection::IntensityDistance, size);
    let room = room(0.5, Selection::IntensityDistance, size);
    let open = cloud(4.0, DVec3::new(0.1, 0.0, 1.6), 9.0, Interpolation::Trilinear).with_cells(3, 1.0, 1.0);
    let indoors = cloud(2.2, DVec3::new(0.0, 1.0, 1.4), 12.0, Interpolation::Nearest);
    [("cloud among lights", with_field(&lights, open)), ("cloud in a room", with_field(&room, indoors))]
}

/// A volume without voxels.
pub fn solid(shape: Shape, extinction: f32) -> Volume {
    Volume { shape: Some(shape), voxels: None, extinction }
}

/// A ball of this `extinction` [1/m].
pub fn ball(center: DVec3, radius: f64, extinction: f32) -> Volume {
    solid(Shape::Sphere { center, radius }, extinction)
}

/// A closed mesh of eight triangles, with its corners at this distance from its centre along the axes `[m]`.
pub fn octahedron(center: DVec3, radius: f64) -> Shape {
    let triangles = (0..8).map(|octant: u32| {
        let side = |axis: usize| if octant >> axis & 1 == 0 { radius } else { -radius };
        let corner = |axis: usize| (center + DVec3::AXES[axis] * side(axis)).as_vec3().to_array();
        // An odd number of reflections turns triangles inside out.
        let order = if octant.count_ones().is_multiple_of(2) { [0, 1, 2] } else { [0, 2, 1] };
        order.map(corner)
    });
    let mesh = ClosedMesh::new(&triangles.collect::<Vec<_>>()).expect("a closed mesh");
    Shape::Mesh(Arc::new(mesh))
}

/// The cloud of [`cloud`] as one of several volumes.
fn lumpy(size: f64, center: DVec3, extinction: f32) -> Volume {
    let voxels = Voxels::new(&leaves(3, lumps), &centred(24, size, center), Interpolation::Trilinear);
    Volume { shape: None, voxels: Some(voxels), extinction }
}

/// `frame` with a medium of these volumes, the first of which hide those behind, in fog.
pub fn with_volumes(frame: &Frame, volumes: Vec<Volume>, around: f32) -> Frame {
    with_field(frame, Field::new(volumes, around))
}

/// Volumes that overlap in fog among lights, a mesh and a hole of vacuum among them, each of an albedo of its own; a dense
/// ball in a hall of fog; a coloured ball in a room, and a coloured cloud; volumes that differ in colour; techniques have
/// to be set anew.
pub fn volumes(size: [u32; 2]) -> [(&'static str, Frame); 7] {
    let lights = three_lights(0.6, Selection::IntensityDistance, size);
    let room = room(0.5, Selection::IntensityDistance, size);
    let several = vec![
        solid(Shape::block([[-0.4, -0.3, 0.6], [0.2, 0.5, 1.1]]), 0.0),
        ball(DVec3::new(0.2, 0.1, 1.4), 0.7, 2.5),
        solid(octahedron(DVec3::new(-0.45, -0.2, 1.55), 0.9), 1.2),
        lumpy(3.0, DVec3::new(0.5, 0.3, 1.8), 8.0),
    ];
    let mut several = with_volumes(&lights, several, 0.25);
    // The blocks of the hall are larger than the ball.
    let hall = solid(Shape::block([[-30.0, -28.0, -31.0], [29.0, 30.0, 30.0]]), 0.25);
    let hall = with_volumes(&lights, vec![ball(DVec3::new(0.15, 0.1, 1.3), 0.2, 15.0), hall], 0.0);
    let albedos = [[0.9; 3], [0.0; 3], [1.0, 0.9, 0.8], [0.6; 3], [0.95, 0.97, 1.0]];
    let medium = several.medium.clone().with_albedos(&albedos);
    several = with_medium(&several, medium);
    let coloured = Field::new(vec![ball(DVec3::new(0.0, 1.0, 1.4), 0.8, 3.0)], 0.0).coloured([0.3, 0.55, 1.0]);
    let cloud = cloud(4.0, DVec3::new(0.1, 0.0, 1.6), 9.0, Interpolation::Trilinear).coloured([1.0, 0.5, 0.2]);
    let [in_the_open, in_a_room] = colours(size);
    [
        ("volumes in fog", several),
        ("dense ball in a hall of fog", hall),
        ("coloured ball in a room", with_field(&room, coloured)),
        ("coloured cloud among lights", with_field(&lights, cloud)),
        ("phase functions in a room", turning(&room)),
        (in_the_open.name, in_the_open.frame),
        (in_a_room.name, in_a_room.frame),
    ]
}

/// Volumes, and what is around them, that differ in the colour of their extinction.
pub struct Colours {
    /// What this is called.
    pub name: &'static str,
    /// A frame with them.
    pub frame: Frame,
    volumes: Vec<Volume>,
    hues: Vec<[f32; 3]>,
    around: [f32; 3],
}

impl Colours {
    fn new(name: &'static str, base: &Frame, volumes: Vec<Volume>, hues: &[[f32; 3]], around: [f32; 3]) -> Self {
        let frame = with_field(base, Field::of_colours(volumes.clone(), hues, around));
        Self { name, frame, volumes, hues: hues.to_vec(), around }
    }

    fn with_albedos(mut self, albedos: &[[f32; 3]]) -> Self {
        self.frame = with_medium(&self.frame, self.frame.medium.clone().with_albedos(albedos));
        self
    }

    /// The frame in grey extinction: that of one channel.
    pub fn grey(&self, channel: usize) -> Frame {
        let volumes = self.volumes.iter().zip(&self.hues);
        let of_channel = |(volume, hues): (&Volume, &[f32; 3])| {
            let extinction = volume.extinction * hues[channel];
            Volume { extinction, ..volume.clone() }
        };
        with_volumes(&self.frame, volumes.map(of_channel).collect(), self.around[channel])
    }
}

/// A block and a ball, of which every channel is clear in one, a lumpy cloud and haze in the open; and a block in haze in
/// a room, the optical depth through which is known in every channel.
pub fn colours(size: [u32; 2]) -> [Colours; 2] {
    let volumes = vec![
        solid(Shape::block([[-0.4, -0.3, 0.6], [0.2, 0.5, 1.1]]), 1.5),
        ball(DVec3::new(0.2, 0.1, 1.4), 0.7, 2.5),
        lumpy(3.0, DVec3::new(0.5, 0.3, 1.8), 8.0),
    ];
    let hues = [[1.0, 0.0, 0.0], [0.0, 0.4, 1.0], [1.0; 3]];
    let lights = three_lights(0.6, Selection::IntensityDistance, size);
    let several = Colours::new("volumes of several colours in haze", &lights, volumes, &hues, [0.1, 0.2, 0.4]);
    let block = vec![solid(Shape::block([[-0.6, 0.2, 0.6], [0.5, 1.3, 2.0]]), 1.0)];
    let room = room(0.5, Selection::IntensityDistance, size);
    [
        several.with_albedos(&[[0.9; 3], [0.8, 0.9, 0.0], [1.0, 0.9, 0.8], [0.9, 0.95, 1.0]]),
        Colours::new("coloured block in other haze in a room", &room, block, &[[2.5, 0.8, 0.2]], [0.05, 0.1, 0.6]),
    ]
}

/// A ball, a box and fog around them in a room, each of a phase function of its own.
fn turning(room: &Frame) -> Frame {
    let volumes =
        vec![ball(DVec3::new(0.0, 1.0, 1.4), 0.5, 3.0), solid(Shape::block([[-0.6, 0.2, 0.6], [0.5, 1.3, 2.0]]), 1.5)];
    let frame = with_volumes(room, volumes, 0.3);
    let phases = [-0.4, 0.85, 0.2].map(PhaseFunction::henyey_greenstein);
    with_medium(&frame, frame.medium.clone().with_phases(&phases))
}

/// The sets of techniques that grids have.
pub const IN_FIELDS: [Active; 11] = [
    Active::Path,
    Active::Nee,
    Active::Mvnee,
    Active::MvneeGaussian,
    Active::MvneeFast,
    Active::Both,
    Active::Omnee,
    Active::Bridge,
    Active::BridgeUniform,
    Active::Lis,
    Active::LisMvnee,
];
