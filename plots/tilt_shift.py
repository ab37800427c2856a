#!/usr/bin/env python3
"""Correlation over tilts of the light and shifts of the view: a map for each result of `covariance`
with covariance = "tilt_shift", say transmission beside reflection, above its matched line and axes
with theory."""

from lib import style

import matplotlib.pyplot as plt
import numpy as np


def edges(centres):
    """Borders of the cells around the (sorted) centres."""
    if len(centres) < 2:
        raise style.Unusable("a map needs at least two tilts and two shifts")
    middle = (centres[1:] + centres[:-1]) / 2
    return np.concatenate([[2 * centres[0] - middle[0]], middle, [2 * centres[-1] - middle[-1]]])


def is_far(result):
    return result.has("matched_correlation")


def title(result):
    if not is_far(result):
        depths = np.unique(result.values("sensor_z"))
        return f"sensors at $z$ = {', '.join(style.short(depths))}"
    views = np.atleast_1d(result.values("view_angle"))
    sides = {"transmission" if np.cos(view) > 0 else "reflection" for view in views}
    return " and ".join(sorted(sides)) + ", view " + ", ".join(style.angle(view) for view in views)


class Map:
    """One result in the axes' units: q L of the tilt; shift x L, or lengths for near sensors."""

    def __init__(self, result):
        self.result = result
        depth = result.attribute("depth")
        self.q = result.values("tilt_q") * depth
        self.shift = result.axis("field_correlation", 1) * (depth if is_far(result) else 1)
        self.tilt_order, self.shift_order = np.argsort(self.q), np.argsort(self.shift)
        self.field = result.values("field_correlation")
        self.error = result.values("field_correlation_error")

    def draw(self, axis):
        rows = self.field[np.ix_(self.tilt_order, self.shift_order)]
        image = axis.pcolormesh(edges(self.q[self.tilt_order]),
                                edges(self.shift[self.shift_order]), rows.T, cmap="viridis",
                                vmin=0, vmax=1, rasterized=True)
        if is_far(self.result):
            low, high = max(self.q.min(), self.shift.min()), min(self.q.max(), self.shift.max())
            axis.plot([low, high], [low, high], color="white", linewidth=0.7,
                      linestyle=(0, (4, 3)))
        axis.set_title(title(self.result))
        axis.set_xlabel("tilt $qL$")
        axis.set_ylabel(r"shift $\Delta(k\,\sin v)\,L$" if is_far(self.result) else
                        "shift along $x$")
        return image

    def draw_lines(self, axis):
        """Matched views with theory, and both axes of the map."""
        no_tilt, no_shift = np.argmin(np.abs(self.q)), np.argmin(np.abs(self.shift))
        curves = []
        if is_far(self.result):
            curves.append(("matched views", self.q, self.result.values("matched_correlation"),
                           self.result.values("matched_correlation_error")))
        curves += [("tilt alone", self.q, self.field[:, no_shift], self.error[:, no_shift])]
        if is_far(self.result):
            curves += [("shift alone", self.shift, self.field[no_tilt], self.error[no_tilt])]
        for number, (label, x, field, error) in enumerate(curves):
            look = {**style.look(number), "linestyle": "none"}
            axis.errorbar(x, field, error, elinewidth=0.7, label=label,
                          markerfacecolor="white" if number else look["color"], **look)
        for name, label, line in (("diffusion_theory", "diffusion", "-"),
                                  ("single_scattering", "single scattering", "--")):
            if self.result.has(name):
                axis.plot(self.q[self.tilt_order], self.result.values(name)[self.tilt_order],
                          color=style.GREY, linestyle=line, linewidth=0.9, label=label, zorder=1)
        axis.set_ylim(-0.03, 1.08)
        axis.set_xlabel("$qL$")
        axis.set_ylabel("field correlation $C_E$")


def draw(results):
    for result in results:
        if not result.has("tilt_q") or not result.has("field_correlation") or \
                result.dataset("field_correlation").ndim != 2:
            raise style.Unusable(f'{result.path}: is no result of covariance = "tilt_shift"')
    maps = [Map(result) for result in results]
    columns = len(maps)
    width = min(style.PAGE, style.COLUMN * columns)
    figure, axes = plt.subplots(2, columns, squeeze=False, figsize=(width, 1.55 * width / columns),
                                height_ratios=(1.15, 1))
    for column, panel in enumerate(maps):
        image = panel.draw(axes[0, column])
        panel.draw_lines(axes[1, column])
    figure.colorbar(image, ax=list(axes[0]), label="$C_E$")
    handles = {}
    for axis in axes[1]:
        handles.update({label: handle for handle, label in zip(*axis.get_legend_handles_labels())})
    figure.legend(list(handles.values()), list(handles), loc="lower center",
                  bbox_to_anchor=(0.5, 1.0), ncol=3 if columns == 1 else 5)
    return figure


if __name__ == "__main__":
    style.main(draw, __doc__, several=True)
