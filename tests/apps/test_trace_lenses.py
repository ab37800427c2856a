"""Properties of optical systems by `trace`: paraxial constants of published systems, glasses, Strehl ratio and MTF
against closed forms, aspheres, mirrors and apertures."""

import unittest

import numpy as np

from refusing import RefusingTest
from program import datasets

PARALLEL = {"field": "homogeneous", "light": "disk", "ray_count": 400, "max_length": 1000}


def plane(z):
    return [0, 0, z, 0, 0, 1]


class LensTest(RefusingTest):
    def trace(self, **keys):
        self.output = self.call("trace", **{**PARALLEL, **keys}, out="rays.h5").stdout
        return datasets(self.folder / "rays.h5")


class Systems(LensTest):
    def test_eye_of_le_grand(self):
        """Published: power 59.940 D, focal point 24.197 mm behind the cornea. The bodies overlap: the smaller one counts."""
        cornea, lens = [0, 0, 0, 4, 7.8, 6.5, 0.55, 1.3771], [0, 0, 3.6, 3.5, 10.2, -6, 4, 1.42]
        aqueous, vitreous = [0, 0, 0.55, 4.5, 6.5, 0, 4.6, 1.3374], [0, 0, 5.15, 4.6, 0, 0, 40, 1.336]
        rows = sum((body + [0, 0, 0] for body in (cornea, aqueous, vitreous, lens)), [])
        found = self.trace(lens=rows, origin=[0, 0, -5], beam_radius=0.5, stop_plane=plane(20), image_plane=plane(24))
        self.assertAlmostEqual(1000 * found["image/power"], 59.940, delta=6e-4)
        self.assertAlmostEqual(found["image/paraxial_z"], 24.197, delta=6e-4)

    def test_gradient_lens_of_the_eye_of_liou_and_brennan(self):
        """Published: power of the eye 60.35 D, axial length 23.95 mm."""
        cornea = [0, 0, 0, 4, 7.77, 6.40, 0.5, 1.376]
        aqueous, vitreous = [0, 0, 0.5, 4.5, 6.40, 0, 5, 1.336], [0, 0, 5.5, 4.6, 0, 0, 40, 1.336]
        found = self.trace(field="polynomial", index=1.368, centre=[0, 0, 3.66], radial_terms=[-0.001978],
                           axial_terms=[0.049057, -0.015427], axial_break=1.59, axial_terms_beyond=[0, -0.006605],
                           body_lens=[0, 0, 3.66, 3, 12.4, -8.1, 4.02],
                           lens=sum((body + [0, 0, 0] for body in (cornea, aqueous, vitreous)), []), origin=[0, 0, -5],
                           beam_radius=0.3, stop_plane=plane(20), image_plane=plane(24), tolerance=1e-10, step=0.02)
        self.assertAlmostEqual(1000 * found["image/power"], 60.35, delta=1e-2)
        self.assertAlmostEqual(found["image/paraxial_z"], 23.95, delta=6e-3)

    def test_wood_lens_and_rod(self):
        """n = n0 sech(g rho), and the same to fourth order: f = 1/(n0 g sin g L), back focal length cot(g L)/(n0 g)."""
        n0, g, length = 1.6, 0.3, 2.0
        for field in ({"field": "sech", "index": n0, "alpha": g},
                      {"field": "polynomial", "index": n0, "radial_terms": [-n0 * g**2 / 2, 5 * n0 * g**4 / 24]}):
            found = self.trace(**field, body_lens=[0, 0, 0, 0.9, 0, 0, length], origin=[0, 0, -1], beam_radius=0.3,
                               stop_plane=plane(3), image_plane=plane(4), tolerance=1e-12)
            self.assertAlmostEqual(found["image/focal_length"] * n0 * g * np.sin(g * length), 1, delta=2e-7)
            self.assertAlmostEqual(found["image/back_focal_length"] * n0 * g * np.tan(g * length), 1, delta=2e-7)

    def test_thick_lens(self):
        """Focal length and back focal length of a thick lens, by the lens maker's equation."""
        n, r1, r2, d = 1.5168, 51.5, -80, 5
        power = (n - 1) * (1 / r1 - 1 / r2 + (n - 1) * d / (n * r1 * r2))
        found = self.trace(lens=[0, 0, 0, 12.5, r1, r2, d, n, 0, 0, 0], origin=[0, 0, -20], beam_radius=10,
                           stop_plane=plane(50), image_plane=plane(60))
        self.assertAlmostEqual(found["image/focal_length"] * power, 1, delta=1e-9)
        self.assertAlmostEqual(found["image/back_focal_length"] * power / (1 - (n - 1) * d / (n * r1)), 1, delta=1e-9)
        self.assertAlmostEqual(found["image/f_number"], 1 / power / 20, delta=1e-7)
        self.assertIn("focal length", self.output)

    def test_glass(self):
        """Index of the catalogue at the lines d, F and C, through the power of a thin lens; an achromat by Abbe numbers."""
        keys = {"length_unit": "mm", "origin": [0, 0, -20], "beam_radius": 2, "stop_plane": plane(50), "image_plane": plane(60)}
        for line, index in ((0.5875618e-3, 1.51680), (0.4861327e-3, 1.52238), (0.6562725e-3, 1.51432)):
            power = self.trace(lens=[0, 0, 0, 5, 50, 0, 2, 9, 0, 0, 0], lens_glass="N-BK7", wavelength=line, **keys)["image/power"]
            self.assertAlmostEqual(1 + 50 * power, index, delta=6e-6)
        powers = [self.trace(lens=[0, 0, 0, 5, 50, 0, 2, 9, 0, 0, 0], lens_glass="1.5168/64.17", wavelength=line, **keys)["image/power"]
                  for line in (0.5875618e-3, 0.4861327e-3, 0.6562725e-3)]
        self.assertAlmostEqual(powers[0] / (powers[1] - powers[2]), 64.17, delta=1e-3)
        self.assert_refused(["lens_glass = BK77", "N-BK7"], "trace", lens=[0, 0, 0, 5, 50, 0, 2, 9, 0, 0, 0], lens_glass="BK77",
                            wavelength=1e-3, **PARALLEL, **keys)


