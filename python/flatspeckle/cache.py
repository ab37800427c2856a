"""Results of earlier calls, in a folder named by what was asked for: program, subcommand, keys, and the
contents of the files that they name."""

import hashlib
import os
import pathlib
import shutil
import tempfile

from flatspeckle import program

# How, not what: the numbers are the same.
NOT_ASKED = ("threads", "out", "resume", "keep_state")


def folder():
    """FLATSPECKLE_CACHE, or flatspeckle in the user's cache."""
    users = os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache"
    return pathlib.Path(os.environ.get("FLATSPECKLE_CACHE") or pathlib.Path(users) / "flatspeckle")


def clear():
    """Forgets all results."""
    shutil.rmtree(folder(), ignore_errors=True)


def put(path, content):
    """Writes a file as a whole or not at all."""
    with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
        file.write(content)
    os.replace(file.name, path)


def digest_of(path):
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def identity(subcommand, values):
    """What is asked for, as a text. values: {key: text or texts}."""
    lines = [program.version(), subcommand]
    for name in sorted(set(values) - set(NOT_ASKED)):
        lines.append(f"{name} = {values[name]!r}")
        several = [values[name]] if isinstance(values[name], str) else values[name]
        lines += [digest_of(text) for text in several if os.path.isfile(text)]
    return "\n".join(lines)


def run_folder(subcommand, values):
    """Of the run that is asked for."""
    name = hashlib.sha256(identity(subcommand, values).encode()).hexdigest()[:32]
    return folder() / "runs" / f"{subcommand}-{name}"
