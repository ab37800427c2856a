"""Pictures in space: simulated frames and what is recovered from them, sources in pictures, and rejected input."""

import unittest

import numpy as np

from frame_files import speckle, write_png
from program import WHOLE, ProgramTest, datasets
from refusing import RefusingTest

FOG = {"dimension": 3, "width": 100, "height": 100, "depth": 4, "scatterer": "hg", "g": 0.9, "optical_depth": 8}
CAMERA = {"camera_pixels": 128, "camera_aperture": 0.16}
QUICK = {"starts": 4, "phase_iterations": 100, "prediction_draws": 4, "prediction_paths": 20000, "paths_per_field": 1000}
LETTER = np.array([[255 * (c == "#") for c in row] for row in ("###", "#..", "##.", "#..", "###")], np.uint8)


class Images(ProgramTest):
    def image(self, name="image.h5", **keys):
        self.output = self.call("image", **{**FOG, **CAMERA, **QUICK, **keys}, out=name).stdout
        return datasets(self.folder / name)

    def test_a_letter_is_recovered_as_predicted_and_as_recover_does(self):
        """`recover` makes the same pictures from the frames of the file, and the truth is the letter."""
        write_png(self.folder / "letter.png", LETTER)
        found = self.image(object_picture="letter.png", object_width=0.027, repeats=1, average=6, photons=3000, starts=12,
                           phase_iterations=200, prediction_draws=12, paths_per_field=3000, quantum_efficiency=0.5, read_noise=3, full_well=20000, bit_depth=12)
        self.assertEqual(found["frames"].shape, (6, 128, 128))
        self.call("export", "image.h5", "frames", to="frames.tif")
        for name, linear in (("shown", {}), ("linear", {"linear": True})):
            self.call("export", "image.h5", "frames", select="camera_frame=0", to=f"{name}.png", **linear)
        self.assertIn("is a picture for display", self.call("contrast", frames="shown.png", out="c.h5", status=2).stderr)
        self.call("export", "image.h5", "frames", select="camera_frame=0", to="first.tif")
        for name, frames in (("c.h5", "linear.png"), ("d.h5", "first.tif")):
            self.assertNotIn("saturated", self.call("contrast", frames=frames, out=name).stderr)
        png, tif = (datasets(self.folder / name)["contrast_map"] for name in ("c.h5", "d.h5"))
        np.testing.assert_allclose(png, tif, rtol=1e-3)
        self.assertTrue(np.all(found["frames"] == np.round(found["frames"])))
        np.testing.assert_allclose(found["frames"].mean() * 20000 / 4095, 1500, rtol=0.02)
        self.assertEqual(np.count_nonzero(LETTER), len(found["point_x"]))
        x, y = found["place_x"], found["place_y"]
        self.assertAlmostEqual(found["true_picture"].sum(), 1)
        for row, column in ((0, 2), (4, 0), (1, 1)):  # corners and a dark pixel
            at = found["true_picture"][np.abs(y - 0.009 * (row - 2)).argmin(), np.abs(x - 0.009 * (column - 1)).argmin()]
            (self.assertGreater if LETTER[row, column] else self.assertLess)(at, 0.6 * found["true_picture"].max())
        self.assertGreater(found["similarity"].max(), 0.5)
        self.assertLess(abs(found["predicted_similarity"] - found["similarity"].mean()), 0.3)
        noise = np.hypot(3, 20000 / 4095 / 12**0.5)
        self.call("recover", frames="frames.tif", average=6, photons=1500, read_noise=noise,
                  longest=len(x) - 1, starts=12, phase_iterations=200, out="r.h5")
        again = datasets(self.folder / "r.h5")
        np.testing.assert_allclose(again["agreement"], found["agreement"], atol=1e-9)
        np.testing.assert_allclose(again["white_noise"], found["white_noise"], rtol=1e-9)
        peaks = [np.sort(file[0].ravel())[-20:] for file in (again["phased_picture"], found["recovered_picture"])]
        np.testing.assert_allclose(*peaks, rtol=1e-6)

    def test_sparse_points_are_found(self):
        places = np.array([[0, 0], [0.035, 0.01], [-0.005, 0.0275], [0.015, -0.0125]])  # x, y
        found = self.image(object_x=list(places[:, 0]), object_y=list(places[:, 1]), repeats=1, average=4, photons=3000)
        for name, keys in {"a.h5": {}, "b.h5": {"points": 4}}.items():
            self.call("recover", frames="image.h5", frame_dataset="frames", average=4, photons=3000, recovery="search",
                      longest=len(found["place_x"]) - 1, **keys, out=name, status=0 if keys else 2)
        points = datasets(self.folder / "b.h5")
        self.assertGreater(points["explained"][0], 0.9)
        at = np.column_stack([points["found_x"][0], points["found_y"][0]]) * 0.32 / 128
        off = min(np.abs((sign * at - sign * at[i])[:, None] - (places - places[j])[None]).max(axis=2).min(axis=1).max()
                  for sign in (1, -1) for i in range(4) for j in range(4))
        self.assertLess(off, 0.0025)

    def test_lengths_with_units(self):
        """Frames of a scene in micrometres with a wavelength of 1 um are those without units."""
        keys = {"object_x": [0, 0.02], "object_y": [0, 0.01], "repeats": 1, "paths_per_field": 100, "prediction_paths": 2000, "starts": 1,
                "phase_iterations": 5, "prediction_draws": 0}
        plain = self.image(**keys)
        units = self.image("units.h5", **keys, length_unit="um", wavelength="1um", depth="4um")
        np.testing.assert_array_equal(units["frames"], plain["frames"])

    def test_depths_and_threads(self):
        """Points nearer to the box are farther apart in the picture; threads do not matter."""
        keys = {"object_x": [-4, 0, 3], "object_y": [0, 4, 0], "object_depth": [-300, -300, -200], "repeats": 1,
                "paths_per_field": 300, "prediction_paths": 5000, "starts": 2, "phase_iterations": 20, "prediction_draws": 2}
        found = self.image(**keys, threads=1)
        for name in ("frames", "recovered_picture", "predicted_similarity"):
            np.testing.assert_array_equal(self.image("two.h5", **keys, threads=2)[name], found[name])
        truth = found["true_picture"]
        peak = np.unravel_index(np.where(found["place_x"] > 2, truth, 0).argmax(), truth.shape)
        # The scale is that of the middle of the depths, 250; the middle of x is -0.5
        self.assertAlmostEqual(found["place_x"][peak[1]], -0.5 + 250 * (3 / 200 + 0.5 / 250), delta=0.4)

    def test_a_moving_medium_blurs_the_speckle(self):
        still, moving = (self.image(object_x=[0, 0.01], repeats=2, prediction_draws=0, exposure=1, exposure_steps=4,
                                    diffusion=diffusion, starts=1, phase_iterations=4) for diffusion in (1e-9, 500))
        self.assertAlmostEqual(still["exposure_factor"], 1, delta=1e-6)
        self.assertLess(moving["exposure_factor"], 0.6)
        ratio = np.mean(moving["light_contrast"]**2) / np.mean(still["light_contrast"]**2)
        self.assertAlmostEqual(ratio / moving["exposure_factor"], 1, delta=0.2)

    def test_a_disc_and_a_prediction_alone(self):
        found = self.image(object_disc=0.02, repeats=0, prediction_draws=2)
        self.assertEqual(len(found["point_x"]), 5)
        self.assertNotIn("frames", found)
        self.assertIn("expected: similarity", self.output)


