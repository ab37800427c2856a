"""Pictures of scattering media against closed forms, what the file holds, what is refused."""

import math
import unittest

import h5py
import numpy as np

from program import DATA, ProgramTest, attributes, datasets

SCENES = DATA / "scenes"
NAMES = ["luneburg", "fisheye", "grin_fibre", "waveguide", "glass_ball", "luneburg_pulse", "slab"]
METHODS = ["path", "light", "bidirectional", "photon_map"]
LIGHT_SPEED = 299792458
BOX = {"stage_box": [-1, -1, 0, 1, 1, 4]}
BEAM = {"beam_light": [0, 0, 0, 0, 0, 1, 0.3, 2]}
FOG = {"mu_s": 0.4, "mu_a": 0.1}
AREA = {"sensor": "area", "sensor_at": [0, 0, 4], "sensor_size": [1, 0.8], "pixels": [4, 3]}
CAMERA = {"sensor_at": [0.2, 0, 3.9], "sensor_direction": [0, 0, -1], "field_of_view": 1,
          "pixels": [6, 4]}
FIBRE = {"field": "parabolic", "index": 1.5, "alpha": 0.5}
NEVER = 1e-12
COST = ("wall_s", "cpu_s", "state", "trials", "transport")  # differs from run to run, or when resumed


def write_density(path, density, **attributes):
    with h5py.File(path, "w") as file:
        data = file.create_dataset("density", data=density)
        data.attrs["origin"] = attributes.get("origin", np.array([-1.0, -1, 0]))
        data.attrs["spacing"] = attributes.get("spacing", np.array([0.5, 0.5, 1]))


class RenderTest(ProgramTest):
    def render(self, name="render.h5", **keys):
        keys = {"samples": 4000, "threads": 2, **keys}
        status = 3 if "target_error" in keys else 0
        self.output = self.call("render", **keys, out=name, status=status).stdout
        return datasets(self.folder / name)

    def scene(self, scene, **keys):
        return self.render(config=SCENES / f"render_{scene}.toml", **keys)

    def assert_within(self, value, error, expected, count=4):
        np.testing.assert_array_less(np.abs(value - expected), count * error + 1e-12)


class Maps(RenderTest):
    RINGS = {"map_cylinder": [0, 0, 0, 0, 0, 4, 1], "map_cells": [3, 5]}
    LAMP = {**BOX, **FOG, "point_light": [0, 0, 1, 1]}

    def test_alone_and_beside_a_picture(self):
        """Its light paths are its own: whatever else is asked for, its numbers are the same."""
        alone = self.render(**self.LAMP, **self.RINGS, sensor="none")
        self.assertIn("largest fluence", self.output)
        self.assertNotIn("image", alone)
        for method in METHODS:
            if method != "photon_map":  # of larger batches
                beside = self.render(**self.LAMP, **self.RINGS, **CAMERA, method=method)
                for name in ("map/fluence", "map/absorbed"):
                    self.assert_within(beside[name], beside[name + "_error"] +
                                       alone[name + "_error"], alone[name])
        np.testing.assert_allclose(alone["map/absorbed"], FOG["mu_a"] * alone["map/fluence"])

    def test_target(self):
        """A target is of the fluence."""
        keys = {**self.LAMP, **self.RINGS, "sensor": "none"}
        target = 0.003
        self.call("render", **keys, samples=10**7, target_error=target, out="aimed.h5")
        found = datasets(self.folder / "aimed.h5")
        self.assertLess(attributes(self.folder / "aimed.h5")["samples"], 10**6)
        relative = np.sqrt(np.mean(found["map/fluence_error"] ** 2) / np.mean(found["map/fluence"] ** 2))
        self.assertLess(relative, target)


