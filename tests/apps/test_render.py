"""Pictures of scattering media against closed forms, and contents of the file."""

import math
import unittest

import numpy as np

from program import WHOLE, attributes, datasets
from renders import AREA, BEAM, BOX, CAMERA, FIBRE, FOG, SCENES, RenderTest, write_density

NAMES = ["luneburg", "fisheye", "grin_fibre", "waveguide", "glass_ball", "luneburg_pulse", "slab"]
METHODS = ["path", "light", "bidirectional"]
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


class ClosedForms(RenderTest):
    def test_camera_in_a_glass_block(self):
        """A beam along the normal between two faces gives Fresnel's sum and L/n^2."""
        def seen(index):
            return self.render(stage_box=[-2, -2, -2, 2, 2, 2], block=[-1, -1, -1, 1, 1, 1, index, 0, 0, 0],
                               beam_light=[0, 0, -2, 0, 0, 1, 1.5, 1], sensor="camera",
                               sensor_at=[0.1, 0.2, 0.3], sensor_direction=[0, 0, -1],
                               field_of_view=1.2, pixels=[1, 1], samples=500)["mean"]
        reflectance = (0.5 / 2.5)**2
        expected = (1 - reflectance) / (1 - reflectance**2) / 1.5**2
        np.testing.assert_allclose(seen(1.5) / seen(1), expected, rtol=1e-6)

    def test_beam_through_a_clear_graded_ball(self):
        """Behind the focus of a Luneburg ball. Rays at the distance b from the axis leave it at the angle asin(b). Nothing
        scatters and all light hits the sensor, so that rays are counted, without searches for connections."""
        keys = {"field": "luneburg", "radius": 1, "body_sphere": [0, 0, 0, 1], "stage_box": [-2, -2, -2, 2, 2, 2],
                "beam_light": [0, 0, -1.9, 0, 0, 1, 0.5, 1], **AREA, "sensor_at": [0, 0, 2], "sensor_size": [2, 2],
                "pixels": [20, 20], "samples": 60_000}
        found = self.render(**keys, method=None)
        self.assertIn("render: forward", self.output)
        self.assertNotIn("connections:", self.output)
        self.assertAlmostEqual(found["total"], 1, delta=1e-9)
        square = found["row"][:, None]**2 + found["column"]**2
        lit = square < 0.45**2
        expected = 4 / np.pi / (1 + square[lit])**2
        self.assertLess(np.std(found["image"][lit] / expected), 0.05)
        self.assertAlmostEqual(found["image"][lit].mean() / expected.mean(), 1, delta=0.01)

    def test_absorption(self):
        """A beam through an absorbing medium is attenuated exponentially."""
        found = self.render(**BOX, **{**AREA, "sensor_size": [2, 2]}, **BEAM, mu_a=0.3)
        self.assert_within(found["total"], found["total_error"], 2 * np.exp(-0.3 * 4))

    def test_absorption_in_a_density(self):
        """The mean density is one half: linear from 0 to 1 along z, in a grid of 5 nodes."""
        write_density(self.folder / "density.h5", np.tile(np.linspace(0, 1, 5), (5, 5, 1)))
        found = self.render(**BOX, **{**AREA, "sensor_size": [2, 2]}, **BEAM, mu_a=0.3,
                            density="density.h5", samples=20_000)
        self.assert_within(found["total"], found["total_error"], 2 * np.exp(-0.3 * 4 / 2))

    def test_point_light_in_all_directions(self):
        found = self.render(**BOX, point_light=[0.1, 0.2, 1, 3], sensor="directional",
                            half_angle=0.5, pixels=[2, 3], sensor_direction=[1, 0, 1])
        self.assert_within(found["image"], found["image_error"], 3 / (4 * np.pi))

    def test_white_furnace(self):
        """L/n^2 of the environment everywhere (C24), by every method in a straight and a curved
        scene. By light, connections with the pinhole through the field have infinite
        variance, which is reported."""
        for field in ({}, FIBRE):
            for method in METHODS:
                with self.subTest(field=field, method=method):
                    found = self.render(**BOX, **field, **CAMERA, mu_s=0.3, environment=1.5,
                                        method=method, samples=8000)
                    self.assert_within(found["mean"], found["mean_error"], 1.5)
                    if method == "light" and field:
                        self.assertTrue(found["mean_rare"])
                    else:
                        self.assertAlmostEqual(found["mean"], 1.5, delta=0.3)

    def test_arrival(self):
        """Unscattered light through a Luneburg ball arrives in one bin at pi/2 + 1 from one tangent plane
        to the focus (C27)."""
        found = self.scene("luneburg_pulse", body_mu_s=0, path_bins=[2.65, 2.75, 100])
        at = found["optical_path"][np.argmax(found["pulse"])]
        self.assertAlmostEqual(at, 0.1 + 1 + np.pi / 2, delta=3e-3)
        self.assert_within(found["total"], found["total_error"] + 1e-6, 1)  # rays go by steps

    def test_lights_add_up(self):
        both = self.render(**BOX, **FOG, **AREA, **BEAM, point_light=[0, 0, 2, 1], samples=20_000)
        beam = self.render(**BOX, **FOG, **AREA, **BEAM, samples=20_000)
        point = self.render(**BOX, **FOG, **AREA, point_light=[0, 0, 2, 1], samples=20_000)
        errors = [each["total_error"] for each in (both, beam, point)]
        self.assert_within(both["total"], np.linalg.norm(errors), beam["total"] + point["total"])

    def test_random_phase(self):
        """Sound at a random phase per path gives a power between those of the phases 0 and pi."""
        sound = {"random_phase": True, "sensor_size": [0.4, 0.4], "pixels": [1, 1],
                 "samples": 20_000, "mu_s": 0}
        found = {}
        for name, keys in (("random", sound), ("high", {**sound, "random_phase": None}),
                           ("low", {**sound, "random_phase": None, "sound_phase": np.pi})):
            found[name] = self.scene("waveguide", **keys)["total"]
        self.assertGreater(found["high"], 1.1 * found["random"])
        self.assertGreater(found["random"], 1.1 * found["low"])


