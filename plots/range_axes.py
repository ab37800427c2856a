"""Axes of plots of the memory-effect range: against which parameter, on which scales."""

import style

import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

LABELS = {"albedo": "absorption 1 \u2212 albedo", "g": "mean cosine $g$",
          "optical_depth": "optical depth", "index": "relative index",
          "radius": "radius (wavelength = {:g})",
          "density": "density (per area, wavelength = {:g})"}


def horizontal(sweep, against):
    """Positions of all points along the axis."""
    column = sweep.column(against)
    return np.round(1 - column, 12) if against == "albedo" else column


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
        return
    if len(values) <= 7:
        axis.set_xticks(values, style.short(values))
    axis.xaxis.set_minor_locator(NullLocator())


def scale_range(axis, sweep, single):
    """All ranges and the single-scattering limit; diffusion theory down to half the least range,
    for it is meaningless where the slab is thinner than a transport mean free path."""
    shown = [sweep.of(method, "memory_effect_range")[sweep.rows] for method in sweep.prefixes]
    low, high = np.min(shown), max([np.max(shown), *single])
    diffusion = sweep.optional("diffusion_range")
    if diffusion is not None:
        diffusion = diffusion[sweep.rows]
        low, high = min(low, max(diffusion.min(), low / 2)), max(high, diffusion.max())
    if high > 4 * low:
        axis.set_yscale("log")
        axis.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.yaxis.set_minor_formatter(NullFormatter())
        axis.set_ylim(low / 1.15, high * 1.45)
    else:
        axis.set_ylim(max(0, low - 0.15 * (high - low)), high + 0.2 * (high - low))
