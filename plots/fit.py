#!/usr/bin/env python3
"""Result of `flatspeckle fit`: data and fitted curves, residuals in standard errors, and error ellipses (1 and 2
standard errors) for pairs of parameters. Values that belong to no curve, such as transmittances, are drawn over their
number; a value beside curves is printed."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np

NAMES = {"field_correlation": r"$C_E$", "intensity_correlation": r"$C_I$", "intensity": "intensity",
         "reflectance": "reflectance", "transmittance": "transmittance", "squared_contrast": "$K^2$",
         "field_covariance": r"$\langle u_i u_j^*\rangle$"}

MOST_PAIRS = 6  # those of the most correlated errors


ROW = "number of the value"  # label of the abscissa of values that belong to no curve


def abscissas(result, observable):
    """Returns the abscissa of every datum and its label: a tilt or angle, a time, a distance from a beam, the index of
    the value for covariances of fields, or the number of a value that belongs to no curve."""
    angle = result.values("datum_angle")
    time, distance = (result.values(name) if result.has(name) else 0 * angle for name in ("datum_time", "datum_distance"))
    curve = result.values("datum_curve")
    moves = np.isin(curve, curve[time > 0])  # curves over times may begin at 0
    numbers, lengths = np.unique(curve, return_counts=True)
    alone = np.isin(curve, numbers[lengths == 1])
    rows = alone & (alone.all() or alone.sum() > 2)
    kinds = [rows, observable == "field_covariance", moves, distance > 0]
    return (np.select(kinds, [np.cumsum(alone), np.arange(len(angle)), time, distance], angle),
            np.select(kinds, [ROW, "index of the value", "delay or exposure", "distance"], "tilt or angle (rad)"))


def name_of(result, observable, row):
    """Returns the name of the curve that contains this row."""
    distance = result.values("datum_distance")[row] if result.has("datum_distance") else 0
    if not distance:
        return NAMES[observable]
    return {"reflectance": "reflectance per area", "field_correlation": "$g_1$",
            "intensity_correlation": "$g_2 - 1$"}[observable] + (f" at {distance:g}" if observable != "reflectance" else "")


def draw_values(axis, pulls, result, at, rows, observable):
    """Draws values that belong to no curve, one colour for each observable, and the model as a bar beside each."""
    (value, error), model, pull = result.measured("measured"), result.values("model"), result.values("pull")
    for number, name in enumerate(dict.fromkeys(observable[rows])):
        some = rows[observable[rows] == name]
        symbols = {**style.look(number), "linestyle": "none"}
        axis.errorbar(at[some], value[some], error[some], **symbols, label=NAMES[name])
        axis.hlines(model[some], at[some] - 0.3, at[some] + 0.3, colors=symbols["color"], linewidth=0.8)
        pulls.plot(at[some], pull[some], **symbols)
    axis.legend(title="bars: model", fontsize=7, title_fontsize=7)
    pulls.locator_params(axis="x", integer=True)


def draw_data(columns, result, at, label):
    """columns: for each label of an abscissa, the axes of the data and of the residuals."""
    observable, curve = np.array(result.texts("datum_observable")), result.values("datum_curve")
    (value, error), pull, single = result.measured("measured"), result.values("pull"), []
    if ROW in columns:
        draw_values(*columns[ROW], result, at, np.flatnonzero(label == ROW), observable)
    for number in np.unique(curve[label != ROW]):
        rows = np.flatnonzero(curve == number)
        axis, pulls = columns[label[rows[0]]]
        symbols = {**style.look(int(number)), "linestyle": "none"}
        name = name_of(result, observable[rows[0]], rows[0])
        if len(rows) == 1:
            single.append((name, rows[0]))
            continue
        rows = rows[np.argsort(at[rows])]
        axis.errorbar(at[rows], value[rows], error[rows], **symbols, label=name)
        axis.plot(at[rows], result.values("model")[rows], **style.line(int(number)))
        pulls.plot(at[rows], pull[rows], **symbols)
    for place, (name, row) in enumerate(single):
        axis.text(0.97, 0.97 - 0.08 * place, f"{name} {value[row]:.3g}, residual {pull[row]:+.1f} errors",
                  transform=axis.transAxes, ha="right", va="top", fontsize=7)
    most = 1.2 * max(2, np.abs(pull).max())
    for name, (axis, pulls) in columns.items():
        axis.tick_params(labelbottom=False)
        axis.set_yscale("log" if name == "distance" else "linear")
        pulls.axhspan(-1, 1, color="0.9")
        pulls.set(xlabel=name, ylim=(-most, most), xscale="log" if name.startswith("delay") else "linear")
        if result.has("datum_distance") and axis.get_legend_handles_labels()[1]:
            axis.legend()


def draw_pair(axis, result, i, j, columns):
    names, estimate = result.texts("parameter_name"), result.values("estimate")
    values, vectors = np.linalg.eigh(result.values("parameter_covariance")[np.ix_([j, i], [j, i])])
    for size, line in ((1, "-"), (2, "--")):  # ellipses of 1 and 2 standard errors
        x, y = vectors @ (size * np.sqrt(np.maximum(values, 0))[:, None] * style.circle())
        axis.plot(estimate[j] + x, estimate[i] + y, line, color=style.COLOURS[0])
    axis.plot(estimate[j], estimate[i], "+", color="k")
    axis.set(xlabel=names[j], ylabel=names[i])
    axis.locator_params(axis="x", nbins=4 if columns == 1 else 2)
    axis.locator_params(axis="y", nbins=4)


@script.plot()
def draw(result):
    count = len(result.values("estimate"))
    pairs = [(i, j) for i in range(count) for j in range(i)]
    correlation = np.abs(result.values("parameter_correlation"))
    pairs = sorted(sorted(pairs, key=lambda pair: -correlation[pair])[:MOST_PAIRS])
    columns = max(1, -(-len(pairs) // 3))
    figure = plt.figure(figsize=(style.PAGE, 3.6))
    at, label = abscissas(result, np.array(result.texts("datum_observable")))
    names = list(dict.fromkeys(label))
    left, right = figure.subfigures(1, 2, width_ratios=[1.6 * len(names), columns])
    axes = left.subplots(2, len(names), sharex="col", sharey=False, height_ratios=[3, 1], squeeze=False)
    axes[0, 0].set_ylabel("measured value")
    axes[1, 0].set_ylabel("residual / error")
    draw_data({name: axes[:, i] for i, name in enumerate(names)}, result, at, label)
    if not pairs:
        (value,), (error,) = result.measured("estimate")
        right.text(0.5, 0.5, f"{result.texts('parameter_name')[0]}\n{value:.4g} ± {error:.2g}", ha="center")
        return figure
    axes = np.atleast_1d(right.subplots(min(3, len(pairs)), columns)).ravel()
    for axis, (i, j) in zip(axes, pairs):
        draw_pair(axis, result, i, j, columns)
    for axis in axes[len(pairs):]:
        axis.remove()
    return figure
