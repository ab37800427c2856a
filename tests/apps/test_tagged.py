"""Light that sound shifts in frequency: exact sidebands of a beam, water, bodies, and bad input."""

import unittest

import h5py
import numpy as np

from program import DATA
from refusing import RefusingTest

WAVELENGTH = 5e-4
STAGE = {"stage_box": [-2, -2, 0, 2, 2, 3], "beam_light": [0, 0, 0, 0, 0, 1, 1e-6, 1], "sensor": "area", "sensor_at": [0, 0, 3],
         "sensor_size": [4, 4], "pixels": [1, 1], "method": "forward", "samples": 2000}
SOUND = {"field": "transducers", "index": 1.33, "tag_wavelength": WAVELENGTH}


def bessel(order, depth):
    angles = 2 * np.pi * (np.arange(400) + 0.5) / 400
    return np.mean(np.cos(order * angles - depth * np.sin(angles)))


class Tagged(RefusingTest):
    def tagged(self, **keys):
        self.call("render", **{**STAGE, **SOUND, **keys}, out="x.h5")
        with h5py.File(self.folder / "x.h5") as file:
            return {name: file[name][()] for name in file if not isinstance(file[name], h5py.Group)}

    def assert_sidebands(self, found, depth):
        np.testing.assert_allclose(found["mean_sideband"], [(1 + (n > 0)) * bessel(n, depth)**2 for n in range(4)], atol=1e-6)
        self.assertAlmostEqual(found["mean_modulation"] / depth**2, 1, 6)

    def test_beam(self):
        """A beam across and along a plane wave, in a clear stage and in a clear body (Raman and Nath)."""
        amplitude, wavenumber = 5e-5, 4.0
        across = [amplitude, wavenumber, 0.3, 0, 0, 0, 1, 0, 0, 0]
        along = [amplitude, wavenumber, 0.3, 0, 0, 0, 0, 0, 1, 0]
        rate = 2 * np.pi / WAVELENGTH * amplitude
        self.assert_sidebands(self.tagged(transducer=across), 3 * rate)
        half = wavenumber * 3 / 2
        self.assert_sidebands(self.tagged(transducer=along), 3 * rate * abs(np.sin(half) / half))
        body = self.tagged(transducer=across, body_box=[-1, -1, 1, 1, 1, 2], index_around=1.33)
        self.assert_sidebands(body, rate)

    def test_water(self):
        """A pressure gives the index by piezo_optic; the key strain_optic acts on scattered light alone."""
        keys = {"field": "focused_sound", "pressure": 1e5, "frequency": 1e6, "length_unit": 1e-3, "emitters": 1, "aperture": 1e-9}
        clear = self.tagged(**keys)
        half = 2 * np.pi * 1e6 / 1500 * 1e-3 * 3 / 2
        self.assert_sidebands(clear, 3 * 2 * np.pi / WAVELENGTH * 1.402e-5 * abs(np.sin(half) / half))
        weak, usual = (self.tagged(**keys, mu_s=2, strain_optic=value, samples=500) for value in (0.01, 0.32))
        self.assertGreater(weak["mean_modulation"], 10 * usual["mean_modulation"])

    def test_shipped_scene(self):
        self.call("render", config=DATA / "scenes" / "tagged_slab.toml", samples=500, out="x.h5")
        with h5py.File(self.folder / "x.h5") as file:
            shares = file["mean_sideband"][()]
            self.assertEqual(file["image_sideband"].shape[0], 4)
            self.assertTrue(0.9 < sum(shares) < 1 and np.all(np.diff(shares) < 0), shares)

    def test_guided(self):
        """Paths that are guided to a small sensor count the sound as those that are not, of two beams."""
        def shares(**keys):
            self.call("render", config=DATA / "scenes" / "tagged_slab.toml", sensor_radius=3, rings=1, out="x.h5", **keys)
            with h5py.File(self.folder / "x.h5") as file:
                self.assertLessEqual(file["invariants/sidebands"][()], 1e-9)
                return file.attrs["plan"], file["mean_sideband"][()], file["mean_sideband_error"][()]
        beam = [0, 0, 0, 0, 0, 1, 0.5]
        plan, guided, error = shares(beam_light=[*beam, 1], samples=15000)
        self.assertIn("paths guided to the sensors", plan)
        plan, plain, plain_error = shares(beam_light=[*beam, 0.5, *beam, 0.5], samples=60000)
        self.assertNotIn("guided", plan)
        near = abs(guided - plain) < 4 * np.hypot(error, plain_error)
        self.assertTrue(np.all(near[:2]), (guided, plain, error, plain_error))  # few paths make the higher sidebands
        self.assertLess(error[1] / guided[1], 0.15)

    def test_bad_input(self):
        wave = [5e-5, 4, 0, 0, 0, 0, 1, 0, 0, 0]
        good = {**STAGE, **SOUND, "transducer": wave}
        for change, words in (({"field": None, "transducer": None}, ["tag_wavelength", "requires sound"]),
                              ({"transducer": wave + [5e-5, 5, *wave[2:]]}, ["tag_wavelength", "one frequency"]),
                              ({"method": "light"}, ["tag_wavelength", "method = forward"]),
                              ({"tag_wavelength": 0}, ["tag_wavelength = 0", "positive"]),
                              ({"strain_optic": -1}, ["strain_optic = -1", "positive"]),
                              ({"tag_wavelength": None, "strain_optic": 0.3}, ["strain_optic", "tag_wavelength"])):
            with self.subTest(change=change):
                self.assert_refused(words, "render", **{**good, **change})


if __name__ == "__main__":
    unittest.main()
