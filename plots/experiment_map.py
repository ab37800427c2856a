#!/usr/bin/env python3
"""Map of a number of a sweep of another subcommand (--value, by default the power on the detector) over two of its keys, with contours and
its largest value marked; with one key a curve with its errors."""

from lib import style
from lib.result_file import Unusable

import matplotlib.pyplot as plt
import numpy as np


def axes_of(result, name):
    """The swept keys of more than one value, with their values, in the order of the dataset's axes."""
    axes = [(scales[0].name.strip("/"), scales[0][...]) for scales in result.dataset(name).dims]
    if any(key == "point" for key, _ in axes):
        raise Unusable(f"{result.path}: a list of points or a part of a sweep; a map needs all of a grid")
    return axes


def grid_of(result, arguments):
    if not result.swept():
        raise Unusable(f"{result.path}: no sweep of another subcommand")
    axes = axes_of(result, arguments.value)
    values, keep = result.values(arguments.value), []
    errors = result.values(f"{arguments.value}_error") if result.has(f"{arguments.value}_error") else np.zeros_like(values)
    for number, (key, own) in enumerate(axes):
        if len(own) > 1:
            keep.append((key, own))
    if len(keep) not in (1, 2):
        raise Unusable(f"{result.path}: {arguments.value} varies with {', '.join(key for key, _ in keep) or 'nothing'}; a map has two keys")
    shape = [len(own) for _, own in keep]
    return keep, values.reshape(shape), errors.reshape(shape)


def is_log(values):
    return values.min() > 0 and np.allclose(np.diff(np.log(values)), np.log(values[1] / values[0]), rtol=1e-3)


def draw_curve(axis, key, place, values, errors):
    axis.errorbar(place, values, errors, **style.look(0))
    best = int(np.argmax(values))
    axis.plot(place[best], values[best], "*", color="black", markersize=9, zorder=5)
    axis.set_xlabel(key)
    if is_log(place):
        axis.set_xscale("log")


def draw_map(figure, axis, keys, values, name):
    (down, y), (across, x) = keys
    mesh = axis.pcolormesh(x, y, values, cmap="cividis", shading="nearest")
    if min(values.shape) > 3 and np.ptp(values) > 0:
        axis.contour(x, y, values, colors="white", linewidths=0.6, levels=6)
    row, column = np.unravel_index(np.argmax(values), values.shape)
    axis.plot(x[column], y[row], "*", color="white", markeredgecolor="black", markersize=10)
    axis.set(xlabel=across, ylabel=down, xscale="log" if is_log(x) else "linear", yscale="log" if is_log(y) else "linear")
    figure.colorbar(mesh, ax=axis, label=name)
    return {across: x[column], down: y[row]}


def draw(results, arguments):
    keys, values, errors = grid_of(results[0], arguments)
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.6))
    if len(keys) == 1:
        draw_curve(axis, keys[0][0], keys[0][1], values, errors)
        axis.set_ylabel(arguments.value)
        return figure
    best = draw_map(figure, axis, keys, values, arguments.value)
    at = np.argmax(values)
    style.caption(figure, ["star: largest, " + ", ".join(f"{key} = {value:.3g}" for key, value in best.items()) +
                           f", {values.flat[at]:.4g} +- {errors.flat[at]:.2g}; the largest of noisy values is too large"])
    return figure


def add_options(parser):
    parser.add_argument("--value", default="total", help="dataset of one number for each point")


if __name__ == "__main__":
    style.main(draw, __doc__, add_options=add_options)
