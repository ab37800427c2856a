"""The command line of the plots. A script declares its plot by `@script.plot()` on the last of its
functions, which draws; run as a program, the script then draws the files of its command line."""

import argparse
import contextlib
import dataclasses
import pathlib
import sys
from collections.abc import Callable

from lib import style

import matplotlib

from lib.result_file import Result, Unusable


@dataclasses.dataclass(frozen=True)
class Plot:
    """The function that draws, and the files and options that it takes."""

    draw: Callable  # (result, or with `several` results; with options also arguments) -> figure
    options: list  # (names, settings), as argparse's add_argument takes them
    several: bool = False  # any number of files
    needs: dict = dataclasses.field(default_factory=dict)  # datasets, and what makes them
    one_run: bool = False  # sweeps are refused
    dpi: int = None  # of the PNG file, where it is not that of style
    read: Callable = Result  # path -> what is drawn
    metavar: str = "RESULT.h5"
    default: str = None  # the file that is drawn where none is given

    @property
    def description(self):
        return self.draw.__globals__["__doc__"]

    def add_options(self, parser):
        for names, settings in self.options:
            parser.add_argument(*names, **settings)

    def figure(self, files, arguments):
        """files: as `read` returns them."""
        for file in files:
            if self.one_run and file.swept():
                raise Unusable(f"{file.path}: a sweep over {', '.join(file.swept())}, no one picture; "
                               "plots/experiment_map.py --value NAME draws a number of it")
            for name, hint in self.needs.items():
                file.require(name, hint)
        drawn = files if self.several else files[0]
        try:
            return self.draw(drawn, arguments) if self.options else self.draw(drawn)
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as problem:
            names = ", ".join(str(file.path) for file in files)
            why = " ".join(f"{type(problem).__name__}: {problem}".split())
            raise Unusable(f"{names}: does not hold what this plot draws ({why})") from problem

    def run(self):
        """Draws the command line's files; ends with status 2 if they lack something."""
        matplotlib.use("Agg")
        parser = argparse.ArgumentParser(description=self.description)
        parser.add_argument("results", metavar=self.metavar,
                            nargs="*" if self.default else "+" if self.several else 1)
        parser.add_argument("--out", metavar="PREFIX", help="writes PREFIX.png and PREFIX.pdf "
                            "(default: beside the first result, named after it and this plot)")
        self.add_options(parser)
        arguments = parser.parse_args()
        with complaints():
            prefix = output_prefix(arguments)
            files = [self.read(path) for path in arguments.results or [self.default]]
            style.save(self.figure(files, arguments), prefix, self.dpi)


def plot(**settings):
    """Declares the function that draws: settings are those of Plot. In a script that is run it draws
    at once, so that it must be the last of the script."""
    def declare(draw):
        draw.plot = Plot(draw, getattr(draw, "options", []), **settings)
        if draw.__globals__["__name__"] == "__main__":
            draw.plot.run()
        return draw
    return declare


def option(*names, **settings):
    """Declares an option of the plot's command line, as argparse's add_argument does."""
    def declare(draw):
        draw.options = [(names, settings), *getattr(draw, "options", [])]
        return draw
    return declare


@contextlib.contextmanager
def complaints():
    """Ends the program with status 2 and one line where a file is not what it should be."""
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
    """PREFIX of --out, also if it ends like one of the files; beside the first result without, in the
    working folder where no result is given."""
    if not arguments.out:
        beside = [str(pathlib.Path(path).with_suffix("")) for path in arguments.results[:1]]
        return "_".join([*beside, pathlib.Path(sys.argv[0]).stem])
    out = pathlib.Path(arguments.out)
    if not out.parent.is_dir():
        raise Unusable(f"--out {out}: there is no folder {out.parent}")
    return out.with_suffix("") if out.suffix in (".png", ".pdf") else out
