"""Pages of panels with one legend outside the panels."""

import textwrap

from lib import style

import matplotlib.pyplot as plt
import numpy as np

LETTERS = 17  # of a legend, per inch
MOST_ROWS = 3  # of a legend and its notes above a single panel


def page_of_panels(down, across, count, beneath=0):
    """Returns a figure and its axes [down, across], as wide as a page or, for one panel across, as a column. Panels
    after number `count` are removed. If `beneath`, a fraction of a panel's height, is not 0, also returns the axes
    [down, across] of narrow panels below them."""
    width = style.COLUMN if across == 1 else min(style.PAGE, 2.4 * across)
    height = min(min(2.1, 1.3 * width / across) * (1 + beneath), (style.PAGE_HEIGHT - 0.5) / down)
    heights = [1, beneath] * down if beneath else [1] * down
    figure, rows = plt.subplots(len(heights), across, squeeze=False, sharex=True,
                                figsize=(width, 0.5 + down * height),
                                gridspec_kw={"height_ratios": heights})
    kinds = [rows[0::2], rows[1::2]] if beneath else [rows]
    for axes in kinds:
        for axis in axes.flat[1:]:
            axis.sharey(axes[0, 0])
        for axis in axes.flat[count:]:
            axis.remove()
    return figure, *kinds


def side_by_side(result, panels, width, height, **looks):
    """Returns a figure of panels, each drawn by a function of (axis, result)."""
    figure, axes = plt.subplots(1, len(panels), figsize=(width, height), **looks)
    for axis, draw_panel in zip(axes, panels):
        draw_panel(axis, result)
    return figure


def outer_labels(axes, count):
    """Keeps axis labels only at the left and below the lowest panel of each column."""
    for (row, column), axis in np.ndenumerate(axes):
        lowest = (row + 1) * axes.shape[1] + column >= count
        label_sides(axis, column == 0, lowest)


def label_sides(axis, left, bottom):
    axis.tick_params(labelbottom=bottom, labelleft=left)
    axis.xaxis.label.set_visible(bottom)
    axis.yaxis.label.set_visible(left)


def labelled(axes):
    """Returns legend entries (handle, label) of everything drawn in some axes, each label once."""
    entries = {label: handle for axis in axes
               for handle, label in zip(*axis.get_legend_handles_labels())}
    return [(handle, label) for label, handle in entries.items()]


def legend_above(figure, entries, columns, **looks):
    """Adds a legend of (handle, label) above the figure."""
    handles, labels = zip(*entries) if entries else ((), ())
    figure.legend(handles, labels, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=columns,
                  **looks)


def legend_outside(figure, entries, notes=()):
    """Adds a legend of (handle, label), headed by notes: above the figure, or beside a single panel if it would have
    more than a few rows."""
    if not entries and not notes:
        return
    letters = LETTERS * figure.get_figwidth()
    sizes = [len(label.replace("$", "")) + 9 for _, label in entries] or [0]
    width = lambda columns: sum(max(part) for part in np.array_split(sizes, columns))
    most = max(n for n in range(1, len(sizes) + 1) if n == 1 or width(n) <= letters)
    columns = -(-len(sizes) // -(-len(sizes) // most))  # all about equally long
    rows = len(notes) + -(-len(entries) // columns)
    beside = entries and figure.get_figwidth() <= style.COLUMN and rows > MOST_ROWS
    wrapped = [textwrap.fill(note, 40 if beside else int(letters)) for note in notes]
    head = {"title": "\n".join(wrapped) or None, "title_fontsize": 7}
    if beside:
        figure.legend(*zip(*entries), loc="center left", bbox_to_anchor=(1.0, 0.5), ncol=1, **head)
    else:
        legend_above(figure, entries, columns, **head)
