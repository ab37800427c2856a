#!/usr/bin/env python3
"""Error against run time of light transport, from the CSV of bench_render: bidirectional tracing and
the photon map with its default and its best radius; prints the ratios of times to equal error."""

import argparse
import csv
import sys
from collections import defaultdict

from lib import style

import matplotlib.pyplot as plt
import numpy as np

TITLES = {"luneburg": "scattering Luneburg ball", "waveguide": "waveguide of ultrasound in tissue"}


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
        runs[scene][key] = tuple(np.median(points, axis=0).T)
    return runs


def lower_envelope(curves):
    """Of several radii: whichever is best by each time."""
    times = np.unique(np.concatenate([cpu for cpu, _ in curves]))
    best = [min((error[cpu <= time].min() for cpu, error in curves if np.any(cpu <= time)))
            for time in times]
    return times, np.array(best)


def time_to(curve, target):
    """By slope -1/2 through the points of a curve without bias."""
    cpu, error = curve
    return np.median(cpu * (error / target) ** 2)


def methods_of(curves):
    """{name: curve}; photon map tuned: the best of all radii."""
    named = {method: curve for (method, _), curve in curves.items() if method != "photon_map"}
    maps = [curve for (method, _), curve in curves.items() if method.startswith("photon_map")]
    return {**named, "photon_map_tuned": lower_envelope(maps)}


def print_ratios(runs):
    print("scene       photon map  radius   error   its time  bidirectional   ratio")
    for scene, curves in runs.items():
        ours = curves["bidirectional", 0.0]
        default = next(key for key in curves if key[0] == "photon_map_default")
        tuned = min((key for key in curves if key[0].startswith("photon_map")),
                    key=lambda key: curves[key][1].min())
        for name, key in (("default", default), ("tuned", tuned)):
            cpu, error = curves[key]
            best = np.argmin(error)
            time = time_to(ours, error[best])
            print(f"{scene:12s}{name:11s}{key[1]:7.3g}{error[best]:8.3f}{cpu[best]:9.2f} s"
                  f"{time:13.3f} s{cpu[best] / time:8.1f}")


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
    print_ratios(runs)
    style.save(draw(runs), arguments.out)


if __name__ == "__main__":
    main()
