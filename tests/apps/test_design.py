"""Index fields designed for given targets of their rays."""

import signal
import time

import h5py
import numpy as np

from program import DATA, attributes, datasets, user_seconds, user_seconds_of_children
from refusing import RefusingTest

FIBRE = {"design": "guide", "goal": "equal_path", "index": 1.47, "delta": 0.01, "radius": 25, "coefficients": 0,
         "ray_count": 60}
PICTURE = {"design": "box", "nodes": [11], "goal": "irradiance", "rays_across": 16, "roughness": 1e-4}
SMALL = {"nodes": [5], "directions": 12, "rays_per_direction": 20}
TRACED = {"light": "disk", "origin": [0, 0, -1.2], "beam_radius": 0.9, "ray_count": 30,
          "stop_plane": [0, 0, 1.00001, 0, 0, 1], "max_length": 6}


def views(count, across):
    """Returns parallel rays in `count` directions in the plane y = 0."""
    rows = ["x,y,z,dx,dy,dz"]
    places = 1.2 * ((np.arange(across) + 0.5) / across - 0.5) * 2
    for angle in np.pi * np.arange(count) / count:
        along, right = np.array([np.sin(angle), 0, np.cos(angle)]), np.array([np.cos(angle), 0, -np.sin(angle)])
        for u in places:
            for v in places:
                x = u * right + np.array([0, v, 0]) - 1.9 * along
                rows.append(",".join(f"{value:.9g}" for value in (*x, *along)))
    return "\n".join(rows) + "\n"


