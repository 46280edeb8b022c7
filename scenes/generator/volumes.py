#!/usr/bin/python3
"""Writes the cloud of scenes/cloud-box, the fire of scenes/smoke-fire, the cumulus of scenes/cloud-sky and the volumes
in tests/data/volumes, the same bytes each time.

    apt-get install python3-openvdb python3-numpy
    /usr/bin/python3 scenes/generator/volumes.py [OUTPUT_DIR]

OpenVDB's Python module packs with Blosc and knows floats, vectors and truth values only. What else tests need,
tests/data/volumes/formats.cpp writes.
"""

import hashlib
import pathlib
import sys

import numpy as np
import pyopenvdb as vdb

# Voxels along an edge of the cloud's box, which is 2 m wide and centred on the origin.
CLOUD = 128
# Densities are multiples of one over this: they take less space, and nobody can tell.
STEPS = 64
# Lumps of the cloud: centre and radius in metres. The ground is at small y.
LUMPS = [
    ((0.00, -0.30, 0.00), 0.52),
    ((-0.42, -0.38, 0.12), 0.36),
    ((0.45, -0.36, -0.10), 0.38),
    ((0.12, -0.34, 0.42), 0.34),
    ((-0.10, -0.36, -0.44), 0.33),
    ((0.10, 0.12, -0.05), 0.40),
    ((-0.18, 0.02, 0.16), 0.34),
    ((0.05, 0.42, 0.02), 0.25),
]
# The flat base of the cloud [m].
BASE = -0.62
# How far lumps flow into each other [m].
BLEND = 0.12
# Octaves of noise: the first has this many cells along an edge of the box; depth of the billows [m].
OCTAVES, CELLS, BILLOWS = 5, 5, 0.26
# Distance over which the density rises from 0 to 1 [m].
EDGE = 0.10

# Edge of the fire's voxels [m], how many there are along each axis, and where the first one's corner is [m]. The fire
# burns around x = z = 0, above y = 0; its smoke drifts towards large x.
VOXEL, FIRE, CORNER = 0.03, (112, 144, 72), (-1.08, 0.0, -1.08)
# Height of the flames [m], and their strength from which on they are orange, and yellow.
FLAMES, ORANGE, YELLOW = 2.1, 0.10, 0.35

# Edge of the cumulus's voxels [m], and how many there are along each axis. It stands on y = 0, around x = z = 0.
WISP, CUMULUS = 8.0, (200, 112, 136)
# Its heaps: centre and radius [m].
HEAPS = [
    ((-60.0, 120.0, 0.0), 260.0),
    ((-110.0, 330.0, -30.0), 215.0),
    ((-50.0, 530.0, -10.0), 150.0),
    ((-20.0, 655.0, 10.0), 85.0),
    ((-330.0, 90.0, 60.0), 190.0),
    ((-290.0, 260.0, 30.0), 135.0),
    ((-540.0, 50.0, -20.0), 120.0),
    ((160.0, 100.0, 70.0), 220.0),
    ((200.0, 270.0, 30.0), 160.0),
    ((230.0, 400.0, 20.0), 100.0),
    ((400.0, 70.0, -30.0), 175.0),
    ((420.0, 170.0, 0.0), 105.0),
    ((570.0, 50.0, 40.0), 125.0),
    ((-120.0, 90.0, 230.0), 170.0),
    ((60.0, 80.0, -230.0), 170.0),
]
# How far heaps flow into each other; size and depth of the largest cauliflowers; how fast density rises [m].
MELT, FLORETS, RELIEF, FRINGE = 22.0, 190.0, 95.0, 26.0


def hashed(x, y, z, seed):
    """A number in [0, 1) for every cell."""
    word = (x * 0x8DA6B343 ^ y * 0xD8163841 ^ z * 0xCB1AB31F ^ seed * 0x9E3779B1).astype(np.uint32)
    for shift, factor in ((16, 0x7FEB352D), (15, 0x846CA68B), (16, 1)):
        word = ((word ^ (word >> np.uint32(shift))) * np.uint32(factor)).astype(np.uint32)
    return word.astype(np.float64) / 2.0**32


