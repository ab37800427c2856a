#!/usr/bin/env python3
"""Structure factor of drawn placements, from any number of `place --structure` results."""

from lib import style

import matplotlib.pyplot as plt
import numpy as np


def in_spacings(result, q):
    """q times the mean spacing, which points have too."""
    area = result.attribute("width") * result.attribute("depth")
    return q * np.sqrt(area / result.attribute("count"))


def label(result):
    word = str(result.attribute("placement"))
    packing = result.attribute("packing_fraction")
    return word if packing == 0 else rf"{word}, $\phi$ = {packing:.3g}"


def draw(results):
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.6))
    axis.axhline(1, color=style.GREY, linewidth=0.6, linestyle=(0, (1, 2)), zorder=0)
    with_theory = False
    for number, result in enumerate(results):
        look = style.look(number)
        q = in_spacings(result, result.axis("structure_factor", 0))
        axis.errorbar(q, result.values("structure_factor"),
                      result.values("structure_factor_error"), linestyle="none", elinewidth=0.7,
                      color=look["color"], marker=look["marker"], markersize=2.2,
                      label=label(result))
        if result.has("structure_factor_theory"):
            with_theory = True
            axis.plot(q, result.values("structure_factor_theory"), color=look["color"],
                      linewidth=0.7, zorder=1)
    axis.set_xlim(left=0)
    axis.set_ylim(bottom=0)
    axis.set_xlabel(r"$q\,\rho^{-1/2}$")
    axis.set_ylabel("structure factor $S(q)$")
    axis.legend(title="lines: Baus and Colot 1987" if with_theory else None, title_fontsize=7)
    return figure


if __name__ == "__main__":
    style.main(draw, __doc__, several=True)
