"""Every kind of result is checked by an invariant with a limit; a result that violates it has not converged."""

import unittest

import h5py

from program import BOX, CYLINDERS, SLAB, ProgramTest

HG = {"width": 20, "depth": 10, "scatterer": "hg", "optical_depth": 2, "g": 0.5}
RAYS = {"field": "luneburg", "light": "line", "ray_count": 3, "beam_radius": 0.4, "origin": [0, 0, -2],
        "stop_plane": [0, 0, 2, 0, 0, 1], "max_length": 10}
IMAGE = {"domain": "box", **HG, "width": 60, "object_x": [0, 20], "object_depth": -500, "camera": [-0.3, 0.3],
         "pixels": 128, "repeats": 2, "paths_per_field": 20, "prediction_paths": 300000}
STAGE = {"stage_box": [-1, -1, 0, 1, 1, 4], "mu_s": 0.5, "point_light": [0, 0, 1, 1], "sensor": "area", "sensor_at": [0, 0, 4],
         "sensor_size": [2, 2], "pixels": [8, 8],
         "method": "forward", "samples": 20000}

RUNS = {  # invariant: subcommand, keys
    "light": [("render", STAGE)],
    "power": [("covariance", BOX | {"samples": 2000000}),
              ("covariance", BOX | {"method": "wave", "samples": 20}),
              ("covariance", SLAB | {"albedo": 0.8}),
              ("flux", SLAB | {"albedo": 0.8}),
              ("flux", HG | {"samples": 20000}),
              ("solve", CYLINDERS),
              ("render", STAGE)],
    "path_power": [("covariance", HG | {"samples": 300000}),
                   ("covariance", HG | {"albedo": 0.9, "samples": 300000}),
                   ("field", HG | {"view_angles": [0.1, 0.2], "fields": 4, "method": "paths", "paths_per_field": 100000}),
                   ("image", IMAGE)],
    "mc/invariants/path_power": [("validate", SLAB | {"samples": 300000})],
    "transport/invariants/power": [("validate", SLAB | {"samples": 20000})],
    "index_mismatch": [("trace", RAYS)],
}


class Invariants(ProgramTest):
    def check(self, name):
        with h5py.File(self.folder / "x.h5") as file:
            path = name if "/" in name else f"invariants/{name}"
            self.assertTrue((file[path][()] <= file[path + "_limit"][()]).all(), path)
            self.assertTrue(file.attrs["converged"])

    def test_each_result_has_its_own(self):
        for name, runs in RUNS.items():
            for subcommand, keys in runs:
                with self.subTest(subcommand, **keys):
                    done = self.call(subcommand, **keys, threads=1, out="x.h5")
                    self.assertRegex(done.stdout, r"invariants/\w+: off by ")
                    self.check(name)
                    (self.folder / "x.h5").unlink()

    def test_a_failing_one_says_that_nothing_has_converged(self):
        """Steps too long for the field violate |v| = n."""
        coarse = RAYS | {"integrator": "leapfrog", "step": 1.5}
        done = self.call("trace", **coarse, out="x.h5", status=3)
        self.assertIn("invariants/index_mismatch: off by ", done.stdout)
        self.assertIn("has not converged", done.stdout)
        with h5py.File(self.folder / "x.h5") as file:
            self.assertFalse(file.attrs["converged"])
        self.call("sweep", "--vary", "step=0.01,1.5", of="trace", **(coarse | {"step": None}), out="y.h5", status=3)
        with h5py.File(self.folder / "y.h5") as file:
            off, limit = file["invariants/index_mismatch"][()], file["invariants/index_mismatch_limit"][()]
            self.assertEqual((off > limit).any(axis=1).tolist(), [False, True])
            self.assertFalse(file.attrs["converged"])


if __name__ == "__main__":
    unittest.main()
