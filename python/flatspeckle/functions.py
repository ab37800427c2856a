"""One function for each subcommand, made from its keys."""

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

NO_FUNCTION = ("keys", "datasets", "explain", "new", "bench")
OWN = """
Runs `flatspeckle {name}` and returns its result as an xarray.Dataset. Keys that are not given, or None,
have the program's defaults. Before the keys stand, if need be, a Scene, a mapping, or the path of a scene
file or result to start from. Where a file is asked for, an array or dict of columns will do.

Raises InputError for what cannot be used, warns TargetMissed where a run stopped before its target error,
and on KeyboardInterrupt stops the program.

Of Python alone:
  cache     True: a call like an earlier one is answered from its result; with `out`, there is none.
  progress  True or False; None: on terminals and in notebooks.
"""
OTHERS = """
With of="render" (or covariance, flux, field, image, solve, trace) all keys of that subcommand are keys here too:
help(flatspeckle.render) lists them. `vary` may be a dict: {"mu_s": [0.5, 1]} of values and, in optimise,
{"amplitude": (1e-4, 4e-3, "log")} of bounds, with "log" to search in ratios."""
_temporary = []  # folders of uncached results, which plots may still read


def subcommands():
    """Names of the functions."""
    table = program.table(program.path())["subcommands"]
    return [name for name in table if name not in NO_FUNCTION]


def place_of_run(subcommand, values, use_cache):
    """The folder of its scene and, without `out`, of its result."""
    if use_cache and "out" not in values:
        folder = cache.run_folder(subcommand, values)
        folder.mkdir(parents=True, exist_ok=True)
        return folder
    _temporary.append(tempfile.TemporaryDirectory(prefix="flatspeckle-"))
    return pathlib.Path(_temporary[-1].name)


def flags(values, known):
    """Of keys that scene files do not have."""
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


def refusal(said, folder, values=()):
    """The one line, less what is not the user's, and with the key where it begins with the file that a key names."""
    text = (said.strip().splitlines() or ["no word of why"])[-1].removeprefix("flatspeckle: ")
    text = text.removeprefix(f"{folder / 'scene.toml'}, ")
    for name in values:
        several = [values[name]] if isinstance(values[name], str) else values[name]
        if any(os.path.isabs(path) and text.startswith(path) for path in several):
            return f"{name} = {text}"
    return text


def make(subcommand, values, folder, progress):
    """Runs it, and leaves word of its end beside the result."""
    words = command(subcommand, values, keys.rows_for(subcommand, values), folder)
    status, printed, said = run(words, progress)
    if status == BAD_INPUT:
        raise InputError(refusal(said, folder, values))
    if status == FAILED:
        raise OSError(refusal(said, folder))
    if status not in (DONE, TARGET_MISSED):
        raise RuntimeError(f"flatspeckle {subcommand} ended with {status}: {refusal(said, folder)}")
    end = {"status": status, "printed": printed}
    cache.put(folder / "end.json", json.dumps(end).encode())
    return end


@contextlib.contextmanager
def alone(folder):
    """One call at a time makes the result of a folder: others, of this process too, wait for it."""
    with open(folder / ".lock", "w") as lock:
        with contextlib.suppress(OSError):  # of file systems without locks
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def all_values(subcommand, scene):
    """Texts of all that is given, with full paths."""
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
        warnings.warn(f"{subcommand} stopped before its target error", TargetMissed, stacklevel=3)
    return result


def description(key):
    """One entry of a docstring."""
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
