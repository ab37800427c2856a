#!/usr/bin/env python3
"""Speckle fields of `flatspeckle field`: intensity of the first realization over detection directions and
illuminations, with lines along which the memory effect moves speckles; for a single illumination, over detection
directions and realizations. Further panels show the histogram of all intensities and their autocorrelation over
detection directions for the first illumination."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import MaxNLocator

BRIGHTEST = 5  # times the mean: 0.7 % of a Gaussian field's intensities are above
UNEVEN = 1.5  # if the ratio of widest to narrowest step exceeds this, cells have equal width
MOST_NAMES = 9  # largest number of tick labels on an axis with cells of equal width
MOST_ROWS = 24  # largest number of realizations drawn
FEWEST_EXPECTED = 10  # expected counts in a bin, below which its error bar is meaningless


class Cells:
    """Cells along one axis. If the values are about equally spaced, cells are at their values. Otherwise all cells
    have the same width and are labelled by their values, so that no cell appears wider than the directions that were
    computed."""

    def __init__(self, values):
        steps = np.abs(np.diff(values))
        self.values, self.even = values, len(steps) == 0 or steps.max() < UNEVEN * steps.min()
        centres = values if self.even else np.arange(len(values))
        middle = (centres[1:] + centres[:-1]) / 2
        first, last = 2 * centres[0] - middle[0], 2 * centres[-1] - middle[-1]
        self.edges = np.concatenate([[first], middle, [last]])

    def mark(self, side):
        """Sets the ticks of a matplotlib axis."""
        if self.even:
            return side.set_major_locator(MaxNLocator(5))
        named = np.unique(np.linspace(0, len(self.values) - 1, MOST_NAMES).round().astype(int))
        side.set_ticks(named, style.short(self.values[named]))


def views(result):
    """Returns coordinate and label of the detection axis."""
    if result.has("view_angle"):
        return np.sin(result.values("view_angle")), r"sine of the detection angle, $\sin v$"
    x = result.values("sensor_x") / result.attribute("wavelength")
    if len(np.unique(x)) == len(x) and np.all(np.diff(x) * (x[1] - x[0]) > 0):
        return x, r"position of the sensor, $x/\lambda$"
    return np.arange(len(x), dtype=float), "index of the sensor"


def picture(result):
    """Returns intensity / mean intensity [row, view], and coordinate and label of the rows."""
    field, mean = result.dataset("field"), result.values("intensity")
    mean = np.where(mean > 0, mean, 1)
    if field.shape[1] > 1:
        name, values = result.scale("field", 1)
        y, label = (np.sin(values), r"$\sin i$") if name == "light_angle" else (values, name.replace("_", " "))
        return np.abs(field[0])**2 / mean, y, label
    rows = min(len(field), MOST_ROWS)
    return np.abs(field[:rows, 0])**2 / mean, np.arange(rows, dtype=float), "realization"


def draw_picture(figure, axis, result):
    intensity, y, y_label = picture(result)
    x, x_label = views(result)
    order_x, order_y = np.argsort(x), np.argsort(y)
    x, y, intensity = x[order_x], y[order_y], intensity[np.ix_(order_y, order_x)]
    if len(x) < 2 or len(np.unique(y)) < len(y) or len(np.unique(x)) < len(x):
        raise style.Unusable(f"{result.path}: needs at least two detection directions, all of them different")
    across, up = Cells(x), Cells(y)
    mesh = axis.pcolormesh(across.edges, up.edges, intensity, cmap="inferno", vmin=0,
                           vmax=BRIGHTEST, rasterized=True)
    if y_label == "realization":  # the rows are independent
        axis.hlines(up.edges[1:-1], *across.edges[[0, -1]], color="white", linewidth=0.7)
        y_label = "realization (one field in each row)"
    if y_label == r"$\sin i$" and result.has("view_angle") and across.even and up.even:
        # Within the range of the memory effect, speckles move along k sin v - k sin i = const.
        for middle in np.linspace(x[0], x[-1], 7)[1:-1:2]:
            axis.plot(middle + y - y.mean(), y, color="white", linewidth=0.7, linestyle=(0, (4, 4)),
                      scalex=False, scaley=False)
    axis.set(xlabel=x_label, ylabel=y_label, xlim=across.edges[[0, -1]], ylim=up.edges[[0, -1]])
    axis.tick_params(direction="out", top=False, right=False)
    across.mark(axis.xaxis)
    up.mark(axis.yaxis)
    if not (across.even and up.even):
        style.caption(figure, ["rows or columns that are not equally spaced are drawn with equal width and "
                               "labelled by their values"])
    figure.colorbar(mesh, ax=axis, label=r"intensity $|u|^2/\langle |u|^2\rangle$", extend="max", pad=0.02)


def draw_histogram(axis, result):
    low, (counts, error) = result.values("intensity_bin"), result.measured("histogram")
    expected = result.values("histogram_expected")
    width = low[1] - low[0]
    shown = (expected >= FEWEST_EXPECTED) & (counts > 0)
    shown[-1] = False  # the last bin has no upper limit
    unit = expected.sum() * width
    x = np.linspace(0, np.max(low[shown], initial=width) + width, 200)
    axis.semilogy(x, np.exp(-x), color=style.COLOURS[1], label=r"$\exp(-I/\langle I\rangle)$")
    axis.errorbar(low[shown] + width / 2, counts[shown] / unit, error[shown] / unit,
                  **style.symbols(0), markersize=2.5, label=f"{len(result.dataset('field'))} fields")
    contrast, spread = result.measured("mean_contrast")
    axis.text(0.05, 0.06, f"contrast {contrast:.3f} $\\pm$ {spread:.1g}", transform=axis.transAxes)
    axis.set(xlabel=r"intensity $I/\langle I\rangle$", ylabel="probability density")
    axis.legend(loc="upper right")


def draw_autocorrelation(axis, result):
    if not result.has("intensity_autocorrelation"):
        axis.text(0.5, 0.5, "detection directions\nare not equally spaced", ha="center", va="center",
                  transform=axis.transAxes)
        axis.set_axis_off()
        return
    far = result.has("view_angle")
    unit = 1 if far else result.attribute("wavelength")
    lag = result.values("view_lag") / unit
    found, error = result.measured("intensity_autocorrelation")
    expected = result.values("siegert") if result.has("siegert") else np.zeros_like(found)
    reach = lag <= 5 * lag[np.argmax((expected if expected.any() else found) < 0.3)]
    style.mark(axis, 0)
    if result.has("siegert"):
        axis.plot(lag[reach], expected[reach], color=style.COLOURS[1],
                  label=r"$|\langle u u'^*\rangle|^2/\langle I\rangle\langle I'\rangle$")
    axis.errorbar(lag[reach], found[reach], error[reach], **style.symbols(0), markersize=2.5,
                  label=r"$\langle I I'\rangle/\langle I\rangle\langle I'\rangle-1$")
    if result.has("grain_width"):
        # The width of a speckle is twice the lag of half the maximum.
        width, error = (float(value) / unit for value in result.measured("grain_width"))
        axis.plot([0, width / 2], [found[0] / 2] * 2, color="black", linewidth=0.8, marker="|", markersize=5)
        axis.text(0.97, 0.35, f"speckle width {width:.3g} $\\pm$ {error:.1g}\n(full width, half maximum)", ha="right",
                  transform=axis.transAxes, fontsize=6.5)
    axis.set(xlabel=r"difference of sines, $\sin v'-\sin v$" if far else r"distance of sensors / $\lambda$",
             ylabel="intensity autocorrelation")
    axis.xaxis.set_major_locator(MaxNLocator(4))
    axis.legend(loc="upper right")


@script.plot(dpi=150)
def draw(result):
    if result.has("camera_x") or result.has("image_x"):
        raise style.Unusable(f"{result.path}: has pictures of a camera; draw it with plots/camera_field.py")
    figure = plt.figure(figsize=(style.PAGE, 3.2))
    grid = figure.add_gridspec(2, 2, width_ratios=[1.9, 1])
    draw_picture(figure, figure.add_subplot(grid[:, 0]), result)
    draw_histogram(figure.add_subplot(grid[0, 1]), result)
    draw_autocorrelation(figure.add_subplot(grid[1, 1]), result)
    return figure
