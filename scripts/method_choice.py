#!/usr/bin/env python3
"""Measure how good the method chosen by `render` is, over scenes drawn at random.

Draws scenes (media, bodies, lights and sensors), renders each by every method that is possible and
by `auto`, several times with different seeds, and compares the work that each needs for the same
error: CPU seconds times the squared spread over the seeds, relative to the total light. Pictures of
few pixels are rendered more often, because their spread is less certain. Scenes whose sensor no
light reaches are left out. Prints one line per scene and a summary. Also checks the claimed errors: the fraction of totals within two
claimed errors of the mean of the best method.
"""

import argparse
import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile

import h5py
import numpy as np

METHODS = ("path", "light", "bidirectional", "forward")


def medium(draw, names=("mu_s", "mu_a", "g")):
    """Draw coefficients of a medium: clear, thin or thick; isotropic or forward."""
    depth = draw.choice([0, 0.1, 0.5, 2, 8])
    values = (depth, depth * draw.choice([0, 0, 0.02, 0.3]), draw.choice([0, 0.5, 0.9]))
    return dict(zip(names, values))


def body(draw):
    """Draw a ball or a block near the centre."""
    of = medium(draw)
    index = draw.choice([1, 1, 1.33, 1.5])
    rest = [index, of["mu_s"], of["mu_a"], of["g"]]
    if draw.random() < 0.6:
        centre = [draw.uniform(-0.5, 0.5) for _ in range(3)]
        return ["--ball", *centre, draw.uniform(0.4, 1.2), *rest]
    low, high = [-draw.uniform(0.4, 1.5) for _ in range(3)], [draw.uniform(0.4, 1.5) for _ in range(3)]
    return ["--block", *low, *high, *rest]


def light(draw):
    kind = draw.choice(["environment", "beam", "point", "fibre", "face"])
    if kind == "environment":
        return ["--environment", 1]
    if kind == "beam":
        return ["--beam_light", 0, 0, -2, 0, 0, 1, draw.choice([0.1, 0.8]), 1]
    if kind == "point":
        return ["--point_light", draw.uniform(-1.5, 1.5), draw.uniform(-1.5, 1.5), -1.8, 1]
    if kind == "fibre":
        return ["--fibre_light", 0, 0, -2, 0, 0, 1, 0.2, 0.3, 1]
    return ["--face_light", 0, 0, -2, 0.5, 1]


def sensor(draw):
    kind = draw.choice(["pinhole", "lens", "area", "polar", "radial", "directional"])
    side = draw.choice([-1, 1])
    if kind in ("pinhole", "lens"):
        at = (1.9 if kind == "pinhole" else 2) * side
        flags = ["--sensor", "camera", "--sensor_at", at, 0, 0, "--sensor_direction", -side, 0, 0]
        flags += ["--field_of_view", 1.2, "--pixels", 16, 16]
        return flags + (["--lens_radius", 0.2, "--focus_distance", 2] if kind == "lens" else [])
    if kind == "area":
        pixels = draw.choice([1, 12])
        return ["--sensor", "area", "--sensor_at", 0, 0, 2 * side, "--sensor_size",
                draw.choice([0.5, 4]), 4, "--pixels", pixels, pixels]
    if kind == "polar":
        return ["--sensor", "polar", "--sensor_direction", 0, 0, side, "--rings", 12]
    if kind == "radial":
        return ["--sensor", "radial", "--sensor_at", 0, 0, 2 * side, "--sensor_radius", 1.5,
                "--rings", 8]
    return ["--sensor", "directional", "--sensor_direction", 0, 0, side, "--pixels", 9, 9]


def scene(number):
    """Flags of scene `number`."""
    draw = random.Random(number)
    flags = ["--stage_box", -2, -2, -2, 2, 2, 2]
    for _ in range(draw.choice([0, 1, 1, 2])):
        flags += body(draw)
    around = medium(draw) if draw.random() < 0.4 else {"mu_s": 0}
    for key, value in around.items():
        if key != "g":
            flags += [f"--{key}", value]
    if around.get("g"):
        flags += ["--phase", "henyey_greenstein", "--g", around["g"]]
    return [str(flag) for flag in flags + light(draw) + sensor(draw)]


