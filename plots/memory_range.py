#!/usr/bin/env python3
"""Range of the memory effect, q L at C_I = 1/2, against one axis of a sweep; a second axis as
curves, a third as panels. Arrows: bounds, where a curve does not cross 1/2 within the tilts."""

import style

import range_axes
import sweep_file

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.transforms import offset_copy

MOST_CURVES, MOST_PANELS, ACROSS = 7, 12, 3
ASIDE = {None: 0, "mc": -2.5, "wave": 2.5}  # points of print
ABOVE = 1  # in range_censored: the curve stays above 1/2


def add_options(parser):
    parser.add_argument("--against", choices=list(range_axes.LABELS),
                        help="horizontal axis (default: the innermost that varies)")
    parser.add_argument("--curves", choices=list(range_axes.LABELS),
                        help="axis that sets the curves apart")
    sweep_file.add_select(parser)


def carrier(sweep, name):
    """The axis of the grid that a parameter varies along: itself, or radius where g depends on
    it."""
    if name in sweep.axes or sweep.is_list:
        return name
    column = sweep.column(name)[sweep.rows]
    for axis in sweep.varying():
        fixed = [sweep.columns[other][sweep.rows] for other in sweep.varying() if other != axis]
        groups = np.unique(np.stack(fixed), axis=1, return_inverse=True)[1] if fixed else 0 * column
        if any(len(np.unique(column[groups == group])) > 1 for group in np.unique(groups)):
            return axis
    return name


def share_curves(sweep, names):
    """Whether the points lie on curves of constant `names`, at least two on each on the average."""
    constants = np.stack([sweep.columns[name][sweep.rows] for name in names], axis=1)
    return len(sweep.rows) >= 2 * len(np.unique(constants, axis=0))


def arrange(sweep, arguments):
    """Axes of (horizontal axis, curves, panels); None where one is not needed."""
    axes = sweep.varying()
    if not axes:
        raise style.Unusable(f"{sweep.path}: one point is no curve")
    against = arguments.against or axes[-1]
    if len(np.unique(sweep.column(against)[sweep.rows])) < 2:
        raise style.Unusable(f"{sweep.path}: {against} does not vary; --against one of "
                             f"{', '.join(axes)}")
    others = [name for name in axes if name not in (against, carrier(sweep, against))]
    if arguments.curves:
        if arguments.curves not in others:
            raise style.Unusable(f"{sweep.path}: --curves should be one of "
                                 f"{', '.join(others) or 'nothing here'}")
        others = [name for name in others if name != arguments.curves] + [arguments.curves]
    if sweep.is_list and others and not share_curves(sweep, others):
        return against, None, None  # one cloud of points
    if len(others) > 2:
        raise style.Unusable(f"{sweep.path}: besides {against} it varies {', '.join(others)}; "
                             f"try --select {sweep.example(others[0], 1)}")
    return against, *([*reversed(others)] + [None, None])[:2]


def check_size(sweep, curves, panels):
    for name, most, what in ((curves, MOST_CURVES, "curves"), (panels, MOST_PANELS, "panels")):
        if name and len(sweep.values(name)) > most:
            raise style.Unusable(f"{sweep.path}: {len(sweep.values(name))} {what}, at most {most} "
                                 f"are legible; try --select {sweep.example(name, 3)}")


def draw_bounds(axis, sweep, method, rows, x, numbers):
    """Arrows away from points that are bounds. Those of one place stand side by side, because all
    curves that stay above 1/2 share their bound."""
    censored, value = (sweep.of(method, name) for name in ("range_censored", "memory_effect_range"))
    bounds = rows[censored[rows] > 0]
    for position in np.unique(x[bounds]):
        peers = bounds[x[bounds] == position]
        for rank, row in enumerate(peers):
            look = sweep_file.curve_look(numbers[row], method)
            place = moved(axis, method, 3 * (rank - (len(peers) - 1) / 2))
            axis.plot(position, value[row], linestyle="none", transform=place, **look)
            axis.annotate("", (position, value[row]), xycoords=place, textcoords="offset points",
                          xytext=(0, 11 if censored[row] == ABOVE else -11), zorder=1,
                          arrowprops={"arrowstyle": "<|-", "color": look["color"], "shrinkA": 0,
                                      "shrinkB": 2, "linewidth": 0.7, "mutation_scale": 6})


