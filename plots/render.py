#!/usr/bin/env python3
"""Picture of `flatspeckle render` with tone mapping, and its relative standard error. Several results or sensors have
a row each; those that measure the same quantity share one colour scale. Sensors without a picture, such as rings, are
omitted. The brightest 0.1 % of the pixels share one colour."""

from lib import pictures, script, style

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm, PowerNorm
from matplotlib.ticker import FuncFormatter, MaxNLocator, NullFormatter

DPI = 150  # pictures that fill the page make large files
MOST = 1.0  # largest relative error on the colour scale
DECADES = 4  # of relative errors on the colour scale, at most


def relative_error(result):
    """Returns the relative error of each pixel, masked where there is no light."""
    value, error = (np.ma.masked_where(result.values("image") <= 0, values)
                    for values in result.measured("image"))
    return error / value


def panel(figure, axis, result, picture, label, extend, **look):
    image = pictures.show(axis, result, picture, **look)
    axis.tick_params(direction="out", top=False, right=False)
    for side in (axis.xaxis, axis.yaxis):
        side.set_major_locator(MaxNLocator(5))
    return figure.colorbar(image, ax=axis, label=label, extend=extend, shrink=0.95, pad=0.02)


def draw_image(figure, axis, result, norm):
    bar = panel(figure, axis, result, result.values("image"), pictures.quantity(result),
                "both" if norm.vmin > 0 else "max", cmap="inferno", norm=norm)
    if not isinstance(norm, LogNorm):
        ticks = [tick for tick in MaxNLocator(4).tick_values(norm.vmin, norm.vmax) if norm.vmin <= tick < norm.vmax]
        if isinstance(norm, PowerNorm):  # ticks that would overlap on a square-root scale are omitted
            ticks = [norm.vmin]
            for tick in MaxNLocator(8).tick_values(norm.vmin, norm.vmax):
                if tick <= norm.vmax and norm(tick) - norm(ticks[-1]) > 0.12:
                    ticks.append(tick)
        bar.set_ticks(ticks)
        bar.ax.yaxis.get_offset_text().set_ha("left")
        bar.formatter.set_powerlimits((-2, 4))


def say_what_is_no_error(axis, result, error):
    """Writes above the panel which pixels have no error estimate (hatched, because they have no light) and which have
    only upper bounds, because they or their neighbours depend on few high-weight paths."""
    notes = []
    if result.has("image_rare") and np.any(result.values("image_rare")):
        notes.append("blocks: upper bounds (few high-weight paths)")
    if np.ma.is_masked(error):
        axis.patch.set(hatch="xxxx", facecolor="white", edgecolor="0.6")
        notes.append("hatched: no light yet")
    axis.set_title("\n".join(notes), fontsize=7, loc="right", pad=2)


def draw_error(figure, axis, result, norm):
    say_what_is_no_error(axis, result, relative_error(result))
    bar = panel(figure, axis, result, relative_error(result), "relative standard error", "both", cmap="cividis",
                norm=norm)
    bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda share, _: f"{100 * share:g} %"))
    bar.ax.yaxis.set_minor_formatter(NullFormatter())


@script.plot(several=True, one_run=True, dpi=DPI)
@pictures.tone_options()
def draw(results, arguments):
    shown = [(label, result) for label, result in pictures.sensors(results) if pictures.is_picture(result)]
    for result in results:
        if not any(result.file == drawn.file for _, drawn in shown):
            raise style.Unusable(f"{result.path}: has no picture; requires render with rows and columns of pixels")
    names, results = zip(*shown)
    if not any(np.any(result.values("image") > 0) for result in results):
        raise style.Unusable(f"{results[0].path}: all pixels are dark")
    height = np.clip(pictures.height_over_width(results[0]), 0.2, 2) * 0.36 * style.PAGE + 0.4
    figure, axes = plt.subplots(len(results), 2, squeeze=False,
                                figsize=(style.PAGE, len(results) * height))
    # The colour scale of errors begins at the power of ten below the smallest errors in all results, without those of
    # pixels that are exact, such as of an even background, but at most DECADES below the largest.
    found = np.concatenate([relative_error(result).compressed() for result in results])
    best = np.quantile(found[found > 0], 0.01) if np.any(found > 0) else MOST
    least = np.clip(10 ** np.floor(np.log10(best)), MOST / 10**DECADES, MOST / 10)
    errors = LogNorm(least, MOST, clip=True)
    quantities = [pictures.quantity(result) for result in results]  # all results with the same quantity share a scale
    norms = {name: pictures.tone([result.values("image") for result, own in zip(results, quantities)
                                  if own == name], arguments)
             for name in set(quantities)}
    for (left, right), result, label, quantity in zip(axes, results, names, quantities):
        draw_image(figure, left, result, norms[quantity])
        draw_error(figure, right, result, errors)
        across, up = pictures.axis_names(result)
        left.set(xlabel=across, ylabel=up)
        right.set_xlabel(across)
        if len(results) > 1:
            left.set_title(label, loc="left")
    if any(result.has("image_rare") for result in results):
        style.caption(figure, ["errors of pixels that depend on few high-weight paths, and of their neighbours, "
                               "are upper bounds (image_rare)"])
    return figure
