"""A slab's parameters from measured tables and from results of the program itself."""

import os
import pty
import subprocess
import time
import unittest

import numpy as np

from journals import records
from program import DATA, PROGRAM, SAMPLES, WHOLE, ProgramTest, attributes, datasets, flags

MEASURED = DATA / "measurements"
FREE = ["g=0.5:0.95", "albedo=0.9:1", "optical_depth=1:20"]
TRUTH = [0.8, 0.98, 4]
ALL = [MEASURED / f"slab_{name}.csv" for name in ("transmission", "reflection", "transmittance")]
FAR_START = {"g": 0.55, "albedo": 0.91, "optical_depth": 15}


class Fit(ProgramTest):
    def fit(self, *measurements, status=0, **keys):
        done = self.call("fit", "--free", *keys.pop("free", FREE), status=status, depth=2000, threads=1,
                         measurement=[str(one) for one in measurements], out="fit.h5", **keys)
        return done, datasets(self.folder / "fit.h5")

    def test_tables(self):
        """By night a start given by the scene leads to the same result."""
        done, found = self.fit(*ALL)
        normalised = (found["estimate"] - TRUTH) / found["estimate_error"]
        self.assertLess(np.abs(normalised).max(), 3)
        self.assertEqual([name.decode() for name in found["parameter_name"]],
                         ["g", "albedo", "optical_depth"])
        chi_squared = attributes(self.folder / "fit.h5")["chi_squared"]
        self.assertAlmostEqual(chi_squared, np.sum(found["pull"]**2), delta=1e-6)
        self.assertLess(chi_squared, 14 + 4 * 28**0.5)
        self.assertIn("mu_s (1 - g) is known to", done.stdout)
        if not WHOLE:
            return
        _, stated = self.fit(*ALL, **FAR_START)
        off = np.abs(found["estimate"] - stated["estimate"]) / found["estimate_error"]
        self.assertLess(off.max(), 0.1)

    def test_distances(self):
        """Shipped tables of tissue: coefficients, and scale, diffusion and beta of a detector without calibration."""
        keys = {"depth": 100, "g": 0.9, "medium_index": 1.4, "detector_radius": 0.5}
        tables = [MEASURED / f"distance_{name}.csv" for name in ("reflectance", "correlation")]
        free = {"mu_a=0.001:0.1": 0.013, "mu_s=2:50": 11.5, "detector_scale=0.01:100": 1, "diffusion=10:10000": 125.6, "beta=0.1:1": 0.45}
        for count, limit, values in ((1, 2, 11), (2, 5, 41)):
            done = self.call("fit", "--free", *list(free)[:limit], measurement=[str(one) for one in tables[:count]], out="fit.h5", **keys)
            found = datasets(self.folder / "fit.h5")
            off = (found["estimate"] - list(free.values())[:limit]) / found["estimate_error"]
            self.assertLess(np.abs(off).max(), 3)
            self.assertEqual(len(found["measured"]), values)
            self.assertTrue(np.all(found["datum_distance"] >= 5))
            self.assertIn("reduced_scattering", done.stdout)

    def test_progress_on_a_terminal(self):
        """The line is updated five times per second, and ends before the table."""
        terminal, line = pty.openpty()
        command = [PROGRAM, "fit", "--free", *FREE, "--measurement", *map(str, ALL), "--out", "fit.h5", "--depth", "2000"]
        subprocess.run(command, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=line, check=True, timeout=60)
        os.close(line)
        printed = os.read(terminal, 1 << 16).decode()
        os.close(terminal)
        self.assertRegex(printed, r"fit: \d+ s, chi\^2 [0-9.e+]+ so far, \d+ media, [0-9.]+/s")
        self.assertRegex(printed, r"chi\^2 3\.45\d so far, \d+ media in .* s\r?\n\Z")

    def test_a_result_of_many_close_tilts(self):
        """Errors are so correlated that they cancel to rounding in some sums."""
        tilts = [0, 0.0003, 0.0006, 0.0009, 0.0012, 0.0016, 0.002, 0.0025, 0.003, 0.004, 0.006, 0.01]
        for seed in (1, 2) if WHOLE else (1,):
            self.call("covariance", domain="slab", depth=100, scatterer="hg", g=0.9, albedo=0.99,
                      optical_depth=10, tilts=tilts, covariance="memory_effect", view_angles=0,
                      method="mc", target_error=0.01, seed=seed, out="measured.h5")
            self.call("fit", "--free", "g=0.5:0.99", "optical_depth=1:30", depth=100, albedo=0.99,
                      measurement="measured.h5", out="fit.h5")
            found = datasets(self.folder / "fit.h5")
            normalised = (found["estimate"] - [0.9, 10]) / found["estimate_error"]
            self.assertLess(np.abs(normalised).max(), 4)
            self.assertLess(attributes(self.folder / "fit.h5")["chi_squared"], 9 + 4 * 18**0.5)

    def test_a_model_that_cannot_be(self):
        self.write("curve.csv", "tilt,field_correlation,error\n" + "".join(
            f"{0.001 * i},{0.99 - 0.001 * i},0.001\n" for i in range(1, 6)))
        done = self.call("fit", "--free", "g=0:0.8", depth=100, optical_depth=10,
                         measurement="curve.csv", out="fit.h5")
        self.assertIn("at its bound", done.stdout)
        self.assertIn("chi^2 is unlikely", done.stdout)

    def test_covariance_in_place_of_errors_and_squares(self):
        """C_I with the errors of C_E^2 gives the same estimate."""
        rows = np.loadtxt(MEASURED / "slab_transmission.csv", delimiter=",", skiprows=2)
        columns = np.hstack([rows[:, :3], np.diag(rows[:, 3]**2)])
        names = ["view_angle", "tilt", "field_correlation"] + [f"covariance_{i}" for i in range(1, 9)]
        np.savetxt(self.folder / "t.csv", columns, delimiter=",", header=",".join(names), comments="")
        _, field = self.fit(ALL[0], free=FREE[::2], albedo=0.98)
        _, covariance = self.fit("t.csv", free=FREE[::2], albedo=0.98)
        np.testing.assert_allclose(field["estimate"], covariance["estimate"], rtol=1e-6)
        rows[:, 3] *= 2 * rows[:, 2]
        rows[:, 2] **= 2
        np.savetxt(self.folder / "t.csv", rows, delimiter=",", comments="",
                   header="view_angle,tilt,intensity_correlation,error")
        _, squares = self.fit("t.csv", free=FREE[::2], albedo=0.98)
        off = np.abs(field["estimate"] - squares["estimate"]) / field["estimate_error"]
        self.assertLess(off.max(), 0.3)

    def test_results(self):
        """Fits the power transmitted by two thicknesses of one medium, by Monte Carlo."""
        medium = {"domain": "slab", "scatterer": "hg", "g": 0.5, "albedo": 0.9,
                  "mean_free_path": 50, "samples": 20000}
        for depth in (50, 200):
            self.call("flux", **medium, depth=depth, out=f"{depth}.h5")
        self.call("fit", "--free", "albedo=0.5:1", "mean_free_path=10:200", g=0.5,
                  measurement=["50.h5", "200.h5"], out="fit.h5")
        found = datasets(self.folder / "fit.h5")
        normalised = (found["estimate"] - [0.9, 50]) / found["estimate_error"]
        self.assertLess(np.abs(normalised).max(), 4)

    def test_curves_of_one_run(self):
        """Tilts of one Monte Carlo run share paths: its sums give the correlation of errors."""
        self.call("covariance", domain="slab", depth=2000, scatterer="hg", g=0.8, optical_depth=4,
                  albedo=0.98, covariance="memory_effect", view_angles=0.1, seed=3, samples=100000,
                  tilts=[0, 0.0002, 0.0003, 0.0004, 0.0006], out="t.h5")
        done = self.call("fit", "--free", "g=0.5:0.95", measurement="t.h5", optical_depth=4, albedo=0.98,
                         out="fit.h5")
        self.assertEqual(done.stderr, "")
        found = datasets(self.folder / "fit.h5")
        self.assertEqual(len(found["measured"]), 4)
        self.assertLess(abs(found["estimate"][0] - 0.8) / found["estimate_error"][0], 4)
        self.assertLess(attributes(self.folder / "fit.h5")["chi_squared"], 3 + 4 * 6**0.5)

    def test_thicknesses_of_a_table(self):
        self.write("t.csv", "depth,transmittance,error\n50,0.9,0.05\n200,0.5,0.05\n")
        self.call("fit", free="mean_free_path=10:1000", measurement="t.csv", out="fit.h5")
        self.assertEqual(list(datasets(self.folder / "fit.h5")["datum_curve"]), [0, 1])

    def test_plan(self):
        keys = {"free": ["g=0.5:0.95", "optical_depth=1:20"], "depth": 2000, "g": 0.8, "optical_depth": 4,
                "view_angles": [0.1, 0.4], "tilts": [0.0002, 0.0006]}
        done = self.call("fit", "--plan", **keys, patterns=100, out="plan.h5")
        found = datasets(self.folder / "plan.h5")
        percent = 100 * (100 * found["planned_error"] / found["planned"])**2
        np.testing.assert_allclose(found["patterns_to_percent"], percent)
        self.assertEqual(found["growth_without_view"].shape, (2, 2))
        self.assertIn("patterns to 1 %", done.stdout)

    def test_paths(self):
        """Monte Carlo agrees with transport within its stated statistical error."""
        files = [MEASURED / "slab_transmission.csv", MEASURED / "slab_transmittance.csv"]
        keys = {"free": ["g=0.5:0.95", "optical_depth=1:20"], "albedo": 0.98}
        _, transport = self.fit(*files, **keys)
        _, paths = self.fit(*files, **keys, method="mc", model_share=0.3)
        statistical = np.sqrt(np.diag(paths["chance_covariance"]))
        off = np.abs(paths["estimate"] - transport["estimate"])
        self.assertLess((off / statistical).max(), 4)
        measured = np.sqrt(paths["estimate_error"]**2 - statistical**2)
        self.assertLess((statistical / measured).max(), 0.3**0.5)
        np.testing.assert_allclose(measured, transport["estimate_error"], rtol=0.3)

    def test_box(self):
        """Fits cylinders in a box to intensities by Monte Carlo."""
        box = {"domain": "box", "width": 20, "depth": 10, "scatterer": "tm"}
        self.call("covariance", **box, radius=0.16, index="1.5", density=0.33, seed=7, method="mc",
                  samples=int(40000 * SAMPLES), view_angles=[0.2, 0.5, 0.9, 1.3, 1.8, 2.4, 2.8], out="box.h5")
        by_night = ["index=1.2:1.8"] if WHOLE else []
        self.call("fit", "--free", "density=0.1:1", "radius=0.1:0.25", *by_night, index=None if WHOLE else "1.5", scatterer="tm",
                  measurement="box.h5", model_share=0.5, threads=1, out="fit.h5")
        found = datasets(self.folder / "fit.h5")
        normalised = (found["estimate"] - [0.33, 0.16, 1.5][:len(found["estimate"])]) / found["estimate_error"]
        self.assertLess(np.abs(normalised).max(), 4)

    def test_motion(self):
        """Fits diffusion and shear to decays and contrasts of a run; the table's delays include 0."""
        slab = {"domain": "slab", "depth": 50, "scatterer": "hg", "g": 0.6, "optical_depth": 5,
                "view_angles": [0.2, 0.9, 2.64] if WHOLE else [0.2, 2.64]}
        self.call("covariance", **slab, method="mc", samples=20000, seed=5, diffusion=0.5, shear=0.02,
                  delays=[0, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2] if WHOLE else [0, 0.01, 0.05, 0.2], out="flow.h5")
        free = {"depth": 50, "g": 0.6, "optical_depth": 5, "threads": 1}
        for words in ({"measurement": "flow.h5"}, {"measurement": "contrast.h5"}):
            if words["measurement"] == "contrast.h5":
                self.call("covariance", **slab, method="mc", samples=20000, seed=6, diffusion=0.5, shear=0.02,
                          delays=[0.001, 0.002, 0.004, 0.008, 0.02, 0.05, 0.1, 0.2],
                          exposures=[0.02, 0.05, 0.1, 0.2] if WHOLE else [0.02, 0.1], beta=0.5, out="contrast.h5")
            self.call("fit", "--free", "diffusion=0.05:5", "shear=0:0.1", **free, **words, out="fit.h5")
            found = datasets(self.folder / "fit.h5")
            normalised = (found["estimate"] - [0.5, 0.02]) / found["estimate_error"]
            self.assertLess(np.abs(normalised).max(), 4)
            self.assertGreater(found["datum_time"].min(), 0)
        self.write("decay.csv", "delay,field_correlation,error\n0,1,0\n0.01,0.9,0.01\n0.02,0.8,0.01\n")
        done = self.call("fit", "--free", "diffusion=0.001:5", **free, measurement="decay.csv", out="fit.h5")
        self.assertIn("diffusion_constant", done.stdout)
        self.assertEqual(len(datasets(self.folder / "fit.h5")["measured"]), 2)

    def test_power_of_a_box(self):
        """Fits by its own walks to powers of flux."""
        box = {"domain": "box", "width": 20, "depth": 10, "scatterer": "hg"}
        self.call("flux", **box, g=0.5, albedo=0.9, mean_free_path=4, light_angles=[0, 0.7],
                  samples=int(100000 * SAMPLES), seed=3, out="power.h5")
        self.call("fit", "--free", "g=0:0.9", "albedo=0.5:1", "mean_free_path=1:20", scatterer="hg",
                  measurement="power.h5", model_share=0.5, threads=1, out="fit.h5")
        found = datasets(self.folder / "fit.h5")
        normalised = (found["estimate"] - [0.5, 0.9, 4]) / found["estimate_error"]
        self.assertLess(np.abs(normalised).max(), 4)

    def test_killed_and_resumed(self):
        """A killed search, resumed from its steps, gives the same bits."""
        words = ["fit", "--free", "g=0.5:0.95", "optical_depth=1:20"]
        keys = {"depth": 2000, "albedo": 0.98, "method": "mc", "threads": 1, "model_share": 0.5,
                "measurement": str(MEASURED / "slab_transmission.csv")}
        self.call(*words, **keys, out="whole.h5")
        command = [PROGRAM, *words, *flags(keys), "--out", "killed.h5"]
        with subprocess.Popen(command, cwd=self.folder, stdout=subprocess.DEVNULL) as run:
            journal = self.folder / "killed.h5.search"
            while run.poll() is None and not (journal.exists() and len(records(journal)) > 4):
                time.sleep(0.002)
            run.kill()
        self.assertFalse((self.folder / "killed.h5").exists())
        with open(journal, "ab") as file:
            file.write(b"fblk cut")
        self.call(*words, "--resume", **keys, out="killed.h5")
        whole, resumed = datasets(self.folder / "whole.h5"), datasets(self.folder / "killed.h5")
        for name in whole:
            np.testing.assert_array_equal(whole[name], resumed[name], name)
        self.assertFalse(journal.exists())

    def test_compare(self):
        """Of two media for the same curves the true one is likelier."""
        for name, scatterer in (("hg", {"scatterer": "hg"}), ("rayleigh", {"scatterer": "rayleigh"})):
            free = ["optical_depth=1:20"] + (["g=0.5:0.95"] if name == "hg" else [])
            self.call("fit", "--free", *free, **scatterer, depth=2000, albedo=0.98, out=f"{name}.h5",
                      measurement=str(MEASURED / "slab_reflection.csv"))
        lines = self.call("fit", compare=["rayleigh.h5", "hg.h5"]).stdout.splitlines()
        self.assertTrue(lines[1].startswith("hg.h5"), lines)

    def test_plans(self):
        free = ["g=-0.5:0.95", "optical_depth=0.1:20"][:2 if WHOLE else 1]
        self.call("fit", "--plan", "--free", *free, "--vary", "g=0.5,0.8", "optical_depth=1,4",
                  depth=2000, view_angles=0.1, tilts=[0.0002, 0.0006], out="plans.h5")
        self.call("fit", "--plan", "--free", *free, g=0.8, optical_depth=1,
                  depth=2000, view_angles=0.1, tilts=[0.0002, 0.0006], out="plan.h5")
        plans, plan = datasets(self.folder / "plans.h5"), datasets(self.folder / "plan.h5")
        np.testing.assert_allclose(plans["point_patterns_to_percent"][2], plan["patterns_to_percent"])

    def test_not_converged(self):
        done, found = self.fit(ALL[0], free=FREE[::2], albedo=0.98, status=3, most_iterations=1)
        self.assertIn("not converged", done.stdout)
        self.assertEqual(attributes(self.folder / "fit.h5")["converged"], 0)
        self.assertEqual(len(found["estimate"]), 2)


if __name__ == "__main__":
    unittest.main()
