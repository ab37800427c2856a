#!/usr/bin/env python3
"""Error against processor time of the exact ensemble and of Monte Carlo, for boxes of several sizes and optical
depths, from a table such as data/methods_error_time.csv. Prints the times to an error of 2 %, and how their ratio
scales with size and optical depth."""

import functools

from lib import script, style
from lib.result_file import read_table

import matplotlib.pyplot as plt
import numpy as np

TARGET = 0.02
COLUMNS = ("method", "seed", "depth", "optical_depth", "setup_s", "cpu_s", "relative_error")
METHODS = {"mc": ("Monte Carlo", 1.4), "wave": ("exact ensemble", 0.7)}  # names, line widths


def boxes(rows):
    """Yields (depth, optical depth, {method: its runs, each the rows of one seed}) in ascending order."""
    for depth, optical_depth in np.unique(rows[["depth", "optical_depth"]]):
        box = rows[(rows["depth"] == depth) & (rows["optical_depth"] == optical_depth)]
        yield depth, optical_depth, {
            method: [own[own["seed"] == seed] for seed in dict.fromkeys(own["seed"])]
            for method in dict.fromkeys(box["method"]) for own in [box[box["method"] == method]]}


def time_to_target(runs):
    """Returns the time to the target error, and whether it is extrapolated for any run. The time is the set-up time
    plus the time on a line of slope -1/2 fitted to the points near or below the target; the median over the runs is
    returned."""
    times = []
    for run in runs:
        error = run["relative_error"]
        near = error < max(2 * TARGET, 1.1 * error.min())
        times.append(run["setup_s"][0] + np.median(run["cpu_s"][near] * (error[near] / TARGET) ** 2))
    return np.median(times), any(run["relative_error"].min() > TARGET for run in runs)


def print_table(rows):
    """Prints times, ratios, and the fit log ratio = a + p log size + q log optical depth."""
    print("   box      OD  exact to 2 %  Monte Carlo    ratio   (* extrapolated)")
    found = []
    for depth, optical_depth, methods in boxes(rows):
        (exact, beyond), (mc, _) = (time_to_target(methods[method]) for method in ("wave", "mc"))
        found.append((1, np.log(depth), np.log(optical_depth), np.log(exact / mc)))
        print(f"{2 * depth:4.0f} x {depth:<3.0f} {optical_depth:4.0f} {exact:10.3g} s"
              f"{'*' if beyond else ' '} {1e3 * mc:9.3g} ms {exact / mc:9.0f}")
    *columns, ratio = np.array(found).T
    (_, size, density), *_ = np.linalg.lstsq(np.stack(columns, axis=1), ratio, rcond=None)
    print(f"ratio grows as size^{size:.2f} x OD^{density:.2f}")


@script.plot(read=functools.partial(read_table, columns=COLUMNS), metavar="TRACES.csv")
def draw(rows):
    print_table(rows)
    figure, axis = plt.subplots(figsize=(style.PAGE, 3.6))
    colours = dict(zip(np.unique(rows["depth"]), style.COLOURS))
    lines = dict(zip(np.unique(rows["optical_depth"]), style.LINES))
    for depth, optical_depth, methods in boxes(rows):
        for method, runs in methods.items():
            axis.loglog(runs[0]["setup_s"] + runs[0]["cpu_s"], runs[0]["relative_error"],
                        color=colours[depth], linestyle=lines[optical_depth],
                        linewidth=METHODS[method][1])
    axis.axhline(TARGET, color=style.GREY, linewidth=0.5)
    axis.text(axis.get_xlim()[0] * 1.1, TARGET * 1.04, "2 %", color=style.GREY, fontsize=7)
    entries = [(rf"${2 * depth:.0f} \times {depth:.0f}$", {"color": colour})
               for depth, colour in colours.items()]
    entries += [(f"OD {depth:g}", {"color": "0", "linestyle": line}) for depth, line in lines.items()]
    entries += [(name, {"color": "0", "linewidth": width}) for name, width in METHODS.values()]
    for label, look in entries:
        axis.plot([], [], **look, label=label)
    axis.legend(ncols=3)
    axis.set(xlabel="processor time, one thread (s)", ylabel="relative error of the intensities")
    return figure
