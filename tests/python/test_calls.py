"""Calls: arrays are passed unchanged, rejections name the key, an interrupted run is resumed, a repeated call
costs nothing."""

import functools
import os
import signal
import subprocess
import threading
import time
import unittest
import warnings
from unittest import mock

import h5py
import numpy as np
import xarray

from package import BOX, CURVE, FEW, ROOT, SLAB, PackageTest, fs

from flatspeckle import functions, program

LONG = {**BOX, "view_angles": [0.1, 0.5, 1], "samples": 1_000_000, "threads": 1}
MOST_CPU_S = 0.15  # of this process alone


class Results(PackageTest):
    def test_as_in_the_file(self):
        result = fs.covariance(CURVE)
        self.assertIsInstance(result, xarray.Dataset)
        with h5py.File(result.encoding["source"]) as file:
            np.testing.assert_array_equal(result.covariance, file["covariance"][()])
            np.testing.assert_array_equal(result.tilt, CURVE["tilts"])
            self.assertEqual(result.covariance.dims, ("tilt", "view_angle"))
            self.assertEqual(result.covariance.attrs["units"], file["covariance"].attrs["units"])
            self.assertEqual(result.field_correlation_error.attrs["long_name"],
                             file["field_correlation_error"].attrs["long_name"])
            self.assertEqual(result.attrs["git_commit"], file.attrs["git_commit"])
        self.assertIs(result.attrs["converged"], True)

    def test_channels_of_a_periodic_cell_are_axes(self):
        cell = fs.solve(width=3.3, period=3.3, depth=2, count=5, scatterer="tm", radius=0.2, index=1.4, solver="fast")
        self.assertEqual(cell.scattering_matrix.dims, ("light_side", "light_sine", "side", "sine"))
        np.testing.assert_allclose(cell.sine, np.arange(-3, 4) / 3.3)
        t = cell.scattering_matrix.sel(light_side=0, side=1)
        np.testing.assert_allclose((abs(t) ** 2).sum(), cell.transmission_eigenvalue.sum())
        self.assertLess(float(cell["invariants/unit_cell"]), 1e-9)

    def test_groups(self):
        result = fs.validate(BOX, wave_samples=4, **FEW)
        mc = fs.group(result, "mc")
        np.testing.assert_array_equal(mc.intensity, result["mc/intensity"])
        self.assertIn("view_angle", mc.coords)
        with self.assertRaisesRegex(KeyError, "mc, .*wave"):
            fs.group(result, "nothing")

    def test_a_file_of_ones_own(self):
        path = self.folder / "mine.h5"
        result = fs.covariance(CURVE, out=path)
        xarray.testing.assert_identical(result.drop_vars("x", errors="ignore"), fs.read(path).assign_attrs(
            printed=result.attrs["printed"]))

    def test_ranges_that_are_bounds(self):
        """They are NaN, with the bound in a variable of its own; the file contains the bound and a mark."""
        result = fs.covariance(CURVE, tilts=[0, 1e-6, 2e-6])
        with h5py.File(result.encoding["source"]) as file:
            self.assertEqual(file["memory_effect_range"].attrs["censored"], 1)
            self.assertEqual(float(result.memory_effect_range_at_least), file["memory_effect_range"][()])
        for name in ("memory_effect_range", "memory_effect_range_error", "memory_effect_range_at_most"):
            self.assertTrue(np.isnan(float(result[name])), name)
        self.assertEqual(result.memory_effect_range_at_least.attrs["units"], "1")

    def test_many_scenes_at_once(self):
        scene = {"stage_box": [-1, -1, -1, 1, 1, 1], "point_light": [0, 0, -0.5, 1], "sensor": "area",
                 "sensor_at": [0, 0, 1], "sensor_size": [2, 2], "pixels": [1, 1], "samples": 500}
        result = fs.sweep(scene, of="render", vary={"mu_s": [0.5, 1], "mu_a": "0,0.1"})
        self.assertEqual(result.total.sizes, {"mu_s": 2, "mu_a": 2})
        alone = fs.render(scene, mu_s=0.5, mu_a=0.1)
        self.assertEqual(float(result.total.sel(mu_s=0.5, mu_a=0.1)), float(alone.total))


