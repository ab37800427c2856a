"""Stresses the program at random and reports failures: crashes, hangs, results that are lost, damaged or differ
from those of an undisturbed run, leftover files, rejections of more than one line.

    torture.py [--runs N] [--seed S] [--seconds T]   exit status 1 if anything was found
    torture.py --kind interrupted [...]              runs of that kind alone
    torture.py --seed S --only K                     run K again; its folder stays
"""

import argparse
import os
import pathlib
import sys
import tempfile
import time

from torture_case import Case
from torture_kinds import KINDS
from torture_library import Library


def torture(library, folder, seed, number, kinds):
    """Does run `number` of this seed, in that folder."""
    case = Case(library, folder, seed, number)
    kind, = case.random.choices(list(kinds), weights=kinds.values())
    kind(case)
    for what, command in case.failures:
        print(f"seed {seed} run {number} ({kind.__name__}): {what}\n    {shown(command)}",
              flush=True)
    return case


def shown(command):
    """Returns the command without its middle if it is long; --only prints all of it."""
    return command if len(command) < 2000 else f"{command[:1000]} ... {command[-200:]}"


def torture_all(library, seed, runs, seconds, kinds):
    """Returns whether there was any failure."""
    began, found, number = time.monotonic(), 0, 0
    while number < runs and time.monotonic() - began < seconds:
        with tempfile.TemporaryDirectory() as folder:
            found += bool(torture(library, folder, seed, number, kinds).failures)
        number += 1
    print(f"{number} runs in {time.monotonic() - began:.0f} s, {found} with failures")
    return found > 0


def torture_again(library, seed, number, kinds):
    folder = tempfile.mkdtemp(prefix=f"torture-{seed}-{number}-")
    case = torture(library, folder, seed, number, kinds)
    for command in case.commands:
        print(command)
    print(f"in {folder}")
    return bool(case.failures)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=int(os.environ.get("FLATSPECKLE_TEST_SEED", 1)))
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--only", type=int)
    parser.add_argument("--kind", choices=[kind.__name__ for kind in KINDS])
    given = parser.parse_args()
    kinds = {kind: often for kind, often in KINDS.items() if given.kind in (None, kind.__name__)}
    with tempfile.TemporaryDirectory() as folder:
        library = Library(pathlib.Path(folder))
        if given.only is not None:
            return torture_again(library, given.seed, given.only, kinds)
        return torture_all(library, given.seed, given.runs, given.seconds, kinds)


if __name__ == "__main__":
    sys.exit(main())
