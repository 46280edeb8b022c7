#!/usr/bin/env python3
"""Measures what a farm costs beyond its samples, with parts that are as small as they can be.

    simulate.py [--fogbow PROGRAM] [--parts 1000] [--size 64x64] [--jobs 1] [SCENE]

Renders SCENE (default: farm/scene.toml) in parts of one sample per pixel, merges 10, 100, ... and all of them, shuffled,
and compares that with one render, bit by bit: seconds and most memory of every step. With --sizes 256x256,1024x1024
it also merges two and four parts of these sizes, for what a megapixel costs. Needs nothing but Python 3.
"""

import argparse
import json
import os
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent


def run(args):
    """Runs a command: seconds, seconds of processors, and most memory in MB."""
    start = time.perf_counter()
    process = subprocess.Popen([str(arg) for arg in args])
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"FAILED with code {process.returncode}: {' '.join(map(str, args))[:400]}")
    return time.perf_counter() - start, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    parser.add_argument("--fogbow", default=os.environ.get("FOGBOW", target / "release" / "fogbow"))
    parser.add_argument("--parts", type=int, default=1000)
    parser.add_argument("--size", default="64x64")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--sizes", default="", help="sizes of parts that are merged by twos and fours")
    parser.add_argument("scene", nargs="?", default=HERE / "scene.toml")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        simulate(args, pathlib.Path(folder))
        for size in filter(None, args.sizes.split(",")):
            megapixels(args, pathlib.Path(folder), size)


def render(args, size, samples, out, *flags):
    """Renders the samples from the first to before the last."""
    command = [args.fogbow, "render", args.scene, "--size", size, "--sample-range", f"{samples[0]}..{samples[1]}"]
    return run([*command, "-o", out, "--progress", "none", "--threads", "1", *flags])


def merge(args, parts, out, *flags):
    """Merges the parts in a random order, from a list: there may be more than fit on a command line."""
    parts = random.Random(1).sample(parts, len(parts))
    names = out.with_suffix(".list")
    names.write_text("".join(f"{part}\n" for part in parts))
    return run([args.fogbow, "merge", f"@{names}", "-o", out, "--progress", "none", *flags])


def simulate(args, folder):
    """Many small parts."""
    parts = [folder / f"{index:06}.exr" for index in range(args.parts)]
    start = time.perf_counter()
    with ThreadPoolExecutor(args.jobs) as pool:
        runs = list(pool.map(lambda index: render(args, args.size, (index, index + 1), parts[index]), range(args.parts)))
    wall, work = [[run[index] for run in runs] for index in (0, 1)]
    print(f"{args.parts} parts of {args.size} pixels, 1 sample each, in {time.perf_counter() - start:.1f} s")
    print(f"  a part: median {statistics.median(wall):.3f} s, of processors {statistics.median(work):.3f} s, "
          f"longest {max(wall):.3f} s, file {parts[0].stat().st_size / 1e3:.1f} kB")
    counts = sorted({min(10**power, args.parts) for power in range(1, 8)})
    for count in counts:
        flags = ["--expect", f"0..{count}"]
        wall, work, memory = merge(args, parts[:count], folder / "merged.exr", *flags)
        print(f"  merge of {count:5}: {wall:7.3f} s, {1e3 * wall / count:6.2f} ms per part, "
              f"of processors {1e3 * work / count:6.2f} ms per part, {memory:6.1f} MB")
    render(args, args.size, (0, args.parts), folder / "whole.exr")
    compare = [args.fogbow, "compare", folder / "merged.exr", folder / "whole.exr", "--json"]
    report = json.loads(subprocess.run([str(arg) for arg in compare], check=True, capture_output=True).stdout)
    if report["same_sums"] is not True or any(channel["rmse"] != 0 for channel in report["channels"]):
        sys.exit(f"FAILED: the merged image is not that of one render: {report}")
    print("  merged and rendered in one run: the same bits")


def megapixels(args, folder, size):
    """Parts of some size, for what merging them costs per pixel."""
    width, height = map(int, size.split("x"))
    parts = [folder / f"{size}-{index}.exr" for index in range(4)]
    for index, part in enumerate(parts):
        render(args, size, (index, index + 1), part)
    two, four = [merge(args, parts[:count], folder / "merged.exr") for count in (2, 4)]
    wall, work = [(four[index] - two[index]) / 2 for index in (0, 1)]
    million = width * height / 1e6
    print(f"{size}: a part has {parts[0].stat().st_size / 1e6:.1f} MB and takes {wall:.3f} s to merge, of processors "
          f"{work:.3f} s; per megapixel {parts[0].stat().st_size / 1e6 / million:.1f} MB, {wall / million:.2f} s, of "
          f"processors {work / million:.2f} s; memory {two[2]:.0f} MB with two parts, {four[2]:.0f} MB with four")
    for part in parts:
        part.unlink()


if __name__ == "__main__":
    main()
