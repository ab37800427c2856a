#!/usr/bin/env python3
"""Success probability of imaging against the key that varies, from `flatspeckle sweep --of image`. Symbols with error
bars are from simulated pictures, lines are the prediction that needs no pictures. If a second key varies, each of its
values has a curve. Several sweeps can share a panel, for example a coarse one with pictures and a fine one with
repeats = 0."""

from lib import labels, script, style
from lib.experiment import Number

import matplotlib.pyplot as plt
import numpy as np


def keys_of(result):
    """Returns the name of the key on the horizontal axis, and of the key that distinguishes curves, or None."""
    keys = [*Number(result, "predicted_success").columns, None]
    if len(keys) > 3:
        raise style.Unusable(f"{result.path}: more than two keys vary; success is drawn over one key or two")
    return keys[:2]


def curves(result, name):
    """Returns (value of the second key or None, values of the first key, success, errors) for each curve."""
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
                      label=f"{second} = {value:g}" if second else "simulated pictures")


@script.plot(several=True, needs={"predicted_success": "needs a sweep of image"})
def draw(results):
    names = [keys_of(result)[0] for result in results]
    if len(set(names)) > 1:
        raise style.Unusable(f"{results[1].path}: varies {names[1]}, but the first result varies {names[0]}; "
                             "all results must vary the same key")
    lines = [curve for result in results for curve in curves(result, "predicted_success")]
    every = sorted({value for value, *_ in lines if value is not None})
    colours = lambda value: "C0" if value is None else f"C{every.index(value) % 10}"
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.6), layout="constrained")
    predictions = any(not result.has("success") for result in results)
    for result in results:
        draw_one(axis, result, colours, with_line=not (predictions and result.has("success")))
    axis.set(xlabel=labels.with_unit(names[0], results[0].unit(names[0])), ylabel="probability to find all points",
             ylim=(-0.05, 1.08))
    if style.in_equal_ratios(lines[0][1]):
        axis.set_xscale("log")
    axis.plot([], [], "-", color="0.4", label="prediction")
    axis.legend()
    return figure
