"""Rays and curves through index fields against closed forms, contents of the file, rejected input."""

import unittest

import h5py
import numpy as np

from program import DATA, ProgramTest, attributes, datasets

SCENES = DATA / "scenes"
PLANE = {"stop_plane": [0, 0, 1, 0, 0, 1], "max_length": 5}
FIBRE = {"index": 1.5, "alpha": 0.5}
LIGHT_SPEED = 299792458


def write_grid(path, excess, origin=(-1, -1, -1), spacing=0.25):
    with h5py.File(path, "w") as file:
        data = file.create_dataset("excess", data=excess)
        data.attrs["origin"] = np.array(origin, dtype=float)
        data.attrs["spacing"] = np.full(3, float(spacing))


def vectors(found, name):
    return np.stack([found[name + axis] for axis in "xyz"], axis=-1)


class TraceTest(ProgramTest):
    def trace(self, name="trace.h5", **keys):
        self.output = self.call("trace", **keys, out=name).stdout
        return datasets(self.folder / name)

    def scene(self, scene, **keys):
        return self.trace(config=SCENES / f"trace_{scene}.toml", **keys)


class Rays(TraceTest):
    def test_luneburg_focus(self):
        """A collimated beam is focused on the far rim, each ray after pi/2 + 1 (C27)."""
        found = self.scene("luneburg")
        np.testing.assert_allclose(vectors(found, "exit/"), np.tile([0, 0, 1], (15, 1)), atol=1e-8)
        np.testing.assert_allclose(found["optical_path"], np.pi / 2 + 1, rtol=1e-8)
        np.testing.assert_array_equal(found["status"], 0)
        self.assertLess(found["invariants/index_mismatch"].max(), 1e-9)
        turn = found["start/x"]  # for a ball with rays parallel to z
        inside = found["invariants/angular_momentum"]
        np.testing.assert_allclose(inside, abs(turn), atol=1e-12)
        self.assertLess(found["invariants/angular_momentum_change"].max(), 1e-8)
        np.testing.assert_allclose(found["time"], found["optical_path"] / LIGHT_SPEED, rtol=1e-14)

    def test_fisheye_image(self):
        """P is imaged to -P/|P|^2, after the optical path pi n0/2."""
        found = self.scene("fisheye")
        np.testing.assert_allclose(vectors(found, "exit/"), np.tile([0, 0, 2], (15, 1)), atol=1e-8)
        np.testing.assert_allclose(found["optical_path"], np.pi, rtol=1e-8)

    def test_parabolic_fibre_disperses(self):
        """The optical path to a plane z follows from C27's sinusoids: with beta = n0 cos t and sigma = z/beta,
        n0^2 sigma - n0^2 sin^2 t (sigma/2 - sin(2 alpha sigma)/(4 alpha))."""
        found = self.scene("parabolic_fibre")
        n0, alpha, z = 1.5, 0.5, 50.2654824574367
        sine = found["start/dx"]
        beta = n0 * np.sqrt(1 - sine**2)
        sigma = z / beta
        ripple = sigma / 2 - np.sin(2 * alpha * sigma) / (4 * alpha)
        exact = n0**2 * sigma - (n0 * sine)**2 * ripple
        np.testing.assert_allclose(found["optical_path"], exact, rtol=1e-8)
        np.testing.assert_allclose(found["exit/x"], n0 * sine / alpha * np.sin(alpha * sigma),
                                   atol=1e-7)
        np.testing.assert_allclose(found["invariants/axial_momentum"], beta, rtol=1e-12)
        self.assertLess(found["invariants/axial_momentum_change"].max(), 1e-8)
        self.assertGreater(np.ptp(exact), 1e-2)  # the dispersion is significant

    def test_whole_periods(self):
        """Over whole periods of a ray the optical path per length is (n0^2 + beta^2)/(2 beta)."""
        sine = np.sin(0.3)
        beta = 1.5 * np.cos(0.3)
        length = 40 * 2 * np.pi * beta / 0.5
        self.write("one.csv", f"x,y,z,dx,dy,dz\n0,0,0,{sine!r},0,{np.cos(0.3)!r}\n")
        found = self.trace(field="parabolic", **FIBRE, rays="one.csv", tolerance=1e-12,
                           stop_plane=[0, 0, length, 0, 0, 1], max_length=1e4)
        exact = (1.5**2 + beta**2) / (2 * beta) * length
        np.testing.assert_allclose(found["optical_path"], exact, rtol=1e-8)

    def test_sech_fibre_does_not(self):
        """Meridional rays of all angles have optical path n0 z over whole periods."""
        found = self.scene("sech_fibre")
        np.testing.assert_allclose(found["optical_path"], 1.5 * 50.2654824574367, rtol=1e-8)
        np.testing.assert_allclose(found["exit/x"], 0, atol=1e-7)

    def test_skew_rays_of_sech_fibre_do(self):
        found = self.trace(field="sech", **FIBRE, light="cone", half_angle=0.3, origin=[0, 1, 0],
                           stop_plane=[0, 0, 50.2654824574367, 0, 0, 1], max_length=100)
        self.assertGreater(np.ptp(found["optical_path"]) / found["optical_path"].mean(), 1e-4)

    def test_ultrasound_guides(self):
        """A ray near the axis crosses it every pi beta/alpha, alpha^2 = (n0+n1) n1 k^2/2 (C28)."""
        keys = {"field": "ultrasound", "index": 1.33, "amplitude": 5e-4, "sound_wavenumber": 4.19}
        quarter = np.pi / 2 * 1.3305 / np.sqrt(1.3305 * 5e-4 * 4.19**2 / 2)
        found = self.trace(**keys, light="line", ray_count=3, beam_radius=1e-3, max_length=1e3,
                           stop_plane=[0, 0, quarter, 0, 0, 1])
        np.testing.assert_allclose(found["exit/x"], 0, atol=1e-8)
        opposite = self.trace(**keys, sound_phase=np.pi, light="line", ray_count=3,
                              beam_radius=1e-3, max_length=1e3,
                              stop_plane=[0, 0, quarter, 0, 0, 1])
        self.assertGreater(opposite["exit/x"][2], 2e-3)  # half a period later it spreads

    def test_time(self):
        found = self.scene("ultrasound")  # in mm
        np.testing.assert_allclose(found["time"], found["optical_path"] / 1000 / LIGHT_SPEED,
                                   rtol=1e-14)

    def test_linear_ramp(self):
        """In n = 1 + z/10 a ray along x is a catenary: n = cosh(x/10)."""
        found = self.trace(field="linear", slope=[0, 0, 0.1], light="line", ray_count=1,
                           direction=[1, 0, 0], across=[0, 0, 1], max_length=100, tolerance=1e-12,
                           stop_plane=[5, 0, 0, 1, 0, 0])
        np.testing.assert_allclose(found["exit/z"], 10 * (np.cosh(0.5) - 1), rtol=1e-9)
        np.testing.assert_allclose(found["invariants/transverse_momentum"], 1, rtol=1e-12)

    def test_tanh_ramp(self):
        """A straight ray integrates n = low + (high - low)/2 (1 + tanh(z/width)), as in --help."""
        found = self.trace(field="tanh", index_low=1, index_high=1.5, ramp_width=0.4, ray_count=1,
                           stop_plane=[0, 0, 1, 0, 0, 1], max_length=5)
        exact = 1 + 0.25 * (1 + 0.4 * np.log(np.cosh(2.5)))
        np.testing.assert_allclose(found["optical_path"], exact, rtol=1e-9)
        self.assertIn("tanh(distance/width)", self.call("trace", help=True).stdout)

    def test_integrators_agree(self):
        keys = {"config": SCENES / "trace_parabolic_fibre.toml"}
        reference = self.trace(**keys)
        for integrator, tolerance in (("yoshida4", 1e-10), ("leapfrog", 1e-7)):
            found = self.trace(**keys, integrator=integrator, tolerance=tolerance)
            np.testing.assert_allclose(found["optical_path"], reference["optical_path"],
                                       rtol=100 * tolerance)

    def test_order_of_equal_steps(self):
        keys = {"field": "fisheye", "light": "fan", "ray_count": 3, "half_angle": 0.5,
                "origin": [0, 0, -0.5], "max_length": 4, "stop_plane": [0, 0, 1, 0, 0, 1]}
        exact = self.trace(**keys, tolerance=1e-13)["optical_path"][2]
        for integrator, order in (("leapfrog", 2), ("yoshida4", 4), ("sharma", 4)):
            coarse, fine = (self.trace(**keys, integrator=integrator, step=step)["optical_path"][2]
                            for step in (0.02, 0.01))
            ratio = (coarse - exact) / (fine - exact)
            self.assertAlmostEqual(np.log2(ratio), order, delta=0.2, msg=integrator)

    def test_sum_and_grid(self):
        """A grid of samples of a blob equals the blob, also next to a medium."""
        self.write("blobs.csv", "x,y,z,height,width\n0.1,0,0.2,0.02,0.5\n")
        nodes = np.linspace(-2, 2, 81)
        x, y, z = np.meshgrid(nodes, nodes[30:51], nodes, indexing="ij")
        blob = 0.02 * np.exp(-((x - 0.1)**2 + y**2 + (z - 0.2)**2) / 0.5)
        write_grid(self.folder / "grid.h5", blob, (-2, -0.5, -2), 0.05)
        keys = {"index": 1.2, "light": "line", "beam_radius": 0.5, "origin": [0, 0, -1.5], **PLANE}
        blobs = self.trace(field=["homogeneous", "blobs"], blobs="blobs.csv", **keys)
        alone = self.trace(field="blobs", blobs="blobs.csv", **keys)
        grid = self.trace(field=["homogeneous", "grid"], grid="grid.h5", **keys)
        straight = self.trace(field="homogeneous", **keys)
        for name in ("exit/x", "optical_path"):
            np.testing.assert_allclose(alone[name], blobs[name], atol=1e-9)
            np.testing.assert_allclose(grid[name], blobs[name], atol=1e-6)
            self.assertGreater(abs(straight[name] - blobs[name]).max(), 1e-3)

    def test_statuses(self):
        write_grid(self.folder / "grid.h5", np.zeros((9, 9, 9)))
        self.write("rays.csv", "x,y,z,dx,dy,dz\n0,0,-0.5,0,0,2\n0,0,-0.5,1,0,0\n0,0,-0.5,0,0,-1\n"
                   "0,0,0.6,0,0,-1\n")
        found = self.trace(field="grid", grid="grid.h5", rays="rays.csv", max_length=1.2,
                           stop_plane=[0, 0, 0.7, 0, 0, 1], stop_sphere=[0, 0, -0.5, 0.1])
        np.testing.assert_array_equal(found["status"], [0, 0, 0, 0])
        np.testing.assert_array_equal(found["surface"], [1, 1, 1, 1])
        found = self.trace(field="grid", grid="grid.h5", rays="rays.csv", max_length=1.25,
                           stop_plane=[0, 0, 0.7, 0, 0, 1])
        np.testing.assert_array_equal(found["status"], [0, 2, 2, 1])
        np.testing.assert_array_equal(found["surface"], [0, 1, 1, 1])
        np.testing.assert_allclose(found["arc_length"], [1.2, 1, 0.5, 1.25], rtol=1e-9)

    def test_rays_leave_a_grid_with_an_index_gradient(self):
        """In n = 1 + s.x, which the spline reproduces, n = n0 cosh(|s| sigma) + v0.s/|s| sinh(|s| sigma) up
        to the edge, and no ray is lost there."""
        nodes = np.linspace(-1, 1, 9)
        x, y, _ = np.meshgrid(nodes, nodes, nodes, indexing="ij")
        write_grid(self.folder / "grid.h5", 0.5 * x + 0.25 * y)
        gradient = np.array([0.5, 0.25, 0])
        steep = np.linalg.norm(gradient)
        start = np.array([0.3, 0.3, -0.9])
        n0 = 1 + gradient @ start
        for steps in ({"tolerance": 1e-10}, {"tolerance": 1e-12, "integrator": "yoshida4"},
                      {"step": 0.01}):
            found = self.trace(field="grid", grid="grid.h5", light="fan", half_angle=1,
                               ray_count=41, origin=[*start], max_length=5, **steps)
            np.testing.assert_array_equal(found["status"], 2)
            end = vectors(found, "exit/")
            np.testing.assert_allclose(abs(end).max(axis=1), 1, atol=1e-9)
            sigma = (end[:, 2] - start[2]) / (n0 * found["start/dz"])
            along = n0 * vectors(found, "start/d") @ gradient / steep
            exact = n0 * np.cosh(steep * sigma) + along * np.sinh(steep * sigma)
            np.testing.assert_allclose(1 + end @ gradient, exact, rtol=1e-8, err_msg=str(steps))

    def test_time_is_shown_in_units(self):
        self.scene("ultrasound")
        self.assertRegex(self.output, r"time 4\.\d+e-10 to 4\.\d+e-10 s, spread")

    def test_lights(self):
        keys = {"max_length": 2, "ray_count": 400, "origin": [1, 2, 3], "direction": [0, 1, 0]}
        disk = self.trace(light="disk", beam_radius=0.5, **keys)
        radius = np.hypot(disk["start/x"] - 1, disk["start/z"] - 3)
        np.testing.assert_allclose(np.mean(radius**2), 0.125, rtol=1e-3)
        np.testing.assert_allclose(disk["exit/y"], 4, atol=1e-9)
        beam = self.trace(light="beam", beam_radius=0.5, **keys)
        radius = np.hypot(beam["start/x"] - 1, beam["start/z"] - 3)
        np.testing.assert_allclose(np.mean(radius**2), 0.125, rtol=0.02)
        self.assertGreater(radius.max(), 0.7)
        cone = self.trace(light="cone", half_angle=1, **keys)
        np.testing.assert_allclose(np.mean(cone["start/dy"]), (1 + np.cos(1)) / 2, rtol=1e-3)
        fan = self.trace(light="fan", half_angle=1, across=[0, 0, 1], **keys)
        np.testing.assert_allclose(np.arctan2(fan["start/dz"], fan["start/dy"]),
                                   np.linspace(-1, 1, 400), atol=1e-12)

    def test_paths_lie_on_the_rays(self):
        """In a Luneburg ball rays are ellipses, x(sigma) = x0 cos sigma + v0 sin sigma."""
        found = self.scene("luneburg")
        path = np.stack([found[f"path/{axis}"] for axis in "xyz"], axis=-1)
        np.testing.assert_allclose(path[:, 0], vectors(found, "start/"), atol=1e-12)
        np.testing.assert_allclose(path[:, -1], vectors(found, "exit/"), atol=1e-9)
        for ray, b in zip(path, found["start/x"]):
            inside = ray[np.linalg.norm(ray, axis=1) < 1]
            entry = np.array([b, 0, -np.sqrt(1 - b * b)])
            x, z = np.linalg.solve(np.array([[entry[0], 0], [entry[2], 1]]), inside[:, [0, 2]].T) \
                if b else (np.zeros(1), np.ones(1))
            np.testing.assert_allclose(x**2 + z**2, 1, atol=1e-5)
        middle = found["index_map"][100, 100]
        self.assertAlmostEqual(middle, np.sqrt(2), delta=0.01)

    def test_far_from_the_origin(self):
        """Ends are accurate to the rounding of the coordinates, and no rays are lost."""
        for far in (1e6, 1e9):
            found = self.trace(field="luneburg", centre=[far, far, far], origin=[far, far, far - 1],
                               light="line", ray_count=21, beam_radius=0.9, max_length=5,
                               stop_plane=[far, far, far + 1, 0, 0, 1])
            np.testing.assert_array_equal(found["status"], 0)
            np.testing.assert_allclose(found["optical_path"], np.pi / 2 + 1,
                                       atol=1e-8 + 1e-14 * far)

    def test_long_rays(self):
        """Tolerances are tight at large coordinates, and ends do not depend on max_length."""
        found = self.trace(field="parabolic", **FIBRE, light="fan", half_angle=0.2, ray_count=3,
                           stop_plane=[0, 0, 1000, 0, 0, 1], max_length=2000, tolerance=1e-13)
        sigma = 1000 / (1.5 * np.cos(0.2))
        exact = 1.5 * np.sin(0.2) / 0.5 * np.sin(0.5 * sigma)
        np.testing.assert_allclose(found["exit/x"], [-exact, 0, exact], atol=1e-8)
        found = self.trace(max_length=1e6, ray_count=1, stop_sphere=[0, 0, 3, 1])
        np.testing.assert_allclose(found["exit/z"], 2, atol=1e-8)

    def test_large_and_small_index(self):
        """Steps do not jump over surfaces at a large index, nor become tiny at a small one."""
        self.write("blobs.csv", "x,y,z,height,width\n0.05,0,50,10,0.1\n")
        keys = {"field": "blobs", "blobs": "blobs.csv", "index": 100, "ray_count": 1,
                "max_length": 200, "stop_plane": [0, 0, 100, 0, 0, 1]}
        found, fine = self.trace(**keys), self.trace(**keys, step=1e-4)
        self.assertGreater(fine["exit/x"][0], 1)
        np.testing.assert_allclose(found["exit/x"], fine["exit/x"], rtol=1e-7)
        # n = 2/(1 + r^2) along r: 2 atan r
        found = self.trace(field="fisheye", origin=[0, 0, -1000], ray_count=1, max_length=5000,
                           stop_plane=[0, 0, 1, 0, 0, 1])
        np.testing.assert_allclose(found["optical_path"], 2 * (np.arctan(1000) + np.arctan(1)),
                                   rtol=1e-8)

    def test_edge_of_the_grid(self):
        """A ray that leaves the grid at its start has length 0."""
        write_grid(self.folder / "grid.h5", np.zeros((9, 9, 9)))
        self.write("rays.csv", "x,y,z,dx,dy,dz\n0,0,1,0,0,1\n0,0,1,0,0,-1\n0,0,-1,0.1,0,-1\n"
                   "0.5,1,0,0,1,1\n")
        found = self.trace(field="grid", grid="grid.h5", rays="rays.csv", max_length=10)
        np.testing.assert_array_equal(found["status"], 2)
        np.testing.assert_allclose(found["arc_length"], [0, 2, 0, 0], atol=1e-9)

    def test_directions_of_any_length(self):
        for length in (1e-200, 1e50):
            found = self.trace(direction=[0, 0, length], ray_count=1, max_length=2)
            np.testing.assert_allclose(vectors(found, "exit/d"), [[0, 0, 1]])
            np.testing.assert_allclose(found["exit/z"], 2)

    def test_threads_do_not_matter(self):
        for threads in (1, 3):
            self.scene("ultrasound", name=f"{threads}.h5", threads=threads)
        self.assert_same_data("1.h5", "3.h5")

    def test_config_runs_again(self):
        self.scene("fisheye")
        self.write("again.toml", attributes(self.folder / "trace.h5")["config"])
        self.trace("again.h5", config="again.toml")
        self.assert_same_data("trace.h5", "again.h5")


