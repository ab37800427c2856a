"""Writes arrays and tables to files that the program can read. The name of such a file is a hash of its content."""

import functools
import hashlib
import io
import os
import re

import h5py
import numpy as np
import xarray

from flatspeckle import cache, keys, program
from flatspeckle.errors import InputError
from flatspeckle.result import source_of

COLUMNS = re.compile(r"columns (\w+\b(?! [a-z])(?:(?:, | \[, )\w+\b(?! [a-z]))*)")
DATASET = re.compile(r"HDF5 (?:file )?with (?:its dataset )?(\w+)\b(?!/)")
TABLE = re.compile(r"\bCSV\b|\btables\b")
PICTURES = "Square pictures"
FRAMES = ("frames", "reference", "dark", "flat")
FILES = re.compile(r"\bCSV\b|^Files|or a file|results of fits")
WORDS_OR_FILES = ("placement", "structure")


def refuse(name, value, accepted):
    """Raises InputError with a message that shows the value, shortened to one line."""
    shown = f"array of shape {np.shape(value)}" if isinstance(value, np.ndarray) else (
        type(value).__name__ if is_array(value) else repr(value))
    raise InputError(f"{name} = {shown if len(shown) < 80 else shown[:80] + '...'}: {accepted}".replace("\n", " "))


def kept(content, ending):
    """Writes a file with this content, unless it exists, and returns its path."""
    folder = cache.folder() / "inputs"
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{hashlib.sha256(content).hexdigest()[:32]}{ending}"
    if not path.exists():
        cache.put(path, content)
    return str(path)


def without_mask(name, values):
    """Returns the values unchanged. Raises InputError if any is masked."""
    if np.ma.is_masked(values):
        refuse(name, values, "has masked values: remove or fill them")
    if isinstance(values, (list, tuple)):
        for one in values:
            without_mask(name, one)
    return values


def numbers(name, values):
    """Returns an array of real numbers. Raises InputError for other values."""
    without_mask(name, values)
    try:
        array = np.asarray(values, float)
    except (TypeError, ValueError, OverflowError):
        refuse(name, values, "must be an array of real numbers with rows of equal length")
    if array.size == 0 or not np.isfinite(array).all():
        refuse(name, values, "must be a non-empty array of finite numbers")
    return array


def rows(name, array):
    """Returns a table without column names as CSV text. Reading it gives exactly the same numbers."""
    array = numbers(name, array)
    if array.ndim != 2:
        refuse(name, array, "must have two axes, rows and columns")
    return "".join(",".join(map(repr, row)) + "\n" for row in array.tolist())


def csv(name, columns):
    """Returns a table of named columns as CSV text. Reading it gives exactly the same numbers."""
    arrays = {str(title): numbers(name, values) for title, values in columns.items()}
    shapes = {array.shape for array in arrays.values()}
    if len(shapes) != 1 or any(len(shape) != 1 for shape in shapes):
        sizes = ", ".join(f"{title} {'x'.join(map(str, array.shape)) or 'one number'}" for title, array in arrays.items())
        refuse(name, columns, f"must have columns of equal length; has {sizes or 'none'}")
    titles = ",".join('"' + title.replace('"', '""') + '"' if re.search(r'[,;"\s]', title) else title for title in arrays)
    return (titles + "\n" + rows(name, np.stack(list(arrays.values()), 1))).encode()


def hdf5(key, name, parts):
    """Returns the content of an HDF5 file with the dataset `name`; all other parts are its attributes."""
    buffer = io.BytesIO()
    with h5py.File(buffer, "w", track_order=True) as file:
        dataset = file.create_dataset(name, data=numbers(key.name, parts[name]), track_times=False)
        for attribute, value in parts.items():
            if attribute != name:
                dataset.attrs[attribute] = numbers(key.name, value)
    return buffer.getvalue()


def names_of_columns(key):
    """Returns the names of columns in the key's help, in order, including optional columns."""
    found = COLUMNS.search(" ".join(key.helps))
    return re.findall(r"\w+", found[1]) if found else []


