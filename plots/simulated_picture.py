#!/usr/bin/env python3
"""Pictures from simulated frames in space (`flatspeckle image --dimension 3`): a frame, the true picture and pictures
recovered from frames with a scale bar, and the correlation C_I of two points over their distance."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np

SHOWN = 2  # recovered pictures
STEPS = (1, 2, 5, 10)


def bar_length(extent):
    """Returns a round length of at most a third of an extent."""
    power = 10.0**np.floor(np.log10(extent / 3))
    return max(step * power for step in STEPS if step * power <= extent / 3)


def unit_of(result):
    """Returns the unit of places on the object: none for sines of directions."""
    return "" if result.dataset("place_x").attrs["units"] in ("1", b"1") else " length units"


def draw_picture(axis, result, picture, title):
    x, y = result.values("place_x"), result.values("place_y")
    half = (x[1] - x[0]) / 2
    axis.imshow(picture, cmap="gray", vmin=0, extent=(x[0] - half, x[-1] + half, y[-1] + half, y[0] - half))
    bar = bar_length(x[-1] - x[0])
    left, low = x[0] + half, y[-1] - 2 * half
    axis.plot([left, left + bar], [low, low], color="w", linewidth=2)
    axis.text(left, low - half, f"{bar:.3g}{unit_of(result)}", color="w", fontsize=6, va="bottom")
    axis.set_title(title, fontsize=7)
    axis.set(xticks=[], yticks=[])


def draw_range(axis, result):
    x = result.values("separation")
    unit = unit_of(result).strip() or "sine"
    axis.errorbar(x, result.values("separation_correlation"), result.values("separation_correlation_error"),
                  **style.line(0))
    axis.axhline(0.5, color="0.6", linewidth=0.8)
    if result.has("field_of_view"):
        axis.axvline(float(result.values("field_of_view")), color="0.6", linewidth=0.8)
    axis.set(xlabel=f"distance [{unit}]", ylabel="$C_I$ of their speckles", ylim=(0, 1.05))


@script.plot(one_run=True, needs={"recovered_picture": "run image with dimension = 3 and repeats of at least 1"}, dpi=150)
def draw(result):
    pictures = result.dataset("recovered_picture")[:SHOWN]
    figure, axes = plt.subplots(1, 3 + len(pictures), figsize=(style.PAGE, 1.9), layout="constrained")
    axes[0].imshow(result.dataset("frames")[0], cmap="gray", vmin=0)
    axes[0].set_title("frame", fontsize=7)
    axes[0].set(xticks=[], yticks=[], xlabel=f"{result.dataset('frames').shape[2]} pixels")
    draw_picture(axes[1], result, result.dataset("true_picture")[()], "truth")
    for axis, picture, similarity in zip(axes[2:], pictures, result.values("similarity")):
        draw_picture(axis, result, picture, f"similarity {similarity:.2f}")
    draw_range(axes[-1], result)
    return figure
