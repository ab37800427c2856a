#!/usr/bin/env python3
"""Memory-effect ranges of layered slabs, over how far apart their scatterers lie: results of
`covariance --layers --covariance memory_effect`, any number. Across: the standard deviation of the
depth at which extinction happens, over that of an undivided slab."""

from lib import style

import matplotlib.pyplot as plt
import numpy as np


def spread(result):
    """1 of an undivided slab, 0 of one sheet, sqrt(3) of two sheets at the faces."""
    thickness, depth = result.values("layer_thickness"), result.values("layer_optical_depth")
    top = np.cumsum(thickness) - thickness
    share, middle = depth / depth.sum(), top + thickness / 2
    mean = np.sum(share * middle)
    variance = np.sum(share * ((middle - mean)**2 + thickness**2 / 12))
    return np.sqrt(12 * variance) / thickness.sum()


def label(result):
    return rf"OD {result.attribute('optical_depth'):.2g}, $g$ = {result.attribute('g'):.2g}"


def draw(results):
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.8))
    curves = {}
    for result in results:
        for name in ("layer_thickness", "memory_effect_range"):
            if not result.has(name):
                raise style.Unusable(f"{result.path}: has no {name}; needs --layers and "
                                     "--covariance memory_effect")
        point = (spread(result), result.values("memory_effect_range"),
                 result.values("memory_effect_range_error"))
        curves.setdefault(label(result), []).append([float(np.squeeze(v)) for v in point])
    for number, (text, points) in enumerate(curves.items()):
        x, y, error = np.array(sorted(points)).T
        look = style.look(number)
        axis.errorbar(x, y, error, elinewidth=0.7, linewidth=0.7, color=look["color"],
                      linestyle=look["linestyle"], marker=look["marker"], markersize=3, label=text)
    axis.set_yscale("log")
    axis.set_xlabel("spread of the extinction over depth (undivided: 1)")
    axis.set_ylabel(r"range $q L$ at $C_I = 1/2$")
    axis.legend()
    return figure


if __name__ == "__main__":
    style.main(draw, __doc__, several=True)
