#!/usr/bin/env python3
"""Scattering matrix of a periodic cell (`flatspeckle solve --period`): power of each outgoing channel for light in each
channel, and the transmission eigenvalues, the most open eigenchannel first."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm

SIDES = ("front", "back")


@script.plot(dpi=150, one_run=True)
def draw(result):
    result.require("scattering_matrix", "solve with --period writes it")
    power = np.abs(result.values("scattering_matrix")) ** 2  # [light_side, light_sine, side, sine]
    count = power.shape[1]
    figure, (left, right) = plt.subplots(1, 2, figsize=(style.PAGE, 2.8), layout="constrained",
                                         gridspec_kw={"width_ratios": [1.1, 1]})
    scale = LogNorm(np.median(power) / 30, power.max())
    image = left.imshow(power.reshape(2 * count, 2 * count).T, origin="lower", cmap="inferno", norm=scale)
    figure.colorbar(image, ax=left, label="power $|S|^2$", extend="min")
    for line in (left.axhline, left.axvline):
        line(count - 0.5, color="white", linewidth=0.5)
    places = [count / 2 - 0.5, 1.5 * count - 0.5]
    left.set_xticks(places, [f"from the {side}" for side in SIDES])
    left.set_yticks(places, [f"to the {side}" for side in SIDES], rotation="vertical", va="center")
    left.tick_params(length=0)
    left.set(xlabel="light channel", ylabel="outgoing channel")
    eigenvalues = result.values("transmission_eigenvalue")
    right.plot(np.arange(count), eigenvalues, **{**style.look(0), "linestyle": "none"})
    right.set(xlabel="number of the eigenchannel", ylabel=r"transmission eigenvalue $\tau$", ylim=(0, 1.03),
              title=f"conductance {eigenvalues.sum():.4g} of {count}")
    return figure
