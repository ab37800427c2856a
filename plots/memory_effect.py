#!/usr/bin/env python3
"""Memory effect: intensity correlation against tilt, from one sweep, or from any number of
memory_effect results of `covariance` and `validate`, compared in one panel."""

import pathlib
from dataclasses import dataclass

import style

import matplotlib.pyplot as plt
import numpy as np

METHODS = {"mc": "Monte Carlo", "wave": "wave solver"}


@dataclass
class Series:
    """One method's field correlation [tilt], of one result file."""

    label: str
    tilt: np.ndarray  # mrad
    correlation: np.ndarray
    error: np.ndarray
    look: dict


def read_curves(result):
    """Field correlation, error and diffusion theory (or None): [optical_depth, g, albedo, tilt]."""
    names = ["field_correlation", "field_correlation_error"]
    if result.has("diffusion_theory"):
        names.append("diffusion_theory")
    curves = [np.real(result.values(name)) for name in names]
    return curves + [None] * (3 - len(curves))


def is_sweep(result):
    return result.has("field_correlation") and result.dataset("field_correlation").ndim == 4


def read_groups(result):
    """(method, prefix of its datasets): both groups of a `validate` result, the root of others."""
    if result.has("mc/field_correlation"):
        return [(method, f"{method}/") for method in METHODS]
    if not result.has("field_correlation"):
        raise style.Unusable(f"{result.path}: has no field_correlation; needs a sweep, or "
                             'covariance = "memory_effect"')
    method = str(result.attribute("plan", "")).split(":")[0]
    if method not in METHODS:
        raise style.Unusable(f"{result.path}: attribute plan names neither method, mc nor wave")
    return [(method, "")]


def method_marker(method, number):
    """A colour and symbol per file; Monte Carlo large and open, so that the wave solver's shows."""
    look = style.look(number)
    is_mc = method == "mc"
    return {"color": look["color"], "marker": look["marker"], "markersize": 5.5 if is_mc else 2.5,
            "markerfacecolor": "none" if is_mc else look["color"]}


def read_series(results):
    series = []
    for number, result in enumerate(results):
        for method, prefix in read_groups(result):
            name = f"{prefix}field_correlation"
            if result.dataset(name).ndim != 1:
                raise style.Unusable(f"{result.path}: {name} is not a curve over tilts")
            series.append(Series(f"{pathlib.Path(result.path).stem}, {METHODS[method]}",
                                 1000 * result.axis(name, 0), np.real(result.values(name)),
                                 result.values(f"{name}_error"), method_marker(method, number)))
    return series


def shared(results, name):
    """An attribute that all files agree on, else None."""
    values = {result.attribute(name) for result in results}
    return values.pop() if len(values) == 1 else None


def share_q(results):
    """Whether a tilt is the same q L in all files."""
    if shared(results, "depth") is None or not all(result.has("tilt_q") for result in results):
        return False
    scales = [(result.axis("tilt_q", 0), result.values("tilt_q")) for result in results]
    return all(np.array_equal(scales[0], other) for other in scales)


def add_q_axis(axis, result, tilt):
    """Top axis q L; q is nearly but not quite proportional to the tilt."""
    depth = result.attribute("depth")
    if depth is None or not result.has("tilt_q"):
        return
    order = np.argsort(tilt)
    x, q_depth = tilt[order], result.values("tilt_q")[order] * depth
    if len(x) < 2 or np.any(np.diff(q_depth) <= 0):
        return
    margin = x[-1] - x[0]  # on each side, along the outermost slopes
    slopes = np.diff(q_depth)[[0, -1]] / np.diff(x)[[0, -1]]
    q_depth = np.concatenate([[q_depth[0] - margin * slopes[0]], q_depth,
                              [q_depth[-1] + margin * slopes[1]]])
    x = np.concatenate([[x[0] - margin], x, [x[-1] + margin]])
    top = axis.secondary_xaxis("top", functions=(lambda t: np.interp(t, x, q_depth),
                                                 lambda q: np.interp(q, q_depth, x)))
    top.set_xlabel(r"$qL$")
    axis.tick_params(top=False)


def title(**values):
    names = {"optical_depth": "OD", "g": "$g$", "albedo": "albedo"}
    return "\n".join(f"{names[key]} = {value:.3g}" for key, value in values.items()
                     if value is not None)


