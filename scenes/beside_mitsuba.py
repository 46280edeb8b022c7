#!/usr/bin/env python3
"""Renders a scene of fogbow in Mitsuba 3 (llvm if there is LLVM, otherwise scalar; volpath), a few samples at a time.

Usage: beside_mitsuba.py SCENE.json       (`fogbow paper peers` writes the scene, and runs this in turn with its own)

It says "ready VERSION VARIANT" on standard output. Then it reads lines: "render N" takes N more samples of every pixel
and answers with the seconds that this took; "write FILE.exr" writes the mean so far and answers "written". Scenes have
one medium without end, disks as lights, and triangles that reflect diffusely. Needs mitsuba and numpy; where Mitsuba
does not find LLVM, DRJIT_LIBLLVM_PATH names it."""

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
from mitsuba_objects import diffuse, mesh, objects, rgb  # noqa: E402: needs a variant

T = mi.ScalarTransform4f
# Samples per pixel and call.
SAMPLES = 16


def medium(keys):
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
        "fog": medium(keys["medium"]),
        "integrator": {"type": "volpath", "max_depth": keys["max_segments"], "rr_depth": 100000},
        "sensor": {
            "type": "perspective",
            "near_clip": max(camera["near"], 1e-4),
            "far_clip": 1e6,
            "fov": camera["vertical_fov_deg"],
            "fov_axis": "y",
            "to_world": T().look_at(camera["position"], camera["look_at"], camera["up"]),
            "medium": {"type": "ref", "id": "fog"},
            "film": {
                "type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"},
                "pixel_format": "rgb", "component_format": "float32",
            },
            "sampler": {"type": "independent"},
        },
    }
    for index, light in enumerate(keys["lights"]):
        built[f"light{index}"] = disk(light)
    if keys["geometry"]:
        for name, corners, triangles, colour in objects(pathlib.Path(keys["geometry"])):
            name = name.replace(".", " ")
            built[f"object {name}"] = mesh(name, corners, triangles, bsdf=diffuse(colour))
    return mi.load_dict(built)


def main():
    built = scene(json.loads(pathlib.Path(sys.argv[1]).read_text()))
    # Kernels differ between numbers of samples: all renders take this one, which is compiled before any is timed.
    mi.render(built, spp=SAMPLES, seed=99999).numpy()
    print("ready", mi.__version__, VARIANT, flush=True)
    total, samples, seed = 0.0, 0, 0
    for line in sys.stdin:
        command, argument = line.strip().split(" ", 1)
        if command == "render":
            seconds, taken = 0.0, 0
            while taken < int(argument):
                start = time.time()
                image = mi.render(built, spp=SAMPLES, seed=seed).numpy()[..., :3]
                seconds, taken, seed = seconds + time.time() - start, taken + SAMPLES, seed + 1
                total, samples = total + SAMPLES * image.astype(np.float64), samples + SAMPLES
            print(seconds, taken, flush=True)
        elif command == "write":
            mi.Bitmap((total / samples).astype(np.float32)).write(argument)
            print("written", flush=True)


if __name__ == "__main__":
    main()
