#!/usr/bin/env python3
"""Amplitude and phase of the total field on the map of `flatspeckle solve --map`, one row per illumination, or of a periodic
cell for one channel and for eigenchannels, with the outlines of disks, or of spheres cut by the plane of the map. Light at angle 0 travels to the
right. The highest 0.1 % of the amplitudes share one colour."""

from lib import script, style
from lib.pictures import edges

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import EllipseCollection
from matplotlib.ticker import MaxNLocator

MOST_LIGHTS = 4
DPI = 118  # pictures that fill the page make large files


def outlines(result, wavelength):
    """Returns the outlines of the scatterers in the plane of the map, to be drawn in each panel; points have none."""
    x, z, radius = (result.values(f"placement/{name}") / wavelength for name in ("x", "z", "radius"))
    off = 0 * radius  # distances of the centres from the plane
    if result.has("placement/y"):
        off = result.values("placement/y") / wavelength - result.scene.get("map_y", 0) / wavelength
    cut = radius > np.abs(off)
    size = 2 * np.sqrt(radius**2 - off**2, where=cut, out=0 * radius)[cut]
    return {"widths": size, "heights": size, "angles": 0 * size, "offsets": np.column_stack([z, x])[cut]}


def panel(figure, axis, values, extent, disks, label, bar="neither", **look):
    image = axis.imshow(values.T, origin="lower", extent=extent, interpolation="antialiased",
                        interpolation_stage="rgba", **look)
    axis.add_collection(EllipseCollection(units="xy", transOffset=axis.transData, **disks,
                                          facecolors="none", edgecolors="white", linewidths=0.5))
    axis.set_xlabel(r"$z/\lambda$")
    axis.tick_params(direction="out", top=False, right=False)
    return figure.colorbar(image, ax=axis, label=label, extend=bar, shrink=0.9, pad=0.015)


def draw_light(figure, axes, field, extent, disks):
    amplitude = np.abs(field)
    highest = np.quantile(amplitude, 0.999) or 1
    panel(figure, axes[0], amplitude, extent, disks, "amplitude $|u|$", bar="max", cmap="inferno", vmin=0,
          vmax=highest)
    bar = panel(figure, axes[1], np.angle(field), extent, disks, "phase of $u$ (rad)",
                cmap="twilight", vmin=-np.pi, vmax=np.pi)
    bar.set_ticks([-np.pi, 0, np.pi], labels=[r"$-\pi$", "0", r"$\pi$"])
    axes[0].set_ylabel(r"$x/\lambda$")
    for axis in axes:
        for side in (axis.xaxis, axis.yaxis):
            side.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))


def title(result, light):
    if result.has("map_wave"):
        eigenchannels = result.file["map_wave"].attrs.get("eigenchannels", light)
        name = "channel closest to normal incidence" if light == 0 else "eigenchannel" if light <= eigenchannels else "own light"
        return f"{name}, transmittance {result.values('map_transmittance')[light]:.2g}"
    return f"illumination at {style.angle(result.values('light_angle')[light])}"


@script.plot(dpi=DPI, one_run=True)
def draw(result):
    result.require("total_field", "solve with --map writes it")
    field = result.dataset("total_field")
    wavelength = field.attrs["wavelength"]
    x, z = (result.values(name) / wavelength for name in ("map_x", "map_z"))
    extent, lights = (*edges(z), *edges(x)), min(len(field), MOST_LIGHTS)
    height = (extent[3] - extent[2]) / (extent[1] - extent[0]) * 0.42 * style.PAGE
    figure, axes = plt.subplots(lights, 2, sharex=True, sharey=True, squeeze=False,
                                figsize=(style.PAGE, lights * np.clip(height, 0.8, 8)))
    disks = outlines(result, wavelength)
    for light in range(lights):
        draw_light(figure, axes[light], field[light], extent, disks)
        if lights > 1:
            axes[light, 0].set_title(title(result, light))
    if lights < len(field):
        axes[-1, 0].set_xlabel(f"{axes[-1, 0].get_xlabel()} ({lights} of {len(field)} lights)")
    return figure
