"""Draws the decay of the field correlation of the first illumination and detection direction with a change of the
medium or the light (delay, frequency shift). The change is scaled as in diffusion theory, whose lines are also
drawn."""

from collections.abc import Callable
from dataclasses import dataclass

from lib import labels, style, theory

import matplotlib.pyplot as plt
import numpy as np

STEPS = 300  # points of a line


@dataclass(frozen=True)
class Decay:
    """Names of the datasets [change, light, view] of a kind of decay, and how they are drawn."""

    dataset: str
    option: str  # option of `covariance` that produces the dataset
    theory: str  # dataset of diffusion theory
    formula: Callable  # (change, **medium) -> correlation by theory
    unit: Callable  # result -> factor by which changes are multiplied for the formula
    scaled: Callable  # (result, changes) -> x
    x_labels: dict  # by dimension; None: for results of different dimensions
    y_label: str

    def diffusion(self, result, change):
        return self.formula(self.unit(result) * change, **theory.medium(result))

    def read(self, result):
        """Returns changes, magnitudes and errors, [change], for the first illumination and detection direction, and
        the order that sorts them."""
        if not result.has(self.dataset) or result.dataset(self.dataset).ndim != 3:
            raise style.Unusable(f"{result.path}: has no {self.dataset} over several changes; requires "
                                 f"{self.option}")
        change = result.axis(self.dataset, 0)
        values, error = (values[:, 0, 0] for values in result.measured(self.dataset))
        order = np.argsort(np.abs(change))
        return change[order], np.abs(values[order]), error[order], order

    def line(self, result, change, stored):
        """Returns (changes, correlation) of diffusion theory, also between the changes of the result."""
        if not np.allclose(self.diffusion(result, change), stored, rtol=1e-4):
            return change, stored
        fine = np.linspace(0, np.sqrt(np.abs(change[-1])), STEPS)**2
        return fine, self.diffusion(result, fine)


def label(result):
    text, albedo = labels.of_slab(result), result.attribute("albedo")
    if result.has("view_angle") and np.cos(result.values("view_angle")[0]) < 0:
        text += ", reflected"
    return text if albedo == 1 else text + f", albedo {albedo:.3g}"


def draw(results, decay, closed_form=None):
    """Draws the decays of all results. closed_form: (function of x, its label), drawn in grey."""
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.8))
    longest = 0
    for number, result in enumerate(results):
        change, values, error, order = decay.read(result)
        x = decay.scaled(result, change)
        longest = max(longest, x[-1])
        axis.errorbar(x, values, error, **style.symbols(number), markersize=3, label=label(result))
        if result.has(decay.theory):
            fine, line = decay.line(result, change, result.values(decay.theory)[order])
            axis.plot(decay.scaled(result, fine), line, **style.line(number), linewidth=0.7, zorder=1)
    if closed_form:
        x = np.linspace(1e-3, longest, STEPS)
        axis.plot(x, closed_form[0](x), color=style.GREY, linewidth=0.7, zorder=0,
                  label=closed_form[1])
    spaces = {theory.dimension(result) for result in results}
    axis.set(yscale="log", xlim=(0, None), ylabel=decay.y_label,
             xlabel=decay.x_labels[spaces.pop() if len(spaces) == 1 else None])
    with_theory = any(result.has(decay.theory) for result in results)
    axis.legend(title="lines: diffusion theory" if with_theory else None, title_fontsize=7)
    return figure
