#!/usr/bin/env python3
"""Renders a scene of fogbow in Mitsuba 3 (llvm if there is LLVM, otherwise scalar; volpath), a few samples at a time.

Usage: beside_mitsuba.py SCENE.json       (`fogbow paper peers` writes the scene, and runs this in turn with its own)

It says "ready VERSION VARIANT" on standard output. Then it reads lines: "render N" takes N more samples of every pixel,
or a few more than that, and answers with the seconds that this took and with their number; "write FILE.exr" writes the
mean so far and answers "written". Scenes have a medium without end, or boxes of voxels in vacuum, disks as lights,
triangles that reflect diffusely, and the seconds that a call may take. Needs mitsuba and numpy; where Mitsuba does not
find LLVM, DRJIT_LIBLLVM_PATH names it."""

import json
import pathlib
import sys
import time

import mitsuba as mi
import numpy as np


def choose_variant():
    for variant in ("llvm_ad_rgb", "scalar_rgb"):
        try:
            mi.set_variant(variant)
            mi.load_dict({"type": "sphere"})
            return variant
        except Exception:  # whatever a variant says that cannot run here
            continue
    sys.exit("no variant of Mitsuba runs here")


VARIANT = choose_variant()
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from mitsuba_objects import cloud, mesh, objects, rgb  # noqa: E402: needs a variant

T = mi.ScalarTransform4f
# Most samples per pixel and call.
MOST = 16


def homogeneous(keys):
    scattering, absorption = (np.array(keys[name], float) for name in ("scattering", "absorption"))
    extinction = scattering + absorption
    scale = extinction.max()  # colours end at 1
    return {
        "type": "homogeneous",
        "sigma_t": rgb(extinction / scale),
        "scale": float(scale),
        "albedo": rgb(scattering / extinction),
        "phase": {"type": "hg", "g": keys["g"]},
    }


def voxels(keys):
    """A box of voxels, whose scattering and absorption are grey."""
    [scattering], [absorption] = (set(keys[name]) for name in ("scattering", "absorption"))
    low, high = (np.array(corner, float) for corner in keys["corners"])
    densities = np.fromfile(keys["densities"], "<f4").reshape(*reversed(keys["counts"]))
    return cloud(densities, low, high, scattering, absorption, keys["g"])


def disk(light):
    center, normal = np.array(light["center"], float), np.array(light["normal"], float)
    up = [0, 0, 1] if abs(normal[1]) > 0.9 * np.linalg.norm(normal) else [0, 1, 0]
    return {
        "type": "disk",
        "to_world": T().look_at(list(center), list(center + normal), up) @ T().scale(light["radius"]),
        "bsdf": {"type": "diffuse", "reflectance": rgb([0, 0, 0])},
        "emitter": {"type": "area", "radiance": rgb(light["radiance"])},
    }


def scene(keys):
    camera, (width, height) = keys["camera"], keys["size"]
    built = {
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": keys["max_segments"], "rr_depth": 100000},
        "sensor": {
            "type": "perspective",
            "near_clip": max(camera["near"], 1e-4),
            "far_clip": 1e6,
            "fov": camera["vertical_fov_deg"],
            "fov_axis": "y",
            "to_world": T().look_at(camera["position"], camera["look_at"], camera["up"]),
            "film": {
                "type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"},
                "pixel_format": "rgb", "component_format": "float32",
            },
            "sampler": {"type": "independent"},
        },
    }
    if keys["medium"]:
        built["fog"] = homogeneous(keys["medium"])
        built["sensor"]["medium"] = {"type": "ref", "id": "fog"}
    for index, volume in enumerate(keys["volumes"]):
        built[f"cloud{index}"] = voxels(volume)
    for index, light in enumerate(keys["lights"]):
        built[f"light{index}"] = disk(light)
    if keys["geometry"]:
        for name, corners, triangles, made_of in objects(pathlib.Path(keys["geometry"])):
            name = name.replace(".", " ")
            built[f"object {name}"] = mesh(name, corners, triangles, **made_of)
    return mi.load_dict(built)


def rendered(built, samples, seed):
    """The mean of so many samples per pixel, and the seconds that they took."""
    start = time.time()
    image = mi.render(built, spp=samples, seed=seed).numpy()[..., :3]
    return image, time.time() - start


def samples_per_call(built, seconds):
    """As many samples per pixel as a call takes within so many seconds, a power of two. Kernels differ between numbers
    of samples: they are compiled before any render is timed."""
    samples = 1
    while True:
        rendered(built, samples, 99999)
        _, took = rendered(built, samples, 99998)
        if samples == MOST or 2 * took > seconds:
            return samples
        samples *= 2


def main():
    keys = json.loads(pathlib.Path(sys.argv[1]).read_text())
    built = scene(keys)
    at_a_time = samples_per_call(built, keys["call"])
    print("ready", mi.__version__, VARIANT, flush=True)
    total, samples, seed = 0.0, 0, 0
    for line in sys.stdin:
        command, argument = line.strip().split(" ", 1)
        if command == "render":
            seconds, taken = 0.0, 0
            while taken < int(argument):
                image, took = rendered(built, at_a_time, seed)
                seconds, taken, seed = seconds + took, taken + at_a_time, seed + 1
                total, samples = total + at_a_time * image.astype(np.float64), samples + at_a_time
            print(seconds, taken, flush=True)
        elif command == "write":
            mi.Bitmap((total / samples).astype(np.float32)).write(argument)
            print("written", flush=True)


if __name__ == "__main__":
    main()
