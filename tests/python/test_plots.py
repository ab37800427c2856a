"""Figures from Python equal those of the scripts, and nothing of the user's is changed."""

import sys
import types
import unittest

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from package import BOX, CURVE, FEW, WHOLE, PackageTest, fs


class Drawn(PackageTest):
    def test_a_curve(self):
        curve = fs.covariance(CURVE, tilts=np.linspace(0, 4e-4, 5))
        figure = fs.plots.memory_effect(curve)
        expected = np.stack([curve.tilt * 1000, curve.field_correlation**2], 1)
        drawn = [line.get_xydata() for line in figure.axes[0].lines]
        self.assertTrue(any(line.shape == expected.shape and np.allclose(line[np.argsort(line[:, 0])], expected, rtol=1e-12)
                            for line in drawn))
        figure.savefig(self.folder / "curve.png")
        self.assertFalse(plt.get_fignums())

    def test_figures_are_whole_however_they_are_saved(self):
        swept = fs.sweep(depth=100, g=[0, 0.5], optical_depth=[2], tilts=[0, 0.01, 0.02])
        both = fs.validate(BOX, view_angles=[0, 0.3], wave_samples=20, **FEW)
        curves = [fs.covariance(CURVE, g=g) for g in (0.8, 0.9)]
        figures = [lambda: fs.plots.validation(both), lambda: fs.plots.memory_effect(*curves), lambda: fs.plots.memory_effect(swept)]
        for figure in (figures if WHOLE else figures[:1]):
            figure = figure()
            box = figure.get_tightbbox(figure.canvas.get_renderer())
            width, height = figure.get_size_inches()
            self.assertTrue(box.x0 >= 0 and box.y0 >= 0 and box.x1 <= width and box.y1 <= height, box)
            self.assertTrue(figure.legends)


class Plots(PackageTest):
    def setUp(self):
        super().setUp()
        self.leave_figures_undrawn()

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

    def test_parts_and_changed_copies_are_refused(self):
        curve = fs.covariance(CURVE)
        changed = curve.copy(deep=True)
        changed["field_correlation"][:] = 0.5
        for other in (curve.isel(tilt=slice(0, 2)), changed, curve * 2, curve.drop_vars("covariance")):
            with self.assertRaisesRegex(fs.InputError, "part of it"):
                fs.plots.memory_effect(other)
            with self.assertRaisesRegex(fs.InputError, "measurement = Dataset"):
                fs.fit(free={"g": (0.5, 0.98)}, depth=1000, optical_depth=4, measurement=[other])
        self.assertTrue(fs.plots.memory_effect(curve.assign(mine=1)).axes)

    def test_labels_say_what_differs(self):
        def labels(*curves):
            return [text.get_text() for text in fs.plots.memory_effect(*curves).legends[0].texts]

        curve = fs.covariance(CURVE)
        self.assertEqual(labels(curve, fs.covariance(CURVE, g=0.8))[:2], ["$g$ = 0.9, transport", "$g$ = 0.8, transport"])
        by_both = labels(curve, fs.covariance(CURVE, method="mc", **FEW))
        self.assertEqual(by_both, ["transport", "Monte Carlo", "lines: diffusion theory"])
        back = fs.covariance(CURVE, view_angles=2.9)
        self.assertIn("view 2.9 rad, reflected, transport", labels(fs.covariance(CURVE, view_angles=0), back))
        self.assertEqual(labels(back)[-1], "lines: diffusion and single scattering")

    def test_a_fixed_number_is_marked_in_the_forward_lobe(self):
        both = fs.validate(BOX, view_angles=[0, 0.3, 1, 2], wave_samples=400, samples=20_000)
        self.assertEqual(list(both.forward), [1, 0, 0, 0])
        self.assertRegex(both.attrs["printed"], "1 forward, 0 beyond.*\n.*fixed number")
        self.assertLess(both.rms_difference, 0.2)
        axes = fs.plots.validation(both).axes
        self.assertLess(axes[1].get_ylim()[1], 60)  # the forward entry, twice as large, does not stretch it
        poisson = fs.validate({**BOX, "count": None, "density": 0.155}, view_angles=[0, 0.3], wave_samples=20, **FEW)
        self.assertEqual(list(poisson.forward), [0, 0])

    def test_a_sweep_over_two_keys_makes_several_curves_or_is_refused(self):
        scene = {"stage_box": [-1, -1, -1, 1, 1, 1], "point_light": [0, 0, -0.5, 1], "sensor": "area",
                 "sensor_at": [0, 0, 1], "sensor_size": [2, 2], "pixels": [1, 1], "phase": "henyey_greenstein", "samples": 500,
                 "method": "path"}
        two = fs.sweep(scene, of="render", vary={"mu_s": [0.5, 1, 2], "mu_a": [0.1, 0.2]})
        self.assertEqual([len(bars.lines[0].get_xdata()) for bars in fs.plots.throughput(two).axes[0].containers], [3, 3])
        three = fs.sweep(scene, of="render", vary={"mu_s": [0.5, 1], "mu_a": [0.1, 0.2], "g": [0, 0.5]})
        many = fs.sweep(scene, of="render", vary={"mu_s": [0.5, 1], "mu_a": list(np.linspace(0.1, 1, 9))})
        for result in (three, many):
            with self.assertRaisesRegex(fs.InputError, "experiment_map"):
                fs.plots.throughput(result)
        with self.assertRaisesRegex(fs.InputError, "varies g besides mu_s and mu_a"):
            fs.plots.throughput(three, curves="mu_a")

    def test_what_a_script_refuses(self):
        power = fs.flux(BOX, **FEW)
        with self.assertRaisesRegex(fs.InputError, "has neither"):
            fs.plots.validation(power)
        with self.assertRaisesRegex(fs.InputError, "has no dataset field") as caught:
            fs.plots.speckle_field(fs.covariance(CURVE, method="mc", **FEW))
        self.assertNotIn("resume", str(caught.exception))

    def test_each_script_of_results_is_a_function(self):
        for name in fs.plots.scripts():
            with self.subTest(script=name):
                self.assertTrue(getattr(fs.plots, name).__doc__)
        self.assertGreater(len(fs.plots.scripts()), 20)
        self.assertEqual(dir(fs.plots), fs.plots.scripts())

    def test_nothing_of_the_users_is_changed(self):
        mine = types.ModuleType("lib")
        sys.modules["lib"] = mine
        before = dict(matplotlib.rcParams)
        path = list(sys.path)
        fs.plots.memory_effect(fs.covariance(CURVE))
        self.assertIs(sys.modules.pop("lib"), mine)
        self.assertEqual(dict(matplotlib.rcParams), before)
        self.assertEqual(sys.path, path)


if __name__ == "__main__":
    unittest.main()