class Connections(TraceTest):
    def test_luneburg(self):
        """The only curve inside the ball follows from C27: with C = cos sigma, 2 C^2 - 2 (P.Q) C + P^2 + Q^2
        - 2 = 0, v0 = (Q - P C)/sin sigma."""
        p, q = np.array([0.3, 0.1, -0.6]), np.array([-0.2, 0.4, 0.5])
        found = self.trace(field="luneburg", connect=[*p, *q], trials=300, max_length=20)
        self.assertEqual(len(found["found"]), 1)
        c = np.roots([2, -2 * p @ q, p @ p + q @ q - 2]).max()
        s = np.sqrt(1 - c * c)
        v0 = (q - p * c) / s
        vq = v0 * c - p * s
        n0, nq = np.linalg.norm(v0), np.linalg.norm(vq)
        np.testing.assert_allclose(vectors(found, "start/d"), [v0 / n0], atol=1e-7)
        np.testing.assert_allclose(vectors(found, "exit/d"), [vq / nq], atol=1e-7)
        np.testing.assert_allclose(found["spreading"], [n0 * s * s * abs(v0 @ vq) / nq], rtol=1e-6)
        self.assertEqual(found["found"].sum(), found["trials/converged"])
        ends = [found[name] for name in found if name.startswith("trials/")]
        self.assertEqual(sum(ends) - found["trials/iterations"], 300)

    def test_fisheye(self):
        """Curves are both arcs of a circle through the points: with R = n0 a/2 = 1 the optical paths are d
        and 2 pi - d, |J| = sin^2(d)/n_Q^2, and the long arc passes one point focus."""
        p, q = np.array([0.3, 0.1, -0.6]), np.array([-0.2, 0.7, 0.9])
        found = self.trace(field="fisheye", connect=[*p, *q], trials=400, max_length=8)
        n = 2 / (1 + q @ q)
        d = 2 * np.arcsin(np.linalg.norm(p - q) / np.sqrt((1 + p @ p) * (1 + q @ q)))
        np.testing.assert_allclose(found["optical_path"], [d, 2 * np.pi - d], rtol=1e-7)
        np.testing.assert_allclose(found["spreading"], np.sin(d)**2 / n**2, rtol=1e-6)
        np.testing.assert_array_equal(found["caustics"], [0, 2])
        self.assertGreater(found["found"].min(), 10)

    def test_straight(self):
        found = self.trace(field="homogeneous", index=1.4, connect=[0, 0, 0, 0, 3, 4],
                           max_length=10, path_points=3)
        np.testing.assert_allclose(found["optical_path"], [7])
        np.testing.assert_allclose(found["spreading"], [25])
        np.testing.assert_allclose(found["path/z"], [[0, 2, 4]])

    def test_no_curve(self):
        """A sphere lies between the two points."""
        found = self.trace(field="homogeneous", connect=[0, 0, -2, 0, 0, 2], max_length=10,
                           stop_sphere=[0, 0, 0, 1], step=0.1, path_points=5)
        self.assertNotIn("found", found)
        self.assertIn("0 curves", self.output)

    def test_image_point(self):
        found = self.trace(field="fisheye", connect=[0, 0, -0.5, 0, 0, 2], trials=50, max_length=8)
        self.assertNotIn("found", found)
        self.assertGreater(found["trials/degenerate"], 0)
        self.assertIn("image point", self.output)

    def test_small_obstacles(self):
        """Surfaces between the steps of a curve also stop it."""
        ends = {"connect": [0, 0, -2, 0, 0, 2], "max_length": 100, "trials": 50}
        fibre = {"field": "parabolic", "index": 1.5, "alpha": 1e-3, "step": 0.5}
        for field in ({}, fibre):
            free = self.trace(**field, **ends, stop_sphere=[0, 0.06, 0.1, 0.05])
            self.assertEqual(len(free["found"]), 1)
            found = self.trace(**field, **ends, stop_sphere=[0, 0.04, 0.1, 0.05])
            self.assertNotIn("found", found)
        self.assertEqual(found["trials/converged"], 0)
        self.assertEqual(found["trials/left_region"], free["trials/converged"])

    def test_any_index(self):
        """Curves in the fisheye do not depend on n0; optical paths are proportional to it."""
        ends = {"connect": [0.3, 0.1, -0.6, -0.2, 0.7, 0.9], "max_length": 8, "trials": 100}
        usual = self.trace(field="fisheye", **ends)
        for index in (1e-3, 100):
            found = self.trace(field="fisheye", index=index, **ends)
            np.testing.assert_allclose(found["optical_path"], usual["optical_path"] * index / 2,
                                       rtol=1e-7)
            np.testing.assert_allclose(found["spreading"], usual["spreading"], rtol=1e-6)

    def test_paths_end_at_the_point(self):
        q = [0.5, 0.2, 6]
        found = self.trace(field="parabolic", **FIBRE, connect=[0, 0.3, 0] + q, trials=300,
                           max_length=20, path_points=50)
        for i, axis in enumerate("xyz"):
            np.testing.assert_allclose(found[f"path/{axis}"][:, -1], q[i], atol=1e-5)