class Arrays(PackageTest):
    def test_places(self):
        places = fs.place(width=20, depth=10, radii=[0.2], count=20, seed=3)
        solved = fs.solve(placement=places.to_pandas(), scatterer="soft", view_angles=np.linspace(0, 3, 4))
        for name in ("x", "z", "radius"):
            np.testing.assert_array_equal(solved[f"placement/{name}"], places[name])
        again = fs.solve(placement={name: places[name] for name in ("x", "z", "radius")}, scatterer="soft",
                         view_angles=np.linspace(0, 3, 4))
        self.assertEqual(solved.encoding["source"], again.encoding["source"])

    def test_places_of_ones_own(self):
        places = np.array([[0, 1], [3, 4], [-5, 9]])
        result = fs.validate(width=20, depth=10, scatterer="soft", radius=0.2, placement=places, view_angles=[0.3, 1, 2], **FEW)
        np.testing.assert_array_equal(np.stack([result["placement/x"], result["placement/z"]], 1), places)
        with self.assertRaisesRegex(fs.InputError, "^placement = array of shape .3, 2.: takes no table here .in solve and validate"):
            fs.covariance(BOX, placement=places)

    def test_bounds_and_values_of_searches(self):
        from flatspeckle import keys, scene
        rows = keys.rows_for("optimise", {"of": "render"})
        vary = {"amplitude": (1e-4, 4e-3, "log"), "mu_s": (0.5, 1), "sound_order": [0, 1], "index": "1.3:1.4"}
        self.assertEqual(scene.all_texts({"vary": vary, "against": {"amplitude": 0}}, rows),
                         {"vary": ["amplitude=0.0001:0.004:log", "mu_s=0.5:1", "sound_order=0,1", "index=1.3:1.4"],
                          "against": ["amplitude=0"]})
        of_sweep = keys.rows_for("sweep", {"of": "render"})
        self.assertEqual(scene.all_texts({"vary": {"mu_s": (0.5, 1)}}, of_sweep), {"vary": ["mu_s=0.5,1.0"]})
        self.assertIn("help(flatspeckle.render)", fs.sweep.__doc__)

    def test_sensors(self):
        at = np.array([[0, 13], [3, 15 + 1 / 3]])
        result = fs.covariance(BOX, near_sensors=at, **FEW)
        np.testing.assert_array_equal(np.stack([result.sensor_x, result.sensor_z], 1), at)

    def test_pairs(self):
        pairs = np.array([[0, 0.1, 0.04, 0.14], [0, 0.5, 0, 0.5]])
        result = fs.covariance(BOX, covariance="pairs", pairs=pairs, **FEW)
        names = ("pair_light_1", "pair_view_1", "pair_light_2", "pair_view_2")
        np.testing.assert_array_equal(np.stack([result[name] for name in names], 1), pairs)

    def test_densities_and_layers(self):
        cells = np.array([[1, 2, 0.5], [1, 0, 1.5]])
        result = fs.covariance(width=20, depth=10, density=0.155, density_map=cells, **FEW)
        centres = {"map_density_z": [2.5, 7.5], "map_density_x": [-7, 0, 7]}
        np.testing.assert_allclose(result.relative_density.sel(centres, method="nearest"), cells)
        layers = {"thickness": [3.0, 4], "optical_depth": [1 / 3, 2]}
        result = fs.covariance(domain="slab", scatterer="hg", layers=layers, **FEW)
        np.testing.assert_allclose(result.layer_optical_depth, layers["optical_depth"], rtol=1e-12)

    def test_grids_of_the_index(self):
        """In a constant index the optical path of a ray is n times its length."""
        grid = {"excess": np.full((4, 4, 4), 0.5), "origin": [-3, -3, -3], "spacing": [2, 2, 2]}
        result = fs.trace(field="grid", grid=grid, origin=[0, 0, -2], ray_count=1, max_length=3)
        np.testing.assert_allclose(result.optical_path, 1.5 * 3, rtol=1e-6)

    def test_complex_numbers_and_texts(self):
        scene = {**BOX, "scatterer": "tm", "radius": 0.1, "index": 1.33 + 0.01j, "count": 5}
        self.assertIn('index = "1.33+0.01i"', fs.solve(scene).attrs["config"])
        angle = fs.solve(scene, view_angles="0:pi:3").view_angle
        np.testing.assert_array_equal(angle, [0, np.pi / 2, np.pi])

    def test_measured_curves(self):
        """The three ways to pass the same curve give the same medium."""
        curve = fs.covariance(CURVE, tilts=np.linspace(0, 4e-4, 9), method="mc", samples=20_000)
        medium = {"free": {"g": (0.5, 0.98)}, "depth": 1000, "optical_depth": 4}
        found = [fs.fit(medium, measurement=measured) for measured in (curve, curve.encoding["source"])]
        xarray.testing.assert_equal(*found)
        far = curve.isel(tilt=slice(1, None))
        table = {"tilt": far.tilt, "field_correlation": far.field_correlation, "error": far.field_correlation_error}
        found = fs.fit(medium, measurement=[table])
        self.assertLess(abs(float(found.estimate[0]) - SLAB["g"]), 4 * float(found.estimate_error[0]))


