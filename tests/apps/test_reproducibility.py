"""Equal scene, seed and samples give the same numbers for any number of threads."""

import unittest

from program import BOX, CYLINDERS, SLAB, TILTS, ProgramTest, datasets

REQUESTS = {
    "intensity": {"view_angles": [0.1, 3.0]},
    "full": {"covariance": "full", "view_angles": [0.1, 0.5, 3.0]},
    "pairs": {"covariance": "pairs", "pairs": [0, 0.1, 0.04, 0.14]},
    "memory_effect": TILTS,
}
SWEEP = {"depth": 100, "optical_depth": [1, 3], "g": [0, 0.5], "tilts": [0, 0.001], "samples": 9000}


class Threads(ProgramTest):
    def check_threads(self, subcommand, **keys):
        for threads in (1, 4):
            self.call(subcommand, **keys, threads=threads, out=f"{threads}.h5")
        self.assert_same_data("1.h5", "4.h5")

    def test_mc(self):
        for name, request in REQUESTS.items():
            for scene in (BOX, CYLINDERS):
                with self.subTest(request=name, scene=scene):
                    self.check_threads("covariance", **scene, **request, samples=9000)

    def test_slab(self):
        self.check_threads("covariance", **SLAB, **TILTS, samples=9000)

    def test_wave(self):
        for name, request in REQUESTS.items():
            with self.subTest(request=name):
                self.check_threads("covariance", **BOX, **request, samples=13, method="wave")

    def test_target_error(self):
        self.check_threads("covariance", **BOX, **TILTS, target_error=0.03)

    def test_sweep_and_validate(self):
        self.check_threads("sweep", **SWEEP)
        self.check_threads("validate", **BOX, **TILTS, samples=9000, wave_samples=13)


class Seed(ProgramTest):
    def check_seed(self, name, subcommand, **keys):
        for seed in (1, 2):
            self.call(subcommand, **keys, seed=seed, out=f"{seed}.h5")
        first, second = (datasets(self.folder / f"{seed}.h5")[name] for seed in (1, 2))
        self.assertEqual(first.shape, second.shape)
        self.assertTrue((first != second).all())
        self.call(subcommand, **keys, out="default.h5")
        self.assert_same_data("1.h5", "default.h5")

    def test_seed(self):
        views = {"view_angles": [0.5, 1]}
        self.check_seed("intensity", "covariance", **BOX, **views, samples=4000)
        self.check_seed("intensity", "covariance", **BOX, **views, samples=9, method="wave")
        self.check_seed("far_field", "solve", **BOX, **views)
        self.check_seed("far_field", "solve", **CYLINDERS, **views)
        self.check_seed("field_correlation_error", "sweep", **{**SWEEP, "tilts": [0.001]})


class PrintedConfiguration(ProgramTest):
    FILES = {"a 'b' = [1, 2] #c.csv": "x,z\n0,15\n", "it's.csv": "x,z,radius\n0,0,0.1\n"}

    def setUp(self):
        super().setUp()
        for name, text in self.FILES.items():
            self.write(name, text)

    SCENES = [
        ("covariance", {**BOX, **TILTS, "samples": 5, "resume": True}),
        ("covariance", {**CYLINDERS, "index": "1.5+0.1i", "light_angles": [-0.1],
                        "near_sensors": "a 'b' = [1, 2] #c.csv"}),
        ("covariance", {**BOX, **REQUESTS["pairs"], "seconds": "1e1", "threads": 2}),
        ("validate", {**BOX, "wave_samples": 7}),
        ("sweep", {**SWEEP, "optical_depth": [2]}),
        ("solve", {**BOX, "tolerance": 1e-9}),
        ("solve", {"scatterer": "te", "placement": "it's.csv"}),
    ]

    def test_round_trip(self):
        for subcommand, keys in self.SCENES:
            with self.subTest(subcommand=subcommand, keys=keys):
                printed = self.call(subcommand, "--print-config", **keys).stdout
                self.write("scene.toml", printed)
                again = self.call(subcommand, "--print-config", config="scene.toml").stdout
                self.assertEqual(printed, again)
                for key in keys:
                    self.assertIn(f"{key} = ", printed)
        self.assertEqual(set(self.listing()), {"scene.toml", *self.FILES})

    def test_is_toml(self):
        try:
            import tomllib
        except ModuleNotFoundError:
            self.skipTest("tomllib comes with Python 3.11")
        for subcommand, keys in self.SCENES:
            read = tomllib.loads(self.call(subcommand, "--print-config", **keys).stdout)
            for key, value in keys.items():
                self.assertEqual(read[key], 10 if value == "1e1" else value)

    def test_the_same_number_in_other_words(self):
        disks = {**CYLINDERS, "method": "wave"}
        plain = self.call("covariance", "--print-config", **disks, min_gap=0.001).stdout
        for width, gap in (("20.0", "1e-3"), ("2e1", "0.0010"), ("2.0E+1", "1.e-03")):
            with self.subTest(width=width):
                keys = {**disks, "width": width, "min_gap": gap}
                self.assertEqual(self.call("covariance", "--print-config", **keys).stdout, plain)

    def test_numbers_as_people_write_them(self):
        keys = {**BOX, "covariance": "memory_effect"}
        plain = self.call("covariance", "--print-config", light_angles=-0.7853981633974483,
                          view_angles=[-0.1, 2.941592653589793], tilts=[0, 0.001, 0.01, 0.1],
                          **keys).stdout
        self.write("written.toml", 'tilts = ["0", "1e-3:0.1:3:log"]\nview_angles = "-.1, pi - 0.2"\n')
        written = self.call("covariance", "--print-config", "--light_angles", "-pi/4",
                            config="written.toml", **keys).stdout
        self.assertEqual(written, plain)


if __name__ == "__main__":
    unittest.main()
