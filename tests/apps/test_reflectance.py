"""Light at distances from a beam: against render, motion and contrast, the shipped scenes, and bad input."""

import unittest

import h5py
import numpy as np

from program import DATA, ProgramTest
from refusing import RefusingTest

TISSUE = {"depth": 1000, "mu_s": 10, "mu_a": 0.02, "g": 0.9, "medium_index": 1.37,
          "distances": [5, 10], "ring_width": 2}
LAYERS = "thickness,mu_s,mu_a,g,diffusion\n2,10,0.02,0.9,0.5\n1000,5,0.01,0.8,1\n"


class Reflectance(ProgramTest):
    def run_one(self, subcommand="reflectance", out="x.h5", **keys):
        self.call(subcommand, **keys, out=out)
        file = h5py.File(self.folder / out)
        self.addCleanup(file.close)
        return file

    def test_agrees_with_render(self):
        """Power, field correlation and its derivative on rings, by Monte Carlo of the same tissue in a block."""
        delays = [1e-3, 1e-2]
        exact = self.run_one(**TISSUE, delays=delays, gradient=True)
        paths = self.run_one("render", out="paths.h5", stage_box=[-30, -30, -0.001, 30, 30, 30],
                             block=[-30, -30, 0, 30, 30, 30, 1.37, 10, 0.02, 0.9], beam_light=[0, 0, -0.001, 0, 0, 1, 0.01, 1],
                             sensor="radial", sensor_at=[0, 0, -0.001], radii=[4, 6, 9, 11], method="forward",
                             delays=delays, samples=30000, path_bins=[0, 60, 3])
        within, covariance = paths["power_within"][()], paths["power_within_covariance"][()]
        for ring, inner in enumerate((0, 2)):
            error = np.sqrt(covariance[inner, inner] + covariance[inner + 1, inner + 1] - 2 * covariance[inner, inner + 1])
            power = exact["detected_power"][ring]
            self.assertLess(abs(within[inner + 1] - within[inner] - power), 4 * error + 0.002 * power)
            found, off = (paths[f"image_correlation{name}"][:, inner + 1] for name in ("", "_error"))
            expected = exact["distance_correlation"][:, ring]
            self.assertTrue(np.all(np.abs(found - expected) < 4 * off + 0.003 * expected), (found, expected, off))
        self.assertTrue(np.all(np.diff(paths["pulse_correlation"][:], axis=1) < 0))  # longer paths decay faster
        self.assertEqual(paths["mean_transfer"][0], 0)

    def test_far_detector_of_render(self):
        """Guided paths of render to a distant disk on two layers: power, g1 and derivatives by the flow of each layer."""
        (self.folder / "tissue.csv").write_text(LAYERS)
        delays = [1e-3, 1e-2]
        exact = self.run_one(layers="tissue.csv", distances=15, detector_radius=1, medium_index=1.4, delays=delays, gradient=True)
        block = lambda top, bottom, *medium: [-40, -40, top, 40, 40, bottom, 1.4, *medium]
        paths = self.run_one("render", out="paths.h5", stage_box=[-40, -40, -0.001, 40, 40, 60],
                             block=block(0, 2, 10, 0.02, 0.9) + block(2, 60, 5, 0.01, 0.8), beam_light=[0, 0, -0.001, 0, 0, 1, 0.01, 1],
                             sensor="radial", sensor_at=[15, 0, -0.001], sensor_radius=1, rings=1, method="forward",
                             delays=delays, diffusion=[0, 1, 0.5], samples=3000)
        self.assertIn("guided", paths.attrs["plan"])
        def compare(found, name, expected):
            off = paths[f"{name}_error"][()]
            self.assertTrue(np.all(np.abs(found - expected) < 4 * off + 0.003 * np.abs(expected)), (name, found, expected, off))
            self.assertTrue(np.all(off < 0.15 * np.abs(expected)), (name, off, expected))
        compare(paths["total"][()], "total", exact["detected_power"][0])
        compare(paths["mean_correlation"][()], "mean_correlation", exact["distance_correlation"][:, 0])
        slopes = np.concatenate([np.zeros((1, 2)), exact["correlation_gradient"][()][::-1, 2, :, 0]])  # the deep block is larger
        found, off = paths["correlation_gradient"][()], paths["correlation_gradient_error"][()]
        self.assertTrue(np.all(np.abs(found - slopes) <= 4 * off + 0.005 * np.abs(slopes)), (found, slopes, off))

    def test_layers_of_motion(self):
        """g1 depends on the product of diffusion and delay, in seconds as in plain numbers."""
        (self.folder / "tissue.csv").write_text(LAYERS)
        keys = {"layers": "tissue.csv", "distances": 20, "detector_radius": 1, "medium_index": 1.4, "wavelength": 850e-6}
        delays = np.array([1e-4, 1e-3, 1e-2])
        plain = self.run_one(**keys, delays=list(delays), gradient=True)
        rate = 1e-12 * (2 * np.pi * 1.4 / 850e-9)**2
        timed = self.run_one(out="timed.h5", **keys, delays=list(delays / rate), diffusion="1e-12 m^2/s", length_unit="mm")
        np.testing.assert_allclose(timed["distance_correlation"], plain["distance_correlation"], rtol=1e-9)
        self.assertEqual(timed["delay"].attrs["units"], "s")
        g1, slope = plain["distance_correlation"][:, 0], plain["correlation_gradient"][:, 2, :, 0]
        both = 0.5 * slope[0] + slope[1]  # derivative by a common factor on all diffusion
        self.assertTrue(np.all(both < 0) and np.all(np.diff(g1) < 0))

    def test_contrast(self):
        """K^2 is beta at short exposures, and the integral of g1^2 at longer ones."""
        delays = np.concatenate([[0], np.logspace(-6, -1, 51)])
        file = self.run_one(**TISSUE, delays=list(delays), exposures=[1e-5, 0.0999], beta=0.5)
        g2 = file["distance_intensity_correlation"][:, 1]
        np.testing.assert_allclose(g2, 0.5 * file["distance_correlation"][:, 1]**2, rtol=1e-12)
        fine = np.linspace(0, 0.0999, 100001)
        expected = 2 * np.mean(np.interp(fine, delays, g2) * (1 - fine / 0.0999))
        self.assertAlmostEqual(file["distance_contrast"][0, 1], 0.5, delta=0.01)
        self.assertAlmostEqual(file["distance_contrast"][1, 1] / expected, 1, delta=0.02)

    def flow(self, top=0.5, bottom=1, out="flow.h5", **keys):
        """A laser of 20 mW, and 100 pixels at each distance from tissue whose lower layer holds the flow that is wanted."""
        (self.folder / "tissue.csv").write_text(f"thickness,mu_s,mu_a,g,diffusion\n2,10,0.02,0.9,{top}\n1000,5,0.01,0.8,{bottom}\n")
        return self.run_one(out=out, layers="tissue.csv", medium_index=1.4, wavelength=850e-6, length_unit="mm", distances=[5, 15],
                            detector_radius=1, delays=["0", "1us:10ms:9:log"], diffusion="2e-12 m^2/s",
                            tolerance=0.05, **{"exposures": "5ms", "source_power": "20mW", "pixel_area": 1, "detector_count": 100,
                                               "flow_layers": 1, "read_noise": 2, **keys})

    def test_instrument(self):
        """Photons, noise and error of the flow of K^2 and g2; derivatives against differences of other flows."""
        file = self.flow(quantum_efficiency=0.5, averaging_time=2, other_flow_error=0.2)
        modes = 2 * np.pi * np.pi * 1**2 / 850e-6**2  # of a disk of radius 1 and a numerical aperture of 1
        rate = 0.02 * 0.5 * 850e-9 / (6.62607015e-34 * 299792458) * 2 / modes * file["detected_power"][()]
        np.testing.assert_allclose(file["detector_rate"], rate, rtol=1e-9)
        photons = rate * 5e-3
        np.testing.assert_allclose(file["contrast_noise"][0], 1 / photons + 4 / photons**2, rtol=1e-9)
        contrast, beta = file["distance_contrast"][0], file["detector_rate"].attrs["beta"]
        self.assertAlmostEqual(beta, 0.233, delta=0.001)  # half of that of polarised light, Goodman
        independent = np.sqrt(2 / (100 * 400)) * (contrast + file["contrast_noise"][0])
        self.assertTrue(np.all(file["contrast_deviation"][0] > independent))
        self.assertTrue(np.all(file["contrast_deviation"][0] < 1.5 * independent))
        changed = [self.flow(**flows, out=f"{name}.h5")["distance_contrast"][0] for name, flows in
                   (("less", {"bottom": 0.98}), ("more", {"bottom": 1.02}), ("top_less", {"top": 0.49}), ("top_more", {"top": 0.51}))]
        own, other = (changed[1] - changed[0]) / 0.04, (changed[3] - changed[2]) / 0.04
        error = np.hypot(file["contrast_deviation"][0], 0.2 * other) / -own  # the flow of the other layer is known to 20 %
        np.testing.assert_allclose(1 / file["contrast_flow_ratio"][0], error, rtol=0.01)
        np.testing.assert_allclose(file["contrast_flow_crosstalk"][0], other / own, rtol=0.01)
        normal = np.array([own, other]) @ (np.array([own, other]) / file["contrast_deviation"][0]**2).T
        self.assertAlmostEqual(file["contrast_separated_ratio"][0] * np.sqrt(np.linalg.inv(normal)[0, 0]), 1, delta=0.02)

    def test_flow_from_correlation(self):
        """One mode: few photons limit g2, so that four times the time or the fibres halve the error."""
        keys = {"source_power": 2e-6, "other_flow_error": 0, "pixel_area": None, "fibre_modes": 2, "exposures": None, "read_noise": None, "detector_count": 1}
        one, longer, more = (self.flow(**{**keys, **change}, out=f"{number}.h5") for number, change in
                             enumerate(({}, {"averaging_time": "4s"}, {"detector_count": 4})))
        self.assertEqual(one["detector_rate"].attrs["beta"], 0.5)
        np.testing.assert_allclose(one["distance_intensity_correlation"][0], 0.5)
        for other in (longer, more):
            np.testing.assert_allclose(other["correlation_flow_ratio"], 2 * one["correlation_flow_ratio"][()], rtol=1e-9)
        rate, delay = one["detector_rate"][()], one["delay"][()]
        bins = np.gradient(delay)[1:-1]  # half the distance between both neighbours
        pairs = np.sqrt(1 + one["distance_intensity_correlation"][1:-1]) / (rate * np.sqrt(bins)[:, None])
        self.assertTrue(np.all(one["correlation_deviation"][1:-1] > pairs))
        np.testing.assert_allclose(one["correlation_deviation"][1], pairs[0], rtol=0.05)
        self.assertLess(one["correlation_separated_ratio"][()], np.sqrt(np.sum(one["correlation_flow_ratio"][()]**2)))

    def test_shipped_scenes(self):
        for name in ("tissue_head", "tissue_forearm"):
            file = self.run_one(config=DATA / f"scenes/{name}.toml", out=f"{name}.h5")
            self.assertTrue(np.all(np.diff(file["distance_reflectance"]) < 0))
            self.assertEqual(file.attrs["converged"], 1)


