#!/usr/bin/env python3
"""Validation of Monte Carlo against the exact wave solver or, for slabs, against deterministic transport. For each
entry of the covariance: values, relative deviations, and deviations in standard errors. For a result with the user's
own placement: its speckle pattern and the mean intensity, and the distribution of their ratio."""

from dataclasses import dataclass

from lib import page, script, speckle_ratio, style
from lib.labels import with_unit
from lib.speckle_ratio import FORWARD
from lib.sweep_file import METHODS

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import MaxNLocator

SIGMAS = 4  # combined standard errors within which values agree
BAND = "0.92"
PEAKED = 8  # ratio of highest to lowest value above which the axis is logarithmic
# Largest deviations on the axes; larger ones are drawn as arrows with numbers.
MOST_RELATIVE, MOST_SIGMAS = 100, 5 * SIGMAS
ENTRIES, SENSORS = "index of the entry", "index of the sensor"


@dataclass
class Comparison:
    """Entries [curve, x] of both methods and their errors. Complex entries are compared by their distance in the
    complex plane."""

    reference: str
    x: np.ndarray
    x_label: str
    curve_labels: list
    y_label: str
    mc: np.ndarray
    mc_error: np.ndarray
    exact: np.ndarray
    exact_error: np.ndarray
    forward: np.ndarray  # entries affected by the fixed number of scatterers (conventions, C12)

    def residual(self):
        """Returns |mc - reference| in combined standard errors, and these errors."""
        combined = np.hypot(self.mc_error, self.exact_error)
        # Entries that are exactly 0 in both methods have no error and agree.
        return np.divide(np.abs(self.mc - self.exact), combined, out=np.zeros(combined.shape),
                         where=combined > 0), combined

    def relative(self):
        """Returns Monte Carlo / reference - 1 and its standard error, in %; for complex values, of their magnitudes.
        The values are nan where the reference is 0."""
        size = np.where(self.exact == 0, np.nan, np.abs(self.exact))
        ratio = np.abs(self.mc) / size
        return 100 * (ratio - 1), 100 * np.hypot(self.mc_error, ratio * self.exact_error) / size

    def curves(self):
        """Yields (number, abscissae, colours of Monte Carlo and of the reference, marker and line) for each curve.
        The abscissae are shifted slightly so that error bars do not overlap. For a single curve the two colours
        differ."""
        count, x = len(self.curve_labels), self.x
        step = min(0.05 * np.median(np.diff(np.sort(x))), 0.012 * np.ptp(x)) if len(x) > 1 else 0
        for number in range(count):
            look = style.look(number)
            colours = style.COLOURS[:2] if count == 1 else [look["color"]] * 2
            yield number, x + step * (number - (count - 1) / 2), colours, look


def read_entries(result, name, reference):
    """Returns values and errors of both methods, and which entries are in the forward lobe."""
    entries = [values for method in ("mc", reference) for values in result.measured(f"{method}/{name}")]
    shape = entries[0].shape
    if any(entry.shape != shape for entry in entries):
        raise style.Unusable(f"{result.path}: {name} has different shapes for mc and {reference}")
    forward = np.zeros(shape, bool)
    if result.has("forward"):  # for a full covariance, the lower triangle of [light, view, light, view]
        stored, size = result.values("forward") > 0, np.prod(shape[:2])
        if len(shape) < 4:
            forward = stored[:forward.size].reshape(shape)
        else:
            forward.reshape(size, size)[np.tril_indices(size)] = stored
    return [*entries, forward]


def views_of(result, name):
    """Returns the abscissae of a dataset's second axis and their label: detection angles or indices of sensors."""
    kind, views = result.scale(name, 1)
    return views, "detection angle" if kind == "view_angle" else SENSORS


