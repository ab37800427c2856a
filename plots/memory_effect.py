#!/usr/bin/env python3
"""Memory effect: intensity correlation against tilt. Draws one sweep (if it contains two methods, with their
deviation in a panel below), or compares any number of results of `covariance`, `validate` and `sweep` in one
panel."""

from lib import correlation_panel, covariance_curves, curve_looks, page, script, style, sweep_file, theory
from lib.correlation_panel import BELIEVED

import matplotlib.pyplot as plt
import numpy as np

MOST_ROWS, MOST_COLUMNS, MOST_CURVES = 5, 4, 8
BENEATH = 0.35  # height of a panel of deviations relative to the panel above it
BAND = 4  # standard errors, the tolerance used everywhere
STEPS = 300  # points of a line


def arrange(sweep):
    """Returns the parameters shown by (rows, columns, curves); None for those not needed. Raises Unusable if a page
    cannot show all points legibly."""
    axes = sweep.varying()
    if sweep.is_list:
        axes = [None, None, "point"] if len(sweep.rows) <= MOST_CURVES else [None, "point", None]
    if len(axes) > 3:
        sweep.refuse(f"varies {', '.join(axes)}, but rows, columns and curves can show only three parameters",
                     (axes[0], 1))
    rows, columns, curves = axes = [None] * (3 - len(axes)) + axes
    limits = {rows: MOST_ROWS, columns: MOST_COLUMNS, curves: MOST_CURVES}
    if rows is None:
        limits[columns] = MOST_ROWS * MOST_COLUMNS
    counts = {name: len(sweep.values(name)) for name in limits if name}
    beyond = [name for name, count in counts.items() if count > limits[name]]
    if beyond:
        there = ", ".join(f"{count} points" if name == "point" else f"{count} values of {name}"
                          for name, count in counts.items())
        sweep.refuse(f"{there}; a page can show {MOST_ROWS} x {MOST_COLUMNS} panels of {MOST_CURVES} "
                     "curves", *((name, min(3, limits[name])) for name in beyond))
    return axes


def parts(sweep, name, rows):
    """Returns [({name: value}, its rows)] for all values of a parameter, including values without any of these
    rows."""
    if name is None:
        return [({}, rows)]
    column = sweep.columns[name][rows]
    return [({name: value}, rows[column == value]) for value in sweep.values(name)]