def marker(number):
    """Colour and symbol of one albedo; every other one is open, for prints without colour."""
    look = style.look(number)
    return {"color": look["color"], "marker": look["marker"],
            "markerfacecolor": "white" if number % 2 else look["color"]}


def draw_curve(axis, tilt, field, error, look):
    """C_I = C_E^2 with its error bars."""
    return axis.errorbar(tilt, field**2, 2 * np.abs(field) * error, linestyle="none",
                         elinewidth=0.7, **look)


def prepare(axis):
    axis.axhline(0.5, color=style.GREY, linewidth=0.6, linestyle=(0, (1, 2)), zorder=0)
    axis.set_ylim(-0.03, 1.08)


def draw_panel(axis, tilt, correlation, error, theory):
    order = np.argsort(tilt)
    prepare(axis)
    for number, field in enumerate(correlation):
        draw_curve(axis, tilt, field, error[number], marker(number))
        if theory is not None:
            look = style.look(number)
            axis.plot(tilt[order], theory[number][order]**2, color=look["color"], linewidth=0.7,
                      linestyle=look["linestyle"], zorder=1)


def write_title(axis, text, curves):
    """In the corner that the curves leave free."""
    falls = all(curve[-1]**2 < 0.6 for curve in curves)
    place = (0.95, 0.95, "right", "top") if falls else (0.06, 0.05, "left", "bottom")
    axis.text(*place[:2], text, ha=place[2], va=place[3], transform=axis.transAxes)


def add_legend(figure, albedos, has_theory):
    handles = [plt.Line2D([], [], linewidth=0.7, **marker(number),
                          linestyle=style.look(number)["linestyle"] if has_theory else "none")
               for number in range(len(albedos))]
    labels = [f"albedo {albedo}" for albedo in style.short(albedos)]
    if has_theory:
        handles.append(plt.Line2D([], [], linestyle="none"))
        labels.append("(lines: diffusion theory)")
    figure.legend(handles, labels, loc="lower center", bbox_to_anchor=(0.5, 1.0),
                  ncol=len(labels) if figure.get_figwidth() > style.COLUMN else 2)


def draw_series(results):
    series = read_series(results)
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.6))
    prepare(axis)
    handles = [draw_curve(axis, s.tilt, s.correlation, s.error, s.look) for s in series]
    text = title(**{name: shared(results, name) for name in ("optical_depth", "g", "albedo")})
    write_title(axis, text, [s.correlation for s in series])
    if share_q(results):
        add_q_axis(axis, results[0], series[0].tilt)
    axis.set_xlabel("tilt (mrad)")
    axis.set_ylabel(r"intensity correlation $C_I$")
    figure.legend(handles, [s.label for s in series], loc="lower center",
                  bbox_to_anchor=(0.5, 1.0), ncol=2)
    return figure


def draw_sweep(result):
    correlation, error, theory = read_curves(result)
    depths, anisotropies, albedos, tilt = (result.axis("field_correlation", axis)
                                           for axis in range(4))
    tilt = 1000 * tilt
    rows, columns = len(depths), len(anisotropies)
    single = rows == columns == 1
    width = style.COLUMN if single else min(style.PAGE, max(style.COLUMN, 2.4 * columns))
    height = min(2.1, 1.3 * width / columns)
    figure, axes = plt.subplots(rows, columns, squeeze=False, sharex=True, sharey=True,
                                figsize=(width, 0.5 + height * rows))
    for i, j in np.ndindex(rows, columns):
        draw_panel(axes[i, j], tilt, correlation[i, j], error[i, j],
                   None if theory is None else theory[i, j])
        text = title(optical_depth=depths[i], g=anisotropies[j])
        write_title(axes[i, j], text, correlation[i, j])
    for axis in axes[0]:
        add_q_axis(axis, result, tilt)
    for axis in axes[-1]:
        axis.set_xlabel("tilt (mrad)")
    for axis in axes[:, 0]:
        axis.set_ylabel(r"intensity correlation $C_I$")
    add_legend(figure, albedos, theory is not None)
    return figure


def draw(results):
    if not any(is_sweep(result) for result in results):
        return draw_series(results)
    if len(results) > 1:
        raise style.Unusable("a sweep is drawn alone: give one sweep, or several covariance or "
                             "validate results")
    return draw_sweep(results[0])


if __name__ == "__main__":
    style.main(draw, __doc__, several=True)
