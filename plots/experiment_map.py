#!/usr/bin/env python3
"""Map of a number of a sweep of another subcommand (--value, by default the power on the detector) over two of its keys, with contours and
its largest value (--smallest: smallest) marked; with one key a curve with its errors, and short tangents where the result has the derivative by
that key (`render --gradient_by KEY`). --value NAME[i] takes the i-th of several numbers, as in
power_within[0]. --ideal_lens draws where that number is what an ideal lens before the medium would bring to a point there: all light that
comes unscattered through the stage, exp(-(mu_s + mu_a) length)."""

import math
import re
import tomllib

from lib import labels, style
from lib.result_file import Unusable

import matplotlib.pyplot as plt
from matplotlib.ticker import EngFormatter
import numpy as np


def points_of(result, name):
    """A list of points as the grid that it is part of, with holes: keys with their values, values, errors."""
    keys = [key.replace(".", "_") for key in result.swept()]
    columns = [result.values(key) for key in keys]
    own = [np.unique(column) for column in columns]
    shape = [len(values) for values in own]
    if np.prod(shape) > 4 * len(columns[0]):
        raise Unusable(f"{result.path}: a list of points that make no grid")
    places = tuple(np.searchsorted(values, column) for values, column in zip(own, columns))
    grids = np.full((2, *shape), np.nan)
    for grid, values in zip(grids, values_of(result, name)):
        grid[places] = values.reshape(len(columns[0]))
    return list(zip(keys, own)), *grids


def entry_of(name):
    """The dataset, and which of several numbers."""
    found = re.fullmatch(r"(.*?)(?:\[(\d+)\])?", name)
    return found[1], None if found[2] is None else int(found[2])


def numbers_of(result, path, entry):
    values = result.values(path)
    if entry is None:
        return values
    if values.ndim == len(result.dataset("samples").shape) or entry >= values.shape[-1]:
        raise Unusable(f"{result.path}: {path} has no number {entry} at each point")
    return values[..., entry]


def values_of(result, name):
    path, entry = entry_of(name)
    values = numbers_of(result, path, entry)
    return values, numbers_of(result, f"{path}_error", entry) if result.has(f"{path}_error") else np.zeros_like(values)


def slopes_of(result, name, key):
    """Its derivative by the key at each point, or None."""
    path, entry = entry_of(name)
    if not result.has(f"{path}_gradient"):
        return None
    parameters = list(result.dataset("parameter").attrs["names"])
    if key not in parameters:
        return None
    gradients = numbers_of(result, f"{path}_gradient", entry)
    return np.take(gradients, parameters.index(key), axis=len(result.dataset("samples").shape)).ravel()


def grid_of(result, arguments):
    name = arguments.value
    if not result.swept():
        raise Unusable(f"{result.path}: no sweep of another subcommand")
    path, entry = entry_of(name)
    if not result.has(path):
        raise Unusable(f"{result.path}: has no dataset {name}; --value takes one of {', '.join(result.numbers())}, or one of "
                       "several numbers at each point, as power_within[0]")
    scales = [scale[0] for scale in result.dataset(path).dims]
    axes = [(scale.name.strip("/"), scale[...]) for scale in (scales if entry is None else scales[:-1])]
    if any(key == "point" for key, _ in axes):
        axes, values, errors = points_of(result, name)
    else:
        values, errors = values_of(result, name)
    keep = [(key, own) for key, own in axes if len(own) > 1]
    if len(keep) not in (1, 2):
        raise Unusable(f"{result.path}: {name} varies with {', '.join(key for key, _ in keep) or 'nothing'}; a map has two keys")
    shape = [len(own) for _, own in keep]
    return keep, values.reshape(shape), errors.reshape(shape)


def ideal_lens(result):
    """What comes unscattered through the stage, along its axis."""
    keys = tomllib.loads(result.attribute("config"))
    try:
        box = keys["stage_box"]
        return math.exp(-(keys.get("mu_s", 0) + keys.get("mu_a", 0)) * (box[5] - box[2])) * keys["beam_light"][7]
    except KeyError as missing:
        raise Unusable(f"{result.path}: --ideal_lens is of a beam along z through a box; there is no {missing}")


def is_among(lens, values):
    return np.nanmin(values) < lens < np.nanmax(values)


def lens_text(lens, values, best):
    if is_among(lens, values):
        drawn = "dashed: as much as"
    else:
        drawn = "everywhere more than" if lens < best else "everywhere less than"
    return f"{drawn} what an ideal lens brings to a point of the light that is not scattered, {lens:.3g}: the star has {best / lens:.3g} of it"


def with_unit(result, name):
    """A name with the unit that the file says, and where it is one of several numbers."""
    path, entry = entry_of(name)
    dataset = result.dataset(path if result.has(path) else path.replace(".", "_"))
    scales = [] if entry is None else list(dataset.dims[dataset.ndim - 1].values())
    if scales:
        scale = scales[0]
        name = f"{path}, {scale.name.split('/')[-1].replace('_', ' ')} {scale[entry]:.3g}"
    return labels.with_unit(name, dataset.attrs.get("units"))


