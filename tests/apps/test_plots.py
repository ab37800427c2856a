"""Each plot script, run as by a user, draws its own kinds of results and rejects all others in one line.
Lines of theory agree with values stored by the program, also between its points."""

import contextlib
import io
import pathlib
import runpy
import sys
import unittest
from unittest import mock

from program import BOX, DATA, SLAB, TILTS, WHOLE, ProgramTest

try:
    import matplotlib
    import matplotlib.figure
except ImportError:
    print("no matplotlib (Debian: python3-matplotlib)")
    sys.exit(77)
import h5py
import numpy as np

PLOTS = DATA.parent / "plots"
sys.path.insert(0, str(PLOTS))
import experiment_map
from lib.experiment import Number
from lib.result_file import Result

FEW = {"samples": 2000, "threads": 1}
DRAWN = "fitted" if WHOLE else "never"
SPACE = {"stage_box": [-1, -1, -1, 1, 1, 1], "mu_s": 1, "point_light": [0, 0, -0.5, 1],
         "sensor": "area", "sensor_at": [0, 0, 1], "sensor_size": [2, 2], "samples": 500,
         "method": "bidirectional"}
RAYS = {"config": DATA / "scenes/trace_luneburg.toml", "path_points": 10}
SHIFTS = {"tilts": [-0.05, 0, 0.05], "shifts": [-0.1, 0, 0.1], "covariance": "tilt_shift"}
SPACE_BOX = {**BOX, "dimension": 3, "height": 20, "camera_pixels": 9, "camera_aperture": 0.1, "view_angles": 0}
# Kinds of results: subcommand and keys.
KINDS = {
    "grid": ("sweep", {**SLAB, "tilts": [0, 0.004, 0.016], "g": [0, 0.5], "albedo": [0.9, 1]}),
    "points": ("sweep", {**SLAB, "tilts": [0, 0.04], "g": None, "optical_depth": None,
                         "points": "points.csv"}),
    "curve": ("covariance", {**SLAB, **TILTS, "tilts": [0, 0.004, 0.016]}),
    "moves": ("covariance", {**BOX, "covariance": "translation", "shifts": [0, 1, 2],
                             "beam_waist": 4, **FEW}),
    "map": ("covariance", {**BOX, **SHIFTS, **FEW}),
    "intensity": ("covariance", {**BOX, "view_angles": [0.1, 0.3], **FEW}),
    "delays": ("covariance", {**SLAB, "delays": [0, 0.01, 0.02]}),
    "frequencies": ("covariance", {**SLAB, "frequency_shifts": [0, 1e-4, 3e-4]}),
    "exposed": ("covariance", {**SLAB, "view_angles": 2.5, "delays": [0, 0.1, 0.3, 1, 3, 10, 30], "exposures": [5, 30],
                               "method": "mc", **FEW}),
    "layers": ("covariance", {"domain": "slab", "layers": "rows.csv", "scatterer": "hg", **TILTS, **FEW}),
    "graded": ("covariance", {**SLAB, "method": "mc", "index_field": "linear", "index_slope": [0, 1e-4], **TILTS, **FEW}),
    "both": ("validate", {**BOX, "view_angles": [0.1, 0.3], "wave_samples": 40, **FEW}),
    "own_places": ("validate", {"scatterer": "soft", "radius": 0.2, "width": 20, "depth": 10, "placement": "three.csv",
                                "view_angles": [0.1, 0.4, 0.9], **FEW}),
    "grains": ("field", {**BOX, "view_angles": [0.005 * i for i in range(40)], "fields": 8, "threads": 1}),
    "fields": ("field", {**BOX, "view_angles": [0.1, 0.2, 0.3], "light_angles": [0, 0.01, 0.2],
                         "fields": 4, "threads": 1}),
    "camera": ("field", {**SPACE_BOX, "tilts": [0, 0.02], "fields": 2, "threads": 1}),
    "foci": ("field", {**BOX, "dimension": 3, "height": 20, "beam_waist": 2, "beam_positions": [-2, 0, 2],
                       "near_sensors": "line.csv", "fields": 3, "paths_per_field": 50, "threads": 1}),
    "scan": ("field", {**SPACE_BOX, "beam_waist": 2, "beam_positions": [-2, 2], "camera_focus": 5, "fields": 2,
                       "paths_per_field": 50, "threads": 1}),
    "moved": ("field", {**SPACE_BOX, "camera_focus": 5, "delays": [0, 1], "diffusion": 0, "velocity": [1, 0], "fields": 2,
                        "paths_per_field": 50, "threads": 1}),
    "cone": ("covariance", {**SPACE_BOX, "view_angles": 3.14159, **FEW}),
    "boils": ("field", {**BOX, "dimension": 3, "height": 8, "view_angles": 0, "camera_pixels": 8, "camera_aperture": 0.2, "fields": 2,
                        "delays": [0, 0.1], "threads": 1}),
    "focused": ("field", {**BOX, "dimension": 3, "height": 8, "view_angles": 0, "camera_pixels": 8, "camera_aperture": 0.2,
                          "camera_focus": 5, "fields": 2, "threads": 1}),
    "frames": ("image", {**BOX, "count": None, "scatterer": "hg", "optical_depth": 1,
                         "object_x": [0, 3], "object_depth": -30, "camera": [-0.5, 0.5], "pixels": 512, "repeats": 2, "threads": 1}),
    "blinks": ("image", {**BOX, "count": None, "scatterer": "hg", "optical_depth": 1, "blinking": "subsets",
                         "object_x": [0, 3], "object_depth": -30, "camera": [-0.5, 0.5], "pixels": 512, "repeats": 2, "threads": 1}),
    "unlit": ("image", {**BOX, "count": None, "scatterer": "hg", "optical_depth": 1, "object_x": [0, 3], "object_depth": -30,
                        "camera": [-0.5, 0.5], "pixels": 512, "repeats": 0, "prediction_paths": 500, "threads": 1}),
    "recovered": ("recover", {"frames": "picture.csv", "frame_axes": "picture", "longest": 12, "starts": 2,
                              "phase_iterations": 8}),
    "contrasts": ("contrast", {"frames": "picture.csv", "frame_axes": "picture", "window": 5, "exposure": 1}),
    "separated": ("recover", {"frames": "frames.csv", "recovery": "sources"}),
    "pictures": ("sweep", {**BOX, "count": None, "optical_depth": None, "of": "image", "scatterer": "hg", "vary": "optical_depth=1,2",
                           "object_x": [0, 3], "object_depth": -30, "camera": [-0.5, 0.5], "pixels": 512, "repeats": 2}),
    "power": ("flux", {**SLAB}),
    "fitted": ("fit", {"free": ["g=0.5:0.95", "optical_depth=1:20"], "depth": 2000, "threads": 1,
                       "measurement": DATA / "measurements/slab_transmission.csv"}),
    "planned": ("fit", {"plan": True, "free": ["g=0.5:0.95", "optical_depth=1:20"], "depth": 2000, "g": 0.8,
                        "optical_depth": 4, "tilts": [0.0002, 0.0006]}),
    "rays": ("trace", RAYS),
    "spot": ("trace", {"config": DATA / "scenes/trace_singlet.toml", "ray_count": 50}),
    "lens": ("design", {"nodes": [3], "directions": 6, "rays_per_direction": 8, "threads": 1}),
    "display": ("design", {"design": "box", "nodes": [7], "goal": "irradiance", "pictures": "asked.csv", "rays_across": 8,
                           "iterations": 2, "threads": 1}),
    "core": ("design", {"design": "guide", "goal": "equal_path", "delta": 0.01, "coefficients": 0, "ray_count": 9}),
    "picture": ("render", {**SPACE, "pixels": [4, 4]}),
    "pulse": ("render", {**SPACE, "pixels": [4, 4], "path_bins": [1, 3, 4]}),
    "light": ("render", {**SPACE, "pixels": [1, 1], "map_cylinder": [0, 0, -1, 0, 0, 1, 1],
                         "map_cells": [3, 4]}),
    "rings": ("render", {**SPACE, "sensor": ["radial", "polar"], "sensor_at": [0, 0, 1], "sensor_size": None,
                         "sensor_radius": 0.9, "sensor_direction": [0, 0, 1], "rings": 5}),
    "tagged": ("render", {**SPACE, "sensor": "radial", "sensor_size": None, "sensor_radius": 0.9, "rings": 3, "method": "forward",
                          "field": "transducers", "transducer": [5e-5, 5, 0, 0, 0, 0, 1, 0, 0, 0], "tag_wavelength": 5e-4}),
    "mixed": ("render", {**SPACE, "sensor": ["radial", "area"], "sensor_radius": 0.9, "sensor_direction": [0, 0, 1], "rings": 5,
                         "pixels": [4, 4]}),
    "spectrum": ("solve", {**BOX, "wavelengths": [0.9, 1.1], "view_angles": [3.0, 3.1]}),
    "points_in_space": ("image", {"dimension": 3, "width": 30, "height": 30, "depth": 5, "scatterer": "hg", "g": 0.9,
                                  "optical_depth": 2, "object_x": [-0.02, 0.02], "camera_pixels": 64,
                                  "camera_aperture": 0.4, "repeats": 2, "starts": 2, "phase_iterations": 8,
                                  "prediction_draws": 2, "prediction_paths": 2000, "paths_per_field": 500}),
    "tissue": ("reflectance", {"depth": 100, "mean_free_path": 0.1, "g": 0.9, "albedo": 0.99, "distances": [5, 10], "ring_width": 1,
                               "delays": [0, 1e-3], "tolerance": 0.05}),
    "tissue_flow": ("reflectance", {"depth": 100, "mean_free_path": 0.1, "g": 0.9, "albedo": 0.99, "distances": [5, 10],
                                    "ring_width": 1, "delays": [0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2], "diffusion": "1e-12 m^2/s",
                                    "wavelength": 850e-6, "length_unit": "mm", "exposures": [2e-3, 1e-2], "source_power": 0.05,
                                    "pixel_area": 1, "tolerance": 0.05}),
    "matrices": ("matrix", {"width": 9.3, "depth": 4, "count": 5, "scatterer": "soft", "radius": 0.2, "shifts": 3, "samples": 4,
                            "numerical_aperture": 0.5}),
    "cell": ("solve", {"width": 9.3, "period": 9.3, "depth": 4, "count": 5, "scatterer": "soft", "radius": 0.2, "map": [-3, 3, -1, 5],
                       "map_pixels": [6, 5]}),
    "near": ("solve", {"placement": DATA / "reference/g10/placement.csv", "scatterer": "soft",
                       "map": [-2, 2, -2, 2], "map_pixels": [6, 5]}),
}
# Kinds of results that each script draws.
OWN = {"memory_effect": {"grid", "points", "curve", "moves", "layers", "graded"}, "memory_range": {"grid", "points"},
       "range_map": {"grid"}, "convergence": {"grid", "points"}, "tilt_shift": {"map"},
       "dws": {"delays", "exposed"}, "contrast": {"exposed"}, "layer_range": {"layers"}, "graded_range": {"graded"},
       "refraction": {"curve", "layers", "graded"},
       "frequency": {"frequencies"}, "validation": {"both", "own_places"}, "speckle_field": {"fields", "grains"},
       "camera_field": {"camera", "boils", "focused", "scan", "moved"}, "focus_matrix": {"foci"},
       "confocal_scan": {"scan"}, "tracked_motion": {"moved"}, "camera_intensity": {"camera", "cone"},
       "recovered_picture": {"recovered"}, "simulated_picture": {"points_in_space"},
       "contrast_map": {"contrasts"}, "image_success": {"pictures"}, "image": {"frames", "blinks"}, "sources": {"blinks", "separated"}, "fit": {"fitted"}, "fit_plan": {"planned"}, "rays": {"rays"}, "spot": {"spot"},
       "design": {"lens", "display", "core"}, "design_methods": {"lens", "display", "core"},
       "render": {"picture", "pulse", "mixed"}, "render_time": {"pulse"},
       "light_map": {"light"}, "matrix": {"matrices"}, "ring_profile": {"rings", "mixed", "tagged"}, "sidebands": {"tagged"}, "tissue": {"tissue", "tissue_flow"}, "reflection_image": {"spectrum"}, "field_map": {"cell", "near"}}


