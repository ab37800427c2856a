#!/usr/bin/env python3
"""Memory effect: intensity correlation against tilt, from a sweep or a memory_effect covariance."""

import matplotlib.pyplot as plt
import numpy as np

import style


def read_curves(result):
    """Field correlation, error and diffusion theory (or None): [optical_depth, g, albedo, tilt]."""
    names = ["field_correlation", "field_correlation_error"]
    if result.has("diffusion_theory"):
        names.append("diffusion_theory")
    curves = [np.real(result.values(name)) for name in names]
    curves += [None] * (3 - len(curves))
    if curves[0].ndim == 4:
        return curves
    if curves[0].ndim == 1:
        return [c if c is None else c[None, None, None, :] for c in curves]
    raise style.Unusable(f"{result.path}: field_correlation has neither 1 nor 4 axes")


def parameters(result):
    """Optical depths, g and albedos of the curves; [None] where a single scene does not say."""
    if result.dataset("field_correlation").ndim == 4:
        return [result.axis("field_correlation", axis) for axis in range(3)]
    return [[result.attribute(name)] for name in ("optical_depth", "g", "albedo")]


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


def title(depth, anisotropy):
    named = (("OD", depth), ("$g$", anisotropy))
    return "\n".join(f"{name} = {value:g}" for name, value in named if value is not None)


def marker(number):
    """Colour and symbol of one albedo; every other one is open, for prints without colour."""
    look = style.look(number)
    return {"color": look["color"], "marker": look["marker"],
            "markerfacecolor": "white" if number % 2 else look["color"]}


def draw_panel(axis, tilt, correlation, error, theory):
    order = np.argsort(tilt)
    axis.axhline(0.5, color=style.GREY, linewidth=0.6, linestyle=(0, (1, 2)), zorder=0)
    for number, field in enumerate(correlation):
        axis.errorbar(tilt, field**2, 2 * np.abs(field) * error[number], linestyle="none",
                      elinewidth=0.7, **marker(number))
        if theory is not None:
            look = style.look(number)
            axis.plot(tilt[order], theory[number][order]**2, color=look["color"], linewidth=0.7,
                      linestyle=look["linestyle"], zorder=1)
    axis.set_ylim(-0.03, 1.08)


def write_title(axis, text, correlation):
    """In the corner that the curves leave free."""
    falls = np.all(correlation[:, -1]**2 < 0.6)
    place = (0.95, 0.95, "right", "top") if falls else (0.06, 0.05, "left", "bottom")
    axis.text(*place[:2], text, ha=place[2], va=place[3], transform=axis.transAxes)


def add_legend(figure, albedos, has_theory):
    handles = [plt.Line2D([], [], linewidth=0.7, **marker(number),
                          linestyle=style.look(number)["linestyle"] if has_theory else "none")
               for number in range(len(albedos))]
    labels = ["simulation" if albedo is None else f"albedo {albedo:g}" for albedo in albedos]
    if has_theory:
        handles.append(plt.Line2D([], [], linestyle="none"))
        labels.append("(lines: diffusion theory)")
    figure.legend(handles, labels, loc="lower center", bbox_to_anchor=(0.5, 1.0),
                  ncol=len(labels) if figure.get_figwidth() > style.COLUMN else 2)


def draw(results):
    result = results[0]
    correlation, error, theory = read_curves(result)
    depths, anisotropies, albedos = parameters(result)
    tilt = 1000 * result.axis("field_correlation", result.dataset("field_correlation").ndim - 1)
    rows, columns = len(depths), len(anisotropies)
    single = rows == columns == 1
    width = style.COLUMN if single else min(style.PAGE, max(style.COLUMN, 2.4 * columns))
    height = min(2.1, 1.3 * width / columns)
    figure, axes = plt.subplots(rows, columns, squeeze=False, sharex=True, sharey=True,
                                figsize=(width, 0.5 + height * rows))
    for i, j in np.ndindex(rows, columns):
        draw_panel(axes[i, j], tilt, correlation[i, j], error[i, j],
                   None if theory is None else theory[i, j])
        write_title(axes[i, j], title(depths[i], anisotropies[j]), correlation[i, j])
    for axis in axes[0]:
        add_q_axis(axis, result, tilt)
    for axis in axes[-1]:
        axis.set_xlabel("tilt (mrad)")
    for axis in axes[:, 0]:
        axis.set_ylabel(r"intensity correlation $C_I$")
    add_legend(figure, albedos, theory is not None)
    return figure


if __name__ == "__main__":
    style.main(draw, __doc__)