def moved(axis, method, points):
    """Places moved sideways by so many points of print; the methods stand beside each other."""
    return offset_copy(axis.transData, axis.figure, x=points + ASIDE[method], units="points")


def draw_diffusion(axis, sweep, rows, x, number, joined):
    """Diffusion theory of the same points: a line, or dashes where the points are on no curve."""
    diffusion = sweep.optional("diffusion_range")
    if diffusion is None:
        return
    look = style.look(number)
    if joined:
        axis.plot(x[rows], diffusion[rows], color=look["color"], linestyle=look["linestyle"],
                  linewidth=0.7, zorder=1)
    else:
        axis.plot(x[rows], diffusion[rows], color="black", linestyle="none", marker="_",
                  markersize=9, markeredgewidth=0.7, zorder=1)


def draw_curve(axis, sweep, method, rows, x, number):
    """The points of one curve that are no bounds."""
    value, error, censored = (sweep.of(method, name)[rows] for name in (
        "memory_effect_range", "memory_effect_range_error", "range_censored"))
    known = censored == 0
    axis.errorbar(x[rows][known], value[known], error[known], linestyle="none", elinewidth=0.7,
                  transform=moved(axis, method, 0), **sweep_file.curve_look(number, method))


def entries(sweep, curves, single, joined):
    """Legend entries (handle, label)."""
    diffusion = sweep.result.has("diffusion_range")
    for number, value in enumerate(sweep.values(curves) if curves else []):
        line = style.look(number)["linestyle"] if diffusion else "none"
        look = sweep_file.curve_look(number, "wave" if len(sweep.prefixes) > 1 else None)
        yield (plt.Line2D([], [], linewidth=0.7, linestyle=line, **{**look, "markersize": 3}),
               sweep_file.text(curves, value))
    yield from sweep_file.method_entries(sweep)
    if diffusion:
        handle = {"linewidth": 0.7} if joined else {"marker": "_", "linestyle": "none"}
        yield (plt.Line2D([], [], color="black", **handle),
               f"{'lines' if joined else 'dashes'}: diffusion theory")
    if any((sweep.of(method, "range_censored")[sweep.rows] > 0).any() for method in sweep.prefixes):
        yield plt.Line2D([], [], color="black", linestyle="none", marker=r"$\uparrow$",
                         markersize=6), "bound, no error bar"
    if single is not None:
        note = "" if len(single) else ": beyond the tilts"
        yield (plt.Line2D([], [], color="0.55", linewidth=1.6 if len(single) else 0),
               f"single scattering{note}")


def draw_panel(axis, sweep, rows, against, curves, single):
    x = range_axes.horizontal(sweep, against)
    for limit in single or []:
        axis.axhline(limit, color="0.55", linewidth=1.6, zorder=0.5)
    numbers = {}
    for curve, part in sweep.groups(curves, rows):
        number = list(sweep.values(curves)).index(curve) if curves else 0
        numbers.update({row: number for row in part})
        part = part[np.argsort(x[part], kind="stable")]
        draw_diffusion(axis, sweep, part, x, number, is_joined(sweep, curves))
        for method in sweep.prefixes:
            draw_curve(axis, sweep, method, part, x, number)
    for method in sweep.prefixes:
        draw_bounds(axis, sweep, method, rows, x, numbers)
    range_axes.scale_axis(axis, against, x[sweep.rows], sweep.result.attribute("wavelength", 1))
    range_axes.scale_range(axis, sweep, single or [])
    axis.set_ylabel(r"range $qL$ at $C_I = 1/2$")


def is_joined(sweep, curves):
    return curves is not None or not sweep.is_list


def draw(results, arguments):
    sweep = sweep_file.read(results, arguments)
    against, curves, panels = arrange(sweep, arguments)
    check_size(sweep, curves, panels)
    parts, single = sweep.groups(panels, sweep.rows), sweep.single_scattering_range()
    across = 2 if len(parts) == 4 else min(ACROSS, len(parts))
    figure, axes = style.page_of_panels(-(-len(parts) // across), across, len(parts))
    for axis, (value, rows) in zip(axes.flat, parts):
        draw_panel(axis, sweep, rows, against, curves, single)
        if panels:
            axis.set_title(sweep_file.text(panels, value), fontsize=7.5, pad=3)
    style.outer_labels(axes, len(parts))
    style.legend_above(figure, list(entries(sweep, curves, single, is_joined(sweep, curves))))
    return figure


if __name__ == "__main__":
    style.main(draw, __doc__, add_options=add_options)
