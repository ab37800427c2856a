#!/usr/bin/env python3
"""Memory effect: intensity correlation against tilt, from one sweep (by both methods: with their
deviation beneath), or from any number of results of `covariance`, `validate` and `sweep` compared in
one panel."""

from lib import correlation_panel, covariance_curves, page, script, style, sweep_curves, sweep_file
from lib.correlation_panel import BELIEVED

MOST_ROWS, MOST_COLUMNS, MOST_CURVES = 5, 4, 8
BENEATH = 0.35  # height of a panel of deviations, of the one above it


def refuse_maps(result):
    for prefix in ("", "mc/"):
        name = f"{prefix}field_correlation"
        if result.has(name) and any(scales and scales[0].name == "/shift"
                                    for scales in list(result.dataset(name).dims)[1:]):
            raise style.Unusable(f"{result.path}: a map over tilts and shifts; "
                                 "plots/tilt_shift.py draws it")


def arrange(sweep):
    """Axes of (rows, columns, curves), None where one is not needed."""
    if sweep.is_list:
        return (None, None, "point") if len(sweep.rows) <= MOST_CURVES else (None, "point", None)
    axes = sweep.varying()
    if len(axes) > 3:
        sweep.refuse(f"varies {', '.join(axes)}, rows, columns and curves show three", (axes[0], 1))
    return [None] * (3 - len(axes)) + axes


def check_size(sweep, rows, columns, curves):
    """Refuses what a page cannot hold legibly."""
    limits = {rows: MOST_ROWS, columns: MOST_COLUMNS, curves: MOST_CURVES}
    if rows is None:
        limits[columns] = MOST_ROWS * MOST_COLUMNS
    counts = {name: len(sweep.values(name)) for name in limits if name}
    beyond = [name for name, count in counts.items() if count > limits[name]]
    if beyond:
        there = ", ".join(f"{count} points" if name == "point" else f"{count} values of {name}"
                          for name, count in counts.items())
        sweep.refuse(f"{there}; a page holds {MOST_ROWS} x {MOST_COLUMNS} panels of {MOST_CURVES} "
                     "curves", *((name, min(3, limits[name])) for name in beyond))


def parts(sweep, name, rows):
    """[({name: value}, its rows)] over the values of an axis, also those without any row here."""
    if name is None:
        return [({}, rows)]
    column = sweep.columns[name][rows]
    return [({name: value}, rows[column == value]) for value in sweep.values(name)]


def panels(sweep, rows, columns):
    """[row][column]: the values that the panel fixes, and its points; a single axis of panels is
    wrapped."""
    table = [[({**fixed, **fixed_too}, part) for fixed_too, part in parts(sweep, columns, group)]
             for fixed, group in parts(sweep, rows, sweep.rows)]
    if rows is None and len(table[0]) > MOST_COLUMNS:
        line = table[0]
        across = -(-len(line) // -(-len(line) // MOST_COLUMNS))
        table = [line[start:start + across] for start in range(0, len(line), across)]
    return table


def draw_sweep(sweep, arguments):
    rows, columns, curves = arrange(sweep)
    check_size(sweep, rows, columns, curves)
    table = panels(sweep, rows, columns)
    count = sum(map(len, table))
    figure, axes, *beneath = page.page_of_panels(len(table), len(table[0]), count,
                                                 BENEATH if sweep.result.has("deviation") else 0)
    drawing = sweep_curves.Drawing(sweep, curves, arguments)
    for axis, panel in zip(axes.flat, sum(table, [])):
        drawing.panel(axis, *panel)
    page.outer_labels(axes, count)
    for deviations in beneath:
        drawing.deviations(deviations, [points for _, points in sum(table, [])])
        for axis in axes.flat[:count]:
            page.label_sides(axis, axis.yaxis.label.get_visible(), False)
        page.outer_labels(deviations, count)
    for axis in axes[0]:
        correlation_panel.add_q_axis(axis, sweep.result, drawing.tilt)
    page.legend_outside(figure, list(drawing.entries()), sweep.notes())
    style.caption(figure, drawing.unseen.notes(arguments))
    return figure


@script.plot(several=True)
@script.option("--log", action="store_true", help="logarithmic tilts; those up to 0 are left out")
@script.option("--log_correlation", action="store_true", help="logarithmic C_I; left out where C_E, a "
               f"magnitude, is below {BELIEVED} standard errors")
@sweep_file.SELECT
def draw(results, arguments):
    for result in results:
        refuse_maps(result)
    sweeps = [result for result in results if covariance_curves.is_sweep(result)]
    if arguments.select and not sweeps:
        raise style.Unusable(f"{results[0].path}: not a sweep, --select has nothing to select")
    if len(results) > 1 or not sweeps:
        return covariance_curves.draw(results, arguments)
    return draw_sweep(sweep_file.read(results[0], arguments), arguments)
