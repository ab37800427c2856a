#!/usr/bin/env python3
"""Map of the memory-effect range (q L at C_I = 1/2) over optical depth and g from a sweep, one panel per albedo.
Lines mark where diffusion theory is wrong by 1, 5 and 20 %. Hatched: C_I stays above 1/2 at all tilts. Dashed:
thickness of 1 and 10 transport mean free paths."""

from lib import page, script, style, sweep_file

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm

AXES = ("g", "optical_depth")
LEAST_VALUES = 5  # along each axis, so that contours can be drawn
WRONG_BY = {0.01: (0, (1, 1)), 0.05: "-", 0.2: (0, (5, 1.5))}  # line styles
THICKNESSES = (1, 10)  # transport mean free paths
MAP = plt.get_cmap("cividis")


def check(sweep):
    """Raises Unusable for a sweep that cannot be drawn as a map."""
    if sweep.optional("diffusion_range") is None:
        sweep.refuse("has no dataset diffusion_range, which only sweeps of slabs have")
    for name in AXES:
        if sweep.is_list or len(sweep.values(name)) < LEAST_VALUES:
            sweep.refuse(f"the map needs a grid with at least {LEAST_VALUES} values of g and of "
                         "optical_depth")
    shown = (*AXES, "albedo")
    sweep.refuse_others([name for name in sweep.varying() if name not in shown], ", ".join(shown))
    cells = np.prod([len(sweep.values(name)) for name in shown])
    if len(sweep.rows) < cells:
        sweep.refuse(f"{cells - len(sweep.rows)} of {cells} points are not finished")
    if len(sweep.values("albedo")) > 4:
        sweep.refuse("more than 4 albedos do not fit a page", ("albedo", 3))


def table(sweep, rows, values):
    """Returns values of a panel's points as [g, optical depth]."""
    order = np.lexsort((sweep.columns["optical_depth"][rows], sweep.columns["g"][rows]))
    return values[rows[order]].reshape([len(sweep.values(name)) for name in AXES])


def draw_panel(axis, sweep, rows, method, norm):
    depths, cosines = (sweep.values(name) for name in reversed(AXES))
    ranges, _, censored, diffusion = (
        table(sweep, rows, values) for values in (*sweep.ranges(method), sweep.optional("diffusion_range")))
    bounds = censored > 0
    image = axis.pcolormesh(depths, cosines, ranges, norm=norm, cmap=MAP, shading="gouraud",
                            rasterized=True)
    if bounds.any():
        axis.contourf(depths, cosines, bounds.astype(float), [0.5, 1], colors="none",
                      hatches=["////"])
    # The larger of ratio and inverse ratio: a range that is too short by a factor is as wrong as one that is too
    # long.
    wrong_by = np.maximum(diffusion / ranges, ranges / diffusion) - 1
    known = np.ma.array(np.log(wrong_by), mask=bounds)
    for level, line in WRONG_BY.items():
        for colour, width, style_of_line in (("white", 1.8, "-"), ("black", 0.9, line)):
            axis.contour(depths, cosines, known, [np.log(level)], colors=colour, linewidths=width,
                         linestyles=[style_of_line])
    thickness = depths[None, :] * (1 - cosines[:, None] * sweep.columns["albedo"][rows[0]])
    axis.contour(depths, cosines, thickness, THICKNESSES, colors=style.COLOURS[1], linewidths=0.7,
                 linestyles="--")
    axis.set(xscale="log", xlabel="optical depth", ylabel="mean cosine $g$")
    return image


def entries():
    """Yields legend entries (handle, label)."""
    for level, line in WRONG_BY.items():
        yield (plt.Line2D([], [], color="black", linewidth=0.9, linestyle=line),
               f"diffusion theory wrong by {100 * level:.0f} %")
    yield (plt.Line2D([], [], color=style.COLOURS[1], linewidth=0.7, linestyle="--"),
           f"{' and '.join(map(str, THICKNESSES))} transport mean free paths")
    yield (plt.Rectangle((0, 0), 1, 1, fill=False, hatch="////", edgecolor="0.4"),
           "lower bound: $C_I$ stays above 1/2")


@script.plot()
@sweep_file.SELECT
def draw(result, arguments):
    sweep = sweep_file.read(result, arguments)
    check(sweep)
    method = next(iter(sweep.prefixes))
    parts = sweep.groups("albedo" if "albedo" in sweep.columns else None, sweep.rows)
    figure, axes = page.page_of_panels(1, len(parts), len(parts))
    ranges = sweep.of(method, "memory_effect_range")[sweep.rows]
    norm = LogNorm(ranges.min(), ranges.max())
    for axis, (albedo, rows) in zip(axes.flat, parts):
        image = draw_panel(axis, sweep, rows, method, norm)
        axis.set_title(sweep_file.text("albedo", albedo), fontsize=7.5, pad=3)
    page.outer_labels(axes, len(parts))
    bar = figure.colorbar(image, ax=list(axes.flat), aspect=25, pad=0.015, fraction=0.05)
    style.few_decades(bar.ax.yaxis)
    bar.set_label(r"range $qL$ at $C_I = 1/2$")
    page.legend_outside(figure, list(entries()), sweep.unfinished())
    return figure
