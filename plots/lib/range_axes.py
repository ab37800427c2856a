"""Axes of plots of the memory-effect range: labels and scales for each parameter."""

from lib import style

import numpy as np
from matplotlib.ticker import NullLocator

LABELS = {"albedo": "absorption 1 \u2212 albedo", "g": "mean cosine $g$",
          "optical_depth": "optical depth", "index": "relative index",
          "radius": "radius (wavelength = {:g})",
          "density": "density (per area, wavelength = {:g})"}
RANGE = r"range $qL$ at $C_I = 1/2$"
MOST_TICKS = 16  # largest number of ticks placed at the values themselves
CLOSE = 0.13  # fraction of an axis; tick labels closer than this would overlap


def numbers_apart(axis, values):
    """Returns the texts of ticks, the largest first; empty if a text would overlap the next one."""
    places = axis.xaxis.get_transform().transform(values)
    texts, last = style.short(values), np.inf
    for number in reversed(range(len(values))):
        if last - places[number] < CLOSE * np.ptp(places):
            texts[number] = ""
        else:
            last = places[number]
    return texts


def scale_axis(axis, against, x, wavelength):
    """Makes an axis logarithmic if its values span a large range. For absorption, the axis is linear near 0."""
    axis.set_xlabel(LABELS[against].format(wavelength))
    values = np.unique(x)
    least = values[values > 0].min(initial=1)
    if against == "albedo" and len(values) > 2:
        axis.set_xscale("symlog", linthresh=least, linscale=0.6)
        axis.set_xlim(-0.25 * least if values[0] <= 0 else None, 1.4 * values[-1])
    elif against in ("density", "radius", "optical_depth") and values[-1] > 4 * values[0] > 0:
        axis.set_xscale("log")
    else:
        axis.margins(x=0.1)
    if len(values) <= MOST_TICKS:
        axis.set_xticks(values, numbers_apart(axis, values))
    axis.xaxis.set_minor_locator(NullLocator())


def limits(sweep, single):
    """Returns (low, high, whether the axis is logarithmic), so that all ranges and the single-scattering limit are
    visible. Diffusion theory is shown only above half the smallest range, because it is meaningless for slabs thinner
    than a transport mean free path."""
    shown = [sweep.of(method, "memory_effect_range")[sweep.rows] for method in sweep.prefixes]
    low, high = np.min(shown), max([np.max(shown), *single])
    diffusion = sweep.optional("diffusion_range")
    if diffusion is not None:
        shown = diffusion[sweep.rows][diffusion[sweep.rows] >= low / 2]
        low, high = np.min(shown, initial=low), np.max(shown, initial=high)
    if high > 4 * low:
        return low / 1.15, high * max(1.45, (high / low)**0.12), True  # leaves room for arrows
    spread = max(high - low, 0.3 * high)
    return max(0, low - 0.15 * spread), high + 0.2 * spread, False


def scale_range(axis, sweep, single, vertical=True):
    """Sets scale, ticks and limits of the axis of ranges."""
    low, high, logarithmic = limits(sweep, single)
    side = axis.yaxis if vertical else axis.xaxis
    if logarithmic:
        (axis.set_yscale if vertical else axis.set_xscale)("log")
        style.few_decades(side)
    (axis.set_ylim if vertical else axis.set_xlim)(low, high)


def diffusion_in_view(sweep, single):
    """Returns whether diffusion theory is within the axis limits at all selected points, and whether at any."""
    diffusion = sweep.optional("diffusion_range")
    if diffusion is None:
        return True, False
    seen = diffusion[sweep.rows] >= limits(sweep, single)[0]
    return seen.all(), seen.any()


def notes(sweep, single):
    """Yields notes on theories outside the axis limits."""
    every, some = diffusion_in_view(sweep, single or [])
    if not every:
        part = "partly " if some else ""
        yield f"diffusion theory: {part}below the axis (less than half the smallest range)"
    if single == []:
        yield "single scattering: $C_I$ stays above 1/2 at all tilts"
