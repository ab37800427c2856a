#!/usr/bin/env python3
"""Motion tracked by the correlation of images (`flatspeckle field` with camera_focus, delays and velocity): images at the
first and the last time, and the displacement at the largest correlation with the first image, beside the true one."""

import tomllib

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np


def displacement(first, other, step):
    """Returns the shift in x and y at which the correlation of two images is largest, to a fraction of a pixel."""
    a, b = (image - image.mean() for image in (first, other))
    correlation = np.real(np.fft.ifft2(np.conj(np.fft.fft2(a)) * np.fft.fft2(b)))
    row, column = np.unravel_index(correlation.argmax(), correlation.shape)

    def along(values, place):
        """Returns the maximum of a parabola through the largest value and its neighbours."""
        before, at, after = (values[(place + by) % len(values)] for by in (-1, 0, 1))
        place = place + 0.5 * (before - after) / (before - 2 * at + after)
        return (place + len(values) / 2) % len(values) - len(values) / 2

    return along(correlation[row], column) * step, along(correlation[:, column], row) * step


@script.plot(dpi=150)
def draw(result):
    for name in ("field", "delay", "image_x"):
        result.require(name, "run field with camera_focus, delays and velocity")
    intensity = np.abs(result.values("field"))**2
    delay, x, y = (result.values(name) for name in ("delay", "image_x", "image_y"))
    moved = np.array([[displacement(images[0], image, x[1] - x[0]) for image in images] for images in intensity])
    figure, axes = plt.subplots(1, 3, figsize=(style.PAGE, 2.3), layout="constrained")
    for axis, time in zip(axes, (0, -1)):
        axis.imshow(intensity[0, time], cmap="inferno", origin="lower", extent=(x[0], x[-1], y[0], y[-1]))
        axis.set(xlabel="x", ylabel="y", title=f"time {delay[time]:g}")
    error = moved.std(axis=0, ddof=1) / np.sqrt(len(moved))
    velocity = tomllib.loads(result.attribute("config", "")).get("velocity", [0, 0])
    for number, (name, speed) in enumerate((("x", velocity[0]), ("y", velocity[2] if len(velocity) > 2 else 0))):
        axes[2].errorbar(delay, moved.mean(axis=0)[:, number], error[:, number], **style.symbols(number), label=name)
        axes[2].plot(delay, speed * delay, **style.line(number))
    axes[2].set(xlabel="time", ylabel="displacement (line: true)")
    axes[2].legend()
    return figure
