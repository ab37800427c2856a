"""Reading of result files, with one clear complaint about whatever is missing."""

import functools
import pathlib
import tomllib

import h5py
import numpy as np


class Unusable(Exception):
    """A result file without what the plot needs; the message says which file and what."""


def complaint(path):
    """Why there is no result at a path."""
    path = path.rstrip("/")
    folder = path if path.endswith(".shards") else f"{path}.shards"
    if pathlib.Path(path).is_file():
        return f"{path}: not a readable result file"
    if pathlib.Path(folder).is_dir():
        return (f"{path}: {'no file' if path == folder else 'no such file'}; flatspeckle merge "
                f"--partial --out NOW.h5 --shards {folder} makes a file of the points so far")
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
        """Path of a dataset in the file."""
        return name

    def has(self, name):
        return self.locate(name) in self.file

    def require(self, name, hint=""):
        """Refuses a result without a dataset; the hint says what makes it."""
        if not isinstance(self.file.get(self.locate(name)), h5py.Dataset):
            why = ("is not complete: the same command with --resume goes on; "
                   if self.attribute("complete") == 0 or set(self.file) == {"state"} else "")
            raise Unusable(f"{self.path}: {why}has no dataset {name}" + (f"; {hint}" if hint else ""))

    def dataset(self, name):
        self.require(name)
        return self.file[self.locate(name)]

    def values(self, name):
        return self.dataset(name)[...]

    def measured(self, name):
        """Values of a dataset and their errors."""
        return self.values(name), self.values(f"{name}_error")

    def texts(self, name):
        return [text.decode() for text in self.values(name)]

    def scale(self, name, number):
        """Name and values of the scale of one axis of a dataset."""
        dimension = self.dataset(name).dims[number]
        if len(dimension) == 0:
            raise Unusable(f"{self.path}: axis {number} of {name} has no scale")
        return dimension[0].name.split("/")[-1], dimension[0][...]

    def axis(self, name, number):
        """Values of the scale of one axis of a dataset."""
        return self.scale(name, number)[1]

    def attribute(self, name, default=None, group="/"):
        return self.file[group].attrs.get(name, default)

    def unit(self, name):
        """The unit of a dataset; nothing where it has none."""
        unit = self.dataset(name).attrs.get("units", "")
        return "" if unit == "1" else unit

    @functools.cached_property
    def scene(self):
        """The resolved keys, as the file has them: {key: value}."""
        return tomllib.loads(self.attribute("config", ""))

    def swept(self):
        """Keys that vary in a sweep of another subcommand; none of other results."""
        return list(self.attribute("swept", [])) if self.attribute("of") else []


class Table(np.ndarray):
    """The rows of a table; `path` is its file."""


def read_table(path, columns=()):
    """A CSV table with a line of names: [row], each column by its name. Lines that begin with # are
    comments. Refuses one without rows, or without some columns."""
    try:
        with open(path, encoding="utf-8-sig") as file:
            lines = [line for line in file if not line.startswith("#")]
        if len(lines) < 2:
            raise Unusable(f"{path}: has no rows")
        table = np.atleast_1d(np.genfromtxt(lines, delimiter=",", names=True, dtype=None, encoding="utf-8")).view(Table)
    except (ValueError, TypeError, IndexError):
        raise Unusable(f"{path}: is no CSV table")
    lacking = [name for name in columns if name not in (table.dtype.names or ())]
    if lacking:
        raise Unusable(f"{path}: has no column {', '.join(lacking)}")
    table.path = path
    return table
