"""Scenes: keys with values, given as keyword arguments or read from scene files and results, and written as scene
files."""

import contextlib
import decimal
import numbers
import os
import re
import tomllib
from collections.abc import Mapping

import h5py
import numpy as np
import xarray

from flatspeckle import inputs, program
from flatspeckle.errors import InputError

MOST = 10 ** 18  # larger integers are written as floats
OF_KEYS = ("vary", "free", "against")  # keys whose values may be dicts {key: values}


class Scene(Mapping):
    """An immutable mapping of keys to values; `replace` makes a changed copy. Functions accept a Scene before their
    keyword arguments, as in covariance(scene, g=0.9)."""

    folder = None  # folder of the scene file from which the scene was loaded

    def __init__(self, scene=(), /, **keys):
        try:
            given = {**dict(scene), **keys}
        except (TypeError, ValueError):
            inputs.refuse("scene", scene, "must be a Scene, a mapping, or the path of a scene file or result")
        for name in given:
            if not isinstance(name, str):
                inputs.refuse("scene", name, "names of keys must be texts")
        self._keys = {name: value for name, value in given.items() if value is not None}
        self.folder = getattr(scene, "folder", None)

    def replace(self, **keys):
        """Returns a copy with other values; None removes a key."""
        return Scene(self, **keys)

    @classmethod
    def load(cls, path):
        """Loads a scene file (TOML), or the scene of the run that made a result file. Files named in a scene file are
        searched in its folder, then in the working folder."""
        try:
            if h5py.is_hdf5(path):
                with h5py.File(path) as file:
                    return cls(tomllib.loads(file.attrs["config"]))
            with open(path, "rb") as file:
                scene = cls(tomllib.load(file))
        except OSError as problem:
            raise InputError(f"scene = {path}: {problem.strerror or problem}") from None
        except (ValueError, KeyError, TypeError) as problem:  # includes files that are not TOML or not text
            raise InputError(f"scene = {path}: {problem}") from None
        scene.folder = os.path.dirname(os.path.abspath(path))
        names = inputs.file_keys(program.path()) & scene.keys()
        scene._keys.update({name: beside(scene.folder, scene[name]) for name in names})
        return scene

    def save(self, path):
        """Writes a scene file."""
        with open(path, "w") as file:
            file.write(text(self._keys, {}))

    def __getitem__(self, key):
        return self._keys[key]

    def __iter__(self):
        return iter(self._keys)

    def __len__(self):
        return len(self._keys)

    def __repr__(self):
        return f"Scene({', '.join(f'{key}={value!r}' for key, value in self.items())})"


def beside(folder, value):
    """Returns the path of a file in a folder if it exists there, otherwise the unchanged value."""
    if isinstance(value, list):
        return [beside(folder, one) for one in value]
    path = os.path.join(folder, value) if isinstance(value, str) else ""
    return path if os.path.isfile(path) else value


def scene_of(value):
    """Returns a Scene from a Scene, a mapping, or the path of a scene file or result."""
    return Scene.load(value) if isinstance(value, (str, os.PathLike)) else Scene(() if value is None else value)


def values_of(key, name, values):
    """Returns the text for one item of a dict given for a key in OF_KEYS: "1,2" for values, "0:1" for bounds if the
    key accepts them. Bounds are given as a tuple, (low, high) or (low, high, "log"); values as an array or list."""
    if isinstance(values, str):
        return values
    bounds = key is not None and re.search(r"\bbounds\b", " ".join(key.helps))
    between = ":" if bounds and (key.name == "free" or isinstance(values, tuple)) else ","
    several = values if between == ":" and isinstance(values, (list, tuple)) else flat(name, values)
    return between.join(text_of(name, one) for one in several)


def is_many(value):
    """Whether a value is a list, an array with an axis, or a table."""
    is_list = isinstance(value, (list, tuple, range))
    return is_list or (inputs.is_array(value) and getattr(value, "ndim", 1) != 0)


def flat(name, values):
    """Returns all values of a list or array, row by row."""
    if not is_many(values):
        return [values]
    if isinstance(values, (dict, xarray.Dataset)):
        inputs.refuse(name, values, "must be a number or a list of them")
    if not isinstance(values, (list, tuple, range)):
        return list(np.ravel(inputs.without_mask(name, values)))
    inputs.without_mask(name, values)
    if any(is_many(one) for one in values):
        rows = [flat(name, one) for one in values]
        if len({len(row) for row in rows}) > 1:
            inputs.refuse(name, values, "must have rows of equal length")
        return [one for row in rows for one in row]
    array = np.asarray(values)  # mixed integers and floats become floats
    return list(array if array.dtype.kind in "iufc" else values)


def are_paths(values):
    return isinstance(values, (list, tuple)) and all(isinstance(one, (str, os.PathLike)) for one in values)


def texts(key, name, value):
    """Returns a value in the program's notation: a text, or a list of texts."""
    if name in OF_KEYS and isinstance(value, Mapping) and value:
        return [f"{one}={values_of(key, name, several)}" for one, several in value.items()]
    if not is_many(value):
        return text_of(name, value)
    if key is not None and key.name in inputs.FRAMES and not are_paths(value):
        return inputs.file_of(key, value)
    if key is None or key.type is not str:
        found = [text_of(name, one) for one in flat(name, value)]
    elif key.is_list and (isinstance(value, (list, tuple)) or getattr(value, "ndim", 2) != 2):
        found = [inputs.file_of(key, one) if is_many(one) and not key.words else text_of(name, one) for one in value]
    else:
        return inputs.file_of(key, value)
    if not found:
        raise InputError(f"{name} = []: must have at least one value")
    return found


def text_of(name, value):
    inputs.without_mask(name, value)
    if isinstance(value, (np.datetime64, np.timedelta64)):
        inputs.refuse(name, value, "must be a number, not a time")
    if hasattr(value, "item") and np.ndim(value) == 0:
        value = value.item()
    if isinstance(value, (bool, np.bool_)):
        return str(bool(value)).lower()
    if isinstance(value, (numbers.Real, decimal.Decimal)):
        if isinstance(value, numbers.Integral) and abs(value) < MOST:
            return str(int(value))
        with contextlib.suppress(OverflowError, ValueError):
            return repr(float(value))
        raise InputError(f"{name}: must be within the range of double precision")
    if isinstance(value, numbers.Complex):
        value = complex(value)
        return f"{value.real!r}{value.imag:+}i"
    if isinstance(value, (str, os.PathLike)) and isinstance(path := os.fspath(value), str):
        return checked(name, path)
    inputs.refuse(name, value, "must be a number, a text, a path, or a list or array of them")


def checked(name, text):
    """Returns a text unchanged. Raises InputError if scene files cannot contain it."""
    if not text:
        raise InputError(f"{name} = '': must have a value")
    if '"' in text or "\\" in text or not text.isprintable():
        raise InputError(f"{name} = {text!r}: must not contain control characters, \" or \\")
    return text


def line(name, value):
    """Returns a line of a scene file. All values are quoted; the program also reads numbers from quoted texts."""
    show = '"{}"'.format
    shown = show(value) if isinstance(value, str) else f"[{', '.join(map(show, value))}]"
    return f"{name} = {shown}\n"


def all_texts(scene, keys):
    """Returns {key: texts} of all given values."""
    return {name: texts(keys.get(name), name, value) for name, value in scene.items() if value is not None}


def text(scene, keys):
    """Returns the text of a scene file."""
    return "".join(line(name, value) for name, value in all_texts(scene, keys).items())
