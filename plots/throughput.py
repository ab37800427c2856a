#!/usr/bin/env python3
"""Power on the detector against a key, of a sweep of `render` by default the first that varies, of
several results of `render` the amplitude of ultrasound: a curve for each value of another key, over
the power where the first is 0 if that is among them. Means over the sound's period make curves of
their own."""

from lib import style
from lib.labels import scene_of, with_unit
from lib.result_file import Unusable

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import MaxNLocator

NAMES = {"amplitude": "amplitude of the index", "mu_s": r"$\mu_s$", "mu_a": r"$\mu_a$"}


def key_name(result, arguments):
    return arguments.key or next(iter(result.swept()), "amplitude")


def swept_values(result, key):
    """Of a key that varies, at each point of the sweep, in its axes' order."""
    axes = [scales[0].name.strip("/") for scales in result.dataset("total").dims]
    if key not in axes:  # a list of points
        return result.values(key)
    grid = np.meshgrid(*(result.values(name) for name in axes), indexing="ij")
    return grid[axes.index(key)].ravel()


def key_of(result, key):
    """Its value, or those at the points of a sweep."""
    value = scene_of(result).get(key)
    if key in result.swept():
        value = swept_values(result, key)
        if np.issubdtype(value.dtype, np.number):
            return value
    elif isinstance(value, (int, float)):
        return float(value)
    raise Unusable(f"{result.path}: its scene has no number {key}; --key takes one that has")


MOST_CURVES = len(style.COLOURS)


def second_key(result, arguments):
    """What sets curves apart: as asked for, or the second of two keys that vary."""
    if arguments.curves:
        return arguments.curves
    others = [key for key in result.swept() if key != key_name(result, arguments)]
    if not others:
        return None
    if len(others) > 1 or len(np.unique(key_of(result, others[0]))) > MOST_CURVES:
        raise Unusable(f"{result.path}: {', '.join(others)} vary too; --curves KEY draws a curve for each value of one key, "
                       "of at most 8; plots/experiment_map.py draws a map over two")
    return others[0]


def check_others(result, arguments):
    """Refuses to join points that differ in what is not drawn."""
    drawn = (key_name(result, arguments), second_key(result, arguments))
    hidden = [key for key in result.swept() if key not in drawn]
    if hidden:
        raise Unusable(f"{result.path}: varies {', '.join(hidden)} besides {' and '.join(filter(None, drawn))}; "
                       "sweep over two keys at most")


def rows_of(result, arguments):
    """Second key, key, power and error of each point; NaN where there is none."""
    power, error = result.values("total").ravel(), result.values("total_error").ravel()
    check_others(result, arguments)
    curves = second_key(result, arguments)
    second = key_of(result, curves) if curves else 0.0
    key = key_of(result, key_name(result, arguments))
    rows = np.array(np.broadcast_arrays(second, key, power, error)).T
    if not np.isfinite(rows[:, 2]).any():
        raise Unusable(f"{result.path}: no point is there yet")
    return rows


def curves(results, arguments):
    """(value of the second key, sound's phase is random) -> rows of key, power, error, by the key."""
    found = {}
    for result in results:
        is_mean = scene_of(result).get("random_phase", False)
        for second, *row in rows_of(result, arguments):
            found.setdefault((second, is_mean), []).append(row)
    return {curve: np.array(sorted(rows)) for curve, rows in sorted(found.items())}


def labels_of(found, curves_of):
    """What tells the curves apart."""
    labels = {curve: [] for curve in found}
    for (second, is_mean), label in labels.items():
        if curves_of:
            label.append(f"{NAMES.get(curves_of, curves_of)} = {second:.4g}")
        if len({phase for _, phase in found}) > 1:
            label.append("mean over the period" if is_mean else "at one instant")
    return {curve: ", ".join(label) for curve, label in labels.items()}


def over_the_first(power, error):
    """Ratios to the first point and their errors; that of the first is in all others."""
    ratio = power / power[0]
    return ratio, np.where(np.arange(len(power)) == 0, 0,
                           ratio * np.hypot(error / power, error[0] / power[0]))


def scale_key(axis, values):
    """A logarithm of what was swept in equal ratios."""
    if style.in_equal_ratios(values):
        axis.set_xscale("log")
    else:
        axis.xaxis.set_major_locator(MaxNLocator(4))
        axis.ticklabel_format(axis="x", scilimits=(-2, 4), useMathText=True)


def label_of_key(result, key):
    """With the unit that a sweep's file says."""
    unit = result.dataset(key).attrs.get("units") if result.has(key) else None
    return with_unit(NAMES.get(key, key), unit)


def draw(results, arguments):
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.4))
    found = curves(results, arguments)
    key = key_name(results[0], arguments)
    relative = all(rows[0, 0] == 0 and rows[0, 1] > 0 for rows in found.values())
    labels = labels_of(found, second_key(results[0], arguments))
    for number, (curve, rows) in enumerate(found.items()):
        place, power, error = rows.T
        if relative:
            power, error = over_the_first(power, error)
        axis.errorbar(place, power, error, **style.look(number), label=labels[curve])
    axis.set_xlabel(label_of_key(results[0], key))
    axis.set_ylabel("power / power at 0" if relative else "power on the detector")
    scale_key(axis, np.unique(np.concatenate([rows[:, 0] for rows in found.values()])))
    if any(labels.values()):
        figure.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=2)
    return figure


def add_options(parser):
    parser.add_argument("--key", help="of the horizontal axis")
    parser.add_argument("--curves", metavar="KEY", help="a curve for each of its values")


if __name__ == "__main__":
    style.main(draw, __doc__, several=True, add_options=add_options)
