"""Figures from Python: those of the scripts, and nothing of the user's is changed."""

import sys
import types
import unittest

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from package import BOX, CURVE, FEW, PackageTest, fs


class Plots(PackageTest):
    def test_a_curve(self):
        curve = fs.covariance(CURVE, tilts=np.linspace(0, 4e-4, 5))
        figure = fs.plots.memory_effect(curve)
        expected = np.stack([curve.tilt * 1000, curve.field_correlation**2], 1)
        drawn = [line.get_xydata() for line in figure.axes[0].lines]
        self.assertTrue(any(line.shape == expected.shape and np.allclose(line[np.argsort(line[:, 0])], expected, rtol=1e-12)
                            for line in drawn))
        figure.savefig(self.folder / "curve.png")
        self.assertFalse(plt.get_fignums())

    def test_options(self):
        curve = fs.covariance(CURVE)
        self.assertEqual(fs.plots.memory_effect(curve, log=True).axes[0].get_xscale(), "log")
        with self.assertRaisesRegex(fs.InputError, "nothing"):
            fs.plots.memory_effect(curve, nothing=1)
        self.assertIn("--log_correlation", fs.plots.memory_effect.__doc__)

    def test_several_results(self):
        curves = [fs.covariance(CURVE, g=g) for g in (0.8, 0.9)]
        self.assertTrue(fs.plots.memory_effect(*curves).axes)
        with self.assertRaisesRegex(fs.InputError, "draws one result"):
            fs.plots.validation(*curves)

    def test_what_a_script_refuses(self):
        power = fs.flux(BOX, **FEW)
        with self.assertRaisesRegex(fs.InputError, "has neither"):
            fs.plots.validation(power)
        with self.assertRaisesRegex(fs.InputError, "whole results"):
            fs.plots.validation(power.isel(light_angle=0).copy().pipe(without_source))

    def test_each_script_of_results_is_a_function(self):
        for name in fs.plots.scripts():
            with self.subTest(script=name):
                self.assertTrue(getattr(fs.plots, name).__doc__)
        self.assertGreater(len(fs.plots.scripts()), 20)

    def test_nothing_of_the_users_is_changed(self):
        mine = types.ModuleType("lib")
        sys.modules["lib"] = mine
        before = dict(matplotlib.rcParams)
        path = list(sys.path)
        fs.plots.memory_effect(fs.covariance(CURVE))
        self.assertIs(sys.modules.pop("lib"), mine)
        self.assertEqual(dict(matplotlib.rcParams), before)
        self.assertEqual(sys.path, path)


def without_source(result):
    result.encoding.pop("source", None)
    return result


if __name__ == "__main__":
    unittest.main()
