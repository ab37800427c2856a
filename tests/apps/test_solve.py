"""Exact fields by the command line."""

import resource
import signal
import subprocess
import unittest

import h5py
import numpy as np

from program import BOX, CYLINDERS, DATA, PROGRAM, ProgramTest, attributes, datasets, flags

DISKS = {"placement": DATA / "reference/g2/placement.csv", "scatterer": "te", "index": "1.5+0.1i"}


def table(name):
    return np.genfromtxt(DATA / "reference/g2" / name, delimiter=",", names=True)


def relative_distance(found, expected):
    return np.linalg.norm(found - expected) / np.linalg.norm(expected)


class Reference(ProgramTest):
    def test_far_field(self):
        rows = table("farfield_TE15abs.csv")
        lights, views = np.unique(rows["light_angle"]), np.unique(rows["view_angle"])
        self.call("solve", **DISKS, light_angles=list(map(repr, lights.tolist())),
                  view_angles=list(map(repr, views.tolist())), out="far.h5")
        field = datasets(self.folder / "far.h5")["far_field"]
        found = field[np.searchsorted(lights, rows["light_angle"]),
                      np.searchsorted(views, rows["view_angle"])]
        self.assertGreater(len(rows), 50)
        self.assertLess(relative_distance(found, rows["re"] + 1j * rows["im"]), 1e-10)

    def test_near_field(self):
        rows = table("nearfield_TE15abs.csv")
        self.assertGreater(len(rows), 10)
        for light in np.unique(rows["light_angle"]):
            seen = rows[rows["light_angle"] == light]
            lines = [f"{x!r},{z!r}\n" for x, z in zip(seen["x"].tolist(), seen["z"].tolist())]
            self.write("sensors.csv", "x,z\n" + "".join(lines))
            self.call("solve", **DISKS, light_angles=[light], near_sensors="sensors.csv",
                      out="near.h5")
            found = datasets(self.folder / "near.h5")["near_field"][0]
            self.assertLess(relative_distance(found, seen["re"] + 1j * seen["im"]), 1e-10)

    def test_the_file_is_told_back(self):
        self.call("solve", **DISKS, out="result.h5")
        stored, rows = datasets(self.folder / "result.h5"), table("placement.csv")
        for column in ("x", "z", "radius"):
            np.testing.assert_array_equal(stored[f"placement/{column}"], rows[column])

    def test_the_stored_configuration_runs_again(self):
        self.call("solve", **DISKS, view_angles=[0, 1], out="first.h5")
        self.write("stored.toml", attributes(self.folder / "first.h5")["config"])
        self.call("solve", config="stored.toml", out="second.h5")
        first, second = (datasets(self.folder / name) for name in ("first.h5", "second.h5"))
        np.testing.assert_array_equal(first["far_field"], second["far_field"])

    def test_order_of_rows_and_spelling_do_not_matter(self):
        self.write("a.csv", "x,z,radius\n0,0,0.3\n1,2,0.2\n")
        self.write("b.csv", "# two disks\r\nradius , z , x\r\n\r\n+2e-1, 2.0, 1\r\n.3,0,0\r\n")
        for name in "ab":
            self.call("solve", scatterer="soft", placement=f"{name}.csv", out=f"{name}.h5")
        a, b = (datasets(self.folder / f"{name}.h5")["far_field"] for name in "ab")
        self.assertLess(relative_distance(b, a), 1e-13)

    def test_index_by_column(self):
        self.write("by_key.csv", "x,z,radius\n0,0,0.3\n1,2,0.2\n")
        self.write("by_column.csv",
                   "x,z,radius,index_re,index_im\n0,0,0.3,1.5,.1\n1,2,0.2,1.5,.1\n")
        self.call("solve", scatterer="tm", placement="by_key.csv", index="1.5+0.1i", out="a.h5")
        self.call("solve", scatterer="tm", placement="by_column.csv", out="b.h5")
        self.assert_same_data("a.h5", "b.h5")


class Believed(ProgramTest):
    def test_resonance_sharper_than_double_precision(self):
        """TM, index 2, k radius = 9.335788: order 15 has a resonance of Q = 4e4."""
        self.write("disk.csv", "x,z\n0,0\n")
        disk = {"placement": "disk.csv", "scatterer": "tm", "index": 2,
                "radius": repr(9.335788 / (2 * np.pi)), "view_angles": [0, 1]}
        done = self.call("solve", **disk, status=3, out="sharp.h5")
        self.assertRegex(done.stdout, r"invariants/rounding: off by \S+, at most 1e-12 allowed: FAILS")
        self.assertFalse(attributes(self.folder / "sharp.h5")["converged"])
        self.call("solve", **disk, tolerance=1e-9, out="rough.h5")
        self.call("solve", **disk, wavelengths=[1, 1.1], status=3, out="spectrum.h5")

    def test_narrow_gap_of_metals_is_refused(self):
        self.write("pair.csv", "x,z\n0,0\n0,0.2000001\n")
        done = self.call("solve", placement="pair.csv", scatterer="te", index="0.05+2.2i",
                         radius=0.1, status=2, out="pair.h5")
        self.assertIn("next to a TE disk with Re(index^2) < 0", done.stderr)

    def test_notes(self):
        self.write("disk.csv", "x,z\n0,0\n")
        thin = {"placement": "disk.csv", "scatterer": "te", "radius": 0.3}
        self.assertIn("n - 1", self.call("solve", **thin, index=0.5, out="thin.h5").stderr)
        self.assertNotIn("n - 1", self.call("solve", **thin, index=1.5, out="thick.h5").stderr)


