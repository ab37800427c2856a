"""One function for each subcommand, generated from its keys."""

import contextlib
import fcntl
import functools
import inspect
import json
import os
import pathlib
import tempfile
import textwrap
import warnings

import xarray

from flatspeckle import cache, inputs, keys, program
from flatspeckle.errors import InputError, TargetMissed
from flatspeckle.result import read
from flatspeckle.run import BAD_INPUT, DONE, FAILED, TARGET_MISSED, run
from flatspeckle.scene import all_texts, line, scene_of

NO_FUNCTION = ("keys", "datasets", "explain", "export", "new", "bench")
OWN = """
Runs `flatspeckle {name}` and returns its result as an xarray.Dataset. Keys that are omitted or None
have the program's defaults. The optional first argument provides keys to start from: a Scene, a mapping,
or the path of a scene file or result. Keys that accept a file also accept an array or a dict of columns.

Raises InputError for invalid input, and issues the warning TargetMissed if the run stopped before it reached
its target error. KeyboardInterrupt stops the program.

Arguments of the Python function only:
  cache     whether a call equal to an earlier one returns the cached result; calls with `out` are not cached
  progress  whether to show progress; None: only on terminals and in notebooks
"""
OTHERS = """
With of="render" (or covariance, flux, field, image, solve, trace), all keys of that subcommand are also accepted;
help(flatspeckle.render) lists them. `vary` may be a dict: {"mu_s": [0.5, 1]} gives values. In optimise,
{"amplitude": (1e-4, 4e-3, "log")} gives bounds; "log" means a search on a logarithmic scale."""
_temporary = []  # folders of uncached results; kept, because plots may still read them


def subcommands():
    """Returns the names of all subcommands that have a function."""
    table = program.table(program.path())["subcommands"]
    return [name for name in table if name not in NO_FUNCTION]


def place_of_run(subcommand, values, use_cache):
    """Returns the folder for the scene file and, if `out` is not given, for the result."""
    if use_cache and "out" not in values:
        folder = cache.run_folder(subcommand, values)
        folder.mkdir(parents=True, exist_ok=True)
        return folder
    _temporary.append(tempfile.TemporaryDirectory(prefix="flatspeckle-"))
    return pathlib.Path(_temporary[-1].name)


def flags(values, known):
    """Yields the command-line flags of keys that scene files cannot contain."""
    for name, value in values.items():
        if name in known and not known[name].in_scene_files and value != "false":
            yield f"--{name}"
            if value != "true":
                yield from [value] if isinstance(value, str) else value


def command(subcommand, values, known, folder):
    scene = {name: value for name, value in values.items() if name not in known or known[name].in_scene_files}
    words = [program.path(), subcommand, *flags(values, known)]
    if scene:
        path = folder / "scene.toml"
        path.write_text("".join(line(*item) for item in scene.items()))
        words += ["--config", str(path)]
    return words


def refusal(output, folder, values=()):
    """Returns the error line without the path of the temporary scene file. If the line begins with the path of a file
    given for a key, the name of the key is put in front."""
    text = (output.strip().splitlines() or ["no error message"])[-1].removeprefix("flatspeckle: ")
    text = text.removeprefix(f"{folder / 'scene.toml'}, ")
    for name in values:
        several = [values[name]] if isinstance(values[name], str) else values[name]
        if any(os.path.isabs(path) and text.startswith(path) for path in several):
            return f"{name} = {text}"
    return text


def make(subcommand, values, folder, progress):
    """Runs the program, and writes its exit status and output into the folder of the result."""
    words = command(subcommand, values, keys.rows_for(subcommand, values), folder)
    status, printed, errors = run(words, progress)
    if status == BAD_INPUT:
        raise InputError(refusal(errors, folder, values))
    if status == FAILED:
        raise OSError(refusal(errors, folder))
    if status not in (DONE, TARGET_MISSED):
        raise RuntimeError(f"flatspeckle {subcommand} exited with status {status}: {refusal(errors, folder)}")
    end = {"status": status, "printed": printed}
    cache.put(folder / "end.json", json.dumps(end).encode())
    return end


@contextlib.contextmanager
def alone(folder):
    """Locks a folder, so that only one call at a time computes its result. Other calls wait, also those of the same
    process."""
    with open(folder / ".lock", "w") as lock:
        with contextlib.suppress(OSError):  # some file systems do not support locks
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def all_values(subcommand, scene):
    """Returns all given values as texts, with absolute paths."""
    rows = keys.rows_for(subcommand, scene)
    values = all_texts(scene, rows)
    return {name: inputs.paths(rows[name], text, scene.folder) if name in rows else text for name, text in values.items()}


def call(subcommand, scene, given, use_cache, progress):
    values = all_values(subcommand, scene_of(scene).replace(**given))
    folder = place_of_run(subcommand, values, use_cache)
    ending = ".csv" if subcommand == "place" else ".h5"
    values.setdefault("out", str(folder / f"result{ending}"))
    end = folder / "end.json"
    with alone(folder):
        known = json.loads(end.read_text()) if end.exists() else make(subcommand, values, folder, progress)
    result = read(values["out"])
    result.attrs["printed"] = known["printed"]
    if known["status"] == TARGET_MISSED:
        warnings.warn(f"{subcommand} stopped before it reached its target error", TargetMissed, stacklevel=3)
    return result


def description(key):
    """Returns the paragraph of a docstring that describes a key."""
    default = "" if key.default in (None, ()) else f", default {key.default!r}"
    unit = f" [{key.unit}]" if key.unit else ""
    head = f"{key.name} : {key.kind}{unit}{default}"
    helps = [textwrap.indent(textwrap.fill(text, 92, break_on_hyphens=False), "    ") for text in key.helps]
    return "\n".join([head, *helps, f"    {key.accepted}"])


def documentation(subcommand):
    purpose = program.table(program.path())["subcommands"][subcommand]["purpose"]
    parts, group = [purpose[0].upper() + purpose[1:] + ".\n" + OWN.format(name=subcommand)], None
    if "of" in keys.keys_of(subcommand):
        parts.append(OTHERS)
    for key in sorted_by_group(keys.keys_of(subcommand).values()):
        if key.group != group:
            parts.append(f"\n{key.group}\n{'-' * len(key.group)}")
        group = key.group
        parts.append(description(key))
    return "\n".join(parts)


def sorted_by_group(rows):
    groups = list(dict.fromkeys(key.group for key in rows))
    return sorted(rows, key=lambda key: groups.index(key.group))


def signature(subcommand):
    only = inspect.Parameter.KEYWORD_ONLY
    parameters = [inspect.Parameter("scene", inspect.Parameter.POSITIONAL_ONLY, default=None)]
    parameters += [inspect.Parameter(key.name, only, default=key.default,
                                     annotation=list[key.type] if key.is_list else key.type)
                   for key in sorted_by_group(keys.keys_of(subcommand).values())]
    parameters += [inspect.Parameter("cache", only, default=True, annotation=bool),
                   inspect.Parameter("progress", only, default=None, annotation=bool)]
    return inspect.Signature(parameters, return_annotation=xarray.Dataset)


@functools.cache
def function_of(subcommand):
    def function(scene=None, /, *, cache=True, progress=None, **given):
        return call(subcommand, scene, given, cache, progress)

    function.__name__ = function.__qualname__ = subcommand
    function.__module__ = "flatspeckle"
    function.__doc__ = documentation(subcommand)
    function.__signature__ = signature(subcommand)
    return function
