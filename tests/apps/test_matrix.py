"""Scattering matrices of periodic cells by the command line."""

import unittest

import numpy as np

from program import ProgramTest, attributes, datasets

CELL = {"width": 9.3, "depth": 4, "count": 12, "scatterer": "tm", "radius": 0.3, "index": 1.4}


class OnePlacement(ProgramTest):
    def solve(self, **more):
        self.call("solve", **{**CELL, "period": 9.3, **more}, out="cell.h5")
        return datasets(self.folder / "cell.h5")

    def test_a_lossless_cell_is_unitary(self):
        found = self.solve()
        s = found["scattering_matrix"]
        sides, channels = 2, len(found["sine"])
        self.assertEqual(s.shape, (sides, channels, sides, channels))
        s = s.reshape(sides * channels, -1)
        np.testing.assert_allclose(s.conj() @ s.T, np.eye(len(s)), atol=1e-9)
        t = found["scattering_matrix"][0, :, 1, :]
        np.testing.assert_allclose(np.sort(found["transmission_eigenvalue"]), np.sort(np.linalg.svd(t)[1] ** 2), atol=1e-9)
        self.assertEqual(attributes(self.folder / "cell.h5")["converged"], 1)
        self.write("again.toml", attributes(self.folder / "cell.h5")["config"])
        self.call("solve", config="again.toml", out="again.h5")
        self.assert_same_data("cell.h5", "again.h5")

    def test_positions_of_a_file_repeat(self):
        found = self.solve()
        xs, zs = found["placement/x"], found["placement/z"]
        xs = np.where(np.arange(len(xs)) % 2, xs, xs + 9.3)
        self.write("cell.csv", "x,z\n" + "".join(f"{x!r},{z!r}\n" for x, z in zip(xs.tolist(), zs.tolist())))
        self.call("solve", placement="cell.csv", scatterer="tm", radius=0.3, index=1.4, period=9.3, out="moved.h5")
        moved = datasets(self.folder / "moved.h5")["scattering_matrix"]
        np.testing.assert_allclose(moved, found["scattering_matrix"], atol=1e-9)

    def test_the_map_is_quasi_periodic_and_continues_the_channels(self):
        phase = 1
        for solver in ("dense", "fast"):  # 31 pixels are a period
            found = self.solve(period_phase=phase, map=[-4.65, 7.35, -1, 5], map_pixels=[40, 60], solver=solver,
                               map_eigenchannels=[0, 7, 12])
            field, x, z = found["total_field"], found["map_x"], found["map_z"]
            self.assertEqual(field.shape, (4, 60, 40))
            np.testing.assert_allclose(field[:, :, 31:], np.exp(1j * phase) * field[:, :, :9], atol=1e-8)
            sine, cosine = found["sine"], np.sqrt(1 - found["sine"] ** 2)
            t = found["scattering_matrix"][0, :, 1, :].T
            back = np.exp(2j * np.pi * (np.outer(sine, x[:31]) + z[-1] * cosine[:, None])) / np.sqrt(cosine)[:, None]
            waves = field[:, -1, :31] @ back.conj().T * cosine / 31  # evanescent waves are orthogonal to channels
            np.testing.assert_allclose(waves[0], t[:, np.argmin(abs(sine))], atol=1e-5)
            power = (abs(waves) ** 2).sum(axis=1)
            np.testing.assert_allclose(power[1:], found["transmission_eigenvalue"][[0, 7, 12]], atol=1e-5)
            np.testing.assert_allclose(power, found["map_transmittance"], atol=1e-5)

    def test_own_lights_are_mapped(self):
        """The eigenchannel that is read back from its amplitudes has the same map; a sum of lights has the sum of their maps."""
        keys = {"map": [-2, 2, -1, 5], "map_pixels": [12, 20]}
        found = self.solve(**keys, map_eigenchannels=[3])
        waves, normal = found["map_light"], int(np.argmax(abs(found["map_light"][0])))
        rows = [(0, c, a.real, a.imag) for c, a in enumerate(waves[1])]
        rows += [(1, c, 2 * a.real + (c == normal), 2 * a.imag) for c, a in enumerate(waves[1])]
        self.write("lights.csv", "light,channel,re,im\n" + "".join(",".join(map(repr, map(float, row))) + "\n" for row in rows))
        own = self.solve(**keys, map_eigenchannels=[3], map_lights="lights.csv")
        field = own["total_field"]
        np.testing.assert_allclose(field[2], field[1], atol=1e-10)
        np.testing.assert_allclose(field[3], 2 * field[1] + field[0], atol=1e-10)
        t = own["scattering_matrix"][0, :, 1, :].T
        for light, amplitudes in enumerate(own["map_light"]):
            power = (abs(t @ amplitudes) ** 2).sum() / (abs(amplitudes) ** 2).sum()
            self.assertAlmostEqual(power, own["map_transmittance"][light], 9)
        for text, words in (("light,channel,re,im\n0,40,1,0\n", "must be less than the number of channels"),
                            ("light,channel,re,im\n1,4,1,0\n", "light 0 has no power"), ("light,channel,re,im\n0.5,4,1,0\n", "column light")):
            self.write("lights.csv", text)
            told = self.call("solve", **CELL, period=9.3, **keys, map_lights="lights.csv", out="no.h5", status=2).stderr
            self.assertIn(words, told)

    def test_refused(self):
        self.write("two.csv", "x,z\n0,0\n9,0.1\n")
        two = {"placement": "two.csv", "scatterer": "soft", "radius": 0.2}
        for keys, message in (({**CELL, "period": 9}, "period = 9: must be the width"),
                              ({**two, "period": 9.3}, "overlap with those of the next period"),
                              *(({**CELL, "period": 9.3, name: value}, f"{name}: not with period")
                                for name, value in (("view_angles", 1), ("light_angles", 0.2), ("near_sensors", "two.csv"), ("beam_waist", 2))),
                              ({**CELL, "period": 9.3, "wavelengths": [1, 1.1]}, "sweep --of solve --vary wavelength="),
                              ({**CELL, "period": 9.3, "map": [-1, 1, -1, 1], "map_eigenchannels": [0, 19]},
                               "map_eigenchannels = 19: must be less than the number of channels, 19"),
                              ({**CELL, "period": 9.3, "map_eigenchannels": [1]}, "is a key of period with map only"),
                              ({**CELL, "period_phase": 1}, "period_phase")):
            self.assertIn(message, self.call("solve", **keys, out="no.h5", status=2).stderr)


