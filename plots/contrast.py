#!/usr/bin/env python3
"""Laser speckle contrast: K^2 against the time of exposure, from any number of
`covariance --exposures` results: each curve over the time at which its |g1| has fallen to 1/e, or
all over the exposure itself where the delays of one do not show that time."""

from lib import labels, style

import matplotlib.pyplot as plt
import numpy as np


def decay_time(result):
    """Where |g1| of the first light and view is 1/e, between delays; None where that is not."""
    delay = result.axis("field_correlation", 0)
    values = result.values("field_correlation")[:, 0, 0]
    order = np.argsort(delay)
    delay, values = delay[order], values[order]
    below = np.flatnonzero(values < np.exp(-1))
    if not len(below) or below[0] == 0:
        return None
    last = below[0]
    logs = np.log(values[last - 1:last + 1])
    return np.interp(1, -logs, delay[last - 1:last + 1])


def draw(results):
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.8))
    for result in results:
        if not result.has("squared_contrast"):
            raise style.Unusable(f"{result.path}: has no squared_contrast; needs --exposures")
    times = [decay_time(result) for result in results]
    scaled = all(time is not None for time in times)
    for number, (result, time, name) in enumerate(zip(results, times, labels.labels(results))):
        look = style.look(number)
        x = result.axis("squared_contrast", 0) / (time if scaled else 1)
        order = np.argsort(x)
        axis.errorbar(x[order], result.values("squared_contrast")[order, 0, 0],
                      result.values("squared_contrast_error")[order, 0, 0], elinewidth=0.7,
                      color=look["color"], marker=look["marker"], markersize=3, linewidth=0.7,
                      linestyle=look["linestyle"], label=name or "Monte Carlo")
    if scaled:
        x = np.geomspace(0.1, 30, 200)
        axis.plot(x, (np.expm1(-2 * x) + 2 * x) / (2 * x**2), color=style.GREY, linewidth=0.7,
                  zorder=0, label=r"$|g_1| = e^{-\tau/\tau_c}$")
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel(r"exposure $T / \tau_c$" if scaled else "exposure $T$ (unit of the delays)")
    axis.set_ylabel(r"squared contrast $K^2$")
    axis.legend()
    return figure


if __name__ == "__main__":
    style.main(draw, __doc__, several=True)
