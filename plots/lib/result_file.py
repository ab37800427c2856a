"""Reading of result files, with one clear complaint about whatever is missing."""

import pathlib

import h5py


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

    def has(self, name):
        return name in self.file

    def dataset(self, name):
        if not isinstance(self.file.get(name), h5py.Dataset):
            why = ("is not complete: the same command with --resume goes on; "
                   if self.attribute("complete") == 0 or set(self.file) == {"state"} else "")
            raise Unusable(f"{self.path}: {why}has no dataset {name}")
        return self.file[name]

    def swept(self):
        """Keys that vary in a sweep of another subcommand; none of other results."""
        return list(self.attribute("swept", [])) if self.attribute("of") else []

    def numbers(self):
        """Names of datasets of numbers over what was swept, errors and times apart."""
        names = []
        self.file.visititems(lambda name, thing: names.append(name) if isinstance(thing, h5py.Dataset) else None)
        swept = {key.replace(".", "_") for key in self.swept()}
        hidden = ("_error", "_rare", "_s", "samples")
        return [name for name in names if 0 < self.file[name].ndim <= max(1, len(swept)) and self.file[name].dtype.kind == "f"
                and name not in swept and not name.endswith(hidden) and not name.startswith("state") and self.file[name].attrs.get("CLASS") != b"DIMENSION_SCALE"]

    def refuse_sweep(self):
        if self.swept():
            raise Unusable(f"{self.path}: a sweep over {', '.join(self.swept())}, no one picture; "
                           "plots/experiment_map.py --value NAME draws a number of it")

    def values(self, name):
        return self.dataset(name)[...]

    def axis(self, name, number):
        """Values of the scale of one axis of a dataset."""
        dimension = self.dataset(name).dims[number]
        if len(dimension) == 0:
            raise Unusable(f"{self.path}: axis {number} of {name} has no scale")
        return dimension[0][...]

    def attribute(self, name, default=None, group="/"):
        return self.file[group].attrs.get(name, default)
