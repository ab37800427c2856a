#!/usr/bin/env python3
"""Compares the fields of `flatspeckle solve` with a table of exact ones (data/reference): prints the
relative L2 error of each and exits 1 where one is above the limit."""

import argparse
import sys

import numpy as np

import style


def read_table(path):
    table = np.genfromtxt(path, delimiter=",", names=True)
    return table, table["re"] + 1j * table["im"]


def positions(scale, wanted, what):
    """Where on an axis the wanted values are."""
    found = np.abs(scale[None, :] - wanted[:, None]).argmin(axis=1)
    if not np.allclose(scale[found], wanted, rtol=0, atol=1e-12):
        raise style.Unusable(f"the result does not have every {what} of the table")
    return found


def far_error(result, path):
    table, expected = read_table(path)
    lights = positions(result.axis("far_field", 0), table["light_angle"], "light")
    views = positions(result.axis("far_field", 1), table["view_angle"], "view")
    return relative_error(result.values("far_field")[lights, views], expected)


def near_error(result, path):
    """The sensors of the result are the rows of the table, in order."""
    table, expected = read_table(path)
    fields = result.values("near_field")
    if fields.shape[1] != len(table):
        raise style.Unusable(f"{result.path}: solve with --near_sensors {path}")
    lights = positions(result.axis("near_field", 0), table["light_angle"], "light")
    return relative_error(fields[lights, np.arange(len(table))], expected)


def relative_error(values, expected):
    return np.linalg.norm(values - expected) / np.linalg.norm(expected)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("result", metavar="RESULT.h5")
    parser.add_argument("far", metavar="FARFIELD.csv")
    parser.add_argument("near", metavar="NEARFIELD.csv", nargs="?")
    parser.add_argument("--limit", type=float, default=1e-9)
    arguments = parser.parse_args()
    result = style.Result(arguments.result)
    errors = {"far field": far_error(result, arguments.far)}
    if arguments.near:
        errors["near field"] = near_error(result, arguments.near)
    for name, error in errors.items():
        print(f"{name}: relative L2 error {error:.1e}")
    return 0 if all(error <= arguments.limit for error in errors.values()) else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (style.Unusable, OSError, ValueError) as problem:
        print(problem, file=sys.stderr)
        sys.exit(2)
