#!/usr/bin/env python3
"""Memory-effect ranges of layered slabs against the spread of their scatterers in depth, from any number of results
of `covariance --layers --covariance memory_effect`. The spread is the standard deviation of the depth, weighted by
the extinction coefficient and divided by that of a homogeneous slab."""

from lib import script, slab_ranges

import numpy as np


def spread(result):
    """Returns the spread of a layered slab: 1 for a homogeneous slab, 0 for one thin sheet, sqrt(3) for two thin
    sheets at the faces."""
    thickness, depth = result.values("layer_thickness"), result.values("layer_optical_depth")
    top = np.cumsum(thickness) - thickness
    share, middle = depth / depth.sum(), top + thickness / 2
    mean = np.sum(share * middle)
    variance = np.sum(share * ((middle - mean)**2 + thickness**2 / 12))
    return np.sqrt(12 * variance) / thickness.sum()


@script.plot(several=True, needs={"layer_thickness": "needs --layers", **slab_ranges.NEEDS})
def draw(results):
    figure = slab_ranges.draw(results, spread, "spread of the extinction in depth (homogeneous slab: 1)")
    figure.axes[0].set_yscale("log")
    return figure