class Energy(RenderTest):
    """The tally of light adds up to its power and agrees with formulas."""
    BALL = {"stage_box": [-2, -2, -2, 2, 2, 2], "body_sphere": [0, 0, 0, 1], "sensor": "directional"}
    SMOKE = {"body_mu_s": 1, "body_mu_a": 0.3, "body_phase": "isotropic"}
    POINT = {"point_light": [0, 0, -1.5, 3]}
    POINT_INSIDE = {"point_light": [0, 0, 1, 3]}

    def tally(self, **keys):
        found = self.render(**keys)
        power = {name.removeprefix("energy/"): value for name, value in found.items()
                 if name.startswith("energy/")}
        ends = [value for name, value in power.items()
                if name != "emitted" and not name.endswith("_error")]
        self.assertGreater(power["emitted"], 0)
        np.testing.assert_allclose(sum(ends), power["emitted"], rtol=1e-12)
        self.assertGreaterEqual(min(ends), 0)
        return power

    def test_of_scenes(self):
        """Covers all scenes by both methods by night, two by one method by day."""
        for name in NAMES if WHOLE else ("waveguide", "glass_ball"):
            for method in ("light", "bidirectional") if WHOLE else ("light" if name == "glass_ball" else "bidirectional",):
                with self.subTest(name, method=method):
                    self.tally(config=SCENES / f"render_{name}.toml", method=method, samples=200)

    def test_of_media(self):
        write_density(self.folder / "density.h5", np.arange(80.0).reshape(4, 4, 5))
        around = {"method": "light", "index_around": 1.4, **self.BALL, **self.POINT}
        for name, keys in {
                "body": {**around, **self.SMOKE},
                "both": {**around, **self.SMOKE, **FOG, "phase": "henyey_greenstein", "g": 0.9},
                "absorbs": {**around, "body_mu_a": 2, "mu_a": 0.1},
                "curved": {**around, **self.SMOKE, "field": "parabolic", "alpha": 0.5},
                "no loss": {**around, "body_mu_s": 3, "body_phase": "isotropic"},
                "cut": {**around, **self.SMOKE, "max_scatterings": 2},
                "grid": {**BOX, **BEAM, **AREA, "mu_s": 0.1, "mu_a": 0.02, "density": "density.h5"},
                "even": {**BOX, **FOG, "method": "light", "sensor": "directional", "environment": 1}}.items():
            with self.subTest(name):
                power = self.tally(**keys)
                self.assertEqual("cut" in power, name == "cut")
                self.assertEqual("specular" in power, "body_sphere" in keys)

    def assert_tally(self, power, **expected):
        for name, value in expected.items():
            self.assert_within(power[name], power[f"{name}_error"], value)

    def test_absorbing_box(self):
        through = np.exp(-4 * 0.5)
        for beam in (BEAM, {"gaussian_beam": [0, 0, 0, 0, 0, 1, 0.3, 2]}):
            power = self.tally(**BOX, **beam, **AREA, mu_a=0.5, method="light")
            self.assert_tally(power, emitted=2, unscattered=2 * through,
                              absorbed_stage=2 * (1 - through), scattered=0, lost=0)

    def test_reflections_of_an_absorbing_ball(self):
        """A beam through the middle gives a geometric series of reflections."""
        reflected, kept = (0.5 / 2.5) ** 2, np.exp(-2 * 0.4)
        power = self.tally(**self.BALL, index=1.5, body_mu_a=0.4, method="light", samples=40000,
                           beam_light=[0, 0, -2, 0, 0, 1, 1e-5, 1])
        self.assert_tally(power, emitted=1, specular=reflected, scattered=0, absorbed_stage=0,
                          absorbed_body=(1 - reflected) * (1 - kept) / (1 - reflected * kept))

    def test_only_of_methods_that_end_light(self):
        found = self.render(**BOX, **self.POINT_INSIDE, **FOG, **AREA, method="path")
        self.assertFalse([name for name in found if name.startswith("energy")])


