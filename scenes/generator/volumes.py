#!/usr/bin/python3
"""Writes the cloud of scenes/cloud-box and the volumes in tests/data/volumes, the same bytes each time.

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
