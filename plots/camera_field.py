#!/usr/bin/env python3
"""Speckle on a camera (`flatspeckle field --camera_pixels`): intensity of the first realization under each light, and
the correlation of the intensity between the first light and the others, in the matched pixels and without a shift."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np

BRIGHTEST = 5  # times the mean: 0.7 % of a Gaussian field's intensities are above
MOST_PICTURES = 4


def shifted(intensity, by, step):
    """Returns the intensity that moved by `by` (direction cosines), and which pixels it is known in."""
    pixels = len(intensity)
    place = np.arange(pixels) + by / step
    low = np.floor(place).astype(int)
    inside = (low >= 0) & (low < pixels - 1)
    low = np.clip(low, 0, pixels - 2)
    part = place - low
    return (1 - part) * intensity[:, low] + part * intensity[:, low + 1], inside


def correlation(first, other):
    """Returns <I I'> / (<I> <I'>) - 1, relative to that of I with itself."""
    def excess(a, b):
        return (a * b).mean() / (a.mean() * b.mean()) - 1
    return excess(first, other) / np.sqrt(excess(first, first) * excess(other, other))


def correlations(result):
    """Returns the correlations over realizations, [matched or fixed pixels, realization, light], of tilts along x."""
    field = result.dataset("field")
    x = result.values("camera_x")
    moves = result.values("tilt_q") * result.attribute("wavelength") / (2 * np.pi)
    found = np.zeros((2, *field.shape[:2]))
    for number, realization in enumerate(np.abs(field)**2):
        for light, intensity in enumerate(realization):
            moved, inside = shifted(intensity, moves[light] - moves[0], x[1] - x[0])
            found[0, number, light] = correlation(realization[0][:, inside], moved[:, inside])
            found[1, number, light] = correlation(realization[0], intensity)
    return found


def draw_picture(axis, result, light):
    intensity = np.abs(result.dataset("field")[0, light])**2
    x, y = result.values("camera_x"), result.values("camera_y")
    half = (x[1] - x[0]) / 2
    mesh = axis.imshow(intensity / intensity.mean(), cmap="inferno", vmin=0, vmax=BRIGHTEST, origin="lower",
                       extent=(x[0] - half, x[-1] + half, y[0] - half, y[-1] + half))
    axis.set(xlabel="direction cosine $v_x$")
    if result.has("tilt"):
        axis.set_title(f"tilt {style.short(result.values('tilt'))[light]} rad", fontsize=7)
    return mesh


@script.plot(dpi=150)
def draw(result):
    if not result.has("camera_x"):
        raise style.Unusable(f"{result.path}: has no camera: take a result of field with camera_pixels")
    lights = min(result.dataset("field").shape[1], MOST_PICTURES)
    tilted = result.has("tilt") and lights > 1
    figure, axes = plt.subplots(1, lights + tilted, figsize=(style.PAGE, 2.2), squeeze=False, layout="constrained")
    for light in range(lights):
        mesh = draw_picture(axes[0, light], result, light)
        if light > 0:
            axes[0, light].set_yticklabels([])
    axes[0, 0].set(ylabel="direction cosine $v_y$")
    figure.colorbar(mesh, ax=axes[0, lights - 1], label=r"intensity $|u|^2/\langle|u|^2\rangle$", extend="max")
    if tilted:
        last = axes[0, -1]
        found = correlations(result)
        tilts = result.values("tilt")
        for number, (of, label) in enumerate(zip(found, ("matched pixels", "same pixels"))):
            error = of.std(axis=0, ddof=1) / np.sqrt(len(of))
            last.errorbar(tilts, of.mean(axis=0), error, **style.symbols(number), markersize=3, label=label)
        last.set(xlabel="tilt [rad]", ylabel="correlation of intensity")
        last.legend(fontsize=6)
    return figure
