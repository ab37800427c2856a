"""Reads the result file of a sweep as a table with one row per point, for a grid, an unfinished grid or a list of
points."""

from lib import script, style

import numpy as np

METHODS = {"mc": "Monte Carlo", "wave": "wave solver", "transport": "transport"}
PARAMETERS = ("density", "radius", "index", "optical_depth", "g", "albedo")
NAMES = {"density": "density", "radius": "radius", "index": "index", "optical_depth": "OD",
         "g": "$g$", "albedo": "albedo"}
# Fraction of all combinations of values above which a list is treated as a grid with missing points.
LEAST_FILLED = 0.25
LEAST_STEPS = 4  # tilts below the range, for which its error is reliable


class Sweep:
    """A sweep. `columns`: {parameter: its value at every point}. `axes`: the parameters that vary and do not follow
    from others, outermost first. `is_list`: whether the points do not form a grid. `rows`: the selected points."""

    def __init__(self, result):
        self.result, self.path = result, result.path
        self.prefixes = {method: f"{method}/" for method in METHODS
                         if result.has(f"{method}/memory_effect_range")} or {None: ""}
        grid = result.dataset(next(iter(self.prefixes.values())) + "memory_effect_range")
        if result.attribute("format", 1) < 2 or grid.ndim == 0:
            self.refuse("is not a sweep of this version of the program")
        if grid.size == 0:
            self.refuse("has no finished point")
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
        """Returns the parameters that a list of points specifies. g and albedo may instead follow from the radius and
        index of scatterers, and the optical depth from a density."""
        scatterer = self.scene.get("scatterer")
        known = {"g": scatterer == "hg", "albedo": scatterer in ("hg", "point"),
                 "optical_depth": "density" not in self.columns and
                 not self.scene.keys() & {"density", "count", "mean_free_path"}}
        return [name for name in PARAMETERS if name in self.columns and known.get(name, True)]

    def has_part_of_grid(self):
        """Whether a list is an unfinished grid or contains a large fraction of all combinations of its values. If a
        parameter differs at every point, no points can be connected."""
        counts, points = [len(self.values(name)) for name in self.axes], self.shape[0]
        fills = points >= LEAST_FILLED * np.prod(counts)
        return "points" not in self.scene or (fills and (len(counts) < 2 or max(counts) < points))

    def notes(self):
        """Returns the notes of every figure: missing points, and the values that all drawn points have in common."""
        common = [name for name in self.axes or self.given() if len(self.values(name)) == 1]
        return [*self.unfinished(), *([self.label(common, self.rows[0])] if common else [])]

    def unfinished(self):
        """Returns a list with a note on missing points, if there are any."""
        if self.result.attribute("complete", 1):
            return []
        lists = [np.size(self.scene.get(name, 0)) for name in PARAMETERS]
        identity = self.result.attribute("identity", "").splitlines()
        total = np.prod(lists) if "points" not in self.scene else \
            sum("=" in line and " = " not in line for line in identity)  # one line for each point
        return [f"unfinished: {self.shape[0]} of {total} points"]

    def table(self, name):
        """Returns a dataset [grid, ...] as [point, ...]."""
        values = self.result.values(name)
        if values.shape[:len(self.shape)] != self.shape:
            self.refuse(f"{name} does not have one value per point of the grid")
        return values.reshape(-1, *values.shape[len(self.shape):])

    def optional(self, name):
        return self.table(name) if self.result.has(name) else None

    def of(self, method, name):
        return self.table(self.prefixes[method] + name)

    def measured(self, method, name):
        """Returns the values of all points and their errors."""
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
        """Raises Unusable for a sweep that a figure cannot show. few: (parameter, number of its values that can be
        shown), for advice on --select."""
        choice = " ".join(self.example(name, count) for name, count in few)
        advice = f"; try --select {choice}" if few else ""
        raise style.Unusable(f"{self.path}: {why}{advice}")

    def refuse_others(self, others, shown):
        """Raises Unusable if parameters vary that the figure does not show."""
        if others:
            self.refuse(f"varies {', '.join(others)} besides {shown}", (others[0], 1))

    def values(self, name):
        """Returns the distinct values of a parameter among the selected points."""
        return np.unique(self.columns[name][self.rows])

    def example(self, name, count):
        """Returns an example of --select that keeps `count` values of a parameter."""
        values = self.values(name)
        kept = np.unique(np.linspace(0, len(values) - 1, count).round().astype(int))
        return f"{name}={','.join(f'{value:g}' for value in values[kept])}"

    def varying(self):
        """Returns the parameters that vary among the selected points."""
        return [name for name in self.axes if len(self.values(name)) > 1]

    def select(self, choices):
        """Keeps only the points that satisfy the choices AXIS=VALUE,VALUE."""
        for choice in choices or []:
            name, _, text = choice.partition("=")
            column = self.column(name)
            try:
                near = np.isclose(column[:, None], np.array(text.split(","), float), rtol=1e-4, atol=0)
            except ValueError:
                raise style.Unusable(f"--select {choice}: must have the form AXIS=VALUE,VALUE")
            if not near.any(axis=0).all():
                raise style.Unusable(f"--select {choice}: {self.path} has {name} = "
                                     f"{', '.join(style.short(np.unique(column)))}")
            self.rows = self.rows[near.any(axis=1)[self.rows]]
        if len(self.rows) == 0:
            self.refuse("no point satisfies all choices of --select")

    def column(self, name):
        if name not in self.columns:
            self.refuse(f"has no parameter {name}; has {', '.join(self.columns)}")
        return self.columns[name]

    def groups(self, name, rows):
        """Returns [(value, its rows)] for a parameter; [(None, rows)] if name is None."""
        if name is None:
            return [(None, rows)]
        column = self.columns[name][rows]
        return [(value, rows[column == value]) for value in np.unique(column)]

    def label(self, names, row):
        """Returns a label with the values of these parameters at a point."""
        return ", ".join(text(name, self.columns[name][row]) for name in names)

    def few_steps(self, method):
        """Returns for each point whether its range has too few tilts below it for a reliable error."""
        steps = self.optional(f"{self.prefixes[method]}range_steps")
        if steps is None:
            return np.zeros(self.columns["g"].shape, bool)
        return (steps < LEAST_STEPS) & (self.of(method, "range_censored") == 0)

    def single_scattering_range(self):
        """Returns [q L at C_I = 1/2] for single scattering; an empty list if the tilts do not reach it, None if it is
        not in the file. It depends only on the geometry."""
        if not self.result.has("single_scattering_range"):
            return None
        dataset = self.result.dataset("single_scattering_range")
        return [] if dataset.attrs.get("censored", 0) else [float(dataset[()])]

    def target(self, method):
        """Returns the target relative error of a method, or None if it has another stopping criterion."""
        return self.result.attribute("target_error", self.result.attribute("target_error"),
                                     group=self.prefixes[method].rstrip("/") or "/")


def columns_of(scales):
    """Returns {name: its values [point]} for a grid over scales {name: values}."""
    grids = np.meshgrid(*scales.values(), indexing="ij")
    return {name: grid.ravel() for name, grid in zip(scales, grids)}


def text(name, value):
    return f"{NAMES[name]} = {value:.4g}"


SELECT = script.option("--select", nargs="+", metavar="AXIS=VALUE,VALUE",
                       help="draw only these points, for example optical_depth=10 g=0,0.9")


def read(result, arguments):
    """Returns a sweep with the points chosen by --select."""
    sweep = Sweep(result)
    sweep.select(arguments.select)
    return sweep
