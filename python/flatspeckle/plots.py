"""Figures of results. Each plot script of the program has a function, such as plots.memory_effect(ds), which returns
the figure that the script would save. Options of the script are keyword arguments."""

import argparse
import contextlib
import functools
import importlib
import importlib.util
import os
import pathlib
import sys

from flatspeckle import program
from flatspeckle.errors import InputError
from flatspeckle.result import source_of

_libraries = {}  # modules that scripts import as `lib`


def folder():
    """Returns the folder of the scripts: in the checkout of this file, in the installation of the program, or in the
    checkout in which the program was built."""
    binary = pathlib.Path(program.path()).resolve()
    for place in (program.HERE.parents[1], binary.parents[1] / "share/flatspeckle", *binary.parents[3:4]):
        if (place / "plots/lib/style.py").is_file():
            return place / "plots"
    raise FileNotFoundError("the folder plots/ was found neither in the installation of the program "
                            "nor in its checkout")


def scripts():
    """Returns the names of all scripts that declare a plot."""
    return sorted(path.stem for path in folder().glob("*.py") if "@script.plot(" in path.read_text())


def names_of_lib():
    return [name for name in sys.modules if name == "lib" or name.startswith("lib.")]


@contextlib.contextmanager
def own_libraries():
    """While scripts are loaded and draw, replaces the modules `lib` and the plot style of the user by those of the
    scripts; restores the user's afterwards."""
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


def plot_of(name):
    """Returns the plot that a script declares."""
    spec = importlib.util.spec_from_file_location(f"flatspeckle.plots.{name}", folder() / f"{name}.py")
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    return script.draw.plot


class Options(argparse.ArgumentParser):
    def error(self, message):
        raise InputError(message)


def parsed(plot, options):
    """Converts keyword arguments to options of the script's command line and returns the parsed options."""
    parser, words = Options(add_help=False, allow_abbrev=False), []
    plot.add_options(parser)
    for option, value in options.items():
        several = value if isinstance(value, (list, tuple)) else [value]
        words += [] if value in (None, False) else [f"--{option}", *([] if value is True else map(str, several))]
    return parser.parse_args(words)


def file_of(result):
    """Returns the path of a result file; for a Dataset, the path of the file from which it was read."""
    return os.fspath(result) if isinstance(result, (str, os.PathLike)) else source_of(result)


def whole(figure, pad):
    """Enlarges the figure to include everything outside it, such as legends, with a margin of `pad` inches. The
    panels keep their size. Nothing is cut off, however the figure is saved."""
    figure.draw_without_rendering()
    width, height = figure.get_size_inches()
    box = figure.get_tightbbox(figure.canvas.get_renderer())
    left, bottom = (max(0, pad - low) for low in (box.x0, box.y0))
    right, top = max(0, box.x1 + pad - width), max(0, box.y1 + pad - height)
    if max(left, bottom, right, top) <= pad:
        return
    wide, high = width + left + right, height + bottom + top
    places = [legend.get_bbox_to_anchor().transformed(figure.dpi_scale_trans.inverted()) for legend in figure.legends]
    figure.set_size_inches(wide, high)
    figure.get_layout_engine().set(rect=(left / wide, bottom / high, width / wide, height / high))
    for legend, place in zip(figure.legends, places):
        legend.set_bbox_to_anchor(((place.x0 + left) / wide, (place.y0 + bottom) / high), figure.transFigure)
    figure.draw_without_rendering()


def figure(name, results, options):
    with own_libraries() as style:
        plot = plot_of(name)
        if len(results) != 1 and not (plot.several and results):
            raise InputError(f"{name}: draws {'one result or more' if plot.several else 'one result'}")
        if options and not plot.options:
            raise InputError(f"{name}: has no options")
        try:
            files = [plot.read(file_of(result)) for result in results]
            drawn = plot.figure(files, parsed(plot, options))
        except style.Unusable as problem:
            raise InputError(str(problem)) from None
        whole(drawn, style.PAD)  # while the scripts' style is active
        style.plt.close(drawn)  # closed, because a notebook would show the returned figure twice
    for file in files:
        if hasattr(file, "file"):
            file.file.close()
    return drawn


@functools.cache
def function_of(name):
    def function(*results, **options):
        return figure(name, results, options)

    with own_libraries():
        plot = plot_of(name)
        parser = Options(prog=f"plots.{name}", add_help=False)
        plot.add_options(parser)
    function.__name__ = function.__qualname__ = name
    function.__module__ = "flatspeckle.plots"
    function.__doc__ = f"{plot.description}\n\n{parser.format_help()}" if plot.options else plot.description
    return function


def __getattr__(name):
    if not name.startswith("_") and name in scripts():
        return function_of(name)
    raise AttributeError(f"module 'flatspeckle.plots' has no attribute {name!r}")


def __dir__():
    return scripts()
