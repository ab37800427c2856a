"""Reads result files and reports missing contents in one line."""

import functools
import pathlib
import tomllib

import h5py
import numpy as np


class Unusable(Exception):
    """Raised if a result file lacks data that the plot needs; the message names the file and the data."""


def complaint(path):
    """Returns the reason why there is no result at a path."""
    path = path.rstrip("/")
    folder = path if path.endswith(".shards") else f"{path}.shards"
    if pathlib.Path(path).is_file():
        return f"{path}: not a readable result file"
    if pathlib.Path(folder).is_dir():
        return (f"{path}: {'no file' if path == folder else 'no such file'}; flatspeckle merge "
                f"--partial --out NOW.h5 --shards {folder} writes a file of the points finished so far")
    return f"{path}: {'a folder' if pathlib.Path(path).is_dir() else 'no such file'}"


class Result:
    """A result file."""

    def __init__(self, path):
        self.path = path
        try:
            self.file = h5py.File(path, "r")
        except OSError:
            raise Unusable(complaint(path))

    def locate(self, name):
        """Returns the path of a dataset in the file."""
        return name

    def has(self, name):
        return self.locate(name) in self.file

    def require(self, name, hint=""):
        """Raises Unusable if a dataset is missing; the hint names the option that produces it."""
        if not isinstance(self.file.get(self.locate(name)), h5py.Dataset):
            why = ("is not complete (the same command with --resume continues it); "
                   if self.attribute("complete") == 0 or set(self.file) == {"state"} else "")
            raise Unusable(f"{self.path}: {why}has no dataset {name}" + (f"; {hint}" if hint else ""))

    def dataset(self, name):
        self.require(name)
        return self.file[self.locate(name)]

    def values(self, name):
        return self.dataset(name)[...]

    def measured(self, name):
        """Returns the values of a dataset and their errors."""
        return self.values(name), self.values(f"{name}_error")

    def texts(self, name):
        return [text.decode() for text in self.values(name)]

    def scale(self, name, number):
        """Returns name and values of the scale of one axis of a dataset."""
        dimension = self.dataset(name).dims[number]
        if len(dimension) == 0:
            raise Unusable(f"{self.path}: axis {number} of {name} has no scale")
        return dimension[0].name.split("/")[-1], dimension[0][...]

    def axis(self, name, number):
        """Returns the values of the scale of one axis of a dataset."""
        return self.scale(name, number)[1]

    def attribute(self, name, default=None, group="/"):
        return self.file[group].attrs.get(name, default)

    def unit(self, name):
        """Returns the unit of a dataset; an empty text if it has none."""
        unit = self.dataset(name).attrs.get("units", "")
        return "" if unit == "1" else unit

    @functools.cached_property
    def scene(self):
        """Returns the resolved keys of the run, {key: value}."""
        return tomllib.loads(self.attribute("config", ""))

    def swept(self):
        """Returns the keys that vary in a sweep of another subcommand; an empty list for other results."""
        return list(self.attribute("swept", [])) if self.attribute("of") else []


class Table(np.ndarray):
    """Rows of a table; `path` is its file."""


def read_table(path, columns=()):
    """Reads a CSV table whose first line contains the names of columns; returns [row] with named columns. Lines that
    begin with # are comments. Raises Unusable if there are no rows or columns are missing."""
    try:
        with open(path, encoding="utf-8-sig") as file:
            lines = [line for line in file if not line.startswith("#")]
        if len(lines) < 2:
            raise Unusable(f"{path}: has no rows")
        table = np.atleast_1d(np.genfromtxt(lines, delimiter=",", names=True, dtype=None, encoding="utf-8")).view(Table)
    except (ValueError, TypeError, IndexError):
        raise Unusable(f"{path}: is no CSV table with equally long rows")
    lacking = [name for name in columns if name not in (table.dtype.names or ())]
    if lacking:
        raise Unusable(f"{path}: has no column {', '.join(lacking)}")
    table.path = path
    return table
