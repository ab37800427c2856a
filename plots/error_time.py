#!/usr/bin/env python3
"""Relative error against processor time: every convergence trace in the given result files, with its fitted slope."""

import pathlib

from lib import script, style

import h5py
import matplotlib.pyplot as plt
import numpy as np

MOST_LABELS = 7


def traces_of(result):
    """Returns the names of the groups that contain a trace, such as trace or mc/trace. Groups in state/ are excluded,
    because they repeat the same traces for resuming a run."""
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
    """Yields (label, processor seconds, errors) of a trace, or of each point's trace for a sweep. Checkpoints with
    fewer than four times the samples of the first one are omitted, because errors estimated from few batches are
    unreliable. Rows without an error cannot be shown on logarithmic axes."""
    columns = [result.values(f"{name}/{column}") for column in ("cpu_s", "samples", "relative_error")]
    is_sweep = result.has(f"{name}/of_point")
    point = result.values(f"{name}/of_point") if is_sweep else np.zeros(len(columns[0]))
    for number in np.unique(point):
        cpu, samples, error = (column[point == number] for column in columns)
        rows = (cpu > 0) & (error > 0) & (samples >= 4 * samples.min(initial=np.inf))
        words = [name.split("/")[0] if "/" in name else "", f"point {number}" if is_sweep else ""]
        if rows.any():
            yield " ".join(filter(None, words)), cpu[rows], error[rows]


def read_all(results):
    """Returns (label, processor seconds, errors) of every trace that has errors."""
    traces = []
    for result in results:
        stem = pathlib.Path(result.path).stem if len(results) > 1 else ""
        traces += [(f"{stem} {label}".strip() or "run", cpu, error) for name in traces_of(result)
                   for label, cpu, error in read_traces(result, name)]
    if not traces:
        raise style.Unusable(f"{results[0].path}: no trace has a checkpoint with an error")
    return traces


@script.plot(several=True)
def draw(results):
    traces = read_all(results)
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.7))
    few = len(traces) <= MOST_LABELS
    slopes = [np.polyfit(np.log(cpu), np.log(error), 1)[0] if len(cpu) > 1 else np.nan
              for _, cpu, error in traces]
    for number, (name, cpu, error) in enumerate(traces):
        look = style.look(number) if few else {"color": style.COLOURS[0], "alpha": 0.35}
        fitted = f", slope ${slopes[number]:.2f}$" if np.isfinite(slopes[number]) else ""
        axis.loglog(cpu, error, **look, markersize=2.5, linewidth=0.7,
                    label=name + fitted if few else None)
    if not few:
        fitted = [s for s in slopes if np.isfinite(s)]
        middle = f", median slope ${np.median(fitted):.2f}$" if fitted else ""
        axis.plot([], [], color=style.COLOURS[0], alpha=0.35, label=f"{len(traces)} runs{middle}")
    ends = np.array([min(t[1].min() for t in traces), max(t[1].max() for t in traces)])
    level = min(np.min(error * np.sqrt(cpu)) for _, cpu, error in traces)
    axis.plot(ends, 0.6 * level / np.sqrt(ends), color=style.GREY, linewidth=0.7,
              linestyle=(0, (4, 2)), label="guide with slope $-1/2$", zorder=0)
    style.whole_decades(axis)
    axis.set(xlabel="processor time (s)", ylabel="relative error")
    axis.legend()
    return figure
