#!/usr/bin/env python3
"""Progress of a search by `optimise`: value of the objective against the number of the evaluation, and against each
key that varies. Filled symbols use the random numbers of the search, open ones others. The star is the best point,
with a value from independent random numbers."""

from lib import script, style
from lib.labels import with_unit

import matplotlib.pyplot as plt
import numpy as np

DRAWS = ("search", "choice", "value")


def draw_values(axis, place, result):
    (value, error), draw = result.measured("search/value"), result.values("search/draw")
    for number, word in enumerate(DRAWS):
        of = draw == number
        if of.any():
            axis.errorbar(place[of], value[of], error[of], **{**style.look(number), "linestyle": "none"},
                          fillstyle="full" if number == 0 else "none", label=word)
    axis.set_ylabel(with_unit(result.attribute("objective"), result.attribute("objective_unit")))


def draw_key(axis, result, key):
    draw_values(axis, result.values(f"search/{key}"), result)
    axis.plot(result.values(f"best/{key}"), result.values("best/value"), "*", color="black", markersize=9, zorder=5)
    axis.set_xlabel(with_unit(key, result.unit(f"search/{key}")))
    if any(text.replace(".", "_").startswith(f"{key}=") and text.endswith(":log")
           for text in result.scene.get("vary", [])):
        axis.set_xscale("log")


@script.plot(needs={"search/value": "needs a result of optimise"})
def draw(result):
    keys = [key for key in result.file["search"].attrs["swept"]
            if np.issubdtype(result.dataset(f"search/{key}").dtype, np.number)]
    figure, axes = plt.subplots(1, 1 + len(keys), figsize=(style.COLUMN * min(1 + len(keys), 4) * 0.85, 2.5), squeeze=False)
    draw_values(axes[0, 0], np.arange(len(result.values("search/value"))), result)
    axes[0, 0].set_xlabel("number of the evaluation")
    axes[0, 0].legend(title="random numbers for")
    for axis, key in zip(axes[0, 1:], keys):
        draw_key(axis, result, key)
    (lead, doubt), (value, error) = (result.measured(f"best/{name}") for name in ("lead", "value"))
    apart = "" if abs(lead) >= 2 * doubt else " (the difference is not significant)"
    style.caption(figure, [f"best {value:.4g} +- {error:.2g}, better than the second-best point with a confidence of "
                           f"{result.values('best/confidence'):.3g}{apart}"])
    return figure