def panels(sweep, rows, columns):
    """Returns [row][column] of (the values common to a panel, the panel's points). If only one parameter
    distinguishes panels, they are wrapped into several rows."""
    table = [[({**fixed, **fixed_too}, part) for fixed_too, part in parts(sweep, columns, group)]
             for fixed, group in parts(sweep, rows, sweep.rows)]
    if rows is None and len(table[0]) > MOST_COLUMNS:
        line = table[0]
        across = -(-len(line) // -(-len(line) // MOST_COLUMNS))
        table = [line[start:start + across] for start in range(0, len(line), across)]
    return table


class Drawing:
    """Panels of one sweep that share axes and legend. `curves`: the parameter that distinguishes the curves of a
    panel, or None."""

    def __init__(self, sweep, curves, arguments):
        self.sweep, self.curves, self.arguments = sweep, curves, arguments
        self.tilt = 1000 * sweep.result.values("tilt")  # mrad
        self.data = [(method, *sweep.measured(method, "field_correlation")) for method in sweep.prefixes]
        self.lowest = min(correlation_panel.lowest(field[sweep.rows], error[sweep.rows])
                          for _, field, error in self.data)
        self.unseen = correlation_panel.Unseen()

    def numbered(self, rows):
        """Returns (number of the curve, row) for each row."""
        if self.curves is None:
            return [(0, row) for row in rows]
        columns = self.sweep.columns[self.curves][rows]
        return list(zip(np.searchsorted(self.sweep.values(self.curves), columns), rows))

    def panel(self, axis, fixed, rows):
        """Draws the points `rows`, which share the values `fixed`."""
        correlation_panel.prepare(axis, self.tilt, self.lowest, self.arguments)
        words = [sweep_file.text(name, value) for name, value in fixed.items()] \
            if "point" not in fixed else [self.sweep.label(self.sweep.varying(), rows[0])]
        axis.set_title(", ".join(words), fontsize=7.5, pad=3)
        if len(rows) == 0:
            axis.text(0.5, 0.5, "no data", ha="center", transform=axis.transAxes, color=style.GREY)
            return
        self.theories(axis, rows)
        for method, field, error in self.data:
            for number, row in self.numbered(rows):
                correlation_panel.draw_curve(axis, self.tilt, field[row], error[row],
                                             curve_looks.curve_look(number, method), self.unseen)

    def theories(self, axis, rows):
        sweep, tilt = self.sweep, self.tilt / 1000
        spaced, start = (np.geomspace, tilt[tilt > 0]) if self.arguments.log else (np.linspace, tilt)
        fine = spaced(start.min(), tilt.max(), STEPS)
        diffusion = sweep.optional("diffusion_theory")
        for number, row in self.numbered(rows) if diffusion is not None else []:
            tilt, field = theory.of_point(sweep, row, diffusion[row], fine)
            axis.plot(1000 * tilt, field**2, **style.line(number), linewidth=0.7, zorder=1)
        if sweep.result.has("single_scattering"):
            tilt, field = theory.curve(sweep.result, lambda q: theory.single_scattering(sweep.result, q),
                                       sweep.result.values("single_scattering"), fine)
            axis.plot(1000 * tilt, field**2, **curve_looks.SINGLE_SCATTERING, zorder=0.5)

    def deviations(self, axes, panels):
        """Draws Monte Carlo minus the other method, in combined standard errors of C_E."""
        deviation = self.sweep.table("deviation")
        limit = 1.15 * max(np.abs(deviation[self.sweep.rows]).max(), 1.5 * BAND)
        shown = self.tilt > 0 if self.arguments.log else np.ones(len(self.tilt), bool)
        for axis, (_, rows) in zip(axes.flat, panels):
            axis.axhspan(-BAND, BAND, color="0.9", linewidth=0, zorder=0)
            axis.axhline(0, color=style.GREY, linewidth=0.5, zorder=0.5)
            for number, row in self.numbered(rows):
                look = {**curve_looks.curve_look(number, None), "markersize": 2.2}
                axis.plot(self.tilt[shown], deviation[row][shown], linestyle="none", **look)
            axis.set(ylim=(-limit, limit), xlabel="tilt (mrad)", ylabel="deviation / error")
            if limit < 3 * BAND:
                axis.set_yticks([-BAND, 0, BAND])

    def entries(self):
        """Yields legend entries (handle, label)."""
        sweep, has = self.sweep, self.sweep.result.has
        for number, value in enumerate(sweep.values(self.curves) if self.curves else []):
            row = sweep.rows[sweep.columns[self.curves][sweep.rows] == value][0]
            names = sweep.varying() or sweep.given() if self.curves == "point" else [self.curves]
            yield curve_looks.curve_handle(sweep, number, has("diffusion_theory")), sweep.label(names, row)
        yield from curve_looks.method_entries(sweep)
        if has("diffusion_theory"):
            yield plt.Line2D([], [], color="black", linewidth=0.7), "lines: diffusion theory"
        if has("single_scattering"):
            yield plt.Line2D([], [], **curve_looks.SINGLE_SCATTERING), "single scattering only"
        if has("deviation"):
            yield plt.Rectangle((0, 0), 1, 1, color="0.9"), \
                f"deviation of $C_E$ in standard errors, $\\pm${BAND}"


def draw_sweep(sweep, arguments):
    rows, columns, curves = arrange(sweep)
    table = panels(sweep, rows, columns)
    every = sum(table, [])
    figure, axes, *beneath = page.page_of_panels(len(table), len(table[0]), len(every),
                                                 BENEATH if sweep.result.has("deviation") else 0)
    drawing = Drawing(sweep, curves, arguments)
    for axis, panel in zip(axes.flat, every):
        drawing.panel(axis, *panel)
    page.outer_labels(axes, len(every))
    for deviations in beneath:
        drawing.deviations(deviations, every)
        for axis in axes.flat[:len(every)]:
            page.label_sides(axis, axis.yaxis.label.get_visible(), False)
        page.outer_labels(deviations, len(every))
    for axis in axes[0]:
        correlation_panel.add_q_axis(axis, sweep.result, drawing.tilt)
    page.legend_outside(figure, list(drawing.entries()), sweep.notes())
    style.caption(figure, drawing.unseen.notes(arguments))
    return figure


@script.plot(several=True)
@script.option("--log", action="store_true", help="logarithmic tilt axis; tilts up to 0 are omitted")
@script.option("--log_correlation", action="store_true", help="logarithmic C_I axis; points whose C_E is "
               f"below {BELIEVED} standard errors are omitted")
@sweep_file.SELECT
def draw(results, arguments):
    for result in results:
        for name in filter(result.has, ("field_correlation", "mc/field_correlation")):
            if any(scales and scales[0].name == "/shift" for scales in list(result.dataset(name).dims)[1:]):
                raise style.Unusable(f"{result.path}: is a map over tilts and shifts; draw it with plots/tilt_shift.py")
    sweeps = list(filter(covariance_curves.is_sweep, results))
    if arguments.select and not sweeps:
        raise style.Unusable(f"{results[0].path}: is not a sweep, so --select cannot be used")
    if len(results) > 1 or not sweeps:
        return covariance_curves.draw(results, arguments)
    return draw_sweep(sweep_file.read(results[0], arguments), arguments)
