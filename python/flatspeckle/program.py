"""Finds the program and reads its table of keys."""

import functools
import json
import os
import pathlib
import shutil
import subprocess

HERE = pathlib.Path(__file__).resolve().parent


def places():
    """Yields possible paths of the program. If the environment variable FLATSPECKLE is set, it is the only one.
    Otherwise they are the release build in this file's checkout, the installation that contains this package, and the
    PATH."""
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
    raise FileNotFoundError("the program flatspeckle was not found; "
                            "set the environment variable FLATSPECKLE to its path")


@functools.cache
def table(program):
    """Returns {"version", "commit", "subcommands": {name: {"purpose", "keys": [rows]}}}."""
    printed = subprocess.run([program, "keys", "json"], capture_output=True, check=True).stdout
    return json.loads(printed)


def version():
    """Returns a text that identifies the program: version, commit and, for builds with uncommitted changes, the time
    of the build."""
    program = path()
    known = table(program)
    text = f"{known['version']} {known['commit']}"
    changed = os.stat(program).st_mtime_ns if known["commit"].endswith("+changes") else ""
    return f"{text} {changed}"
