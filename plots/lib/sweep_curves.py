"""Memory-effect curves of a sweep: symbols, theories, deviations of the methods, legend."""

from lib import correlation_panel, curve_looks, style, sweep_file, theory

import matplotlib.pyplot as plt
import numpy as np

BAND = 4  # standard errors, as everywhere
STEPS = 300  # of a line


class Drawing:
    """Panels of one sweep that share axes and legend; `curves`: the axis that sets the curves of a
    panel apart, or None."""

    def __init__(self, sweep, curves, arguments):
        self.sweep, self.curves, self.arguments = sweep, curves, arguments
        self.tilt = 1000 * sweep.result.values("tilt")  # mrad
        self.data = [(method, *sweep.measured(method, "field_correlation"))
                     for method in sweep.prefixes]
        self.lowest = min(correlation_panel.lowest(field[sweep.rows], error[sweep.rows])
                          for _, field, error in self.data)
        self.unseen = correlation_panel.Unseen()

    def numbered(self, rows):
        """[(number of its curve, row)]."""
        if self.curves is None:
            return [(0, row) for row in rows]
        numbers = np.searchsorted(self.sweep.values(self.curves),
                                  self.sweep.columns[self.curves][rows])
        return list(zip(numbers, rows))

    def panel(self, axis, fixed, rows):
        """Of the points `rows`, which have the values `fixed` in common."""
        correlation_panel.prepare(axis, self.tilt, self.lowest, self.arguments)
        words = [sweep_file.text(name, value) for name, value in fixed.items()] \
            if "point" not in fixed else [self.sweep.label(self.sweep.varying(), rows[0])]
        axis.set_title(", ".join(words), fontsize=7.5, pad=3)
        if len(rows) == 0:
            axis.text(0.5, 0.5, "no point", ha="center", transform=axis.transAxes,
                      color=style.GREY)
            return
        self.theories(axis, rows)
        for method, field, error in self.data:
            for number, row in self.numbered(rows):
                correlation_panel.draw_curve(axis, self.tilt, field[row], error[row],
                                             curve_looks.curve_look(number, method), self.unseen)

    def fine_tilts(self):
        """Tilts of a line, in rad."""
        tilt = self.tilt / 1000
        if self.arguments.log:
            return np.geomspace(tilt[tilt > 0].min(), tilt.max(), STEPS)
        return np.linspace(tilt.min(), tilt.max(), STEPS)

    def theories(self, axis, rows):
        sweep, fine = self.sweep, self.fine_tilts()
        diffusion = sweep.optional("diffusion_theory")
        if diffusion is not None:
            for number, row in self.numbered(rows):
                tilt, field = theory.of_point(sweep, row, diffusion[row], fine)
                axis.plot(1000 * tilt, field**2, **style.line(number), linewidth=0.7, zorder=1)
        if sweep.result.has("single_scattering"):
            tilt, field = theory.curve(sweep.result, lambda q: theory.single_scattering(sweep.result, q),
                                       sweep.result.values("single_scattering"), fine)
            axis.plot(1000 * tilt, field**2, **curve_looks.SINGLE_SCATTERING, zorder=0.5)

    def deviations(self, axes, parts):
        """Monte Carlo less the other method, in combined standard errors of C_E."""
        deviation = self.sweep.table("deviation")
        limit = 1.15 * max(np.abs(deviation[self.sweep.rows]).max(), 1.5 * BAND)
        for axis, rows in zip(axes.flat, parts):
            axis.axhspan(-BAND, BAND, color="0.9", linewidth=0, zorder=0)
            axis.axhline(0, color=style.GREY, linewidth=0.5, zorder=0.5)
            for number, row in self.numbered(rows):
                look = {**curve_looks.curve_look(number, None), "markersize": 2.2}
                shown = self.tilt > 0 if self.arguments.log else np.ones(len(self.tilt), bool)
                axis.plot(self.tilt[shown], deviation[row][shown], linestyle="none", **look)
            axis.set_ylim(-limit, limit)
            if limit < 3 * BAND:
                axis.set_yticks([-BAND, 0, BAND])
            axis.set_xlabel("tilt (mrad)")
            axis.set_ylabel("deviation")

    def curve_entries(self):
        """Legend entries of the curves: (handle, label)."""
        sweep, method = self.sweep, curve_looks.last_method(self.sweep)
        line = sweep.result.has("diffusion_theory")
        for number, value in enumerate(sweep.values(self.curves) if self.curves else []):
            row = sweep.rows[sweep.columns[self.curves][sweep.rows] == value][0]
            names = sweep.varying() or sweep.given() if self.curves == "point" else [self.curves]
            look = {**curve_looks.curve_look(number, method), "markersize": 3}
            yield plt.Line2D([], [], linewidth=0.7, **look,
                             linestyle=style.look(number)["linestyle"] if line else "none"), \
                sweep.label(names, row)

    def entries(self):
        """All legend entries."""
        result = self.sweep.result
        yield from self.curve_entries()
        yield from curve_looks.method_entries(self.sweep)
        if result.has("diffusion_theory"):
            yield plt.Line2D([], [], color="black", linewidth=0.7), "lines: diffusion theory"
        if result.has("single_scattering"):
            yield plt.Line2D([], [], **curve_looks.SINGLE_SCATTERING), "single scattering alone"
        if result.has("deviation"):
            yield plt.Rectangle((0, 0), 1, 1, color="0.9"), \
                f"deviation of $C_E$ in standard errors, $\\pm${BAND}"
