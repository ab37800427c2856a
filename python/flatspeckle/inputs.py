"""Arrays and tables as the files that the program reads. A file is named by its content."""

import hashlib
import io
import re

import h5py
import numpy as np
import xarray

from flatspeckle import cache, keys, program
from flatspeckle.errors import InputError
from flatspeckle.result import source_of

COLUMNS = re.compile(r"columns (\w+(?:, \w+)*)")
DATASET = re.compile(r"HDF5 (?:file )?with (\w+)")


def kept(content, ending):
    """The path of a file with this content."""
    folder = cache.folder() / "inputs"
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{hashlib.sha256(content).hexdigest()[:32]}{ending}"
    if not path.exists():
        cache.put(path, content)
    return str(path)


def csv(columns):
    """A table of named columns, as text that reads back as the same numbers."""
    rows = zip(*(np.asarray(values, float).ravel().tolist() for values in columns.values()), strict=True)
    lines = [",".join(columns), *(",".join(map(repr, row)) for row in rows)]
    return ("\n".join(lines) + "\n").encode()


def hdf5(name, parts):
    """A dataset, with what else there is as its attributes."""
    buffer = io.BytesIO()
    with h5py.File(buffer, "w", track_order=True) as file:
        dataset = file.create_dataset(name, data=np.asarray(parts[name], float), track_times=False)
        for attribute, value in parts.items():
            if attribute != name:
                dataset.attrs[attribute] = np.asarray(value, float)
    return buffer.getvalue()


def named_columns(key, values):
    """The columns of an array [row, column], in the order in which the key's help names them."""
    found = COLUMNS.search(" ".join(key.helps))
    names = found[1].split(", ") if found else []
    if values.ndim == 1:
        values = values[:, None] if len(names) == 1 else values[None, :]
    if names and values.ndim == 2 and values.shape[1] <= len(names):
        return dict(zip(names, values.T))
    if key.name in ("frames", "reference"):  # each column is one of a kind
        return {f"frame_{number}": column for number, column in enumerate(values.T)}
    raise InputError(f"{key.name} = array of shape {values.shape}: must be a table of named columns, "
                     f"{key.helps[0]}")


def is_array(value):
    """What is no text, number or path, but a table or grid."""
    return isinstance(value, (dict, np.ndarray, xarray.DataArray, xarray.Dataset)) or hasattr(value, "columns")


def shown(value):
    return f"array of shape {np.shape(value)}" if isinstance(value, np.ndarray) else type(value).__name__


def elsewhere(key):
    """Which subcommands take a table for a key of this name."""
    rows = {name: keys.keys_of(name).get(key.name) for name in program.table(program.path())["subcommands"]}
    found = [name for name, row in rows.items() if row and COLUMNS.search(" ".join(row.helps))]
    return f" here (in {' and '.join(found)} it does)" if found else ""


def source_of_dataset(key, value):
    try:
        return source_of(value)
    except InputError as problem:
        raise InputError(f"{key.name} = Dataset: {problem}") from None


def file_of(key, value):
    """The path of a file with a table, grid or result in it."""
    if isinstance(value, xarray.Dataset):
        return source_of_dataset(key, value)
    if key.words:
        raise InputError(f"{key.name} = {shown(value)}: takes no table{elsewhere(key)}; {key.accepted}")
    grid = DATASET.search(" ".join(key.helps))
    if grid and not (isinstance(value, dict) and grid[1] not in value):
        parts = value if isinstance(value, dict) else {grid[1]: value}
        return kept(hdf5(grid[1], parts), ".h5")
    if hasattr(value, "columns"):  # of pandas
        value = {name: value[name] for name in value.columns}
    columns = value if isinstance(value, dict) else named_columns(key, np.asarray(value))
    return kept(csv(columns), ".csv")
