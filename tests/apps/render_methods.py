#!/usr/bin/python3
"""Compares the methods of render on the shipped scenes: processor time that each needs to reach an error of the
picture and of the total, relative to the method that the pilot chooses.

    tests/apps/render_methods.py PROGRAM [--seconds T] [--reference R] [--seeds N] [--scenes NAME ...] [--power]

--power: a single pixel, for which the pilot may choose another method.

Errors are differences between runs of T seconds and a reference of R seconds by the chosen method, not reported ones.
They fall as 1 / sqrt(time). Runs of all methods alternate, as the machine may be shared."""

import argparse
import pathlib
import subprocess
import tempfile

import h5py
import numpy as np

SCENES = pathlib.Path(__file__).resolve().parents[2] / "data" / "scenes"
NAMES = ("luneburg", "luneburg_pulse", "slab", "waveguide", "fisheye", "grin_fibre", "glass_ball")
METHODS = ("path", "light", "bidirectional", "forward")
NO_FORWARD = ("luneburg", "slab", "fisheye", "glass_ball")  # no index field, or a camera
ERRORS = (0.1, 0.05, 0.02, 0.01, 0.005)


class Scene:
    def __init__(self, program, name, folder, extra):
        self.program, self.name, self.out, self.extra = program, name, folder / "out.h5", extra

    def run(self, seconds, seed, *flags):
        """Returns picture, total, processor seconds of the batches, and the plan."""
        subprocess.run([self.program, "render", "--config", SCENES / f"render_{self.name}.toml", "--threads", "1",
                        "--seconds", str(seconds), "--seed", str(seed), "--out", self.out, *self.extra, *map(str, flags)],
                       check=True, capture_output=True)
        with h5py.File(self.out) as file:
            total = np.atleast_1d(file["total" if "total" in file else "mean"][...])
            return {"picture": file["image"][...], "total": total, "picture_error": file["image_error"][...],
                    "total_error": np.atleast_1d(file[("total" if "total" in file else "mean") + "_error"][...]),
                    "cpu": float(file.attrs["cpu_s"]), "plan": str(file.attrs["plan"])}


def squared_error(found, reference, of):
    """Returns the squared relative error, less that of the reference. The error of a total is one number, which may be
    small by accident: it is at least the reported one."""
    off = np.mean((found[of] - reference[of]) ** 2) - np.mean(reference[of + "_error"] ** 2)
    least = found[of + "_error"][0] ** 2 if of == "total" else 0
    return max(off, least) / np.mean(reference[of] ** 2)


def mean_cost(runs, reference, of):
    return np.mean([squared_error(run, reference, of) * run["cpu"] for run in runs])


def measure(scene, arguments):
    auto = scene.run(arguments.reference, 1000)
    methods = [method for method in METHODS if method != "forward" or scene.name not in NO_FORWARD]
    runs = {method: [] for method in methods}
    for seed in range(1, arguments.seeds + 1):
        for method in methods:
            runs[method].append(scene.run(arguments.seconds, seed, "--method", method))
    chosen = auto["plan"].split()[1].rstrip(":")
    for of in ("picture", "total"):
        costs = {method: mean_cost(runs[method], auto, of) for method in methods}
        print(f"{scene.name:15s} {of:8s} {chosen:14s}", *(f"{method} {costs[method] / costs[chosen]:8.3g}" for method in costs),
              "| chosen to " + ", ".join(f"{100 * error:g} %: {costs[chosen] / error**2:.3g} s" for error in ERRORS), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--seconds", type=float, default=1)
    parser.add_argument("--reference", type=float, default=20)
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--scenes", nargs="+", default=NAMES)
    parser.add_argument("--power", action="store_true")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for name in arguments.scenes:
            measure(Scene(arguments.program, name, pathlib.Path(folder), ["--pixels", "1", "1"] * arguments.power),
                    arguments)


if __name__ == "__main__":
    main()
