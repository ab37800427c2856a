"""The program that does the work: where it is, and its table of keys."""

import functools
import json
import os
import pathlib
import shutil
import subprocess

HERE = pathlib.Path(__file__).resolve().parent


def places():
    """Where the program may be: named by FLATSPECKLE, built in the checkout that this file is of, installed
    with it, on the PATH."""
    if os.environ.get("FLATSPECKLE"):
        yield os.environ["FLATSPECKLE"]
        return
    yield HERE.parents[1] / "build/release/bin/flatspeckle"
    yield HERE.parents[3] / "bin/flatspeckle"
    yield shutil.which("flatspeckle") or "flatspeckle"


def path():
    for place in places():
        if os.access(place, os.X_OK):
            return str(place)
    raise FileNotFoundError("the program flatspeckle is not on the PATH; the variable FLATSPECKLE may name it")


@functools.cache
def table(program):
    """{"version", "commit", "subcommands": {name: {"purpose", "keys": [rows]}}}."""
    printed = subprocess.run([program, "keys", "json"], capture_output=True, check=True).stdout
    return json.loads(printed)


def version():
    """Of the program, one text for each that may give other numbers."""
    program = path()
    known = table(program)
    text = f"{known['version']} {known['commit']}"
    changed = os.stat(program).st_mtime_ns if known["commit"].endswith("+changes") else ""
    return f"{text} {changed}"
