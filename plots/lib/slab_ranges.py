"""Draws memory-effect ranges of any number of slabs against a number computed for each, with a curve for each optical
depth and g."""

from lib import labels, range_axes, style

import matplotlib.pyplot as plt
import numpy as np

NEEDS = {"memory_effect_range": "needs --covariance memory_effect"}


def draw(results, number_of, number_label):
    """Draws the ranges. number_of(result): value on the horizontal axis."""
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.8))
    curves = {}
    for result in results:
        point = number_of(result), *result.measured("memory_effect_range")
        curves.setdefault(labels.of_slab(result, 2), []).append([float(np.squeeze(v)) for v in point])
    for number, (label, points) in enumerate(curves.items()):
        axis.errorbar(*np.array(sorted(points)).T, elinewidth=0.7, linewidth=0.7, markersize=3,
                      **style.look(number), label=label)
    axis.set(xlabel=number_label, ylabel=range_axes.RANGE)
    axis.legend()
    return figure
