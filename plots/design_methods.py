#!/usr/bin/env python3
"""Comparison of search methods of `flatspeckle design`, from one result for each method: RMS miss distance of the
rays against the number of traces of each ray, forward or backward. The legend gives the number of traces at which the
distance first falls below --level."""

import re

from lib import script, style

import matplotlib.pyplot as plt
import numpy as np


NAMES = {"gauss_newton": "Gauss-Newton", "lbfgs": "L-BFGS", "adam": "Adam"}


def label(result):
    """Returns the name of the method, with its rate for Adam."""
    keys = dict(re.findall(r"(\w+) = (\S+)", result.attribute("config")))
    word = keys.get("method", "gauss_newton").strip('"')
    return NAMES.get(word, word) + (f", rate {keys['rate']}" if word == "adam" else "")


@script.plot(several=True, needs={"history/rms": "needs a result of design"})
@script.option("--level", type=float, default=1e-3, metavar="RMS",
               help="RMS miss distance to be reached (default: 1e-3)")
def draw(results, arguments):
    figure, axis = plt.subplots(figsize=(0.7 * style.PAGE, 2.6))
    for number, result in enumerate(results):
        traces, rms = result.values("history/traces"), result.values("history/rms")
        first = np.flatnonzero(rms <= arguments.level)[:1]
        reached = f"{traces[first[0]]:.0f}" if len(first) else f"more than {traces[-1]:.0f}"
        axis.loglog(traces, rms, **style.line(number), label=f"{label(result)}: {reached}")
        axis.plot(traces[first], rms[first], **style.look(number))
    axis.axhline(arguments.level, color="black", linewidth=0.6, linestyle=":")
    axis.set(xlabel="number of traces of each ray", ylabel="RMS miss distance of rays")
    axis.legend(loc="upper left", bbox_to_anchor=(1.02, 1), title=f"traces to {arguments.level:g}", title_fontsize=7)
    return figure
