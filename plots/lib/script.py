"""Command line of the plot scripts. A script declares its plot by the decorator `@script.plot()` on its last
function, which draws. If the script is run as a program, it then draws the files named on its command line."""

import argparse
import contextlib
import dataclasses
import pathlib
import sys
from collections.abc import Callable

from lib import style

import matplotlib

from lib.result_file import Result, Unusable


MOST_NAMED = 3  # largest number of further results whose names are part of that of a picture


@dataclasses.dataclass(frozen=True)
class Plot:
    """A function that draws, and the files and options that it accepts."""

    draw: Callable  # (result, or a list if `several`; also arguments if there are options) -> figure
    options: list  # (names, settings) for argparse's add_argument
    several: bool = False  # whether any number of files is accepted
    needs: dict = dataclasses.field(default_factory=dict)  # {required dataset: hint how to produce it}
    one_run: bool = False  # whether sweeps are rejected
    dpi: int = None  # resolution of the PNG file, if not the default of style
    read: Callable = Result  # reads a file: path -> object to be drawn
    metavar: str = "RESULT.h5"
    default: str = None  # file that is drawn if none is given

    @property
    def description(self):
        return self.draw.__globals__["__doc__"]

    def add_options(self, parser):
        for names, settings in self.options:
            parser.add_argument(*names, **settings)

    def figure(self, files, arguments):
        """Returns the figure. files: objects returned by `read`."""
        for file in files:
            if self.one_run and file.swept():
                raise Unusable(f"{file.path}: is a sweep over {', '.join(file.swept())}, not a single run; "
                               "choose a point and run it alone, or draw one of the numbers of all points with "
                               "plots/experiment_map.py --value NAME")
            for name, hint in self.needs.items():
                file.require(name, hint)
        drawn = files if self.several else files[0]
        try:
            return self.draw(drawn, arguments) if self.options else self.draw(drawn)
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as problem:
            names = ", ".join(str(file.path) for file in files)
            why = " ".join(f"{type(problem).__name__}: {problem}".split())
            raise Unusable(f"{names}: does not hold the data that this plot needs ({why})") from problem

    def run(self):
        """Draws the files of the command line. Exits with status 2 if they lack required data."""
        matplotlib.use("Agg")
        parser = argparse.ArgumentParser(description=self.description)
        parser.add_argument("results", metavar=self.metavar,
                            nargs="*" if self.default else "+" if self.several else 1)
        parser.add_argument("--out", metavar="PREFIX", help="write PREFIX.png and PREFIX.pdf "
                            "(default: next to the first result, named after all results and this plot)")
        self.add_options(parser)
        arguments = parser.parse_args()
        with complaints():
            prefix = output_prefix(arguments)
            files = [self.read(path) for path in arguments.results or [self.default]]
            style.save(self.figure(files, arguments), prefix, self.dpi)


def plot(**settings):
    """Declares the function that draws; settings are the fields of Plot. In a script that is run as a program, the
    function is called at once, so it must be the last one in the script."""
    def declare(draw):
        draw.plot = Plot(draw, getattr(draw, "options", []), **settings)
        if draw.__globals__["__name__"] == "__main__":
            draw.plot.run()
        return draw
    return declare


def option(*names, **settings):
    """Declares an option of the plot's command line, with the arguments of argparse's add_argument."""
    def declare(draw):
        draw.options = [(names, settings), *getattr(draw, "options", [])]
        return draw
    return declare


@contextlib.contextmanager
def complaints():
    """Exits with status 2 and a one-line message if a file cannot be used."""
    try:
        yield
    except Unusable as problem:
        print(problem, file=sys.stderr)
        sys.exit(2)
    except OSError as problem:
        print(f"{problem.filename}: {problem.strerror}" if problem.filename else problem,
              file=sys.stderr)
        sys.exit(2)


def output_prefix(arguments):
    """Returns the PREFIX of --out, without an ending .png or .pdf. Without --out it is next to the first result, or
    in the working folder if no result is given; the names of all results are part of it."""
    if not arguments.out:
        beside = [str(pathlib.Path(path).with_suffix("")) for path in arguments.results[:1]]
        others = [pathlib.Path(path).stem for path in arguments.results[1:]]
        if len(others) > MOST_NAMED:
            others = [f"{len(others)}_more"]
        return "_".join([*beside, *others, pathlib.Path(sys.argv[0]).stem])
    out = pathlib.Path(arguments.out)
    if not out.parent.is_dir():
        raise Unusable(f"--out {out}: there is no folder {out.parent}")
    return out.with_suffix("") if out.suffix in (".png", ".pdf") else out
