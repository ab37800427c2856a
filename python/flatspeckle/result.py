"""Results as xarray.Datasets: names, axes and units are those of the file (docs/format.md)."""

import os

import h5py
import numpy as np
import xarray

from flatspeckle.errors import InputError

STATES = "state"  # what --resume goes on from
OF_SCALES = {"CLASS", "NAME", "REFERENCE_LIST", "DIMENSION_LIST", "DIMENSION_LABELS"}


def plain(value):
    """Attributes as Python has them."""
    if isinstance(value, bytes):
        return value.decode()
    if isinstance(value, np.uint8):
        return bool(value)
    return value.item() if isinstance(value, np.generic) else value


def name_of(item):
    return item.name.lstrip("/")


def datasets(file):
    """All but the states."""
    found = []

    def add(name, item):
        if isinstance(item, h5py.Dataset) and STATES not in name.split("/"):
            found.append(item)

    file.visititems(add)
    return found


def is_scale(dataset):
    return h5py.h5ds.is_scale(dataset.id)


def dims(dataset):
    """Names of the axes: their scales, or of what has none a number."""
    if is_scale(dataset):
        return (name_of(dataset),)
    return tuple(name_of(axis[0]) if len(axis) else f"{name_of(dataset)}.{number}"
                 for number, axis in enumerate(dataset.dims))


def variable(dataset):
    values = dataset.asstr()[()] if h5py.check_string_dtype(dataset.dtype) else dataset[()]
    attributes = {name: plain(dataset.attrs[name]) for name in dataset.attrs if name not in OF_SCALES}
    return xarray.Variable(dims(dataset), values, attributes)


def read(path):
    """A result file (HDF5), or a placement (CSV), as a Dataset. What lies in groups keeps its full name,
    ds["mc/intensity"]; `group` takes one out. `encoding["source"]` is the file."""
    path = os.path.abspath(path)
    if not h5py.is_hdf5(path) and os.path.isfile(path):
        return read_placement(path)
    with h5py.File(path) as file:
        found = datasets(file)
        variables = {name_of(item): variable(item) for item in found}
        axes = [name_of(item) for item in found if is_scale(item)]
        attributes = {name: plain(value) for name, value in file.attrs.items()}
    result = xarray.Dataset({name: variables[name] for name in variables if name not in axes},
                            {name: variables[name] for name in axes}, attributes)
    result.encoding["source"] = path
    return result


def read_placement(path):
    try:
        with open(path) as file:
            names, *rows = [line.strip().split(",") for line in file if line.strip() and not line.startswith("#")]
        columns = np.array(rows, float).reshape(-1, len(names)).T
    except ValueError:
        raise InputError(f"path = {path}: is neither a result nor a placement as place writes it") from None
    result = xarray.Dataset({name: ("scatterer", column) for name, column in zip(names, columns)})
    result.encoding["source"] = path
    return result


def source_of(result):
    """The file that a Dataset was read from. Raises InputError for a part of it, and where it was changed."""
    path = result.encoding.get("source")
    if path is None or not os.path.isfile(path) or not holds(result, read(path)):
        raise InputError("a Dataset stands for its file as a run or read() returned it: this one is a part of it, was "
                         "computed from it, or was changed; draw parts with xarray's own .plot()")
    return path


def holds(result, whole):
    """Whether all that is in the file is in the Dataset, as it is there."""
    return all(name in result.variables and result.variables[name].equals(variable)
               for name, variable in whole.variables.items())


def group(result, name):
    """What one method, sensor or other group of a result found, by names without the group's:
    group(ds, "mc").intensity."""
    own = {full: full[len(name) + 1:] for full in result.variables if full.startswith(f"{name}/")}
    data = {full: short for full, short in own.items() if full in result.data_vars}
    if not data:
        groups = sorted({full.rsplit("/", 1)[0] for full in result.data_vars if "/" in full})
        raise KeyError(f"{name}: no such group; there are {', '.join(groups) or 'none'}")
    part = result[list(data)]
    part = part.rename({full: short for full, short in own.items() if full in part.variables})
    part.attrs, part.encoding["source"] = result.attrs, result.encoding.get("source")
    return part
