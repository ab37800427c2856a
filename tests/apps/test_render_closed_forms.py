"""Pictures and powers of scattering media against closed forms."""

import math
import unittest

import numpy as np

from program import WHOLE
from renders import AREA, BEAM, BOX, CAMERA, FIBRE, FOG, METHODS, NAMES, SCENES, RenderTest, write_density


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


if __name__ == "__main__":
    unittest.main()