class Axes(RenderTest):
    """Unscattered light falls on the expected row and column."""

    def brightest(self, **keys):
        found = self.render(**{**BOX, "pixels": [19, 15], "samples": 2000, **keys})
        row, column = np.unravel_index(found["image"].argmax(), found["image"].shape)
        self.step = abs(found["column"][1] - found["column"][0])
        self.assertAlmostEqual(abs(found["row"][1] - found["row"][0]), self.step)
        self.assertGreater(found["image"].max(), 0.3 * found["image"].sum())
        return found["column"][column], found["row"][row]

    def check(self, column, row, **keys):
        at = self.brightest(**keys)
        np.testing.assert_allclose(at, (column, row), atol=0.51 * self.step)

    def test_area(self):
        """Columns are along outward normal x up, here -x."""
        self.check(-0.31, 0.22, sensor="area", sensor_at=[0, 0, 4], sensor_size=[1.9, 1.5],
                   beam_light=[0.31, 0.22, 0, 0, 0, 1, 0.01, 1])

    def test_directional(self):
        x, y, _ = np.array([0.31, 0.12, 1]) / np.linalg.norm([0.31, 0.12, 1])
        self.check(-x, y, sensor="directional", half_angle=0.6, pixels=[19, 19],
                   beam_light=[0, 0, 0.1, 0.31, 0.12, 1, 0.01, 1])

    def test_camera(self):
        """Columns are along sensor_direction x sensor_up, here x."""
        self.check(0.5 / 2.9, 0.3 / 2.9, **{**CAMERA, "sensor_at": [0, 0, 3.9], "pixels": [19, 15]},
                   point_light=[0.5, 0.3, 1, 1])


