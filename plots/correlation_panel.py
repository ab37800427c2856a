"""A panel with C_I = C_E^2 against tilt: what all plots of memory-effect curves share."""

import style

import numpy as np


def prepare(axis):
    axis.axhline(0.5, color=style.GREY, linewidth=0.6, linestyle=(0, (1, 2)), zorder=0)
    axis.set_ylim(-0.03, 1.08)


def draw_curve(axis, tilt, field, error, look):
    """C_I = C_E^2 with its error bars."""
    return axis.errorbar(tilt, field**2, 2 * np.abs(field) * error, linestyle="none",
                         elinewidth=0.7, **look)


def add_q_axis(axis, result, tilt):
    """Top axis q L over tilts in mrad; q is nearly but not quite proportional to the tilt."""
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


def write_title(axis, text, curves):
    """In the corner that the curves leave free."""
    falls = all(curve[-1]**2 < 0.6 for curve in curves)
    place = (0.95, 0.95, "right", "top") if falls else (0.06, 0.05, "left", "bottom")
    axis.text(*place[:2], text, ha=place[2], va=place[3], transform=axis.transAxes)