def intensities(result, reference):
    kind, lights = result.scale("mc/intensity", 0)
    curves = [f"illumination {style.angle(light) if kind == 'light_angle' else f'{light:g}'}"
              for light in lights]
    return *views_of(result, "mc/intensity"), curves, \
        with_unit(r"intensity $C_{vv}$", result.unit("mc/intensity")), \
        *read_entries(result, "intensity", reference)


def covariances(result, reference):
    entries = read_entries(result, "covariance", reference)
    if entries[0].ndim == 4:  # the lower triangle of a full covariance, row by row
        size = entries[0].shape[0] * entries[0].shape[1]
        entries = [entry.reshape(size, size)[np.tril_indices(size)] for entry in entries]
    if entries[0].ndim != 2:
        return np.arange(entries[0].size), ENTRIES, ["entries"], "covariance $|C|$", *(
            entry[None] for entry in entries)
    tilts, (views, kind) = result.axis("mc/covariance", 0), views_of(result, "mc/covariance")
    if len(views) > max(6, len(tilts)):
        return views, kind, [f"tilt {style.angle(tilt)}" for tilt in tilts], "covariance $|C|$", *entries
    return tilts, "tilt", [f"detection at {style.angle(view)}" for view in views], "covariance $|C|$", *(
        entry.T for entry in entries)


def draw_values(axis, data, allowance):
    for number, x, (own, other), look in data.curves():
        mc, exact = np.abs(data.mc[number]), np.abs(data.exact[number])
        common = {"marker": look["marker"], "elinewidth": 0.7, "linestyle": "none"}
        order = np.argsort(data.x)
        axis.vlines(x, mc * (1 - allowance), mc * (1 + allowance), color=own, alpha=0.15,
                    linewidth=4, zorder=0)
        axis.plot(x[order], mc[order], color=own, linestyle=look["linestyle"], linewidth=0.5, alpha=0.6)
        axis.errorbar(x, mc, data.mc_error[number], **common, color=own, markerfacecolor="white",
                      markersize=5)
        label = data.curve_labels[number] if len(data.curve_labels) > 1 else None
        axis.errorbar(x, exact, data.exact_error[number], **common, color=other, markersize=2.5,
                      label=label)
    axis.set_ylabel(data.y_label)
    values = np.abs(np.concatenate([data.mc, data.exact]))
    low, high = values.min(), values.max()
    if low > 0 and high > PEAKED * low:
        axis.set(yscale="log", ylim=(low / 1.3, high * 1.3))
    else:
        axis.set_ylim(bottom=-0.03 * axis.get_ylim()[1])


def draw_within(axis, x, values, errors, limit, look):
    """Draws values up to a limit, and larger ones as arrows at the edge with their numbers."""
    inside = np.abs(values) <= limit
    axis.errorbar(x[inside], values[inside], errors[inside], linestyle="none", elinewidth=0.7, **look)
    for place, value in zip(x[~inside], values[~inside]):
        if np.isfinite(value):
            side = np.sign(value)
            axis.annotate(f"{value:.0f}", (place, side * limit), xytext=(0, -7 * side), textcoords="offset points",
                          ha="center", va="top" if side > 0 else "bottom", fontsize=6, color=look["color"],
                          arrowprops={"arrowstyle": "<|-", "color": look["color"], "linewidth": 0.7, "shrinkA": 0,
                                      "shrinkB": 0, "mutation_scale": 6})


def reach_of(values, forward, least, most):
    """Returns the range of an axis from the entries that should agree (those outside the forward lobe), between
    limits."""
    return np.clip(1.15 * np.nanmax(np.abs(values[~forward]), initial=0), least, most)


def draw_relative(axis, data, allowance):
    deviation, error = data.relative()
    axis.axhspan(-100 * allowance, 100 * allowance, color="black", alpha=0.12, linewidth=0, zorder=0)
    axis.axhline(0, color="black", linewidth=0.5, zorder=1)
    limit = reach_of(np.abs(deviation) + error, data.forward, max(100 * allowance, 1), MOST_RELATIVE)
    for number, x, (own, _), look in data.curves():
        draw_within(axis, x, deviation[number], error[number], limit,
                    {"color": own, "marker": look["marker"], "markersize": 2.5})
    axis.set(ylim=(-limit, limit), ylabel="relative deviation (%)")


