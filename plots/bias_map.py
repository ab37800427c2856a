#!/usr/bin/env python3
"""Deviation of Monte Carlo from the exact solver, against 1/(k mean free path) and against packing fraction. Reads
the table that scripts/bias_map.py writes (default: the shipped data/bias_map.csv)."""

import functools
import pathlib

from lib import page, script, style
from lib.result_file import read_table

import matplotlib.pyplot as plt
import numpy as np

SHIPPED = pathlib.Path(__file__).parent.parent / "data" / "bias_map.csv"
COLUMNS = ("family", "structure", "optical_depth", "k_mean_free_path", "packing_fraction", "k_shift_over_k",
           "mean", "mean_error", "rms", "grazing", "grazing_error")
KINDS = (("black", "o", "filled: mean over detection directions"), ("white", "o", "open: RMS"),
         ("black", "x", "crosses: mean of directions along the faces"))


def draw_curve(axis, number, label, x, rows):
    """Draws the mean over the detection directions with its error bar (filled symbols), the RMS (open), and the mean
    over directions along the faces (crosses)."""
    mean, error, rms, grazing, grazing_error = (
        100 * rows[name] for name in ("mean", "mean_error", "rms", "grazing", "grazing_error"))
    look = {**style.look(number), "linestyle": "none"}
    axis.errorbar(x, mean, error, **style.look(number), elinewidth=0.7, label=label)
    axis.plot(x, rms, **look, markerfacecolor="white", zorder=1)
    axis.errorbar(x, grazing, grazing_error, **{**look, "marker": "x"}, elinewidth=0.5, markersize=3,
                  zorder=1)


def draw_line(axis, x, y, label):
    axis.plot(x, 100 * y, color=style.GREY, linewidth=0.6, linestyle=(0, (4, 2)), zorder=0,
              label=label)


def fitted(x, mean):
    """Returns a in mean = a / x by least squares."""
    return np.sum(mean / x) / np.sum(1 / x**2)


def draw_points(axis, rows):
    for number, optical_depth in enumerate(np.unique(rows["optical_depth"])):
        chosen = rows[rows["optical_depth"] == optical_depth]
        draw_curve(axis, number, f"optical depth {optical_depth:g}", 1 / chosen["k_mean_free_path"], chosen)
    slope = fitted(rows["k_mean_free_path"], rows["mean"])
    line = np.array([0, 1.05 / rows["k_mean_free_path"].min()])
    draw_line(axis, line, slope * line, rf"${slope:.2f}/(k \ell)$")
    axis.set(xlabel=r"$1/(k \ell)$, $\ell$ the mean free path")


def draw_others(axis, rows, family, number, label):
    chosen = rows[rows["family"] == family]
    draw_curve(axis, number, label, 1 / chosen["k_mean_free_path"], chosen)


def draw_correlated(axis, rows, structure, kind):
    for number, (name, label) in enumerate({"none": "independent positions",
                                            structure: f"structure factor of hard {kind}"}.items()):
        chosen = rows[rows["structure"] == name]
        draw_curve(axis, number + 2, label, chosen["packing_fraction"], chosen)
    draw_line(axis, chosen["packing_fraction"], -chosen["k_shift_over_k"], r"$-\Delta k/k$")
    axis.set(xlabel=r"packing fraction $\phi$")


@script.plot(read=functools.partial(read_table, columns=COLUMNS), metavar="TABLE.csv", default=SHIPPED)
def draw(rows):
    figure, axes = plt.subplots(2, 2, figsize=(style.PAGE, 5.2))
    for axis, family, title in ((axes[0, 0], "points", "plane: resonant points"),
                                (axes[1, 0], "space_points", "space: points and resonant spheres")):
        draw_points(axis, rows[rows["family"] == family])
        axis.set_title(title)
    draw_others(axes[1, 0], rows, "space_shifted", 4, "points off resonance")
    draw_others(axes[1, 0], rows, "space_resonant", 5, "spheres, $ka = 1$, index 3")
    axes[1, 0].set_ylim(-16, 36)  # leaves space for the legend
    for axis, family, structure, kind, title in (
            (axes[0, 1], "disks", "hard_disks", "disks", "plane: cylinders, $ka = 1$, index 1.2"),
            (axes[1, 1], "space_spheres", "hard_spheres", "spheres", "space: spheres, $ka = 1$, index 1.2")):
        draw_correlated(axis, rows[rows["family"] == family], structure, kind)
        axis.set_title(title)
    for axis in axes.flat:
        axis.axhline(0, color="black", linewidth=0.5, zorder=0)
        axis.set_xlim(left=0)
        axis.legend(loc="upper left")
    page.legend_above(figure, [(plt.Line2D([], [], color="black", marker=marker, markerfacecolor=fill,
                                           linestyle="none"), label) for fill, marker, label in KINDS], 3)
    for axis in axes[:, 0]:
        axis.set_ylabel("(Monte Carlo $-$ exact) / exact, %")
    return figure
