#!/usr/bin/env python3
"""Intensity against depth, averaged across the maps of `flatspeckle solve --period --map`, for light at normal incidence
and for transmission eigenchannels. For a sweep over placements (`sweep --of solve --vary seed=...`): mean values and their
standard errors."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np


MOST_LIGHTS = 6


@script.plot(dpi=150)
def draw(result):
    result.require("map_transmittance", "solve with --period and --map writes it")
    field, transmittance = result.dataset("total_field"), result.values("map_transmittance")
    lights, depths = field.shape[-3:-1]
    z = result.axis("total_field", field.ndim - 2) / field.attrs["wavelength"]
    profiles = np.mean(np.abs(field[...]) ** 2, axis=-1).reshape(-1, lights, depths)  # [placement, light, depth]
    transmittance = transmittance.reshape(-1, lights).mean(axis=0)
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.8), layout="constrained")
    for light in range(min(lights, MOST_LIGHTS)):
        eigenchannels = result.file["map_wave"].attrs.get("eigenchannels", light)
        name = "normal incidence" if light == 0 else "eigenchannel" if light <= eigenchannels else "own light"
        profile, look = profiles[:, light].mean(axis=0), style.line(light)
        axis.plot(z, profile, **look, label=fr"{name}, $\tau$ = {transmittance[light]:.2g}")
        if len(profiles) > 1:
            error = profiles[:, light].std(axis=0, ddof=1) / np.sqrt(len(profiles))
            axis.fill_between(z, profile - error, profile + error, color=look["color"], alpha=0.3, linewidth=0)
    axis.set(xlabel=r"depth $z/\lambda$", ylabel=r"intensity $\langle|u|^2\rangle$", ylim=(0, None))
    axis.legend(loc="lower center", bbox_to_anchor=(0.5, 1), ncol=2, columnspacing=1)
    if lights > MOST_LIGHTS:
        axis.text(0.98, 0.98, f"{MOST_LIGHTS} of {lights} lights", transform=axis.transAxes, ha="right", va="top")
    return figure
