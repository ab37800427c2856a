#!/usr/bin/env python3
"""Diffusing-wave spectroscopy: field correlation against delay in transmission through slabs, from
any number of `covariance --delays` results."""

from lib import style

import matplotlib.pyplot as plt
import numpy as np


def scaled_delay(result, delay):
    """Q L of diffusion theory without absorption: Q l* = 2 sqrt(t) in flatland."""
    transport = result.attribute("transport_mean_free_path")
    return 2 * np.sqrt(delay) * result.attribute("depth") / transport


def label(result):
    values = {name: result.attribute(name) for name in ("optical_depth", "g", "albedo")}
    text = rf"OD {values['optical_depth']:.3g}, $g$ = {values['g']:.3g}"
    return text if values["albedo"] == 1 else text + f", albedo {values['albedo']:.3g}"


def read(result):
    """Delay, correlation and error [delay], of the first light and view."""
    name = "field_correlation"
    if result.dataset(name).ndim != 3:
        raise style.Unusable(f"{result.path}: {name} is not one over delays; needs --delays")
    delay, values, error = (result.axis(name, 0), result.values(name)[:, 0, 0],
                            result.values(f"{name}_error")[:, 0, 0])
    order = np.argsort(delay)
    return delay[order], values[order], error[order], order


def draw(results):
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.8))
    longest, with_theory = 0, False
    for number, result in enumerate(results):
        look = style.look(number)
        delay, values, error, order = read(result)
        x = scaled_delay(result, delay)
        longest = max(longest, x[-1])
        axis.errorbar(x, values, error, linestyle="none", elinewidth=0.7, color=look["color"],
                      marker=look["marker"], markersize=3, label=label(result))
        if result.has("diffusion_theory"):
            with_theory = True
            axis.plot(x, result.values("diffusion_theory")[order], color=look["color"],
                      linewidth=0.7, linestyle=look["linestyle"], zorder=1)
    x = np.linspace(1e-3, longest, 200)
    axis.plot(x, x / np.sinh(x), color=style.GREY, linewidth=0.7, zorder=0,
              label=r"$x/\sinh x$")
    axis.set_yscale("log")
    axis.set_xlim(left=0)
    axis.set_xlabel(r"$x = 2\,k\sqrt{D\tau}\,L/\ell^*$")
    axis.set_ylabel(r"field correlation $g_1$")
    axis.legend(title="lines: diffusion theory" if with_theory else None, title_fontsize=7)
    return figure


if __name__ == "__main__":
    style.main(draw, __doc__, several=True)
