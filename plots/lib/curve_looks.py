"""Symbols of curves and points of sweeps, and their legend entries (handle, label)."""

from lib import style
from lib.sweep_file import LEAST_STEPS, METHODS

import matplotlib.pyplot as plt

RING = {"color": "black", "linestyle": "none", "marker": "o", "markersize": 8,
        "markerfacecolor": "none", "markeredgewidth": 0.6}
SINGLE_SCATTERING = {"color": "0.55", "linewidth": 1.6}
ARROWS = {1: 11, 2: -11}  # by range_censored: points of print towards where the range may be
FEW_STEPS = f"fewer than {LEAST_STEPS} tilts up to the range"


def method_look(method, colour, size=3.5):
    """Monte Carlo open and large where both methods are drawn: the other shows inside."""
    scales = {None: 1, "mc": 1.6}
    return {"color": colour, "markersize": scales.get(method, 0.7) * size,
            "markerfacecolor": "none" if method == "mc" else colour}


def curve_look(number, method):
    """Colour and symbol of one curve; for one method every other one is open, for prints without
    colour."""
    look = style.look(number)
    fill = {} if method or number % 2 == 0 else {"markerfacecolor": "white"}
    return {"marker": look["marker"], **method_look(method, look["color"], 3), **fill}


def curve_handle(sweep, number, with_line):
    """Legend handle of a curve: the symbol of its last method, and a line where theory is drawn."""
    look = {**curve_look(number, list(sweep.prefixes)[-1]), "markersize": 3}
    line = style.look(number)["linestyle"] if with_line else "none"
    return plt.Line2D([], [], linewidth=0.7, linestyle=line, **look)


def method_entries(sweep):
    """Of both methods, where a file holds both."""
    if len(sweep.prefixes) > 1:
        for method in sweep.prefixes:
            yield plt.Line2D([], [], linestyle="none", marker="o",
                             **method_look(method, "black")), METHODS[method]


def range_entries(sweep):
    """Of bounds and doubtful ranges, as far as there are any."""
    if sweep.has_bounds():
        yield plt.Line2D([], [], color="black", linestyle="none", marker=r"$\uparrow$",
                         markersize=6), "bound, no error bar"
    if sweep.has_few_steps():
        yield plt.Line2D([], [], **RING), FEW_STEPS


def draw_bound(axis, at, place, away, colour):
    """An arrow from a point at places of `place` by (x, y) points of print."""
    axis.annotate("", at, xycoords=place, textcoords="offset points", xytext=away, zorder=1,
                  arrowprops={"arrowstyle": "<|-", "color": colour, "shrinkA": 0, "shrinkB": 2,
                              "linewidth": 0.7, "mutation_scale": 6})
