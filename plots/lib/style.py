"""Style of the plots. Scripts import it before matplotlib, h5py and numpy, because it checks that these are
installed."""

import importlib
import logging
import sys

for package in ("matplotlib", "h5py", "numpy"):
    try:
        importlib.import_module(package)
    except ImportError:
        print(f"{sys.executable} has no {package}; on Debian: apt install python3-{package}, and "
              "use /usr/bin/python3", file=sys.stderr)
        sys.exit(2)

logging.getLogger("fontTools").setLevel(logging.ERROR)  # suppresses warnings about dates of font files
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from lib.result_file import Unusable

# Colours of Okabe and Ito 2008, which colour-blind readers can distinguish; marker and line style also differ, for
# prints in grey.
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#8C510A"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X", "p"]
LINES = ["-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (7, 2)), (0, (1, 1)), (0, (3, 1, 1, 1))]
GREY = "0.5"
INDEX = LinearSegmentedColormap.from_list("index", ["white", "#56B4E9", "#00456b"])
COLUMN, PAGE, PAGE_HEIGHT = 3.4, 7.0, 8.6  # widths and height of a journal page, inches
PAD = 0.02  # margin around the figure, inches

LOOK = {
    "font.size": 8, "axes.labelsize": 8, "axes.titlesize": 8, "legend.fontsize": 7,
    "xtick.labelsize": 7, "ytick.labelsize": 7, "mathtext.fontset": "dejavusans",
    "axes.linewidth": 0.6, "lines.linewidth": 0.9, "lines.markersize": 3.5,
    "xtick.direction": "in", "ytick.direction": "in", "xtick.top": True, "ytick.right": True,
    "xtick.major.width": 0.6, "ytick.major.width": 0.6,
    "errorbar.capsize": 1.5, "legend.frameon": False, "legend.handlelength": 2.4,
    "pdf.fonttype": 42, "savefig.dpi": 300, "figure.constrained_layout.use": True,
    "savefig.bbox": "tight", "savefig.pad_inches": PAD,
}
plt.rcParams.update(LOOK)


def look(number):
    """Returns colour, marker and line style of curve `number`; all three differ from those of neighbouring curves."""
    return {"color": COLOURS[number % len(COLOURS)], "marker": MARKERS[number % len(MARKERS)],
            "linestyle": LINES[number % len(LINES)]}


def line(number):
    """Returns colour and line style of curve `number`."""
    return {key: look(number)[key] for key in ("color", "linestyle")}


def symbols(number):
    """Returns the look of curve `number` as points with error bars, without connecting lines."""
    return {**look(number), "linestyle": "none", "elinewidth": 0.7}


def mark(axis, height):
    """Draws a dotted grey line at a reference value."""
    axis.axhline(height, color=GREY, linewidth=0.6, linestyle=(0, (1, 2)), zorder=0)


def circle(points=200):
    """Returns points of the unit circle, [x or y, point]."""
    turn = np.linspace(0, 2 * np.pi, points)
    return np.array([np.cos(turn), np.sin(turn)])


def short(values):
    """Returns numbers with three significant digits, or more if two texts would be equal."""
    texts = [f"{value:.3g}" for value in values]
    return texts if len(set(texts)) == len(texts) else [f"{value:g}" for value in values]


def angle(value):
    """Returns an angle as text."""
    turns = {0.5: r"$\pi/2$", 1.0: r"$\pi$"}
    for turn, name in turns.items():
        if np.isclose(abs(value), turn * np.pi):
            return ("$-$" if value < 0 else "") + name
    return f"{value:.3g} rad"


def angle_axis(axis, angles, label):
    """Labels a horizontal axis in radians, with ticks at multiples of pi/2 if it spans a large angle."""
    axis.set_xlabel(f"{label} (rad)")
    if np.ptp(angles) <= np.pi / 2:
        return
    names = {-2: r"$-\pi$", -1: r"$-\pi/2$", 0: "0", 1: r"$\pi/2$", 2: r"$\pi$", 3: r"$3\pi/2$",
             4: r"$2\pi$"}
    low, high = np.floor(angles.min() / (np.pi / 2)), np.ceil(angles.max() / (np.pi / 2))
    shown = [n for n in names if low <= n <= high]
    axis.set_xticks([n * np.pi / 2 for n in shown], [names[n] for n in shown])


def in_equal_ratios(values):
    """Whether ascending values have equal ratios, so that a logarithmic axis suits them."""
    if len(values) < 3 or values[0] <= 0:
        return False
    steps = np.diff(np.log(values))
    return np.allclose(steps, steps[0], rtol=1e-3)


def whole_decades(axis):
    """Moves the limits of a logarithmic axis to powers of ten, so that it has at least two labels."""
    for low_high, limit in ((axis.dataLim.intervalx, axis.set_xlim),
                            (axis.dataLim.intervaly, axis.set_ylim)):
        low, high = np.log10(low_high)
        limit(10 ** np.floor(low - 0.03), 10 ** np.ceil(high + 0.03))
    no_minor_numbers(axis)


def no_minor_numbers(axis):
    for side in (axis.xaxis, axis.yaxis):
        side.set_minor_formatter(NullFormatter())


def few_decades(side, steps=(1, 2, 5)):
    """Labels these steps of every decade, for a logarithmic axis that spans few decades."""
    side.set_major_locator(LogLocator(subs=steps))
    side.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    side.set_minor_formatter(NullFormatter())


def label_log_axis(side):
    """Labels several steps of every decade if a logarithmic axis spans so few decades that it would have one label."""
    low, high = side.get_view_interval()
    if high < 100 * low:
        few_decades(side)


def caption(figure, sentences):
    """Adds sentences to a figure's caption, which is printed and written into the metadata of both files."""
    figure.caption = "; ".join([*filter(None, [getattr(figure, "caption", "")]), *sentences])


def save(figure, prefix, dpi=None):
    text = getattr(figure, "caption", "").replace("$", "")
    if text:
        print(f"caption: {text}")
    for ending, metadata in (("png", {"Description": text} if text else {}),
                             ("pdf", {"CreationDate": None, "Subject": text or None})):
        figure.savefig(f"{prefix}.{ending}", metadata=metadata, dpi=dpi or LOOK["savefig.dpi"])
        print(f"wrote {prefix}.{ending}")
        figure.set_layout_engine("none")  # both files use the same layout