def noise(position, seed):
    """Smooth noise in [0, 1) with cells of edge 1."""
    cell = np.floor(position).astype(np.int64)
    x, y, z = position - cell
    x, y, z = (t * t * t * (t * (t * 6 - 15) + 10) for t in (x, y, z))
    total = 0.0
    for corner in range(8):
        dx, dy, dz = corner & 1, corner >> 1 & 1, corner >> 2
        weight = (x if dx else 1 - x) * (y if dy else 1 - y) * (z if dz else 1 - z)
        total = total + weight * hashed(cell[0] + dx & 0xFFFF, cell[1] + dy & 0xFFFF, cell[2] + dz & 0xFFFF, seed)
    return total


def billows(position):
    """Round lumps of all sizes, about 0 to 1: octaves of noise, folded in the middle."""
    total, amplitude, sum_of_amplitudes = 0.0, 1.0, 0.0
    for octave in range(OCTAVES):
        scaled = (position + 1.0) * (CELLS / 2.0) * 2.0**octave + 17.31 * octave
        total = total + amplitude * (1.0 - np.abs(2.0 * noise(scaled, octave) - 1.0))
        sum_of_amplitudes += amplitude
        amplitude *= 0.5
    return total / sum_of_amplitudes


def distance(position):
    """Distance [m] to the blended lumps above the base, negative inside."""
    total = 0.0
    for centre, radius in LUMPS:
        centre = np.reshape(np.array(centre), (3, 1, 1, 1))
        total = total + np.exp(-(np.sqrt(((position - centre) ** 2).sum(axis=0)) - radius) / BLEND)
    return np.maximum(-BLEND * np.log(total), BASE - position[1])


def cloud():
    """The densities of the cloud, x, y and z being the axes of the array."""
    centres = (np.arange(CLOUD) + 0.5) * (2.0 / CLOUD) - 1.0
    position = np.stack(np.meshgrid(centres, centres, centres, indexing="ij"))
    depth = BILLOWS * (billows(position) - 0.55) - distance(position)
    density = np.clip(depth / EDGE, 0.0, 1.0)
    # Nothing touches the walls of the box.
    wall = np.clip((1.0 - np.abs(position).max(axis=0)) / EDGE - 0.5, 0.0, 1.0)
    return (np.round(density * wall * STEPS) / STEPS).astype(np.float32)


def turbulence(position, cells, octaves, seed):
    """Octaves of noise, from 0 to 1, of which the first has so many cells in a metre along each axis."""
    total, amplitude, sum_of_amplitudes = 0.0, 1.0, 0.0
    scale = np.reshape(np.array(cells, dtype=float), (3, 1, 1, 1))
    for octave in range(octaves):
        total = total + amplitude * noise(position * scale * 2.0**octave + 31.7, seed + octave)
        sum_of_amplitudes += amplitude
        amplitude *= 0.55
    return total / sum_of_amplitudes


def swirled(position, strength, cells, seed):
    """Positions moved sideways by turbulence."""
    x, y, z = position
    shift = [strength * (2.0 * turbulence(position, cells, 3, seed + 10 * axis) - 1.0) for axis in (0, 1)]
    return np.stack([x + shift[0], y, z + shift[1]])


