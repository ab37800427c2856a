#!/usr/bin/env python3
"""Memory-effect ranges of slabs with a graded index, over the gradient: results of
`covariance --index_field linear --covariance memory_effect`, any number; without gradient: index_slope 0 0."""

from lib import style

import matplotlib.pyplot as plt
import numpy as np


def gradient(result):
    """n^2 at the far face less that at the near one."""
    front, back = result.attribute("index_front"), result.attribute("index_back")
    if front is None or back is None:
        raise style.Unusable(f"{result.path}: has no index_front; needs --index_field linear")
    return back**2 - front**2


def draw(results):
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.8))
    curves = {}
    for result in results:
        if not result.has("memory_effect_range"):
            raise style.Unusable(f"{result.path}: has no memory_effect_range; needs --covariance memory_effect")
        point = (gradient(result), result.values("memory_effect_range"), result.values("memory_effect_range_error"))
        label = rf"OD {result.attribute('optical_depth'):.2g}, $g$ = {result.attribute('g'):.2g}"
        curves.setdefault(label, []).append([float(np.squeeze(v)) for v in point])
    for number, (text, points) in enumerate(curves.items()):
        x, y, error = np.array(sorted(points)).T
        look = style.look(number)
        axis.errorbar(x, y, error, elinewidth=0.7, linewidth=0.7, color=look["color"], linestyle=look["linestyle"],
                      marker=look["marker"], markersize=3, label=text)
    axis.set_xlabel("change of $n^2$ over the depth")
    axis.set_ylabel(r"range $q L$ at $C_I = 1/2$")
    axis.legend()
    return figure


if __name__ == "__main__":
    style.main(draw, __doc__, several=True)
