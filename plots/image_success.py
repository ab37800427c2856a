#!/usr/bin/env python3
"""Success of `flatspeckle sweep --of image` against the key that varies: pictures with their errors, the prediction without pictures as a
line. With a second key a curve for each of its values. Several sweeps in one panel: a coarse one with pictures, a fine one with
repeats = 0."""

from lib import labels, style
from lib.result_file import Unusable

import matplotlib.pyplot as plt
import numpy as np


def axes_of(result):
    if not result.has("predicted_success") or not result.swept():
        raise Unusable(f"{result.path}: no sweep of image whose success is predicted")
    axes = [(scale[0].name.strip("/"), scale[0][...]) for scale in result.dataset("predicted_success").dims]
    if len(axes) > 2 or any(name == "point" for name, _ in axes):
        raise Unusable(f"{result.path}: success over one or two keys that vary is drawn")
    return axes


def curves(result, name):
    """(value of the second key, numbers along the first)."""
    values = result.values(name)
    axes = axes_of(result)
    if len(axes) == 1:
        return [(None, values)]
    return [(second, values[:, number]) for number, second in enumerate(axes[1][1])]


def draw_one(axis, result, colors, with_line):
    (_, place), *second = axes_of(result)
    for value, success in curves(result, "predicted_success") if with_line else []:
        axis.plot(place, success, "-", color=colors(value), linewidth=1.1)
    if not result.has("success"):
        return
    errors = dict(curves(result, "success_error"))
    for value, success in curves(result, "success"):
        label = f"{second[0][0]} = {value:g}" if second else "pictures"
        axis.errorbar(place, success, errors[value], fmt="o", markersize=4, color=colors(value), label=label)


def draw(results):
    names = [axes_of(result)[0][0] for result in results]
    if len(set(names)) > 1:
        raise Unusable(f"{results[1].path}: varies with {names[1]}, the first with {names[0]}")
    every = sorted({value for result in results for value, _ in curves(result, "predicted_success") if value is not None})

    def colors(value):
        return "C0" if value is None else f"C{every.index(value) % 10}"
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.6), layout="constrained")
    predictions = any(not result.has("success") for result in results)
    for result in results:
        draw_one(axis, result, colors, with_line=not (predictions and result.has("success")))
    place = axes_of(results[0])[0][1]
    unit = results[0].dataset(names[0]).attrs.get("units")
    axis.set(xlabel=labels.with_unit(names[0], unit), ylabel="all points found", ylim=(-0.05, 1.08))
    if style.in_equal_ratios(place):
        axis.set_xscale("log")
    axis.plot([], [], "-", color="0.4", label="predicted")
    axis.legend()
    return figure


if __name__ == "__main__":
    style.main(draw, __doc__, several=True)
