#!/usr/bin/env python3
"""Structure factor of random placements, from any number of `place --structure` results."""

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np


def label(result):
    word = str(result.attribute("placement"))
    packing = result.attribute("packing_fraction")
    return word if packing == 0 else rf"{word}, $\phi$ = {packing:.3g}"


@script.plot(several=True, needs={"structure_factor": "needs place --structure"})
def draw(results):
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.6))
    style.mark(axis, 1)
    with_theory = False
    for number, result in enumerate(results):
        # The unit of length is the mean spacing, which is also defined for points.
        area = result.attribute("width") * result.attribute("depth")
        q = result.axis("structure_factor", 0) * np.sqrt(area / result.attribute("count"))
        axis.errorbar(q, *result.measured("structure_factor"), **style.symbols(number),
                      markersize=2.2, label=label(result))
        if result.has("structure_factor_theory"):
            with_theory = True
            axis.plot(q, result.values("structure_factor_theory"), linewidth=0.7, zorder=1,
                      color=style.look(number)["color"])
    axis.set(xlim=(0, None), ylim=(0, None), xlabel=r"wavenumber $q\,\rho^{-1/2}$, number density $\rho$",
             ylabel="structure factor $S(q)$")
    axis.legend(title="lines: Baus and Colot 1987" if with_theory else None, title_fontsize=7)
    return figure
