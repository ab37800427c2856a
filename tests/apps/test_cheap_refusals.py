"""Bad input in expensive scenes: rejected within 0.3 CPU seconds (ProgramTest.call) by one line that
names the key, and nothing is written."""

import unittest

import h5py
import numpy as np

from program import CYLINDERS, WHOLE, flags
from refusing import RefusingTest

# Cylinders hundreds of wavelengths wide: their T-matrix takes seconds.
WIDE = {"domain": "slab", "depth": 5000, "scatterer": "tm", "radius": 300, "index": 1.33,
        "density": 1e-7}
DISKS = {"width": 400, "depth": 400, "scatterer": "tm", "radius": 0.2, "index": 1.5,
         "density": 0.8, "view_angles": [0.1, 3]}
FLUID = {"width": 60, "depth": 60, "scatterer": "tm", "radius": 0.3, "index": 1.5, "density": 1.6,
         "structure": "hard_disks"}
MANY = {"depth": 100, "optical_depth": list(range(1, 101)), "g": [0.1, 0.3, 0.5, 0.7, 0.9],
        "albedo": [0.9, 0.95, 0.99, 1], "tilts": [0, 0.001]}
WIDE_SWEEP = {"depth": 5000, "scatterer": "tm", "radius": [300, 200], "index": [1.33, 1.4],
              "density": 1e-7, "tilts": [0, 1e-5]}
RENDER = {"stage_box": [-1, -1, 0, 1, 1, 4], "beam_light": [0, 0, 0, 0, 0, 1, 0.1, 1], "mu_s": 50,
          "sensor": "area", "sensor_at": [0, 0, 4], "sensor_size": [2, 2], "pixels": [500, 500]}
LENS = {**RENDER, "field": "luneburg", "centre": [0, 0, 2], "body_sphere": [0, 0, 2, 0.9],
        "radius": 0.9}
RAYS = {"field": "fisheye", "ray_count": 1_000_000, "max_length": 100}
CURVES = {"field": "fisheye", "connect": [0.5, 0, 0, -0.4, 0.1, 0], "trials": 1_000_000,
          "max_length": 100}
FLUID_PLACED = {"width": 400, "depth": 400, "radii": [0.4], "packing_fraction": 0.6,
                "placement": "equilibrium", "structure": "s.h5", "realizations": 1000}
GRIDS = {"width": 100, "depth": 100, "count": 5000, "map": [-50, 50, 0, 100]}

