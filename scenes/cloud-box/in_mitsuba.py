#!/usr/bin/env python3
"""The same scene in Mitsuba 3, with the same numbers in its grid: image mean and standard error, and samples per second.

Usage: in_mitsuba.py [SAMPLES]        (from any folder; 512 samples per pixel at 128 x 128 if nothing is asked for)

Needs mitsuba, numpy and the Python module of OpenVDB (openvdb or pyopenvdb)."""

import math
import pathlib
import sys
import time

import mitsuba as mi
import numpy as np

try:
    import openvdb as vdb
except ImportError:
    import pyopenvdb as vdb

mi.set_variant("llvm_ad_rgb")
HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from mitsuba_objects import mesh, objects
SIZE, BATCH = 128, 32
SCALE_BY, TRANSLATE = 2.2, np.array([2.78, 2.5, 2.79])


def cloud():
    """Extinction on a dense grid, and the box of its voxels: Mitsuba counts from their faces, OpenVDB from their centres."""
    grid = vdb.read(str(HERE / "cloud.vdb"), "density")
    low, high = (np.array(corner) for corner in grid.evalActiveVoxelBoundingBox())
    low, high = low - 1, high + 1
    dense = np.zeros(high - low + 1, dtype=np.float32)
    grid.copyToArray(dense, ijk=tuple(int(x) for x in low))
    corners = [np.array(grid.transform.indexToWorld(tuple(index))) for index in (low - 0.5, high + 0.5)]
    corners = [SCALE_BY * corner + TRANSLATE for corner in corners]
    t = mi.ScalarTransform4f
    # Mitsuba's unit cube, and its cube shape from -1 to 1.
    box = t().translate(list(corners[0])) @ t().scale(list(corners[1] - corners[0]))
    values = np.ascontiguousarray(dense.transpose(2, 1, 0))[..., None]
    return values, box, box @ t().translate([0.5] * 3) @ t().scale(0.5)


def walls():
    for name, corners, triangles, made_of in objects(HERE.parent / "cornell-fog" / "cornell-fog.glb"):
        yield name.replace(".", " "), mesh(name, corners, triangles, **made_of)


def scene():
    values, box, cube = cloud()
    t = mi.ScalarTransform4f
    light = t().look_at([2.78, 5.48, 2.79], [2.78, 4.48, 2.79], [0, 0, 1]) @ t().scale(0.8)
    medium = {
        "type": "heterogeneous",
        "albedo": {"type": "constvolume", "value": 0.8},
        "sigma_t": {"type": "gridvolume", "grid": mi.VolumeGrid(values), "to_world": box},
        "scale": 5.0,
        "phase": {"type": "hg", "g": 0.9},
    }
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}, "pixel_format": "rgb"}
    return mi.load_dict({
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": 25, "rr_depth": 100000},
        "sensor": {
            "type": "perspective", "near_clip": 1.0, "fov": 53.13010235, "fov_axis": "y",
            "to_world": t().look_at([2.78, 2.73, -4], [2.78, 2.73, 0], [0, 1, 0]),
            "film": film | {"component_format": "float32"}, "sampler": {"type": "independent"},
        },
        "cloud": {"type": "cube", "to_world": cube, "bsdf": {"type": "null"}, "interior": medium},
        "light": {
            "type": "disk", "to_world": light,
            "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}},
            "emitter": {"type": "area", "radiance": {"type": "rgb", "value": 40.0}},
        },
        **dict(walls()),
    })


def main():
    samples = int(sys.argv[1]) if len(sys.argv) > 1 else 512
    built = scene()
    mi.render(built, spp=BATCH, seed=99999).numpy()
    start = time.time()
    images = [mi.render(built, spp=BATCH, seed=seed).numpy() for seed in range(max(2, samples // BATCH))]
    rate = len(images) * BATCH * SIZE**2 / (time.time() - start)
    images = np.stack(images).astype(np.float64)[..., :3]
    mean, error = images.mean((0, 1, 2)), images.mean((1, 2)).std(0, ddof=1) / math.sqrt(len(images))
    variance = images.var(0, ddof=1).mean((0, 1)) * BATCH
    print("mean    ", *(f"{m:.5f} +- {e:.5f}" for m, e in zip(mean, error)))
    print(f"variance {variance[1]:.2f} per sample, {rate / 1e3:.0f} k samples/s, efficiency {rate / variance[1]:.0f}")


if __name__ == "__main__":
    main()