def frames_file(key, values):
    """Returns the path of a file of frames: lines of pixels as CSV, pictures as NPY."""
    array = numbers(key.name, values)
    is_list = isinstance(values, (list, tuple))
    if key.name in ("dark", "flat"):
        if array.ndim not in (2, 3):
            refuse(key.name, array, "must have two axes (rows, columns) or three (frames, rows, columns)")
    elif array.ndim == 1 or (array.ndim == 2 and is_list):
        lines = np.atleast_2d(array)
        return kept(csv(key.name, {f"frame_{number}": line for number, line in enumerate(lines)}), ".csv")
    elif array.ndim != 3:
        refuse(key.name, array, "must be a list of frames (lines of pixels, or pictures), one line of pixels, or have "
                                "three axes (frames, rows, columns)")
    buffer = io.BytesIO()
    np.save(buffer, np.ascontiguousarray(array))
    return kept(buffer.getvalue(), ".npy")


def named_columns(key, values):
    """Returns {name: column} for an array [row, column]."""
    names, values = names_of_columns(key), numbers(key.name, values)
    if values.ndim == 1:
        values = values[:, None] if len(names) == 1 else values[None, :]
    if names and values.ndim == 2 and values.shape[1] <= len(names):
        return dict(zip(names, values.T))
    refuse(key.name, values, f"must be a table of named columns, {key.helps[0]}")


def is_array(value):
    """Whether a value is a table or grid, and not a text, a number or a path."""
    return isinstance(value, (dict, np.ndarray, xarray.DataArray, xarray.Dataset)) or hasattr(value, "columns") or (
        hasattr(value, "to_numpy") and hasattr(value, "index"))  # pandas


def elsewhere(key):
    """Returns a note that names the subcommands in which a key of this name accepts a table."""
    rows = {name: keys.keys_of(name).get(key.name) for name in program.table(program.path())["subcommands"]}
    found = [name for name, row in rows.items() if row and names_of_columns(row)]
    return f" here (in {' and '.join(found)} it does)" if found else ""


def source_of_dataset(key, value):
    try:
        return source_of(value)
    except InputError as problem:
        raise InputError(f"{key.name} = Dataset: {problem}") from None


def file_of(key, value):
    """Returns the path of a file that contains this table, grid or result."""
    if isinstance(value, xarray.Dataset):
        return source_of_dataset(key, value)
    helps = " ".join(key.helps)
    if key.name in FRAMES and not (isinstance(value, dict) or hasattr(value, "columns")):
        return frames_file(key, value)
    if key.words:
        refuse(key.name, value, f"takes no table{elsewhere(key)}; {key.accepted}")
    if helps.startswith(PICTURES):
        return kept(rows(key.name, value).encode(), ".csv")
    if grid := DATASET.search(helps):
        parts = value if isinstance(value, dict) else {grid[1]: value}
        if grid[1] not in parts:
            refuse(key.name, value, f"must have {grid[1]}, has {', '.join(map(str, parts)) or 'nothing'}; {key.helps[0]}")
        return kept(hdf5(key, grid[1], parts), ".h5")
    if not TABLE.search(helps):
        refuse(key.name, value, f"takes no array; {key.helps[0]}")
    if hasattr(value, "columns"):  # pandas
        value = {name: value[name] for name in value.columns}
    return kept(csv(key.name, value if isinstance(value, dict) else named_columns(key, value)), ".csv")


def names_a_file(key, text):
    """Whether the program interprets this value as the name of a file."""
    if key.name in WORDS_OR_FILES and not ("." in text or os.sep in text):
        return False
    is_input = not key.words and key.type is str and FILES.search(" ".join(key.helps))
    return key.is_file or bool(is_input and key.name != "out" and not key.helps[0].startswith("Result file"))


@functools.cache
def file_keys(path):
    """Returns the names of all keys, of any subcommand, whose values may be names of files."""
    table = program.table(path)["subcommands"]
    return {name for one in table for name, key in keys.read_keys(path, one).items() if names_a_file(key, os.sep)}


def paths(key, texts, folder):
    """Returns the texts with absolute paths of files. Paths relative to the scene file were already resolved. Raises
    InputError for a missing file."""
    for text in [texts] if isinstance(texts, str) else texts:
        if names_a_file(key, text) and not os.path.exists(text):
            where = f" in {folder}, the folder of the scene, nor in the working folder {os.getcwd()}" if folder else ""
            raise InputError(f"{key.name} = {text}: no such file{where}")
    full = [os.path.abspath(text) if names_a_file(key, text) else text
            for text in ([texts] if isinstance(texts, str) else texts)]
    return full[0] if isinstance(texts, str) else full
