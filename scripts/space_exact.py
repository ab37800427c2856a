#!/usr/bin/env python3
"""Compares Monte Carlo, exact ensembles and transport in boxes of resonant points at optical depths 1, 2 and 5.

Writes one line for each point of a curve: the field correlation C_E against q L, for tilts in the plane of incidence
and out of it, and the intensity around the direction of backscattering (cone) against k l |v + i|: the distance of
the view v from the light i reversed, in direction cosines, times the wavenumber and the mean free path l. Cones are
divided by their mean over distances |v + i| from 0.4 to 0.6. k l is 30 in the plane and for the cone at optical
depth 1 in space, otherwise 15. The plane's boxes are four times as wide as deep, those in space 4, 2 and 1 times for
optical depths 1, 2 and 5, for cones 2, 2 and 1 times. Transport is that of a slab. Cones are the means of RUNS runs
with their own seeds; their errors are from the scatter of the runs.
"""

import argparse
import csv
import math
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

SCENES = pathlib.Path(__file__).parent.parent / "data" / "scenes"
RUNS = 8
STEP = 0.05  # width of a ring of the cone, in direction cosines
OUTER = (0.4, 0.6)  # rings by whose mean cones are divided
# Placements for each memory effect, and for each run of a cone.
PLACEMENTS = {(3, 1): (15000, 1000), (3, 2): (4000, 150), (3, 5): (160, 16),
              (2, 1): (30000, 1000), (2, 2): (10000, 300), (2, 5): (1000, 60)}
PATHS = 1000000
COSINES = [round(STEP * j, 2) for j in range(-12, 13)]
VIEWS = {"view_angles": [-0.3, -0.4, -0.5, -0.6, -0.7, -0.8]}
TILTS = [0, 0.5, 1, 1.5, 2, 3, 4]
COLUMNS = ["dimension", "curve", "optical_depth", "x", "method", "value", "error"]