class Profiles(RenderTest):
    """Unscattered light of a Gaussian beam and of fibres, through absorption."""

    def test_gaussian_beam(self):
        """Irradiance is a product of differences of error functions over the pixels. Many rays give the
        darkest pixel some tens."""
        found = self.render(**BOX, sensor="area", sensor_at=[0, 0, 4], sensor_size=[1.6, 1.2],
                            pixels=[8, 6], mu_a=0.5, samples=400_000,
                            gaussian_beam=[0.1, 0, 0, 0, 0, 1, 0.3, 2])

        def shares(edges):
            """Returns the share of each column; columns are along -x."""
            return np.diff([math.erf(math.sqrt(2) * edge / 0.3) for edge in edges]) / 2

        columns, rows = shares(np.linspace(-0.8, 0.8, 9) + 0.1), shares(np.linspace(-0.6, 0.6, 7))
        expected = 2 * np.exp(-2) * np.outer(rows, columns) / 0.2**2
        self.assert_within(found["image"], found["image_error"] + 1e-5, expected)

    def test_fibres(self):
        """The share within an angle, at index 1.5, is the squared ratio of sines."""
        for name, share in (("fibre_light", lambda ratio: ratio**2),
                            ("gaussian_fibre", lambda ratio: -math.expm1(-2 * ratio**2))):
            found = self.render(**BOX, index=1.5, sensor="area", sensor_at=[0, 0, 4],
                                sensor_size=[2, 2], acceptance=0.1, pixels=[1, 1], samples=40_000,
                                **{name: [0, 0, 1.5, 0, 0, 1, 0.2, 0.3, 2]})
            self.assert_within(found["total"], found["total_error"],
                               2 * share(1.5 * math.sin(0.1) / 0.3))


class Paths(RenderTest):
    KEYS = {**BOX, **BEAM, **AREA, "mu_a": 0.1, "index": 1.5}

    def test_moments_of_unscattered_light(self):
        """Each path is 4 long, at index 1.5; some pixels are dark."""
        found = self.render(**self.KEYS, path_moments=True)
        lit = found["image"] > 0
        for name, value in (("path", 6), ("path_square", 36)):
            np.testing.assert_allclose(found[f"mean_{name}"], value, rtol=1e-12)
            np.testing.assert_allclose(found[f"image_{name}"], value * lit, rtol=1e-12)
        self.assertNotIn("transient", found)

    def test_beyond_the_bins(self):
        for bins, name in (([1, 5, 4], "after"), ([7, 9, 4], "before"), ([4, 8, 4], None)):
            found = self.render(**self.KEYS, path_bins=bins)
            for beyond in ("before", "after"):
                whole = found["total"] if beyond == name else 0
                np.testing.assert_allclose(found[f"pulse_{beyond}"], whole, rtol=1e-12)
            np.testing.assert_allclose(found["pulse"].sum(), 0 if name else found["total"], rtol=1e-12)

    def test_rings_are_what_areas_are(self):
        """Power on a disk and by angle agrees with the tally of light."""
        scene = {**BOX, **FOG, "point_light": [0, 0, 3, 1], "samples": 40_000, "method": "light"}
        whole = self.render(**scene, sensor="polar", rings=5, largest_angle=math.pi)
        ends = ("unscattered", "scattered")
        error = whole["total_error"] + sum(whole[f"energy/{end}_error"] for end in ends)
        self.assert_within(whole["total"], error, sum(whole[f"energy/{end}"] for end in ends))
        disk = self.render(**scene, sensor="radial", sensor_at=[0, 0, 4], sensor_radius=0.9, rings=3)
        areas = np.pi * 0.3**2 * (2 * np.arange(3) + 1)
        np.testing.assert_allclose(disk["image"] @ areas, disk["total"], rtol=1e-12)
        np.testing.assert_allclose(disk["radius"], [0.15, 0.45, 0.75])
        face = self.render(**scene, sensor="area", sensor_at=[0, 0, 4], sensor_size=[2, 2], pixels=[1, 1])
        self.assertLess(disk["total"], face["total"])


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
