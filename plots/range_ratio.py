#!/usr/bin/env python3
"""Ratio of the memory-effect ranges of two sweeps over optical depth and g, for example 3D over 2D. Draws FIRST /
SECOND against optical depth, with a curve for each g. Points that are bounds in either sweep are omitted."""

from lib import page, script, style, sweep_file

import matplotlib.pyplot as plt
import numpy as np

AXES = ("optical_depth", "g")
MOST_CURVES = 8


def name_of(sweep):
    return f"{sweep.result.attribute('dimension', 2)}D"


def ranges(sweep):
    """Returns {(optical depth, g): (range, error)} for those points of a sweep that are not bounds."""
    for name in AXES:
        sweep.column(name)
    sweep.refuse_others([name for name in sweep.varying() if name not in AXES], "optical_depth and g")
    value, error, censored = sweep.ranges(next(iter(sweep.prefixes)))
    keys = zip(*(np.round(sweep.columns[name], 9) for name in AXES))
    return {key: (value[row], error[row]) for row, key in enumerate(keys)
            if row in sweep.rows and censored[row] == 0}


def curves(first, second):
    """Returns [(g, optical depths, ratios, errors)] for the points that both sweeps contain."""
    common = sorted(set(first) & set(second))
    for g in sorted({g for _, g in common}):
        depths = np.array([depth for depth, of_g in common if of_g == g])
        a, b = (np.array([points[depth, g] for depth in depths]).T for points in (first, second))
        ratio = a[0] / b[0]
        yield g, depths, ratio, ratio * np.hypot(a[1] / a[0], b[1] / b[0])


@script.plot(several=True)
@sweep_file.SELECT
def draw(results, arguments):
    if len(results) != 2:
        raise style.Unusable("requires two results, FIRST.h5 SECOND.h5")
    sweeps = [sweep_file.read(result, arguments) for result in results]
    drawn = list(curves(*map(ranges, sweeps)))
    if not drawn:
        raise style.Unusable(f"{sweeps[0].path} and {sweeps[1].path} have no point in common")
    if len(drawn) > MOST_CURVES:
        sweeps[0].refuse(f"g has {len(drawn)} values, but at most {MOST_CURVES} curves are legible",
                         ("g", MOST_CURVES))
    figure, axis = plt.subplots(figsize=(style.COLUMN, 2.5))
    axis.axhline(1, color=style.GREY, linewidth=0.5)
    entries = []
    for number, (g, depths, ratio, error) in enumerate(drawn):
        look = style.look(number)
        axis.errorbar(depths, ratio, yerr=error, **look)
        entries.append((plt.Line2D([], [], **look), sweep_file.text("g", g)))
    axis.set_xscale("log")
    style.few_decades(axis.xaxis)
    axis.set(xlabel="optical depth",
             ylabel=f"ratio of ranges at $C_I = 1/2$: {' / '.join(map(name_of, sweeps))}")
    page.legend_outside(figure, entries, sweeps[0].notes())
    return figure
