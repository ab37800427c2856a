#!/usr/bin/env python3
"""Image from a reflection matrix: the far fields of `solve --wavelengths` are summed coherently over wavelengths and
angles, after removing from each the phase of the path through the image point. The smallest disks are circled."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np

STEP = 0.3  # pixel size, in units of the shortest wavelength
ROWS = 4000  # number of pixels computed at a time
FLOOR = -30  # dB


def phases(points, k, angles, index):
    """Returns exp(i k w.r), [point][angle], of plane waves incident from outside and refracted at z = 0."""
    across = k * np.sin(angles)
    deep = np.sign(np.cos(angles)) * np.sqrt((k * index)**2 - across**2)
    return np.exp(1j * (np.outer(points[:, 0], across) + np.outer(points[:, 1], deep)))


def image(result, points, index):
    """Returns |sum of A exp(-i (k_i - k_v).r)|^2 at the points r. The sum is over wavelengths, illuminations i and
    detection directions v."""
    field, wavelengths = result.values("far_field"), result.values("wavelength")
    lights, views = result.values("light_angle"), result.values("view_angle")
    total = np.zeros(len(points), complex)
    for matrix, wavelength in zip(field, wavelengths):
        k = 2 * np.pi / wavelength
        for first in range(0, len(points), ROWS):
            some = slice(first, first + ROWS)
            lit = phases(points[some], k, lights, index).conj()
            seen = phases(points[some], k, views, index)
            total[some] += np.einsum("pv,pv->p", lit @ matrix, seen) / np.sqrt(wavelength)
    return np.abs(total)**2


@script.plot()
@script.option("--index", type=float, default=1,
               help="mean index of the medium, relative to its surroundings (default: 1)")
def draw(result, arguments):
    if result.dataset("far_field").ndim != 3:
        raise style.Unusable(f"{result.path}: far_field is of a single wavelength; "
                             "requires a result of solve --wavelengths")
    x, z, radius = (result.values(f"placement/{name}") for name in ("x", "z", "radius"))
    step = STEP * result.values("wavelength").min()
    across = np.arange(x.min(), x.max() + step, step)
    deep = np.arange(z.min(), z.max() + step, step)
    grid = np.stack(np.meshgrid(across, deep), axis=-1).reshape(-1, 2)
    power = image(result, grid, arguments.index).reshape(len(deep), len(across))
    figure, axis = plt.subplots(figsize=(style.PAGE, 3.4))
    level = 10 * np.log10(np.maximum(power / power.max(), 1e-12))
    shown = axis.pcolormesh(across, deep, level, cmap="magma", vmin=FLOOR, vmax=0, rasterized=True)
    smallest = radius < 1.01 * radius.min()
    if not smallest.all():
        axis.scatter(x[smallest], z[smallest], s=28, facecolors="none", edgecolors="#56B4E9",
                     linewidths=0.5)
    axis.set(aspect="equal", xlabel="x", ylabel="z")
    axis.invert_yaxis()
    figure.colorbar(shown, label="intensity (dB)", shrink=0.8)
    return figure
