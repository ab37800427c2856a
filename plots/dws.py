#!/usr/bin/env python3
"""Diffusing-wave spectroscopy: field correlation against delay in transmission through slabs, from
any number of `covariance --delays` results."""

from lib import style, theory

import matplotlib.pyplot as plt
import numpy as np


STEPS = 300  # of a line
LABELS = {2: r"$x = 2\,k\sqrt{D\tau}\,L/\ell^*$", 3: r"$x = \sqrt{6}\,k\sqrt{D\tau}\,L/\ell^*$",
          None: r"$x = \sqrt{2d}\,k\sqrt{D\tau}\,L/\ell^*$"}  # by dimension d


def scaled_delay(result, delay):
    """Q L of diffusion theory without absorption: Q l* = sqrt(2 dimension t)."""
    transport = result.attribute("transport_mean_free_path")
    return np.sqrt(2 * theory.dimension(result) * delay) * result.attribute("depth") / transport


def diffusion_line(result, delay, stored):
    """(delays, g_1) of diffusion theory between the delays too."""
    medium = [result.attribute(name) for name in ("depth", "optical_depth", "g", "albedo")]
    space = theory.dimension(result)
    if not np.allclose(theory.delayed_diffusion(*medium, delay, space), stored, rtol=1e-4):
        return delay, stored
    fine = np.linspace(0, np.sqrt(delay[-1]), STEPS)**2
    return fine, theory.delayed_diffusion(*medium, fine, space)


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
            fine, line = diffusion_line(result, delay, result.values("diffusion_theory")[order])
            axis.plot(scaled_delay(result, fine), line, color=look["color"], linewidth=0.7,
                      linestyle=look["linestyle"], zorder=1)
    x = np.linspace(1e-3, longest, STEPS)
    axis.plot(x, x / np.sinh(x), color=style.GREY, linewidth=0.7, zorder=0,
              label=r"$x/\sinh x$")
    spaces = {theory.dimension(result) for result in results}
    axis.set_yscale("log")
    axis.set_xlim(left=0)
    axis.set_xlabel(LABELS[spaces.pop() if len(spaces) == 1 else None])
    axis.set_ylabel(r"field correlation $g_1$")
    axis.legend(title="lines: diffusion theory" if with_theory else None, title_fontsize=7)
    return figure


if __name__ == "__main__":
    style.main(draw, __doc__, several=True)
