#!/usr/bin/env python3
"""Light tagged by sound, from a result of `render` with tag_wavelength: the fractions of all light that are shifted by
multiples of the sound's frequency and, if the sensor has rings, the tagged fraction against the radius or angle."""

from lib import pictures, script, style

import matplotlib.pyplot as plt
import numpy as np


def draw_lines(axis, result):
    value, error = result.measured("mean_sideband")
    axis.bar(result.values("sideband"), value, yerr=error, color=style.look(0)["color"], width=0.6)
    axis.set(yscale="log", xlabel="shift (frequencies of the sound)", ylabel="fraction of the light",
             xticks=result.values("sideband"))


def draw_rings(axis, result, over):
    value, error = (part[0] for part in result.measured("image_sideband"))
    lit = value > 0
    axis.errorbar(result.values(over)[lit], 1 - value[lit], error[lit], color=style.look(0)["color"],
                  marker=style.look(0)["marker"])
    unit = "rad" if over == "angle" else pictures.length_name(result)
    axis.set(xlabel=f"{over} ({unit})", ylabel="tagged fraction")
    axis.set_ylim(0, 1.05 * axis.get_ylim()[1])


@script.plot(one_run=True, needs={"mean_sideband": "requires a result of render with tag_wavelength"})
def draw(result):
    rings = [axis for axis in ("radius", "angle") if result.has(axis) and result.has("image_sideband")
             and np.ndim(result.values("image_sideband")) == 2]
    figure, axes = plt.subplots(1, 1 + len(rings), squeeze=False, figsize=(style.PAGE if rings else style.COLUMN, 2.5))
    draw_lines(axes[0][0], result)
    for axis, over in zip(axes[0][1:], rings):
        draw_rings(axis, result, over)
    return figure
