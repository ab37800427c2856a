#!/usr/bin/env python3
"""Power on the detector of several results of `flatspeckle render` against a key of their scenes, by
default the amplitude of ultrasound: a curve for each value of another key, over the power where the
first is 0 if there is such a result."""

import tomllib

from lib import style
from lib.result_file import Unusable

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import MaxNLocator

NAMES = {"amplitude": "amplitude of the index", "mu_s": r"$\mu_s$", "mu_a": r"$\mu_a$"}


def key_of(result, key):
    value = tomllib.loads(result.attribute("config", "")).get(key)
    if isinstance(value, (int, float)):
        return float(value)
    raise Unusable(f"{result.path}: its scene has no number {key}")


def curves(results, arguments):
    """value of the second key -> rows of key, power, error, by the key."""
    found = {}
    for result in results:
        second = key_of(result, arguments.curves) if arguments.curves else None
        row = (key_of(result, arguments.key), float(result.values("total")),
               float(result.values("total_error")))
        found.setdefault(second, []).append(row)
    return {second: np.array(sorted(rows)) for second, rows in sorted(
        found.items(), key=lambda item: item[0] or 0)}


def over_the_first(power, error):
    """Ratios to the first point and their errors; that of the first is in all others."""
    ratio = power / power[0]
    return ratio, np.where(np.arange(len(power)) == 0, 0,
                           ratio * np.hypot(error / power, error[0] / power[0]))


def draw(results, arguments):
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.4))
    found = curves(results, arguments)
    relative = all(rows[0, 0] == 0 and rows[0, 1] > 0 for rows in found.values())
    for number, (second, rows) in enumerate(found.items()):
        key, power, error = rows.T
        if relative:
            power, error = over_the_first(power, error)
        name = NAMES.get(arguments.curves, arguments.curves)
        axis.errorbar(key, power, error, **style.look(number),
                      label=None if second is None else f"{name} = {second:g}")
    axis.set_xlabel(NAMES.get(arguments.key, arguments.key))
    axis.set_ylabel("power on the detector" + (" / that at amplitude 0" if relative else ""))
    axis.xaxis.set_major_locator(MaxNLocator(4))
    axis.ticklabel_format(axis="x", scilimits=(-2, 4), useMathText=True)
    if arguments.curves:
        axis.legend()
    return figure


def add_options(parser):
    parser.add_argument("--key", default="amplitude", help="of the horizontal axis")
    parser.add_argument("--curves", metavar="KEY", help="a curve for each of its values")


if __name__ == "__main__":
    style.main(draw, __doc__, several=True, add_options=add_options)
