#!/usr/bin/env python3
"""Range of the memory effect (q L at C_I = 1/2) against one parameter of a sweep. A second parameter distinguishes
curves, a third one panels. For a list of points that differ in several parameters at once, each point has a row.
Arrows mark bounds, where C_I does not cross 1/2 within the tilts."""

from lib import curve_looks, page, range_axes, range_list, script, style, sweep_file, theory

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.transforms import offset_copy

MOST_CURVES, MOST_PANELS, ACROSS = 8, 12, 3
ASIDE = {None: 0, "mc": -2.5, "wave": 2.5, "transport": 2.5}  # sideways shift of symbols, in points (1/72 inch)
DASH = {"marker": "_", "markersize": 9, "markeredgewidth": 0.7}  # diffusion theory of one point
STEPS = 300  # points of a line


def carrier(sweep, name):
    """Returns the parameter of the sweep along which `name` varies: `name` itself, or radius if g depends on the
    radius."""
    if name in sweep.axes:
        return name
    column = sweep.column(name)[sweep.rows]
    for axis in sweep.varying():
        fixed = [sweep.columns[other][sweep.rows] for other in sweep.varying() if other != axis]
        groups = np.unique(np.stack(fixed), axis=1, return_inverse=True)[1] if fixed else 0 * column
        if any(len(np.unique(column[groups == group])) > 1 for group in np.unique(groups)):
            return axis
    return name


def arrange(sweep, arguments):
    """Returns the parameters of (horizontal axis, curves, panels); None for those not needed."""
    axes = sweep.varying()
    if not axes:
        sweep.refuse("has a single point; a curve requires several")
    against = arguments.against or ([name for name in axes if name != arguments.curves] or axes)[-1]
    if len(np.unique(sweep.column(against)[sweep.rows])) < 2:
        sweep.refuse(f"{against} does not vary; --against must be one of {', '.join(axes)}")
    others = [name for name in axes if name not in (against, carrier(sweep, against))]
    if arguments.curves:
        if arguments.curves not in others:
            sweep.refuse(f"with --against {against}, --curves must be one of "
                         f"{', '.join(others) or 'none: no other parameter varies'}")
        others = [name for name in others if name != arguments.curves] + [arguments.curves]
    if len(others) > 2:
        sweep.refuse_others(others, against)
    return against, *([*reversed(others)] + [None, None])[:2]


def draw_bounds(axis, sweep, method, rows, x, numbers):
    """Draws bounds as arrows. Arrows at the same position are drawn side by side, because all curves that stay above
    1/2 have the same bound."""
    value, _, censored = sweep.ranges(method)
    bounds = rows[censored[rows] > 0]
    for position in np.unique(x[bounds]):
        peers = bounds[x[bounds] == position]
        for rank, row in enumerate(peers):
            look = curve_looks.curve_look(numbers[row], method)
            place = moved(axis, method, (6 if method else 3) * (rank - (len(peers) - 1) / 2))
            axis.plot(position, value[row], linestyle="none", transform=place, **look)
            curve_looks.draw_bound(axis, (position, value[row]), place,
                                   (0, curve_looks.ARROWS[censored[row]]), look["color"])


def moved(axis, method, points):
    """Returns a transform that shifts positions sideways by `points` (1/72 inch), so that the methods are drawn side
    by side."""
    return offset_copy(axis.transData, axis.figure, x=points + ASIDE[method], units="points")


def draw_curve(axis, sweep, method, rows, x, number):
    """Draws the points of one curve that are not bounds."""
    value, error, censored = (column[rows] for column in sweep.ranges(method))
    known, place = censored == 0, moved(axis, method, 0)
    axis.errorbar(x[rows][known], value[known], error[known], linestyle="none", elinewidth=0.7,
                  transform=place, **curve_looks.curve_look(number, method))
    few = sweep.few_steps(method)[rows]
    axis.plot(x[rows][few], value[few], transform=place, **curve_looks.RING)


