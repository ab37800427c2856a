"""Symbols for curves and points of sweeps, and their legend entries (handle, label)."""

from lib import style
from lib.sweep_file import LEAST_STEPS, METHODS

import matplotlib.pyplot as plt

RING = {"color": "black", "linestyle": "none", "marker": "o", "markersize": 8,
        "markerfacecolor": "none", "markeredgewidth": 0.6}
SINGLE_SCATTERING = {"color": "0.55", "linewidth": 1.6}
ARROWS = {1: 11, 2: -11}  # by range_censored: length of the arrow towards the possible ranges, in points (1/72 inch)
FEW_STEPS = f"fewer than {LEAST_STEPS} tilts below the range"


def method_look(method, colour, size=3.5):
    """Returns the look of a method. If two methods are drawn, Monte Carlo has large open symbols, so that the other
    method is visible inside."""
    scales = {None: 1, "mc": 1.6}
    return {"color": colour, "markersize": scales.get(method, 0.7) * size,
            "markerfacecolor": "none" if method == "mc" else colour}


def curve_look(number, method):
    """Returns colour and symbol of a curve. If there is only one method, every second curve has open symbols, so that
    curves can be distinguished without colour."""
    look = style.look(number)
    fill = {} if method or number % 2 == 0 else {"markerfacecolor": "white"}
    return {"marker": look["marker"], **method_look(method, look["color"], 3), **fill}


def curve_handle(sweep, number, with_line):
    """Returns the legend handle of a curve: the symbol of its last method, with a line if theory is drawn."""
    look = {**curve_look(number, list(sweep.prefixes)[-1]), "markersize": 3}
    line = style.look(number)["linestyle"] if with_line else "none"
    return plt.Line2D([], [], linewidth=0.7, linestyle=line, **look)


def method_entries(sweep):
    """Yields legend entries of the methods if a file contains several."""
    if len(sweep.prefixes) > 1:
        for method in sweep.prefixes:
            yield plt.Line2D([], [], linestyle="none", marker="o",
                             **method_look(method, "black")), METHODS[method]


def range_entries(sweep):
    """Yields legend entries of bounds and of ranges from too few tilts, if there are any."""
    if sweep.has_bounds():
        yield plt.Line2D([], [], color="black", linestyle="none", marker=r"$\uparrow$",
                         markersize=6), "bound (no error bar)"
    if sweep.has_few_steps():
        yield plt.Line2D([], [], **RING), FEW_STEPS


def draw_bound(axis, at, place, away, colour):
    """Draws an arrow that starts at a point, given in the coordinates `place`, and has the length (x, y) in points
    (1/72 inch)."""
    axis.annotate("", at, xycoords=place, textcoords="offset points", xytext=away, zorder=1,
                  arrowprops={"arrowstyle": "<|-", "color": colour, "shrinkA": 0, "shrinkB": 2,
                              "linewidth": 0.7, "mutation_scale": 6})
