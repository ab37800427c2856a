#!/usr/bin/env python3
"""Memory-effect ranges of slabs with a graded index against the gradient, from any number of results of `covariance
--index_field linear --covariance memory_effect`. For a slab without gradient use index_slope 0 0."""

from lib import script, slab_ranges, style


def gradient(result):
    """Returns n^2 at the far face minus n^2 at the near face."""
    front, back = result.attribute("index_front"), result.attribute("index_back")
    if front is None or back is None:
        raise style.Unusable(f"{result.path}: has no index_front; needs --index_field linear")
    return back**2 - front**2


@script.plot(several=True, needs=slab_ranges.NEEDS)
def draw(results):
    return slab_ranges.draw(results, gradient, "$n^2$ at the far face minus $n^2$ at the near face")