def shorten_large(axis):
    """2 M in place of 2 beside 1e6 in a corner."""
    if axis.get_scale() == "linear" and max(map(abs, axis.get_view_interval())) > 1e5:
        axis.set_major_formatter(EngFormatter(sep=" "))


def draw_tangents(axis, place, values, slopes):
    """As long as a third of the way to the neighbours."""
    before, after = (np.append(place[0], place[:-1]) + 2 * place) / 3, (np.append(place[1:], place[-1]) + 2 * place) / 3
    for at, value, slope, *ends in zip(place, values, slopes, before, after):
        x = np.linspace(*ends, 9)  # bent by a logarithmic axis
        axis.plot(x, value + slope * (x - at), color="black", linewidth=1, zorder=4,
                  label="derivative" if at == place[0] else None)


def draw_curve(axis, label, place, values, errors, lens, slopes, best):
    if lens:
        axis.axhline(lens, color="gray", linestyle="--", label="ideal lens")
    axis.errorbar(place, values, errors, **style.look(0))
    if slopes is not None:
        draw_tangents(axis, place, values, slopes)
    if axis.get_legend_handles_labels()[1]:
        axis.legend()
    axis.plot(place[best], values[best], "*", color="black", markersize=9, zorder=5)
    axis.set_xlabel(label)
    if style.in_equal_ratios(place):
        axis.set_xscale("log")
    shorten_large(axis.xaxis)


def draw_map(figure, axis, result, keys, values, name, lens, best):
    (down, y), (across, x) = keys
    mesh = axis.pcolormesh(x, y, values, cmap="cividis", shading="nearest")
    if min(values.shape) > 3 and np.nanmax(values) > np.nanmin(values):
        lines = axis.contour(x, y, values, colors="white", linewidths=0.6, levels=6)
        axis.clabel(lines, fontsize=5.5, fmt="%.3g")
    if lens and is_among(lens, values):
        axis.contour(x, y, values, colors="red", linewidths=1, linestyles="--", levels=[lens])
    row, column = np.unravel_index(best, values.shape)
    axis.plot(x[column], y[row], "*", color="white", markeredgecolor="black", markersize=10)
    scales = ["log" if style.in_equal_ratios(values) else "linear" for values in (x, y)]
    axis.set(xlabel=with_unit(result, across), ylabel=with_unit(result, down), xscale=scales[0], yscale=scales[1])
    for side in (axis.xaxis, axis.yaxis):
        shorten_large(side)
    figure.colorbar(mesh, ax=axis, label=with_unit(result, name))
    return {across: x[column], down: y[row]}, row in (0, len(y) - 1) or column in (0, len(x) - 1)


def draw(results, arguments):
    keys, values, errors = grid_of(results[0], arguments)
    lens = ideal_lens(results[0]) if arguments.ideal_lens else None
    at = int(np.nanargmin(values) if arguments.smallest else np.nanargmax(values))
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.6))
    if len(keys) == 1:
        draw_curve(axis, with_unit(results[0], keys[0][0]), keys[0][1], values, errors, lens,
                   slopes_of(results[0], arguments.value, keys[0][0]), at)
        axis.set_ylabel(with_unit(results[0], arguments.value))
        return figure
    best, at_edge = draw_map(figure, axis, results[0], keys, values, arguments.value, lens, at)
    value, error = values.flat[at], errors.flat[at]
    word, amiss = ("smallest", "small") if arguments.smallest else ("largest", "large")
    edge = ["at the edge of the map"] if at_edge else []
    noise = f" $\\pm$ {error:.2g}" if error > 0 else ""
    axis.set_title(", ".join([f"star: {value:.4g}{noise}", *edge]), fontsize=7)
    missing = int(np.isnan(values).sum())
    style.caption(figure, [f"star: {word}, " + ", ".join(f"{key} = {value:.3g}" for key, value in best.items()) + f", {value:.4g}" +
                           (f" +- {error:.2g}; the {word} of noisy values is too {amiss}"
                            if error > 0 else ""),
                           *([f"white: {missing} of {values.size} points are missing"] if missing else []),
                           *(f"it lies {text}: a better one may lie beyond" for text in edge),
                           *([lens_text(lens, values, value)] if lens else [])])
    return figure


def add_options(parser):
    parser.add_argument("--value", default="total", help="dataset of one number for each point, or NAME[i]")
    parser.add_argument("--smallest", action="store_true", help="mark the smallest value in place of the largest")
    parser.add_argument("--ideal_lens", action="store_true", help="compare with all light that comes unscattered through a box")


if __name__ == "__main__":
    style.main(draw, __doc__, add_options=add_options)
