#!/usr/bin/env python3
"""Checks data/space_exact.csv, the table of the README's figure of exact ensembles, Monte Carlo and transport in
boxes of points (scripts/space_exact.py)."""

import csv
import math
import pathlib
import unittest

TABLE = pathlib.Path(__file__).resolve().parents[2] / "data" / "space_exact.csv"
ALLOWED, ERRORS = 0.01, 4  # relative deviation, plus standard errors


def curves():
    """Returns {(dimension, curve, optical depth): {method: {x: (value, error)}}}."""
    found = {}
    with open(TABLE, encoding="utf-8") as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            curve = found.setdefault((row["dimension"], row["curve"], row["optical_depth"]), {})
            curve.setdefault(row["method"], {})[float(row["x"])] = float(row["value"]), float(row["error"])
    return found


class SpaceExact(unittest.TestCase):
    def test_all_curves_are_there(self):
        depths = {"1", "2", "5"}
        expected = {(dimension, curve, depth) for depth in depths
                    for dimension, curve in (("3", "in"), ("3", "out"), ("3", "cone"), ("2", "in"), ("2", "cone"))}
        self.assertEqual(set(curves()), expected)

    def test_exact_ensembles_agree_with_monte_carlo(self):
        for key, methods in curves().items():
            xs = [0.0] if key[1] == "cone" else list(methods["exact"])
            for x in xs:
                (exact, error), (found, other) = methods["exact"][x], methods["monte_carlo"][x]
                allowed = ALLOWED * exact + ERRORS * math.hypot(error, other)
                with self.subTest(curve=key, x=x, exact=exact, monte_carlo=found, allowed=allowed):
                    self.assertLessEqual(abs(found - exact), allowed)

    def test_errors_resolve_the_curves(self):
        for key, methods in curves().items():
            for x, (value, error) in methods["exact"].items():
                with self.subTest(curve=key, x=x):
                    self.assertLess(error, 0.1 * max(value, 0.5))


if __name__ == "__main__":
    unittest.main()
