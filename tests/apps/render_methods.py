#!/usr/bin/python3
"""Methods of render on the shipped scenes: what each needs in processor time to an error of the picture and of the
total, against that which the pilot chooses, and photon maps of six radii.

    tests/apps/render_methods.py PROGRAM [--seconds T] [--reference R] [--seeds N] [--scenes NAME ...] [--power]

--power: of a single pixel, for which the pilot may choose otherwise.

Errors are those of runs of T seconds against a reference of R seconds by the chosen method, not those that runs claim.
That of an unbiased method falls as 1 / sqrt(time); that of a photon map is a bias and such a part, told apart by runs of
half and of four times T. Runs of all methods are made in turn, as the machine may be shared."""

import argparse
import pathlib
import subprocess
import tempfile

import h5py
import numpy as np

SCENES = pathlib.Path(__file__).resolve().parents[2] / "data" / "scenes"
RADII = {"luneburg": 0.05, "luneburg_pulse": 0.05, "slab": 0.005, "waveguide": 0.5, "fisheye": 0.06,
         "grin_fibre": 0.045, "glass_ball": 0.25}  # the program's own: a twentieth of the shortest length
FACTORS = (0.25, 0.5, 1, 2, 4, 8)
UNBIASED = ("path", "light", "bidirectional", "analog")
NO_ANALOG = ("luneburg", "slab", "fisheye", "glass_ball")  # no index field, or a camera
ERRORS = (0.1, 0.05, 0.02, 0.01, 0.005)


class Scene:
    def __init__(self, program, name, folder, extra):
        self.program, self.name, self.out, self.extra = program, name, folder / "out.h5", extra

    def run(self, seconds, seed, *flags):
        """Picture, total, processor seconds of the batches, and the plan."""
        subprocess.run([self.program, "render", "--config", SCENES / f"render_{self.name}.toml", "--threads", "1",
                        "--seconds", str(seconds), "--seed", str(seed), "--out", self.out, *self.extra, *map(str, flags)],
                       check=True, capture_output=True)
        with h5py.File(self.out) as file:
            total = np.atleast_1d(file["total" if "total" in file else "mean"][...])
            return {"picture": file["image"][...], "total": total, "picture_error": file["image_error"][...],
                    "total_error": np.atleast_1d(file[("total" if "total" in file else "mean") + "_error"][...]),
                    "cpu": float(file.attrs["cpu_s"]), "batches": file.attrs["samples"] / 16384,  # of a map
                    "plan": str(file.attrs["plan"])}


def squared_error(found, reference, of):
    """Relative, less what the reference itself is likely off by. That of a total is one number, which chance may make
    small: never less than what the run claims."""
    off = np.mean((found[of] - reference[of]) ** 2) - np.mean(reference[of + "_error"] ** 2)
    least = found[of + "_error"][0] ** 2 if of == "total" else 0
    return max(off, least) / np.mean(reference[of] ** 2)


def mean_cost(runs, reference, of):
    return np.mean([squared_error(run, reference, of) * run["cpu"] for run in runs])


def map_times(short, long, reference, of):
    """To each of ERRORS, of one radius; infinite where the bias is larger."""
    at = [(np.mean([run["cpu"] for run in runs]), np.mean([squared_error(run, reference, of) for run in runs]))
          for runs in (short, long)]
    (t1, e1), (t2, e2) = at
    noise = max(e1 - e2, 0) / (1 / t1 - 1 / t2)
    bias = max(e2 - noise / t2, 0)
    least = 2 * np.mean([run["cpu"] / run["batches"] for run in short + long])  # no run is shorter
    return [max(noise / (error**2 - bias), least) if error**2 > bias else np.inf for error in ERRORS]


def measure(scene, arguments):
    auto = scene.run(arguments.reference, 1000)
    flags = [("--method", method) for method in UNBIASED if method != "analog" or scene.name not in NO_ANALOG]
    radii = [("--method", "photon_map", "--photon_radius", factor * RADII[scene.name]) for factor in FACTORS]
    runs = {flag: [] for flag in flags}
    short, long = {flag: [] for flag in radii}, {flag: [] for flag in radii}
    for seed in range(1, arguments.seeds + 1):
        for flag in flags:
            runs[flag].append(scene.run(arguments.seconds, seed, *flag))
        for flag in radii:
            short[flag].append(scene.run(arguments.seconds / 2, seed, *flag))
            long[flag].append(scene.run(arguments.seconds * 4, seed, *flag))
    chosen = auto["plan"].split()[1].rstrip(":")
    for of in ("picture", "total"):
        costs = {flag[1]: mean_cost(runs[flag], auto, of) for flag in flags}
        maps = np.min([map_times(short[flag], long[flag], auto, of) for flag in radii], axis=0)
        print(f"{scene.name:15s} {of:8s} {chosen:14s}", *(f"{method} {costs[method] / costs[chosen]:8.3g}" for method in costs),
              "| chosen, best map to " + ", ".join(f"{100 * error:g} %: {costs[chosen] / error**2:.3g} {map:.3g} s"
                                                   for error, map in zip(ERRORS, maps)), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--seconds", type=float, default=1)
    parser.add_argument("--reference", type=float, default=20)
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--scenes", nargs="+", default=list(RADII))
    parser.add_argument("--power", action="store_true")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for name in arguments.scenes:
            measure(Scene(arguments.program, name, pathlib.Path(folder), ["--pixels", "1", "1"] * arguments.power),
                    arguments)


if __name__ == "__main__":
    main()
