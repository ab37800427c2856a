#!/usr/bin/env python3
"""Power on the detector against a key, from a sweep of `render` or several results of `render`. The default key is
the first one that a sweep varies, or the amplitude of ultrasound. Each value of a second key has a curve. If the key
takes the value 0, powers are divided by the power there. Means over the period of the sound are drawn as separate
curves."""

from lib import labels, page, script, style
from lib.experiment import Number, keys_of

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import MaxNLocator

NAMES = {"amplitude": "amplitude of the index modulation", "mu_s": r"$\mu_s$", "mu_a": r"$\mu_a$"}
MOST_CURVES = len(style.COLOURS)


def values_of(result, key):
    """Returns the value of a key, or its values at the points of a sweep."""
    values = Number(result, "total").columns[key] if key in keys_of(result) else result.scene.get(key)
    if not np.issubdtype(np.asarray(values).dtype, np.number) or np.ndim(values) != (key in keys_of(result)):
        raise style.Unusable(f"{result.path}: its scene has no number {key}; "
                             "--key must name a key with a numerical value")
    return values


def drawn_keys(result, arguments):
    """Returns the key of the horizontal axis, and the key that distinguishes curves or None: as requested, or the
    second of two varying keys. Raises Unusable if points of one curve would differ in another key."""
    across = arguments.key or next(iter(keys_of(result)), "amplitude")
    others = [key for key in keys_of(result) if key != across]
    apart = arguments.curves or next(iter(others), None)
    if not arguments.curves and (len(others) > 1 or others and len(np.unique(values_of(result, apart))) > MOST_CURVES):
        raise style.Unusable(f"{result.path}: {', '.join(others)} also vary; --curves KEY draws a curve "
                             "for each value of a key with at most 8 values; "
                             "plots/experiment_map.py draws a map over two keys")
    hidden = [key for key in others if key != apart]
    if hidden:
        raise style.Unusable(f"{result.path}: varies {', '.join(hidden)} besides {across} and {apart}; "
                             "sweep over two keys at most")
    return across, apart


def rows_of(result, arguments):
    """Returns the second key, the key, power and error for each point; nan for values that do not exist."""
    power, error = (values.ravel() for values in result.measured("total"))
    across, apart = drawn_keys(result, arguments)
    second = values_of(result, apart) if apart else 0.0
    if not np.isfinite(power).any():
        raise style.Unusable(f"{result.path}: no point of the sweep is finished")
    return np.array(np.broadcast_arrays(second, values_of(result, across), power, error)).T


def curves(results, arguments):
    """Returns {(value of the second key, whether the phase of the sound is random): rows of key, power, error, sorted
    by the key}."""
    found = {}
    for result in results:
        is_mean = result.scene.get("random_phase", False)
        for second, *row in rows_of(result, arguments):
            found.setdefault((second, is_mean), []).append(row)
    return {curve: np.array(sorted(rows)) for curve, rows in sorted(found.items())}


def label_of(curve, found, apart):
    """Returns a label that distinguishes a curve from the others."""
    second, is_mean = curve
    words = [f"{NAMES.get(apart, apart)} = {second:.4g}"] if apart else []
    if len({phase for _, phase in found}) > 1:
        words.append("mean over the sound's period" if is_mean else "at one instant")
    return ", ".join(words)


@script.plot(several=True, needs={"total": "needs a result of render"})
@script.option("--key", help="key of the horizontal axis")
@script.option("--curves", metavar="KEY", help="key that has a curve for each of its values")
def draw(results, arguments):
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.4))
    found, (key, apart) = curves(results, arguments), drawn_keys(results[0], arguments)
    relative = all(rows[0, 0] == 0 and rows[0, 1] > 0 for rows in found.values())
    for number, (curve, rows) in enumerate(found.items()):
        place, power, error = rows.T
        if relative:  # all points are divided by the first one and share its error
            spread = np.hypot(error / power, error[0] / power[0]) * (np.arange(len(power)) > 0)
            power, error = power / power[0], power / power[0] * spread
        axis.errorbar(place, power, error, **style.look(number), label=label_of(curve, found, apart))
    axis.set(xlabel=labels.with_unit(NAMES.get(key, key), results[0].unit(key) if results[0].has(key) else ""),
             ylabel="power / power at value 0" if relative else "power on the detector")
    if style.in_equal_ratios(np.unique(np.concatenate([rows[:, 0] for rows in found.values()]))):
        axis.set_xscale("log")
    else:
        axis.xaxis.set_major_locator(MaxNLocator(4))
        axis.ticklabel_format(axis="x", scilimits=(-2, 4), useMathText=True)
    if entries := page.labelled([axis]):
        page.legend_above(figure, entries, 2)
    return figure
