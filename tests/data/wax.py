#!/usr/bin/env python3
"""Writes wax.json: the candle of scenes/wax from nearby in Mitsuba 3, as means and standard errors of square blocks.

Usage: wax.py [REPETITIONS]           (from any folder; 72 if nothing is asked for, which take ten minutes on two cores)

Mitsuba moves rays off surfaces by 9e-5 (1 + largest coordinate). Two things follow, of which neither is left:

- What enters the wax skips some of it. Where the candle is far above or below the origin, all rays are moved by as much,
  but for a share that is opposite above and below. The mean of both is taken, at one distance and at four times as much,
  and continued to where nothing is skipped: (4 near - far) / 3.
- A shadow ray that leaves the wax is believed to be as far from its light as if it had not been moved, and ends on the
  light itself if that is near. There are none: light is found by scattered rays alone.

Repetitions are independent; their four images share random numbers, which makes the difference of two more certain.

Needs mitsuba and numpy."""

import json
import math
import pathlib
import sys

import mitsuba as mi
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent.parent / "scenes" / "wax"))
import in_mitsuba

SIZE, BLOCK, SAMPLES = 32, 8, 256
# The bowl and the upper half of the side, and nothing of the flame.
VIEW = {"look_at": [0.0, 0.71, 0.0], "vertical_fov_deg": 10.0}
# How far rays are moved, over 9e-5 decimetres, and the images' weights.
LEVELS, WEIGHTS = (1.0, 4.0), (4 / 3, -1 / 3)
MIDDLE = np.array([0.0, 0.5, 0.0])


def around(level):
    """The scene with the origin below and above the candle, by so much that rays are moved by `level` on average."""
    away = np.array([0.0, level - 1 / in_mitsuba.UNIT, 0.0])
    camera = in_mitsuba.SCENE["camera"] | VIEW
    return [in_mitsuba.scene(camera, SIZE, MIDDLE + side * away, connected=False) for side in (-1, 1)]


def blocks(image):
    """Means of blocks of pixels, row by row from the top."""
    count = SIZE // BLOCK
    return image[..., :3].astype(np.float64).reshape(count, BLOCK, count, BLOCK, 3).mean((1, 3)).reshape(-1, 3)


def rounded(values, digits):
    return [[float(f"{x:.{digits}g}") for x in row] for row in values]


def main():
    repetitions = int(sys.argv[1]) if len(sys.argv) > 1 else 72
    scenes = [around(level) for level in LEVELS]
    images = np.array([
        [np.mean([blocks(mi.render(scene, spp=SAMPLES, seed=seed).numpy()) for scene in pair], 0) for pair in scenes]
        for seed in range(repetitions)
    ])

    def estimate(values):
        return values.mean(0), values.std(0, ddof=1) / math.sqrt(repetitions)

    near, far = images.mean(2).transpose(1, 0, 2)
    in_mitsuba.line("rays moved by 1", *estimate(near))
    in_mitsuba.line("4 less 1", *estimate(far - near))
    continued = np.einsum("rlbc,l->rbc", images, WEIGHTS)
    in_mitsuba.line("not at all", *estimate(continued.mean(1)))
    mean, error = estimate(continued)
    file = {
        "about": "scenes/wax from nearby, blocks of 8x8 pixels row by row, by Mitsuba 3.9.1: see wax.py",
        "look_at": VIEW["look_at"],
        "vertical_fov_deg": VIEW["vertical_fov_deg"],
        "size": SIZE,
        "block": BLOCK,
        "mean": rounded(mean, 6),
        "standard_error": rounded(error, 3),
    }
    lines = ",\n".join(f' {json.dumps(key)}: {json.dumps(value)}' for key, value in file.items())
    (HERE / "wax.json").write_text("{\n" + lines.replace("], [", "],\n  [") + "\n}\n")


if __name__ == "__main__":
    main()
