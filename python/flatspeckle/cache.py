"""Cache of results of earlier calls. The folder name of a result is a hash of the program's version, the subcommand,
the keys, and the contents of the files named by keys."""

import hashlib
import os
import pathlib
import shutil
import tempfile

from flatspeckle import program

# Keys that do not change the numbers in the result.
WITHOUT_EFFECT = ("threads", "out", "resume", "keep_state")


def folder():
    """Returns the folder FLATSPECKLE_CACHE, by default flatspeckle in the user's cache folder."""
    users = os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache"
    return pathlib.Path(os.environ.get("FLATSPECKLE_CACHE") or pathlib.Path(users) / "flatspeckle")


def clear():
    """Deletes all cached results."""
    shutil.rmtree(folder(), ignore_errors=True)


def put(path, content):
    """Writes a file atomically."""
    with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
        file.write(content)
    os.replace(file.name, path)


def digest_of(path):
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def identity(subcommand, values):
    """Returns a text that identifies a call. values: {key: text or texts}."""
    lines = [program.version(), subcommand]
    for name in sorted(set(values) - set(WITHOUT_EFFECT)):
        lines.append(f"{name} = {values[name]!r}")
        several = [values[name]] if isinstance(values[name], str) else values[name]
        lines += [digest_of(text) for text in several if os.path.isfile(text)]
    return "\n".join(lines)


def run_folder(subcommand, values):
    """Returns the folder of a run with these values."""
    name = hashlib.sha256(identity(subcommand, values).encode()).hexdigest()[:32]
    return folder() / "runs" / f"{subcommand}-{name}"
