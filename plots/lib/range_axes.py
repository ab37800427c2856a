"""Axes of plots of the memory-effect range: against which parameter, on which scales."""

from lib import style

import numpy as np
from matplotlib.ticker import NullLocator

LABELS = {"albedo": "absorption 1 \u2212 albedo", "g": "mean cosine $g$",
          "optical_depth": "optical depth", "index": "relative index",
          "radius": "radius (wavelength = {:g})",
          "density": "density (per area, wavelength = {:g})"}
RANGE = r"range $qL$ at $C_I = 1/2$"
MOST_TICKS = 16  # at the values themselves
CLOSE = 0.13  # of an axis: two numbers nearer than this run into each other


def numbers_apart(axis, values):
    """Texts of ticks, the largest first; none where it would run into the next."""
    places = axis.xaxis.get_transform().transform(values)
    texts, last = style.short(values), np.inf
    for number in reversed(range(len(values))):
        if last - places[number] < CLOSE * np.ptp(places):
            texts[number] = ""
        else:
            last = places[number]
    return texts


def scale_axis(axis, against, x, wavelength):
    """A logarithm where the values span much; absorption down to none by a linear piece at 0."""
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
    """(low, high, whether on a logarithmic scale): all ranges and the single-scattering limit;
    diffusion theory from half the least range on, for it is meaningless where the slab is thinner
    than a transport mean free path."""
    shown = [sweep.of(method, "memory_effect_range")[sweep.rows] for method in sweep.prefixes]
    low, high = np.min(shown), max([np.max(shown), *single])
    diffusion = sweep.optional("diffusion_range")
    if diffusion is not None:
        shown = diffusion[sweep.rows][diffusion[sweep.rows] >= low / 2]
        low, high = np.min(shown, initial=low), np.max(shown, initial=high)
    if high > 4 * low:
        return low / 1.15, high * max(1.45, (high / low)**0.12), True  # with room for arrows
    spread = max(high - low, 0.3 * high)
    return max(0, low - 0.15 * spread), high + 0.2 * spread, False


def scale_range(axis, sweep, single, vertical=True):
    """Scale, ticks and limits of the axis of ranges."""
    low, high, logarithmic = limits(sweep, single)
    side = axis.yaxis if vertical else axis.xaxis
    if logarithmic:
        (axis.set_yscale if vertical else axis.set_xscale)("log")
        style.few_decades(side)
    (axis.set_ylim if vertical else axis.set_xlim)(low, high)


def diffusion_in_view(sweep, single):
    """Whether diffusion theory is in view at every selected point, and whether at any."""
    diffusion = sweep.optional("diffusion_range")
    if diffusion is None:
        return True, False
    seen = diffusion[sweep.rows] >= limits(sweep, single)[0]
    return seen.all(), seen.any()


def notes(sweep, single):
    """What is to be said of theories that are not in view."""
    every, some = diffusion_in_view(sweep, single or [])
    if not every:
        part = "partly " if some else ""
        yield f"diffusion theory: {part}out of view, below half the least range"
    if single == []:
        yield "single scattering: no fall to 1/2 within the tilts"
