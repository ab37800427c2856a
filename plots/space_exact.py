#!/usr/bin/env python3
"""Memory effect and coherent backscattering of resonant points, in space and in the plane: exact ensembles, Monte
Carlo and transport. Reads the table that scripts/space_exact.py writes (default: the shipped
data/space_exact.csv)."""

import functools
import pathlib

from lib import page, script, style
from lib.result_file import read_table

import matplotlib.pyplot as plt
import numpy as np

SHIPPED = pathlib.Path(__file__).parent.parent / "data" / "space_exact.csv"
COLUMNS = ("dimension", "curve", "optical_depth", "x", "method", "value", "error")
PANELS = {  # [row][column]: (dimension, curve, title)
    (0, 0): (3, "in", "space: tilt in the plane of incidence"), (0, 1): (3, "out", "space: tilt out of the plane"),
    (0, 2): (3, "cone", "space: backscattering"), (1, 0): (2, "in", "plane: tilt"),
    (1, 2): (2, "cone", "plane: backscattering")}
X_LABELS = {"cone": r"$k \ell\,|v + i|$", "in": "$qL$", "out": "$qL$"}
Y_LABELS = {"cone": "intensity / far mean", "in": "field correlation $C_E$"}


def points_of(rows, method):
    chosen = rows[rows["method"] == method]
    return [chosen[name] for name in ("x", "value", "error")]


def draw_panel(axis, rows, curve):
    for number, optical_depth in enumerate(np.unique(rows["optical_depth"])):
        own = rows[rows["optical_depth"] == optical_depth]
        x, value, _ = points_of(own, "transport")
        axis.plot(x, value, color=style.COLOURS[number], linewidth=0.7, zorder=1)
        x, value, error = points_of(own, "monte_carlo")
        axis.errorbar(x, value, error, **{**style.symbols(number), "markerfacecolor": "white", "markersize": 5.5},
                      zorder=2)
        x, value, error = points_of(own, "exact")
        axis.errorbar(x, value, error, **{**style.symbols(number), "markersize": 2.8}, zorder=3,
                      label=f"optical depth {optical_depth:g}")
    axis.set(xlabel=X_LABELS[curve], xlim=(0, 9.5 if curve == "cone" else None))
    if curve == "cone":
        style.mark(axis, 1)
    else:
        axis.set_ylim(0, 1.05)


def entries(axis):
    """Returns legend entries (handle, label)."""
    grey = {"color": "black", "linestyle": "none", "marker": "o"}
    return page.labelled([axis]) + [
        (plt.Line2D([], [], **grey, markersize=2.8), "exact ensembles of placements"),
        (plt.Line2D([], [], **grey, markersize=5.5, markerfacecolor="white"), "Monte Carlo"),
        (plt.Line2D([], [], color="black", linewidth=0.7), "transport, infinitely wide slab")]


@script.plot(read=functools.partial(read_table, columns=COLUMNS), metavar="TABLE.csv", default=SHIPPED)
def draw(rows):
    figure, axes = plt.subplots(2, 3, figsize=(style.PAGE, 4.2))
    for place, (dimension, curve, title) in PANELS.items():
        axis = axes[place]
        draw_panel(axis, rows[(rows["dimension"] == dimension) & (rows["curve"] == curve)], curve)
        axis.set_title(title, fontsize=7.5, pad=3)
        if curve in Y_LABELS:
            axis.set_ylabel(Y_LABELS[curve])
    axes[1, 1].axis("off")
    axes[1, 1].legend(*zip(*entries(axes[0, 0])), loc="center", fontsize=7)
    return figure