def rise(low, high, value):
    """From 0 at `low` to 1 at `high`, smoothly."""
    t = np.clip((value - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def flames(position):
    """Strength of the flames: tongues that get thinner and more torn towards their tips."""
    height = position[1] / FLAMES
    x, _, z = swirled(position, 0.62 * np.clip(height, 0.0, 1.2) ** 0.75, (2.0, 1.25, 2.0), 100)
    radius = 0.46 * np.clip(1.0 - 0.66 * height, 0.16, 1.0)
    torn = turbulence(np.stack([x, position[1], z]), (6.0, 1.7, 6.0), 4, 140)
    inside = 1.0 - np.hypot(x, z) / radius
    strength = np.clip(0.75 * inside + 2.9 * (torn - 0.5) - 0.55 * height + 0.10, 0.0, 1.0)
    return strength**1.5 * rise(0.0, 0.03, height) * (1.0 - rise(0.85, 1.15, height))


def smoke(position):
    """Density of the smoke: a plume that widens, billows and leans with the wind."""
    x, y, z = position
    above = np.maximum(y - 0.75, 0.0)
    lean = 0.12 * above**1.55
    x, _, z = swirled(np.stack([x - lean, y, z]), 0.16 + 0.13 * above, (1.5, 1.1, 1.5), 200)
    radius = 0.20 + 0.21 * above
    billow = 1.0 - np.abs(2.0 * turbulence(np.stack([x, y, z]), (2.6, 2.2, 2.6), 5, 240) - 1.0)
    depth = 1.0 - np.hypot(x, z) / radius + 1.5 * (billow - 0.62)
    return rise(0.0, 0.8, depth) * rise(0.75, 1.5, y) * (1.0 - 0.45 * rise(1.5, 4.3, y))


def fire():
    """Densities of smoke and flames, and of the parts of the flames that are orange and yellow."""
    axes = [corner + (np.arange(count) + 0.5) * VOXEL for corner, count in zip(CORNER, FIRE)]
    position = np.stack(np.meshgrid(*axes, indexing="ij"))
    steps = lambda values: (np.round(values * STEPS) / STEPS).astype(np.float32)
    # Nothing touches the walls of the box.
    far = np.array(CORNER) + np.array(FIRE) * VOXEL
    wall = np.ones(FIRE)
    for axis in range(3):
        wall *= rise(0.0, 0.25, far[axis] - position[axis])
        wall *= rise(0.0, 0.25, position[axis] - CORNER[axis]) if axis != 1 else 1.0
    flame = steps(flames(position) * wall)
    parts = [np.where(flame >= strength, flame, 0.0).astype(np.float32) for strength in (ORANGE, YELLOW)]
    return {"density": steps(smoke(position) * wall), "flame": flame, "orange": parts[0], "yellow": parts[1]}


def cauliflower(position):
    """Round lumps on round lumps, 0 to 1: octaves of noise, creased where lumps meet."""
    total, amplitude, sum_of_amplitudes = 0.0, 1.0, 0.0
    for octave in range(4):
        # Turned from octave to octave, so that no cells show.
        x, y, z = position / FLORETS * 2.1**octave + 57.3 + 11.7 * octave
        turned = np.stack([0.8 * x - 0.6 * z, 0.6 * (0.6 * x + 0.8 * z) + 0.8 * y, 0.8 * (0.6 * x + 0.8 * z) - 0.6 * y])
        total = total + amplitude * np.abs(2.0 * noise(turned, 300 + octave) - 1.0) ** 0.8
        sum_of_amplitudes += amplitude
        amplitude *= 0.55
    return total / sum_of_amplitudes


def cumulus():
    """The densities of a cumulus: heaps with cauliflowers above a flat base."""
    axes = [(np.arange(count) + 0.5) * WISP for count in CUMULUS]
    axes = [axes[0] - CUMULUS[0] * WISP / 2.0, axes[1] - 60.0, axes[2] - CUMULUS[2] * WISP / 2.0]
    position = np.stack(np.meshgrid(*axes, indexing="ij"))
    total = 0.0
    for centre, radius in HEAPS:
        centre = np.reshape(np.array(centre), (3, 1, 1, 1))
        total = total + np.exp(-(np.sqrt(((position - centre) ** 2).sum(axis=0)) - radius) / MELT)
    height = position[1]
    lumps = cauliflower(position) - 0.33
    # The base is nearly flat, and the lumps grow from it.
    depth = MELT * np.log(total) + 2.0 * RELIEF * lumps * (0.35 + 0.65 * rise(0.0, 180.0, height))
    base = np.clip((height + 45.0 * lumps) / (2.5 * FRINGE), 0.0, 1.0)
    density = np.clip(depth / FRINGE, 0.0, 1.0) * base
    wall = 1.0
    for axis, low, high in ((0, 8.0, 40.0), (1, 8.0, 24.0), (2, 8.0, 40.0)):
        wall = wall * rise(low, high, position[axis] - axes[axis][0]) * rise(low, high, axes[axis][-1] - position[axis])
    return (np.round(density * wall * 16.0) / 16.0).astype(np.float32)


def blob():
    """A Gaussian of 24^3 voxels in steps of 1/256; what is less is 0."""
    axis = np.arange(24) - 11.5
    squares = axis[:, None, None] ** 2 + axis[None, :, None] ** 2 + axis[None, None, :] ** 2
    return (np.floor(256.0 * np.exp(squares / -32.0)) / 256.0).astype(np.float32)


def grid(name, values=None, origin=(0, 0, 0), fog=True):
    """A grid of floats, with the array `values` from voxel `origin` on."""
    new = vdb.FloatGrid()
    new.name = name
    if fog:
        new.gridClass = "fog volume"
    if values is not None:
        new.copyFromArray(values, ijk=origin)
    return new


def write(path, *grids):
    """Writes a file. OpenVDB gives it an identifier at random; here it follows from the content."""
    path.parent.mkdir(parents=True, exist_ok=True)
    vdb.write(str(path), list(grids))
    data = bytearray(path.read_bytes())
    name = hashlib.sha256(data[:21] + data[57:]).hexdigest()
    data[21:57] = "-".join((name[:8], name[8:12], name[12:16], name[16:20], name[20:32])).encode()
    path.write_bytes(data)
    print(f"{path}: {len(data)} bytes")


def scenes(folder):
    density = grid("density", cloud())
    density.transform = vdb.createLinearTransform(2.0 / CLOUD)
    density.transform.translate((1.0 / CLOUD - 1.0,) * 3)
    write(folder / "cloud-box" / "cloud.vdb", density)

    grids = [grid(name, values) for name, values in fire().items()]
    for new in grids:
        new.transform = vdb.createLinearTransform(VOXEL)
        new.transform.translate([corner + VOXEL / 2.0 for corner in CORNER])
        new.saveFloatAsHalf = True
    write(folder / "smoke-fire" / "fire.vdb", *grids)

    heaps = grid("density", cumulus())
    heaps.transform = vdb.createLinearTransform(WISP)
    heaps.transform.translate((-(CUMULUS[0] - 1) * WISP / 2.0, WISP / 2.0 - 60.0, -(CUMULUS[2] - 1) * WISP / 2.0))
    heaps.saveFloatAsHalf = True
    write(folder / "cloud-sky" / "cumulus.vdb", heaps)


def tests(folder):
    write(folder / "block.vdb", grid("density", np.full((16, 16, 16), 0.5, np.float32), (4, -4, 100)))

    placed = grid("density", blob(), (-3, 0, 40))
    placed.transform = vdb.createLinearTransform(0.25)
    placed.transform.translate((1.0, 2.0, 3.0))
    write(folder / "blob.vdb", placed)

    heat = grid("heat", np.full((3, 3, 3), 2.0, np.float32), fog=False)
    heat.transform = vdb.createLinearTransform([[0, 2, 0, 0], [-3, 0, 0, 0], [1, 0, 4, 0], [5, 6, 7, 1]])
    write(folder / "two.vdb", heat, placed)

    half = grid("density", blob())
    half.fill((128, 0, 0), (135, 7, 7), 0.3)
    half.saveFloatAsHalf = True
    write(folder / "half.vdb", half)

    tiles = grid("density")
    tiles.fill((-128, 0, 0), (-1, 127, 127), 0.5)
    tiles.fill((0, 0, 0), (15, 7, 9), 0.25)
    write(folder / "tiles.vdb", tiles)

    velocity = vdb.Vec3SGrid()
    velocity.name = "velocity"
    velocity.fill((0, 0, 0), (3, 3, 3), (1, 2, 3))
    mask = vdb.BoolGrid()
    mask.name = "mask"
    mask.fill((0, 0, 0), (3, 3, 3), True)
    sphere = vdb.createLevelSetSphere(radius=0.6, voxelSize=0.2)
    sphere.name = "sphere"
    write(folder / "others.vdb", velocity, mask, sphere)


def main():
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2]
    scenes(root / "scenes")
    tests(root / "tests" / "data" / "volumes")


if __name__ == "__main__":
    main()
