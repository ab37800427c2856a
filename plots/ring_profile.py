#!/usr/bin/env python3
"""Ring profiles of `flatspeckle render`: irradiance against the distance from the centre of a disk (sensor radial),
power per solid angle against the polar angle (sensor polar), compared with a Lambertian surface of the same power,
and power within given radii. Several results or sensors share one figure. Open symbols: the value depends on few
paths, and the error bar is an upper bound."""

from lib import pictures, script, style

import matplotlib.pyplot as plt
import numpy as np

QUANTITIES = {"radius": "irradiance", "angle": "power per solid angle", "disk_radius": "power within the radius"}


def kinds(result):
    """Returns {horizontal axis: dataset to be drawn} for a sensor."""
    if result.has("power_within"):
        return {"disk_radius": "power_within"}
    return {axis: "image" for axis in ("radius", "angle") if result.has(axis)}


def draw_values(axis, result, over, name, number, label):
    at, (value, error), look = result.values(over), result.measured(name), style.look(number)
    lit = value > 0
    rare = result.values(f"{name}_rare") > 0 if result.has(f"{name}_rare") else np.zeros(len(value), bool)
    for those, face in ((lit & ~rare, look["color"]), (lit & rare, "white")):
        axis.errorbar(at[those], value[those], pictures.below(value, error)[those], fmt=look["marker"],
                      color=look["color"], markerfacecolor=face, label=label if face != "white" else None)


def draw_kind(axis, results, over):
    for number, (label, result) in enumerate(results):
        name = kinds(result)[over]
        draw_values(axis, result, over, name, number, label)
        if over == "angle":
            angles = np.linspace(0, min(result.values("angle")[-1], np.pi / 2), 200)
            axis.plot(angles, result.values("total") / np.pi * np.cos(angles), linestyle="--",
                      color=style.look(number)["color"], label="Lambertian" if number == 0 else None)
    first = results[0][1]
    units = pictures.unit_name(first, kinds(first)[over])
    unit = "rad" if over == "angle" else pictures.length_name(first)
    axis.set(xlabel=f"{over.replace('disk_', '')} ({unit})", ylabel=QUANTITIES[over] + (f" ({units})" if units else ""),
             yscale="linear" if over == "angle" else "log")
    if over == "angle" or any(label for label, _ in results):
        axis.legend()


@script.plot(several=True, one_run=True)
def draw(results):
    by_kind = {}
    for label, result in pictures.sensors(results):
        for over in kinds(result):
            by_kind.setdefault(over, []).append((label, result))
    if not by_kind:
        raise style.Unusable(f"{results[0].path}: has no rings; requires render with sensor radial or polar")
    figure, axes = plt.subplots(1, len(by_kind), squeeze=False,
                                figsize=(style.PAGE if len(by_kind) > 1 else style.COLUMN, 2.5))
    for axis, over in zip(axes[0], filter(by_kind.get, QUANTITIES)):
        draw_kind(axis, by_kind[over], over)
    return figure
