#!/usr/bin/env python3
"""Rays or connecting curves of `flatspeckle trace` (with path_points) over the index map. If the optical paths of the
rays differ, a second panel shows them against the angle or height at which the rays start. If some rays end on a stop
surface, the second panel shows only these."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import MaxNLocator

MOST_DRAWN = 60
SAME = 1e-9  # relative difference below which values count as equal
ROUNDING = 1e-16


def draw_map(figure, axis, result, up):
    index, z = result.values("index_map"), result.values("map_z")
    across = result.values(f"map_{up}")
    shown = np.ma.masked_equal(index, 0)
    axis.set_facecolor("0.85")
    low, high = shown.min(), shown.max()
    if high - low < SAME * high:
        axis.pcolormesh(z, across, shown, cmap=style.INDEX, vmin=0, vmax=4 * high, rasterized=True)
        axis.set_title(f"index $n = {high:.6g}$", loc="right")
        return
    mesh = axis.pcolormesh(z, across, shown, cmap=style.INDEX, vmin=low, vmax=high + (high - low),
                           rasterized=True, shading="nearest")
    bar = figure.colorbar(mesh, ax=axis, label="index $n$", pad=0.02)
    bar.ax.set_ylim(low, high)
    bar.ax.yaxis.set_major_locator(MaxNLocator(5))
    bar.formatter.set_useOffset(False)


def draw_paths(axis, result, up):
    across, z = result.values(f"path/{up}"), result.values("path/z")
    chosen = np.unique(np.linspace(0, len(z) - 1, min(len(z), MOST_DRAWN)).round().astype(int))
    for n in chosen:
        axis.plot(z[n], across[n], color=style.COLOURS[1], linewidth=0.6)
    for end in (0, -1):
        axis.plot(z[chosen, end], across[chosen, end], "o", color="black", markersize=1.5)
    height, width = np.ptp(axis.get_ylim()), np.ptp(axis.get_xlim())
    if 0.25 < height / width < 4:
        axis.set_aspect("equal")


def start(result, up):
    """Returns the quantity that distinguishes rays at their start, and its label: the height, or the angle if all
    start at one point. For rays that fill a disk or a cone, these are measured from the z axis."""
    x, y, dx, dy, dz = (result.values(f"start/{name}") for name in ("x", "y", "dx", "dy", "dz"))
    if max(np.ptp(x), np.ptp(y)) > 0:
        if min(np.ptp(x), np.ptp(y)) > SAME * max(np.ptp(x), np.ptp(y)):
            return np.hypot(x, y), "distance from the $z$ axis\nat the start"
        return (x if up == "x" else y), f"${up}$ at the start"
    if min(np.ptp(dx), np.ptp(dy)) > SAME:
        return np.arctan2(np.hypot(dx, dy), dz), "angle to $z$ at the start (rad)"
    return np.arctan2(dx if up == "x" else dy, dz), "angle at the start (rad)"


def draw_spread(axis, result, up):
    stopped = result.values("status") == 0
    shown = stopped if stopped.any() else np.full(len(stopped), True)
    paths = result.values("optical_path")[shown]
    mean = paths.mean()
    where, label = start(result, up)
    spread = np.ptp(paths) / mean
    decade = int(np.floor(np.log10(max(spread, ROUNDING))))
    power = f" / 10^{{{decade}}}" if decade else ""
    axis.set(xlabel=label, ylabel=f"(optical path$/$mean $-\\ 1){power}$")
    axis.plot(where[shown], (paths / mean - 1) / 10.0**decade, "o", color=style.COLOURS[0])
    axis.set_title(f"relative spread {spread:.2g}, mean {mean:.6g}", loc="right")
    axis.margins(y=0.1)
    axis.xaxis.set_major_locator(MaxNLocator(4))


@script.plot(needs={"path/z": "trace with --path_points"})
def draw(result):
    up = result.dataset("index_map").dims[0].label.removeprefix("map_")  # the axis across z
    of_rays = result.has("ray")
    figure, axes = plt.subplots(1, 2 if of_rays else 1, squeeze=False,
                                figsize=(style.PAGE if of_rays else 4.5, 2.5),
                                width_ratios=[2, 1] if of_rays else [1])
    axis = axes[0, 0]
    draw_map(figure, axis, result, up)
    draw_paths(axis, result, up)
    axis.set(xlabel="$z$", ylabel=f"${up}$", xlim=result.values("map_z")[[0, -1]],
             ylim=result.values(f"map_{up}")[[0, -1]])
    axis.tick_params(direction="out", top=False, right=False)
    if of_rays:
        draw_spread(axes[0, 1], result, up)
    return figure
