#!/usr/bin/env python3
"""Map of the memory-effect range, q L at C_I = 1/2, over (g, albedo) of a sweep, one panel per
optical depth (and method). Hatched: bounds, where a curve does not cross 1/2 within the tilts.
White: points that are not finished."""

from lib import curve_looks, page, script, style, sweep_file

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm

MOST_PANELS, MOST_CELLS = 12, 16
LEAST_CONTOURED = 6  # cells across and down: contours of fewer are all corners
MAP = plt.get_cmap("cividis")  # even steps of lightness, so that it survives in grey
STEPS = (1, 1.5, 2, 3, 5, 7)  # marks of the scale, in every decade, and contours
FEW_STEPS, WIDE = (1, 2, 5), 20  # contours where the ranges span more than this factor
SIGNS = {0: "", 1: ">", 2: "<"}
DAGGER = "\u2020"


def check(sweep):
    """The axis of the panels, or None; refuses what is no map."""
    for name in ("g", "albedo"):
        if sweep.is_list or name not in sweep.varying():
            sweep.refuse("a map needs a grid with at least two values of g and of albedo; "
                         "memory_range.py draws ranges of other sweeps")
        if len(sweep.values(name)) > MOST_CELLS:
            sweep.refuse(f"{len(sweep.values(name))} values of {name}, at most {MOST_CELLS} are legible",
                         (name, MOST_CELLS))
    others = [name for name in sweep.varying() if name not in ("g", "albedo")]
    panels = others[-1] if others else None
    sweep.refuse_others(others[:-1], f"g, albedo and {panels}")
    if panels and len(sweep.values(panels)) * len(sweep.prefixes) > MOST_PANELS:
        sweep.refuse(f"more than {MOST_PANELS} panels do not fit a page", (panels, 4))
    return panels


def table(sweep, rows, values):
    """Values of a panel's points as [albedo, g], albedo rising; masked where there is no point."""
    axes = [sweep.values(name) for name in ("albedo", "g")]
    cells = np.ma.masked_all([len(axis) for axis in axes], values.dtype)
    cells[tuple(np.searchsorted(axis, sweep.columns[name][rows])
                for axis, name in zip(axes, ("albedo", "g")))] = values[rows]
    return cells


def number(value):
    """Three digits, the same decimals for all of a magnitude."""
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
    """Levels of the contours; none of a map of few cells or with holes."""
    if holes or min(len(sweep.values(name)) for name in ("g", "albedo")) < LEAST_CONTOURED:
        return []
    steps = FEW_STEPS if norm.vmax > WIDE * norm.vmin else STEPS
    levels = [step * 10.0**power for power in range(-3, 4) for step in steps]
    return [level for level in levels if norm.vmin < level < norm.vmax]


def draw_contours(axis, values, censored, levels):
    """Between the centres of the cells, whose steps need not be equal; none beyond bounds."""
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
    """Largest relative error of a range that is no bound, in words."""
    errors = []
    for method in sweep.prefixes:
        value, error, censored = (column[sweep.rows] for column in sweep.ranges(method))
        errors += list((error / value)[censored == 0])
    kind = "errors" if sweep.result.attribute("errors") else "standard errors"
    return f"{kind} up to {100 * max(errors):.2g} %" if errors else "bounds alone"


def entries(sweep, holes):
    """Legend entries (handle, label)."""
    if sweep.has_bounds():
        yield (plt.Rectangle((0, 0), 1, 1, fill=False, hatch="////", edgecolor="0.4"),
               "bound: no crossing of 1/2 within the tilts")
    if sweep.has_few_steps():
        yield (plt.Line2D([], [], linestyle="none", marker=r"$\dagger$", color="black"),
               curve_looks.FEW_STEPS)
    if holes:
        yield plt.Rectangle((0, 0), 1, 1, fill=False, edgecolor="0.4"), "no point"


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
    spread = 1 if ranges.max() > 1.1 * ranges.min() else 1.2  # for a scale with room for marks
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
