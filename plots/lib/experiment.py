"""Sweeps of another subcommand: a row for each point, whether the points are a grid or a list."""

import re

from lib import labels
from lib.result_file import Unusable
from lib.sweep_file import columns_of

import h5py
import numpy as np

HIDDEN = ("_error", "_rare", "_s", "samples")  # endings of datasets that are no results


def keys_of(result):
    """Names of the scales of the keys that vary."""
    return [key.replace(".", "_") for key in result.swept()]


def names_of_numbers(result):
    """Datasets with one number for each point."""
    names, keys = [], keys_of(result)

    def add(name, item):
        if isinstance(item, h5py.Dataset) and 0 < item.ndim <= max(1, len(keys)) and item.dtype.kind == "f" \
                and name not in keys and not name.endswith(HIDDEN) and not name.startswith("state") \
                and item.attrs.get("CLASS") != b"DIMENSION_SCALE":
            names.append(name)

    result.file.visititems(add)
    return names


class Number:
    """A number of each point of a sweep: a dataset NAME, or NAME[i], the i-th of several numbers.
    columns: {key: its values [point]}."""

    def __init__(self, result, name):
        if not result.swept():
            raise Unusable(f"{result.path}: no sweep of another subcommand")
        found = re.fullmatch(r"(.*?)(?:\[(\d+)\])?", name)
        self.result, self.name, self.path = result, name, found[1]
        self.entry = None if found[2] is None else int(found[2])
        if not result.has(self.path):
            raise Unusable(f"{result.path}: has no dataset {name}; --value takes one of "
                           f"{', '.join(names_of_numbers(result))}, or one of several numbers at each "
                           "point, as power_within[0]")
        rank = result.dataset(self.path).ndim - (self.entry is not None)
        scales = dict(result.scale(self.path, axis) for axis in range(rank))
        is_list = next(iter(scales), "") in ("point", "swept_point")
        self.columns = {key: result.values(key) for key in keys_of(result)} if is_list else \
            columns_of(scales)

    def of(self, path):
        """The number itself, its error or derivatives: [point, ...]."""
        values, rank = self.result.values(path), self.result.dataset("samples").ndim
        if self.entry is not None:
            if values.ndim == rank or self.entry >= values.shape[-1]:
                raise Unusable(f"{self.result.path}: {path} has no number {self.entry} at each point")
            values = values[..., self.entry]
        return values.reshape(-1, *values.shape[rank:])

    def values(self):
        return self.of(self.path)

    def errors(self):
        name = f"{self.path}_error"
        return self.of(name) if self.result.has(name) else np.zeros_like(self.values())

    def derivatives(self, key):
        """By a key [point], or None."""
        name = f"{self.path}_gradient"
        parameters = list(self.result.dataset("parameter").attrs["names"]) if self.result.has(name) else []
        return self.of(name)[:, parameters.index(key)] if key in parameters else None

    def label(self):
        """With its unit, and where it is one of several numbers."""
        dataset = self.result.dataset(self.path)
        scales = [] if self.entry is None else list(dataset.dims[dataset.ndim - 1].values())
        text = self.name if not scales else (f"{self.path}, {scales[0].name.split('/')[-1].replace('_', ' ')} "
                                             f"{scales[0][self.entry]:.3g}")
        return labels.with_unit(text, self.result.unit(self.path))