class Quality(LensTest):
    LENS = {"asphere": [0, 0, 0, 10, 0, 0, -50, -1.5**2, 8, 1.5, 0, 0, 0], "origin": [0, 0, -5], "beam_radius": 8,
            "stop_plane": plane(40), "image_plane": plane(8 + 100), "wavelength": 0.5e-3, "ray_count": 2000}

    def test_stigmatic_lens(self):
        """A plano-hyperbolic lens, k = -n^2, has no aberration at R/(n - 1): Strehl ratio 1 and the MTF of a round pupil."""
        found = self.trace(**self.LENS)
        self.assertLess(found["image/spot_radius"], 1e-12)
        self.assertAlmostEqual(found["image/strehl"], 1, delta=1e-9)
        f = found["image/mtf_frequency"] / found["image/mtf_frequency"][-1]
        ideal = 2 / np.pi * (np.arccos(f) - f * np.sqrt(1 - f**2))
        for name in ("mtf_x", "mtf_y", "mtf_ideal"):
            np.testing.assert_allclose(found["image/" + name], ideal, atol=0.004)
        self.assertAlmostEqual(found["image/mtf_frequency"][-1], 2 * found["image/aperture"] / 0.5e-3, delta=1e-6)

    def test_defocus(self):
        """Defocus by dz: W = NA^2 dz/2 rho^2 for small NA, Strehl ratio sinc^2 of half the edge's W in wavelengths."""
        dz = 0.1
        found = self.trace(**{**self.LENS, "image_plane": plane(108 + dz)})
        edge = found["image/aperture"]**2 * dz / 2 / 0.5e-3
        self.assertAlmostEqual(found["image/strehl"], np.sinc(edge)**2, delta=0.01)
        self.assertAlmostEqual(found["image/best_strehl"], 1, delta=1e-9)
        self.assertLess(found["image/mtf_x"][5], 0.9 * found["image/mtf_ideal"][5])

    def test_even_terms(self):
        """A back face a4 rho^4 deflects rays outwards by 4 a4 rho^3 (n - 1)."""
        keys = {"origin": [0, 0, -5], "beam_radius": 1, "stop_plane": plane(9), "light": "line", "ray_count": 11}
        plate = self.trace(asphere=[0, 0, 0, 2, 0, 0, 0, 0, 1, 1.5, 0, 0, 0], asphere_terms=[0, 0, 0, 1e-5, 0, 0], **keys)
        np.testing.assert_allclose(plate["exit/dx"], 0.5 * 4e-5 * plate["start/x"]**3, atol=1e-9)

    def test_spherical_faces_are_a_lens(self):
        keys = {"origin": [0.1, 0, -3], "beam_radius": 0.8, "stop_plane": plane(9)}
        lens = self.trace(lens=[0, 0, 0, 1, 2, -3, 0.8, 1.5, 0, 0, 0], **keys)
        asphere = self.trace(asphere=[0, 0, 0, 1, 2, 0, -3, 0, 0.8, 1.5, 0, 0, 0], **keys)
        for name in ("exit/x", "exit/y", "exit/dx", "optical_path", "transmittance"):
            np.testing.assert_allclose(asphere[name], lens[name], atol=1e-12)


class Faces(LensTest):
    def test_parabolic_mirror(self):
        """Parallel light meets at R/2 before the mirror, for any height."""
        found = self.trace(asphere=[0, 0, 20, 8, -40, -1, 0, 0, 2, 1.5, 0, 0, 0], asphere_face="mirror", origin=[0, 0, -5],
                           beam_radius=7, stop_plane=[0, 0, -6, 0, 0, -1], image_plane=[0, 0, 0, 0, 0, -1])
        self.assertLess(found["image/spot_radius"], 1e-12)
        self.assertAlmostEqual(found["image/focal_length"], 20, delta=1e-7)

    def test_apertures_and_absorbing_bodies(self):
        keys = {"origin": [0, 0, 0], "beam_radius": 1, "stop_plane": plane(9), "ray_count": 1000, "image_plane": plane(9)}
        found = self.trace(aperture_stop=[0, 0, 1, 0, 0, 1, 0.5], **keys)
        rho = np.hypot(found["start/x"], found["start/y"])
        np.testing.assert_array_equal(found["status"] == 3, rho > 0.5)
        np.testing.assert_allclose(found["exit/z"], np.where(rho > 0.5, 1, 9))
        self.assertEqual(len(found["image/ray"]), np.sum(rho <= 0.5))
        found = self.trace(ball=[0, 0, 3, 0.5, 1.5, 0, 0, 0], ball_face="absorb", **keys)
        np.testing.assert_array_equal(found["status"] == 3, rho < 0.5)
        self.assertIn("absorbed", self.output)

    def test_refused(self):
        body = {**PARALLEL, "stop_plane": plane(9)}
        self.assert_refused(["ball_face"], "trace", ball=[0, 0, 3, 0.5, 1.5, 0, 0, 0], ball_face=["absorb", "mirror"], **body)
        self.assert_refused(["asphere", "must extend"], "trace", asphere=[0, 0, 0, 3, 2, 0, 0, 0, 1, 1.5, 0, 0, 0], **body)
        self.assert_refused(["lens_face"], "trace", lens_face="mirror", **body)


if __name__ == "__main__":
    unittest.main()
