"""Reads results as xarray.Datasets with the names, axes and units of the file (docs/format.md)."""

import os

import h5py
import numpy as np
import xarray

from flatspeckle.errors import InputError

STATES = "state"  # name of groups with the state of a run, from which --resume continues
OF_SCALES = {"CLASS", "NAME", "REFERENCE_LIST", "DIMENSION_LIST", "DIMENSION_LABELS"}


def plain(value):
    """Returns an attribute as a Python value."""
    if isinstance(value, bytes):
        return value.decode()
    if isinstance(value, np.uint8):
        return bool(value)
    return value.item() if isinstance(value, np.generic) else value


def name_of(item):
    return item.name.lstrip("/")


def datasets(file):
    """Returns all datasets except those in the state of a run."""
    found = []

    def add(name, item):
        if isinstance(item, h5py.Dataset) and STATES not in name.split("/"):
            found.append(item)

    file.visititems(add)
    return found


def is_scale(dataset):
    return h5py.h5ds.is_scale(dataset.id)


def dims(dataset):
    """Returns the names of a dataset's axes: the name of the axis's scale, or the dataset's name with a number for
    axes without a scale."""
    if is_scale(dataset):
        return (name_of(dataset),)
    return tuple(name_of(axis[0]) if len(axis) else f"{name_of(dataset)}.{number}"
                 for number, axis in enumerate(dataset.dims))


def variable(dataset):
    values = dataset.asstr()[()] if h5py.check_string_dtype(dataset.dtype) else dataset[()]
    attributes = {name: plain(dataset.attrs[name]) for name in dataset.attrs if name not in OF_SCALES}
    return xarray.Variable(dims(dataset), values, attributes)


def censoring(variables, name):
    """Returns the marks of a range (docs/format.md, `censored`): 0 where it is known, 1 where only a lower bound is
    known, 2 where an upper one; None for other variables."""
    group = name[:name.rfind("/") + 1]
    of_curves = variables.get(f"{group}range_censored") if name == f"{group}memory_effect_range" else None
    marks = variables.get(f"{name}_censored", of_curves)
    if marks is None and "censored" in variables[name].attrs:
        return np.full(variables[name].shape, variables[name].attrs["censored"])
    return None if marks is None or marks.shape != variables[name].shape else marks.values


def with_bounds(variables):
    """Returns the variables with NaN for the value and error of each range of which only a bound is known. The bounds
    are in the variables NAME_at_least and NAME_at_most, which are NaN elsewhere."""
    result = dict(variables)
    for name, variable in variables.items():
        marks = censoring(variables, name)
        if marks is None:
            continue
        for own in (name, f"{name}_error"):
            if own in variables:
                result[own] = variables[own].copy(data=np.where(marks == 0, variables[own].values, np.nan))
        for mark, ending, kind in ((1, "at_least", "lower"), (2, "at_most", "upper")):
            attributes = {key: value for key, value in variable.attrs.items() if key == "units"}
            attributes["long_name"] = f"{kind} bound: {variable.attrs.get('long_name', name)}"
            result[f"{name}_{ending}"] = xarray.Variable(
                variable.dims, np.where(marks == mark, variable.values, np.nan), attributes)
    return result


def read(path):
    """Reads a result file (HDF5), or a placement (CSV), as a Dataset. Variables in groups keep their full names, as
    in ds["mc/intensity"]; `group` extracts the variables of one group. A range of which only a bound is known is NaN,
    and the bound is in NAME_at_least or NAME_at_most. `encoding["source"]` is the path of the file."""
    path = os.path.abspath(path)
    if not h5py.is_hdf5(path) and os.path.isfile(path):
        return read_placement(path)
    with h5py.File(path) as file:
        found = datasets(file)
        variables = with_bounds({name_of(item): variable(item) for item in found})
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
        raise InputError(f"path = {path}: must be a result file, or a placement written by `place`") from None
    result = xarray.Dataset({name: ("scatterer", column) for name, column in zip(names, columns)})
    result.encoding["source"] = path
    return result


def source_of(result):
    """Returns the file from which a Dataset was read. Raises InputError if the Dataset is a part of the file's
    contents or was changed."""
    path = result.encoding.get("source")
    if path is None or not os.path.isfile(path) or not holds(result, read(path)):
        raise InputError("a Dataset must be as returned by a run or by read(), because its file is used: this one "
                         "is a part of it, was computed from it, or was changed; draw parts with xarray's own .plot()")
    return path


def holds(result, whole):
    """Whether the Dataset contains all variables of the file unchanged."""
    return all(name in result.variables and result.variables[name].equals(variable)
               for name, variable in whole.variables.items())


def group(result, name):
    """Returns the variables of one group of a result, such as a method or sensor. Their names omit the name of the
    group, as in group(ds, "mc").intensity."""
    own = {full: full[len(name) + 1:] for full in result.variables if full.startswith(f"{name}/")}
    data = {full: short for full, short in own.items() if full in result.data_vars}
    if not data:
        groups = sorted({full.rsplit("/", 1)[0] for full in result.data_vars if "/" in full})
        raise KeyError(f"{name}: no such group; the result has {', '.join(groups) or 'none'}")
    part = result[list(data)]
    part = part.rename({full: short for full, short in own.items() if full in part.variables})
    part.attrs, part.encoding["source"] = result.attrs, result.encoding.get("source")
    return part
