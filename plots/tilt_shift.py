#!/usr/bin/env python3
"""Correlation over tilts of the illumination and shifts of the detection direction or sensor, from results of
`covariance` with covariance = "tilt_shift". Each result, for example transmission and reflection, has a map; the
panel below shows the correlation for matched shifts (tilt = shift) and along both axes of the map, with theory."""

from lib import page, script, style

import matplotlib.pyplot as plt
import numpy as np

NEEDS = 'needs covariance = "tilt_shift"'
THEORIES = {"diffusion_theory": ("diffusion", "-"), "single_scattering": ("single scattering", "--")}


def is_far(result):
    return result.has("matched_correlation")


def title(result):
    if not is_far(result):
        depths = np.unique(result.values("sensor_z"))
        return f"sensors at $z$ = {', '.join(style.short(depths))}"
    views = np.atleast_1d(result.values("view_angle"))
    sides = {"transmission" if np.cos(view) > 0 else "reflection" for view in views}
    return " and ".join(sorted(sides)) + ", detection at " + ", ".join(style.angle(view) for view in views)


def axes_of(result):
    """Returns tilts as q L, and shifts times L, or as lengths for near sensors."""
    depth = result.attribute("depth")
    tilts = result.values("tilt_q") * depth
    shifts = result.axis("field_correlation", 1) * (depth if is_far(result) else 1)
    if min(len(tilts), len(shifts)) < 2:
        raise style.Unusable(f"{result.path}: a map needs at least two tilts and two shifts")
    return tilts, shifts


def draw_map(axis, result):
    tilts, shifts = axes_of(result)
    across, up = np.argsort(tilts), np.argsort(shifts)
    image = axis.pcolormesh(tilts[across], shifts[up],
                            result.values("field_correlation")[np.ix_(across, up)].T,
                            shading="nearest", cmap="viridis", vmin=0, vmax=1, rasterized=True)
    if is_far(result):
        ends = [max(tilts.min(), shifts.min()), min(tilts.max(), shifts.max())]
        axis.plot(ends, ends, color="white", linewidth=0.7, linestyle=(0, (4, 3)))
    axis.set(title=title(result), xlabel="tilt $qL$",
             ylabel=(r"shift of the direction, $\Delta(k\,\sin v)\,L$" if is_far(result)
                     else "shift of the sensor along $x$"))
    return image


def draw_lines(axis, result):
    """Draws the correlation for matched detection directions with theory, and along both axes of the map."""
    (tilts, shifts), (field, error) = axes_of(result), result.measured("field_correlation")
    no_tilt, no_shift = np.argmin(np.abs(tilts)), np.argmin(np.abs(shifts))
    curves = [("tilt only", tilts, field[:, no_shift], error[:, no_shift])]
    if is_far(result):
        curves = [("matched directions", tilts, *result.measured("matched_correlation")), *curves,
                  ("shift only", shifts, field[no_tilt], error[no_tilt])]
    for number, (label, *curve) in enumerate(curves):
        fill = {"markerfacecolor": "white"} if number else {}
        axis.errorbar(*curve, label=label, **style.symbols(number), **fill)
    order = np.argsort(tilts)
    for name, (label, line) in THEORIES.items():
        if result.has(name):
            axis.plot(tilts[order], result.values(name)[order], color=style.GREY, linestyle=line,
                      linewidth=0.9, label=label, zorder=1)
    axis.set(ylim=(-0.03, 1.08), xlabel="$qL$", ylabel="field correlation $C_E$")


@script.plot(several=True, needs={"tilt_q": NEEDS, "field_correlation": NEEDS})
def draw(results):
    for result in results:
        if result.dataset("field_correlation").ndim != 2:
            raise style.Unusable(f"{result.path}: field_correlation is not a map; {NEEDS}")
    columns = len(results)
    width = min(style.PAGE, style.COLUMN * columns)
    figure, axes = plt.subplots(2, columns, squeeze=False, figsize=(width, 1.55 * width / columns),
                                height_ratios=(1.15, 1))
    for result, upper, lower in zip(results, *axes):
        image = draw_map(upper, result)
        draw_lines(lower, result)
    figure.colorbar(image, ax=list(axes[0]), label="field correlation $C_E$")
    page.legend_above(figure, page.labelled(axes[1]), 3 if columns == 1 else 5)
    return figure
