"""Reading of a sweep's result file. A grid, a grid with holes and a list of points look alike
here: a table with one row per point."""

from lib import script, style

import numpy as np

METHODS = {"mc": "Monte Carlo", "wave": "wave solver", "transport": "transport"}
PARAMETERS = ("density", "radius", "index", "optical_depth", "g", "albedo")
NAMES = {"density": "density", "radius": "radius", "index": "index", "optical_depth": "OD",
         "g": "$g$", "albedo": "albedo"}
LEAST_FILLED = 0.25  # of a product of values, for its points to be shown as a grid with holes
LEAST_STEPS = 4  # tilts up to the range, for its error to be trusted


class Sweep:
    """One sweep. `columns`: each parameter's value at every point [point]; `axes`: those that vary
    and do not follow from others, outermost first; `is_list`: the points are not (part of) a grid;
    `rows`: the selected points."""

    def __init__(self, result):
        self.result, self.path = result, result.path
        self.prefixes = {method: f"{method}/" for method in METHODS
                         if result.has(f"{method}/memory_effect_range")} or {None: ""}
        grid = result.dataset(next(iter(self.prefixes.values())) + "memory_effect_range")
        if result.attribute("format", 1) < 2 or grid.ndim == 0:
            self.refuse("not a sweep of this version of the program")
        if grid.size == 0:
            self.refuse("no point of the sweep is finished")
        scales = dict(result.scale(grid.name, axis) for axis in range(grid.ndim))
        self.shape, self.rows, self.scene = grid.shape, np.arange(grid.size), result.scene
        self.columns = self.read_columns(scales)
        self.axes = [name for name in (self.given() if "point" in scales else scales)
                     if len(self.values(name)) > 1]
        self.is_list = "point" in scales and not self.has_part_of_grid()

    def read_columns(self, scales):
        columns = columns_of(scales)
        for name in PARAMETERS:
            if name not in columns and self.result.has(name):
                columns[name] = self.table(name)
        return columns

    def given(self):
        """The parameters that a list gives; those of scatterers follow from their radius and index,
        the optical depth from a density."""
        scatterer = self.scene.get("scatterer")
        known = {"g": scatterer == "hg", "albedo": scatterer in ("hg", "point"),
                 "optical_depth": "density" not in self.columns and
                 not self.scene.keys() & {"density", "count", "mean_free_path"}}
        return [name for name in PARAMETERS if name in self.columns and known.get(name, True)]

    def has_part_of_grid(self):
        """Whether a list is an unfinished grid, or fills a fair part of the product of its values;
        where one of several values is another at each point, there is nothing to join."""
        counts, points = [len(self.values(name)) for name in self.axes], self.shape[0]
        fills = points >= LEAST_FILLED * np.prod(counts)
        return "points" not in self.scene or (fills and (len(counts) < 2 or max(counts) < points))

    def notes(self):
        """What every picture has to say: points that are missing, and what all that it shows have
        in common."""
        common = [name for name in self.axes or self.given() if len(self.values(name)) == 1]
        return [*self.unfinished(), *([self.label(common, self.rows[0])] if common else [])]

    def unfinished(self):
        """[A sentence on points that are missing, if any]."""
        if self.result.attribute("complete", 1):
            return []
        lists = [np.size(self.scene.get(name, 0)) for name in PARAMETERS]
        identity = self.result.attribute("identity", "").splitlines()
        total = np.prod(lists) if "points" not in self.scene else \
            sum("=" in line and " = " not in line for line in identity)  # a line for each point
        return [f"unfinished: {self.shape[0]} of {total} points"]

    def table(self, name):
        """A dataset [grid, ...] as [point, ...]."""
        values = self.result.values(name)
        if values.shape[:len(self.shape)] != self.shape:
            self.refuse(f"{name} is not one value per point of the grid")
        return values.reshape(-1, *values.shape[len(self.shape):])

    def optional(self, name):
        return self.table(name) if self.result.has(name) else None

    def of(self, method, name):
        return self.table(self.prefixes[method] + name)

    def measured(self, method, name):
        """Values of all points and their errors."""
        return self.of(method, name), self.of(method, f"{name}_error")

    def ranges(self, method):
        """Returns q L at C_I = 1/2, its error, and whether it is a bound, each [point]: 1 where the curve
        stays above 1/2, 2 where it stays below."""
        return *self.measured(method, "memory_effect_range"), self.of(method, "range_censored")

    def has_bounds(self):
        return any((self.ranges(method)[2][self.rows] > 0).any() for method in self.prefixes)

    def has_few_steps(self):
        return any(self.few_steps(method)[self.rows].any() for method in self.prefixes)

    def refuse(self, why, *few):
        """Refuses what a picture cannot show: few are (name, how many of its values it could)."""
        choice = " ".join(self.example(name, count) for name, count in few)
        advice = f"; try --select {choice}" if few else ""
        raise style.Unusable(f"{self.path}: {why}{advice}")

    def refuse_others(self, others, shown):
        """Refuses what varies besides what is shown."""
        if others:
            self.refuse(f"besides {shown} it varies {', '.join(others)}", (others[0], 1))

    def values(self, name):
        """The different values of a parameter among the selected points."""
        return np.unique(self.columns[name][self.rows])

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
                near = np.isclose(column[:, None], np.array(text.split(","), float), rtol=1e-4, atol=0)
            except ValueError:
                raise style.Unusable(f"--select {choice}: should be AXIS=VALUE,VALUE")
            if not near.any(axis=0).all():
                raise style.Unusable(f"--select {choice}: {self.path} has {name} = "
                                     f"{', '.join(style.short(np.unique(column)))}")
            self.rows = self.rows[near.any(axis=1)[self.rows]]
        if len(self.rows) == 0:
            self.refuse("no point has all that --select asks for")

    def column(self, name):
        if name not in self.columns:
            self.refuse(f"has no axis {name}; has {', '.join(self.columns)}")
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

    def few_steps(self, method):
        """Whether so few tilts lead to a point's range that its error is not to be trusted."""
        steps = self.optional(f"{self.prefixes[method]}range_steps")
        if steps is None:
            return np.zeros(self.columns["g"].shape, bool)
        return (steps < LEAST_STEPS) & (self.of(method, "range_censored") == 0)

    def single_scattering_range(self):
        """[q L at C_I = 1/2 of single scattering], empty if the tilts do not reach it; None if it
        is not in the file. It depends on the geometry alone."""
        if not self.result.has("single_scattering_range"):
            return None
        dataset = self.result.dataset("single_scattering_range")
        return [] if dataset.attrs.get("censored", 0) else [float(dataset[()])]

    def target(self, method):
        """The relative error that a method was to reach, or None where it stops otherwise."""
        return self.result.attribute("target_error", self.result.attribute("target_error"),
                                     group=self.prefixes[method].rstrip("/") or "/")


def columns_of(scales):
    """{name: its values [point]} of a grid over scales {name: values}."""
    grids = np.meshgrid(*scales.values(), indexing="ij")
    return {name: grid.ravel() for name, grid in zip(scales, grids)}


def text(name, value):
    return f"{NAMES[name]} = {value:.4g}"


SELECT = script.option("--select", nargs="+", metavar="AXIS=VALUE,VALUE",
                       help="draws these points alone: optical_depth=10 g=0,0.9")


def read(result, arguments):
    """A sweep, with what --select leaves of it."""
    sweep = Sweep(result)
    sweep.select(arguments.select)
    return sweep