class Refused(TraceTest):
    def refuse(self, *words, **keys):
        """Checks one line that contains the words, status 2, and nothing written."""
        before = self.listing()
        done = self.call("trace", status=2, out="bad.h5", **{"max_length": 5, **keys})
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for word in words:
            self.assertIn(str(word), done.stderr)
        self.assertEqual(self.listing(), before)

    def test_fields(self):
        self.write("none.csv", "x,y,z,height,width\n")
        self.write("thin.csv", "x,y,z,height,width\n0,0,0,1,0\n")
        self.refuse("field = glass", field="glass")
        self.refuse("field", "luneburg fisheye", field=["luneburg", "fisheye"])
        self.refuse("field = blobs", "twice", field=["blobs", "blobs"])
        self.refuse("index = 0", index=0)
        self.refuse("index = -1", field="fisheye", index=-1)
        self.refuse("radius = 0", field="luneburg", radius=0)
        self.refuse("alpha", "is a key of", "parabolic, sech", field="luneburg", alpha=1)
        self.refuse("alpha is not given", field="sech")
        self.refuse("blobs is not given", field="blobs")
        self.write("one.csv", "x,y,z,height,width\n0,0,0,1,1\n")
        self.refuse("index", "is a key of", field=["luneburg", "blobs"], blobs="one.csv", index=1.3)
        self.refuse("blobs = none.csv", "at least one row", field="blobs", blobs="none.csv")
        self.refuse("thin.csv, width = 0", field="blobs", blobs="thin.csv")
        self.refuse("sound_wavenumber = -1", field="ultrasound", sound_wavenumber=-1, amplitude=1)
        self.refuse("emitters = 0", field="focused_sound", sound_wavenumber=1, amplitude=0,
                    emitters=0)
        self.refuse("frequency", field="ultrasound", sound_wavenumber=1, frequency=1e6, amplitude=0)
        self.refuse("pressure", field="ultrasound", sound_wavenumber=1, pressure=1, amplitude=0)
        self.refuse("sound_speed", field="ultrasound", sound_wavenumber=1, sound_speed=1600, amplitude=0)
        self.refuse("transducer", field="transducers")
        self.refuse("transducer", field="transducers", transducer=[1e-3, 4, 0])
        self.refuse("aperture of a transducer = 4", field="transducers",
                    transducer=[1e-3, 4, 0, 0, 0, 15, 1, 0, 0, 4])
        self.refuse("direction of a transducer", field="transducers",
                    transducer=[1e-3, 4, 0, 0, 0, 15, 0, 0, 0, 0.4])
        self.refuse("sound_order = 65", field="ultrasound", sound_wavenumber=1, amplitude=0,
                    sound_order=65)

    def test_grids(self):
        write_grid(self.folder / "flat.h5", np.zeros((5, 5)))
        write_grid(self.folder / "small.h5", np.zeros((5, 5, 3)))
        write_grid(self.folder / "low.h5", np.full((5, 5, 5), -1.0))
        write_grid(self.folder / "good.h5", np.zeros((9, 9, 9)))
        with h5py.File(self.folder / "empty.h5", "w"):
            pass
        for name, what in (("flat", "axes"), ("small", "3"), ("low", "-1"), ("empty", "excess"),
                           ("absent", "no such file")):
            self.refuse("grid", f"{name}.h5", what, field="grid", grid=f"{name}.h5")
        self.refuse("grid is not given", field="grid")
        self.refuse("ray 0", "must lie inside the grid", field="grid", grid="good.h5", origin=[0, 0, 2])

    def test_index_not_positive_on_the_way(self):
        self.refuse("ray 0", "index", field="linear", slope=[0, 0, -0.5], ray_count=1)
        self.refuse("ray 0", "starts at 4 0 0", "index", field="parabolic", **FIBRE, ray_count=1,
                    origin=[4, 0, 0])
        self.write("hole.csv", "x,y,z,height,width\n0,0,2,-1.5,0.3\n")
        self.refuse("ray 0", "index", field="blobs", blobs="hole.csv", ray_count=1)

    def test_lights(self):
        self.write("none.csv", "x,y,z,dx,dy,dz\n")
        self.write("still.csv", "x,y,z,dx,dy,dz\n0,0,0,0,0,0\n")
        self.write("short.csv", "x,y,z\n0,0,0\n")
        self.refuse("ray_count = 0", ray_count=0)
        self.refuse("ray_count = 100000000", "memory", ray_count=100000000, path_points=100000)
        self.refuse("light = laser", light="laser")
        self.refuse("half_angle", "is a key of", "cone", half_angle=0.2)
        self.refuse("half_angle = 0", light="fan", half_angle=0)
        self.refuse("beam_radius = -1", beam_radius=-1)
        self.refuse("direction = 0 0 0", direction=[0, 0, 0])
        self.refuse("direction = 0 1", direction=[0, 1])
        self.refuse("across = 0 0 1", across=[0, 0, 1])
        self.refuse("rays = none.csv", "at least one row", rays="none.csv")
        self.refuse("still.csv, direction of ray 0 = 0 0 0", rays="still.csv")
        self.refuse("short.csv", "dx", rays="short.csv")
        self.write("good.csv", "x,y,z,dx,dy,dz\n0,0,0,0,0,1\n")
        self.refuse("origin", "is a key of", rays="good.csv", origin=[0, 0, 1])

    def test_stops(self):
        self.refuse("max_length is not given", max_length=None)
        self.refuse("max_length = 0", max_length=0)
        self.refuse("stop_plane = 0 0 1", stop_plane=[0, 0, 1])
        self.refuse("stop_plane, normal = 0 0 0", stop_plane=[0, 0, 1, 0, 0, 0])
        self.refuse("stop_sphere, radius = -1", stop_sphere=[0, 0, 1, -1])
        self.refuse("stop_box = 1 1 1 0 0 0", stop_box=[1, 1, 1, 0, 0, 0])
        self.refuse("ray 0 starts", "behind stop_plane", stop_plane=[0, 0, -1, 0, 0, 1])
        self.refuse("integrator = euler", integrator="euler")
        self.refuse("tolerance = 0", tolerance=0)
        self.refuse("step = -1", step=-1)
        self.refuse("path_points = 1", path_points=1)
        self.refuse("length_unit = 0", length_unit=0)

    def test_connections(self):
        self.refuse("connect = 1 2 3 1 2 3", "different", connect=[1, 2, 3, 1, 2, 3])
        self.refuse("connect = 1 2 3", "six", connect=[1, 2, 3])
        self.refuse("trials = 0", connect=[0, 0, 0, 0, 0, 1], trials=0)
        self.refuse("trials", "connect", trials=10)
        self.refuse("ray_count", "light of rays", connect=[0, 0, 0, 0, 0, 1], ray_count=3)
        self.refuse("connect = 0 0 2", "ball", field="luneburg", connect=[0, 0, 0, 0, 0, 2])
        self.refuse("connect = 0 0 2", "stop_plane", connect=[0, 0, 0, 0, 0, 2], **PLANE)
        self.refuse("connect", "sides", connect=[0, 0, 0, 0, 0, 2], stop_sphere=[0, 0, 0, 1])
        self.refuse("connect = 4 0 0", "index", field="parabolic", **FIBRE,
                    connect=[0, 0, 0, 4, 0, 0])


if __name__ == "__main__":
    unittest.main()