# subcommand, scene, changed keys, words of the message
CASES = [
    ("covariance", WIDE, {"out": None}, ["out is not given"]),
    ("covariance", WIDE, {"out": "none/new.h5"}, ["none/new.h5"]),
    ("covariance", WIDE, {"samples": 0}, ["samples = 0", "positive"]),
    ("covariance", WIDE, {"target_error": 2}, ["target_error = 2"]),
    ("covariance", WIDE, {"tilts": [0, 0.1]}, ["tilts", "memory_effect"]),
    ("covariance", WIDE, {"g": 0.5}, ["g = 0.5", "hg"]),
    ("covariance", WIDE, {"light_angles": [2]}, ["light_angles = 2"]),
    ("covariance", WIDE, {"covariance": "full", "view_angles": [0, 0.1]},
     ["covariance", "slab"]),
    ("covariance", WIDE, {"near_sensors": "points.csv"}, ["near_sensors", "outside of the slab"]),
    ("covariance", WIDE, {"gradient": True, "delays": [0.1]}, ["gradient, delays"]),
    ("covariance", WIDE, {"method": "wave"}, ["domain = slab", "box"]),
    ("covariance", FLUID, {"samples": -1}, ["samples = -1"]),
    ("covariance", FLUID, {"structure": "none.h5"}, ["structure", "none.h5"]),
    ("covariance", FLUID, {"density": 4}, ["packing"]),
    ("covariance", DISKS, {"method": "wave", "wave_tolerance": 0}, ["wave_tolerance = 0"]),
    ("flux", WIDE, {"out": None}, ["out is not given"]),
    ("flux", WIDE, {"light_angles": [2]}, ["light_angles = 2"]),
    ("flux", WIDE, {"angle_bins": 0}, ["angle_bins = 0"]),
    ("field", DISKS, {"out": None}, ["out is not given"]),
    ("field", DISKS, {"fields": 10**12}, ["fields = 1000000000000", "GB"]),
    ("field", {**DISKS, **WIDE, "width": None}, {}, ["domain = slab", "box"]),
    ("field", DISKS, {"tilts": [0, 0.1], "light_angles": [0, 1]}, ["tilts", "light_angles"]),
    ("solve", DISKS, {"out": None}, ["out is not given"]),
    ("solve", DISKS, {"tolerance": 0}, ["tolerance = 0"]),
    ("solve", DISKS, {"map": [1, 0, 0, 1]}, ["map = 1 0 0 1"]),
    ("solve", GRIDS, {"map_pixels": [0, 10]}, ["map_pixels = 0 10"]),
    ("solve", DISKS, {"near_sensors": "header.csv"}, ["header.csv", "at least one"]),
    ("solve", {}, {"placement": "overlap.csv", "scatterer": "tm"}, ["placement", "1 and 2"]),
    ("solve", {}, {"placement": "disk.csv", "scatterer": "tm", "near_sensors": "inside.csv"},
     ["near_sensors = (1.2", "outside"]),
    ("validate", DISKS, {"out": None}, ["out is not given"]),
    ("validate", DISKS, {"near_sensors": "points.csv"}, ["near_sensors", "view_angles"]),
    ("validate", {**CYLINDERS, "index": 1.5}, {"near_sensors": "covered.csv"},
     ["near_sensors = (0, 5)", "a cylinder may cover it"]),
    ("validate", WIDE, {}, ["an infinite slab"]),
    ("validate", FLUID, {"wave_samples": 0}, ["wave_samples = 0"]),
    ("sweep", MANY, {"out": None}, ["out is not given"]),
    ("sweep", MANY, {"albedo": [1, 0]}, ["albedo", "does not scatter"]),
    ("sweep", MANY, {"g": [0.5, 0.5]}, ["g=0.5", "twice"]),
    ("sweep", MANY, {"shard": "3/3"}, ["shard = 3/3"]),
    ("sweep", MANY, {"view_angles": [0, 3]}, ["view_angles"]),
    ("sweep", WIDE_SWEEP, {"samples": 0}, ["samples = 0"]),
    ("sweep", WIDE_SWEEP, {"view_angles": [0, 3]}, ["view_angles"]),
    ("sweep", WIDE_SWEEP, {"radius": [300, -1]}, ["radius = -1"]),
    ("sweep", WIDE_SWEEP, {"target_error": 0}, ["target_error = 0"]),
    ("sweep", WIDE_SWEEP, {"tilts": None}, ["tilts"]),
    ("place", FLUID_PLACED, {"out": None}, ["out is not given"]),
    ("place", FLUID_PLACED, {"structure": "points.csv"}, ["points.csv", "no result"]),
    ("place", FLUID_PLACED, {"fractions": [1, 2]}, ["fractions: has 2"]),
    ("place", FLUID_PLACED, {"packing_fraction": 0.72}, ["packing fraction", "0.69"]),
    ("trace", RAYS, {"out": None}, ["out is not given"]),
    ("trace", RAYS, {"stop_sphere": [0, 0, 1, -1]}, ["stop_sphere, radius = -1"]),
    ("trace", RAYS, {"path_points": 100_000}, ["ray_count = 1000000", "memory"]),
    ("trace", CURVES, {"connect": [1, 2, 3, 1, 2, 3]}, ["connect", "different"]),
    ("trace", CURVES, {"ray_count": 3}, ["ray_count", "light of rays"]),
    ("render", RENDER, {"out": None}, ["out is not given"]),
    ("render", RENDER, {"samples": 0}, ["samples = 0"]),
    ("render", RENDER, {"path_bins": [2, 1, 5]}, ["path_bins = 2 1 5"]),
    ("render", RENDER, {"sensor_at": [0, 0, 3]}, ["sensor_at = 0 0 3", "boundary"]),
    ("render", RENDER, {"density": "thin.h5"}, ["density: thin.h5"]),
    ("render", RENDER, {"mu_s": 1e7}, ["mu_s = 1e+07", "too dense"]),
    ("render", LENS, {"focus_distance": 3}, ["focus_distance", "is a key of"]),
    ("render", LENS, {"index": 1.5}, ["index"]),
    ("merge", {}, {"shards": "none"}, ["shards = none"]),
    ("merge", {}, {"out": None}, ["out is not given"]),
]
FILES = {"points.csv": "x,z\n0,450\n", "covered.csv": "x,z\n0,5\n", "header.csv": "x,z\n",
         "inside.csv": "x,z\n1.2,2\n", "disk.csv": "x,z,radius\n1,2,0.5\n",
         "overlap.csv": "x,z,radius\n1,2,0.5\n1.5,2,0.5\n"}


class Cheap(RefusingTest):
    def setUp(self):
        super().setUp()
        for name, text in FILES.items():
            self.write(name, text)
        with h5py.File(self.folder / "thin.h5", "w") as file:
            data = file.create_dataset("density", data=np.ones((5, 5, 1)))
            data.attrs["origin"], data.attrs["spacing"] = np.zeros(3), np.ones(3)

    def test_each(self):
        for subcommand, scene, changes, words in CASES if WHOLE else CASES[::2]:
            with self.subTest(subcommand=subcommand, changes=changes):
                keys = {"out": "new.h5", **scene, **changes}
                self.assert_refused(words, subcommand, *flags({**keys, "out": None}),
                                    out=keys["out"])


if __name__ == "__main__":
    unittest.main()
