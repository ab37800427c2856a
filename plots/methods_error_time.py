#!/usr/bin/env python3
"""Error against run time of the exact ensemble and of Monte Carlo, from the CSV of
bench_error_time; prints the table of times to 2 % and how their ratio grows."""

import argparse
import csv
import sys
from collections import defaultdict

from lib import style

import matplotlib.pyplot as plt
import numpy as np

TARGET = 0.02
TITLES = {"wave": "exact ensemble", "mc": "Monte Carlo"}


def read_traces(path):
    """{(depth, optical depth): {method: [(set-up, processor seconds, errors) of each run]}}."""
    rows = defaultdict(list)
    with open(path, newline="") as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            key = float(row["depth"]), float(row["optical_depth"]), row["method"], row["seed"]
            rows[key].append([float(row[name]) for name in ("setup_s", "cpu_s", "relative_error")])
    traces = defaultdict(lambda: defaultdict(list))
    for (depth, optical_depth, method, _), points in rows.items():
        traces[depth, optical_depth][method].append(np.array(points).T)
    return traces


def time_to_target(runs):
    """Median over the runs of the set-up and the time by slope -1/2 through the points around the
    target and below it; whether that is beyond the end of any."""
    times = []
    for setup, cpu, error in runs:
        near = error < max(2 * TARGET, 1.1 * error.min())
        times.append(setup[0] + np.median(cpu[near] * (error[near] / TARGET) ** 2))
    return np.median(times), any(error.min() > TARGET for _, _, error in runs)


def print_table(traces):
    """Times, ratios, and the fit log ratio = a + p log size + q log optical depth."""
    print("   box      OD  exact to 2 %  Monte Carlo    ratio   (* extrapolated)")
    rows = []
    for (depth, optical_depth), methods in sorted(traces.items()):
        (exact, beyond), (mc, _) = (time_to_target(methods[m]) for m in ("wave", "mc"))
        rows.append((np.log(depth), np.log(optical_depth), np.log(exact / mc)))
        mark = "*" if beyond else " "
        print(f"{2 * depth:4.0f} x {depth:<3.0f} {optical_depth:4.0f} {exact:10.3g} s{mark}"
              f" {1e3 * mc:9.3g} ms {exact / mc:9.0f}")
    size, density, ratio = np.array(rows).T
    fit, *_ = np.linalg.lstsq(np.stack([np.ones_like(size), size, density], axis=1), ratio,
                              rcond=None)
    print(f"ratio grows as size^{fit[1]:.2f} x OD^{fit[2]:.2f}")


def draw(traces):
    figure, axis = plt.subplots(figsize=(style.PAGE, 3.6))
    depths = sorted({depth for depth, _ in traces})
    optical_depths = sorted({optical_depth for _, optical_depth in traces})
    for (depth, optical_depth), methods in sorted(traces.items()):
        for method, runs in methods.items():
            setup, cpu, error = runs[0]
            axis.loglog(setup + cpu, error, color=style.COLOURS[depths.index(depth)],
                        linestyle=style.LINES[optical_depths.index(optical_depth)],
                        linewidth=1.4 if method == "mc" else 0.7)
    axis.axhline(TARGET, color=style.GREY, linewidth=0.5)
    axis.text(axis.get_xlim()[0] * 1.1, TARGET * 1.04, "2 %", color=style.GREY, fontsize=7)
    for depth in depths:
        axis.plot([], [], color=style.COLOURS[depths.index(depth)],
                  label=rf"${2 * depth:.0f} \times {depth:.0f}$")
    for number, optical_depth in enumerate(optical_depths):
        axis.plot([], [], color="0", linestyle=style.LINES[number], label=f"OD {optical_depth:g}")
    for method, width in (("mc", 1.4), ("wave", 0.7)):
        axis.plot([], [], color="0", linewidth=width, label=TITLES[method])
    axis.legend(ncols=3)
    axis.set_xlabel("processor time, one thread (s)")
    axis.set_ylabel("relative error of the intensities")
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("traces", metavar="TRACES.csv")
    parser.add_argument("--out", metavar="PREFIX", required=True,
                        help="writes PREFIX.png and PREFIX.pdf")
    arguments = parser.parse_args()
    try:
        traces = read_traces(arguments.traces)
    except (OSError, KeyError, ValueError) as problem:
        print(f"{arguments.traces}: {problem}", file=sys.stderr)
        sys.exit(2)
    print_table(traces)
    style.save(draw(traces), arguments.out)


if __name__ == "__main__":
    main()
