"""Draws the memory-effect ranges of a list of points, with a row for each point, labelled by its parameters."""

from lib import curve_looks, page, range_axes, style

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.transforms import offset_copy

MOST_POINTS = 40
STEP = 0.2  # inches from row to row
ASIDE = {None: 0, "mc": 2, "wave": -2, "transport": -2}  # shift of symbols, in points (1/72 inch)
THEORY = {"color": "black", "marker": "|", "markersize": 8, "linestyle": "none"}


def draw_method(axis, sweep, method, places):
    value, error, censored = (column[sweep.rows] for column in sweep.ranges(method))
    look = {"marker": "o", **curve_looks.method_look(method, style.COLOURS[0])}
    place = offset_copy(axis.transData, axis.figure, y=ASIDE[method], units="points")
    axis.plot(value, places, linestyle="none", transform=place, **look)
    known = censored == 0
    axis.errorbar(value[known], places[known], xerr=error[known], fmt="none", elinewidth=0.7,
                  ecolor=look["color"], transform=place)
    for row in np.flatnonzero(censored):
        curve_looks.draw_bound(axis, (value[row], places[row]), place,
                               (curve_looks.ARROWS[censored[row]], 0), look["color"])
    few = sweep.few_steps(method)[sweep.rows]
    axis.plot(value[few], places[few], transform=place, **curve_looks.RING)


def entries(sweep, single):
    """Yields legend entries (handle, label)."""
    yield from curve_looks.method_entries(sweep)
    if range_axes.diffusion_in_view(sweep, single)[1]:
        yield plt.Line2D([], [], **THEORY), "diffusion theory"
    yield from curve_looks.range_entries(sweep)
    if single:
        yield plt.Line2D([], [], **curve_looks.SINGLE_SCATTERING), "single scattering"


def draw(sweep, single):
    """Draws the rows. single: result of Sweep.single_scattering_range."""
    if len(sweep.rows) > MOST_POINTS:
        sweep.refuse(f"{len(sweep.rows)} points, but at most {MOST_POINTS} rows are legible",
                     (sweep.varying()[0], 3))
    places = np.arange(len(sweep.rows))
    figure, axis = plt.subplots(figsize=(style.COLUMN + 1.4, 0.6 + STEP * (len(places) + 1)))
    limits = single or []
    for limit in limits:
        axis.axvline(limit, **curve_looks.SINGLE_SCATTERING, zorder=0.5)
    diffusion = sweep.optional("diffusion_range")
    if diffusion is not None:
        axis.plot(diffusion[sweep.rows], places, zorder=1, **THEORY)
    for method in sweep.prefixes:
        draw_method(axis, sweep, method, places)
    range_axes.scale_range(axis, sweep, limits, vertical=False)
    axis.set_xlabel(range_axes.RANGE)
    axis.set_yticks(places, [sweep.label(sweep.varying(), row) for row in sweep.rows])
    axis.set_ylim(len(places) - 0.4, -0.6)
    axis.tick_params(axis="y", length=0)
    axis.grid(axis="y", color="0.9", linewidth=0.5)
    axis.set_axisbelow(True)
    page.legend_outside(figure, list(entries(sweep, limits)), sweep.notes())
    style.caption(figure, range_axes.notes(sweep, single))
    return figure
