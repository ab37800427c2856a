#!/usr/bin/env python3
"""Diffuse light at distances from a beam, from any number of results of `reflectance`: power per area against distance
and, if there are delays, the field correlation g1 against delay at each distance of the first result. With an instrument, the
error of the flow against the exposure at each distance."""

import pathlib

from lib import pictures, script, style

import matplotlib.pyplot as plt


def draw_distances(axis, results):
    for number, result in enumerate(results):
        value, error = result.measured("distance_reflectance")
        axis.errorbar(result.values("distance"), value, error, color=style.look(number)["color"],
                      marker=style.look(number)["marker"], label=pathlib.Path(result.path).stem if len(results) > 1 else None)
    unit = pictures.length_name(results[0])
    axis.set(yscale="log", xlabel=f"distance ({unit})", ylabel=f"diffuse reflectance (1/{unit}$^2$)")
    if len(results) > 1:
        axis.legend()


def draw_delays(axis, result):
    delay, correlation = result.values("delay"), result.values("distance_correlation")
    later = delay > 0
    for number, distance in enumerate(result.values("distance")):
        axis.plot(delay[later], correlation[later, number], label=f"{distance:g}", **style.line(number))
    axis.set(xscale="log", ylim=(0, 1.02), ylabel="field correlation $g_1$",
             xlabel=r"delay $\tau$ (s)" if result.unit("delay") == "s" else r"delay $k^2 D \tau$")
    axis.legend(title=f"distance ({pictures.length_name(result)})")


def draw_flow(axis, result):
    """Relative error of the flow in percent. From K^2 against exposure, in the colours of the distances, with dotted lines
    for g2; without exposures, from g2 against distance."""
    by_correlation = result.values("correlation_flow_ratio")
    known = by_correlation > 0
    if result.has("contrast_flow_ratio"):
        for number, by_exposure in enumerate(result.values("contrast_flow_ratio").T):
            look = style.look(number) | {"linestyle": "-"}
            some = by_exposure > 0
            axis.plot(result.values("exposure")[some], 100 / by_exposure[some], **look)
            if known[number]:
                axis.axhline(100 / by_correlation[number], color=look["color"], linewidth=0.8, linestyle=":")
        axis.plot([], [], color="0.3", label="from $K^2$")
        axis.plot([], [], color="0.3", linewidth=0.8, linestyle=":", label="from $g_2$")
        axis.legend()
        axis.set(xscale="log", xlabel="exposure (s)")
    else:
        axis.plot(result.values("distance")[known], 100 / by_correlation[known], marker="o")
        axis.set(xlabel=f"distance ({pictures.length_name(result)})")
    axis.set(yscale="log", ylabel="error of the flow (%)")
    if axis.get_ylim()[1] > 1e4:
        axis.set_ylim(top=1e4)


@script.plot(several=True, one_run=True, needs={"distance_reflectance": "requires a result of reflectance"})
def draw(results):
    delayed = results[0].has("distance_correlation")
    planned = results[0].has("correlation_flow_ratio")
    figure, axes = plt.subplots(1, 1 + delayed + planned, squeeze=False,
                                figsize=(style.PAGE if delayed else style.COLUMN, 2.5))
    draw_distances(axes[0][0], results)
    if delayed:
        draw_delays(axes[0][1], results[0])
    if planned:
        draw_flow(axes[0][2], results[0])
    return figure
