#!/usr/bin/env python3
"""Result of `flatspeckle fit`: data and fitted curves, residuals in standard errors, and error ellipses (1 and 2
standard errors) for pairs of parameters."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np

NAMES = {"field_correlation": r"$C_E$", "intensity_correlation": r"$C_I$", "intensity": "intensity",
         "reflectance": "reflectance", "transmittance": "transmittance", "squared_contrast": "$K^2$",
         "field_covariance": r"$\langle u_i u_j^*\rangle$"}


def abscissa(result, observable):
    """Returns the abscissa of every datum and its label: a tilt or angle, a time, or, for covariances of fields, the
    index of the value."""
    angle, is_pair = result.values("datum_angle"), observable == "field_covariance"
    time = result.values("datum_time") if result.has("datum_time") else 0 * angle
    name = "delay or exposure" if result.has("datum_time") else "tilt or angle (rad)"
    return (np.select([is_pair, time > 0], [np.arange(len(angle)), time], angle),
            "index of the value" if is_pair.any() else name)


def draw_data(axis, pulls, result):
    observable = np.array(result.texts("datum_observable"))
    curve, (angle, name_of_angle) = result.values("datum_curve"), abscissa(result, observable)
    (value, error), pull, single = result.measured("measured"), result.values("pull"), []
    for number in np.unique(curve):
        rows = np.flatnonzero(curve == number)
        symbols = {**style.look(int(number)), "linestyle": "none"}
        name = observable[rows[0]]
        if len(rows) == 1:
            single.append((name, rows[0]))
            continue
        rows = rows[np.argsort(angle[rows])]
        axis.errorbar(angle[rows], value[rows], error[rows], **symbols, label=NAMES[name])
        axis.plot(angle[rows], result.values("model")[rows], **style.line(int(number)))
        pulls.plot(angle[rows], pull[rows], **symbols)
    for place, (name, row) in enumerate(single):
        axis.text(0.97, 0.97 - 0.08 * place, f"{NAMES[name]} {value[row]:.3g}, residual {pull[row]:+.1f} errors",
                  transform=axis.transAxes, ha="right", va="top", fontsize=7)
    axis.set_ylabel("measured value")
    axis.tick_params(labelbottom=False)
    pulls.axhspan(-1, 1, color="0.9")
    most = 1.2 * max(2, np.abs(pull).max())
    pulls.set(xlabel=name_of_angle, ylabel="residual / error", ylim=(-most, most),
              xscale="log" if result.has("datum_time") else "linear")


def draw_pair(axis, result, i, j):
    names, estimate = result.texts("parameter_name"), result.values("estimate")
    values, vectors = np.linalg.eigh(result.values("parameter_covariance")[np.ix_([j, i], [j, i])])
    for size, line in ((1, "-"), (2, "--")):  # ellipses of 1 and 2 standard errors
        x, y = vectors @ (size * np.sqrt(np.maximum(values, 0))[:, None] * style.circle())
        axis.plot(estimate[j] + x, estimate[i] + y, line, color=style.COLOURS[0])
    axis.plot(estimate[j], estimate[i], "+", color="k")
    axis.set(xlabel=names[j], ylabel=names[i])
    axis.locator_params(nbins=4)


@script.plot()
def draw(result):
    count = len(result.values("estimate"))
    pairs = [(i, j) for i in range(count) for j in range(i)]
    columns = max(1, -(-len(pairs) // 3))
    figure = plt.figure(figsize=(style.PAGE, 3.6))
    left, right = figure.subfigures(1, 2, width_ratios=[1.6, columns])
    data, pulls = left.subplots(2, 1, sharex=True, height_ratios=[3, 1])
    draw_data(data, pulls, result)
    if not pairs:
        (value,), (error,) = result.measured("estimate")
        right.text(0.5, 0.5, f"{result.texts('parameter_name')[0]}\n{value:.4g} ± {error:.2g}", ha="center")
        return figure
    axes = np.atleast_1d(right.subplots(min(3, len(pairs)), columns)).ravel()
    for axis, (i, j) in zip(axes, pairs):
        draw_pair(axis, result, i, j)
    for axis in axes[len(pairs):]:
        axis.remove()
    return figure
