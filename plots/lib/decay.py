"""Draws the decay of the field correlation with a change of the medium or the light (delay, frequency shift): one curve
for the first light and the first view on each side of the medium. The change is scaled as in diffusion theory or, if
all results give it in a physical unit, drawn in that unit. Lines of diffusion theory are also drawn."""

from collections.abc import Callable
from dataclasses import dataclass

from lib import labels, style, theory

import matplotlib.pyplot as plt
import numpy as np

STEPS = 300  # points of a line
SQUARED = r"correlation of intensities $g_2 - 1$"


@dataclass(frozen=True)
class Decay:
    """Names of the datasets [change, light, view] of a kind of decay, and how they are drawn."""

    dataset: str
    option: str  # option of `covariance` that produces the dataset
    theory: Callable  # reflected -> name of the dataset of diffusion theory
    formula: Callable  # (change, reflected, **medium) -> correlation by theory
    unit: Callable  # result -> factor by which changes are multiplied for the formula
    scaled: Callable  # (result, changes, reflected) -> x of diffusion theory
    physical: Callable  # result -> factor that converts changes to the physical unit; None if it is not known
    physical_label: str
    x_label: Callable  # (dimension or None for different ones, whether any light is reflected) -> label
    y_label: str
    # result -> beta if beta times the square of the correlation is drawn in the physical unit; else None
    beta: Callable = lambda result: None


@dataclass(frozen=True)
class Curve:
    """Decay of the first light and the first view on one side of the medium, sorted by the change."""

    result: object
    reflected: bool
    change: np.ndarray
    value: np.ndarray
    error: np.ndarray
    theory: np.ndarray  # at the changes; None if the result does not contain it

    def diffusion(self, decay, change):
        return decay.formula(decay.unit(self.result) * change, self.reflected, **theory.medium(self.result))

    def line(self, decay):
        """Returns (changes, correlation) of diffusion theory, also between the changes of the result."""
        if not np.allclose(self.diffusion(decay, self.change), self.theory, rtol=1e-4):
            return self.change, self.theory
        reach = np.sqrt(np.abs(self.change[-1]))
        steps = np.append(np.linspace(0, reach, STEPS), np.geomspace(1e-4 * reach, reach, STEPS))
        fine = np.sort(steps)**2
        return fine, self.diffusion(decay, fine)


def first_views(result):
    """Returns {reflected: number of the first view on that side}."""
    if not result.has("view_angle"):
        return {False: 0}
    sides = np.cos(result.values("view_angle")) < 0
    return {bool(side): int(np.argmax(sides == side)) for side in np.unique(sides)}


def curves_of(result, decay):
    if not result.has(decay.dataset) or result.dataset(decay.dataset).ndim != 3:
        raise style.Unusable(f"{result.path}: has no {decay.dataset} over several changes; requires {decay.option}")
    change = result.axis(decay.dataset, 0)
    order = np.argsort(np.abs(change))
    for reflected, view in first_views(result).items():
        values, error = (values[order, 0, view] for values in result.measured(decay.dataset))
        name = decay.theory(reflected)
        known = result.values(name)[order] if result.has(name) else None
        yield Curve(result, reflected, change[order], np.abs(values), error, known)


def label(curve):
    text, albedo = labels.of_slab(curve.result), curve.result.attribute("albedo")
    if curve.reflected:
        text += ", reflected"
    return text if albedo == 1 else text + f", albedo {albedo:.3g}"


def draw(results, decay, closed_form=lambda curves: None):
    """Draws the decays of all results. closed_form: curves -> (function of the scaled change, its label), drawn in grey,
    or None."""
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.8))
    curves = [curve for result in results for curve in curves_of(result, decay)]
    physical = None not in [decay.physical(result) for result in results]
    squared = physical and None not in [decay.beta(result) for result in results]

    def shown_value(curve, value):
        return decay.beta(curve.result) * value**2 if squared else value

    def place(curve, change):
        if physical:
            return np.abs(change) * decay.physical(curve.result)
        return decay.scaled(curve.result, change, any(curve.reflected for curve in curves))

    lowest = 1
    for number, curve in enumerate(curves):
        shown = slice(int(physical and curve.change[0] == 0), None)  # 0 has no place on a logarithmic axis
        x = place(curve, curve.change)
        value = shown_value(curve, curve.value)
        error = curve.error * (2 * decay.beta(curve.result) * curve.value if squared else 1)
        lowest = min(lowest, value.min())
        axis.errorbar(x[shown], value[shown], error[shown], **style.symbols(number), markersize=3, label=label(curve))
        if curve.theory is not None:
            fine, line = curve.line(decay)
            axis.plot(place(curve, fine), shown_value(curve, line), **style.line(number), linewidth=0.7, zorder=1)
    grey = None if physical else closed_form(curves)
    if grey:
        x = np.linspace(1e-3, max(place(curve, curve.change)[-1] for curve in curves), STEPS)
        axis.plot(x, grey[0](x), color=style.GREY, linewidth=0.7, zorder=0, label=grey[1])
    spaces = {theory.dimension(result) for result in results}
    axis.set(yscale="log", ylabel=SQUARED if squared else decay.y_label)
    if physical:
        places = np.concatenate([place(curve, curve.change) for curve in curves])
        axis.set(xscale="log", xlim=(places[places > 0].min() / 1.3, places.max() * 1.3), xlabel=decay.physical_label)
        style.label_log_axis(axis.xaxis)
    else:
        axis.set(xlim=(0, None), xlabel=decay.x_label(spaces.pop() if len(spaces) == 1 else None,
                                                      any(curve.reflected for curve in curves)))
    axis.set_ylim(max(lowest / 2, 1e-6), 1.3)
    style.label_log_axis(axis.yaxis)
    with_theory = any(curve.theory is not None for curve in curves)
    axis.legend(title="lines: diffusion theory" if with_theory else None, title_fontsize=7)
    return figure
