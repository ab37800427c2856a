"""`optimise`: the best values of keys, evaluated with independent random numbers, however often it was killed."""

import shutil
import signal
import time
import unittest

import h5py
import numpy as np

from program import WHOLE, ProgramTest, datasets

SOUND = {"field": "ultrasound", "index": 1.3333, "sound_wavenumber": 3.4851}
# Sound that focuses a thin beam at the far side; the paraxial amplitude has a closed form.
Q = (np.pi / 40) ** 2
PARAXIAL = Q * 1.3333 / (3.4851 ** 2 / 2 - Q)
FOCUS = {**SOUND, "of": "trace", "light": "line", "ray_count": 5, "beam_radius": 0.01,
         "stop_plane": [0, 0, 20, 0, 0, 1], "max_length": 40, "step": 0.05, "integrator": "leapfrog",
         "vary": [f"amplitude={PARAXIAL / 1.5}:{PARAXIAL * 1.4}"], "minimise": "spot_radius"}
GUIDE = {**SOUND, "stage_box": [-2, -2, 0, 2, 2, 8], "mu_s": 0.2, "phase": "henyey_greenstein", "g": 0.8,
         "beam_light": [0, 0, 0, 0, 0, 1, 0.3, 1], "sensor": "area", "sensor_at": [0, 0, 8], "sensor_size": [0.3, 0.3],
         "pixels": [1, 1], "method": "light", "vary": ["amplitude=1e-4:1.2e-2:log", "sound_order=0,1"],
         "maximise": "total", "scattered": 12, "target_error": 0.1, "threads": 2, "against": "amplitude=0"}


