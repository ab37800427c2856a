"""Figures of results: one function for each plot script of the program, plots.memory_effect(ds), which
returns the figure that the script would save. Options of the script are keyword arguments."""

import argparse
import contextlib
import functools
import importlib
import importlib.util
import os
import pathlib
import sys
from unittest import mock

from flatspeckle import program
from flatspeckle.errors import InputError
from flatspeckle.result import source_of

_libraries = {}  # the scripts' own modules, which they know as `lib`


def folder():
    """Where the scripts are: in this checkout, beside the program, in the checkout that it was built in."""
    binary = pathlib.Path(program.path()).resolve()
    for place in (program.HERE.parents[1], binary.parents[1] / "share/flatspeckle", *binary.parents[3:4]):
        if (place / "plots/lib/style.py").is_file():
            return place / "plots"
    raise FileNotFoundError("the plot scripts are neither beside the program nor in its checkout")


def scripts():
    """Their names: all that draw results."""
    return sorted(path.stem for path in folder().glob("*.py") if "style.main(" in path.read_text())


def names_of_lib():
    return [name for name in sys.modules if name == "lib" or name.startswith("lib.")]


@contextlib.contextmanager
def own_libraries():
    """While scripts are loaded and draw, `lib` and the look are theirs; what the user has is back
    afterwards."""
    import matplotlib.pyplot as plt

    others = {name: sys.modules.pop(name) for name in names_of_lib()}
    sys.modules.update(_libraries)
    sys.path.insert(0, str(folder()))
    try:
        with plt.rc_context():
            style = importlib.import_module("lib.style")
            plt.rcParams.update(style.LOOK)
            yield style
    finally:
        sys.path.pop(0)
        _libraries.update({name: sys.modules.pop(name) for name in names_of_lib()})
        sys.modules.update(others)


def what_it_draws(name, style):
    """(draw, description, several, add_options): what the script hands to style.main."""
    spec = importlib.util.spec_from_file_location("__main__", folder() / f"{name}.py")
    script = importlib.util.module_from_spec(spec)
    with mock.patch.object(style, "main") as main:
        spec.loader.exec_module(script)
    (draw, description), options = main.call_args
    return draw, description, options.get("several", False), options.get("add_options")


class Options(argparse.ArgumentParser):
    def error(self, message):
        raise InputError(message)


def parsed(add_options, options):
    """Keyword arguments as the script's command line has them."""
    parser, words = Options(add_help=False, allow_abbrev=False), []
    add_options(parser)
    for option, value in options.items():
        several = value if isinstance(value, (list, tuple)) else [value]
        words += [] if value in (None, False) else [f"--{option}", *([] if value is True else map(str, several))]
    return parser.parse_args(words)


def file_of(result):
    """A path, or a Dataset as it was read."""
    return os.fspath(result) if isinstance(result, (str, os.PathLike)) else source_of(result)


def figure(name, results, options):
    with own_libraries() as style:
        draw, _, several, add_options = what_it_draws(name, style)
        if len(results) != 1 and not (several and results):
            raise InputError(f"{name}: draws {'one result or more' if several else 'one result'}")
        if options and not add_options:
            raise InputError(f"{name}: has no options")
        try:
            files = [style.Result(file_of(result)) for result in results]
            drawn = draw(files, parsed(add_options, options)) if add_options else draw(files)
        except style.Unusable as problem:
            raise InputError(str(problem)) from None
        style.whole(drawn)  # while the look is theirs
        style.plt.close(drawn)  # it is returned: a notebook need not show it twice
    for file in files:
        file.file.close()
    return drawn


@functools.cache
def function_of(name):
    def function(*results, **options):
        return figure(name, results, options)

    with own_libraries() as style:
        _, description, _, add_options = what_it_draws(name, style)
        parser = Options(prog=f"plots.{name}", add_help=False)
        if add_options:
            add_options(parser)
    function.__name__ = function.__qualname__ = name
    function.__module__ = "flatspeckle.plots"
    function.__doc__ = f"{description}\n\n{parser.format_help()}" if add_options else description
    return function


def __getattr__(name):
    if not name.startswith("_") and name in scripts():
        return function_of(name)
    raise AttributeError(f"module 'flatspeckle.plots' has no attribute {name!r}")


def __dir__():
    return scripts()
