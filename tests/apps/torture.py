"""Tortures the program at random and tells what must not happen: deaths, hangs, results lost,
damaged or other than those of an undisturbed run, litter, refusals of more than one line.

    torture.py [--runs N] [--seed S] [--seconds T]   exit status 1 if anything was found
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


def torture(library, folder, seed, number):
    """Run `number` of this seed, in that folder."""
    case = Case(library, folder, seed, number)
    kind, = case.random.choices(list(KINDS), weights=KINDS.values())
    kind(case)
    for what, command in case.failures:
        print(f"seed {seed} run {number} ({kind.__name__}): {what}\n    {shown(command)}",
              flush=True)
    return case


def shown(command):
    """--only has all of it."""
    return command if len(command) < 2000 else f"{command[:1000]} ... {command[-200:]}"


def torture_all(library, seed, runs, seconds):
    """Tells whether anything was found."""
    began, found, number = time.monotonic(), 0, 0
    while number < runs and time.monotonic() - began < seconds:
        with tempfile.TemporaryDirectory() as folder:
            found += bool(torture(library, folder, seed, number).failures)
        number += 1
    print(f"{number} runs in {time.monotonic() - began:.0f} s, {found} with failures")
    return found > 0


def torture_again(library, seed, number):
    folder = tempfile.mkdtemp(prefix=f"torture-{seed}-{number}-")
    case = torture(library, folder, seed, number)
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
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        library = Library(pathlib.Path(folder))
        if given.only is not None:
            return torture_again(library, given.seed, given.only)
        return torture_all(library, given.seed, given.runs, given.seconds)


if __name__ == "__main__":
    sys.exit(main())