def entries(sweep, curves, panels, single):
    """Yields legend entries (handle, label)."""
    theory = range_axes.diffusion_in_view(sweep, single)[1]
    for number, value in enumerate(sweep.values(curves) if curves else []):
        yield curve_looks.curve_handle(sweep, number, theory), sweep_file.text(curves, value)
    yield from curve_looks.method_entries(sweep)
    if theory:
        constants = [sweep.columns[name][sweep.rows] for name in (curves, panels) if name]
        # Theory of a curve with a single point is drawn as a dash.
        lone = constants and 1 in np.unique(constants, axis=1, return_counts=True)[1]
        marks = "lines and dashes" if lone else "lines"
        yield plt.Line2D([], [], color="black", linewidth=0.7), f"{marks}: diffusion theory"
    yield from curve_looks.range_entries(sweep)
    if single:
        yield plt.Line2D([], [], **curve_looks.SINGLE_SCATTERING), "single scattering"


def diffusion_line(axis, sweep, part, against, x):
    """Returns (x, range) of diffusion theory, also between the points if x is one of its parameters and all others
    are the same at these points."""
    medium = {name: sweep.columns[name][part] for name in ("optical_depth", "g", "albedo")}
    stored = x[part], sweep.optional("diffusion_range")[part]
    space = theory.dimension(sweep.result)
    if len(part) == 1 or any(len(np.unique(values)) > 1 for name, values in medium.items()
                             if name != against):
        return stored
    known = theory.diffusion_range(1, **medium, dimension=space)
    if against not in medium or not np.allclose(known, stored[1], rtol=1e-3):
        return stored
    scale = axis.xaxis.get_transform()
    fine = scale.inverted().transform(np.linspace(*scale.transform(x[part][[0, -1]]), STEPS))
    medium = {name: values[0] for name, values in medium.items()}
    medium[against] = 1 - fine if against == "albedo" else fine
    return fine, theory.diffusion_range(1, **medium, dimension=space)


def draw_panel(axis, sweep, rows, against, curves, single):
    x = sweep.column(against)
    x = np.round(1 - x, 12) if against == "albedo" else x
    for limit in single:
        axis.axhline(limit, **curve_looks.SINGLE_SCATTERING, zorder=0.5)
    diffusion, numbers, lines = sweep.optional("diffusion_range"), {}, []
    for curve, part in sweep.groups(curves, rows):
        number = list(sweep.values(curves)).index(curve) if curves else 0
        numbers.update({row: number for row in part})
        part = part[np.argsort(x[part], kind="stable")]
        if diffusion is not None:
            lines.append((style.line(number), part))
        for method in sweep.prefixes:
            draw_curve(axis, sweep, method, part, x, number)
    for method in sweep.prefixes:
        draw_bounds(axis, sweep, method, rows, x, numbers)
    range_axes.scale_axis(axis, against, x[sweep.rows], sweep.result.attribute("wavelength", 1))
    range_axes.scale_range(axis, sweep, single)
    for look, part in lines:
        axis.plot(*diffusion_line(axis, sweep, part, against, x), linewidth=0.7, zorder=1, **look,
                  **(DASH if len(part) == 1 else {}))
    axis.set_ylabel(range_axes.RANGE)


@script.plot()
@script.option("--against", choices=list(range_axes.LABELS),
               help="parameter of the horizontal axis (default: the innermost one that varies)")
@script.option("--curves", choices=list(range_axes.LABELS), help="parameter that distinguishes curves")
@sweep_file.SELECT
def draw(result, arguments):
    sweep = sweep_file.read(result, arguments)
    single = sweep.single_scattering_range()
    if sweep.is_list and len(sweep.varying()) > 1 and not (arguments.against or arguments.curves):
        return range_list.draw(sweep, single)
    against, curves, panels = arrange(sweep, arguments)
    for name, most, what in ((curves, MOST_CURVES, "curves"), (panels, MOST_PANELS, "panels")):
        if name and len(sweep.values(name)) > most:
            sweep.refuse(f"{len(sweep.values(name))} {what} needed, but at most {most} are legible", (name, 3))
    parts = sweep.groups(panels, sweep.rows)
    across = 2 if len(parts) == 4 else min(ACROSS, len(parts))
    figure, axes = page.page_of_panels(-(-len(parts) // across), across, len(parts))
    for axis, (value, rows) in zip(axes.flat, parts):
        draw_panel(axis, sweep, rows, against, curves, single or [])
        if panels:
            axis.set_title(sweep_file.text(panels, value), fontsize=7.5, pad=3)
    page.outer_labels(axes, len(parts))
    page.legend_outside(figure, list(entries(sweep, curves, panels, single or [])), sweep.notes())
    style.caption(figure, range_axes.notes(sweep, single))
    return figure
