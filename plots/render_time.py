#!/usr/bin/env python3
"""Time-resolved picture of `flatspeckle render` with path_bins: a film strip of frames, each for an interval of
optical path, all with one colour scale. The panel below shows the pulse with standard errors and the intervals of the
frames; for a single pixel or rings, only the pulse is drawn. Separate points at the sides show light with shorter or
longer optical paths than all bins."""

from lib import pictures, script, style

import matplotlib.pyplot as plt
import numpy as np

PICOSECOND = 1e-12
PULSE_DECADES = 6  # decades below the peak that are drawn; fainter light is noise


def shares(bins, frames):
    """Returns the first bin and the end bin (exclusive) of each frame."""
    cuts = np.linspace(0, bins, min(frames, bins) + 1).round().astype(int)
    return list(zip(cuts[:-1], cuts[1:]))


def draw_film(figure, axes, result, parts, norm):
    transient = result.values("transient")
    across, up = pictures.axis_names(result)
    paths = np.linspace(*pictures.edges(result.values("optical_path")), transient.shape[2] + 1)
    figure.suptitle(f"optical path ({pictures.length_name(result)})", fontsize=8)
    for number, (axis, (first, last)) in enumerate(zip(axes, parts)):
        image = pictures.show(axis, result, transient[:, :, first:last].sum(axis=2),
                              cmap="inferno", norm=norm)
        axis.set_title(f"{paths[first]:.4g} to {paths[last]:.4g}", fontsize=7)
        axis.tick_params(direction="out", top=False, right=False, labelleft=number == 0)
        axis.set_xlabel(across)
    axes[0].set_ylabel(up)
    figure.colorbar(image, ax=axes, label=pictures.quantity(result), extend="both", pad=0.01)


def draw_pulse(axis, result, parts):
    path, (pulse, error) = result.values("optical_path"), result.measured("pulse")
    cuts = np.linspace(*pictures.edges(path), len(path) + 1)
    for number, (first, last) in enumerate(parts):
        axis.axvspan(cuts[first], cuts[last], color="0.93" if number % 2 else "white", zorder=0)
    lit = pulse > pulse.max() * 10.0**-PULSE_DECADES
    if not np.any(lit):
        raise style.Unusable(f"{result.path}: all bins are dark")
    axis.stairs(np.where(lit, pulse, np.nan), cuts, color=style.COLOURS[0], baseline=None)
    axis.errorbar(path[lit], pulse[lit], pictures.below(pulse, error)[lit], fmt="none",
                  color=style.COLOURS[0], elinewidth=0.6)
    draw_beyond(axis, result, cuts)
    units = pictures.unit_name(result, "pulse")
    axis.set(yscale="log", ylim=(0.3 * pulse[lit].min(), None), xlabel=f"optical path ({pictures.length_name(result)})",
             ylabel=f"mean over the pixels, per bin ({units})" if units else "power per bin")
    if result.has("time"):
        rate = result.values("time")[-1] / path[-1] / PICOSECOND
        above = axis.secondary_xaxis("top", functions=(lambda x: x * rate, lambda t: t / rate))
        above.set_xlabel("time (ps)")
        axis.tick_params(top=False)


def draw_beyond(axis, result, cuts):
    """Draws light outside the bins, if there is any, beyond vertical lines at the sides."""
    room = 0.06 * (cuts[-1] - cuts[0])
    for name, edge, side in (("before", cuts[0], -1), ("after", cuts[-1], 1)):
        light, error = result.measured(f"pulse_{name}")
        axis.axvline(edge, color="0.6", linewidth=0.6)
        if light > 0:
            axis.errorbar(edge + side * room / 2, light, pictures.below(light, error), fmt="_",
                          color=style.COLOURS[1], label="shorter or longer paths")
    axis.set_xlim(cuts[0] - room, cuts[-1] + room)


@script.plot(one_run=True, dpi=150)
@pictures.tone_options("log")
@script.option("--sensor", metavar="NAME", help="sensor to be drawn, if the result has several")
@script.option("--frames", type=int, default=6, help="number of frames of the film strip (default: 6)")
def draw(result, arguments):
    result = pictures.chosen(result, arguments.sensor)
    result.require("transient", "requires render with --path_bins")
    if arguments.frames < 1:
        raise style.Unusable("--frames must be positive")
    transient = result.values("transient")
    if transient.ndim < 3 or transient[:, :, 0].size == 1:
        figure, axis = plt.subplots(figsize=(style.PAGE, 2.1))
        draw_pulse(axis, result, [])
        return figure
    parts = shares(transient.shape[2], arguments.frames)
    frames = [transient[:, :, first:last].sum(axis=2) for first, last in parts]
    width = 0.85 * style.PAGE / len(parts)
    height = np.clip(pictures.height_over_width(result), 0.3, 3) * width + 0.7
    figure = plt.figure(figsize=(style.PAGE, height + 1.9))
    film, curve = figure.subfigures(2, 1, height_ratios=[height, 1.9])
    draw_film(film, film.subplots(1, len(parts), sharey=True, squeeze=False)[0], result, parts,
              pictures.tone(frames, arguments))
    draw_pulse(curve.subplots(), result, parts)
    return figure
