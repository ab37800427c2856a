"""Pictures of the graded fibre against closed-form rays. By night: share of the pixels not marked as undersampled
that lie beyond two errors."""

import unittest

import numpy as np

from fibre_picture import fibre_picture
from program import WHOLE, nightly
from renders import RenderTest


class Picture(RenderTest):
    def test_it_is_that_of_the_rays(self):
        truth = fibre_picture(6, blocks=1)
        for method in ("path", "light", "bidirectional", "forward"):
            with self.subTest(method=method):
                found = self.scene("grin_fibre", pixels=[6, 6], path_bins=[80.42, 80.74, 2], method=method, samples=15000)
                # the variance of hits grows with their number, and is too small where the value is
                share = np.maximum(1, truth / np.maximum(found["image"], 1e-9))
                self.assert_within(found["image"], found["image_error"] * np.sqrt(share), truth)
                self.assert_within(found["total"], found["total_error"], truth.mean() * 1.8**2)

    def test_rays_fill_pixels_evenly_enough(self):
        pixels = 24 if WHOLE else 12
        coarse, fine = fibre_picture(pixels, blocks=1), fibre_picture(pixels, blocks=4 if WHOLE else 2)
        self.assertLess(np.sqrt(np.mean((coarse - fine) ** 2)), 0.005 * np.sqrt(np.mean(fine**2)))


@nightly
class Pixels(RenderTest):
    def assert_few_beyond(self, samples, seeds):
        """Checks that at most 8 % lie beyond, plus one standard error of the share."""
        beyond = seen = 0
        truth = fibre_picture(24)
        for seed in seeds:
            found = self.scene("grin_fibre", pixels=[24, 24], samples=samples, seed=seed)
            trusted = found["image_rare"] == 0
            off = np.abs(found["image"] - truth)[trusted]
            beyond += np.count_nonzero(off > 2 * found["image_error"][trusted])
            seen += np.count_nonzero(trusted)
        print(f"{samples} samples: {beyond} of {seen} beyond two errors")
        self.assertLess(beyond, 0.08 * seen + np.sqrt(0.08 * 0.92 * seen))

    def test_of_many_samples(self):
        self.assert_few_beyond(600000, range(1, 4))

    def test_of_few_samples(self):
        self.assert_few_beyond(60000, range(1, 25))


if __name__ == "__main__":
    unittest.main()
