"""Pictures of scattering media: contents of the file, notes, targets, resumption."""

import unittest

import numpy as np

from program import WHOLE, attributes, datasets
from renders import AREA, BEAM, BOX, CAMERA, FIBRE, FOG, METHODS, NAMES, RenderTest, write_density

LIGHT_SPEED = 299792458
NEVER = 1e-12


class Maps(RenderTest):
    RINGS = {"map_cylinder": [0, 0, 0, 0, 0, 4, 1], "map_cells": [3, 5]}
    LAMP = {**BOX, **FOG, "point_light": [0, 0, 1, 1]}

    def test_alone_and_beside_a_picture(self):
        """A map has its own light paths, so its numbers do not depend on other outputs."""
        alone = self.render(**self.LAMP, **self.RINGS, sensor="none")
        self.assertIn("largest fluence", self.output)
        self.assertNotIn("image", alone)
        for method in METHODS:
            beside = self.render(**self.LAMP, **self.RINGS, **CAMERA, method=method)
            for name in ("map/fluence", "map/absorbed"):
                self.assert_within(beside[name], beside[name + "_error"] +
                                   alone[name + "_error"], alone[name])
        np.testing.assert_allclose(alone["map/absorbed"], FOG["mu_a"] * alone["map/fluence"])

    def test_nothing_absorbs(self):
        clear = self.render(**{**self.LAMP, "mu_a": 0}, **self.RINGS, sensor="none")
        np.testing.assert_array_equal(clear["map/absorbed"], 0)

    def test_target(self):
        """A target error applies to the fluence."""
        keys = {**self.LAMP, **self.RINGS, "sensor": "none"}
        target = 0.003
        self.call("render", **keys, samples=10**7, target_error=target, out="aimed.h5")
        found = datasets(self.folder / "aimed.h5")
        self.assertLess(attributes(self.folder / "aimed.h5")["samples"], 10**6)
        relative = np.sqrt(np.mean(found["map/fluence_error"] ** 2) / np.mean(found["map/fluence"] ** 2))
        self.assertLess(relative, target)


class Targets(RenderTest):
    TISSUE = {**BOX, "mu_s": 2, "mu_a": 0.1, **BEAM, "sensor": "radial", "sensor_at": [0, 0, 0]}

    def test_powers(self):
        """Each printed power reaches the target error, also faint ones."""
        self.call("render", **self.TISSUE, radii=[0.1, 0.9], target_error=0.05, out="powers.h5")
        found = datasets(self.folder / "powers.h5")
        self.assertLess((found["power_within_error"] / found["power_within"]).max(), 0.05)

    def test_total(self):
        keys = {**self.TISSUE, "sensor_radius": 0.9, "rings": 200, "target_error": 0.05}
        self.call("render", **keys, target="total", out="total.h5")
        found = datasets(self.folder / "total.h5")
        self.assertLess(found["total_error"], 0.05 * found["total"])
        line = self.call("render", **keys, target="powers", out="none.h5", status=2).stderr
        self.assertIn("requires radii", line)

    def test_samples_per_pixel(self):
        """A batch contains whole pictures."""
        keys = {**BOX, **FOG, **BEAM, **CAMERA, "method": "path"}
        self.call("render", **keys, samples_per_pixel=2**12, out="each.h5")
        self.assertEqual(attributes(self.folder / "each.h5")["samples"] % 24, 0)
        self.assertGreaterEqual(attributes(self.folder / "each.h5")["samples"], 24 * 2**12)
        line = self.call("render", **keys, samples_per_pixel=1, samples=100, out="none.h5", status=2).stderr
        self.assertIn("samples_per_pixel", line)


