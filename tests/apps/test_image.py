"""Pictures through a medium: contents of the file, dependence on the seed alone, and rejected input."""

import unittest

import numpy as np

from program import WHOLE, ProgramTest, attributes, datasets

FOG = {"domain": "box", "width": 300, "depth": 20, "scatterer": "hg", "g": 0.9, "optical_depth": 5}
IMAGE = {**FOG, "object_x": [0, 40, 130], "object_depth": -4000, "camera": [-0.4, 0.4],
         "pixels": 512, "repeats": 3, "paths_per_field": 300, "prediction_paths": 4000}
POINTS = {"domain": "box", "width": 40, "depth": 10, "scatterer": "point", "density": 0.1,
          "object_x": [-6, 7], "object_depth": -200, "camera": [-0.5, 0.5], "pixels": 128}


class Image(ProgramTest):
    def image(self, name="image.h5", **keys):
        self.output = self.call("image", **keys, out=name).stdout
        return datasets(self.folder / name)

    def test_contents(self):
        found = self.image(**IMAGE)
        self.assertEqual(found["frame"].shape, (3, 512))
        np.testing.assert_allclose(found["frame"].mean(axis=1), 1)
        self.assertEqual(found["found_x"].shape, (3, 3))
        np.testing.assert_allclose(found["pair_distance"], [40, 130, 90])
        self.assertTrue(np.all((found["pair_correlation"] > 0) & (found["pair_correlation"] <= 1)))
        self.assertTrue(np.all(np.diff(found["pair_correlation"][[0, 2, 1]]) < 0))
        np.testing.assert_allclose(found["mean_autocorrelation"],
                                   found["autocorrelation"].mean(axis=0))
        step = found["distance"][1]
        pixel = 0.8 / 511
        self.assertAlmostEqual(step, 4000 * pixel)
        for name, values in found.items():
            if values.dtype.kind == "f":
                self.assertTrue(np.all(np.isfinite(values)), name)
        self.assertIn("of the media", self.output)

    def test_parts_of_objects(self):
        found = self.image(**{**IMAGE, "repeats": 0}, object_count=2, object_scale=1.5)
        np.testing.assert_allclose(found["object_x"], [0, 60])

    def test_prediction_and_pictures_over_the_same_axes(self):
        """Sweeps of both and of the prediction alone agree; it falls with the optical depth."""
        success = {}
        for repeats in 0, 2:
            self.call("sweep", **{**{k: v for k, v in IMAGE.items() if k != "optical_depth"}, "repeats": repeats},
                      of="image", vary=["optical_depth=1,20", "photons=2,50"], seed=1, out="sweep.h5")
            success[repeats] = datasets(self.folder / "sweep.h5")
        predicted = success[0]["predicted_success"]
        self.assertEqual(predicted.shape, (2, 2))
        np.testing.assert_allclose(predicted, success[2]["predicted_success"], rtol=1e-12)
        self.assertTrue(np.all(predicted[0] >= predicted[1]))
        self.assertTrue(np.all(predicted[:, 1] >= predicted[:, 0]))
        self.assertEqual(success[2]["success"].shape, (2, 2))

    def test_threads_do_not_matter_and_the_seed_does(self):
        frames = {}
        for name, extra in {"one": {"threads": 1}, "two": {"threads": 2},
                            "other": {"seed": 2}}.items():
            frames[name] = self.image(f"{name}.h5", **IMAGE, **extra)["frame"]
        np.testing.assert_array_equal(frames["one"], frames["two"])
        self.assertGreater(np.abs(frames["one"] - frames["other"]).max(), 0.1)

    def test_gaussian(self):
        """Contrast is 1/sqrt(N) and E|u|^4 = 2 (E|u|^2)^2, less by a hundredth for few paths."""
        media = {**IMAGE, "points": 0, "object_extent": 150, "repeats": 20, "pixels": 1024,
                 "paths_per_field": 3000}
        for brightness in ([1], [1, 1, 1], [1, 2, 3]) if WHOLE else ([1], [1, 2, 3]):
            expected = np.linalg.norm(brightness) / sum(brightness) / 1.5
            found = self.image(**{**media, "object_x": IMAGE["object_x"][:len(brightness)]},
                               object_brightness=brightness, background=0.5)
            self.assertAlmostEqual(float(found["gaussian_contrast"]), expected)
            contrast, error = found["mean_contrast"], found["mean_contrast_error"]
            self.assertLess(abs(contrast - expected), 4 * error + 0.01 * expected)
            self.assertLess(error, 0.05 * expected)
            self.assertLess(abs(found["fourth_moment"] - 2),
                            4 * found["fourth_moment_error"] + 0.01)

    def test_reference(self):
        """Deconvolution by the frame of a point gives a picture, worse behind deeper media, as predicted."""
        scene = {**IMAGE, "width": 600, "object_x": [-120, 30, 160], "object_depth": -8000,
                 "object_brightness": [1, 3, 2], "reference_x": 10, "pixels": 1024, "repeats": 8 if WHOLE else 5,
                 "points": 0}
        del scene["paths_per_field"]
        psnr, clear = [], None
        for optical_depth in 2, 12:
            found = self.image(**{**scene, "optical_depth": optical_depth})
            clear = clear or found
            expected = found["predicted_psnr"]
            self.assertLess(abs(found["mean_psnr"] - expected),
                            1.5 + 4 * found["mean_psnr_error"])
            self.assertIn(f"expected {float(expected):.1f} dB", self.output)
            psnr.append(float(found["mean_psnr"]))
            self.assertTrue(np.all(np.diff(found["reference_correlation"][[1, 0]]) < 0))
        self.assertGreater(psnr[0], psnr[1] + 4)
        lucy = self.image(**{**scene, "optical_depth": 2}, deconvolution="richardson_lucy",
                          iterations=40)
        self.assertEqual(lucy["residual"].shape, (8 if WHOLE else 5, 40))
        self.assertNotIn("predicted_psnr", lucy)
        for found in lucy, clear:
            brightest = found["picture_x"][found["picture"].mean(axis=0).argmax()]
            self.assertAlmostEqual(brightest, 30, delta=2 * np.diff(found["picture_x"])[0])

    def test_one_medium_has_errors(self):
        found = self.image(**{**IMAGE, "repeats": 1})
        grains = found["grains"][0]
        self.assertAlmostEqual(float(found["fourth_moment_error"]), (8 / grains)**0.5)
        self.assertAlmostEqual(float(found["mean_contrast_error"]),
                               found["contrast"][0] * (4 / grains)**0.5 / 2)

    def test_noise(self):
        dark = self.image(**IMAGE, photons=3, read_noise=2, background=1)
        self.assertAlmostEqual(dark["frame"].mean(), 2, delta=0.1)
        self.assertGreater(dark["frame"].std(), self.image(**IMAGE)["frame"].std())
        self.refused("read_noise = 2: is not used here", **IMAGE, read_noise=2)

    def test_exact_placements(self):
        """Exact placements have the contrast of light paths."""
        contrast = {method: self.image(f"{method}.h5", **POINTS, method=method, points=0,
                                       repeats=100)["contrast"] for method in ("paths", "wave")}
        error = np.hypot(*(c.std() / 10 for c in contrast.values()))
        self.assertLess(abs(contrast["wave"].mean() - contrast["paths"].mean()), 4 * error + 0.02)
        self.assertIn("exact solver", attributes(self.folder / "wave.h5")["plan"])

    def test_near_camera(self):
        near = self.image(**{**IMAGE, "camera_depth": 1020, "camera": [-300, 300]})
        self.assertAlmostEqual(near["distance"][1], 4 * 600 / 511)

    def refused(self, words, **keys):
        (self.folder / "image.h5").unlink(missing_ok=True)
        line = self.call("image", **keys, out="image.h5", status=2).stderr
        self.assertIn(words, line)
        self.assertEqual(line.count("\n"), 1)
        self.assertFalse((self.folder / "image.h5").exists())

    def test_bad_input(self):
        def other(**keys):
            return {key: value for key, value in {**IMAGE, **keys}.items() if value is not None}
        self.refused("object_depth = 3: must be outside of the box", **other(object_depth=3))
        self.refused("camera_depth = 20: must be outside", **other(camera_depth=20))
        self.refused("object_x", **other(object_x=None))
        self.refused("object_depth", **other(object_depth=None))
        self.refused("camera", **other(camera=None))
        self.refused("camera = 0.1: must be larger than the first value", **other(camera=[0.4, 0.1]))
        self.refused("camera: must be sines", **other(camera=[-2, 2]))
        self.refused("object_brightness: has 2 values, must have one for each of the 3 points",
                     **other(object_brightness=[1, 2]))
        self.refused("object_brightness", **other(object_brightness=[1, 2, -1]))
        self.refused("object_extent = 1000: corresponds to", **other(object_extent=1000))
        self.refused("regularisation = 1: is not used here", **other(regularisation=1))
        self.refused("iterations = 9: is not used here", **other(reference_x=3, iterations=9))
        self.refused("object_extent", **other(reference_x=5000))
        self.refused("slab", **other(domain="slab", width=None))
        self.refused("photons", **other(photons=-1))
        self.refused("pixels", **other(pixels=3))
        self.refused("point", **other(method="wave", paths_per_field=None))


if __name__ == "__main__":
    unittest.main()