class Refusals(PackageTest):
    def refused(self, subcommand, *scenes, **given):
        with self.assertRaises(fs.InputError) as caught:
            getattr(fs, subcommand)(*scenes, **given)
        return caught.exception.key, caught.exception.value, caught.exception.accepted

    def test_key_value_and_what_is_accepted(self):
        self.assertEqual(self.refused("covariance", depth=-3), ("depth", "-3", "must be positive"))
        self.assertEqual(self.refused("covariance", domain="ball"), ("domain", "ball", "must be one of box slab"))
        self.assertEqual(self.refused("covariance", domain="slab")[0::2], ("depth", "must be positive"))
        key, _, accepted = self.refused("covariance", SLAB, depht=1)
        self.assertEqual(key, "depht")
        self.assertIn("did you mean depth?", accepted)
        self.assertEqual(self.refused("covariance", SLAB, layers="no.csv")[::2], ("layers", "no such file"))

    def test_before_the_program_sees_it(self):
        self.assertEqual(self.refused("covariance", BOX, structure='a"b')[0], "structure")
        self.assertEqual(self.refused("covariance", BOX, near_sensors=np.zeros((2, 3)))[0], "near_sensors")
        with self.assertRaises(AttributeError):
            fs.nothing

    def test_nothing_is_left_of_what_was_refused(self):
        self.refused("covariance", SLAB, out=self.folder / "new.h5", samples=-1)
        self.assertFalse((self.folder / "new.h5").exists())

    def test_missed_targets_are_warnings(self):
        for _ in ("run", "cached"):
            with self.assertWarns(fs.TargetMissed):
                result = fs.covariance(BOX, target_error=1e-9, **FEW)
            self.assertIs(result.attrs["converged"], False)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            fs.covariance(BOX, **FEW)

    def test_without_the_program(self):
        with mock.patch.dict(os.environ, FLATSPECKLE="/nowhere"), self.assertRaisesRegex(OSError, "FLATSPECKLE"):
            fs.covariance(BOX)


