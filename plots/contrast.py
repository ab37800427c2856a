#!/usr/bin/env python3
"""Laser speckle contrast: squared contrast K^2 against exposure time, from any number of `covariance --exposures`
results. If all exposure times are in seconds, they are drawn in seconds. Otherwise they are divided by the delay at
which |g1| of the same result has fallen to 1/e, if |g1| of every result falls that far within its delays."""

from lib import labels, script, style
from lib.sweep_file import METHODS

import matplotlib.pyplot as plt
import numpy as np


def method_of(result):
    """Returns the name of the method that the attribute `plan` of a result begins with."""
    return METHODS.get(str(result.attribute("plan", "")).split(":")[0], "computed")


def decay_time(result):
    """Returns the delay at which |g1| of the first illumination and detection direction is 1/e, interpolated; None if
    the delays do not reach it."""
    delay = result.axis("field_correlation", 0)
    values = result.values("field_correlation")[:, 0, 0]
    order = np.argsort(delay)
    delay, values = delay[order], values[order]
    below = np.flatnonzero(values < np.exp(-1))
    if not len(below) or below[0] == 0:
        return None
    around = slice(below[0] - 1, below[0] + 1)
    return np.interp(1, -np.log(values[around]), delay[around])


@script.plot(several=True, needs={"squared_contrast": "needs --exposures"})
def draw(results):
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.8))
    times = [decay_time(result) for result in results]
    seconds = all(result.unit("exposure") == "s" for result in results)
    scaled = not seconds and all(time is not None for time in times)
    for number, (result, time, name) in enumerate(zip(results, times, labels.labels(results))):
        x = result.axis("squared_contrast", 0) / (time if scaled else 1)
        order = np.argsort(x)
        value, error = (values[order, 0, 0] for values in result.measured("squared_contrast"))
        axis.errorbar(x[order], value, error, elinewidth=0.7, markersize=3, linewidth=0.7,
                      **style.look(number), label=name or method_of(result))
    if scaled:
        x = np.geomspace(0.1, 30, 200)
        axis.plot(x, (np.expm1(-2 * x) + 2 * x) / (2 * x**2), color=style.GREY, linewidth=0.7,
                  zorder=0, label=r"$|g_1| = e^{-\tau/\tau_c}$")
    axis.set(xscale="log", yscale="log", ylabel=r"squared contrast $K^2$",
             xlabel=r"exposure time $T / \tau_c$" if scaled else "exposure time $T$ (s)" if seconds else
             "exposure time $T$ (unit of the delays)")
    axis.legend()
    return figure