def run_script(name, *words, drawn="fitted"):
    """Returns (exit status, standard output, standard error) of a script that draws coarse pictures: "fitted" as usual,
    "once" without fitting the labels; "never" only makes the figure."""
    save, heard, said = matplotlib.figure.Figure.savefig, io.StringIO(), io.StringIO()

    def coarse(figure, place, **looks):
        if not place.endswith(".png"):  # the other format would take the same time again
            return
        if drawn == "fitted":
            save(figure, place, **{**looks, "dpi": 72})
            return
        pathlib.Path(place).touch()
        if drawn == "once":
            figure.set_layout_engine("none")
            figure.canvas.draw()

    with mock.patch.object(sys, "argv", [str(PLOTS / f"{name}.py"), *map(str, words)]), \
            mock.patch.object(matplotlib.figure.Figure, "savefig", coarse), \
            contextlib.redirect_stdout(said), contextlib.redirect_stderr(heard):
        try:
            runpy.run_path(sys.argv[0], run_name="__main__")
            status = 0
        except SystemExit as end:
            status = end.code
    matplotlib.pyplot.close("all")
    return status, said.getvalue(), heard.getvalue()


class Plots(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.maker = ProgramTest("call")
        cls.maker.setUp()
        cls.addClassCleanup(cls.maker.doCleanups)
        cls.maker.write("asked.csv", "1,2,3,4\n" * 4)
        cls.maker.write("frames.csv", "a,b\n" + "".join(f"{1 + i * i % 7},{1 + i * i % 11}\n" for i in range(80)))
        cls.maker.write("picture.csv", "".join(",".join(str(1 + (i * i + 3 * j * i) % 11) for i in range(64)) + "\n"
                                               for j in range(64)))
        cls.maker.write("line.csv", "x,z\n-2,14\n0,14\n2,14\n")
        cls.maker.write("three.csv", "x,z\n0,1\n3,4\n-5,9\n")
        cls.maker.write("points.csv", "g,optical_depth\n0,1\n0.5,3\n")
        cls.maker.write("rows.csv", "thickness,optical_depth\n4,1\n6,2\n")

    def make(self, kind):
        """Returns the file of a kind, made once for all tests."""
        file = self.maker.folder / f"{kind}.h5"
        if not file.exists():
            subcommand, keys = KINDS[kind]
            self.maker.call(subcommand, out=file.name, **keys)
        return file

    def test_odd_files_end_in_one_line(self):
        names = "method,seed,width,depth,optical_depth,setup_s,samples,cpu_s,relative_error\n"
        tables = {"names.csv": (names, "no rows"), "empty.csv": ("", "no rows"), "other.csv": ("a,b\n1,2\n", "no column method"),
                  "one.csv": (names + "mc,1,2,3,4,5,6,7,8\n", "does not hold"), "ragged.csv": ("a,b\n1\n2,3,4\n", "no CSV table"),
                  "words.csv": (names + "mc,1,2,3,4,5,6,7,x\nwave,1,2,3,4,5,6,7,x\n", "does not hold")}
        for name, (text, why) in tables.items():
            path = self.maker.write(name, text)
            for script in ("methods_error_time", "bias_map", "space_exact"):
                with self.subTest(script=script, file=name):
                    status, _, heard = run_script(script, path)
                    self.assertEqual((status, heard.count("\n")), (2, 1), heard)
                    self.assertIn(name, heard)
                    if script == "methods_error_time":
                        self.assertIn(why, heard)
        for number, parts in enumerate(({"graded_spline": np.ones(3), "profile/r": np.ones(3), "profile/index": np.ones(3)},
                                        {"slice_x": np.ones(3), "slice_z": np.ones(3), "slice_index": np.ones((2, 5))},
                                        {"picture/shown": np.ones(3), "picture/psnr_db": 1.0})):
            path = self.maker.folder / f"odd{number}.h5"
            with h5py.File(path, "w") as file:
                for name, values in parts.items():
                    file[name] = values
            status, _, heard = run_script("design", path)
            self.assertEqual((status, heard.count("\n")), (2, 1), heard)
            self.assertIn(path.name, heard)

    def test_each_draws_its_own_and_refuses_the_others_in_one_line(self):
        """By night all others are tried, by day one in 24. By day every other figure of a script is made, of every
        third the first is drawn, and the labels of every twelfth are fitted."""
        for number, (script, own) in enumerate(OWN.items()):
            for other, kind in enumerate(KINDS):
                if kind != min(own) and (number + other) % (2 if kind in own else 24) and not WHOLE:
                    continue
                file, drawn = self.make(kind), "fitted" if WHOLE or number % 12 == 0 else "once" if number % 3 == 0 else "never"
                with self.subTest(script=script, kind=kind):
                    out = self.folder / f"{script}_{kind}"
                    status, _, heard = run_script(script, file, "--out", out, drawn=drawn if WHOLE or kind == min(own) else "never")
                    if kind in own:
                        self.assertEqual((status, heard), (0, ""))
                        self.assertTrue(out.with_suffix(".png").is_file())
                    else:
                        self.assertEqual((status, heard.count("\n")), (2, 1), heard)
                        self.assertIn(str(file), heard)

    def test_range_of_the_colour_scale(self):
        for low, high, tone, expected in ((0.1, 2, "root", 0), (0, 2, "linear", 0), (0, 2, "log", 2), (2, 1, "root", 2)):
            status, _, heard = run_script("render", self.make("picture"), "--range", low, high, "--tone", tone,
                                          "--out", self.folder / "range", drawn="never")
            self.assertEqual((status, heard.count("\n")), (expected, 1 if expected else 0), heard)

    def test_several_sweeps_stand_in_one_panel(self):
        status, _, heard = run_script("memory_effect", self.make("grid"), self.make("curve"), "--select", "g=0",
                                      "--out", self.folder / "both", drawn=DRAWN)
        self.assertEqual((status, heard), (0, ""))

    def test_missing_data_are_named(self):
        self.assertIn("repeats = 0", run_script("image", self.make("unlit"))[2])
        self.call("sweep", **SLAB, of="flux", vary="albedo=0.9,1", out="flux.h5")
        heard = run_script("experiment_map", self.folder / "flux.h5")[2]
        self.assertIn("reflectance[0]", heard)
        self.assertNotIn("power_within", heard)

    def test_maps_of_experiments_take_one_of_several_numbers(self):
        self.call("sweep", **SPACE, of="render", vary=["mu_a=0,0.5", "g=0,0.3,0.6"], phase="henyey_greenstein", out="map.h5")
        file, out = self.folder / "map.h5", self.folder / "map"
        self.assertEqual(run_script("experiment_map", file, "--value", "total", "--out", out, drawn=DRAWN)[::2], (0, ""))
        self.assertEqual(run_script("experiment_map", file, "--value", "total[0]", "--out", out)[0], 2)
        self.assertIn("beam", run_script("experiment_map", file, "--ideal_lens", "--out", out)[2])
        disks = {**SPACE, "point_light": None, "beam_light": [0, 0, -1, 0, 0, 1, 0.1, 1], "sensor": "radial", "sensor_size": None,
                 "radii": [0.1, 0.5], "vary": ["mu_a=0,0.5,1,2"]}
        self.call("sweep", **disks, of="render", out="disks.h5")
        status, said, heard = run_script("experiment_map", self.folder / "disks.h5", "--value", "power_within[1]", "--ideal_lens",
                                         "--out", out, drawn=DRAWN)
        self.assertEqual((status, heard), (0, ""))
        self.assertIn("star: smallest", run_script("experiment_map", file, "--smallest", "--out", out, drawn=DRAWN)[1])
        self.assertEqual(run_script("experiment_map", self.folder / "disks.h5", "--value", "power_within[2]")[0], 2)

    def test_curves_of_experiments_have_the_derivatives_by_their_key(self):
        self.call("sweep", of="render", field="ultrasound", sound_wavenumber=3.485, stage_box=[-5, -5, 0, 5, 5, 5], mu_s=0.1,
                  phase="isotropic", beam_light=[0, 0, 0, 0, 0, 1, 0.25, 1], sensor="radial", sensor_at=[0, 0, 5],
                  radii=[0.1, 0.2], method="forward", gradient_by="amplitude", samples=2000, vary=["amplitude=1e-3:3e-3:3"],
                  out="derivatives.h5")
        with h5py.File(self.folder / "derivatives.h5") as file:
            place, values = file["amplitude"][...], file["power_within"][:, 1]
            derivatives = file["power_within_gradient"][:, 0, 1]
        number = Number(Result(self.folder / "derivatives.h5"), "power_within[1]")
        np.testing.assert_array_equal(number.derivatives("amplitude"), derivatives)
        self.assertIsNone(number.derivatives("mu_s"))
        axis = mock.Mock()
        experiment_map.draw_tangents(axis, place, values, derivatives)
        for call, at, value, derivative in zip(axis.plot.call_args_list, place, values, derivatives, strict=True):
            x, y = call.args
            np.testing.assert_allclose(y, value + derivative * (x - at), rtol=1e-12)
            self.assertTrue(x.min() <= at <= x.max() and np.ptp(x) > 3e-4)

    def test_captions_say_what_a_reader_does_not_see(self):
        said = run_script("memory_effect", self.make("grid"), "--out", self.folder / "a", drawn=DRAWN)[1]
        self.assertIn("error bars are smaller than the symbols", said)
        said = run_script("speckle_field", self.make("fields"), "--out", self.folder / "b", drawn=DRAWN)[1]
        self.assertIn("not equally spaced", said)


class Theory(ProgramTest):
    """Formulas of the plots agree with those of the program."""

    def test_diffusion_ranges_delays_and_frequencies(self):
        from lib import theory
        from lib.result_file import Result
        for dimension in (2, 3):
            keys = {**SLAB, "dimension": dimension, "g": [0, 0.6], "albedo": [0.9, 1],
                    "tilts": [0, 0.001]}
            self.call("sweep", out="s.h5", **keys)
            sweep = Result(self.folder / "s.h5")
            g, albedo = np.meshgrid(sweep.values("g"), sweep.values("albedo"), indexing="ij")
            found = theory.diffusion_range(1, SLAB["optical_depth"], g, albedo, dimension)
            stored = sweep.values("diffusion_range")
            np.testing.assert_allclose(found, stored.reshape(found.shape), rtol=1e-5)
            delays = [0, 0.01, 0.1]
            self.call("covariance", out="d.h5", dimension=dimension, delays=delays, **SLAB)
            medium = theory.medium(Result(self.folder / "d.h5"))
            np.testing.assert_allclose(
                theory.delayed_diffusion(np.array(delays), False, **medium),
                Result(self.folder / "d.h5").values("diffusion_theory"), rtol=1e-9)
            shifts = [0, 1e-4, 1e-3]
            self.call("covariance", out="f.h5", dimension=dimension, frequency_shifts=shifts, **SLAB)
            np.testing.assert_allclose(
                theory.shifted_diffusion(2 * np.pi * np.array(shifts), False, **medium),
                Result(self.folder / "f.h5").values("frequency_diffusion_theory"), rtol=1e-9)


if __name__ == "__main__":
    unittest.main()
