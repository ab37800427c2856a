"""Reads sweeps of another subcommand as tables with a row for each point, for grids and lists of points."""

import re

from lib import labels
from lib.result_file import Unusable
from lib.sweep_file import columns_of

import h5py
import numpy as np

HIDDEN = ("_error", "_limit", "_rare", "_censored", "_s", "samples")  # endings of datasets that are not results


def keys_of(result):
    """Returns the names of the datasets of the keys that vary."""
    return [key.replace(".", "_") for key in result.swept()]


def names_of_numbers(result):
    """Returns the names of datasets with one number for each point, and NAME[i] for those with several."""
    names, keys, points = [], keys_of(result), result.dataset("samples").shape

    def add(name, item):
        if isinstance(item, h5py.Dataset) and item.shape[:len(points)] == points and item.dtype.kind == "f" \
                and name not in keys and not name.endswith(HIDDEN) and not name.startswith("state") \
                and item.attrs.get("CLASS") != b"DIMENSION_SCALE":
            if item.ndim == len(points):
                names.append(name)
            elif item.ndim == len(points) + 1:
                last = item.shape[-1] - 1
                names.append(f"{name}[0]" + (f" to {name}[{last}]" if last else ""))

    result.file.visititems(add)
    return names


class Number:
    """A number for each point of a sweep: the dataset NAME, or NAME[i], which is number i of several at each point.
    columns: {key: its values [point]}."""

    def __init__(self, result, name):
        if not result.swept():
            raise Unusable(f"{result.path}: is not a sweep of another subcommand")
        found = re.fullmatch(r"(.*?)(?:\[(\d+)\])?", name)
        self.result, self.name, self.path = result, name, found[1]
        self.entry = None if found[2] is None else int(found[2])
        if not result.has(self.path):
            raise Unusable(f"{result.path}: has no dataset {name}; --value must be one of "
                           f"{', '.join(names_of_numbers(result))}")
        rank = result.dataset(self.path).ndim - (self.entry is not None)
        scales = dict(result.scale(self.path, axis) for axis in range(rank))
        is_list = next(iter(scales), "") in ("point", "swept_point")
        self.columns = {key: result.values(key) for key in keys_of(result)} if is_list else \
            columns_of(scales)

    def of(self, path):
        """Returns the number itself, its error or its derivatives: [point, ...]."""
        values, rank = self.result.values(path), self.result.dataset("samples").ndim
        if self.entry is not None:
            if values.ndim == rank or self.entry >= values.shape[-1]:
                raise Unusable(f"{self.result.path}: {path} has no number {self.entry} at each point")
            values = values[..., self.entry]
        return values.reshape(-1, *values.shape[rank:])

    def known(self, values):
        """Returns the values with NaN where only a bound of a range is known."""
        name = f"{self.path}_censored"
        if self.result.has(name):
            values = np.where(self.of(name) == 0, values, np.nan)
        elif self.result.dataset(self.path).attrs.get("censored", 0):
            values = np.full(values.shape, np.nan)
        if np.isnan(values).all():
            raise Unusable(f"{self.result.path}: {self.name} is only a bound at all points; give larger or smaller tilts")
        return values

    def values(self):
        return self.known(self.of(self.path))

    def errors(self):
        name = f"{self.path}_error"
        return self.known(self.of(name)) if self.result.has(name) else np.zeros_like(self.of(self.path))

    def derivatives(self, key):
        """Returns the derivatives with respect to a key, [point], or None."""
        name = f"{self.path}_gradient"
        parameters = list(self.result.dataset("parameter").attrs["names"]) if self.result.has(name) else []
        return self.of(name)[:, parameters.index(key)] if key in parameters else None

    def label(self):
        """Returns a label with the unit and, for one of several numbers, its coordinate."""
        dataset = self.result.dataset(self.path)
        scales = [] if self.entry is None else list(dataset.dims[dataset.ndim - 1].values())
        text = self.name if not scales else (f"{self.path}, {scales[0].name.split('/')[-1].replace('_', ' ')} "
                                             f"{scales[0][self.entry]:.3g}")
        return labels.with_unit(text, self.result.unit(self.path))
