#!/usr/bin/env python3
"""The same scene in Mitsuba 3, with the same numbers in its grid: image mean and standard error, and samples per second.

Usage: in_mitsuba.py [SAMPLES]        (from any folder; 512 samples per pixel at 128 x 128 if nothing is asked for)

Needs mitsuba, numpy and the Python module of OpenVDB (openvdb or pyopenvdb)."""

import math
import pathlib
import sys
import time
import tomllib

import mitsuba as mi
import numpy as np

try:
    import openvdb as vdb
except ImportError:
    import pyopenvdb as vdb

mi.set_variant("llvm_ad_rgb")
HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from mitsuba_objects import cloud, mesh, objects, rgb

SIZE, BATCH = 128, 32
SCENE = tomllib.loads((HERE / "scene.toml").read_text())


def voxels():
    """The cloud, with one voxel more on every side: Mitsuba counts from their faces, OpenVDB from their centres."""
    [volume] = SCENE["volume"]
    place = volume["grid"]
    grid = vdb.read(str(HERE / place["file"]), "density")
    low, high = (np.array(corner) for corner in grid.evalActiveVoxelBoundingBox())
    low, high = low - 1, high + 1
    densities = np.zeros(high - low + 1, dtype=np.float32)
    grid.copyToArray(densities, ijk=tuple(int(x) for x in low))
    corners = [np.array(grid.transform.indexToWorld(tuple(index))) for index in (low - 0.5, high + 0.5)]
    corners = [place["scale_by"] * corner + np.array(place["translate"]) for corner in corners]
    densities = np.ascontiguousarray(densities.transpose(2, 1, 0))
    return cloud(densities, *corners, volume["scattering"], volume["absorption"], volume["phase"]["g"])


def walls():
    for name, corners, triangles, made_of in objects(HERE.parent / "cornell-fog" / "cornell-fog.glb"):
        yield name.replace(".", " "), mesh(name, corners, triangles, **made_of)


def scene():
    camera, [lamp], segments = SCENE["camera"], SCENE["light"], SCENE["render"]["max_segments"]
    t = mi.ScalarTransform4f
    center, normal = np.array(lamp["center"]), np.array(lamp["normal"])
    light = t().look_at(list(center), list(center + normal), [0, 0, 1]) @ t().scale(lamp["radius"])
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}, "pixel_format": "rgb"}
    return mi.load_dict({
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": segments, "rr_depth": 100000},
        "sensor": {
            "type": "perspective", "near_clip": float(camera["near"]), "fov": camera["vertical_fov_deg"], "fov_axis": "y",
            "to_world": t().look_at(camera["position"], camera["look_at"], [0, 1, 0]),
            "film": film | {"component_format": "float32"}, "sampler": {"type": "independent"},
        },
        "cloud": voxels(),
        "light": {
            "type": "disk", "to_world": light,
            "bsdf": {"type": "diffuse", "reflectance": rgb([0, 0, 0])},
            "emitter": {"type": "area", "radiance": rgb([lamp["radiance"]] * 3)},
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
