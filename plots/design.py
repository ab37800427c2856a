#!/usr/bin/env python3
"""A field that `flatspeckle design` found: index over a slice with rays before and after, profile beside
the closed form of a lens with that focus, and how the search went."""

from lib import style

import matplotlib.pyplot as plt
import numpy as np

from matplotlib.colors import LinearSegmentedColormap

INDEX = LinearSegmentedColormap.from_list("index", ["white", "#56B4E9", "#00456b"])


def closed_form(r, focus, radius):
    """A lens whose index is 1 at its rim: of a focus inside or on it."""
    f = focus / radius
    return np.sqrt(1 + f**2 - (r / radius)**2) / f


def draw_slice(figure, axis, result):
    x, z, index = (result.values(name) for name in ("slice_x", "slice_z", "slice_index"))
    radius = x[-1]
    low, high = min(1, index.min()), index.max()
    mesh = axis.pcolormesh(z, x, index, cmap=INDEX, vmin=low, vmax=high + 0.5 * (high - low) + 1e-9,
                           rasterized=True, shading="nearest")
    bar = figure.colorbar(mesh, ax=axis, label="index $n$", pad=0.02, shrink=0.8)
    bar.ax.set_ylim(low, high + 1e-9)
    for name, colour, width in (("before", "0.6", 0.5), ("after", style.COLOURS[1], 0.7)):
        for px, pz in zip(result.values(f"{name}/x"), result.values(f"{name}/z")):
            axis.plot(pz, px, color=colour, linewidth=width)
    turn = np.linspace(0, 2 * np.pi, 200)
    axis.plot(radius * np.cos(turn), radius * np.sin(turn), color="black", linewidth=0.8)
    axis.set(xlabel="$z$", ylabel="$x$", xlim=(-1.3 * radius, 1.5 * radius),
             ylim=(-1.2 * radius, 1.2 * radius), aspect="equal")


def draw_profile(axis, result):
    r, index, spread = (result.values(f"profile/{name}") for name in ("r", "index", "spread"))
    focus, radius = result.attribute("focus"), r[-1]
    axis.set(xlabel="$r$", ylabel="$n$ over directions")
    if focus is not None and focus <= radius:
        error = np.abs(index - closed_form(r, focus, radius))
        axis.semilogy(r[:-1], np.maximum(error, 1e-16)[:-1], color=style.COLOURS[0], label="mean")
        axis.set_ylabel("distance from the closed form")
    axis.semilogy(r[1:-1], np.maximum(spread[1:-1], 1e-16), color=style.COLOURS[1],
                  label="spread")
    axis.legend(loc="lower center", handlelength=1.2)


def draw_search(axis, result):
    traces, rms = result.values("history/traces"), result.values("history/rms")
    counts = result.values("history/coefficients")
    for number, count in enumerate(np.unique(counts)):
        here = np.flatnonzero(counts == count)
        shown = np.concatenate([here[:1] - 1, here]) if here[0] > 0 else here
        axis.semilogy(traces[shown], rms[shown], "o-", color=style.COLOURS[number % 6], markersize=2.5,
                      label=f"$s$: {count}")
    held_out = result.values("rms/held_out_half_step") if result.has("rms/held_out_half_step") else None
    if held_out is not None:
        axis.axhline(float(held_out), color="black", linewidth=0.8, linestyle=":",
                     label="held out")
    axis.set(xlabel="traces of each ray", ylabel="rays miss by (rms)")
    axis.legend(loc="upper right", handlelength=1.2, fontsize=6)


def draw(results):
    result = results[0]
    figure, axes = plt.subplots(1, 3, figsize=(style.PAGE, 2.4), width_ratios=[1.6, 1, 1])
    draw_slice(figure, axes[0], result)
    draw_profile(axes[1], result)
    draw_search(axes[2], result)
    return figure


if __name__ == "__main__":
    style.main(draw, __doc__)