class Run:
    """One render: picture, claimed errors, total and CPU seconds."""

    def __init__(self, program, flags, method, seconds, seed):
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "run.h5")
            ended = subprocess.run(
                [program, "render", *flags, "--method", method, "--seconds", str(seconds),
                 "--threads", "1", "--seed", str(seed), "--out", out],
                capture_output=True, text=True, check=False)
            self.is_refused = ended.returncode not in (0, 3)
            self.message = ended.stderr.strip().splitlines()[-1] if ended.stderr else ""
            if self.is_refused:
                return
            self.has_finite_variance = "no finite variance" not in ended.stdout
            self.method = ended.stdout.split()[1]
            with h5py.File(out) as file:
                self.image = file["image"][()].ravel()
                self.mean, self.mean_error = file["mean"][()], file["mean_error"][()]
                self.is_rare = "mean_rare" in file and bool(np.any(file["mean_rare"][()]))
                self.cpu_s = float(file.attrs["cpu_s"])


def spread(runs):
    """Squared spread of the pictures over the seeds, relative to their squared RMS value."""
    images = np.array([run.image for run in runs])
    square = np.mean(np.mean(images, axis=0) ** 2)
    return np.mean(np.var(images, axis=0, ddof=1)) / square if square > 0 else math.inf


def runs_of(program, flags, method, seconds, seeds):
    """Runs with `seeds` seeds, and four times as many for pictures of few pixels."""
    few = 16
    runs = [Run(program, flags, method, seconds, 1)]
    if not runs[0].is_refused and runs[0].image.size < few:
        seeds *= 4
    return runs + [Run(program, flags, method, seconds, seed) for seed in range(2, seeds + 1)]


def measure(program, number, seconds, seeds):
    """Work of each method, and that of `auto`."""
    flags = scene(number)
    work, chosen, covered, checked = {}, None, 0, 0
    for method in ("auto", *METHODS):
        runs = runs_of(program, flags, method, seconds, seeds)
        if any(run.is_refused for run in runs):
            if method == "auto":
                return f"{number:3d} refused: {runs[0].message}", None, 0, 0
            continue
        if method == "auto" and not any(np.any(run.image) for run in runs):
            return f"{number:3d} dark", None, 0, 0
        work[method] = spread(runs) * np.mean([run.cpu_s for run in runs])
        if method == "auto":
            chosen = runs
    best = min(work, key=lambda method: work[method])
    rounding = 1e-24  # pictures without noise differ by the squares of rounding errors
    ratio = (work["auto"] + rounding) / (work[best] + rounding)
    centre = np.mean([run.mean for run in chosen])
    for run in chosen:
        if run.is_rare or not run.has_finite_variance:
            continue
        checked += 1
        # the mean of the seeds has an error too
        widened = run.mean_error * math.sqrt(1 + 1 / len(chosen))
        covered += abs(run.mean - centre) <= 2 * widened + 1e-12 * abs(centre)
    rows = "  ".join(f"{method} {value:.2g}" for method, value in work.items())
    return f"{number:3d} {chosen[0].method:14s} {ratio:6.2f}  best {best:14s} {rows}", ratio, covered, checked


def main():
    reader = argparse.ArgumentParser(description=__doc__)
    reader.add_argument("--program", default="build/release/bin/flatspeckle")
    reader.add_argument("--scenes", type=int, default=40, help="with light")
    reader.add_argument("--first", type=int, default=1)
    reader.add_argument("--seconds", type=float, default=1.0, help="of each run")
    reader.add_argument("--seeds", type=int, default=4)
    given = reader.parse_args()
    program = str(pathlib.Path(given.program).resolve())
    ratios, covered, checked = [], 0, 0
    number = given.first
    while len(ratios) < given.scenes:
        line, ratio, inside, of = measure(program, number, given.seconds, given.seeds)
        print(line, flush=True)
        if ratio is not None:
            ratios.append(ratio)
        covered, checked = covered + inside, checked + of
        number += 1
    print(f"{len(ratios)} scenes with light: at most 1.5 times the best in "
          f"{sum(ratio <= 1.5 for ratio in ratios)}, at most 2.5 times in "
          f"{sum(ratio <= 2.5 for ratio in ratios)}; within two claimed errors {covered} of {checked}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