def draw_residual(axis, data, allowance):
    residual, combined = data.residual()
    axis.axhspan(0, SIGMAS, color=BAND, zorder=0)
    limit = reach_of(residual, data.forward, 1.25 * SIGMAS, MOST_SIGMAS)
    for number, x, (own, _), look in data.curves():
        sigma = np.where(combined[number] > 0, combined[number], 1)
        axis.vlines(x, 0, allowance * np.abs(data.mc[number]) / sigma, color=own, alpha=0.2, linewidth=3,
                    zorder=1)
        draw_within(axis, x, residual[number], 0 * x, limit,
                    {"color": own, "marker": look["marker"], "markersize": 3})
    axis.set(ylim=(0, limit), ylabel=r"|deviation| / $\sigma$")


def shade_forward(axes, data):
    """Shades the background of entries in the forward lobe."""
    steps = np.diff(np.unique(data.x))
    half = 0.5 * (steps.min() if len(steps) else 1)
    for axis in axes:
        for place in np.unique(data.x[data.forward.any(axis=0)]):
            axis.axvspan(place - half, place + half, zorder=-1, **FORWARD)


def entries(axis, data, allowance):
    """Yields legend entries (handle, label)."""
    yield from page.labelled([axis])
    own, other = style.COLOURS[:2] if len(data.curve_labels) == 1 else ("black", "black")
    for colour, fill, size, label in ((own, "white", 5, "Monte Carlo"),
                                      (other, other, 2.5, METHODS[data.reference])):
        yield plt.Line2D([], [], color=colour, marker="o", markerfacecolor=fill, markersize=size,
                         linestyle="none"), label
    yield plt.Rectangle((0, 0), 1, 1, color=BAND), f"{SIGMAS} standard errors ($\\sigma$)"
    if data.forward.any():
        yield plt.Rectangle((0, 0), 1, 1, **FORWARD), "forward lobe (fixed number of scatterers)"
    if allowance > 0 and data.reference == "wave":
        yield plt.Line2D([], [], color="black", alpha=0.2, linewidth=4), \
            f"expected bias of Monte Carlo, {100 * allowance:.2g} %"


@script.plot()
def draw(result):
    if result.has("intensity_ratio"):
        return speckle_ratio.draw(result)
    if not result.has("mc/intensity") and not result.has("mc/covariance"):
        raise style.Unusable(f"{result.path}: has neither mc/intensity nor mc/covariance")
    reference = "transport" if result.has("transport/trace") else "wave"
    read = intensities if result.has("mc/intensity") else covariances
    data, allowance = Comparison(reference, *read(result, reference)), float(result.attribute("bias_allowance", 0))
    figure, axes = plt.subplots(3, 1, sharex=True, figsize=(1.3 * style.COLUMN, 5),
                                height_ratios=[2.2, 1, 1])
    for axis, draw_panel in zip(axes, (draw_values, draw_relative, draw_residual)):
        draw_panel(axis, data, allowance)
    if data.x_label in (ENTRIES, SENSORS):
        axes[-1].set_xlabel(data.x_label)
        axes[-1].xaxis.set_major_locator(MaxNLocator(integer=True))
    else:
        style.angle_axis(axes[-1], data.x, data.x_label)
    shade_forward(axes, data)
    page.legend_above(figure, list(entries(axes[0], data, allowance)), 3)
    if data.forward.any():
        style.caption(figure, ["forward lobe: with a fixed number of scatterers the exact covariance lacks a "
                               "fluctuation of the coherent field that Monte Carlo includes (conventions, C12)"])
    if len(data.curve_labels) > 1:
        style.caption(figure, ["symbols at the same abscissa are shifted slightly sideways"])
    return figure
