"""The three result files of `flatspeckle bench` as lists of rows."""

import dataclasses

import h5py
import numpy as np

from lib.result_file import Result


def rows_of(result, columns):
    """A list of {name: value}, one for each row of the columns."""
    found = {}
    for name in columns:
        is_text = h5py.check_string_dtype(result.dataset(name).dtype)
        found[name] = result.texts(name) if is_text else result.values(name).tolist()
    return [dict(zip(found, values)) for values in zip(*found.values())]


@dataclasses.dataclass
class Made:
    """How a file was made."""
    command: str
    version: str
    commit: str
    machine: str
    threads: int
    started: str
    wall_s: float
    cpu_s: float
    quick: bool

    @property
    def date(self):
        return self.started[:10]

    @property
    def short_commit(self):
        """Its first digits, and whether files differed from it."""
        digits, plus, _ = self.commit.partition("+")
        return digits[:10] + (" with changes" if plus else "")


def made(result):
    text = lambda name: str(result.attribute(name, ""))
    return Made(text("command_line"), text("version"), text("git_commit"), text("machine"),
                int(result.attribute("threads", 0)), text("started"),
                float(result.attribute("wall_s", 0)), float(result.attribute("cpu_s", 0)),
                "quick = true" in text("config"))


def points_of(result, axis, number, count):
    """Columns of the points of each curve: [{name: array}]."""
    columns = {name: result.values(name) for name in axis}
    owner = result.values(number)
    return [{name: values[owner == curve] for name, values in columns.items()}
            for curve in range(count)]


class ErrorFile:
    def __init__(self, result):
        self.made = made(result)
        self.curves = rows_of(result, ["scene", "method", "reference", "reference_uncertainty",
                                       "slope", "slope_error", "efficiency", "is_monte_carlo"])
        columns = ["cpu_s", "samples", "relative_error", "relative_error_error"]
        for curve, points in zip(self.curves, points_of(result, columns, "of_curve",
                                                        len(self.curves))):
            curve.update(points)
        self.costs = rows_of(result, ["task", "size_name", "cost_name", "exponent",
                                      "exponent_error", "expected_exponent"])
        for cost, points in zip(self.costs, points_of(result, ["size", "cost_value"], "of_cost",
                                                      len(self.costs))):
            cost.update(points)

    def scenes(self):
        """In the order of the file."""
        return list(dict.fromkeys(curve["scene"] for curve in self.curves))

    def of_scene(self, scene):
        return [curve for curve in self.curves if curve["scene"] == scene]

    def monte_carlo(self):
        return [curve for curve in self.curves if curve["is_monte_carlo"]]


class RowFile:
    """Of stability or plan."""

    def __init__(self, result, columns):
        self.made = made(result)
        self.rows = rows_of(result, ["room", *columns, "passed"])

    def rooms(self):
        return list(dict.fromkeys(row["room"] for row in self.rows))

    def of_room(self, room):
        return [row for row in self.rows if row["room"] == room]

    def failed(self):
        return [row for row in self.rows if not row["passed"]]


def read_stability(result):
    return RowFile(result, ["name", "invariant", "must_say", "refusal", "figure", "limit", "cpu_s"])


def read_plan(result):
    return RowFile(result, ["left_out", "scene", "per", "general_s", "special_s", "ratio",
                            "ratio_spread", "difference", "difference_in", "limit"])


@dataclasses.dataclass
class Bench:
    error: ErrorFile
    stability: RowFile
    plan: RowFile

    def files(self):
        return {"error": self.error, "stability": self.stability, "plan": self.plan}


def read_bench(error, stability, plan):
    return Bench(ErrorFile(Result(error)), read_stability(Result(stability)),
                 read_plan(Result(plan)))
