#!/usr/bin/env python3
"""Result of `flatspeckle design`: the index in a slice with rays before and after the design, the index profile
compared with the closed form, the pictures compared with the requested ones, and the progress of the search."""

from lib import page, script, style

import matplotlib.pyplot as plt
import numpy as np


def draw_slice(axis, result):
    x, z, index = (result.values(name) for name in ("slice_x", "slice_z", "slice_index"))
    radius = x[-1]
    low, high = min(1, index.min()), index.max()
    mesh = axis.pcolormesh(z, x, index, cmap=style.INDEX, vmin=low, vmax=high + 0.5 * (high - low) + 1e-9,
                           rasterized=True, shading="nearest")
    bar = axis.figure.colorbar(mesh, ax=axis, label="index $n$", pad=0.02, shrink=0.8)
    bar.ax.set_ylim(low, high + 1e-9)
    for name, colour, width in (("before", "0.6", 0.5), ("after", style.COLOURS[1], 0.7)):
        for px, pz in zip(result.values(f"{name}/x"), result.values(f"{name}/z")):
            axis.plot(pz, px, color=colour, linewidth=width)
    square = np.array([(-1, -1), (-1, 1), (1, 1), (1, -1), (-1, -1)]).T
    around = square if result.has("excess") else style.circle()
    axis.plot(*(radius * around), color="black", linewidth=0.8)
    axis.set(xlabel="$z$", ylabel="$x$", xlim=(-1.3 * radius, 1.5 * radius),
             ylim=(-1.2 * radius, 1.2 * radius), aspect="equal")


def draw_profile(axis, result):
    r, index, spread = (result.values(f"profile/{name}") for name in ("r", "index", "spread"))
    focus, radius = result.attribute("focus"), r[-1]
    axis.set(xlabel="$r$", ylabel="index $n$, statistics over directions")
    if focus is not None and focus <= radius:
        f = focus / radius  # the closed form: a lens with index 1 at its rim and a focus inside or on the rim
        error = np.abs(index - np.sqrt(1 + f**2 - (r / radius)**2) / f)
        axis.semilogy(r[:-1], np.maximum(error, 1e-16)[:-1], color=style.COLOURS[0], label="mean")
        axis.set_ylabel("deviation from the closed form")
    axis.semilogy(r[1:-1], np.maximum(spread[1:-1], 1e-16), color=style.COLOURS[1], label="spread")
    axis.legend(loc="lower center", handlelength=1.2)


def draw_search(axis, result):
    traces, rms = result.values("history/traces"), result.values("history/rms")
    counts = result.values("history/coefficients")
    for number, count in enumerate(np.unique(counts)):
        here = np.flatnonzero(counts == count)
        shown = np.concatenate([here[:1] - 1, here]) if here[0] > 0 else here
        axis.semilogy(traces[shown], rms[shown], "o-", color=style.COLOURS[number % 6],
                      markersize=2.5, label=f"$s$: {count}")
    if result.has("rms/held_out_half_step"):
        axis.axhline(float(result.values("rms/held_out_half_step")), color="black", linewidth=0.8,
                     linestyle=":", label="rays not used")
    of_pictures = result.has("picture/shown")
    axis.set(xlabel="traces of each ray",
             ylabel="difference of pictures (RMS)" if of_pictures else "RMS miss distance of rays")
    axis.legend(loc="upper right", handlelength=1.2, fontsize=6)


def draw_guide(axis, result):
    """Draws the deviation of n from the parabola n^2 = n0^2 (1 - 2 delta q), divided by the index step, and that of
    n0 sech(alpha rho)."""
    r, index = result.values("profile/r"), result.values("profile/index")
    n0, delta, radius = (result.attribute(name, group="graded_spline") for name in ("index", "delta", "radius"))
    step = n0 * (1 - np.sqrt(1 - 2 * delta))
    parabola = n0 * np.sqrt(1 - 2 * delta * (r / radius)**2)
    alpha = np.arccosh(1 / np.sqrt(1 - 2 * delta)) / radius
    axis.plot(r, (index - parabola) / step, color=style.COLOURS[0], label="designed")
    axis.plot(r, (n0 / np.cosh(alpha * r) - parabola) / step, color="black", linestyle=":", label="sech")
    axis.set(xlabel=r"$\rho$", ylabel=r"$(n - n_\mathrm{parabola})/\Delta n$")
    axis.legend(handlelength=1.2)


def draw_pictures(axes, result):
    asked, shown = result.values("picture/asked"), result.values("picture/shown")
    for view, (top, bottom) in enumerate(zip(axes[0], axes[1])):
        brightest = asked[view].max()
        for axis, picture in ((top, asked[view]), (bottom, shown[view])):
            axis.imshow(picture / brightest, cmap="gray", vmin=0, vmax=1, interpolation="nearest")
            axis.set(xticks=[], yticks=[])
        bottom.set_xlabel(f"{result.values('picture/psnr_db')[view]:.1f} dB")
    axes[0][0].set_ylabel("requested")
    axes[1][0].set_ylabel("produced")


@script.plot()
def draw(result):
    if result.has("graded_spline"):
        return page.side_by_side(result, (draw_guide, draw_search), style.PAGE * 0.75, 2.4)
    if not result.has("picture/shown"):
        return page.side_by_side(result, (draw_slice, draw_profile, draw_search), style.PAGE, 2.4,
                                 width_ratios=[1.6, 1, 1])
    views = len(result.values("picture/psnr_db"))
    figure = plt.figure(figsize=(style.PAGE, 2.4))
    left, middle, right = figure.subfigures(1, 3, width_ratios=[1.5, 0.6 * views, 1])
    draw_slice(left.subplots(), result)
    draw_pictures(middle.subplots(2, views, squeeze=False), result)
    draw_search(right.subplots(), result)
    return figure