class Few(ProgramTest):
    def test_no_scatterers(self):
        self.write("none.csv", "x,z\n")
        self.write("sensors.csv", "x,z\n1,2\n")
        for keys in ({"placement": "none.csv"}, {**BOX, "count": 0},
                     {"placement": "none.csv", "near_sensors": "sensors.csv"}):
            with self.subTest(keys=keys):
                done = self.call("solve", **keys, light_angles=[0, 1], out="result.h5")
                self.assertIn("0 scatterers", done.stdout)
                self.assertIn("contains no scatterers", done.stderr)
                field = datasets(self.folder / "result.h5")
                field = field.get("far_field", field.get("near_field"))
                np.testing.assert_array_equal(field, [[0], [0]])

    def test_one_point(self):
        """A resonant point at the origin has the same amplitude everywhere."""
        self.write("one.csv", "x,z\n0,0\n")
        self.call("solve", placement="one.csv", view_angles=[0, 1, 2], out="result.h5")
        field = datasets(self.folder / "result.h5")["far_field"][0]
        np.testing.assert_allclose(field, field[0], rtol=1e-14)
        sigma_s = 2 / np.pi  # 4/k at k = 2 pi
        self.assertAlmostEqual(2 * np.pi * abs(field[0]) ** 2, sigma_s, places=12)


class Drawn(ProgramTest):
    def test_by_seed(self):
        for name, seed in (("a", 5), ("b", 5), ("c", 6)):
            self.call("solve", **CYLINDERS, min_gap=0.1, seed=seed, out=f"{name}.h5")
        self.assert_same_data("a.h5", "b.h5")
        a, c = (datasets(self.folder / f"{name}.h5")["placement/x"] for name in "ac")
        self.assertFalse(np.any(a == c))

    def test_disks_lie_in_the_box_and_apart(self):
        self.call("solve", **CYLINDERS, min_gap=0.1, out="result.h5")
        stored = datasets(self.folder / "result.h5")
        x, z = stored["placement/x"], stored["placement/z"]
        self.assertLessEqual(np.abs(x).max(), 10)
        self.assertTrue(0 <= z.min() and z.max() <= 10)
        gaps = np.hypot(x[:, None] - x, z[:, None] - z) + 10 * np.eye(len(x)) - 2 * 0.16
        self.assertGreaterEqual(gaps.min(), 0.1)
        self.assertEqual(len(x), CYLINDERS["count"])

    def test_a_drawn_placement_as_a_file(self):
        self.call("solve", **CYLINDERS, view_angles=[0, 1], out="drawn.h5")
        drawn = datasets(self.folder / "drawn.h5")
        rows = zip(drawn["placement/x"].tolist(), drawn["placement/z"].tolist())
        self.write("drawn.csv", "x,z\n" + "".join(f"{x!r},{z!r}\n" for x, z in rows))
        self.call("solve", scatterer="tm", radius=0.16, placement="drawn.csv", view_angles=[0, 1],
                  out="read.h5")
        np.testing.assert_array_equal(drawn["far_field"],
                                      datasets(self.folder / "read.h5")["far_field"])


class Solvers(ProgramTest):
    """Solvers agree for weakly scattering points, for which the iterative one converges."""

    POINTS = {"domain": "box", "width": 20, "depth": 20, "scatterer": "point", "phase_shift": 0.2,
              "count": 1200, "tolerance": 1e-9, "light_angles": [0, 0.3], "view_angles": [0.1, 3]}

    def test_agree(self):
        for solver in ("dense", "fast", "krylov"):
            self.call("solve", **self.POINTS, solver=solver, out=f"{solver}.h5")
            result = datasets(self.folder / f"{solver}.h5")
            self.assertLess(result["solve/residual"], 1e-9)
            if solver == "dense":
                exact = result["far_field"]
                self.assertGreater(result["solve/condition"], 1)
            self.assertLess(relative_distance(result["far_field"], exact), 1e-8)
        self.assertIn("skeletonization", attributes(self.folder / "fast.h5")["plan"])
        self.assertIn("GMRES", attributes(self.folder / "krylov.h5")["plan"])


class FullDisk(ProgramTest):
    """Full disks, simulated by a limit on the size of files."""

    def call_with_little_room(self, *words, **keys):
        def little_room():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))

        return subprocess.run([PROGRAM, *words, *flags(keys)], cwd=self.folder, text=True,
                              capture_output=True, preexec_fn=little_room, restore_signals=False,
                              timeout=60)

    def test_status_4_and_the_older_result_stays(self):
        self.write_older_result("result.h5")
        before = self.listing()
        for command, keys in (("solve", BOX), ("covariance", {**BOX, "samples": 3000})):
            with self.subTest(command=command):
                done = self.call_with_little_room(command, **keys, out="result.h5")
                self.assertEqual(done.returncode, 4, done.stderr)
                self.assertRegex(done.stderr, r"(^|\n)flatspeckle: writing result.h5 failed: .+\n$")
                self.assertEqual(self.listing(), before)


class Result(ProgramTest):
    def test_provenance(self):
        self.call("solve", **DISKS, out="result.h5")
        stored = attributes(self.folder / "result.h5")
        self.assertEqual(stored["converged"], 1)
        with h5py.File(self.folder / "result.h5") as file:
            self.assertLess(file["solve/residual"][()], 1e-12)
            self.assertGreaterEqual(file["solve/condition"][()], 1)
        self.assertNotIn("density", stored)


if __name__ == "__main__":
    unittest.main()
