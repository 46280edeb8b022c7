#!/usr/bin/env python3
"""The same scene in Mitsuba 3, with the same numbers: mean and standard error of the image and of its quadrants.

Usage: in_mitsuba.py [SAMPLES [IMAGE.exr]]  (from any folder; 4096 samples per pixel at 64 x 64 if nothing is asked for)

IMAGE.exr is one that fogbow made, of the same size, to compare with:

    fogbow render scenes/wax --size 64x64 --samples 4096 -o IMAGE.exr

Needs mitsuba and numpy."""

import math
import pathlib
import sys
import time
import tomllib

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from mitsuba_objects import mesh, objects, rgb

SIZE, BATCH = 64, 64
SCENE = tomllib.loads((HERE / "scene.toml").read_text())
# Mitsuba moves rays off surfaces by 9e-5 (1 + largest coordinate), and so into the wax, whose mean free path is 0.006.
# They skip least of it where the unit is small and the candle about 0.
UNIT, ORIGIN = 100.0, np.array([0.0, 0.5, 0.0])


def place(position, origin):
    return [float(x) for x in UNIT * (np.array(position) - origin)]


def wax(connected):
    """The medium, whose extinction differs between channels. Mitsuba takes values of up to 1, and a factor."""
    volume = SCENE["volume"][0]
    scattering, absorption = np.full(3, float(volume["scattering"])), np.array(volume["absorption"], dtype=float)
    extinction = scattering + absorption
    return {
        "type": "homogeneous",
        "albedo": rgb(scattering / extinction),
        "sigma_t": rgb(extinction / extinction.max()),
        "scale": float(extinction.max() / UNIT),
        "phase": {"type": "hg", "g": volume["phase"]["g"]},
        "sample_emitters": connected,
    }


def surfaces(origin, connected):
    """What reflects is diffuse and has a black back; the bounds of the wax are no surface."""
    for name, corners, triangles, made_of in objects(HERE / SCENE["geometry"]):
        if name == SCENE["volume"][0]["shape"]["name"]:
            made_of = {"bsdf": mi.load_dict({"type": "null"}), "interior": mi.load_dict(wax(connected))}
        yield name.replace(".", " "), mesh(name, UNIT * (corners - origin), triangles, **made_of)


def lamps(origin):
    """Disks, which are black where they do not shine."""
    t = mi.ScalarTransform4f
    for i, light in enumerate(SCENE["light"]):
        ahead = np.add(light["center"], light["normal"])
        to_world = t().look_at(place(light["center"], origin), place(ahead, origin), [0, 1, 0])
        yield f"lamp{i}", {
            "type": "disk",
            "to_world": to_world @ t().scale(UNIT * light["radius"]),
            "bsdf": {"type": "diffuse", "reflectance": rgb([0, 0, 0])},
            "emitter": {"type": "area", "radiance": rgb(light["radiance"])},
        }


def scene(camera=SCENE["camera"], size=SIZE, origin=ORIGIN, connected=True):
    """A square image of so many rows, with or without shadow rays from within the wax; rays are moved least at `origin`."""
    film = {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}, "pixel_format": "rgb"}
    position, look_at = (place(camera[key], origin) for key in ("position", "look_at"))
    return mi.load_dict({
        "type": "scene",
        "integrator": {"type": "volpathmis", "max_depth": -1, "rr_depth": 100},
        "sensor": {
            "type": "perspective", "near_clip": 0.1 * UNIT, "far_clip": 100 * UNIT,
            "fov": float(camera["vertical_fov_deg"]), "fov_axis": "y",
            "to_world": mi.ScalarTransform4f().look_at(position, look_at, [0, 1, 0]),
            "film": film | {"component_format": "float32"}, "sampler": {"type": "independent"},
        },
        **dict(surfaces(origin, connected)),
        **dict(lamps(origin)),
    })


def parts():
    """The image and its quadrants: rows and columns."""
    half = SIZE // 2
    low, high = slice(half), slice(half, None)
    yield "image", slice(None), slice(None)
    for name, rows in [("upper", low), ("lower", high)]:
        yield name + " left", rows, low
        yield name + " right", rows, high


def read(path):
    """Means and standard errors of the pixels of an image that fogbow made."""
    image = mi.Bitmap(path)
    channels = {field.name: np.array(image, dtype=np.float64)[..., i] for i, field in enumerate(image.struct_())}
    return [np.stack([channels[prefix + c] for c in "RGB"], -1) for prefix in ("", "SE.")]


def of_part(image, rows, columns):
    """Means and standard errors of a part of an image, from those of its pixels."""
    mean, error = (layer[rows, columns] for layer in image)
    return mean.mean((0, 1)), np.sqrt((error**2).sum((0, 1))) / error[..., 0].size


def line(name, means, errors):
    print(f"{name:22}", *(f"{m:.5f} +- {e:.5f}" for m, e in zip(means, errors)), sep="  ")


def main():
    samples = int(sys.argv[1]) if len(sys.argv) > 1 else 4096
    built = scene()
    mi.render(built, spp=BATCH, seed=99999).numpy()
    start = time.time()
    images = [mi.render(built, spp=BATCH, seed=seed).numpy() for seed in range(max(2, samples // BATCH))]
    rate = len(images) * BATCH * SIZE**2 / (time.time() - start)
    images = np.stack(images).astype(np.float64)[..., :3]
    image = [images.mean(0), images.std(0, ddof=1) / math.sqrt(len(images))]
    print(f"{len(images) * BATCH} samples per pixel, {rate / 1e3:.0f} k samples/s; red, green, blue")
    other = read(sys.argv[2]) if len(sys.argv) > 2 else None
    for name, *part in parts():
        mean, error = of_part(image, *part)
        line(name, mean, error)
        if other:
            other_mean, other_error = of_part(other, *part)
            line("  in " + pathlib.Path(sys.argv[2]).name, other_mean, other_error)
            z = (other_mean - mean) / np.hypot(other_error, error)
            print(f"{'  standard errors apart':22}", *(f"{x:+18.2f}" for x in z), sep="  ")


if __name__ == "__main__":
    main()