class Optimise(ProgramTest):
    @classmethod
    def setUpClass(cls):
        """Makes the search of GUIDE once, on two threads."""
        cls.maker = ProgramTest("call")
        cls.maker.setUp()
        cls.addClassCleanup(cls.maker.doCleanups)
        cls.maker.call("optimise", **GUIDE, out="whole.h5")

    def whole(self):
        shutil.copy(self.maker.folder / "whole.h5", self.folder)

    def found(self, path):
        return datasets(self.folder / path, ("wall_s", "cpu_s"))

    def assert_same(self, a, b):
        a, b = self.found(a), self.found(b)
        self.assertEqual(a.keys(), b.keys())
        for name, values in a.items():
            if not name.endswith("cpu_s"):
                np.testing.assert_array_equal(values, b[name], name)

    def test_focus_in_closed_form(self):
        """A thin beam near the axis gives the paraxial amplitude."""
        self.call("optimise", **FOCUS, out="focus.h5")
        found = self.found("focus.h5")
        self.assertAlmostEqual(float(found["best/amplitude"]) / PARAXIAL, 1, delta=0.002)
        self.assertEqual(found["best/value_error"], 0)
        self.assertLess(found["spot_radius"], 1e-4)
        with h5py.File(self.folder / "focus.h5") as file:
            self.assertNotIn("at_bounds", file["best"].attrs)

    def test_foci_of_a_square_beam(self):
        """The aberration of a 0.5 mm beam requires 1.061 of the paraxial amplitude: power on a small disk peaks there."""
        for length in (10, 20, 30, 45) if WHOLE else (10,):
            q = (np.pi / 2 / length) ** 2
            paraxial = q * 1.3333 / (3.4851 ** 2 / 2 - q)
            self.call("optimise", **{**FOCUS, "light": "square", "ray_count": 500, "beam_radius": 0.25,
                                     "stop_plane": [0, 0, length, 0, 0, 1], "max_length": 100,
                                     "vary": [f"amplitude={paraxial / 1.5}:{paraxial * 1.5}"]}, out=f"{length}.h5")
            self.assertAlmostEqual(float(self.found(f"{length}.h5")["best/amplitude"]) / paraxial / 1.061, 1, delta=0.01)

    def test_the_result_is_that_of_the_best(self):
        """The result's datasets equal those of a separate run at the best values, with a fresh seed."""
        self.whole()
        found = self.found("whole.h5")
        keys = {key: GUIDE[key] for key in GUIDE if key not in ("vary", "maximise", "scattered", "target_error",
                                                                "against")}
        last = found["search/draw"] == 2
        self.call("render", **{**keys, "amplitude": float(found["best/amplitude"]),
                               "sound_order": int(found["best/sound_order"])},
                  seed=3, samples=int(found["search/samples"][last].max()), out="one.h5")
        one = self.found("one.h5")
        self.assertEqual(found["total"], one["total"])
        self.assertEqual(found["best/value"], one["total"])
        self.assertAlmostEqual(float(found["best/value_error"] / one["total_error"]), 1, delta=0.5)
        self.assertLess(found["best/value_error"] / found["best/value"], 0.1)
        self.assertGreater(found["best/gain"], 1)
        self.assertAlmostEqual(float(found["best/gain"] * found["against/value"]), float(found["best/value"]), 12)
        with h5py.File(self.folder / "whole.h5") as file:
            self.assertEqual(file.attrs["objective"], "total")
            self.assertEqual(list(file["search"].attrs["swept"]), ["amplitude", "sound_order"])
            self.assertEqual(len(file["search/amplitude"]), len(file["search/value"]))

    def test_minimise_by_transport(self):
        """The reflectance of a slab by transport is least at the smallest thickness."""
        done = self.call("optimise", of="flux", domain="slab", scatterer="hg", depth=100, albedo=0.99, light_angles=0,
                         g=0.5,
                  vary=["optical_depth=1:4", "g=0:0.9"], minimise="reflectance[0]", scattered=8, out="flux.h5")
        found = self.found("flux.h5")
        self.assertAlmostEqual(float(found["best/optical_depth"]), 1, delta=0.01)
        self.assertAlmostEqual(float(found["best/g"]), 0.9, delta=0.01)
        self.assertEqual(found["best/value_error"], 0)
        self.assertEqual(found["best/confidence"], 1)
        with h5py.File(self.folder / "flux.h5") as file:
            self.assertEqual(list(file["best"].attrs["at_bounds"]), ["optical_depth", "g"])
        self.assertIn("optical_depth, g; a wider range", done.stdout)

    def test_a_phase_has_no_bounds(self):
        """Sound focuses best at phase 0, which equals 2 pi."""
        for phases, at_bounds in (("0:6.2832", None), ("0:6", ["sound_phase"])):
            with self.subTest(phases=phases):
                self.call("optimise", **{**FOCUS, "amplitude": PARAXIAL, "vary": [f"sound_phase={phases}"]}, out="phase.h5")
                self.assertAlmostEqual(np.cos(float(self.found("phase.h5")["best/sound_phase"])), 1, delta=1e-3)
                with h5py.File(self.folder / "phase.h5") as file:
                    found = file["best"].attrs.get("at_bounds")
                    self.assertEqual(found if found is None else list(found), at_bounds)

    def test_threads(self):
        self.call("optimise", **{**GUIDE, "threads": 1}, out="one.h5")
        self.whole()
        self.assert_same("one.h5", "whole.h5")

    def test_killed_again_and_again(self):
        self.whole()
        for number in (signal.SIGKILL, signal.SIGTERM, signal.SIGKILL):
            process = self.start("optimise", **GUIDE, out="killed.h5", resume=True)
            time.sleep(0.3)
            process.send_signal(number)
            process.communicate(timeout=60)
        self.call("optimise", **GUIDE, out="killed.h5", resume=True)
        self.assert_same("killed.h5", "whole.h5")
        self.assertFalse((self.folder / "killed.h5.evaluations").exists())
        again = self.call("optimise", **GUIDE, out="killed.h5", resume=True)
        self.assertIn("nothing to resume", again.stdout)

    def test_time(self):
        done = self.call("optimise", **GUIDE, seconds=1e-3, out="short.h5", status=3)
        self.assertIn("continue with --resume", done.stdout)
        self.assertFalse(self.attribute("short.h5", "complete"))
        self.call("optimise", **GUIDE, resume=True, out="short.h5")
        self.whole()
        self.assert_same("short.h5", "whole.h5")

    def attribute(self, path, name):
        with h5py.File(self.folder / path) as file:
            return bool(file.attrs[name])

    def test_a_place_without_a_result(self):
        """A failing place is named; with bounds that exclude it the search continues with finished evaluations."""
        keys = {**FOCUS, "field": "homogeneous", "lens": [0, 0, 0, 12.5, 60, 0, 5, 1.5168, 0, 0, 0], "light": "disk",
                "ray_count": 20, "origin": [0, 0, -20], "beam_radius": 5, "sound_wavenumber": None, "index": None,
                "stop_plane": [0, 0, 50, 0, 0, 1], "image_plane": [0, 0, 100, 0, 0, 1], "max_length": None,
                "integrator": None, "minimise": "image/spot_radius", "out": "lens.h5"}
        failed = self.call("optimise", **{**keys, "vary": ["max_length=19:22"]}, status=2)
        self.assertRegex(failed.stderr, "point max_length=.*: image_plane")
        self.assertEqual([path.name for path in self.folder.iterdir()], ["lens.h5.evaluations"])
        self.call("optimise", **{**keys, "vary": ["max_length=21.5:22"]}, resume=True)
        self.assertEqual([path.name for path in self.folder.iterdir()], ["lens.h5"])

    def test_refused(self):
        for change, words in (
                ({"maximise": None}, ("maximise", "minimise")),
                ({"minimise": "total"}, ("maximise", "minimise")),
                ({"maximise": "totl"}, ("totl", "total", "mean")),
                ({"maximise": "image[0]"}, ("image", "1 x 1", "image[0,0]")),
                ({"maximise": "image[0"}, ("image[0", "must be")),
                ({"vary": None}, ("vary",)),
                ({"vary": ["amplitude=1:0"]}, ("amplitude=1:0", "low:high")),
                ({"vary": ["amplitude=0:1:log"]}, ("amplitude", "above 0")),
                ({"vary": ["amplitude"]}, ("amplitude", "low:high")),
                ({"vary": ["sound_order=0,1"]}, ("sweep",)),
                ({"vary": ["samples=1:2"]}, ("samples", "does not change the result")),
                ({"vary": ["amplitude=0:1e-3", "amplitude=0:1e-3"]}, ("varied twice",)),
                ({"vary": ["amplitude=0:1e-3", "g=0:2"]}, ("g", "-1")),
                ({"vary": ["amplitude=0:1e-3", "seed=1:9:9"]}, ("seed=1:9:9", "several seeds")),
                ({"vary": ["amplitude=0:1e-3", "g=0.8:0.9:4", "mu_s=0.1:0.2:4"]}, ("scattered = 12", "16")),
                ({"of": "place"}, ("of", "render")),
                ({"against": "amplitude"}, ("amplitude",)),
                ({"target_error": 2}, ("target_error",))):
            with self.subTest(change=change):
                failed = self.call("optimise", **{**GUIDE, **change}, out="no.h5", status=2)
                lines = [line for line in failed.stderr.splitlines() if line.startswith("flatspeckle")]
                self.assertEqual(len(lines), 1, failed.stderr)
                for word in words:
                    self.assertIn(word, lines[0])
                self.assertEqual(list(self.folder.iterdir()), [])


if __name__ == "__main__":
    unittest.main()
