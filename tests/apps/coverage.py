"""Checks the coverage of error bars: runs scenes of every kind with many seeds. Reports per scene, over
all values of all its estimates:

    ratio    median of the scatter between seeds divided by the reported error; 1 is right
    marked   share of values marked as undersampled (a few batches dominate the error)
    beyond   share of the others that differ from the mean over seeds by more than 2 reported errors

    coverage.py [--seeds N] [--workers N] [--only SCENE ...] [--out FILE.json]

Pictures and maps take at most 40 seeds and have one row for pixels or cells and one for all other estimates.
The exit status is 1 if a ratio is outside 0.9 to 1.15 or more than 8 % lie beyond; for pictures, whose marked
errors are upper bounds, if a ratio is above 1.15 or more than 10 % lie beyond."""

import argparse
import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

from coverage_pictures import PICTURES
from coverage_scenes import SCENES
from program import PROGRAM, flags

RATIOS = 0.9, 1.15
MOST_SEEDS_OF_PICTURES = 40
MOST_BEYOND, MOST_BEYOND_OF_PICTURES = 0.08, 0.1
FIRST_SEED = 1 + 1000 * int(os.environ.get("FLATSPECKLE_TEST_SEED", 0))
MOSTLY_ZERO = ("energy/lost",)  # 0 in most runs
EACH_OF_MANY = ("image", "transient", "map/fluence", "map/absorbed")
ALL = {**SCENES, **{name: ("render", keys) for name, keys in PICTURES.items()}}


def estimates(path):
    """Returns {name of row: (values, errors, marks)} of its estimates, ordered by name."""
    found = {}

    def visit(name, item):
        if name + "_error" in file and name not in MOSTLY_ZERO:
            marks = file[name + "_rare"][...] if name + "_rare" in file else np.zeros(item.shape)
            found.setdefault("pixels" if name in EACH_OF_MANY else "", []).append(
                (item[...].ravel(), file[name + "_error"][...].ravel(), marks.ravel()))

    with h5py.File(path) as file:
        file.visititems(visit)
    return {row: tuple(np.concatenate(each) for each in zip(*parts)) for row, parts in found.items()}


def run(scene, seed):
    subcommand, keys = scene
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "x.h5"
        command = [PROGRAM, subcommand, *flags(keys), "--seed", str(seed), "--threads", "1",
                   "--out", str(path)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode not in (0, 3):
            raise RuntimeError(f"{' '.join(command)}\n{done.stderr}")
        return estimates(path)


def measured(runs):
    """Returns a row of the table, without values that are exact in all runs (the correlation at tilt 0)."""
    values, errors, marks = (np.array(each) for each in zip(*runs))
    kept = (errors > 1e-13 * np.abs(values)).any(axis=0)
    values, errors, marks = values[:, kept], errors[:, kept], marks[:, kept] > 0
    seeds = len(runs)
    off = np.abs(values - values.mean(axis=0)) * np.sqrt(seeds / (seeds - 1))
    ratio = np.sqrt((off**2).mean(axis=0) / (errors**2).mean(axis=0))
    beyond = off > 2 * errors
    return {"seeds": seeds, "values": int(kept.sum()), "ratio": float(np.median(ratio)),
            "marked": float(marks.mean()),
            "beyond": float(beyond[~marks].mean()) if not marks.all() else 0.0}


def is_good(name, row):
    if name.split()[0] in PICTURES:
        return row["ratio"] <= RATIOS[1] and row["beyond"] <= MOST_BEYOND_OF_PICTURES
    return RATIOS[0] <= row["ratio"] <= RATIOS[1] and row["beyond"] <= MOST_BEYOND


def rows_of(name, seeds, pool):
    """Returns {name of row: row}."""
    if name in PICTURES:
        seeds = min(seeds, MOST_SEEDS_OF_PICTURES)
    runs = list(pool.map(lambda seed: run(ALL[name], seed), range(FIRST_SEED, FIRST_SEED + seeds)))
    return {f"{name} {part}".strip(): measured([each[part] for each in runs])
            for part in sorted(runs[0])}


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=160)
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--only", nargs="+", default=list(ALL), choices=list(ALL))
    parser.add_argument("--out", type=pathlib.Path)
    asked = parser.parse_args()
    rows = {}
    print(f"{'scene':23} {'values':>6} {'ratio':>6} {'marked':>8} {'beyond':>8}")
    with concurrent.futures.ThreadPoolExecutor(asked.workers) as pool:
        for scene in asked.only:
            for name, row in rows_of(scene, asked.seeds, pool).items():
                rows[name] = row
                print(f"{name:23} {row['values']:6} {row['ratio']:6.3f} {100 * row['marked']:6.1f} % "
                      f"{100 * row['beyond']:6.1f} %{'' if is_good(name, row) else '  *'}", flush=True)
    if asked.out:
        asked.out.write_text(json.dumps(rows, indent=1) + "\n")
    return 0 if all(is_good(name, row) for name, row in rows.items()) else 1


if __name__ == "__main__":
    sys.exit(main())
