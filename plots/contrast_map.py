#!/usr/bin/env python3
"""Maps of speckle contrast (`flatspeckle contrast`): mean counts, squared contrast K^2 and its relative error; with
exposure also the decay rate."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np


def show(figure, axis, result, values, label, colours="inferno"):
    x, y = result.values("map_column"), result.values("map_row")
    low, high = np.nanquantile(values, (0.01, 0.99))
    mesh = axis.imshow(values, cmap=colours, vmin=low, vmax=high,
                       extent=(x[0] - 0.5, x[-1] + 0.5, y[-1] + 0.5, y[0] - 0.5))
    axis.set(xlabel="column [pixels]")
    figure.colorbar(mesh, ax=axis, label=label, extend="both", shrink=0.8)


@script.plot(needs={"contrast_map": "run flatspeckle contrast"}, dpi=150)
def draw(result):
    rates = result.has("decay_rate")
    figure, axes = plt.subplots(1, 3 + rates, figsize=(style.PAGE, 2.1), layout="constrained", sharey=True)
    square, error = result.dataset("contrast_map")[()], result.dataset("contrast_map_error")[()]
    show(figure, axes[0], result, result.dataset("mean_counts")[()], "mean counts", "gray")
    show(figure, axes[1], result, square, "$K^2$")
    show(figure, axes[2], result, error / np.where(square > 0, square, np.nan), "relative error of $K^2$", "cividis")
    if rates:
        known = result.dataset("decay_rate_known")[()] == 1
        show(figure, axes[3], result, np.where(known, result.dataset("decay_rate")[()], np.nan), "decay rate [1/exposure unit]")
    axes[0].set(ylabel="row [pixels]")
    return figure
