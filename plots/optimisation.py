#!/usr/bin/env python3
"""How a search of `optimise` went: what was found, evaluation by evaluation, and where. Filled: by the random numbers of the search;
open: by others. The star is the best place, with its value by random numbers of its own."""

from lib import script, style
from lib.labels import with_unit

import matplotlib.pyplot as plt
import numpy as np

DRAWS = ("search", "choice", "value")


def keys_of(result):
    if "search" not in result.file:
        raise style.Unusable(f"{result.path}: no result of optimise")
    return list(result.file["search"].attrs["swept"])


def numbers_of(result, key):
    values = result.values(f"search/{key}")
    return values if np.issubdtype(values.dtype, np.number) else None


def is_log(result, key):
    """Whether it was searched in ratios."""
    return any(text.replace(".", "_").startswith(f"{key}=") and text.endswith(":log")
               for text in result.scene.get("vary", []))


def draw_values(axis, place, result):
    (value, error), draw = result.measured("search/value"), result.values("search/draw")
    for number, word in enumerate(DRAWS):
        of = draw == number
        if of.any():
            axis.errorbar(place[of], value[of], error[of], **{**style.look(number), "linestyle": "none"},
                          fillstyle="full" if number == 0 else "none", label=word)
    axis.set_ylabel(with_unit(result.attribute("objective"), result.attribute("objective_unit")))


def draw_progress(axis, result):
    draw_values(axis, np.arange(len(result.values("search/value"))), result)
    axis.set_xlabel("evaluation")
    axis.legend(title="random numbers of")


def draw_key(axis, result, key):
    place = numbers_of(result, key)
    draw_values(axis, place, result)
    axis.plot(result.values(f"best/{key}"), result.values("best/value"), "*", color="black", markersize=9, zorder=5)
    axis.set_xlabel(with_unit(key, result.unit(f"search/{key}")))
    if is_log(result, key):
        axis.set_xscale("log")


@script.plot()
def draw(result):
    keys = [key for key in keys_of(result) if numbers_of(result, key) is not None]
    figure, axes = plt.subplots(1, 1 + len(keys), figsize=(style.COLUMN * min(1 + len(keys), 4) * 0.85, 2.5), squeeze=False)
    draw_progress(axes[0, 0], result)
    for axis, key in zip(axes[0, 1:], keys):
        draw_key(axis, result, key)
    lead, doubt = result.values("best/lead"), result.values("best/lead_error")
    apart = "" if abs(lead) >= 2 * doubt else " (not told apart)"
    style.caption(figure, [f"best {result.values('best/value'):.4g} +- {result.values('best/value_error'):.2g}, better than the "
                           f"runner-up with a confidence of {result.values('best/confidence'):.3g}{apart}"])
    return figure
