"""Reads the three result files of `flatspeckle bench` as lists of rows."""

from dataclasses import dataclass

from lib.result_file import Result

import h5py


def rows_of(result, *columns):
    """Returns {name: value} for each row of the columns."""
    found = [result.texts(name) if h5py.check_string_dtype(result.dataset(name).dtype) else
             result.values(name).tolist() for name in columns]
    return [dict(zip(columns, values)) for values in zip(*found)]


def add_points(result, rows, owner, *columns):
    """Adds to each row the columns of its points, {name: array}. owner: dataset with the number of the row to which
    each point belongs."""
    for number, row in enumerate(rows):
        own = result.values(owner) == number
        row.update({name: result.values(name)[own] for name in columns})


class Made:
    """Origin of a file: version, machine, date and run time."""

    def __init__(self, result):
        text = lambda name: str(result.attribute(name, ""))
        self.version, self.commit, self.machine = map(text, ("version", "git_commit", "machine"))
        self.threads = int(result.attribute("threads", 0))
        self.wall_s, self.cpu_s = (float(result.attribute(name, 0)) for name in ("wall_s", "cpu_s"))
        self.date, self.quick = text("started")[:10], "quick = true" in text("config")
        digits, plus, _ = self.commit.partition("+")  # "+" means that files differed from the commit
        self.short_commit = digits[:10] + (" with changes" if plus else "")


class ErrorFile:
    def __init__(self, result):
        self.made = Made(result)
        self.curves = rows_of(result, "scene", "method", "reference", "reference_uncertainty", "slope",
                              "slope_error", "efficiency", "is_monte_carlo")
        add_points(result, self.curves, "of_curve", "cpu_s", "samples", "relative_error",
                   "relative_error_error")
        self.costs = rows_of(result, "task", "size_name", "cost_name", "exponent", "exponent_error",
                             "expected_exponent")
        add_points(result, self.costs, "of_cost", "size", "cost_value")

    def scenes(self):
        """Returns the scenes in the order of the file."""
        return list(dict.fromkeys(curve["scene"] for curve in self.curves))

    def of_scene(self, scene):
        return [curve for curve in self.curves if curve["scene"] == scene]

    def monte_carlo(self):
        return [curve for curve in self.curves if curve["is_monte_carlo"]]


class RowFile:
    """Rows of a result of `bench stability` or `bench plan`."""

    def __init__(self, result, *columns):
        self.made = Made(result)
        self.rows = rows_of(result, "module", *columns, "passed")

    def modules(self):
        return list(dict.fromkeys(row["module"] for row in self.rows))

    def of_module(self, module):
        return [row for row in self.rows if row["module"] == module]

    def failed(self):
        return [row for row in self.rows if not row["passed"]]


@dataclass
class Bench:
    error: ErrorFile
    stability: RowFile
    plan: RowFile

    def files(self):
        return {"error": self.error, "stability": self.stability, "plan": self.plan}


def read_bench(error, stability, plan):
    """Reads the three files, given by their paths."""
    return Bench(ErrorFile(Result(error)),
                 RowFile(Result(stability), "name", "invariant", "must_say", "refusal", "figure", "limit"),
                 RowFile(Result(plan), "left_out", "scene", "per", "general_s", "special_s", "ratio",
                         "ratio_spread", "difference", "difference_in", "limit"))