class Program:
    def __init__(self, program, folder):
        self.program, self.result = program, pathlib.Path(folder) / "result.h5"

    def __call__(self, subcommand, **keys):
        """Runs the program and returns the open result file."""
        words = [self.program, subcommand, "--threads", "1", "--out", str(self.result)]
        for key, value in keys.items():
            words += [f"--{key}"] + [str(item) for item in (value if isinstance(value, list) else [value])]
        done = subprocess.run(words, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{' '.join(words)}\n{done.stderr}")
        return h5py.File(self.result, "r")


class Medium:
    """Resonant points at an optical depth, for one curve."""

    def __init__(self, dimension, optical_depth, curve):
        is_cone = curve == "cone"
        self.dimension, self.optical_depth = dimension, optical_depth
        self.k_mfp = 30 if dimension == 2 or (is_cone and optical_depth == 1) else 15
        self.ratio = 4 if dimension == 2 else {1: 2 if is_cone else 4, 2: 2, 5: 1}[optical_depth]
        cross_section = 2 / math.pi if dimension == 2 else 1 / math.pi
        mean_free_path = self.k_mfp / (2 * math.pi)
        self.keys = {"scatterer": "point", "density": 1 / (cross_section * mean_free_path),
                     "depth": optical_depth * mean_free_path}

    def box(self):
        width = self.ratio * self.keys["depth"]
        return {**self.keys, "width": width, **({"height": width} if self.dimension == 3 else {})}

    def slab(self):
        return {**self.keys, "domain": "slab", "method": "transport", "tolerance": 0.001,
                **({"dimension": 3} if self.dimension == 3 else {})}


def memory_effect(run, medium, azimuth, placements):
    """Yields (q L, method, C_E, error)."""
    dimension = medium.dimension
    tilts = {} if dimension == 2 else {"tilt_azimuth": azimuth}
    scene = {"config": SCENES / "space_memory.toml"} if dimension == 3 else \
        {"light_angles": 0.3, "covariance": "memory_effect", "q_depths": TILTS, **VIEWS}
    with run("validate", **scene, **medium.box(), **tilts, samples=PATHS,
             wave_samples=placements) as file:
        for group, method in (("mc", "monte_carlo"), ("wave", "exact")):
            values = np.abs(file[group + "/field_correlation"][...].ravel())
            errors = file[group + "/field_correlation_error"][...].ravel()
            yield from ((q, method, value, error) for q, value, error in zip(TILTS, values, errors))
    views = {"view_angles": [0.3, 0.4, 0.5, 0.6, 0.7, 0.8], "view_azimuths": math.pi} if dimension == 3 else VIEWS
    fine = [round(0.4 * i, 1) for i in range(11)]
    with run("covariance", **medium.slab(), light_angles=0.3, **views, covariance="memory_effect",
             q_depths=fine, **tilts) as file:
        values = np.abs(file["field_correlation"][...].ravel())
        yield from ((q, "transport", value, 0) for q, value in zip(fine, values))


def rings(dimension):
    """Returns the number of the ring of each [light, view] of the cone's scenes; -1 beyond the last ring."""
    lights, views = np.meshgrid([-0.2, -0.1, 0, 0.1, 0.2], COSINES, indexing="ij")
    apart = np.abs(lights + views)
    if dimension == 3:  # [light x, light y, view y, view x]
        apart = np.hypot(apart[:, None, None, :], apart[None, :, :, None]).reshape(25, -1)
    number = np.rint(apart / STEP).astype(int)
    return np.where(number * STEP <= OUTER[1] + 1e-9, number, -1)


def cone_of(intensity, number):
    mean = np.array([intensity[number == ring].mean() for ring in range(number.max() + 1)])
    distance = STEP * np.arange(len(mean))
    return mean / mean[distance >= OUTER[0] - 1e-9].mean()


def cone(run, medium, placements):
    """Yields (k l |v + i|, method, relative intensity, error)."""
    dimension = medium.dimension
    number = rings(dimension)
    scene = {"config": SCENES / "space_cone.toml"} if dimension == 3 else \
        {"light_angles": [math.asin(s) for s in (-0.2, -0.1, 0, 0.1, 0.2)],
         "view_angles": [math.pi - math.asin(s) for s in COSINES]}
    for method, name, samples in (("mc", "monte_carlo", PATHS // 10), ("wave", "exact", placements)):
        cones = []
        for seed in range(1, RUNS + 1):
            with run("covariance", **scene, **medium.box(), method=method, samples=samples,
                     seed=seed) as file:
                cones.append(cone_of(file["intensity"][...].reshape(number.shape), number))
        errors = np.std(cones, axis=0, ddof=1) / math.sqrt(RUNS)
        for ring, (value, error) in enumerate(zip(np.mean(cones, axis=0), errors)):
            yield medium.k_mfp * STEP * ring, name, value, error
    fine = [0.01 * i for i in range(61)]
    with run("covariance", **medium.slab(), light_angles=0,
             view_angles=[math.pi - math.asin(s) for s in fine]) as file:
        values = file["intensity"][...].ravel()
    outer = values[np.array(fine) >= OUTER[0] - 1e-9].mean()
    yield from ((medium.k_mfp * s, "transport", value / outer, 0) for s, value in zip(fine, values))


def curves(run, only):
    for (dimension, optical_depth), (placements, each) in PLACEMENTS.items():
        if only and only != dimension:
            continue
        tilts = Medium(dimension, optical_depth, "tilts")
        here = [("in", memory_effect(run, tilts, 0, placements))]
        if dimension == 3:
            here.append(("out", memory_effect(run, tilts, math.pi / 2, placements)))
        here.append(("cone", cone(run, Medium(dimension, optical_depth, "cone"), each)))
        for name, points in here:
            for x, method, value, error in points:
                yield dict(zip(COLUMNS, (dimension, name, optical_depth, f"{x:.4g}", method, f"{value:.6g}",
                                         f"{error:.2g}")))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/release/bin/flatspeckle")
    parser.add_argument("--out", default="data/space_exact.csv")
    parser.add_argument("--only", type=int, choices=(2, 3), help="only this dimension")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, open(arguments.out, "w", newline="") as out:
        out.write("# scripts/space_exact.py: the script describes the columns.\n")
        table = csv.DictWriter(out, COLUMNS, lineterminator="\n")
        table.writeheader()
        for row in curves(Program(arguments.program, folder), arguments.only):
            table.writerow(row)
            out.flush()


if __name__ == "__main__":
    main()
