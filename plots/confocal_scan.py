#!/usr/bin/env python3
"""Confocal scan (`flatspeckle field` with beams along a line and a lens that images the plane of their foci): intensity of the
image of the middle beam, and the intensity at each beam's own focus, mean over realizations."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np


@script.plot(dpi=150)
def draw(result):
    for name in ("field", "light_x", "image_x"):
        result.require(name, "run field with beams and camera_focus")
    intensity = np.abs(result.values("field"))**2
    light_x = result.values("light_x")
    light_y = result.values("light_y") if result.has("light_y") else np.zeros_like(light_x)
    x, y = result.values("image_x"), result.values("image_y")
    column = np.abs(x[:, None] - light_x).argmin(axis=0)
    row = np.abs(y[:, None] - light_y).argmin(axis=0)
    scan = intensity[:, np.arange(len(light_x)), row, column]
    figure, (left, right) = plt.subplots(1, 2, figsize=(style.PAGE, 2.6), layout="constrained")
    middle = len(light_x) // 2
    mesh = left.imshow(intensity[:, middle].mean(axis=0), cmap="inferno", origin="lower", extent=(x[0], x[-1], y[0], y[-1]))
    left.plot(light_x[middle], light_y[middle], "c+")
    left.set(xlabel="x", ylabel="y", title="mean image of one beam (+: its focus)")
    figure.colorbar(mesh, ax=left, label=r"$\langle|u|^2\rangle$")
    error = scan.std(axis=0, ddof=1) / np.sqrt(len(scan))
    right.errorbar(light_x, scan.mean(axis=0), error, **style.symbols(0), label=f"{len(scan)} realizations")
    right.set(xlabel="x of the focus", ylabel=r"$\langle|u|^2\rangle$ at the focus", ylim=(0, None))
    right.legend()
    return figure