class Scenes(RenderTest):
    def check_sums(self, found, config):
        """Checks that means and pulses agree with the pixels, with values beyond the bins stored separately.
        Means are also controlled by the light that hits the sensor."""
        image = found["image"]
        self.assertGreater(image.max(), 0)
        several = np.sqrt(np.mean(found["image_error"] ** 2))
        self.assert_within(found["mean"], several, image.mean())
        if "transient" in found:
            beyond = found["transient_before"] + found["transient_after"]
            np.testing.assert_allclose(found["transient"].sum(axis=2) + beyond, image,
                                       atol=1e-12 * image.max())
            whole = found["total"] if "total" in found else found["mean"]
            beyond = found["pulse_before"] + found["pulse_after"]
            area = whole / found["mean"]
            np.testing.assert_allclose((found["pulse"].sum() + beyond) / area, image.mean(), rtol=1e-12)
            np.testing.assert_allclose(found["time"], found["optical_path"] * 1e-3 / LIGHT_SPEED)

    def check_config_runs_again(self):
        self.write("again.toml", attributes(self.folder / "render.h5")["config"])
        self.render("again.h5", config="again.toml", samples=400)
        self.assert_same("render.h5", "again.h5")

    def test_each_runs(self):
        """Runs each scene, by day without the waveguide and the Luneburg ball, which other tests run."""
        for name in NAMES if WHOLE else [name for name in NAMES if name not in ("luneburg", "waveguide")]:
            with self.subTest(scene=name):
                found = self.scene(name, samples=400, pixels=[12, 8])
                for key, values in found.items():
                    self.assertTrue(np.all(np.isfinite(values)), key)
                self.assertEqual(found["image"].shape, (8, 12))
                self.check_sums(found, name)
                for words in ("brightest pixel", "mean of pixels", "relative error", "wrote"):
                    self.assertIn(words, self.output)
                self.assertEqual(attributes(self.folder / "render.h5")["length_unit"], 1e-3)
                if WHOLE or name == "fisheye":
                    self.check_config_runs_again()

    def test_what_few_paths_bring_is_no_estimate(self):
        """Path tracing would have to connect through a hundred mean free paths: no number is better than
        one that is 39 orders too small."""
        found = self.scene("slab", samples=2000, method="path")
        self.assertTrue(np.all(found["total_rare"] == 1))
        for name in ("total power", "mean of pixels"):
            self.assertRegex(self.output, name + " +not resolved")
        self.scene("slab", samples=2000, method="light")
        self.assertNotIn("not resolved", self.output)

    def test_methods(self):
        """All methods run on a curved and on a straight scene and name themselves."""
        for scene in ("luneburg", "glass_ball") if WHOLE else ("luneburg",):
            for method in METHODS:
                with self.subTest(scene=scene, method=method):
                    self.scene(scene, method=method, samples=500, pixels=[6, 4])
                    self.assertIn(method, attributes(self.folder / "render.h5")["plan"])

    def test_the_former_name_of_a_method(self):
        keys = {**BOX, **BEAM, **FOG, **AREA}
        self.render("former.h5", **keys, method="analog")
        self.render(**keys, method="forward")
        self.assert_same("former.h5", "render.h5")
        self.assertIn('method = "forward"', attributes(self.folder / "former.h5")["config"])

    def test_curves_are_counted(self):
        """Curves are counted only if rays are curved or refracted."""
        found = self.render(**BOX, **BEAM, **FOG, **AREA, **FIBRE, method="bidirectional")
        self.assertGreater(found["trials/found"], 0)
        self.assertLessEqual(found["trials/found"], found["trials/pairs"])
        self.assertLessEqual(found["trials/found"], found["trials/converged"])
        self.assertIn("connections:", self.output)
        straight = self.render(**BOX, **BEAM, **FOG, **AREA)
        self.assertNotIn("trials/found", straight)
        self.assertNotIn("connections:", self.output)

    def test_darkness_is_told(self):
        """A beam misses the sensor, and nothing scatters."""
        dark = {**BOX, **CAMERA, "sensor_at": [0.5, 0, 3.9], "samples": 100, "method": "path", "out": "dark.h5"}
        note = "note: no light reached the sensor"
        told = self.call("render", **dark, **BEAM)
        self.assertEqual(told.stderr.count(note), 1)
        self.assertNotIn("few high-weight paths", told.stderr)  # there are none
        self.assertNotIn("mean of pixels", told.stdout)
        self.assertNotIn(note, self.call("render", **dark, **BEAM, **FOG).stderr)

    def test_sound_that_is_left_out_is_told(self):
        """Sound that is off is not reported."""
        quiet = {**BOX, **BEAM, **FOG, **AREA, "field": "ultrasound", "sound_wavenumber": 3, "samples": 100,
                 "method": "path", "out": "quiet.h5"}
        for amplitude, told in ((0, 0), (1e-12, 1), (1e-3, 0)):
            self.assertEqual(self.call("render", **quiet, amplitude=amplitude).stderr.count("the sound deflects no ray"), told)

    def test_darkness_is_no_result(self):
        """A dark picture has no error, and a run with only a target error ends."""
        dark = {**BOX, **CAMERA, "sensor_at": [0.5, 0, 3.9], "method": "path", "out": "dark.h5"}
        for limit in ({}, {"seconds": 0.2}):
            ended = self.call("render", **dark, **BEAM, target_error=0.1, **limit, status=3)
            self.assertNotIn("error 0", ended.stderr)

    def test_a_target_needs_finite_variance(self):
        """Path tracing to a lamp has infinite variance: a target is rejected, a number of samples accepted."""
        lamp = {**BOX, **FOG, **AREA, "point_light": [0, 0, 1, 1], "method": "path", "out": "lamp.h5"}
        refused = self.call("render", **lamp, target_error=0.1, status=2)
        self.assertIn("target_error = 0.1: requires a method of finite variance", refused.stderr)
        self.call("render", **lamp, samples=100)

    def test_light_that_a_method_misses_is_told(self):
        """A thin beam in fog by path tracing: one run fails, the other has the difference as its error."""
        wide = {"stage_box": [-500, -500, 0, 500, 500, 2], "mu_s": 0.9, "mu_a": 0.1, "beam_light": [0, 0, 0, 0, 0, 1, 1e-3, 1],
                "sensor": "area", "sensor_at": [0, 0, 2], "sensor_size": [1000, 1000], "pixels": [1, 1], "method": "path"}
        told = self.call("render", **wide, target_error=0.01, out="beam.h5", status=3).stderr
        self.assertIn("differs from the mean of the light paths that hit the sensor", told)
        found = datasets(self.folder / "beam.h5")
        self.assertGreater(found["total_error"], 0.2)
        self.assertEqual(found["total_rare"], 1)

    def test_a_light_is_seen_through_a_body(self):
        """A pinhole shows it by every method."""
        keys = {**BOX, **CAMERA, "body_sphere": [0, 0, 2, 0.5], "index": 1.5,
                "point_light": [0, 0, 1, 1]}
        expected = self.render(**keys, samples=20000 if WHOLE else 8000)
        self.assertLess(expected["mean_error"], 0.05 * expected["mean"])
        for method in METHODS:
            found = self.render(**keys, method=method)
            self.assert_within(found["mean"], np.hypot(found["mean_error"], expected["mean_error"]),
                               expected["mean"])

    def test_sound_on_and_off(self):
        """The guide brings more light to the middle of the far side."""
        middle = {}
        for amplitude in (0, 0.001):
            found = self.scene("waveguide", amplitude=amplitude, pixels=[1, 1],
                               sensor_size=[0.4, 0.4], samples=20_000 if WHOLE else 8000)
            middle[amplitude] = found["total"], found["total_error"]
            self.assertIn("curved rays" if amplitude else "straight rays", self.output)
        (off, off_error), (on, on_error) = middle[0], middle[0.001]
        self.assertGreater(on - off, 4 * np.hypot(on_error, off_error))