class Interruption(PackageTest):
    @staticmethod
    @functools.cache
    def whole():
        return fs.covariance(LONG, cache=False)

    def interrupt(self):
        """Interrupts as by Ctrl-C, after the program has had time for some batches."""
        while not any(self.folder.rglob(".*.h5.lock")):
            time.sleep(0.01)
        time.sleep(0.1)
        os.kill(os.getpid(), signal.SIGINT)

    def interrupted(self, **given):
        thread = threading.Thread(target=self.interrupt, daemon=True)
        thread.start()
        with self.assertRaises(KeyboardInterrupt):
            fs.covariance(LONG, **given)
        thread.join()

    def assert_same(self, one, other):
        for name in ("intensity", "intensity_error"):
            np.testing.assert_array_equal(one[name], other[name])

    def test_goes_on(self):
        whole = self.whole()
        self.interrupted()
        files = list((self.folder / "cache").rglob("result.h5"))
        self.assertEqual(len(files), 1)
        with h5py.File(files[0]) as file:
            done = file.attrs["samples"] if "samples" in file.attrs else 0
            self.assertIn("state", file)
        resumed = fs.covariance(LONG, resume=True)
        self.assertLess(done, LONG["samples"])
        self.assert_same(whole, resumed)
        self.assertIn('resume = "true"', files[0].with_name("scene.toml").read_text())
        self.assert_same(whole, fs.covariance(LONG))

    def test_in_a_file_of_ones_own(self):
        self.interrupted(out=self.folder / "mine.h5")
        self.assert_same(self.whole(),
                         fs.covariance(LONG, out=self.folder / "mine.h5", resume=True))

    def test_the_program_is_gone(self):
        self.interrupted()
        children = subprocess.run(["ps", "--ppid", str(os.getpid()), "-o", "comm="], capture_output=True, text=True)
        self.assertNotIn("flatspeckle", children.stdout)


class Cache(PackageTest):
    def test_a_call_again(self):
        first = fs.covariance(CURVE)
        with mock.patch.object(functions, "run", side_effect=AssertionError("runs again")):
            begin = time.process_time()
            again = fs.covariance(CURVE, threads=1)
            self.assertLess(time.process_time() - begin, MOST_CPU_S)
        xarray.testing.assert_identical(first, again)

    def test_not_of_what_differs(self):
        first = fs.covariance(CURVE)
        self.assertNotEqual(first.encoding["source"], fs.covariance(CURVE, seed=2, **FEW).encoding["source"])
        table = self.folder / "layers.csv"
        depths = []
        for depth in (1, 2):  # in files of the same name
            table.write_text(f"thickness,optical_depth\n100,{depth}\n")
            depths.append(float(fs.covariance(domain="slab", scatterer="hg", layers=table).layer_optical_depth[0]))
        self.assertEqual(depths, [1, 2])

    def test_none_and_cleared(self):
        fs.covariance(CURVE, cache=False)
        self.assertFalse((self.folder / "cache/runs").exists())
        fs.covariance(CURVE)
        fs.cache.clear()
        self.assertFalse((self.folder / "cache").exists())

    def test_what_a_call_costs_beside_the_program(self):
        fs.covariance(CURVE)
        begin = time.process_time()
        fs.covariance(CURVE, tilts=[0, 3e-4], threads=1)
        self.assertLess(time.process_time() - begin, MOST_CPU_S)


class Scenes(PackageTest):
    def test_replaced_saved_and_loaded(self):
        scene = fs.Scene(CURVE)
        other = scene.replace(g=0.5, tilts=None, domain="slab")
        self.assertEqual((scene["g"], other["g"], "tilts" in other), (0.9, 0.5, False))
        scene.save(self.folder / "scene.toml")
        first, loaded = fs.covariance(scene), fs.covariance(fs.Scene.load(self.folder / "scene.toml"))
        self.assertEqual(first.encoding["source"], loaded.encoding["source"])

    def test_of_a_result(self):
        first = fs.covariance(CURVE)
        again = fs.covariance(fs.Scene.load(first.encoding["source"]), cache=False)
        np.testing.assert_array_equal(first.covariance, again.covariance)

    def test_of_every_shipped_file(self):
        for path in (ROOT / "data/scenes").glob("*.toml"):
            with self.subTest(scene=path.name):
                self.assertTrue(fs.Scene.load(path))

    def test_version_is_the_programs(self):
        self.assertEqual(fs.__version__, program.table(program.path())["version"])
        self.assertIn(f'version = "{fs.__version__}"', (ROOT / "python/pyproject.toml").read_text())


if __name__ == "__main__":
    unittest.main()
