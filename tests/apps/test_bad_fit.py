"""Rejected fits: one line, status 2, nothing written."""

import unittest

from refusing import RefusingTest

GOOD = "tilt,field_correlation,error\n0.0001,0.9,0.01\n0.0002,0.8,0.01\n0.0004,0.7,0.01\n"
FREE = ["g=0.5:0.95"]
SLAB = {"depth": 2000, "optical_depth": 4}


class BadFit(RefusingTest):
    def refused(self, words, table=GOOD, free=None, **keys):
        path = self.write("m.csv", table)
        self.assert_refused(words, "fit", "--free", *(free or FREE), "--measurement", path.name,
                            **{**SLAB, **keys})

    def test_free_keys(self):
        for free in ("g", "g=", "g=0.5", "g=0.5:", "g=a:b", "g=0.5:inf", "0.5:0.9"):
            self.refused(["free = ", "key=lower:upper"], free=[free])
        self.refused(["lower bound must be below"], free=["g=0.9:0.5"])
        self.refused(["g = 1:", "(-1, 1)"], free=["g=0.5:1"])
        self.refused(["must be a scene key"], free=["gg=0.5:0.9"])
        self.refused(["must be a scene key"], free=["scatterer=0.5:0.9"])
        self.refused(["must be a scene key"], free=["tilts=0.5:0.9"])
        self.refused(["given twice"], free=["g=0.5:0.9", "g=0.1:0.2"])
        self.refused(["g = 0.2", "within the bounds"], g=0.2)
        self.refused(["radius", "is a key of"], free=["radius=0.1:0.2"])
        self.refused(["density is given more than once"], free=["mean_free_path=1:100"])
        self.refused(["free = 4", "must not exceed"], optical_depth=None,
                     free=["g=0.5:0.9", "albedo=0.5:1", "optical_depth=1:10", "wavelength=0.9:1.1"])

    def test_errors(self):
        self.refused(["m.csv", "must have a column named error"], "tilt,field_correlation\n0.1,0.5\n")
        self.refused(["error of value 1 must be positive"],
                     "tilt,field_correlation,error\n0.1,0.5,0\n0.2,0.5,0\n")
        self.refused(["error of value 2 must be positive"],
                     "tilt,field_correlation,error\n0.1,0.5,1\n0.2,0.5,-1\n")
        self.refused(["covariance_2"], "tilt,field_correlation,covariance_1\n0.1,0.5,1\n0.2,0.5,1\n")
        self.refused(["symmetric"], "tilt,field_correlation,covariance_1,covariance_2\n"
                                    "0.1,0.5,1,0.5\n0.2,0.5,0.4,1\n")
        self.refused(["positive definite"], "tilt,field_correlation,covariance_1,covariance_2\n"
                                            "0.1,0.5,1,2\n0.2,0.5,2,1\n")
        for value, error in (("-1e308", 0.05), (0.8, "1e308"), (0.8, "1e-200")):
            self.refused(["m.csv", "at most 1e50" if error != "1e-200" else "positive"],
                         f"tilt,field_correlation,error\n0.002,{value},{error}\n0.004,0.6,0.05\n")
        self.refused(["not both"], "tilt,field_correlation,error,covariance_1\n0.1,0.5,1,1\n")

    def test_shapes(self):
        self.refused(["one column among"], "tilt,error\n0.1,0.1\n")
        self.refused(["one column among"], "tilt,field_correlation,intensity,error\n0.1,1,1,1\n")
        self.refused(["tilt"], "field_correlation,error\n0.5,0.1\n")
        self.refused(["column width"], "width,transmittance,error\n5,0.5,0.1\n")
        self.refused(["depth = 2000", "leave the key out"], "depth,transmittance,error\n5,0.5,0.1\n")
        self.refused(["column \"tilt (deg)\"", "tilt_deg"], "tilt (deg),field_correlation,error\n0.1,0.5,0.1\n")
        self.refused(["column tilt"], "tilt,transmittance,error\n5,0.5,0.1\n")
        self.refused(["at least one row"], "transmittance,error\n")
        self.refused(["given twice"], "tilt,field_correlation,error\n0.1,0.5,1\n0.1,0.5,1\n")
        self.refused(["light_angles", "pi/2"], "light_angle,transmittance,error\n3,0.5,0.1\n")
        self.refused(["finite number"], "transmittance,error\nhalf,0.1\n")

    def test_scene(self):
        self.refused(["depth"], depth=None)
        self.refused(["domain"], domain="box", width=2000, method="transport")
        self.refused(["width"], domain="box")
        self.refused(["model_share"], model_share=0.5)
        self.refused(["model_share = 2"], model_share=2, method="mc")
        self.refused(["free = diffusion", "cannot be determined"], free=["diffusion=0.1:1"])
        self.refused(["free = beta", "cannot be determined"], free=["beta=0.1:1"],
                     table="delay,field_correlation,error\n0.1,0.5,0.1\n0.2,0.5,0.1\n")
        self.refused(["shear", "method = mc"], free=["shear=0:1"], method="transport",
                     table="delay,field_correlation,error\n0.1,0.5,0.1\n0.2,0.5,0.1\n")
        self.refused(["exposure must be positive"], "exposure,squared_contrast,error\n0,0.5,0.1\n")
        self.refused(["rows with tilt other than 0"], "tilt,field_correlation,error\n0,1,0\n")
        self.refused(["column tilt"], "delay,tilt,field_correlation,error\n0.1,0.1,0.5,0.1\n")
        self.assertIn("no.h5", self.call("fit", compare="no.h5", status=2).stderr)
        self.refused(["wavelength", "changes only the medium"], method="mc", free=["wavelength=0.9:1.1"])
        self.assert_refused(["free is not given"], "fit", measurement="m.csv")
        self.assert_refused(["measurement is not given"], "fit", free="g=0:0.5")
        self.assert_refused(["no.csv"], "fit", free="g=0:0.5", measurement="no.csv", **SLAB)
        self.write("damaged.h5", "no result")
        self.assert_refused(["damaged.h5"], "fit", free="g=0:0.5", measurement="damaged.h5", **SLAB)

    def test_distances(self):
        reflectance, decay = "distance,reflectance,error\n5,1e-3,1e-5\n9,1e-4,1e-6\n", "distance,delay,field_correlation,error\n5,0.1,0.5,0.1\n"
        def refused(words, table=reflectance, free=("mu_a=0.001:0.1",), **keys):
            self.refused(words, table, free, **{"depth": 100, "optical_depth": None, "mu_s": 10, "g": 0.9, "detector_radius": 1, **keys})
        refused(["detector_radius, ring_width", "exactly one"], detector_radius=None)
        refused(["distance = 5", "must not overlap"], detector_radius=5)
        refused(["column distance"], "distance,transmittance,error\n5,0.5,0.1\n")
        refused(["column light_angle"], "distance,light_angle,reflectance,error\n5,0,0.5,0.1\n")
        refused(["delay"], "distance,field_correlation,error\n5,0.5,0.1\n")
        refused(["delay must be positive"], decay.replace("0.1,0.5", "-0.1,0.5"))
        refused(["values at distances", "transport"], method="mc", seed=1)
        for key in "dimension", "light_azimuths", "view_azimuths":
            refused([key, "light at distances"], **{key: 3})
        refused(["free = detector_scale", "cannot be determined"], decay, free=("detector_scale=0.1:10",))
        refused(["detector_scale"], decay, detector_scale=2)
        refused(["albedo = 0.9", "follows from mu_s"], albedo=0.9)
        refused(["more than once (mean_free_path, mu_s)"], mean_free_path=1)
        refused(["mu_a", "requires mu_s"], mu_s=None, mean_free_path=1)
        refused(["mu_s = 10", "requires a phase function"], scatterer="mie", g=None, free=("radius=0.1:1",))
        self.refused(["detector_radius", "at distances"], detector_radius=1)

    def test_results(self):
        slab = {"domain": "slab", "scatterer": "hg", "optical_depth": 2, "depth": 100}
        self.call("flux", **slab, method="transport", out="transport.h5")
        self.call("flux", **slab, samples=1000, out="mc.h5")
        self.call("covariance", **slab, covariance="pairs", pairs=[0, 0.1, 0, 0.1], samples=1000,
                  out="pairs.h5")
        free = {"free": "g=0:0.5"}
        self.assert_refused(["numerical errors"], "fit", **free, optical_depth=2,
                            measurement="transport.h5")
        self.assert_refused(["must contain field_correlation"], "fit", **free, optical_depth=2, measurement="pairs.h5")
        self.assert_refused(["depth = 50", "has 100"], "fit", **free, optical_depth=2, depth=50,
                            measurement="mc.h5")
        self.call("flux", **{**slab, "depth": 50}, samples=1000, out="thin.h5")
        self.assert_refused(["fit mean_free_path"], "fit", free="optical_depth=1:3", g=0.2,
                            measurement=["mc.h5", "thin.h5"])


    def test_plan(self):
        plan = {**SLAB, "g": 0.8, "tilts": 0.0001}
        words = ["fit", "--plan", "--free", "g=0.5:0.95"]
        self.assert_refused(["choose = tilts=3", "from 1"], "fit", "--plan", "--free", "g=-0.5:0.95", **plan, choose="tilts=3")
        self.assert_refused(["must have a value"], *words, **{**plan, "g": None})
        self.assert_refused(["must have a value"], "fit", "--plan", "--free", "g=-0.5:0.95", **{**plan, "g": 0})
        self.assert_refused(["tilts"], *words, **{**plan, "tilts": None})
        (self.folder / "m.csv").write_text("tilt,field_correlation,error\n0.001,0.9,0.01\n")
        self.assert_refused(["measurement", "is not used here"], *words, **plan, measurement="m.csv")
        self.assert_refused(["patterns = 0"], *words, **plan, patterns=0)
        self.assert_refused(["tilts = 0", "must not be 0 in a plan"], *words, **{**plan, "tilts": [0, 0.0001]})
        self.assert_refused(["g = 4.9", "must not be close"], "fit", "--plan", "--free", "g=-0.5:0.95", **{**plan, "g": 5e-324})
        self.refused(["tilts", "determined by the measurements"], tilts=0.1)
        self.refused(["view_angles", "determined by the measurements"], view_angles=0.1)
        self.refused(["patterns", "plan"], patterns=10)


if __name__ == "__main__":
    unittest.main()
