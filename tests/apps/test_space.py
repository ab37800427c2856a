"""dimension = 3: slabs in 3D, known numbers and contents of files."""

import csv
import math
import os
import unittest
from pathlib import Path

import h5py
import numpy as np

from program import ProgramTest, datasets

DEPTH = 2000
SPACE = {"domain": "slab", "depth": DEPTH, "optical_depth": 10, "method": "transport",
         "dimension": 3}
Q_TILTS = [1.2, 1.4, 1.6]  # conventions, C41
TILTS = {"covariance": "memory_effect", "tilts": [q / (6.283185307179586 * DEPTH) for q in Q_TILTS],
         "tolerance": 1e-5}


class Space(ProgramTest):
    def correlations(self, **keys):
        self.call("covariance", **(SPACE | TILTS | keys), out="x.h5")
        with h5py.File(self.folder / "x.h5") as file:
            self.assertEqual(file.attrs["dimension"], 3)
            self.assertIn("numerical", file.attrs["errors"])
            correlation = file["field_correlation"][:] ** 2
            return file["reference_intensity"][0], correlation, file.attrs["g"]

    def test_known_numbers(self):
        for g, intensity, known in ((0, 0.058862, [0.5923, 0.4977, 0.4106]),
                                    (0.5, 0.10584, [0.5627, 0.4675, 0.3820])):
            found, correlation, mean_cosine = self.correlations(scatterer="hg", g=g)
            self.assertAlmostEqual(found, intensity, delta=1e-5)
            self.assertAlmostEqual(mean_cosine, g, delta=1e-9)
            for one, other in zip(correlation, known):
                self.assertAlmostEqual(one, other, delta=6e-5)

    def test_monte_carlo_has_them_too(self):
        self.call("covariance", **(SPACE | {"method": "mc", "scatterer": "hg", "g": 0}), seed=1,
                  samples=40000, out="x.h5")
        with h5py.File(self.folder / "x.h5") as file:
            self.assertEqual(file.attrs["dimension"], 3)
            self.assertNotIn("errors", file.attrs)
            error = file["intensity_error"][0, 0]
            self.assertAlmostEqual(file["intensity"][0, 0], 0.058862, delta=4 * error)
            self.assertLess(error, 1e-3)

    def test_a_sweep_of_boxes_has_the_curves_of_single_runs(self):
        box = {"dimension": 3, "domain": "box", "width": 20, "height": 10, "depth": 10, "scatterer": "hg", "optical_depth": 1,
               "tilts": [0, 0.02], "tilt_azimuth": 1, "view_angles": 0.3, "view_azimuths": 1, "samples": 4000}
        self.call("sweep", **box, g=[0, 0.5], out="sweep.h5")
        self.call("covariance", **box, g=0.5, covariance="memory_effect", out="one.h5")
        with h5py.File(self.folder / "sweep.h5") as sweep, h5py.File(self.folder / "one.h5") as one:
            alone, swept = one["field_correlation"][:], sweep["field_correlation"][:].squeeze()
            self.assertEqual(swept.shape, (2, 2))
            self.assertLess(abs(swept[1, 1] - alone[1]), 1e-12)
            self.assertGreater(abs(swept[0, 1] - alone[1]), 1e-3)

    def test_a_flow_across_the_plane_of_incidence_rotates_the_phase(self):
        self.call("covariance", dimension=3, domain="box", width=20, height=20, depth=10, scatterer="hg", g=0.5,
                  optical_depth=1, light_angles=0.3, light_azimuths=1, view_angles=0.5, view_azimuths=-1,
                  delays=[0.01, 0.03], diffusion=0, velocity=[1, 2, 5], method="mc", samples=2000, out="x.h5")
        light, view = ([np.sin(a) * np.cos(b), np.cos(a), np.sin(a) * np.sin(b)] for a, b in ((0.3, 1), (0.5, -1)))
        turn = np.dot(np.subtract(light, view), [1, 2, 5])
        with h5py.File(self.folder / "x.h5") as file:
            found = file["complex_correlation"][:].squeeze()
        np.testing.assert_allclose(found, np.exp(-2j * np.pi * np.array([0.01, 0.03]) * turn), atol=1e-12)

    def test_out_of_plane_tilts_show_their_direction(self):
        said = self.call("covariance", dimension=3, domain="box", width=20, height=20, depth=10, scatterer="hg", optical_depth=1,
                         light_angles=0.2, light_azimuths=0.5, view_angles=0.3, view_azimuths=-1, covariance="memory_effect",
                         tilts=[0, 0.02], tilt_azimuth=1, samples=2000, out="x.h5").stdout
        self.assertIn("(0.2, 0.5)", said)
        self.assertIn("(0.3, -1)", said)
        with h5py.File(self.folder / "x.h5") as file:
            self.assertAlmostEqual(file["tilt_q"].attrs["azimuth"], 1.5)

    def test_the_angle_between_the_beams_is_that_of_their_directions(self):
        slab = {"dimension": 3, "domain": "slab", "depth": 20, "scatterer": "hg", "optical_depth": 2, "light_angles": 1, "method": "transport",
                "view_angles": 0.2, "tilts": "0:0.04:9", "tolerance": 0.1}
        for azimuth, names in ((0, []), (np.pi / 2, ["beam_angle"]), (2, ["beam_angle"])):
            self.call("covariance", **slab, covariance="memory_effect", tilt_azimuth=azimuth, out="x.h5")
            self.call("sweep", **slab, tilt_azimuth=azimuth, out="sweep.h5")
            with h5py.File(self.folder / "x.h5") as file, h5py.File(self.folder / "sweep.h5") as sweep:
                self.assertEqual([name for name in file if name == "beam_angle"], names)
                turn, q = file["memory_effect_angle"][()], file["memory_effect_range"][()] / 20 / (2 * np.pi)
                along = np.array([np.cos(azimuth), np.sin(azimuth), 0])
                light = np.array([np.sin(1), 0, np.cos(1)])
                across = np.cross([0, 0, 1], along)  # axis of the rotation
                turned = light * np.cos(turn) + np.cross(across, light) * np.sin(turn) + across * (across @ light) * (1 - np.cos(turn))
                self.assertAlmostEqual(along @ (turned - light), q, delta=1e-9)
                between = np.arccos(light @ turned)
                for one in (file, sweep):
                    self.assertAlmostEqual(one["beam_angle" if names else "memory_effect_angle"][()].item(), between, delta=1e-7)

    def test_the_grain_of_a_camera_is_that_of_a_line_of_views(self):
        """A box of 30 wavelengths has grains of about 0.886 / 30 along x and y; a lens has those of its pupil."""
        box = {"dimension": 3, "width": 30, "height": 30, "depth": 5, "scatterer": "hg", "g": 0.5, "optical_depth": 3, "fields": 6,
               "view_angles": 0, "paths_per_field": 3000}
        self.call("field", **box, camera_pixels=64, camera_aperture=0.3, out="camera.h5")
        self.call("field", **{**box, "view_angles": list(np.arcsin(np.linspace(-0.3, 0.3, 65)))}, out="line.h5")
        self.call("field", **box, camera_pixels=64, camera_aperture=0.3, camera_focus=5, out="lens.h5")
        camera, line, lens = (datasets(self.folder / f"{name}.h5") for name in ("camera", "line", "lens"))
        error = np.hypot(camera["grain_width_error"], line["grain_width_error"])
        self.assertLess(abs(camera["grain_width"] - line["grain_width"]), 4 * error)
        self.assertLess(error, 0.2 * line["grain_width"])
        self.assertLess(abs(lens["grain_width"] / (0.514 / 0.3) - 1), 0.1)
        self.call("export", "camera.h5", "field", select=["realization=2", "light_angle=0"], to="u.npy")
        u = np.load(self.folder / "u.npy")
        np.testing.assert_array_equal(u, camera["field"][2, 0])
        self.call("export", "camera.h5", "field", select=["realization=2", "light_angle=0"], to="u.pfm")
        pixels = np.frombuffer((self.folder / "u.pfm").read_bytes().split(b"\n", 3)[3], "<f4").reshape(64, 64)
        np.testing.assert_allclose(pixels, np.abs(u)**2, rtol=1e-6)
        for select, words in ((["realization=6"], "from 0 to 5"), (["view=0"], "realization light_angle camera_y camera_x"),
                              (["realization=0"], "two axes")):
            self.assertIn(words, self.call("export", "camera.h5", "field", select=select, to="u.png", status=2).stderr)

    def test_the_contrast_of_few_images_is_not_biased(self):
        self.call("field", dimension=3, domain="box", width=40, height=40, depth=10, scatterer="hg", optical_depth=2, view_angles=0,
                  camera_pixels=32, camera_aperture=0.3, camera_focus=10, fields=3, out="x.h5")
        with h5py.File(self.folder / "x.h5") as file:
            self.assertLess(abs(file["mean_contrast"][()] - 1), 0.15)

    def test_validate(self):
        keys = {key: value for key, value in SPACE.items() if key != "method"}
        table = {"scatterer": "phase_table", "phase_table": "p.csv", "optical_depth": 3}
        (self.folder / "p.csv").write_text("angle,value\n0,5\n1,1\n3.141592653589793,0.2\n")
        for more in ({"scatterer": "hg", "g": 0.6}, table):
            self.call("validate", **(keys | TILTS | more | {"tolerance": 1e-3}), seed=1, samples=20000,
                      out="x.h5")
            with h5py.File(self.folder / "x.h5") as file:
                self.assertLess(max(file["deviation"][:]), 4)

    def test_delays_by_both_methods(self):
        delays = [0, 0.01, 0.1]
        found = {}
        for method, more in (("transport", {"tolerance": 1e-4}),
                             ("mc", {"seed": 2, "samples": 20000})):
            keys = SPACE | more | {"method": method, "scatterer": "rayleigh", "optical_depth": 2}
            self.call("covariance", **keys, delays=delays, out="x.h5")
            with h5py.File(self.folder / "x.h5") as file:
                found[method] = (file["field_correlation"][:].ravel(),
                                 file["field_correlation_error"][:].ravel())
        self.assertAlmostEqual(found["transport"][0][0], 1, delta=1e-9)
        for t in range(len(delays)):
            self.assertAlmostEqual(found["mc"][0][t], found["transport"][0][t],
                                   delta=4 * found["mc"][1][t] + 1e-4)
            self.assertLess(found["mc"][1][t], 0.02)

    def test_gradient_by_both_methods(self):
        found = {}
        for method, more in (("transport", {"tolerance": 1e-4}),
                             ("mc", {"seed": 3, "samples": 40000})):
            keys = SPACE | more | {"method": method, "scatterer": "hg", "g": 0.5, "albedo": 0.9,
                                   "optical_depth": 2}
            self.call("covariance", **keys, gradient=True, out="x.h5")
            with h5py.File(self.folder / "x.h5") as file:
                self.assertEqual(list(file["parameter"].attrs["names"]),
                                 ["mu_t", "g", "albedo", "optical_depth"])
                found[method] = file["gradient"][:].ravel(), file["gradient_error"][:].ravel()
        for p, exact in enumerate(found["transport"][0]):
            error = found["mc"][1][p]
            self.assertAlmostEqual(found["mc"][0][p], exact, delta=4 * error + 1e-4 * abs(exact))
            self.assertLess(error, 0.1 * abs(exact))

    def test_frequency_shifts(self):
        shifts = [0, 1e-5, 1e-4]
        keys = SPACE | {"scatterer": "hg", "g": 0.5, "optical_depth": 5, "tolerance": 1e-4,
                        "frequency_shifts": shifts}
        self.call("covariance", **keys, out="x.h5")
        with h5py.File(self.folder / "x.h5") as file:
            plain = abs(file["frequency_correlation"][:].ravel())
        self.call("covariance", **(keys | TILTS), out="x.h5")
        with h5py.File(self.folder / "x.h5") as file:
            tilted = file["frequency_tilt_correlation"][:]
            by_tilts = file["field_correlation"][:]
        self.assertAlmostEqual(plain[0], 1, delta=1e-9)
        self.assertTrue(plain[1] > 0.9 > plain[2] > 0.2)
        for t, alone in enumerate(by_tilts):
            self.assertAlmostEqual(tilted[0][t], alone, delta=1e-9)
            self.assertTrue(tilted[0][t] > tilted[1][t] > tilted[2][t])

    def test_spheres(self):
        spheres = SPACE | {"scatterer": "mie", "radius": 0.5, "index": "1.33+0.01i", "tolerance": 1e-4}
        self.call("covariance", **spheres, out="x.h5")
        with h5py.File(self.folder / "x.h5") as file:
            self.assertEqual(file.attrs["dimension"], 3)
            albedo, g, found = file.attrs["albedo"], file.attrs["g"], file["intensity"][0, 0]
        self.assertTrue(0.8 < albedo < 1 and 0.7 < g < 1)
        # another phase function with the same g and albedo gives similar but different values
        self.call("covariance", **(SPACE | {"scatterer": "hg", "g": g, "albedo": albedo}), out="x.h5")
        with h5py.File(self.folder / "x.h5") as file:
            self.assertAlmostEqual(file["intensity"][0, 0] / found, 1, delta=0.3)
            self.assertNotAlmostEqual(file["intensity"][0, 0] / found, 1, delta=1e-3)

    def test_small_spheres_are_rayleigh_s(self):
        found = []
        for scatterer in ({"scatterer": "mie", "radius": 1e-4, "index": 1.5}, {"scatterer": "rayleigh"}):
            self.call("covariance", **(SPACE | scatterer), view_angles=[0, 0.7], out="x.h5")
            with h5py.File(self.folder / "x.h5") as file:
                found.append(file["intensity"][:].ravel())
        for one, other in zip(*found):
            self.assertAlmostEqual(one / other, 1, delta=1e-5)

    def test_a_table_is_per_solid_angle(self):
        (self.folder / "p.csv").write_text("angle,value\n0,1\n3.141592653589793,1\n")
        found, _, mean_cosine = self.correlations(scatterer="phase_table", phase_table="p.csv")
        self.assertAlmostEqual(found, 0.058862, delta=1e-5)
        self.assertAlmostEqual(mean_cosine, 0, delta=1e-9)

    def test_two_equal_terms_are_one(self):
        one = self.correlations(scatterer="hg", g=0.5)
        two = self.correlations(scatterer="two_term_hg", g=0.5, g_back=0.5, forward_share=0.3)
        self.assertAlmostEqual(one[0], two[0], delta=1e-9)
        self.assertAlmostEqual(two[2], 0.5, delta=1e-9)

    def test_sweep(self):
        keys = {"depth": DEPTH, "optical_depth": 10, "method": "transport", "g": [0, 0.5],
                "tilts": [q / (6.283185307179586 * DEPTH) for q in Q_TILTS], "tolerance": 1e-4}
        self.call("sweep", **keys, dimension=3, out="space.h5")
        self.call("sweep", **keys, out="plane.h5")
        with (h5py.File(self.folder / "space.h5") as space,
              h5py.File(self.folder / "plane.h5") as plane):
            self.assertEqual(space.attrs["dimension"], 3)
            self.assertNotIn("dimension", plane.attrs)
            self.assertAlmostEqual(space["memory_effect_range"][:].flat[0], 1.395, delta=2e-3)
            self.assertNotEqual(space["diffusion_range"][:].flat[0],
                                plane["diffusion_range"][:].flat[0])

    def test_exact_fields_of_a_table(self):
        """The reference placement of ten resonant points (data/reference/README.md)."""
        folder = Path(os.environ["FLATSPECKLE_DATA"]) / "reference" / "space"
        def rows(name):
            with open(folder / f"points_{name}.csv") as file:
                return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)
                        if row["case"] == "0"]
        def angles(row):
            return math.atan2(math.hypot(row["x"], row["y"]), row["z"]), math.atan2(row["y"], row["x"])
        self.write("points.csv", "x,z,y\n" + "".join(f"{p['x']!r},{p['z']!r},{p['y']!r}\n" for p in rows("placements")))
        light = rows("lights")[0]
        far = [row for row in rows("fields") if row["light"] == 0 and row["near"] == 0]
        keys = {"dimension": 3, "placement": "points.csv", "light_angles": angles(light)[0],
                "light_azimuths": angles(light)[1], "view_angles": [angles(row)[0] for row in far],
                "view_azimuths": [angles(row)[1] for row in far]}
        self.call("solve", **keys, out="x.h5")
        with h5py.File(self.folder / "x.h5") as file:
            self.assertEqual(file.attrs["dimension"], 3)
            for found, row in zip(file["far_field"][0], far):
                self.assertAlmostEqual(found, complex(row["re"], row["im"]), delta=1e-12)
            self.assertEqual(list(file["placement/y"][:]), [p["y"] for p in rows("placements")])

    def test_exact_ensembles(self):
        box = {"dimension": 3, "width": 4, "height": 4, "depth": 3, "count": 20, "light_angles": 0.3,
               "view_angles": [0.7, 2.4], "view_azimuths": [0.5, 1]}
        self.call("validate", **box, seed=1, samples=20000, wave_samples=2000, out="x.h5")
        with h5py.File(self.folder / "x.h5") as file:
            self.assertGreater(file["share_within"][()], 0.99)
            self.assertLess(file["invariants/power"][()] if "invariants/power" in file else 0, 1e-6)
            intensity = file["wave/intensity"][:]
        self.call("covariance", **box, method="wave", seed=1, samples=2000, out="y.h5")
        with h5py.File(self.folder / "y.h5") as file:
            self.assertEqual(file["intensity"][:].tolist(), intensity.tolist())
        self.call("place", dimension=3, width=4, height=4, depth=3, radii=0.2, packing_fraction=0.1, seed=1,
                  out="spheres.csv")
        self.call("solve", dimension=3, placement="spheres.csv", scatterer="penetrable", index=1.2, tolerance=1e-3,
                  out="z.h5")
        with h5py.File(self.folder / "z.h5") as file:
            self.assertEqual(len(file["placement/x"]), 143)
            self.assertLess(file["solve/residual"][()], 1e-12)


if __name__ == "__main__":
    unittest.main()
