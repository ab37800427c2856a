"""Scenes: keys and their values, from keyword arguments, scene files and results, and as scene files."""

import os
import re
import tomllib
from collections.abc import Mapping

import h5py
import numpy as np

from flatspeckle import inputs
from flatspeckle.errors import InputError

OF_KEYS = ("vary", "free", "against")  # take dicts {key: values}


class Scene(Mapping):
    """Keys and values, which do not change: `replace` makes another. A function takes one before its
    keyword arguments: covariance(scene, g=0.9)."""

    def __init__(self, scene=(), /, **keys):
        self._keys = {name: value for name, value in {**dict(scene), **keys}.items() if value is not None}

    def replace(self, **keys):
        """The same with other values; None takes a key away."""
        return Scene(self._keys, **keys)

    @classmethod
    def load(cls, path):
        """Of a scene file (TOML), or of the run that made a result file."""
        if h5py.is_hdf5(path):
            with h5py.File(path) as file:
                return cls(tomllib.loads(file.attrs["config"]))
        with open(path, "rb") as file:
            return cls(tomllib.load(file))

    def save(self, path):
        """As a scene file."""
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


def scene_of(value):
    """A Scene, a mapping, or the path of one."""
    return Scene.load(value) if isinstance(value, (str, os.PathLike)) else Scene(value or ())


def values_of(key, values):
    """Of one key in such a dict: "1,2" of a list, "0:1" of bounds where there are bounds. A tuple is bounds,
    (low, high) or (low, high, "log"); an array or list is values."""
    if isinstance(values, str):
        return values
    bounds = key is not None and re.search(r"\bbounds\b", " ".join(key.helps))
    if bounds and (key.name == "free" or isinstance(values, tuple)):
        return ":".join(map(text_of, values))
    return ",".join(map(text_of, np.ravel(values)))


def texts(key, name, value):
    """A value as the program's own texts: one, or a list of them."""
    if name in OF_KEYS and isinstance(value, Mapping):
        return [f"{one}={values_of(key, several)}" for one, several in value.items()]
    is_text = key is not None and key.type is str
    if is_text and inputs.is_array(value) and not (key.is_list and isinstance(value, np.ndarray)):
        return inputs.file_of(key, value)
    if isinstance(value, (list, tuple)) and is_text:
        if not key.is_list:
            return inputs.file_of(key, np.asarray(value))
        return [texts(key, name, one) if inputs.is_array(one) else text_of(one) for one in value]
    if isinstance(value, (str, bytes, os.PathLike)) or np.ndim(value) == 0:
        return text_of(value)
    return [text_of(one) for one in np.ravel(value)]


def text_of(value):
    if isinstance(value, np.generic) or (hasattr(value, "item") and np.ndim(value) == 0):
        value = value.item()
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, complex):
        return f"{value.real!r}{value.imag:+}i"
    return repr(value) if isinstance(value, (int, float)) else os.fspath(value)


def line(name, value):
    """Of a scene file. The program reads numbers out of texts as well."""
    show = '"{}"'.format
    for text in [value] if isinstance(value, str) else value:
        if '"' in text or "\\" in text or not text.isprintable():
            raise InputError(f"{name} = {text}: must be without control characters, \" and \\")
    shown = show(value) if isinstance(value, str) else f"[{', '.join(map(show, value))}]"
    return f"{name} = {shown}\n"


def all_texts(scene, keys):
    """{key: texts} of all that is given."""
    return {name: texts(keys.get(name), name, value) for name, value in scene.items() if value is not None}


def text(scene, keys):
    """A scene file."""
    return "".join(line(name, value) for name, value in all_texts(scene, keys).items())
