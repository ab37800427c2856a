#!/usr/bin/env python3
"""Error against run time: every trace of the given result files, with its fitted slope."""

import pathlib

from lib import script, style

import h5py
import matplotlib.pyplot as plt
import numpy as np

MOST_LABELS = 7


def traces_of(result):
    """Names of the groups that hold a trace: trace, mc/trace. Those of state/, kept to resume a run,
    say the same again."""
    names = []

    def visit(name, item):
        parts = name.split("/")
        if isinstance(item, h5py.Group) and parts[-1] == "trace" and parts[0] != "state":
            names.append(name)

    result.file.visititems(visit)
    if not names:
        raise style.Unusable(f"{result.path}: has no trace")
    return sorted(names)


def read_traces(result, name):
    """(label, processor seconds, errors) of a trace, or of each point of a sweep's."""
    columns = np.array([result.values(f"{name}/{column}")
                        for column in ("cpu_s", "samples", "relative_error")])
    method = name.split("/")[0] if "/" in name else ""
    if not result.has(f"{name}/of_point"):
        return [(method, *shown(*columns))]
    point = result.values(f"{name}/of_point")
    return [(f"{method} point {number}".strip(), *shown(*columns[:, point == number]))
            for number in np.unique(point)]


def shown(cpu, samples, error):
    """Processor seconds and relative errors, from four times the samples of the first checkpoint on:
    the error of a handful of batches says little. Rows without an error cannot be shown on log axes.
    """
    rows = (cpu > 0) & (error > 0) & (samples >= 4 * samples.min(initial=np.inf))
    return cpu[rows], error[rows]


def slope(cpu, error):
    return np.polyfit(np.log(cpu), np.log(error), 1)[0] if len(cpu) > 1 else np.nan


def read_all(results):
    """(label, processor seconds, errors) of every trace with something to show."""
    traces = []
    for result in results:
        for name in traces_of(result):
            stem = pathlib.Path(result.path).stem if len(results) > 1 else ""
            traces += [(f"{stem} {label}".strip() or "run", cpu, error)
                       for label, cpu, error in read_traces(result, name) if len(cpu) > 0]
    if not traces:
        raise style.Unusable(f"{results[0].path}: no trace has a checkpoint with an error")
    return traces


def draw_guide(axis, traces):
    """Slope -1/2, below all curves."""
    cpu = np.array([min(t[1].min() for t in traces), max(t[1].max() for t in traces)])
    level = min(np.min(error * np.sqrt(times)) for _, times, error in traces)
    axis.plot(cpu, 0.6 * level / np.sqrt(cpu), color=style.GREY, linewidth=0.7,
              linestyle=(0, (4, 2)), label="guide: slope $-1/2$", zorder=0)


@script.plot(several=True)
def draw(results):
    traces = read_all(results)
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.7))
    few = len(traces) <= MOST_LABELS
    slopes = [slope(cpu, error) for _, cpu, error in traces]
    for number, (name, cpu, error) in enumerate(traces):
        look = style.look(number) if few else {"color": style.COLOURS[0], "alpha": 0.35}
        fitted = f", slope ${slopes[number]:.2f}$" if np.isfinite(slopes[number]) else ""
        axis.loglog(cpu, error, **look, markersize=2.5, linewidth=0.7,
                    label=name + fitted if few else None)
    if not few:
        fitted = [s for s in slopes if np.isfinite(s)]
        middle = f", median slope ${np.median(fitted):.2f}$" if fitted else ""
        axis.plot([], [], color=style.COLOURS[0], alpha=0.35, label=f"{len(traces)} runs{middle}")
    draw_guide(axis, traces)
    style.whole_decades(axis)
    axis.set(xlabel="processor time (s)", ylabel="relative error")
    axis.legend()
    return figure
