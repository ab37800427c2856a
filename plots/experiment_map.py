#!/usr/bin/env python3
"""Map of a result of `sweep --of SUBCOMMAND` over the two keys that vary. --value names the dataset (default: total,
the power on the detector); NAME[i] takes number i of several at each point, as in power_within[0]. The largest value
(with --smallest, the smallest) is marked by a star. If only one key varies, a curve with error bars is drawn, with
short tangents if the result has derivatives with respect to that key (`render --gradient_by KEY`). --ideal_lens draws
the contour at which the value equals the power that an ideal lens would focus to a point behind the medium: all light
that crosses the stage unscattered, exp(-(mu_s + mu_a) length) of the beam."""

import math

from lib import labels, script, style
from lib.experiment import Number

import matplotlib.pyplot as plt
from matplotlib.ticker import EngFormatter
import numpy as np


class Grid:
    """Grid of the points of a sweep: the one or two keys that vary, outermost first, with their values. Cells without
    a point are empty."""

    def __init__(self, number):
        self.keys = {key: np.unique(column) for key, column in number.columns.items()
                     if len(np.unique(column)) > 1}
        path = number.result.path
        if len(self.keys) not in (1, 2):
            raise style.Unusable(f"{path}: {number.name} varies with {', '.join(self.keys) or 'nothing'}; "
                                 "a map requires two varying keys, a curve one")
        self.shape = tuple(map(len, self.keys.values()))
        self.places = tuple(np.searchsorted(values, number.columns[key])
                            for key, values in self.keys.items())
        if np.prod(self.shape) > 4 * len(self.places[0]):
            raise style.Unusable(f"{path}: the listed points do not form a grid")

    def of(self, column):
        """Returns values [point] as [key, key], with nan for missing points."""
        cells = np.full(self.shape, np.nan)
        cells[self.places] = column.reshape(len(self.places[0]))
        return cells


def ideal_lens(result):
    """Returns the power of the beam that crosses the stage unscattered along z."""
    keys = result.scene
    try:
        box = keys["stage_box"]
        return math.exp(-(keys.get("mu_s", 0) + keys.get("mu_a", 0)) * (box[5] - box[2])) * keys["beam_light"][7]
    except KeyError as missing:
        raise style.Unusable(f"{result.path}: --ideal_lens requires a beam along z through a box "
                             f"(beam_light and stage_box); the scene lacks {missing}")


def is_among(lens, values):
    return np.nanmin(values) < lens < np.nanmax(values)


def lens_text(lens, values, best):
    if is_among(lens, values):
        drawn = "dashed contour: equal to"
    else:
        drawn = "all values are larger than" if lens < best else "all values are smaller than"
    return (f"{drawn} the unscattered power that an ideal lens would focus to a point, {lens:.3g}; "
            f"the value at the star is {best / lens:.3g} times this power")


def key_label(result, key):
    return labels.with_unit(key, result.unit(key))


def scale_key(axis, side, values):
    """Makes an axis logarithmic if its values have equal ratios. Large numbers get SI prefixes instead of a common
    power of ten."""
    if style.in_equal_ratios(values):
        axis.set(**{f"{side}scale": "log"})
    elif max(map(abs, getattr(axis, f"get_{side}lim")())) > 1e5:
        getattr(axis, f"{side}axis").set_major_formatter(EngFormatter(sep=" "))


def draw_tangents(axis, place, values, slopes):
    """Draws tangents that extend over a third of the distance to the neighbouring points."""
    before, after = (np.append(place[0], place[:-1]) + 2 * place) / 3, (np.append(place[1:], place[-1]) + 2 * place) / 3
    for at, value, slope, *ends in zip(place, values, slopes, before, after):
        x = np.linspace(*ends, 9)  # several points, because a logarithmic axis bends the tangent
        axis.plot(x, value + slope * (x - at), color="black", linewidth=1, zorder=4,
                  label="derivative" if at == place[0] else None)


