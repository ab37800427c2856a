#!/usr/bin/env python3
"""Memory effect: intensity correlation against tilt, from one sweep, or from any number of
memory_effect results of `covariance` and `validate`, compared in one panel."""

import style

import correlation_panel
import covariance_curves
import sweep_file

import matplotlib.pyplot as plt
import numpy as np

MOST_ROWS, MOST_COLUMNS, MOST_CURVES = 5, 4, 7
MOST_SYMBOLS = 18  # per curve in a panel; tilts between them are left to the lines


def is_sweep(result):
    return any(result.has(f"{prefix}field_correlation")
               and result.dataset(f"{prefix}field_correlation").ndim > 1 for prefix in ("", "mc/"))


def arrange(sweep):
    """Axes of (rows, columns, curves), None where one is not needed."""
    if sweep.is_list:
        return None, None, "point"
    axes = sweep.varying()
    if len(axes) > 3:
        raise style.Unusable(f"{sweep.path}: varies {', '.join(axes)}, rows, columns and curves "
                             f"show three; try --select {sweep.example(axes[0], 1)}")
    return [None] * (3 - len(axes)) + axes


def check_size(sweep, rows, columns, curves):
    """Refuses what a page cannot hold legibly."""
    limits = {rows: MOST_ROWS, columns: MOST_COLUMNS, curves: MOST_CURVES}
    if rows is None:
        limits[columns] = MOST_ROWS * MOST_COLUMNS
    counts = {name: len(sweep.values(name)) for name in limits if name}
    beyond = [name for name, count in counts.items() if count > limits[name]]
    if beyond:
        shape = " x ".join(f"{count} {name}" for name, count in counts.items())
        advice = " ".join(sweep.example(name, min(3, limits[name])) for name in beyond)
        raise style.Unusable(f"{sweep.path}: {shape} do not fit a page of {MOST_ROWS} x "
                             f"{MOST_COLUMNS} panels of {MOST_CURVES} curves; "
                             f"try --select {advice}")


def panels(sweep, rows, columns):
    """[row][column]: the names of the axes that the panel fixes, and its points; a single axis of
    panels is wrapped."""
    names = [name for name in (rows, columns) if name]
    table = [[(names, part) for _, part in sweep.groups(columns, group)]
             for _, group in sweep.groups(rows, sweep.rows)]
    if rows is None and len(table[0]) > MOST_COLUMNS:
        line = table[0]
        across = -(-len(line) // -(-len(line) // MOST_COLUMNS))
        table = [line[start:start + across] for start in range(0, len(line), across)]
    return table


def draw_points(axis, sweep, numbered, tilt):
    """Symbols of every method and curve of a panel, at not too many tilts."""
    some = np.argsort(tilt)[::-(-len(tilt) // MOST_SYMBOLS)]
    for method in sweep.prefixes:
        field, error = (sweep.of(method, f"field_correlation{end}") for end in ("", "_error"))
        for number, row in numbered:
            correlation_panel.draw_curve(axis, tilt[some], np.abs(field[row])[some],
                                         error[row][some], sweep_file.curve_look(number, method))


def draw_theory(axis, sweep, numbered, tilt):
    order = np.argsort(tilt)
    diffusion = sweep.optional("diffusion_theory")
    if diffusion is not None:
        for number, row in numbered:
            look = style.look(number)
            axis.plot(tilt[order], diffusion[row][order]**2, color=look["color"], linewidth=0.7,
                      linestyle=look["linestyle"], zorder=1)
    if sweep.result.has("single_scattering"):
        axis.plot(tilt[order], sweep.result.values("single_scattering")[order]**2, color="0.55",
                  linewidth=1.6, zorder=0.5)


def draw_panel(axis, sweep, names, rows, curves, tilt):
    """Of the points `rows`; the axes `names` are the same for them all."""
    numbers = list(sweep.values(curves)) if curves else [None]
    column = sweep.columns[curves] if curves else None
    numbered = [(numbers.index(column[row]) if curves else 0, row) for row in rows]
    correlation_panel.prepare(axis)
    draw_theory(axis, sweep, numbered, tilt)
    draw_points(axis, sweep, numbered, tilt)
    axis.set_title(sweep.label(names, rows[0]), fontsize=7.5, pad=3)


def curve_entries(sweep, curves):
    """Legend entries of the curves: (handle, label)."""
    method = "wave" if len(sweep.prefixes) > 1 else None
    line = sweep.optional("diffusion_theory") is not None
    for number, value in enumerate(sweep.values(curves) if curves else []):
        row = sweep.rows[sweep.columns[curves][sweep.rows] == value][0]
        names = sweep.varying() if sweep.is_list else [curves]
        look = {**sweep_file.curve_look(number, method), "markersize": 3}
        yield plt.Line2D([], [], linewidth=0.7, **look,
                         linestyle=style.look(number)["linestyle"] if line else "none"), \
            sweep.label(names, row) or sweep_file.text("point", value)


def other_entries(sweep):
    """Legend entries of what all curves share."""
    yield from sweep_file.method_entries(sweep)
    if sweep.optional("diffusion_theory") is not None:
        yield plt.Line2D([], [], color="black", linewidth=0.7), "lines: diffusion theory"
    if sweep.result.has("single_scattering"):
        yield plt.Line2D([], [], color="0.55", linewidth=1.6), "single scattering alone"


def add_legend(figure, sweep, curves):
    style.legend_above(figure, [*curve_entries(sweep, curves), *other_entries(sweep)])


def draw_sweep(sweep):
    rows, columns, curves = arrange(sweep)
    check_size(sweep, rows, columns, curves)
    table = panels(sweep, rows, columns)
    down, across = len(table), len(table[0])
    figure, axes = style.page_of_panels(down, across, sum(map(len, table)))
    tilt = 1000 * sweep.result.values("tilt")
    for axis, panel in zip(axes.flat, sum(table, [])):
        draw_panel(axis, sweep, *panel, curves, tilt)
        axis.set_xlabel("tilt (mrad)")
        axis.set_ylabel(r"intensity correlation $C_I$")
    style.outer_labels(axes, sum(map(len, table)))
    for axis in axes[0]:
        correlation_panel.add_q_axis(axis, sweep.result, tilt)
    add_legend(figure, sweep, curves)
    return figure


def draw(results, arguments):
    if not any(is_sweep(result) for result in results):
        return covariance_curves.draw(results)
    if len(results) > 1:
        raise style.Unusable("a sweep is drawn alone: give one sweep, or several covariance or "
                             "validate results")
    return draw_sweep(sweep_file.read(results, arguments))


if __name__ == "__main__":
    style.main(draw, __doc__, several=True, add_options=sweep_file.add_select)