class Sources(ProgramTest):
    def test_sources_of_blinking_points_in_pictures(self):
        random = np.random.default_rng(3)
        places = np.array([[0, 0], [9, 4], [-5, 12], [14, -8]])  # row, column
        pattern = speckle(160, 4, random)
        own = [pattern[20 - y:148 - y, 20 - x:148 - x] for y, x in places]
        frames = [sum(random.random() * (random.random() < 0.6) * one for one in own) for _ in range(30)]
        np.save(self.folder / "frames.npy", np.array(frames))
        self.call("recover", frames="frames.npy", recovery="sources", longest=30, out="s.h5")
        found = datasets(self.folder / "s.h5")
        self.assertEqual(found["source_count"], 4)
        self.assertEqual(found["source_picture"].shape, (4, 128, 128))
        self.assertTrue(np.all(found["source_group"] == 0))
        at = np.column_stack([found["source_y"], found["source_x"]])
        off = min(np.abs((at - at[i])[:, None] - (places - places[j])[None]).max(axis=2).min(axis=1).max()
                  for i in range(4) for j in range(4))
        self.assertLess(off, 0.5)


class Refused(RefusingTest):
    def test_keys(self):
        write_png(self.folder / "dark.png", np.zeros((8, 8), np.uint8))
        scene = {**FOG, **CAMERA, "object_x": [0, 0.01]}
        cases = (
            (["object_x, object_picture, object_disc"], {"object_x": None}),
            (["object_x, object_picture, object_disc"], {"object_disc": 0.01}),
            (["object_y", "2 points"], {"object_y": 1}),
            (["object_depth", "2 points"], {"object_depth": [-10, -20, -30]}),
            (["object_depth = 4", "outside of the box"], {"object_depth": 4}),
            (["sines of directions"], {"object_x": [0, 3]}),
            (["object_picture", "no pixel above 0"], {"object_x": None, "object_picture": "dark.png", "object_width": 1}),
            (["object_width", "not given"], {"object_x": None, "object_picture": "dark.png"}),
            (["object_extent", "quarter"], {"object_x": [0, 0.08]}),
            (["camera_pixels", "not given"], {"camera_pixels": None}),
            (["camera_aperture", "not given"], {"camera_aperture": None}),
            (["camera_pixels = 8"], {"camera_pixels": 8}),
            (["exposure = 1", "at infinity"], {"object_depth": -500, "exposure": 1}),
            (["exposure_steps"], {"exposure_steps": 4}),
            (["quantum_efficiency"], {"quantum_efficiency": 0.5}),
            (["bit_depth = 8", "full_well"], {"photons": 10, "bit_depth": 8}),
            (["camera = "], {"camera": [-0.1, 0.1]}),
            (["points = 3"], {"points": 3}),
            (["domain = slab"], {"domain": "slab", "width": None, "height": None}),
            (["object_spacing"], {"object_x": None, "object_disc": 1, "object_spacing": 1e-4}),
        )
        for words, keys in cases if WHOLE else cases[::2]:
            with self.subTest(**keys):
                self.assert_refused(words, "image", **{k: v for k, v in {**scene, **keys}.items() if v is not None})


if __name__ == "__main__":
    unittest.main()
