"""Shared by all runs of torture.py: files to copy, the keys of the program, results of undisturbed
runs."""

import shutil
import time

from program import flags
from torture_checks import datasets
from torture_run import run
from torture_scenes import rows_of_keys, write_files


def out_of(subcommand):
    return "x.csv" if subcommand == "place" else "x.h5"


def own_keys(subcommand, threads=1):
    """Returns the keys that complete a scene."""
    alone = subcommand in ("place", "merge")
    return {"out": out_of(subcommand), **({} if alone else {"threads": threads})}


class Library:
    def __init__(self, folder):
        self.folder = folder
        self.files = folder / "files"
        self.files.mkdir()
        write_files(self.files)
        self.rows = rows_of_keys()
        self._undisturbed = {}

    def whole(self, subcommand, keys):
        """Returns the datasets of a scene, by one thread."""
        return self.undisturbed(subcommand, keys)[0]

    def duration(self, subcommand, keys):
        return self.undisturbed(subcommand, keys)[1]

    def undisturbed(self, subcommand, keys):
        name = f"{subcommand} {keys}"
        if name not in self._undisturbed:
            place = self.folder / "undisturbed"
            shutil.copytree(self.files, place)
            began = time.monotonic()
            ended = run(place, [subcommand, *flags({**keys, **own_keys(subcommand)})])
            if ended.status != 0:
                raise RuntimeError(f"{ended.command}\n{ended.status}: {ended.stderr}")
            data = {} if subcommand == "place" else datasets(place / "x.h5")
            self._undisturbed[name] = data, time.monotonic() - began
            shutil.rmtree(place)
        return self._undisturbed[name]
