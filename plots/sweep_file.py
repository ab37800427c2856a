"""Reading of a sweep's result file. A grid and a list of points look alike here: a table with one
row per point, in row-major order of the grid."""

import style

import matplotlib.pyplot as plt
import numpy as np

METHODS = {"mc": "Monte Carlo", "wave": "wave solver"}
PARAMETERS = ("density", "radius", "index", "optical_depth", "g", "albedo")
NAMES = {"density": "density", "radius": "radius", "index": "index", "optical_depth": "OD",
         "g": "$g$", "albedo": "albedo", "point": "point"}


class Sweep:
    """One sweep. `columns`: each parameter's value at every point [point]; `axes`: those that the
    grid varies, outermost first, or for a list of points the parameters that differ; `rows`: the
    selected points."""

    def __init__(self, result):
        self.result, self.path = result, result.path
        self.prefixes = {method: f"{method}/" for method in METHODS
                         if result.has(f"{method}/memory_effect_range")} or {None: ""}
        grid = result.dataset(next(iter(self.prefixes.values())) + "memory_effect_range")
        if result.attribute("format", 1) < 2 or grid.ndim == 0:
            raise style.Unusable(f"{self.path}: not a sweep of this version of the program")
        if grid.size == 0:
            raise style.Unusable(f"{self.path}: no point of the sweep is finished")
        scales = dict(self.scale(grid, axis) for axis in range(grid.ndim))
        self.shape = grid.shape
        self.columns = self.read_columns(scales)
        self.is_list = "point" in scales
        self.axes = [name for name in (PARAMETERS if self.is_list else scales)
                     if name in self.columns and len(np.unique(self.columns[name])) > 1]
        self.rows = np.arange(grid.size)

    def scale(self, grid, axis):
        """Name and values of one axis of the grid."""
        if len(grid.dims[axis]) == 0:
            raise style.Unusable(f"{self.path}: axis {axis} of memory_effect_range has no scale")
        scale = grid.dims[axis][0]
        return scale.name.split("/")[-1], scale[...]

    def read_columns(self, scales):
        grids = np.meshgrid(*scales.values(), indexing="ij")
        columns = {name: values.ravel() for name, values in zip(scales, grids)}
        for name in PARAMETERS:
            if name not in columns and self.result.has(name):
                columns[name] = self.table(name)
        return columns

    def table(self, name):
        """A dataset [grid, ...] as [point, ...]."""
        values = self.result.values(name)
        if values.shape[:len(self.shape)] != self.shape:
            raise style.Unusable(f"{self.path}: {name} is not one value per point of the grid")
        return values.reshape(-1, *values.shape[len(self.shape):])

    def optional(self, name):
        return self.table(name) if self.result.has(name) else None

    def of(self, method, name):
        return self.table(self.prefixes[method] + name)

    def values(self, name, rows=None):
        """The different values of a parameter among the points."""
        return np.unique(self.columns[name][self.rows if rows is None else rows])

    def example(self, name, count):
        """An example of --select that keeps `count` values of an axis."""
        values = self.values(name)
        kept = np.unique(np.linspace(0, len(values) - 1, count).round().astype(int))
        return f"{name}={','.join(f'{value:g}' for value in values[kept])}"

    def varying(self):
        """The axes that still vary among the selected points."""
        return [name for name in self.axes if len(self.values(name)) > 1]

    def select(self, choices):
        """Keeps the points of choices: AXIS=VALUE,VALUE."""
        for choice in choices or []:
            name, _, text = choice.partition("=")
            column = self.column(name)
            try:
                wanted = [float(value) for value in text.split(",")]
            except ValueError:
                raise style.Unusable(f"--select {choice}: should be AXIS=VALUE,VALUE")
            for value in wanted:
                if not np.isclose(column, value, rtol=1e-4, atol=0).any():
                    raise style.Unusable(f"--select {choice}: {self.path} has {name} = "
                                         f"{', '.join(style.short(np.unique(column)))}")
            near = np.isclose(column[:, None], wanted, rtol=1e-4, atol=0).any(axis=1)
            self.rows = self.rows[near[self.rows]]
        if len(self.rows) == 0:
            raise style.Unusable(f"{self.path}: no point has all that --select asks for")

    def column(self, name):
        if name not in self.columns:
            raise style.Unusable(f"{self.path}: has no axis {name}; has {', '.join(self.columns)}")
        return self.columns[name]

    def groups(self, name, rows):
        """[(value, its rows)] of a parameter; [(None, rows)] if name is None."""
        if name is None:
            return [(None, rows)]
        column = self.columns[name][rows]
        return [(value, rows[column == value]) for value in np.unique(column)]

    def label(self, names, row):
        """What sets a point apart, in words."""
        return ", ".join(text(name, self.columns[name][row]) for name in names)

    def single_scattering_range(self):
        """[q L at C_I = 1/2 of single scattering], empty if the tilts do not reach it; None if it
        is not in the file. It depends on the geometry alone."""
        if not self.result.has("single_scattering_range"):
            return None
        dataset = self.result.dataset("single_scattering_range")
        return [] if dataset.attrs.get("censored", 0) else [float(dataset[()])]

    def target(self):
        """The relative error that the run was to reach, or None where it stops otherwise."""
        return self.result.attribute("target_error")


def text(name, value):
    return f"{NAMES[name]} {value:g}" if name == "point" else f"{NAMES[name]} = {value:.4g}"


def add_select(parser):
    parser.add_argument("--select", nargs="+", metavar="AXIS=VALUE,VALUE",
                        help="draws these points alone: optical_depth=10 g=0,0.9")


def read(results, arguments):
    """The one sweep of the command line, with what --select leaves of it."""
    sweep = Sweep(results[0])
    sweep.select(arguments.select)
    return sweep


def method_look(method, colour, size=3.5):
    """Monte Carlo open and large where both methods are drawn: the wave solver shows inside."""
    sizes = {None: size, "mc": 1.6 * size, "wave": 0.7 * size}
    return {"color": colour, "markersize": sizes[method],
            "markerfacecolor": "none" if method == "mc" else colour}


def curve_look(number, method):
    """Colour and symbol of one curve; for one method every other one is open, for prints without
    colour."""
    look = style.look(number)
    fill = {} if method or number % 2 == 0 else {"markerfacecolor": "white"}
    return {"marker": look["marker"], **method_look(method, look["color"], 3), **fill}


def method_entries(sweep):
    """Legend entries (handle, label) of both methods, where a file holds both."""
    if len(sweep.prefixes) > 1:
        for method, name in METHODS.items():
            yield plt.Line2D([], [], linestyle="none", marker="o",
                             **method_look(method, "black")), name
