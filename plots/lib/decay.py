"""Decays of the field correlation of the first light and view over a change of the medium or of the
light (delays, frequencies), over the scale of diffusion theory, with its lines."""

from dataclasses import dataclass
from typing import Callable

from lib import style, theory

import matplotlib.pyplot as plt
import numpy as np

STEPS = 300  # of a line


@dataclass(frozen=True)
class Decay:
    """What stands where in a result [change, light, view], and what is drawn of it."""

    dataset: str
    option: str  # of covariance, which makes it
    theory: str  # dataset
    formula: Callable  # (depth, optical depth, g, albedo, result, changes) -> the theory
    scaled: Callable  # (result, changes) -> x
    x_labels: dict  # by dimension; None: of several
    y_label: str


def label(result):
    values = {name: result.attribute(name) for name in ("optical_depth", "g", "albedo")}
    text = rf"OD {values['optical_depth']:.3g}, $g$ = {values['g']:.3g}"
    if result.has("view_angle") and np.cos(result.values("view_angle")[0]) < 0:
        text += ", reflected"
    return text if values["albedo"] == 1 else text + f", albedo {values['albedo']:.3g}"


def read(result, decay):
    """Change, magnitude and error [change], of the first light and view, and their order."""
    if not result.has(decay.dataset) or result.dataset(decay.dataset).ndim != 3:
        raise style.Unusable(f"{result.path}: has no {decay.dataset} over changes; needs "
                             f"{decay.option}")
    change = result.axis(decay.dataset, 0)
    values, error = (result.values(decay.dataset + ending)[:, 0, 0] for ending in ("", "_error"))
    order = np.argsort(np.abs(change))
    return change[order], np.abs(values[order]), error[order], order


def diffusion_line(result, decay, change, stored):
    """(changes, correlation) of diffusion theory between the changes too."""
    medium = [result.attribute(name) for name in ("depth", "optical_depth", "g", "albedo")]
    if not np.allclose(decay.formula(*medium, result, change), stored, rtol=1e-4):
        return change, stored
    fine = np.linspace(0, np.sqrt(np.abs(change[-1])), STEPS)**2
    return fine, decay.formula(*medium, result, fine)


def draw(results, decay, closed_form=None):
    """closed_form: (function of x, its label), drawn in grey."""
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.8))
    longest, with_theory = 0, False
    for number, result in enumerate(results):
        look = style.look(number)
        change, values, error, order = read(result, decay)
        x = decay.scaled(result, change)
        longest = max(longest, x[-1])
        axis.errorbar(x, values, error, linestyle="none", elinewidth=0.7, color=look["color"],
                      marker=look["marker"], markersize=3, label=label(result))
        if result.has(decay.theory):
            with_theory = True
            fine, line = diffusion_line(result, decay, change, result.values(decay.theory)[order])
            axis.plot(decay.scaled(result, fine), line, color=look["color"], linewidth=0.7,
                      linestyle=look["linestyle"], zorder=1)
    if closed_form:
        x = np.linspace(1e-3, longest, STEPS)
        axis.plot(x, closed_form[0](x), color=style.GREY, linewidth=0.7, zorder=0,
                  label=closed_form[1])
    spaces = {theory.dimension(result) for result in results}
    axis.set_yscale("log")
    axis.set_xlim(left=0)
    axis.set_xlabel(decay.x_labels[spaces.pop() if len(spaces) == 1 else None])
    axis.set_ylabel(decay.y_label)
    axis.legend(title="lines: diffusion theory" if with_theory else None, title_fontsize=7)
    return figure