class SameNumbers(RenderTest):
    KEYS = {**BOX, **BEAM, **FOG, **AREA, "path_bins": [3, 9, 6]}

    def kinds(self):
        """Yields scenes with samples for some batches; by day only one method in a field."""
        for field in ({}, FIBRE):
            for method in METHODS if WHOLE or not field else METHODS[2:]:
                with self.subTest(field=field, method=method):
                    yield {**self.KEYS, **field, "method": method}, 34_000 if method == "photon_map" else 4000

    def test_threads_and_resume(self):
        for keys, samples in self.kinds():
            self.render("1.h5", **keys, threads=1, samples=samples)
            if WHOLE:
                self.render("3.h5", **keys, threads=3, samples=samples)
                self.assert_same_data("1.h5", "3.h5")
            self.render("parts.h5", **keys, threads=3, samples=samples // 2)
            self.render("parts.h5", **keys, samples=samples, resume=True)
            self.assert_same("parts.h5", "1.h5")
            self.assert_same_work("parts.h5", "1.h5")

    def assert_same_work(self, first, second):
        """Checks that counts include all batches, also those before a resumption."""
        first, second = (datasets(self.folder / name, ()) for name in (first, second))
        counts = [name for name in first if name.startswith(("transport/", "trials/"))]
        self.assertGreater(first["transport/flights"], 0)
        for name in counts:
            self.assertEqual(first[name], second[name], name)

    def test_another_scene_may_not_resume(self):
        write_density(self.folder / "d.h5", np.ones((5, 5, 5)))
        keys = {**self.KEYS, "density": "d.h5", "target_error": NEVER}
        self.render(**keys)
        write_density(self.folder / "d.h5", np.full((5, 5, 5), 2.0))
        before = self.listing()
        self.call("render", **keys, samples=9000, resume=True, out="render.h5", status=2)
        self.assertEqual(self.listing(), before)

    def test_seeds_differ(self):
        first = self.render(**self.KEYS)["image"]
        self.assertTrue(np.any(first != self.render(**self.KEYS, seed=2)["image"]))


if __name__ == "__main__":
    unittest.main()
