#!/usr/bin/env python3
"""Compares fields from `flatspeckle solve` with tables of exact fields (data/reference). Prints the relative L2 error
for each table, and exits with status 1 if an error exceeds the limit."""

import argparse
import sys

import h5py
import numpy as np


def positions(scale, wanted):
    """Returns the indices of the wanted values on a scale."""
    found = np.abs(scale[None, :] - wanted[:, None]).argmin(axis=1)
    if not np.allclose(scale[found], wanted, rtol=0, atol=1e-12):
        raise ValueError("the result lacks some of the angles in the table")
    return found


def fields_at(result, table):
    """Returns the result's fields in the order of the table: far fields at the angles of the table, or near fields,
    for which the sensors must be the points of the table."""
    lights = positions(result["light_angle"][...], table["light_angle"])
    if "view_angle" in table.dtype.names:
        return result["far_field"][...][lights, positions(result["view_angle"][...], table["view_angle"])]
    for name in "x", "z":
        if not np.array_equal(result[f"sensor_{name}"], table[name]):
            raise ValueError("the result's sensors are not the points of the table")
    return result["near_field"][...][lights, np.arange(len(table))]


def relative_error(result, path):
    table = np.genfromtxt(path, delimiter=",", names=True)
    exact = table["re"] + 1j * table["im"]
    return np.linalg.norm(fields_at(result, table) - exact) / np.linalg.norm(exact)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("result", metavar="RESULT.h5")
    parser.add_argument("tables", metavar="TABLE.csv", nargs="+")
    parser.add_argument("--limit", type=float, default=1e-9)
    arguments = parser.parse_args()
    with h5py.File(arguments.result) as result:
        errors = [relative_error(result, path) for path in arguments.tables]
    for path, error in zip(arguments.tables, errors):
        print(f"{path}: relative L2 error {error:.1e}")
    return 0 if all(error <= arguments.limit for error in errors) else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (OSError, KeyError, ValueError) as problem:
        print(problem, file=sys.stderr)
        sys.exit(2)
