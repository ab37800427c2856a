#!/usr/bin/env python3
"""Map of the memory-effect range (q L at C_I = 1/2) over g and albedo from a sweep, one panel per optical depth and
method. Hatched: bounds, where C_I does not cross 1/2 within the tilts. White: points that are not finished."""

from lib import curve_looks, page, script, style, sweep_file

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm

MOST_PANELS, MOST_CELLS = 12, 16
LEAST_CONTOURED = 6  # cells in each direction; contours over fewer cells are too coarse
MAP = plt.get_cmap("cividis")  # lightness increases uniformly, so that the map is readable in grey
STEPS = (1, 1.5, 2, 3, 5, 7)  # ticks of the colour scale in every decade, and levels of contours
FEW_STEPS, WIDE = (1, 2, 5), 20  # levels if the ranges span more than the factor WIDE
SIGNS = {0: "", 1: ">", 2: "<"}
DAGGER = "\u2020"


def check(sweep):
    """Returns the parameter that distinguishes panels, or None. Raises Unusable for a sweep that is not a map."""
    for name in ("g", "albedo"):
        if sweep.is_list or name not in sweep.varying():
            sweep.refuse("a map needs a grid with at least two values of g and of albedo; "
                         "draw other sweeps with memory_range.py")
        if len(sweep.values(name)) > MOST_CELLS:
            sweep.refuse(f"{name} has {len(sweep.values(name))} values, but at most {MOST_CELLS} are legible",
                         (name, MOST_CELLS))
    others = [name for name in sweep.varying() if name not in ("g", "albedo")]
    panels = others[-1] if others else None
    sweep.refuse_others(others[:-1], f"g, albedo and {panels}")
    if panels and len(sweep.values(panels)) * len(sweep.prefixes) > MOST_PANELS:
        sweep.refuse(f"more than {MOST_PANELS} panels do not fit a page", (panels, 4))
    return panels


def table(sweep, rows, values):
    """Returns values of a panel's points as [albedo, g], in ascending order, masked where there is no point."""
    axes = [sweep.values(name) for name in ("albedo", "g")]
    cells = np.ma.masked_all([len(axis) for axis in axes], values.dtype)
    cells[tuple(np.searchsorted(axis, sweep.columns[name][rows])
                for axis, name in zip(axes, ("albedo", "g")))] = values[rows]
    return cells


def number(value):
    """Returns a number as text with three significant digits; numbers of the same magnitude have the same
    decimals."""
    return f"{value:.{max(0, 2 - int(np.log10(max(value, 1))))}f}"


def draw_numbers(axis, values, censored, few, norm):
    size = min(6.5, 37 / values.shape[1])
    for row, column in np.argwhere(~np.ma.getmaskarray(values)):
        value, kind, doubt = (cells[row, column] for cells in (values, censored, few))
        words = (f"{SIGNS[kind]}{value:.3g}" if kind else number(value)) + DAGGER * int(doubt)
        behind = {"facecolor": MAP(norm(value)), "edgecolor": "none", "pad": 0.4}
        axis.text(column, row, words, ha="center", va="center",
                  fontsize=size, color="white" if norm(value) < 0.55 else "black", bbox=behind)


def contour_levels(sweep, norm, holes):
    """Returns the levels of the contours; none for a map with few cells or with missing points."""
    if holes or min(len(sweep.values(name)) for name in ("g", "albedo")) < LEAST_CONTOURED:
        return []
    steps = FEW_STEPS if norm.vmax > WIDE * norm.vmin else STEPS
    levels = [step * 10.0**power for power in range(-3, 4) for step in steps]
    return [level for level in levels if norm.vmin < level < norm.vmax]


def draw_contours(axis, values, censored, levels):
    """Draws contours, interpolated between the centres of cells, whose steps need not be equal. Cells with bounds are
    excluded."""
    logarithm = np.ma.array(np.ma.log(values), mask=(censored > 0).filled(True))
    crossed = [np.log(level) for level in levels
               if logarithm.min() < np.log(level) < logarithm.max()]
    if crossed:
        axis.contour(logarithm, crossed, colors="white", linewidths=1.6)
        axis.contour(logarithm, crossed, colors="black", linewidths=0.7)


