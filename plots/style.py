"""What the plots share: their look, how they read result files, and their command line. To be
imported before the packages that it looks for."""

import argparse
import importlib
import pathlib
import sys

for package in ("matplotlib", "h5py", "numpy"):
    try:
        importlib.import_module(package)
    except ImportError:
        print(f"this python has no {package}; on Debian use /usr/bin/python3", file=sys.stderr)
        sys.exit(2)

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import NullFormatter

# Okabe and Ito 2008: told apart by the colour blind, and in grey by marker and line style besides.
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X"]
LINES = ["-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (7, 2)), (0, (1, 1))]
GREY = "0.5"
COLUMN, PAGE, PAGE_HEIGHT = 3.4, 7.0, 8.6  # of a journal, inches

plt.rcParams.update({
    "font.size": 8, "axes.labelsize": 8, "axes.titlesize": 8, "legend.fontsize": 7,
    "xtick.labelsize": 7, "ytick.labelsize": 7, "mathtext.fontset": "dejavusans",
    "axes.linewidth": 0.6, "lines.linewidth": 0.9, "lines.markersize": 3.5,
    "xtick.direction": "in", "ytick.direction": "in", "xtick.top": True, "ytick.right": True,
    "xtick.major.width": 0.6, "ytick.major.width": 0.6,
    "errorbar.capsize": 1.5, "legend.frameon": False, "legend.handlelength": 2.4,
    "pdf.fonttype": 42, "savefig.dpi": 300, "figure.constrained_layout.use": True,
    "savefig.bbox": "tight", "savefig.pad_inches": 0.02,
})


class Unusable(Exception):
    """A result file without what the plot needs; the message says which file and what."""


class Result:
    """A result file, with one clear complaint about whatever is missing."""

    def __init__(self, path):
        self.path = path
        try:
            self.file = h5py.File(path, "r")
        except OSError:
            raise Unusable(f"{path}: not a readable result file")

    def has(self, name):
        return name in self.file

    def dataset(self, name):
        if not isinstance(self.file.get(name), h5py.Dataset):
            raise Unusable(f"{self.path}: has no dataset {name}")
        return self.file[name]

    def values(self, name):
        return self.dataset(name)[...]

    def axis(self, name, number):
        """Values of the scale of one axis of a dataset."""
        dimension = self.dataset(name).dims[number]
        if len(dimension) == 0:
            raise Unusable(f"{self.path}: axis {number} of {name} has no scale")
        return dimension[0][...]

    def attribute(self, name, default=None):
        return self.file.attrs.get(name, default)


def look(number):
    """Colour, marker and line style of curve `number`, all different from its neighbours'."""
    return {"color": COLOURS[number % len(COLOURS)], "marker": MARKERS[number % len(MARKERS)],
            "linestyle": LINES[number % len(LINES)]}


def short(values):
    """Numbers in three significant digits, or more where two would read the same."""
    texts = [f"{value:.3g}" for value in values]
    return texts if len(set(texts)) == len(texts) else [f"{value:g}" for value in values]


def angle(value):
    """An angle in words."""
    turns = {0.5: r"$\pi/2$", 1.0: r"$\pi$"}
    for turn, name in turns.items():
        if np.isclose(abs(value), turn * np.pi):
            return ("$-$" if value < 0 else "") + name
    return f"{value:.3g} rad"


def angle_axis(axis, angles, label):
    """A horizontal axis in radians, in steps of pi/2 where it spans more than a quadrant or two."""
    axis.set_xlabel(f"{label} (rad)")
    if np.ptp(angles) <= np.pi / 2:
        return
    names = {-2: r"$-\pi$", -1: r"$-\pi/2$", 0: "0", 1: r"$\pi/2$", 2: r"$\pi$", 3: r"$3\pi/2$",
             4: r"$2\pi$"}
    low, high = np.floor(angles.min() / (np.pi / 2)), np.ceil(angles.max() / (np.pi / 2))
    shown = [n for n in names if low <= n <= high]
    axis.set_xticks([n * np.pi / 2 for n in shown], [names[n] for n in shown])


def whole_decades(axis):
    """Limits at powers of ten, so that each axis has at least two labels."""
    for low_high, limit in ((axis.dataLim.intervalx, axis.set_xlim),
                            (axis.dataLim.intervaly, axis.set_ylim)):
        low, high = np.log10(low_high)
        limit(10 ** np.floor(low - 0.03), 10 ** np.ceil(high + 0.03))
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.yaxis.set_minor_formatter(NullFormatter())


def page_of_panels(down, across, count):
    """Figure and axes [down, across] of a page or, for one panel across, of a column; those after
    `count` are left out."""
    width = COLUMN if across == 1 else min(PAGE, 2.4 * across)
    height = min(2.1, 1.3 * width / across, (PAGE_HEIGHT - 0.5) / down)
    figure, axes = plt.subplots(down, across, squeeze=False, sharex=True, sharey=True,
                                figsize=(width, 0.5 + down * height))
    for axis in axes.flat[count:]:
        axis.remove()
    return figure, axes


def outer_labels(axes, count):
    """Labels at the left and beneath the lowest panel of each column alone."""
    for (row, column), axis in np.ndenumerate(axes):
        lowest = (row + 1) * axes.shape[1] + column >= count
        axis.tick_params(labelbottom=lowest, labelleft=column == 0)
        axis.xaxis.label.set_visible(lowest)
        axis.yaxis.label.set_visible(column == 0)


def legend_above(figure, entries):
    """A legend of (handle, label) over the figure, in as many columns as its width holds."""
    if not entries:
        return
    handles, labels = zip(*entries)
    sizes = [len(label.replace("$", "")) + 9 for label in labels]
    width = lambda columns: sum(max(part) for part in np.array_split(sizes, columns))
    most = max(n for n in range(1, len(labels) + 1)
               if n == 1 or width(n) <= 17 * figure.get_figwidth())
    figure.legend(handles, labels, loc="lower center", bbox_to_anchor=(0.5, 1.0),
                  ncol=-(-len(labels) // -(-len(labels) // most)))


def save(figure, prefix):
    for ending in ("png", "pdf"):
        dates = {"CreationDate": None} if ending == "pdf" else None
        figure.savefig(f"{prefix}.{ending}", metadata=dates)
        print(f"wrote {prefix}.{ending}")


def main(draw, description, several=False, add_options=None):
    """Runs draw(results) -> figure on the command line's files; exits 2 if they lack something.
    With add_options(parser) it runs draw(results, arguments)."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("results", metavar="RESULT.h5", nargs="+" if several else 1)
    parser.add_argument("--out", metavar="PREFIX", help="writes PREFIX.png and PREFIX.pdf "
                        "(default: beside the first result, named after it and this plot)")
    if add_options:
        add_options(parser)
    arguments = parser.parse_args()
    first = pathlib.Path(arguments.results[0])
    prefix = arguments.out or str(first.with_suffix("")) + "_" + pathlib.Path(sys.argv[0]).stem
    try:
        results = [Result(path) for path in arguments.results]
        save(draw(results, arguments) if add_options else draw(results), prefix)
    except (Unusable, OSError) as problem:
        print(problem, file=sys.stderr)
        sys.exit(2)