def draw_curve(axis, number, grid, lens, best):
    (key, place), = grid.keys.items()
    values, slopes = grid.of(number.values()), number.derivatives(key)
    if lens:
        axis.axhline(lens, color="gray", linestyle="--", label="ideal lens")
    axis.errorbar(place, values, grid.of(number.errors()), **style.look(0))
    if slopes is not None:
        draw_tangents(axis, place, values, grid.of(slopes))
    if axis.get_legend_handles_labels()[1]:
        axis.legend()
    axis.plot(place[best], values[best], "*", color="black", markersize=9, zorder=5)
    axis.set(xlabel=key_label(number.result, key), ylabel=number.label())
    scale_key(axis, "x", place)


def draw_map(figure, axis, number, grid, lens, best):
    """Draws the map. Returns the values of the keys at the star, and whether the star is at the edge."""
    (down, y), (across, x) = grid.keys.items()
    values = grid.of(number.values())
    mesh = axis.pcolormesh(x, y, values, cmap="cividis", shading="nearest")
    if min(values.shape) > 3 and np.nanmax(values) > np.nanmin(values):
        lines = axis.contour(x, y, values, colors="white", linewidths=0.6, levels=6)
        axis.clabel(lines, fontsize=5.5, fmt="%.3g")
    if lens and is_among(lens, values):
        axis.contour(x, y, values, colors="red", linewidths=1, linestyles="--", levels=[lens])
    row, column = np.unravel_index(best, values.shape)
    axis.plot(x[column], y[row], "*", color="white", markeredgecolor="black", markersize=10)
    axis.set(xlabel=key_label(number.result, across), ylabel=key_label(number.result, down))
    scale_key(axis, "x", x)
    scale_key(axis, "y", y)
    figure.colorbar(mesh, ax=axis, label=number.label())
    return {across: x[column], down: y[row]}, row in (0, len(y) - 1) or column in (0, len(x) - 1)


def say(figure, axis, number, grid, lens, best, star, at_edge, words):
    """Writes the value at the star above the map, and in the caption also what is not visible in the map."""
    values = grid.of(number.values())
    value, error = values.flat[best], grid.of(number.errors()).flat[best]
    noise = f" $\\pm$ {error:.2g}" if error > 0 else ""
    edge = ["at the edge of the map"] if at_edge else []
    axis.set_title(", ".join([f"star: {value:.4g}{noise}", *edge]), fontsize=7)
    place = ", ".join(f"{key} = {at:.3g}" for key, at in star.items())
    bias = (f" +- {error:.2g}; the {words[0]} of several noisy values is biased and tends to be too {words[1]}"
            if error > 0 else "")
    missing = int(np.isnan(values).sum())
    style.caption(figure, [f"star: {words[0]}, {place}, {value:.4g}{bias}",
                           *([f"white cells: {missing} of {values.size} points are missing or only bounds"] if missing else []),
                           *(f"the star is {text}; a better value may exist beyond it" for text in edge),
                           *([lens_text(lens, values, value)] if lens else [])])


@script.plot()
@script.option("--value", default="total", help="dataset with one number for each point, or NAME[i] (default: total)")
@script.option("--smallest", action="store_true", help="mark the smallest value instead of the largest")
@script.option("--ideal_lens", action="store_true", help="compare with all light that crosses the box unscattered")
def draw(result, arguments):
    number = Number(result, arguments.value)
    grid = Grid(number)
    lens = ideal_lens(result) if arguments.ideal_lens else None
    values = grid.of(number.values())
    best = int(np.nanargmin(values) if arguments.smallest else np.nanargmax(values))
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.6))
    if len(grid.keys) == 1:
        draw_curve(axis, number, grid, lens, best)
    else:
        star, at_edge = draw_map(figure, axis, number, grid, lens, best)
        say(figure, axis, number, grid, lens, best, star, at_edge,
            ("smallest", "small") if arguments.smallest else ("largest", "large"))
    return figure