class Scenes(RenderTest):
    def check_sums(self, found, config):
        """Totals and pulses are those of the pixels; what is beyond the bins stands beside them."""
        image = found["image"]
        self.assertGreater(image.max(), 0)
        np.testing.assert_allclose(found["mean"], image.mean(), rtol=1e-12)
        if "transient" in found:
            beyond = found["transient_before"] + found["transient_after"]
            np.testing.assert_allclose(found["transient"].sum(axis=2) + beyond, image,
                                       atol=1e-12 * image.max())
            whole = found["total"] if "total" in found else found["mean"]
            beyond = found["pulse_before"] + found["pulse_after"]
            np.testing.assert_allclose(found["pulse"].sum() + beyond, whole, rtol=1e-12)
            np.testing.assert_allclose(found["time"], found["optical_path"] * 1e-3 / LIGHT_SPEED)

    def test_each_runs(self):
        for name in NAMES:
            with self.subTest(scene=name):
                found = self.scene(name, samples=500, pixels=[12, 8])
                for key, values in found.items():
                    self.assertTrue(np.all(np.isfinite(values)), key)
                self.assertEqual(found["image"].shape, (8, 12))
                self.check_sums(found, name)
                for words in ("brightest pixel", "mean of pixels", "relative error", "wrote"):
                    self.assertIn(words, self.output)
                self.assertEqual(attributes(self.folder / "render.h5")["length_unit"], 1e-3)

    def test_methods(self):
        """All of them run on a curved and on a straight scene, and say which they are."""
        for scene in ("luneburg", "glass_ball"):
            for method in METHODS:
                with self.subTest(scene=scene, method=method):
                    self.scene(scene, method=method, samples=500, pixels=[6, 4])
                    self.assertIn(method, attributes(self.folder / "render.h5")["plan"])

    def test_curves_are_counted(self):
        """Where rays are curved or refracted, and there alone."""
        found = self.render(**BOX, **BEAM, **FOG, **AREA, **FIBRE)
        self.assertGreater(found["trials/found"], 0)
        self.assertLessEqual(found["trials/found"], found["trials/pairs"])
        self.assertLessEqual(found["trials/found"], found["trials/converged"])
        self.assertIn("joins:", self.output)
        straight = self.render(**BOX, **BEAM, **FOG, **AREA)
        self.assertNotIn("trials/found", straight)
        self.assertNotIn("joins:", self.output)

    def test_darkness_is_told(self):
        """A beam beside the sensor, and nothing that scatters."""
        dark = {**BOX, **CAMERA, "sensor_at": [0.5, 0, 3.9], "samples": 100, "out": "dark.h5"}
        note = "note: no light came to the sensor"
        self.assertEqual(self.call("render", **dark, **BEAM).stderr.count(note), 1)
        self.assertNotIn(note, self.call("render", **dark, **BEAM, **FOG).stderr)

    def test_a_light_is_seen_through_a_body(self):
        """By a pinhole, whatever the method."""
        keys = {**BOX, **CAMERA, "body_sphere": [0, 0, 2, 0.5], "index": 1.5,
                "point_light": [0, 0, 1, 1]}
        expected = self.render(**keys, samples=20000)
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
                               sensor_size=[0.4, 0.4], samples=20_000)
            middle[amplitude] = found["total"], found["total_error"]
            self.assertIn("curved rays" if amplitude else "straight rays", self.output)
        (off, off_error), (on, on_error) = middle[0], middle[0.001]
        self.assertGreater(on - off, 4 * np.hypot(on_error, off_error))