class Refused(RefusingTest):
    def test_detectors(self):
        keys = {**TISSUE, "ring_width": None}
        self.assert_refused(["detector_radius, ring_width"], "reflectance", **keys)
        self.assert_refused(["detector_radius, ring_width"], "reflectance", **{**keys, "ring_width": 1}, detector_radius=1)
        self.assert_refused(["distances = 5"], "reflectance", **keys, detector_radius=5)
        self.assert_refused(["distances = 5"], "reflectance", **keys, detector_radius=3, source_radius=2.5)
        self.assert_refused(["distances: required"], "reflectance", **{**TISSUE, "distances": None})

    def test_media(self):
        for rows, key in (("2,0,0.02,0.9", "layers"), ("2,-1,0.02,0.9", "mu_s")):
            (self.folder / "bad.csv").write_text(f"thickness,mu_s,mu_a,g\n{rows}\n9,5,0.1,0.8\n")
            self.assert_refused([key], "reflectance", layers="bad.csv", distances=5, ring_width=1)
        (self.folder / "bad.csv").write_text("thickness,mu_s,mu_a,g,medium_index\n2,9,0,0.9,1.4\n9,5,0.1,0.8,1.3\n")
        self.assert_refused(["medium_index"], "reflectance", layers="bad.csv", distances=5, ring_width=1)
        (self.folder / "bad.csv").write_text("thickness,optical_depth,mu_a\n2,9,0.1\n")
        self.assert_refused(["mu_a"], "reflectance", layers="bad.csv", distances=5, ring_width=1)
        self.assert_refused(["velocity"], "reflectance", **TISSUE, delays=[0, 1], velocity=[1, 0])
        (self.folder / "bad.csv").write_text("thickness,mu_s,mu_a,g,flow\n2,9,0.1,0.9,0\n9,5,0.1,0.8,1\n")
        for delays in ({}, {"delays": [0, 1]}):
            self.assert_refused(["column flow requires velocity", "column diffusion"], "reflectance", layers="bad.csv",
                                distances=5, ring_width=1, **delays)

    def test_instruments(self):
        flow = {**TISSUE, "delays": ["1us:1ms:8:log"], "diffusion": "1e-12 m^2/s", "wavelength": 850e-6, "length_unit": "mm",
                "source_power": "10mW", "fibre_modes": 2}
        def refuse(message, **keys):
            self.assert_refused([message], "reflectance", **{**flow, **keys})
        refuse("source_power", delays=None, diffusion=None)
        refuse("source_power", diffusion=1, delays=[1, 2, 3, 4])
        refuse("delays", delays=[0, 1e-6, 1e-5, 1e-4])
        refuse("delays", delays=[1e-6, 1e-5, 1e-4, 1e-4, 1e-3])
        refuse("fibre_modes, pixel_area", fibre_modes=None)
        refuse("fibre_modes, pixel_area", pixel_area=1)
        refuse("pixel_area", fibre_modes=None, pixel_area=0.001)
        refuse("detector_count", detector_count=10**12)
        refuse("exposures", exposures=[1e-3], averaging_time="100us")
        refuse("read_noise", read_noise=2)  # without exposures
        refuse("flow_layers", flow_layers=0)  # without layers
        refuse("other_flow_error", other_flow_error=0.2)
        refuse("source_power", source_power="-1W")
        refuse("source_power", source_power="1mm")
        (self.folder / "tissue.csv").write_text("thickness,mu_s,mu_a,g,diffusion\n2,10,0.02,0.9,0\n1000,5,0.01,0.8,1\n")
        layered = {"layers": "tissue.csv", "depth": None, "mu_s": None, "mu_a": None, "g": None}
        refuse("flow_layers", **layered, flow_layers=2)
        refuse("flow_layers", **layered, flow_layers=0)

    def test_delays_of_render(self):
        scene = {"stage_box": [-1, -1, 0, 1, 1, 1], "mu_s": 1, "point_light": [0, 0, 0.5, 1], "sensor": "area",
                 "sensor_at": [0, 0, 1], "sensor_size": [1, 1], "samples": 100}
        self.assert_refused(["delays"], "render", **scene, delays=[0.1])
        self.assert_refused(["diffusion = 1 2"], "render", **scene, method="forward", delays=[0.1], diffusion=[1, 2])


if __name__ == "__main__":
    unittest.main()