class Ensemble(ProgramTest):
    def test_sums_agree(self):
        done = self.call("matrix", **CELL, samples=6, shifts=3, numerical_aperture=0.5, segments=[1, 5], conjugated_fraction=[0.3, 1],
                  out="matrix.h5")
        found = datasets(self.folder / "matrix.h5")
        self.assertRegex(done.stdout, r"tilt correlation C_E +" + f"{found['tilt_correlation'][1]:.4g}".replace(".", r"\."))
        self.assertEqual("wider period" in done.stdout, bool(found["tilt_correlation"][1]**2 < 0.5))
        self.assertNotIn("Poisson", done.stdout)
        points = {"width": 9.3, "depth": 4, "scatterer": "point", "mean_free_path": 3, "samples": 2, "out": "points.h5", "status": 3}
        few = self.call("matrix", **points).stdout
        self.assertIn("Poisson", few)
        self.assertRegex(few, r"variance of conductance +\S+, of unknown error")
        np.testing.assert_allclose(found["transmittance"].sum(), found["conductance"])
        np.testing.assert_allclose(found["transmittance"] + found["reflectance"], 1, atol=1e-6)
        np.testing.assert_allclose(found["eigenvalue_count"].sum(), len(found["light_sine"]))
        kept = (abs(found["light_sine"]) < 0.5).sum()
        np.testing.assert_allclose(found["filtered_eigenvalue_count"].sum(), kept)
        np.testing.assert_allclose(found["filtered_law_count"].sum(), kept)
        np.testing.assert_allclose(found["tilt_correlation"][0], 1)
        np.testing.assert_allclose(found["segment_enhancement"][0], 1)
        self.assertTrue(np.all(found["conjugation_peak"] < 1))
        np.testing.assert_allclose(found["conjugated_fraction"], [6 / 19, 1])
        self.assertLessEqual(found["tilt_correlation"].max(), 1 + 1e-12)

    def test_refused(self):
        for keys, message in (({"shifts": 9}, "shifts = 9: must be less than half"),
                              ({"numerical_aperture": 0.01, "period_phase": 1}, "numerical_aperture = 0.01: must be larger"),
                              ({"segments": [4, 20]}, "segments = 20: must not exceed the number of channels, 19"),
                              ({"conjugated_fraction": 1.1}, "conjugated_fraction = 1.1: must be"),
                              ({"domain": "slab", "count": None, "width": None, "density": 0.1}, "domain"),
                              ({"width": 0.5, "count": 1}, "fewer than two channels")):
            self.assertIn(message, self.call("matrix", **{**CELL, **keys}, samples=2, out="no.h5", status=2).stderr)


if __name__ == "__main__":
    unittest.main()
