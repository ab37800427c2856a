#!/usr/bin/env python3
"""Error against run time of light transport, from the CSV of bench_render: bidirectional tracing and
the photon map with its default and its best radius; prints the times to equal errors."""

import argparse
import csv
import sys
from collections import defaultdict

from lib import style

import matplotlib.pyplot as plt
import numpy as np

TITLES = {"luneburg": "scattering Luneburg ball", "waveguide": "waveguide of ultrasound in tissue",
          "luneburg_wide_beam": "the ball under a wide beam",
          "luneburg_from_outside": "the ball seen from outside"}
TARGETS = (0.1, 0.05, 0.02, 0.01, 0.005, 0.002)


def read_runs(path):
    """{scene: {(method, radius): (processor seconds, errors)}}, medians over the runs."""
    rows = defaultdict(lambda: defaultdict(list))
    with open(path, newline="") as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            key = row["method"], float(row["photon_radius"])
            rows[row["scene"], key][row["seed"]].append(
                (float(row["cpu_s"]), float(row["relative_error"])))
    if not rows:
        raise style.Unusable(f"{path}: has no rows")
    runs = defaultdict(dict)
    for (scene, key), seeds in rows.items():
        shortest = min(len(points) for points in seeds.values())
        points = np.array([points[:shortest] for points in seeds.values()])
        cpu, error = np.median(points, axis=0).T
        seen = error > 0  # else below what the reference is off by
        if np.any(seen):
            runs[scene][key] = cpu[seen], error[seen]
    return runs


def lower_envelope(curves):
    """Of several radii: whichever is best by each time."""
    times = np.unique(np.concatenate([cpu for cpu, _ in curves]))
    best = [min((error[cpu <= time].min() for cpu, error in curves if np.any(cpu <= time)))
            for time in times]
    return times, np.array(best)


def bias_and_variance(curve, biased):
    """b^2 and v of error^2 = b^2 + v / time, by least squares of the relative deviations."""
    cpu, error = curve
    columns = np.stack([1 / error**2, 1 / (cpu * error**2)], axis=1)
    if biased:
        (square, variance), *_ = np.linalg.lstsq(columns, np.ones_like(cpu), rcond=None)
        if square > 0 and variance > 0:
            return square, variance
    return 0.0, np.median(cpu * error**2)


def time_to(curve, target, biased):
    """Infinite where the bias alone is more."""
    square, variance = bias_and_variance(curve, biased)
    return variance / (target**2 - square) if square < target**2 else np.inf


def methods_of(curves):
    """{name: curve}; photon map tuned: the best of all radii."""
    named = {method: curve for (method, _), curve in curves.items() if method != "photon_map"}
    maps = [curve for (method, _), curve in curves.items() if method.startswith("photon_map")]
    return {**named, "photon_map_tuned": lower_envelope(maps)}


def print_times(runs):
    """The best radius is another for each error."""
    print("CPU seconds to an error, by error^2 = bias^2 + variance / time; in "
          "brackets relative to bidirectional")
    for scene, curves in runs.items():
        unbiased = {method: curve for (method, _), curve in curves.items()
                    if not method.startswith("photon_map")}
        maps = {key: curve for key, curve in curves.items() if key[0].startswith("photon_map")}
        print(scene)
        for target in TARGETS:
            times = {name: time_to(curve, target, False) for name, curve in unbiased.items()}
            of_maps = {key: time_to(curve, target, True) for key, curve in maps.items()}
            default = next(time for key, time in of_maps.items() if key[0] == "photon_map_default")
            (_, radius), tuned = min(of_maps.items(), key=lambda item: item[1])
            ours = times["bidirectional"]
            print(f"  {target:6.3f}  " + "  ".join(f"{n} {t:.3g}" for n, t in times.items())
                  + f"  map, default {default:.3g} ({default / ours:.2g})"
                  + f"  map, best {tuned:.3g} ({tuned / ours:.2g}, radius {radius:.3g})")


def draw(runs):
    figure, axes = plt.subplots(1, len(runs), figsize=(style.PAGE, 2.9), squeeze=False)
    names = {"bidirectional": "bidirectional", "light": "light tracing", "path": "path tracing",
             "photon_map_default": "photon map, default radius",
             "photon_map_tuned": "photon map, best of six radii"}
    for axis, (scene, curves) in zip(axes[0], runs.items()):
        methods = methods_of(curves)
        for number, (method, title) in enumerate(names.items()):
            if method in methods:
                axis.loglog(*methods[method], **style.look(number), label=title)
        for (method, _), curve in curves.items():
            if method == "photon_map":
                axis.loglog(*curve, color=style.GREY, linewidth=0.4)
        axis.set_title(TITLES.get(scene, scene))
        axis.set_xlabel("processor time, one thread (s)")
    axes[0][0].set_ylabel("relative error of the picture, bias included")
    axes[0][-1].legend()
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("traces", metavar="TRACES.csv")
    parser.add_argument("--out", metavar="PREFIX", required=True,
                        help="writes PREFIX.png and PREFIX.pdf")
    arguments = parser.parse_args()
    try:
        runs = read_runs(arguments.traces)
    except (OSError, KeyError, ValueError, style.Unusable) as problem:
        print(f"{arguments.traces}: {problem}", file=sys.stderr)
        sys.exit(2)
    print_times(runs)
    style.save(draw(runs), arguments.out)


if __name__ == "__main__":
    main()