class Design(RefusingTest):
    def design(self, out, status=0, **keys):
        done = self.call("design", out=out, status=status, **keys)
        return done.stdout, datasets(self.folder / out)

    def test_ball_that_trace_reads(self):
        said, found = self.design("lens.h5", **SMALL)
        self.assertIn("held-out rays miss their targets by", said)
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

    def test_fibre_that_trace_reads(self):
        """Finds the exponent of least dispersion, checked by rays of trace over many periods."""
        self.design("fibre.h5", **FIBRE)
        law = {"index": 1.47, "delta": 0.01, "core_radius": 25}
        for name, field in (("parabola", law), ("found", {"graded_spline": "fibre.h5"})):
            self.call("trace", field="graded", **field, light="fan", origin=[0, 0, 0], half_angle=0.14, ray_count=25,
                      stop_plane=[0, 0, 1e5, 0, 0, 1], max_length=2e5, tolerance=1e-9, out=name + ".h5")
        spread = [np.ptp(datasets(self.folder / f"{name}.h5")["optical_path"]) for name in ("parabola", "found")]
        self.assertLess(spread[1], 0.6 * spread[0])

    def test_box_that_trace_reads(self):
        """The stored grid, with margins, is the designed field: rays of trace end where those of the search do."""
        self.write("picture.csv", "\n".join(",".join(str(1 + (i > 3) + j % 3) for i in range(8)) for j in range(8)))
        self.design("box.h5", **PICTURE, pictures="picture.csv")
        found = datasets(self.folder / "box.h5")
        self.assertEqual(found["excess"].shape, (15, 15, 15))
        self.assertLess(found["rms/held_out_half_step"], 0.5 * found["rms/start_held_out"])
        self.call("trace", field="grid", grid="box.h5", light="line", origin=[0, 0, -1], beam_radius=0.5, ray_count=9,
                  max_length=6, out="rays.h5")
        rays = datasets(self.folder / "rays.h5")
        self.assertTrue((rays["status"] == 2).all())
        self.assertGreater(np.abs(rays["exit/dx"]).max(), 1e-4)

    def test_host_index(self):
        """A lens in a host of index 1.33 focuses as one in air whose index is smaller by this factor; trace and export agree."""
        said, found = self.design("lens.h5", **SMALL, index_around=1.33, most_index=4)
        self.assertIn("ended after", said)
        self.assertIn("effective focal length", said)
        r, index = found["profile/r"], found["profile/index"]
        np.testing.assert_allclose(index, 1.33 * np.sqrt(2 - r**2), atol=7e-3)
        self.call("trace", field="ball", ball_spline="lens.h5", out="rays.h5", **TRACED)
        rays = datasets(self.folder / "rays.h5")
        self.assertLess(np.hypot(rays["exit/x"], rays["exit/y"]).max(), 2e-2)
        printed = self.call("export", "lens.h5", "ball_spline", to="lens.npy", nodes=33).stdout
        self.assertIn("grid_values = index", printed)
        n = np.load(self.folder / "lens.npy")
        self.assertAlmostEqual(n[16, 16, 16], index[0], delta=1e-6)
        self.assertAlmostEqual(n[0, 0, 0], 1.33, delta=1e-12)
        self.call("trace", field="grid", grid="lens.npy", grid_values="index", grid_origin=[-1, -1, -1], grid_spacing=[1 / 16] * 3,
                  light="line", ray_count=5, origin=[0, 0, -0.9], beam_radius=0.3, max_length=0.5, out="grid.h5")
        self.assert_refused(["grid_values"], "trace", field="grid", grid="lens.npy", grid_origin=[-1, -1, -1],
                            grid_spacing=[1 / 16] * 3, max_length=0.5)
        self.call("export", "lens.h5", "ball_spline", to="lens.vtk", nodes=9)
        head, body = (self.folder / "lens.vtk").read_bytes().split(b"LOOKUP_TABLE default\n")
        self.assertIn(b"DIMENSIONS 9 9 9", head)
        np.testing.assert_allclose(np.frombuffer(body, ">f8").reshape(9, 9, 9).transpose(2, 1, 0), n[::4, ::4, ::4], atol=1e-14)

    def test_rules_that_end_a_search(self):
        """`tolerance` = 0 makes all iterations; more nodes are never worse; gradients keep their bound."""
        picture = {**PICTURE, "pictures": str(DATA / "pictures" / "hills.csv"), "nodes": [9]}
        said, found = self.design("nine.h5", **picture, tolerance=0, iterations=4)
        self.assertIn("ended after 4 steps by the rule: iterations", said)
        self.assertRegex(said, r"pictures of held-out rays: \d+\.\d+ dB")
        share = found["picture/on_screen"]
        self.assertIn(f"light of held-out rays on the screens: {100 * share[0]:.2f} %", said)
        np.testing.assert_allclose(share, found["picture/shown"].sum(axis=(1, 2)))
        self.assertEqual(attributes(self.folder / "nine.h5")["ended_by"], "iterations")
        _, finer = self.design("more.h5", **picture | {"nodes": [17]}, tolerance=0, iterations=8)
        self.assertLess(finer["rms/seen"], found["rms/seen"])
        self.assertEqual(finer["history/coefficients"][0], 11**3)  # begins at 9 nodes
        free = np.abs(np.diff(found["excess"], axis=0)).max() / 0.25
        _, held = self.design("held.h5", **picture, iterations=4, most_gradient=free / 2)
        spacing = 2 / 8
        slopes = [np.diff(held["excess"], axis=axis)[1:-1, 1:-1, 1:-1] / spacing for axis in range(3)]
        self.assertLess(max(np.abs(slope).max() for slope in slopes), free / 2)
        self.assert_refused(["smallest_feature"], "design", **picture, smallest_feature=0.6)

    def test_pictures_as_files_of_images(self):
        """A picture as NPY gives the field that the same picture as text gives."""
        picture = np.loadtxt(DATA / "pictures" / "hills.csv", delimiter=",")
        np.save(self.folder / "hills.npy", picture)
        keys = {**PICTURE, "nodes": [9], "iterations": 2}
        _, text = self.design("text.h5", **keys, pictures=str(DATA / "pictures" / "hills.csv"))
        _, array = self.design("array.h5", **keys, pictures="hills.npy")
        np.testing.assert_array_equal(array["excess"], text["excess"])

    def test_deflections_of_trace(self):
        """Blobs are recovered from the deflections of rays in four views."""
        self.write("blobs.csv", "x,y,z,height,width\n0.2,0.1,-0.1,0.001,0.3\n-0.3,0,0.2,0.0015,0.25\n")
        self.write("views.csv", views(6, 12) + "0,1,-1.9,0,0,1\n1,0.2,-1.9,0,0,1\n")  # the last two run along faces
        self.call("trace", field="blobs", blobs="blobs.csv", rays="views.csv", stop_box=[-3, -3, -3, 3, 3, 3],
                  max_length=9, out="measured.h5")
        _, found = self.design("found.h5", design="box", nodes=[9], goal="deflections", measured="measured.h5",
                               noise=6e-5)
        shape = found["excess"].shape[0]
        middle = shape // 2
        with h5py.File(self.folder / "found.h5") as file:
            at = dict(file["excess"].attrs)
        x = at["origin"][0] + at["spacing"][0] * np.arange(shape)
        X, Y, Z = np.meshgrid(x, x, x, indexing="ij")
        truth = sum(h * np.exp(-((X - a)**2 + (Y - b)**2 + (Z - c)**2) / (2 * w * w)) for a, b, c, h, w in
                    ((0.2, 0.1, -0.1, 0.001, 0.3), (-0.3, 0, 0.2, 0.0015, 0.25)))
        inside = np.s_[middle - 3:middle + 4, middle - 3:middle + 4, middle - 3:middle + 4]
        error = np.sqrt(np.mean((found["excess"] - truth)[inside]**2) / np.mean(truth[inside]**2))
        self.assertLess(error, 0.1)

    def test_bounds_are_told(self):
        done = self.call("design", out="held.h5", **SMALL, most_index=1.3)
        self.assertIn("are at least_index or most_index", done.stderr)
        self.assertGreater(datasets(self.folder / "held.h5")["at_bounds"], 0)

    def test_coefficients_that_no_ray_sees_are_told(self):
        done = self.call("design", out="narrow.h5", **{**SMALL, "directions": 1, "aperture": 0.2, "nodes": [9]})
        self.assertIn("crossed by no ray", done.stderr)
        self.assertGreater(datasets(self.folder / "narrow.h5")["unseen"], 50)
        done = self.call("design", out="all.h5", **SMALL)
        self.assertNotIn("crossed by no ray", done.stderr)
        self.assertEqual(datasets(self.folder / "all.h5")["unseen"], 0)

    def test_light_of_a_point_leaves_parallel(self):
        """The result agrees with trace."""
        point = {"sources": [0, 0, -1], "half_angle": 0.7, "rays_per_source": 200}
        _, found = self.design("parallel.h5", design="ball", nodes=[5], goal="collimation", **point)
        self.assertLess(found["rms/held_out_half_step"], 2e-3)
        self.call("trace", field="ball", ball_spline="parallel.h5", light="cone", origin=[0, 0, -1], half_angle=0.6,
                  ray_count=20, stop_plane=[0, 0, 2, 0, 0, 1], max_length=9, out="rays.h5")
        rays = datasets(self.folder / "rays.h5")
        self.assertLess(np.hypot(rays["exit/dx"], rays["exit/dy"]).max(), 1e-2)

    def test_light_passes_through_an_aperture(self):
        keys = {"design": "ball", "nodes": [5], "goal": "throughput", "sources": [0, 0, -1.5, 0.4, 0, -1.5],
                "half_angle": 0.3, "aperture_radius": 0.05, "aperture_distance": 2}
        said, found = self.design("through.h5", **keys)
        self.assertGreater(found["throughput"], 0.98)
        self.assertIn("pass through the aperture", said)
        start = self.call("design", out="start.h5", iterations=1, **keys, most_index=1.0001)
        self.assertLess(datasets(self.folder / "start.h5")["throughput"], 0.1)

    def test_resumed(self):
        """A search that is cut off and resumed gives the same bits."""
        keys = {**SMALL, "nodes": [5, 9], "directions": 25, "rays_per_direction": 20, "threads": 1}
        self.design("whole.h5", **keys)
        run = self.start("design", out="cut.h5", **keys)
        while not (self.folder / "cut.h5.state").exists() and run.poll() is None:
            time.sleep(0.005)
        run.send_signal(signal.SIGINT)
        run.communicate()
        self.assertIn(run.returncode, (0, 75))
        if run.returncode == 75:
            self.assertTrue((self.folder / "cut.h5.state").exists())
            self.assert_refused(["another search"], "design", out="cut.h5", resume=True, **{**keys, "nodes": [5]})
            kept = (self.folder / "cut.h5.state").read_bytes()
            (self.folder / "new.h5.state").write_bytes(kept)
            self.assertIn("--resume would continue it", self.call("design", out="new.h5", **keys).stderr)
            (self.folder / "new.h5.state").write_bytes(kept)
            self.assertIn("another search, which is discarded",
                          self.call("design", out="new.h5", **{**keys, "nodes": [3]}).stderr)
            self.design("cut.h5", resume=True, **keys)
        self.assertFalse((self.folder / "cut.h5.state").exists())
        whole, cut = (datasets(self.folder / name) for name in ("whole.h5", "cut.h5"))
        for name in ("ball_spline", "history/rms", "rms/held_out"):
            np.testing.assert_array_equal(whole[name], cut[name])

    def test_of_another_picture_nothing_is_resumed(self):
        picture = (DATA / "pictures/hills.csv").read_text()
        self.write("asked.csv", picture)
        keys = {"design": "box", "nodes": [9, 17, 33], "goal": "irradiance", "pictures": "asked.csv", "threads": 1, "out": "cut.h5"}
        run = self.start("design", **keys)
        while not (self.folder / "cut.h5.state").exists() and run.poll() is None:
            time.sleep(0.05)
        run.send_signal(signal.SIGINT)
        run.communicate()
        self.assertEqual(run.returncode, 75)
        self.write("asked.csv", "\n".join(reversed(picture.splitlines())))
        self.assert_refused(["another search", "asked.csv"], "design", resume=True, **keys)

    def test_a_signal_within_a_long_step(self):
        """A step of 400,000 rays takes about four seconds of processor time, on a busy machine too."""
        run = self.start("design", design="guide", goal="equal_path", delta=0.01, coefficients=0, ray_count=400000,
                         threads=1, out="cut.h5")
        time.sleep(1)
        before = user_seconds_of_children() + user_seconds(run)
        run.send_signal(signal.SIGINT)
        run.communicate()
        self.assertLess(user_seconds_of_children() - before, 1.5)
        self.assertIn(run.returncode, (75, 130))
        self.assertFalse((self.folder / "cut.h5").exists())

    def test_threads_do_not_matter(self):
        for threads in (1, 4):
            self.design(f"{threads}.h5", threads=threads, **SMALL)
        self.assert_same_data("1.h5", "4.h5")

    def test_target_that_is_not_reached(self):
        _, found = self.design("lens.h5", status=3, target=1e-9, **SMALL)
        self.assertGreater(found["rms/seen"], 1e-9)
        self.assertFalse(attributes(self.folder / "lens.h5")["converged"])
        self.design("one.h5", status=3, target=1e-9, iterations=1, **SMALL)

    def test_bad_input(self):
        even = "\n".join(["1,1,1,1"] * 4)
        for name, text in (("row.csv", "1,1,1,1\n"), ("dark.csv", even.replace("1", "0")), ("even.csv", even)):
            self.write(name, text)
        for words, keys in [
                (["nodes = 8", "must be 9"], {"nodes": [5, 8]}),
                (["nodes", "from 2"], {"nodes": [1]}),
                (["start_excess = 3", "range"], {"start_excess": 3}),
                (["least_index", "at most 1"], {"least_index": 1.2}),
                (["least_index", "positive"], {"least_index": 0}),
                (["most_index", "at least 1"], {"most_index": 0.9}),
                (["directions"], {"directions": 0}),
                (["rays_per_direction"], {"rays_per_direction": 0}),
                (["step = 2", "radius"], {"step": 2}),
                (["aperture"], {"aperture": 1.5}),
                (["coefficients"], {"coefficients": 9}),
                (["nodes"], {"design": "radial", "nodes": [5, 9]}),
                (["design = lens", "ball radial"], {"design": "lens"}),
                (["goal", "box"], {"goal": "irradiance", "design": "guide", "delta": 0.01}),
                (["goal", "guide"], {"goal": "equal_path"}),
                (["delta"], {"goal": "equal_path", "design": "guide"}),
                (["coefficients = 2"], {"goal": "equal_path", "design": "guide", "delta": 0.01, "coefficients": 2}),
                (["pictures"], {"goal": "irradiance", "design": "box"}),
                (["pictures", "no such file"], {"goal": "irradiance", "design": "box", "pictures": "none.csv"}),
                (["square"], {"goal": "irradiance", "design": "box", "pictures": "row.csv"}),
                (["dark"], {"goal": "irradiance", "design": "box", "pictures": "dark.csv"}),
                (["as many"], {"goal": "irradiance", "design": "box", "pictures": ["even.csv", "even.csv"]}),
                (["beam_width = 3", "fit"],
                 {"goal": "irradiance", "design": "box", "pictures": "even.csv", "beam_width": 3}),
                (["screen_distance"],
                 {"goal": "irradiance", "design": "box", "pictures": "even.csv", "screen_distance": 1}),
                (["measured"], {"goal": "deflections", "design": "box"}),
                (["nodes = 5", "at least 7"], {"goal": "deflections", "design": "box", "nodes": [5, 9]}),
                (["rate"], {"rate": 0.1}),
                (["noise", "target"], {"target": 0.1, "noise": 0.1}),
                (["sources is not given"], {"goal": "collimation"}),
                (["sources = 0 0 0.5", "outside"], {"goal": "collimation", "sources": [0, 0, 0.5]}),
                (["half_angle", "misses"], {"goal": "collimation", "sources": [0, 0, -9]}),
                (["aperture_radius"], {"goal": "throughput", "sources": [0, 0, -1]}),
                (["aperture_distance = 1", "behind"],
                 {"goal": "throughput", "sources": [0, 0, -1], "aperture_radius": 0.1, "aperture_distance": 1})]:
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
