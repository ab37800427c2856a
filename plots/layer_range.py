#!/usr/bin/env python3
"""Memory-effect ranges of layered slabs, over how far apart their scatterers lie: results of
`covariance --layers --covariance memory_effect`, any number. Across: the standard deviation of the
depth at which extinction happens, over that of an undivided slab."""

from lib import script, slab_ranges

import numpy as np


def spread(result):
    """1 of an undivided slab, 0 of one sheet, sqrt(3) of two sheets at the faces."""
    thickness, depth = result.values("layer_thickness"), result.values("layer_optical_depth")
    top = np.cumsum(thickness) - thickness
    share, middle = depth / depth.sum(), top + thickness / 2
    mean = np.sum(share * middle)
    variance = np.sum(share * ((middle - mean)**2 + thickness**2 / 12))
    return np.sqrt(12 * variance) / thickness.sum()


@script.plot(several=True, needs={"layer_thickness": "needs --layers", **slab_ranges.NEEDS})
def draw(results):
    figure = slab_ranges.draw(results, spread, "spread of the extinction over depth (undivided: 1)")
    figure.axes[0].set_yscale("log")
    return figure
