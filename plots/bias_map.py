#!/usr/bin/env python3
"""How far Monte Carlo is from the exact solver, against 1/(k mean free path) and packing fraction,
from the table that scripts/bias_map.py makes (default: the shipped data/bias_map.csv)."""

import argparse
import csv
import pathlib

from lib import style

import matplotlib.pyplot as plt
import numpy as np

SHIPPED = pathlib.Path(__file__).parent.parent / "data" / "bias_map.csv"


def read_rows(path):
    try:
        with open(path, newline="") as file:
            return list(csv.DictReader(line for line in file if not line.startswith("#")))
    except (OSError, UnicodeDecodeError):
        raise SystemExit(f"{path}: is not the table that scripts/bias_map.py makes")


def columns(rows, *names):
    return [np.array([float(row[name]) for row in rows]) for name in names]


def draw_curve(axis, number, label, x, rows):
    """Mean over the views with its error bar, filled; RMS, open; views along the faces, crosses."""
    look = style.look(number)
    mean, error, rms, grazing, grazing_error = (
        100 * values
        for values in columns(rows, "mean", "mean_error", "rms", "grazing", "grazing_error"))
    axis.errorbar(x, mean, error, **look, elinewidth=0.7, label=label)
    axis.plot(x, rms, color=look["color"], marker=look["marker"], linestyle="none",
              markerfacecolor="white", zorder=1)
    axis.errorbar(x, grazing, grazing_error, color=look["color"], marker="x", linestyle="none",
                  elinewidth=0.5, markersize=3, zorder=1)


def draw_line(axis, x, y, label):
    axis.plot(x, 100 * y, color=style.GREY, linewidth=0.6, linestyle=(0, (4, 2)), zorder=0,
              label=label)


def draw_points(axis, rows):
    for number, optical_depth in enumerate(sorted({row["optical_depth"] for row in rows},
                                                  key=float)):
        chosen = [row for row in rows if row["optical_depth"] == optical_depth]
        x, = columns(chosen, "k_mean_free_path")
        draw_curve(axis, number, f"optical depth {float(optical_depth):g}", 1 / x, chosen)
    x, mean = columns(rows, "k_mean_free_path", "mean")
    slope = np.sum(mean / x) / np.sum(1 / x**2)
    line = np.array([0, 1.05 / x.min()])
    draw_line(axis, line, slope * line, rf"${slope:.2f}/(k \ell)$")
    axis.set_xlabel(r"$1/(k \ell)$, $\ell$ the mean free path")
    axis.set_title("resonant points")


def draw_disks(axis, rows):
    labels = {"none": "independent positions", "hard_disks": "structure factor of hard disks"}
    for number, (structure, label) in enumerate(labels.items()):
        chosen = [row for row in rows if row["structure"] == structure]
        x, shift = columns(chosen, "packing_fraction", "k_shift_over_k")
        draw_curve(axis, number + 2, label, x, chosen)
    draw_line(axis, x, -shift, r"$-\Delta k/k$")
    axis.set_xlabel(r"packing fraction $\phi$")
    axis.set_title("cylinders, $ka = 1$, index 1.2")


def draw(rows):
    figure, axes = plt.subplots(1, 2, figsize=(style.PAGE, 2.8))
    families = {"points": draw_points, "disks": draw_disks}
    for axis, (family, draw_family) in zip(axes, families.items()):
        draw_family(axis, [row for row in rows if row["family"] == family])
        axis.axhline(0, color="black", linewidth=0.5, zorder=0)
        axis.set_xlim(left=0)
        axis.legend(loc="upper left")
    kinds = (("black", "o", "filled: mean over the views"), ("white", "o", "open: RMS"),
             ("black", "x", "crosses: mean of the views along the faces"))
    handles = [plt.Line2D([], [], color="black", marker=marker, markerfacecolor=fill,
                          linestyle="none", label=label) for fill, marker, label in kinds]
    figure.legend(handles=handles, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=3)
    axes[0].set_ylabel("(Monte Carlo $-$ exact) / exact, %")
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("table", metavar="TABLE.csv", nargs="?", default=SHIPPED)
    parser.add_argument("--out", metavar="PREFIX", default="bias_map",
                        help="writes PREFIX.png and PREFIX.pdf (default: bias_map)")
    arguments = parser.parse_args()
    style.save(draw(read_rows(arguments.table)), arguments.out)


if __name__ == "__main__":
    main()
