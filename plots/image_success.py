#!/usr/bin/env python3
"""Success of `flatspeckle sweep --of image` against the key that varies: pictures with their errors, the prediction without pictures as a
line. With a second key a curve for each of its values. Several sweeps in one panel: a coarse one with pictures, a fine one with
repeats = 0."""

from lib import labels, script, style
from lib.experiment import Number

import matplotlib.pyplot as plt
import numpy as np


def keys_of(result):
    """Names of the key that stands across, and of the one that sets curves apart or None."""
    keys = [*Number(result, "predicted_success").columns, None]
    if len(keys) > 3:
        raise style.Unusable(f"{result.path}: success over one or two keys that vary is drawn")
    return keys[:2]


def curves(result, name):
    """(value of the second key or None, values of the first, success, errors)."""
    number, (first, second) = Number(result, name), keys_of(result)
    place, success, errors = number.columns[first], number.values(), number.errors()
    if second is None:
        return [(None, place, success, errors)]
    apart = number.columns[second]
    return [(value, *(column[apart == value] for column in (place, success, errors)))
            for value in np.unique(apart)]


def draw_one(axis, result, colours, with_line):
    second = keys_of(result)[1]
    for value, place, success, _ in curves(result, "predicted_success") if with_line else []:
        axis.plot(place, success, "-", color=colours(value), linewidth=1.1)
    for value, *measured in curves(result, "success") if result.has("success") else []:
        axis.errorbar(*measured, fmt="o", markersize=4, color=colours(value),
                      label=f"{second} = {value:g}" if second else "pictures")


@script.plot(several=True, needs={"predicted_success": "needs a sweep of image"})
def draw(results):
    names = [keys_of(result)[0] for result in results]
    if len(set(names)) > 1:
        raise style.Unusable(f"{results[1].path}: varies with {names[1]}, the first with {names[0]}")
    lines = [curve for result in results for curve in curves(result, "predicted_success")]
    every = sorted({value for value, *_ in lines if value is not None})
    colours = lambda value: "C0" if value is None else f"C{every.index(value) % 10}"
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.6), layout="constrained")
    predictions = any(not result.has("success") for result in results)
    for result in results:
        draw_one(axis, result, colours, with_line=not (predictions and result.has("success")))
    axis.set(xlabel=labels.with_unit(names[0], results[0].unit(names[0])), ylabel="all points found",
             ylim=(-0.05, 1.08))
    if style.in_equal_ratios(lines[0][1]):
        axis.set_xscale("log")
    axis.plot([], [], "-", color="0.4", label="predicted")
    axis.legend()
    return figure
