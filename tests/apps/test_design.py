"""Index fields from what their light should do."""

import h5py
import numpy as np

from program import attributes, datasets
from refusing import RefusingTest

SMALL = {"nodes": [5], "directions": 12, "rays_per_direction": 20}
TRACED = {"light": "disk", "origin": [0, 0, -1.2], "beam_radius": 0.9, "ray_count": 30,
          "stop_plane": [0, 0, 1.00001, 0, 0, 1], "max_length": 6}


class Design(RefusingTest):
    def design(self, out, status=0, **keys):
        done = self.call("design", out=out, status=status, **keys)
        return done.stdout, datasets(self.folder / out)

    def test_ball_that_trace_reads(self):
        said, found = self.design("lens.h5", **SMALL)
        self.assertIn("held-out rays miss by", said)
        self.assertEqual(found["ball_spline"].shape, (7, 7, 7))
        self.assertLess(found["rms/seen"], 2e-3)
        self.assertLess(found["profile/spread"].max(), 5e-3)
        r, index = found["profile/r"], found["profile/index"]
        np.testing.assert_allclose(index, np.sqrt(2 - r**2), atol=5e-3)
        self.assertLess(np.diff(found["history/rms"]).max(), 1e-12)
        self.call("trace", field="ball", ball_spline="lens.h5", out="rays.h5", **TRACED)
        rays = datasets(self.folder / "rays.h5")
        self.assertTrue((rays["status"] == 0).all())
        self.assertLess(np.hypot(rays["exit/x"], rays["exit/y"]).max(), 2e-2)

    def test_radial_that_trace_reads(self):
        self.design("lens.h5", design="radial", directions=1, rays_per_direction=100)
        self.call("trace", field="radial", radial_spline="lens.h5", out="rays.h5", **TRACED)
        rays = datasets(self.folder / "rays.h5")
        self.assertLess(np.hypot(rays["exit/x"], rays["exit/y"]).max(), 1e-4)
        self.assertLess(rays["invariants/angular_momentum_change"].max(), 1e-8)

    def test_threads_do_not_matter(self):
        for threads in (1, 2, 4):
            self.design(f"{threads}.h5", threads=threads, **SMALL)
        for threads in (2, 4):
            self.assert_same_data("1.h5", f"{threads}.h5")

    def test_target_that_is_not_reached(self):
        _, found = self.design("lens.h5", status=3, target=1e-9, **SMALL)
        self.assertGreater(found["rms/seen"], 1e-9)
        self.assertFalse(attributes(self.folder / "lens.h5")["converged"])
        self.design("one.h5", status=3, target=1e-9, iterations=1, **SMALL)

    def test_bad_input(self):
        for words, keys in [
                (["nodes = 8", "must be 9"], {"nodes": [5, 8]}),
                (["nodes", "from 2"], {"nodes": [1]}),
                (["start_excess = 3", "bounds"], {"start_excess": 3}),
                (["least_index", "at most 1"], {"least_index": 1.2}),
                (["least_index", "positive"], {"least_index": 0}),
                (["most_index", "at least 1"], {"most_index": 0.9}),
                (["directions"], {"directions": 0}),
                (["rays_per_direction"], {"rays_per_direction": 0}),
                (["step = 2", "radius"], {"step": 2}),
                (["aperture"], {"aperture": 1.5}),
                (["coefficients"], {"coefficients": 9}),
                (["nodes"], {"design": "radial", "nodes": [5, 9]}),
                (["design = lens", "ball radial"], {"design": "lens"})]:
            with self.subTest(keys=keys):
                self.assert_refused(words, "design", **keys)

    def test_bad_fields(self):
        with h5py.File(self.folder / "bad.h5", "w") as file:
            file["ball_spline"] = np.full((5, 5, 5), -2.0)
            file["ball_spline"].attrs["origin"] = [-2.0, -2.0, -2.0]
            file["ball_spline"].attrs["spacing"] = [1.0, 1.0, 1.0]
            file["radial_spline"] = np.zeros(3)
            file["radial_spline"].attrs["centre"] = [0.0, 0.0, 0.0]
            file["radial_spline"].attrs["radius"] = 1.0
        for kind in ("ball", "radial"):
            self.assert_refused([kind, "bad.h5"], "trace", field=kind, max_length=1, **{kind + "_spline": "bad.h5"})
            self.assert_refused([kind, "not given"], "trace", field=kind, max_length=1)


if __name__ == "__main__":
    import unittest
    unittest.main()
