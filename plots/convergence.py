#!/usr/bin/env python3
"""Convergence of a sweep: relative error of every point against processor time or samples, with the target error.
Points that missed the target are marked and printed."""

from lib import page, script, style, sweep_file

import matplotlib.pyplot as plt
import numpy as np

MOST_NAMED, MOST_COLOURS = 6, 8
X_AXES = {"cpu": ("cpu_s", "processor time (s)"), "samples": ("samples", "number of samples")}
MAP = plt.get_cmap("viridis")
SHADES = 0.82  # used part of the colour map; its lightest colours are not visible on paper
LATE = {"marker": "X", "markersize": 6, "markeredgecolor": "black", "markeredgewidth": 0.6}
GUIDE = {"color": "black", "linewidth": 0.7, "linestyle": (0, (1, 2))}


def colours(sweep, axis):
    """Returns colour, from dark to light, and line style for every value of an axis."""
    values = sweep.values(axis) if axis else [None]
    steps = np.linspace(0, SHADES, len(values)) if len(values) > 1 else [0.3]
    return {value: {"color": MAP(step), "linestyle": style.LINES[number % 4]}
            for number, (value, step) in enumerate(zip(values, steps))}


def traces(sweep, method, column):
    """Returns {point: (x, relative error)} of the selected points, without rows that have no error, because the axes
    are logarithmic."""
    prefix = sweep.prefixes[method] + "trace/"
    point, x, error = (sweep.result.values(prefix + name)
                       for name in ("of_point", column, "relative_error"))
    shown = (x > 0) & (error > 0)
    return {row: (x[shown & (point == row)], error[shown & (point == row)]) for row in sweep.rows}


def missed(sweep, method):
    """Returns the points that ended above the target or without an error, the worst first."""
    target, error = sweep.target(method), sweep.of(method, "relative_error")
    late = [row for row in sweep.rows if target is not None and (error[row] > target or error[row] == 0)]
    return sorted(late, key=lambda row: -error[row])


def describe(sweep, method, row):
    names = sweep.varying() or ["optical_depth"]
    error = sweep.of(method, "relative_error")[row]
    reached = f"{100 * error:.2g} %" if error > 0 else "no error estimate"
    return f"{sweep.label([n for n in names if n in sweep.columns], row)}: {reached}"


def draw_panel(axis, sweep, method, arguments, looks, coloured):
    curves = traces(sweep, method, X_AXES[arguments.against][0])
    shown = {row: curve for row, curve in curves.items() if len(curve[0]) > 0}
    if not shown:
        sweep.refuse("no trace has a checkpoint with an error")
    thin = 0.9 if len(shown) < 30 else 0.5
    late = missed(sweep, method)
    for row, (x, error) in shown.items():
        look = looks[sweep.columns[coloured][row] if coloured else None]
        axis.plot(x, error, linewidth=thin, alpha=0.9, **look)
        axis.plot(x[-1], error[-1], color=look["color"], zorder=3,
                  **(LATE if row in late else {"marker": "o", "markersize": 1.8}))
    if sweep.target(method):
        axis.axhline(sweep.target(method), color=style.GREY, linewidth=0.8, zorder=0)
    x, error = min(shown.values(), key=lambda curve: np.min(curve[1] * np.sqrt(curve[0])))
    ends = np.array([x.min(), x.max()])  # ends of a guide of slope -1/2, below the lowest curve
    axis.plot(ends, 0.6 * np.min(error * np.sqrt(x)) / np.sqrt(ends), **GUIDE, zorder=0)
    axis.set(xscale="log", yscale="log", xlabel=X_AXES[arguments.against][1],
             ylabel="relative error")
    name_missed(axis, sweep, method, late)


def name_missed(axis, sweep, method, late):
    """Writes above the panel its method and the points that missed the target."""
    head = f"{sweep_file.METHODS[method]}: " if method else ""
    if sweep.target(method) is None:
        axis.set_title(f"{head}{len(sweep.rows)} points, no target", fontsize=7)
        return
    count, goal = len(sweep.rows), 100 * sweep.target(method)
    lines = [f"{head}{len(late)} of {count} points missed {goal:g} %"]
    lines += [describe(sweep, method, row) for row in late[:MOST_NAMED]]
    if len(late) > MOST_NAMED:
        lines.append(f"and {len(late) - MOST_NAMED} more")
    axis.set_title("\n".join(lines), fontsize=7, loc="left")
    for row in late:
        print(f"{head}missed the target: {describe(sweep, method, row)}".replace("$", ""))


def entries(sweep, coloured, looks):
    for value, look in looks.items() if coloured else []:
        yield plt.Line2D([], [], **look), sweep_file.text(coloured, value)
    if any(sweep.target(method) for method in sweep.prefixes):
        yield plt.Line2D([], [], color=style.GREY, linewidth=0.8), "target"
    if any(missed(sweep, method) for method in sweep.prefixes):
        yield plt.Line2D([], [], color="0.8", linestyle="none", **LATE), "missed the target"
    yield plt.Line2D([], [], **GUIDE), "slope $-1/2$"


@script.plot()
@script.option("--against", choices=list(X_AXES), default="cpu")
@script.option("--colour", choices=list(sweep_file.PARAMETERS),
               help="parameter shown by the colour of the curves (default: the outermost one with few values)")
@sweep_file.SELECT
def draw(result, arguments):
    sweep = sweep_file.read(result, arguments)
    axes = sweep.varying()
    if arguments.colour and arguments.colour not in axes:
        sweep.refuse(f"{arguments.colour} does not vary; --colour must be one of "
                     f"{', '.join(axes) or 'none: no parameter varies'}")
    few = [name for name in axes if len(sweep.values(name)) <= MOST_COLOURS]
    coloured = arguments.colour or next(iter(few), None)
    looks = colours(sweep, coloured)
    if len(looks) > MOST_COLOURS:
        sweep.refuse(f"{coloured} has {len(looks)} values, but colours can show at most {MOST_COLOURS}; "
                     "choose another --colour",
                     (coloured, MOST_COLOURS))
    across = len(sweep.prefixes)
    named = max(min(len(missed(sweep, method)), MOST_NAMED + 1) for method in sweep.prefixes)
    figure, axes = plt.subplots(1, across, squeeze=False,
                                figsize=([style.COLUMN, style.PAGE][across - 1], 2.7 + 0.13 * named))
    for axis, method in zip(axes.flat, sweep.prefixes):
        draw_panel(axis, sweep, method, arguments, looks, coloured)
    for axis in axes.flat:
        style.whole_decades(axis)
    limits = np.array([(*axis.get_xlim(), *axis.get_ylim()) for axis in axes.flat])
    for axis in axes.flat:  # both methods have the same range of the error axis
        axis.set(xlim=(limits[:, 0].min(), limits[:, 1].max()), ylim=(limits[:, 2].min(), limits[:, 3].max()))
    page.legend_outside(figure, list(entries(sweep, coloured, looks)), sweep.notes())
    return figure
