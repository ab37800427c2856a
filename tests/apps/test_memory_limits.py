"""Runs under `ulimit -v`: each succeeds or ends soon with one line."""

import resource
import subprocess
import unittest

from program import BOX, DATA, PROGRAM, ProgramTest, cpu_of_children, flags

STEPS = 20
MEGABYTES = [round(200 * 10 ** (step / (STEPS - 1))) for step in range(STEPS)]  # to 2 GB
VIEWS = {"light_angles": [-0.1, 0, 0.1, 0.2], "view_angles": [0.1, 0.2, 0.5, 3]}
POINTS = {"scatterer": "point", "placement": "poisson"}
RUNS = {
    "solve dense": ("solve", {**POINTS, **VIEWS, "width": 14, "depth": 14, "count": 3000}),
    "solve fast": ("solve", {**POINTS, **VIEWS, "width": 22, "depth": 22, "count": 5000,
                             "solver": "fast", "tolerance": 1e-6}),
    "solve krylov": ("solve", {**POINTS, "width": 20, "depth": 20, "count": 800,
                               "phase_shift": 0.2, "solver": "krylov", "tolerance": 1e-3}),
    "solve map": ("solve", {"config": DATA / "scenes/hundred_disks.toml",
                            "map_pixels": [100, 110]}),
    "covariance full": ("covariance", {**BOX, **VIEWS, "covariance": "full", "samples": 10000}),
    "covariance full wave": ("covariance", {**VIEWS, "method": "wave", "covariance": "full",
                                            "width": 20, "depth": 20, "count": 1500,
                                            "samples": 4}),
    "validate": ("validate", {**BOX, **VIEWS, "samples": 10000, "wave_samples": 40}),
    "field": ("field", {**BOX, **VIEWS, "fields": 20}),
}


class MemoryLimits(ProgramTest):
    def test_each_runs_or_ends_in_one_line(self):
        for name, (command, keys) in RUNS.items():
            done = {mb: self.run_within(name, command, keys, mb) for mb in MEGABYTES}
            self.assertEqual(done[MEGABYTES[-1]], 0, name)
            self.close_in(name, command, keys, done)

    def close_in(self, name, command, keys, done):
        """Bisects to the least memory that suffices and runs near it, where libraries get almost what they need."""
        low = max((mb for mb, status in done.items() if status != 0), default=MEGABYTES[0] // 2)
        high = min(mb for mb, status in done.items() if status == 0 and mb > low)
        while high - low > 1:
            middle = (low + high) // 2
            refused = self.run_within(name, command, keys, middle) != 0
            low, high = (middle, high) if refused else (low, middle)
        for quarter in range(1, 12):
            self.run_within(name, command, keys, low - 1 + quarter / 4)

    def run_within(self, name, command, keys, megabytes):
        limit = int(megabytes * 2 ** 20)
        before = cpu_of_children()
        with self.subTest(run=name, megabytes=megabytes):
            done = subprocess.run(
                [PROGRAM, command, *flags({**keys, "threads": 2, "out": "x.h5"})],
                cwd=self.folder, capture_output=True, text=True, timeout=120,
                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
            self.assertIn(done.returncode, (0, 2), done.stderr)
            if done.returncode == 2:
                errors = [line for line in done.stderr.splitlines() if "flatspeckle: " in line]
                self.assertEqual(len(errors), 1, done.stderr)
                self.assertLess(cpu_of_children() - before, 5, done.stderr)
                self.assertEqual(list(self.folder.iterdir()), [])
            (self.folder / "x.h5").unlink(missing_ok=True)
            return done.returncode
        return None


if __name__ == "__main__":
    unittest.main()
