#!/usr/bin/env python3
"""Measures the deviation of Monte Carlo from the exact solver against k times the mean free path and against packing
fraction.

Runs `flatspeckle validate` on sets of scenes and writes one line per scene: points resonant points, Poisson,
optical depth 1 and 2, box twice as wide as deep disks TM cylinders, k radius = 1, index 1.2, hard disks in a 12 x 8
box, Monte Carlo with independent positions and with the structure factor of hard disks for illumination at 0 and pi
and 16 detection directions around the circle, except those in the forward lobe (k |sin view| < 2 pi / width), where a
fixed number of disks lacks a part of the covariance. Each scene is run ten times with different seeds. The deviation
is (mc - exact) / exact, with exact values averaged over the runs. The error bar of its mean over directions is from
the scatter of the runs. Noise is subtracted from its RMS. Directions along the faces (+- pi / 2), where waves
diffract at the edges of the box, have a separate mean, `grazing`.

Sets in space, of illumination at 0.3 and 25 directions around the sphere: space_points, as above; space_shifted, points
off resonance; space_spheres, k radius = 1, index 1.2; space_resonant, spheres with k
radius = 1 and index 3, whose wave of degree 1 resonates. Their deviations are relative to the mean over directions.
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

RUNS = 10
VIEWS = [2 * math.pi * j / 16 for j in range(-8, 8)]
POINTS = [(optical_depth, k_mfp) for optical_depth in (1, 2)
          for k_mfp in (5, 7, 10, 14, 20, 30, 50, 100, 200)]
PACKINGS = [0.01, 0.02, 0.03, 0.05, 0.075, 0.1, 0.15, 0.2]
BOX = {"width": 12, "depth": 8}
RADIUS = 1 / (2 * math.pi)
SPACE_POINTS = [(1, k_mfp) for k_mfp in (5, 7, 10, 14, 20, 30, 50)] + \
               [(2, k_mfp) for k_mfp in (5, 7, 10, 14, 20)]
SPACE_SHIFTED = [(0.4, 15), (math.pi / 4, 15), (math.pi / 4, 30)]  # phase shift, k mfp
SPACE_PACKINGS = [(0.01, 5, 4), (0.02, 4, 3.5), (0.04, 3.2, 2.8), (0.08, 2.6, 2.1), (0.15, 2.1, 1.7)]  # packing, width, depth
SPACE_RESONANT = [40, 20]  # spheres in 8 x 8 x 6
POLAR, AZIMUTHS = [0.8, 1.2, math.pi / 2, 1.95, 2.4, 2.8], [0.6, 1.9, 3.1, 4.4, 5.6]
COLUMNS = ["family", "structure", "k_mean_free_path", "optical_depth", "packing_fraction",
           "k_shift_over_k", "width", "depth", "placements", "mean", "mean_error", "rms",
           "grazing", "grazing_error"]


def call(program, folder, subcommand, threads, **keys):
    """Runs the program and returns the open result file."""
    words = [program, subcommand, "--threads", str(threads), "--out", str(folder / "result.h5")]
    for key, value in keys.items():
        words += [f"--{key}"] + [str(item) for item in
                                 (value if isinstance(value, list) else [value])]
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(words)}\n{done.stderr}")
    return h5py.File(folder / "result.h5", "r")


class Scene:
    """Ten runs of one scene: exact and Monte Carlo intensities, [run, light x view]."""

    exact_keys = {}  # further keys of exact ensembles

    def __init__(self, family, structure, **keys):
        self.family, self.structure = family, structure
        self.keys = {"light_angles": [0, math.pi], "view_angles": VIEWS, **keys}
        self.exact, self.mc, self.attributes = [], [], {}

    def kinds_of_views(self):
        """Returns masks over light x view: directions to average, and those along the faces."""
        light, view = np.meshgrid([0, math.pi], VIEWS, indexing="ij")
        forward = np.cos(view - light) > 0
        in_lobe = forward & (np.abs(np.sin(view)) * self.keys["width"] < 1)
        grazing = np.abs(np.cos(view)) < 1e-9
        return (~in_lobe & ~grazing).ravel(), grazing.ravel()

    def unit(self, exact):
        """Returns the intensities to which deviations are relative."""
        return exact.mean(axis=0)

    def add(self, file, exact):
        group = "mc/" if "mc" in file else ""
        self.mc.append(file[group + "intensity"][...].ravel())
        self.exact.append(exact)
        self.attributes = dict(file.attrs)

    def row(self, placements):
        exact, mc = np.array(self.exact), np.array(self.mc)
        deviation = (mc - exact) / self.unit(exact)
        chosen, grazing = self.kinds_of_views()
        noise = deviation.var(axis=0, ddof=1) / RUNS
        square = np.mean((deviation.mean(axis=0)**2 - noise)[chosen])
        values = {name: self.attributes[name] for name in COLUMNS if name in self.attributes}
        wavenumber = 2 * math.pi / self.attributes["wavelength"]
        mean, mean_error = mean_over(deviation[:, chosen])
        grazing, grazing_error = mean_over(deviation[:, grazing])
        return {**values, "family": self.family, "structure": self.structure,
                "k_shift_over_k": self.attributes["k_shift"] / wavenumber,
                "placements": RUNS * placements, "mean": mean, "mean_error": mean_error,
                "rms": math.sqrt(max(0, square)), "grazing": grazing,
                "grazing_error": grazing_error}


class SpaceScene(Scene):
    exact_keys = {"wave_tolerance": 0.01}  # gives field errors of 3e-4

    def __init__(self, family, structure, **keys):
        views = {"view_angles": [polar for polar in POLAR for _ in AZIMUTHS],
                 "view_azimuths": AZIMUTHS * len(POLAR)}
        super().__init__(family, structure, light_angles=0.3, dimension=3, height=keys["width"], **views, **keys)

    def kinds_of_views(self):
        grazing = np.repeat(np.abs(np.cos(POLAR)) < 1e-9, len(AZIMUTHS))
        return ~grazing, grazing

    def unit(self, exact):
        return exact[:, self.kinds_of_views()[0]].mean()


def mean_over(deviation):
    """Returns the mean of deviations [run, view] and its standard error, from the scatter of the runs."""
    means = deviation.mean(axis=1)
    return means.mean(), means.std(ddof=1) / math.sqrt(len(means))


def compare(call_program, scenes, placements, paths):
    """Compares scenes with the exact solutions of the first; returns a row for each."""
    first, *others = scenes
    for seed in range(1, RUNS + 1):
        with call_program("validate", **first.keys, **first.exact_keys, seed=seed, samples=paths,
                          wave_samples=placements) as file:
            exact = file["wave/intensity"][...].ravel()
            first.add(file, exact)
        for other in others:
            with call_program("covariance", **other.keys, structure=other.structure, seed=seed,
                              samples=paths) as file:
                other.add(file, exact)
    return [scene.row(placements) for scene in scenes]


def points(optical_depth, k_mfp):
    depth = optical_depth * k_mfp / (2 * math.pi)
    return [Scene("points", "none", width=2 * depth, depth=depth, optical_depth=optical_depth)]


def disks(packing):
    count = round(packing * BOX["width"] * BOX["depth"] / (math.pi * RADIUS**2))
    keys = {**BOX, "scatterer": "tm", "radius": RADIUS, "index": "1.2", "count": count}
    return [Scene("disks", structure, **keys) for structure in ("none", "hard_disks")]


def space_points(optical_depth, k_mfp, **keys):
    depth = optical_depth * k_mfp / (2 * math.pi)
    return [SpaceScene("space_shifted" if keys else "space_points", "none", width=2 * depth, depth=depth,
                       optical_depth=optical_depth, **keys)]


def spheres(packing, width, depth):
    count = round(packing * width * width * depth / (4 / 3 * math.pi * RADIUS**3))
    keys = {"width": width, "depth": depth, "scatterer": "penetrable", "radius": RADIUS, "index": "1.2",
            "count": count}
    return [SpaceScene("space_spheres", structure, **keys) for structure in ("none", "hard_spheres")]


def resonant(count):
    return [SpaceScene("space_resonant", "none", width=8, depth=6, scatterer="penetrable", radius=RADIUS, index="3",
                       count=count)]


def measure_plane(measure):
    for optical_depth, k_mfp in POINTS:
        measure(points(optical_depth, k_mfp), 4000 if k_mfp < 60 else 3000, 100_000)
    for packing in PACKINGS:
        measure(disks(packing), 600 if packing < 0.06 else 300, 100_000)


def measure_space(measure):
    for optical_depth, k_mfp in SPACE_POINTS:
        number = optical_depth**3 * k_mfp**2 / math.pi
        measure(space_points(optical_depth, k_mfp), min(8000, 160000 / number), 80000)
    for phase_shift, k_mfp in SPACE_SHIFTED:
        measure(space_points(1, k_mfp, phase_shift=phase_shift), 60, 80000)
    for packing in SPACE_PACKINGS:
        measure(spheres(*packing), 150, 200000)
    for count in SPACE_RESONANT:
        measure(resonant(count), 40, 200000)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/release/bin/flatspeckle")
    parser.add_argument("--out", default="data/bias_map.csv")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--effort", type=float, default=1, help="factor on the number of samples")
    parser.add_argument("--only", choices=("plane", "space"), help="only these sets")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name, open(arguments.out, "w", newline="") as out:
        out.write("# scripts/bias_map.py: Monte Carlo against the exact solver, both of this "
                  "program; the script describes the columns.\n")
        table = csv.DictWriter(out, COLUMNS, lineterminator="\n")
        table.writeheader()

        def call_program(subcommand, **keys):
            return call(arguments.program, pathlib.Path(name), subcommand, arguments.threads,
                        **keys)

        def measure(scenes, placements, paths):
            for row in compare(call_program, scenes, int(arguments.effort * placements),
                               int(arguments.effort * paths)):
                table.writerow({key: f"{value:.5g}" if isinstance(value, float) else value
                                for key, value in row.items()})
                out.flush()
                print(row["family"], row["structure"], f"k mfp {row['k_mean_free_path']:.4g}, "
                      f"packing {row['packing_fraction']:.3g}: mean {row['mean']:+.4f} "
                      f"+- {row['mean_error']:.4f}, rms {row['rms']:.4f}, "
                      f"grazing {row['grazing']:+.4f}", flush=True)

        if arguments.only != "space":
            measure_plane(measure)
        if arguments.only != "plane":
            measure_space(measure)


if __name__ == "__main__":
    main()
