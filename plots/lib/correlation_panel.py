"""Panels with C_I = C_E^2 against tilt, shared by all plots of memory-effect curves."""

from lib import style

import numpy as np

FEW_DECADES = 50  # ratio of highest to lowest value below which a logarithmic axis needs extra labels
BELIEVED = 3  # standard errors; a smaller C_E is biased upward by noise, because it is a magnitude


def prepare(axis, tilt, lowest, arguments):
    """Sets scales and limits for tilts in mrad and for C_I; a logarithmic axis extends down to `lowest`."""
    style.mark(axis, 0.5)
    axis.set(xlabel="tilt (mrad)", ylabel=r"intensity correlation $C_I$")
    if arguments.log:
        if not (tilt > 0).any():
            raise style.Unusable("--log requires a tilt above 0")
        low, high = tilt[tilt > 0].min() / 1.2, tilt.max() * 1.2
        axis.set(xscale="log", xlim=(low, high))
        if high < FEW_DECADES * low:
            style.few_decades(axis.xaxis)
    else:
        margin = 0.05 * max(np.ptp(tilt), 1e-3)
        axis.set_xlim(tilt.min() - margin, tilt.max() + margin)
    if arguments.log_correlation:
        axis.set(yscale="log", ylim=(lowest / 2, 1.6))
        if 1.6 < FEW_DECADES * lowest / 2:
            style.few_decades(axis.yaxis)
    else:
        axis.set_ylim(-0.03, 1.08)


def believed(field, error):
    """Returns where a magnitude exceeds its noise."""
    return np.abs(field) > BELIEVED * error


def lowest(fields, errors):
    """Returns the smallest C_I that a logarithmic axis shows."""
    return min(np.min(field[believed(field, error)]**2, initial=1)
               for field, error in zip(fields, errors))


def apart(axis, x, y, size):
    """Returns points of a curve, the last first, chosen so that symbols of this size do not overlap."""
    places = axis.transData.transform(np.column_stack([x, y])) * 72 / axis.figure.dpi
    kept = []
    for number in reversed(range(len(x))):
        if not kept or np.hypot(*(places[number] - places[kept[-1]])) >= size:
            kept.append(number)
    return kept


class Unseen:
    """Records what is not visible in the panels: symbols omitted for lack of room, and error bars smaller than the
    symbols."""

    def __init__(self):
        self.symbols, self.bars = 0, True

    def notes(self, arguments):
        if self.symbols:
            yield "symbols that would overlap are omitted"
        if self.bars:
            yield "error bars are smaller than the symbols"
        if arguments.log_correlation:
            yield f"points with $C_E$ below {BELIEVED} standard errors are omitted"


def draw_curve(axis, tilt, field, error, look, unseen):
    """Draws C_I = C_E^2 with error bars, and records in `unseen` what is not visible."""
    order = np.argsort(tilt)
    tilt, field, error = (values[order] for values in (tilt, field, error))
    in_scale = ((tilt > 0) | (axis.get_xscale() != "log")) & \
        (believed(field, error) | (axis.get_yscale() != "log"))
    shown = np.flatnonzero(in_scale)
    kept = shown[apart(axis, tilt[shown], field[shown]**2, look["markersize"])]
    correlation, spread = field[kept]**2, 2 * np.abs(field[kept]) * error[kept]
    axis.errorbar(tilt[kept], correlation, spread, linestyle="none", elinewidth=0.7, **look)
    unseen.symbols += len(shown) - len(kept)
    low, high = (axis.transData.transform(np.column_stack([0 * spread + 1, end]))[:, 1]
                 for end in (correlation - spread, correlation + spread))
    unseen.bars &= not np.any((high - low) * 72 / axis.figure.dpi > look["markersize"])


def add_q_axis(axis, result, tilt):
    """Adds a top axis with q L above an axis with tilts in mrad; q is only nearly proportional to the tilt."""
    depth = result.attribute("depth")
    if depth is None or not result.has("tilt_q"):
        return
    order = np.argsort(tilt)
    x, q_depth = tilt[order], result.values("tilt_q")[order] * depth
    if len(x) < 2 or np.any(np.diff(q_depth) <= 0):
        return
    margin = x[-1] - x[0]  # extrapolated linearly on each side
    slopes = np.diff(q_depth)[[0, -1]] / np.diff(x)[[0, -1]]
    q_depth = np.concatenate([[q_depth[0] - margin * slopes[0]], q_depth,
                              [q_depth[-1] + margin * slopes[1]]])
    x = np.concatenate([[x[0] - margin], x, [x[-1] + margin]])
    top = axis.secondary_xaxis("top", functions=(lambda t: np.interp(t, x, q_depth),
                                                 lambda q: np.interp(q, q_depth, x)))
    top.set_xlabel(r"$qL$")
    if axis.get_xscale() == "log" and np.divide(*reversed(axis.get_xlim())) < FEW_DECADES:
        style.few_decades(top.xaxis)
    axis.tick_params(which="both", top=False)