def draw_panel(axis, sweep, rows, method, norm, levels):
    values, _, censored = (table(sweep, rows, column) for column in sweep.ranges(method))
    edges = [np.arange(count + 1) - 0.5 for count in reversed(values.shape)]
    image = axis.pcolormesh(*edges, values, cmap=MAP, norm=norm, edgecolors="face", linewidth=0.2)
    for row, column in np.argwhere((censored > 0).filled(False)):
        axis.add_patch(plt.Rectangle((column - 0.5, row - 0.5), 1, 1, fill=False, hatch="////",
                                     edgecolor="0.4", linewidth=0))
    draw_contours(axis, values, censored, levels)
    draw_numbers(axis, values, censored, table(sweep, rows, sweep.few_steps(method)), norm)
    for side, name in ((axis.xaxis, "g"), (axis.yaxis, "albedo")):
        side.set_ticks(range(len(sweep.values(name))), style.short(sweep.values(name)))
    axis.tick_params(length=0)
    axis.set(xlabel="mean cosine $g$", ylabel="albedo")
    return image


def colour_bar(figure, axes, image, levels):
    bar = figure.colorbar(image, ax=[axis for axis in axes.flat if axis.figure], aspect=35,
                          pad=0.015, fraction=0.05)
    style.few_decades(bar.ax.yaxis, STEPS)
    for level in levels:
        bar.ax.axhline(level, color="white", linewidth=1.6)
        bar.ax.axhline(level, color="black", linewidth=0.7)
    bar.set_label(r"range $qL$ at $C_I = 1/2$" + (", lines: contours" if levels else ""))


def worst_error(sweep):
    """Returns a text with the largest relative error of all ranges that are not bounds."""
    errors = []
    for method in sweep.prefixes:
        value, error, censored = (column[sweep.rows] for column in sweep.ranges(method))
        errors += list((error / value)[censored == 0])
    kind = "errors" if sweep.result.attribute("errors") else "standard errors"
    return f"{kind} up to {100 * max(errors):.2g} %" if errors else "all ranges are bounds"


def entries(sweep, holes):
    """Yields legend entries (handle, label)."""
    if sweep.has_bounds():
        yield (plt.Rectangle((0, 0), 1, 1, fill=False, hatch="////", edgecolor="0.4"),
               "bound: $C_I$ does not cross 1/2 within the tilts")
    if sweep.has_few_steps():
        yield (plt.Line2D([], [], linestyle="none", marker=r"$\dagger$", color="black"),
               curve_looks.FEW_STEPS)
    if holes:
        yield plt.Rectangle((0, 0), 1, 1, fill=False, edgecolor="0.4"), "no data"


@script.plot()
@sweep_file.SELECT
def draw(result, arguments):
    sweep = sweep_file.read(result, arguments)
    panels = check(sweep)
    shown = [(method, value, rows) for method in sweep.prefixes
             for value, rows in sweep.groups(panels, sweep.rows)]
    across = min(3, len(shown) // len(sweep.prefixes) if len(shown) != 4 else 2)
    figure, axes = page.page_of_panels(-(-len(shown) // across), across, len(shown))
    ranges = np.concatenate([sweep.of(method, "memory_effect_range")[rows]
                             for method, _, rows in shown])
    spread = 1 if ranges.max() > 1.1 * ranges.min() else 1.2  # widens the colour scale so that it has room for ticks
    norm = LogNorm(ranges.min() / spread, ranges.max() * spread)
    cells = len(sweep.values("g")) * len(sweep.values("albedo"))
    holes = any(len(rows) < cells for _, _, rows in shown)
    levels = contour_levels(sweep, norm, holes)
    for axis, (method, value, rows) in zip(axes.flat, shown):
        image = draw_panel(axis, sweep, rows, method, norm, levels)
        words = [sweep_file.METHODS[method]] if method else []
        words += [sweep_file.text(panels, value)] if panels else []
        axis.set_title(", ".join(words), fontsize=7.5, pad=3)
    page.outer_labels(axes, len(shown))
    colour_bar(figure, axes, image, levels)
    page.legend_outside(figure, list(entries(sweep, holes)), sweep.notes())
    style.caption(figure, [worst_error(sweep)])
    return figure
