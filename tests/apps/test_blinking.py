"""Blinking points: their brightness, single frames, sources separated from the frames."""

import unittest

import numpy as np

from program import ProgramTest, datasets

FOG = {"domain": "box", "width": 300, "depth": 20, "scatterer": "hg", "g": 0.9, "optical_depth": 5}
IMAGE = {**FOG, "object_x": [0, 40, 130, 290], "object_depth": -4000, "camera": [-0.4, 0.4],
         "pixels": 1024, "repeats": 2, "paths_per_field": 1000, "prediction_paths": 500}
WEIGHTS = {**IMAGE, "pixels": 128, "repeats": 1, "points": 0, "object_extent": 80, "blinking_frames": 4000,
           "paths_per_field": 100}


class Blinking(ProgramTest):
    def image(self, name="image.h5", **keys):
        self.output = self.call("image", **keys, out=name).stdout
        return datasets(self.folder / name)

    def test_subsets(self):
        """Each point is lit in its share of the frames, independently of the others."""
        bright = self.image(**{**WEIGHTS, "blinking": "subsets", "lit": 0.3})["point_brightness"]
        self.assertEqual(bright.shape, (4000, 4))
        self.assertEqual(set(np.unique(bright)), {0, 1})
        fluctuation = 4 / len(bright)**0.5
        self.assertLess(abs(bright.mean(axis=0) - 0.3).max(), fluctuation * 0.21**0.5)
        self.assertLess(abs(np.corrcoef(bright.T) - np.eye(4)).max(), fluctuation)

    def test_speckle(self):
        """Brightness is exponentially distributed and correlated within a grain as by the light's covariance."""
        found = self.image(**{**WEIGHTS, "object_x": [0, 4, 8, 150]}, blinking="speckle",
                           excitation_wavelength=0.8)
        bright, alike = found["point_brightness"], found["pair_excitation"]
        frames = len(bright)
        scaled = bright / bright.mean(axis=0)
        self.assertLess(abs(bright.mean(axis=0) - 1).max(), 0.1 + 4 / frames**0.5)
        # E x^k = k!, with the variances of an exponential's powers
        self.assertLess(abs((scaled**2).mean(axis=0) - 2).max(), 4 * (20 / frames)**0.5)
        self.assertLess(abs(np.mean(scaled > 1, axis=0) - np.exp(-1)).max(),
                        4 * (0.25 / frames)**0.5)
        correlation = np.corrcoef(bright.T)[np.triu_indices(4, 1)]
        self.assertLess(abs(correlation - alike).max(), 6 / frames**0.5)
        self.assertGreater(alike[0], alike[1])  # distances 4 and 8
        self.assertGreater(alike[1], 0.05)
        self.assertLess(alike[2], 0.02)

    def test_speckle_grain(self):
        """The grains of the excitation are as wide as its wavelength."""
        alike = [self.image(**{**WEIGHTS, "blinking_frames": 2, "object_x": [0, x]}, blinking="speckle",
                            excitation_wavelength=wavelength)["pair_excitation"][0]
                 for x, wavelength in ((6, 1), (9, 1.5), (6, 1.5))]
        self.assertAlmostEqual(alike[0], alike[1], delta=0.05)
        self.assertGreater(alike[2], alike[0] + 0.1)

    def test_contrast_of_frames(self):
        """Four equal points of independent exponential brightness have a squared contrast of 2/(N + 1)."""
        found = self.image(**{**IMAGE, "object_x": [0, 60, 150, 310], "points": 0, "object_extent": 80,
                              "repeats": 12, "blinking_frames": 100}, blinking="speckle")
        error = found["frame_contrast_error"]
        self.assertAlmostEqual(found["expected_frame_contrast"]**2, 2 / 5, delta=0.02)
        self.assertLess(abs(found["frame_contrast"] - found["expected_frame_contrast"]),
                        4 * error + 0.01)
        self.assertLess(error, 0.03)

    def test_sources(self):
        """All points are found, not mirrored, in frames of few photons, also from the frames alone."""
        for extra in ({"blinking": "subsets"},
                      {"blinking": "speckle", "photons": 30, "read_noise": 2, "background": 0.5}):
            found = self.image(**{**IMAGE, **extra}, blinking_frames=40)
            np.testing.assert_array_equal(found["source_count"], 4)
            self.assertEqual(found["sources_success"], 1)
            self.assertGreater(found["pattern_match"].min(), 0.9)
            x = np.sort(found["source_x"], axis=1)
            grain = found["distance"][1] * 1.5
            np.testing.assert_allclose(x - x[:, :1], np.tile([0, 40, 130, 290], (2, 1)), atol=grain)
            for name, values in found.items():
                if values.dtype.kind == "f":
                    self.assertTrue(np.all(np.isfinite(values)), name)
        self.assertIn("all points recovered as sources in 1", self.output)
        frames = found["frames"] - 0.5
        np.savetxt(self.folder / "frames.csv", frames.T, delimiter=",",
                   header=",".join(f"f{i}" for i in range(len(frames))), comments="")
        output = self.call("recover", frames="frames.csv", recovery="sources", longest=100, points=4,
                           out="sources.h5").stdout
        own = datasets(self.folder / "sources.h5")
        self.assertIn("source", output)
        pixels = np.sort(-own["source_x"])  # the picture is a mirror image
        np.testing.assert_allclose((pixels - pixels[0]) * found["distance"][1],
                                   [0, 40, 130, 290], atol=grain)
        np.testing.assert_array_equal(own["source_group"], 0)
        self.assertEqual(own["source_pattern"].shape, (4, 1024))
        self.assertEqual(own["source_brightness"].shape, (40, 4))
        product = own["source_brightness"] @ own["source_pattern"]
        np.testing.assert_allclose(np.linalg.norm(frames / frames.mean() - product) /
                                   np.linalg.norm(frames / frames.mean()),
                                   own["factor_residual"], rtol=1e-3)

    def test_chain(self):
        """Chains beyond the memory-effect range, where the autocorrelation of one frame fails."""
        found = self.image(**{**IMAGE, "width": 600, "optical_depth": 12,
                              "object_depth": -20000, "pixels": 2048,
                              "object_x": [-900, -530, -180, 160, 500, 910],
                              "paths_per_field": 4000, "prediction_paths": 4000, "repeats": 1},
                           blinking="subsets", blinking_frames=60)
        self.assertLess(found["pair_correlation"].min(), 0.1)
        self.assertEqual(found["sources_success"], 1)
        self.assertEqual(found["success"], 0)

    def test_threads_do_not_matter(self):
        one, two = (self.image(f"{n}.h5", **{**IMAGE, "paths_per_field": 200}, threads=n, blinking="speckle", blinking_frames=20)
                    for n in (1, 2))
        for name in one:
            np.testing.assert_array_equal(one[name], two[name], name)


if __name__ == "__main__":
    unittest.main()
