#!/usr/bin/env python3
"""Number of independent speckle patterns required for an error of 1 % of each free parameter, over the values of the
first two parameters. From a result of `fit --plan` with `--vary`, or from several plans."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np


def read(result):
    """Returns the names of the keys, and their values and numbers of patterns, both [plan][key]."""
    names = result.texts("parameter_name")
    if result.has("point"):
        return names, result.values("point_planned"), result.values("point_patterns_to_percent")
    return names, result.values("planned")[None], result.values("patterns_to_percent")[None]


def draw_map(axis, first, second, patterns):
    x, y = np.unique(first), np.unique(second)
    cells = np.full((len(y), len(x)), np.nan)
    for a, b, value in zip(first, second, patterns):
        cells[np.searchsorted(y, b), np.searchsorted(x, a)] = np.log10(value)
    axis.imshow(cells, origin="lower", aspect="auto", cmap="viridis_r")
    middle = (np.nanmin(cells) + np.nanmax(cells)) / 2
    for (row, column), value in np.ndenumerate(cells):
        if np.isfinite(value):
            axis.text(column, row, f"{10**value:.2g}", ha="center", va="center", fontsize=7,
                      color="w" if value > middle else "k")
    axis.set_xticks(range(len(x)), style.short(x))
    axis.set_yticks(range(len(y)), style.short(y))
    axis.tick_params(top=False, right=False, length=0)


@script.plot(several=True)
def draw(results):
    (names, *others), values, patterns = zip(*map(read, results))
    if any(other != names for other in others):
        raise style.Unusable(f"{results[0].path}: all plans must have the same free keys")
    values, patterns = np.concatenate(values), np.concatenate(patterns)
    second = values[:, 1] if len(names) > 1 else np.zeros(len(values))
    figure, axes = plt.subplots(1, len(names), figsize=(min(style.PAGE, 2.6 * len(names)), 2.4), sharey=True,
                                squeeze=False)
    for number, (axis, name) in enumerate(zip(axes[0], names)):
        draw_map(axis, values[:, 0], second, patterns[:, number])
        axis.set(title=f"patterns required for {name} to 1 %", xlabel=names[0])
    if len(names) > 1:
        axes[0, 0].set_ylabel(names[1])
    return figure