class ClosedForms(RenderTest):
    def test_camera_in_a_glass_block(self):
        """A beam along the normal, between two faces: Fresnel's sum, and L/n^2."""
        def seen(index):
            return self.render(stage_box=[-2, -2, -2, 2, 2, 2], block=[-1, -1, -1, 1, 1, 1, index, 0, 0, 0],
                               beam_light=[0, 0, -2, 0, 0, 1, 1.5, 1], sensor="camera",
                               sensor_at=[0.1, 0.2, 0.3], sensor_direction=[0, 0, -1],
                               field_of_view=1.2, pixels=[1, 1], samples=500)["mean"]
        reflectance = (0.5 / 2.5)**2
        expected = (1 - reflectance) / (1 - reflectance**2) / 1.5**2
        np.testing.assert_allclose(seen(1.5) / seen(1), expected, rtol=1e-6)

    def test_absorption(self):
        """A beam through a medium that absorbs."""
        found = self.render(**BOX, **{**AREA, "sensor_size": [2, 2]}, **BEAM, mu_a=0.3)
        self.assert_within(found["total"], found["total_error"], 2 * np.exp(-0.3 * 4))

    def test_absorption_in_a_density(self):
        """Half the density on average: linear from 0 to 1 along z, in a grid of 5 nodes."""
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
        scene."""
        for field in ({}, FIBRE):
            for method in METHODS:
                with self.subTest(field=field, method=method):
                    found = self.render(**BOX, **field, **CAMERA, mu_s=0.3, environment=1.5,
                                        method=method, samples=8000, photon_radius=0.4
                                        if method == "photon_map" else None)
                    if method != "photon_map":
                        self.assert_within(found["mean"], found["mean_error"], 1.5)
                    self.assertAlmostEqual(found["mean"], 1.5, delta=0.3)

    def test_arrival(self):
        """Unscattered light through a Luneburg ball: pi/2 + 1 from one tangent plane to the focus
        (C27), in one bin."""
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
        """Sound that each path meets at its own time is neither that at its height nor none."""
        sound = {"random_phase": True, "sensor_size": [0.4, 0.4], "pixels": [1, 1],
                 "samples": 20_000, "mu_s": 0}
        found = {}
        for name, keys in (("random", sound), ("high", {**sound, "random_phase": None}),
                           ("low", {**sound, "random_phase": None, "sound_phase": np.pi})):
            found[name] = self.scene("waveguide", **keys)["total"]
        self.assertGreater(found["high"], 1.1 * found["random"])
        self.assertGreater(found["random"], 1.1 * found["low"])


class Energy(RenderTest):
    """What becomes of the light adds up to it, and to what formulas say."""
    BALL = {"stage_box": [-2, -2, -2, 2, 2, 2], "body_sphere": [0, 0, 0, 1], "sensor": "directional"}
    SMOKE = {"body_mu_s": 1, "body_mu_a": 0.3, "body_phase": "isotropic"}
    POINT = {"point_light": [0, 0, -1.5, 3]}
    POINT_INSIDE = {"point_light": [0, 0, 1, 3]}

    def fates(self, **keys):
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
        for name in NAMES:
            for method in ("light", "bidirectional"):
                with self.subTest(name, method=method):
                    self.fates(config=SCENES / f"render_{name}.toml", method=method, samples=500)

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
                power = self.fates(**keys)
                self.assertEqual("cut" in power, name == "cut")
                self.assertEqual("specular" in power, "body_sphere" in keys)

    def assert_fates(self, power, **expected):
        for name, value in expected.items():
            self.assert_within(power[name], power[f"{name}_error"], value)

    def test_absorbing_box(self):
        through = np.exp(-4 * 0.5)
        for beam in (BEAM, {"gaussian_beam": [0, 0, 0, 0, 0, 1, 0.3, 2]}):
            power = self.fates(**BOX, **beam, **AREA, mu_a=0.5, method="light")
            self.assert_fates(power, emitted=2, unscattered=2 * through,
                              absorbed_stage=2 * (1 - through), scattered=0, lost=0)

    def test_reflections_of_an_absorbing_ball(self):
        """A beam through the middle: a geometric series of reflections."""
        reflected, kept = (0.5 / 2.5) ** 2, np.exp(-2 * 0.4)
        power = self.fates(**self.BALL, index=1.5, body_mu_a=0.4, method="light", samples=40000,
                           beam_light=[0, 0, -2, 0, 0, 1, 1e-5, 1])
        self.assert_fates(power, emitted=1, specular=reflected, scattered=0, absorbed_stage=0,
                          absorbed_body=(1 - reflected) * (1 - kept) / (1 - reflected * kept))

    def test_only_of_methods_that_end_light(self):
        for method in ("path", "photon_map"):
            found = self.render(**BOX, **self.POINT_INSIDE, **FOG, **AREA, method=method)
            self.assertFalse([name for name in found if name.startswith("energy")])


class Axes(RenderTest):
    """Unscattered light is where row and column say."""

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
        """Columns along outward normal x up, here -x."""
        self.check(-0.31, 0.22, sensor="area", sensor_at=[0, 0, 4], sensor_size=[1.9, 1.5],
                   beam_light=[0.31, 0.22, 0, 0, 0, 1, 0.01, 1])

    def test_directional(self):
        x, y, _ = np.array([0.31, 0.12, 1]) / np.linalg.norm([0.31, 0.12, 1])
        self.check(-x, y, sensor="directional", half_angle=0.6, pixels=[19, 19],
                   beam_light=[0, 0, 0.1, 0.31, 0.12, 1, 0.01, 1])

    def test_camera(self):
        """Columns along sensor_direction x sensor_up, here x."""
        self.check(0.5 / 2.9, 0.3 / 2.9, **{**CAMERA, "sensor_at": [0, 0, 3.9], "pixels": [19, 15]},
                   point_light=[0.5, 0.3, 1, 1])


class Profiles(RenderTest):
    """Unscattered light of a Gaussian beam and of fibres, through absorption."""

    def test_gaussian_beam(self):
        """Irradiance: products of differences of error functions over the pixels. Many rays, so that
        the darkest pixel has some tens."""
        found = self.render(**BOX, sensor="area", sensor_at=[0, 0, 4], sensor_size=[1.6, 1.2],
                            pixels=[8, 6], mu_a=0.5, samples=400_000,
                            gaussian_beam=[0.1, 0, 0, 0, 0, 1, 0.3, 2])

        def shares(edges):
            """Columns are along -x."""
            return np.diff([math.erf(math.sqrt(2) * edge / 0.3) for edge in edges]) / 2

        columns, rows = shares(np.linspace(-0.8, 0.8, 9) + 0.1), shares(np.linspace(-0.6, 0.6, 7))
        expected = 2 * np.exp(-2) * np.outer(rows, columns) / 0.2**2
        self.assert_within(found["image"], found["image_error"] + 1e-5, expected)

    def test_fibres(self):
        """What arrives within an angle, at index 1.5: the square of the ratio of sines."""
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
        """Power on a disk and by angle, as fates of light say."""
        scene = {**BOX, **FOG, "point_light": [0, 0, 3, 1], "samples": 40_000, "method": "light"}
        whole = self.render(**scene, sensor="polar", rings=5, largest_angle=math.pi)
        fates = ("unscattered", "scattered")
        error = whole["total_error"] + sum(whole[f"energy/{fate}_error"] for fate in fates)
        self.assert_within(whole["total"], error, sum(whole[f"energy/{fate}"] for fate in fates))
        disk = self.render(**scene, sensor="radial", sensor_at=[0, 0, 4], sensor_radius=0.9, rings=3)
        areas = np.pi * 0.3**2 * (2 * np.arange(3) + 1)
        np.testing.assert_allclose(disk["image"] @ areas, disk["total"], rtol=1e-12)
        np.testing.assert_allclose(disk["radius"], [0.15, 0.45, 0.75])
        face = self.render(**scene, sensor="area", sensor_at=[0, 0, 4], sensor_size=[2, 2], pixels=[1, 1])
        self.assertLess(disk["total"], face["total"])


class SameNumbers(RenderTest):
    KEYS = {**BOX, **BEAM, **FOG, **AREA, "path_bins": [3, 9, 6]}

    def kinds(self):
        for field in ({}, FIBRE):
            for method in METHODS:
                with self.subTest(field=field, method=method):
                    yield {**self.KEYS, **field, "method": method}

    def assert_same(self, first, second):
        first, second = (datasets(self.folder / name, COST) for name in (first, second))
        self.assertEqual(first.keys(), second.keys())
        for name, values in first.items():
            self.assertEqual(np.asarray(values).tobytes(), np.asarray(second[name]).tobytes(), name)

    def test_threads(self):
        for keys in self.kinds():
            for threads in (1, 3):
                self.render(f"{threads}.h5", **keys, threads=threads, samples=40_000)
            self.assert_same_data("1.h5", "3.h5")

    def test_resume(self):
        for keys in self.kinds():
            self.render("parts.h5", **keys, samples=17_000)
            self.render("parts.h5", **keys, samples=34_000, resume=True)
            self.render("whole.h5", **keys, samples=34_000)
            self.assert_same("parts.h5", "whole.h5")

    def test_another_scene_may_not_resume(self):
        write_density(self.folder / "d.h5", np.ones((5, 5, 5)))
        keys = {**self.KEYS, "density": "d.h5", "target_error": NEVER}
        self.render(**keys)
        write_density(self.folder / "d.h5", np.full((5, 5, 5), 2.0))
        before = self.listing()
        self.call("render", **keys, samples=9000, resume=True, out="render.h5", status=2)
        self.assertEqual(self.listing(), before)

    def test_config_runs_again(self):
        for name in NAMES:
            with self.subTest(scene=name):
                self.scene(name, samples=200, pixels=[3, 2])
                self.write("again.toml", attributes(self.folder / "render.h5")["config"])
                self.render("again.h5", config="again.toml", samples=200)
                self.assert_same("render.h5", "again.h5")

    def test_seeds_differ(self):
        first = self.render(**self.KEYS)["image"]
        self.assertTrue(np.any(first != self.render(**self.KEYS, seed=2)["image"]))


class Refused(RenderTest):
    GOOD = {**BOX, **BEAM, **FOG, **AREA, "samples": 100}

    def refuse(self, *words, **keys):
        """One line that holds the words, status 2, and nothing written."""
        before = self.listing()
        done = self.call("render", status=2, **{"out": "bad.h5", **self.GOOD, **keys})
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for word in words:
            self.assertIn(str(word), done.stderr)
        self.assertEqual(self.listing(), before)

    def test_the_scene_itself_is_good(self):
        self.render(**self.GOOD)

    def test_stages(self):
        self.refuse("stage is not given", "boundary", stage_box=None)
        self.refuse("stage is not given", "boundary", stage_box=None, **FIBRE)
        self.refuse("give one stage", stage_sphere=[0, 0, 0, 9])
        self.refuse("stage_box = 1 1 1 0 0 0", stage_box=[1, 1, 1, 0, 0, 0])
        self.refuse("stage_box", "6 numbers", stage_box=[1, 1, 1])
        self.refuse("stage_sphere, radius = 0", stage_box=None, stage_sphere=[0, 0, 0, 0])
        self.refuse("body", "inside of the stage", body_sphere=[0, 0, 2, 1.5])
        self.refuse("give one body", body_sphere=[0, 0, 2, 0.5], body_box=[0, 0, 1, 0.1, 0.1, 2])
        self.refuse("body_sphere, radius = -1", body_sphere=[0, 0, 2, -1])
        self.refuse("index_around", "a body", index_around=1.3)
        self.refuse("index_around = 0", index_around=0, body_sphere=[0, 0, 2, 0.5])
        self.refuse("body_mu_s", "a body", body_mu_s=1)
        self.refuse("max_length = 0", max_length=0, **FIBRE)
        self.refuse("max_length", "is a key of", max_length=9)
        self.refuse("step = -1", step=-1, **FIBRE)
        self.refuse("step = 1e-09", "at least", step=1e-9, **FIBRE)
        self.refuse("step = 7", "the field varies over 2", step=7, **FIBRE)
        self.refuse("step", "is a key of", step=0.1)
        self.refuse("length_unit = 0", length_unit=0)

    def test_fields(self):
        self.refuse("index", "must be positive", field="linear", slope=[0, 0, -0.5])
        self.refuse("index", "in all of the body", field="linear", slope=[0, 0, -0.5],
                    body_box=[-1, -1, 1, 1, 1, 3])
        self.refuse("index", "positive", **{**FIBRE, "alpha": 2})
        self.refuse("index = 0", index=0)
        self.refuse("luneburg", "rim", field="luneburg", centre=[0, 0, 2],
                    body_sphere=[0, 0, 2, 1.01], stage_box=[-2, -2, 0, 2, 2, 4])
        self.refuse("must be inside of the stage; of luneburg", field="luneburg")
        self.refuse("luneburg in a sum", field=["luneburg", "linear"], centre=[0, 0, 2],
                    slope=[0, 0, 0.01])
        self.refuse("alpha", "is a key of", alpha=1)
        self.refuse("random_phase", "ultrasound", random_phase=True)
        self.refuse("sound_phase", "is a key of", field="ultrasound", amplitude=1e-3, sound_phase=1,
                    sound_wavenumber=1, random_phase=True)
        with h5py.File(self.folder / "small.h5", "w") as file:
            data = file.create_dataset("excess", data=np.zeros((5, 5, 5)))
            data.attrs["origin"], data.attrs["spacing"] = np.array([-1.0, -1, 0]), np.full(3, 0.5)
        self.refuse("grid", "ends inside of the stage", field="grid", grid="small.h5")

    def test_media(self):
        self.refuse("mu_s = -1", "negative", mu_s=-1)
        self.refuse("mu_a = -0.1", "negative", mu_a=-0.1)
        self.refuse("mu_s = nan", mu_s="nan")
        self.refuse("mu_s = 1e+07", "too dense", mu_s=1e7, mu_a=None)
        self.refuse("body_mu_s = 1e+07", "too dense", body_mu_s=1e7, body_sphere=[0, 0, 2, 0.5])
        self.refuse("body_mu_s = -1", body_mu_s=-1, body_sphere=[0, 0, 2, 0.5])
        self.refuse("body_g = 2", body_mu_s=1, body_phase="henyey_greenstein", body_g=2,
                    body_sphere=[0, 0, 2, 0.5])
        self.refuse("phase = schlick", phase="schlick")
        self.refuse("size_parameter is not given", phase="mie", sphere_index="1.33")
        self.refuse("size_parameter = 1e+05", "from 1e-06 to 10000", phase="mie", sphere_index="1.33",
                    size_parameter=1e5)
        for index, why in (("1-1i", "amplify"), ("1", "does not scatter"), ('"x"', "a number such as")):
            self.refuse(f"sphere_index = {index}", why, phase="mie", size_parameter=2,
                        sphere_index=index.strip('"'))
        self.refuse("g = 1", "in (-1, 1)", phase="henyey_greenstein", g=1)
        self.refuse("g", "is a key of", g=0.5)
        self.refuse("phase", "is a key of", mu_s=None, mu_a=None, phase="rayleigh")

    def test_densities(self):
        write_density(self.folder / "flat.h5", np.ones((5, 5)))
        write_density(self.folder / "thin.h5", np.ones((5, 5, 1)))
        write_density(self.folder / "low.h5", np.full((5, 5, 5), -1.0))
        write_density(self.folder / "nan.h5", np.full((5, 5, 5), np.nan))
        write_density(self.folder / "still.h5", np.ones((5, 5, 5)), spacing=np.zeros(3))
        write_density(self.folder / "odd.h5", np.ones((5, 5, 5)), origin=np.zeros(2))
        with h5py.File(self.folder / "empty.h5", "w"):
            pass
        for name, what in (("flat", "axes"), ("thin", ""), ("low", "-1"), ("nan", "nan"),
                           ("still", "spacing"), ("odd", "origin"), ("empty", "density")):
            self.refuse(f"density: {name}.h5", what, density=f"{name}.h5")
        self.refuse("density = absent.h5: no such file", density="absent.h5")
        write_density(self.folder / "far.h5", np.ones((5, 5, 5)), origin=np.array([2.0, 0, 0]))
        self.refuse("density: the grid, from 2 0 0", "outside of the stage", density="far.h5")
        # most of the stage is beside the grid: it is all tentative collisions
        write_density(self.folder / "speck.h5", np.ones((2, 2, 2)),
                      origin=np.array([0, 0, 1.0]), spacing=np.full(3, 1e-3))
        for limit in (None, 2):
            self.refuse("mu_s = 1e+14", "too dense", "tentative", density="speck.h5", mu_s=1e14,
                        max_scatterings=limit)
        self.refuse("body_mu_a = 1e+14", "tentative", body_density="speck.h5", body_mu_a=1e14,
                    body_box=[-0.5, -0.5, 0.5, 0.5, 0.5, 1.5])

    def test_lights(self):
        self.refuse("light is not given", beam_light=None)
        self.refuse("point_light", "4 numbers", point_light=[0, 0, 1])
        self.refuse("point_light, power = 0", point_light=[0, 0, 1, 0])
        self.refuse("point_light = 1e+200", point_light=[0, 0, 1, 1e200])
        self.refuse("point_light, position = 0.25 0 5", "inside the stage",
                    point_light=[0.25, 0, 5, 1])
        self.refuse("beam_light", "8 numbers", beam_light=[0, 0, 0, 0, 0, 1])
        self.refuse("beam_light, direction = 0 0 0", beam_light=[0, 0, 0, 0, 0, 0, 0.1, 1])
        self.refuse("beam_light, radius = 1.1", "inside the stage",
                    beam_light=[0, 0, 0, 0, 0, 1, 1.1, 1])
        self.refuse("beam_light", "into the stage", beam_light=[0, 0, 0, 0, 0, -1, 0.1, 1])
        self.refuse("beam_light, radius = 0", beam_light=[0, 0, 0, 0, 0, 1, 0, 1])
        self.refuse("gaussian_beam, radius = 0.4: its disk of radius 1.2", "inside the stage",
                    gaussian_beam=[0, 0, 0, 0, 0, 1, 0.4, 1])
        self.refuse("fibre_light", "9 numbers", fibre_light=[0, 0, 0, 0, 0, 1, 0.1, 1])
        self.refuse("fibre_light, aperture = 1.1", "at most the index",
                    fibre_light=[0, 0, 0, 0, 0, 1, 0.1, 1.1, 1])
        self.refuse("fibre_light, aperture = 0", fibre_light=[0, 0, 0, 0, 0, 1, 0.1, 0, 1])
        self.refuse("gaussian_fibre, direction = 0 0 -1", "into the stage",
                    gaussian_fibre=[0, 0, 0, 0, 0, -1, 0.1, 0.1, 1])
        self.refuse("face_light", face_light=[0, 0, 1, 0.1, 1])
        self.refuse("face_light, radiance = -1", face_light=[0, 0, 0, 0.1, -1])
        self.refuse("environment = 0", environment=0)
        self.refuse("environment = 1e+200", environment=1e200)

    def test_sensors(self):
        camera = {**{key: None for key in AREA}, **CAMERA}
        directional = {**{key: None for key in AREA}, "sensor": "directional", "pixels": [2, 2]}
        self.refuse("sensor = eye", sensor="eye")
        self.refuse("sensor_at is not given", sensor_at=None)
        self.refuse("sensor_at = 0 0 3", "boundary", sensor_at=[0, 0, 3])
        self.refuse("sensor_size = 3 1:", sensor_size=[3, 1])
        self.refuse("sensor_size = 1", "2 numbers for each: width height", sensor_size=[1])
        self.refuse("sensor_size is not given", sensor_size=None)
        self.refuse("sensor_up", sensor_up=[0, 0, 1])
        self.refuse("acceptance = 2", acceptance=2)
        radial = {**{key: None for key in AREA}, "sensor": "radial", "sensor_at": [0, 0, 4]}
        self.refuse("rings is not given", **radial, sensor_radius=0.5)
        self.refuse("rings = 0", **radial, sensor_radius=0.5, rings=0)
        self.refuse("sensor_radius = 1.1", "within one face", **radial, sensor_radius=1.1, rings=2)
        self.refuse("pixels", **{**radial, "pixels": [2, 2]}, sensor_radius=0.5, rings=2)
        self.refuse("rings", "is a key of", rings=3)
        self.refuse("pixels = 0", pixels=[0, 3])
        self.refuse("pixels = 4", "columns rows", pixels=[4])
        self.refuse("field_of_view", "is a key of", field_of_view=1)
        self.refuse("field_of_view is not given", **{**camera, "field_of_view": None})
        self.refuse("field_of_view = 4", **{**camera, "field_of_view": 4})
        self.refuse("sensor_at", "inside the stage", **{**camera, "sensor_at": [0, 0, 5]})
        self.refuse("sensor_up", "along", **camera, sensor_up=[0, 0, 1])
        self.refuse("focus_distance", "is a key of", **camera, focus_distance=1)
        self.refuse("focus_distance is not given", **camera, lens_radius=0.1)
        self.refuse("sensor_at", "boundary", **camera, lens_radius=0.1, focus_distance=2)
        self.refuse("half_angle = 0", **directional, half_angle=0)
        self.refuse("sensor_at", "is a key of", **{**directional, "sensor_at": [0, 0, 4]})

    def test_maps(self):
        box = {"map_box": [-1, -1, 0, 1, 1, 4]}
        rings = {"map_cylinder": [0, 0, 0, 0, 0, 4, 1]}
        self.refuse("map_cells is not given", **box)
        self.refuse("map_cells", "x, y and z", **box, map_cells=[2, 3])
        self.refuse("map_cells", "radius and axis", **rings, map_cells=[2, 3, 4])
        self.refuse("map_cells = 0", **box, map_cells=[2, 3, 0])
        self.refuse("map_cells = 2.5e+06", **box, map_cells=[1000, 500, 5])
        self.refuse("map_cells", "is a key of", map_cells=[2, 3, 4])
        self.refuse("map_box, map_cylinder", **box, **rings, map_cells=[2, 3])
        self.refuse("map_box", "low corner first", map_box=[1, 1, 4, -1, -1, 0], map_cells=[2, 3, 4])
        self.refuse("map_box", "outside of the stage", map_box=[1, 1, 4, 2, 2, 5], map_cells=[2, 3, 4])
        self.refuse("map_cylinder", "radius", map_cylinder=[0, 0, 0, 0, 0, 0, 1], map_cells=[2, 3])
        self.refuse("map_cylinder", "outside of the stage", map_cylinder=[0, 0, 9, 0, 0, 8, 1],
                    map_cells=[2, 3])
        none = {"sensor": "none", "sensor_at": None, "sensor_size": None, "pixels": None}
        self.refuse("sensor = none", "map_box", **none)
        self.refuse("sensor = none", "alone", sensor=["none", "area"])
        self.refuse("method = path", "map", **none, **rings, map_cells=[2, 3], method="path")
        self.refuse("pixels", **{**none, "pixels": [2, 2]}, **rings, map_cells=[2, 3])

    def test_bins_and_methods(self):
        self.refuse("path_bins = 1 2", path_bins=[1, 2])
        self.refuse("path_bins = 2 1 5", path_bins=[2, 1, 5])
        self.refuse("path_bins = 1 2 1.5", path_bins=[1, 2, 1.5])
        self.refuse("path_bins = 1 2 1", path_bins=[1, 2, 1])
        self.refuse("pixels x path_bins", path_bins=[1, 2, 90_000], pixels=[10, 10])
        self.refuse("method = magic", method="magic")
        self.refuse("photon_radius", "is a key of", photon_radius=0.1)
        self.refuse("photon_radius = 0", method="photon_map", photon_radius=0)
        self.refuse("max_scatterings = -1", max_scatterings=-1)
        self.refuse("samples = 0", samples=0)
        self.refuse("target_error", target_error=2)
        self.refuse("mu_z", mu_z=1)
        self.refuse("out is not given", out=None)


if __name__ == "__main__":
    unittest.main()
