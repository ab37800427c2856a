"""Bodies of triangles: the mesh of a ball gives its powers, maps and pictures; bad files are rejected."""

import unittest

import numpy as np

from meshes import ball, icosphere, volume, write_polygons, write_stl
from program import ERRORS, SAMPLES, WHOLE, attributes, datasets
from renders import BOX, RenderTest

ROOM = {"stage_box": [-2, -2, -2, 2, 2, 2]}
BEAM = {"beam_light": [0, 0, -2, 0, 0, 1, 1.2, 1]}
SMOKE = {"body_mu_s": 1, "body_mu_a": 0.3, "body_phase": "henyey_greenstein", "body_g": 0.7}
DISK = {"sensor": "area", "sensor_at": [0, 0, 2], "sensor_size": [1, 1], "pixels": [1, 1]}


class Mesh(RenderTest):
    def setUp(self):
        super().setUp()
        self.triangles = ball()
        write_stl(self.folder / "ball.stl", self.triangles)

    def both(self, **keys):
        """Returns results with the mesh and with the ball of its volume."""
        keys = {**ROOM, **keys}
        mesh = self.render("mesh.h5", body_mesh="ball.stl", body_mesh_spacing=0.2, **keys)
        sphere = [0, 0, 0, (volume(self.triangles) * 3 / (4 * np.pi)) ** (1 / 3)]
        return mesh, self.render("sphere.h5", body_sphere=sphere, **keys)

    def assert_alike(self, mesh, sphere, name, error):
        value, errors = mesh[name], np.hypot(mesh[f"{name}_error"], sphere[f"{name}_error"])
        self.assertLess(np.max(errors / value), error)
        np.testing.assert_array_less(np.abs(value - sphere[name]), 4 * errors)

    def assert_balance(self, found):
        ends = [value for name, value in found.items()
                if name.startswith("energy/") and not name.endswith(("emitted", "_error", "_rare"))]
        np.testing.assert_allclose(sum(ends), found["energy/emitted"], rtol=1e-12)
        self.assertLessEqual(found["energy/lost"], 1e-5 * found["energy/emitted"])

    def test_powers(self):
        """Compares powers of refracted, scattered, absorbed and unscattered light."""
        for index in (1.4, 1):
            for medium in (SMOKE, {}) if WHOLE else (SMOKE,) if index > 1 else ({},):
                with self.subTest(index=index, **medium):
                    mesh, sphere = self.both(index=index, method="light", samples=int(60000 * SAMPLES), **medium, **BEAM, **DISK)
                    self.assert_balance(mesh)
                    self.assert_alike(mesh, sphere, "total", 0.02 * ERRORS)
                    for name in ("absorbed_body", "scattered") if medium else ():
                        self.assert_alike(mesh, sphere, f"energy/{name}", 0.02 * ERRORS)

    def test_map(self):
        """Compares fluence and absorbed power inside."""
        mesh, sphere = self.both(index=1.4, sensor="none", map_box=[-0.5, -0.5, -0.5, 0.5, 0.5, 0.5],
                                 map_cells=[1, 1, 2], samples=40000, **SMOKE, **BEAM)
        for name in ("map/fluence", "map/absorbed"):
            self.assert_alike(mesh, sphere, name, 0.03)

    def test_pictures(self):
        """Pictures from outside, connected through the smooth surface: by night by a pinhole and on a wall."""
        camera = {"sensor": "camera", "sensor_at": [1.999, 0, 0], "sensor_direction": [-1, 0, 0],
                  "field_of_view": 1.2, "index": 1.1, "samples": int(160000 * SAMPLES)}
        wall = {"sensor": "area", "sensor_at": [2, 0, 0], "sensor_up": [0, 1, 0], "sensor_size": [1, 1],
                "index": 1.4, "method": "bidirectional", "samples": int(40000 * SAMPLES)}
        for keys, error in ((camera, 0.08), (wall, 0.02))[0 if WHOLE else 1:]:
            with self.subTest(sensor=keys["sensor"]):
                mesh, sphere = self.both(point_light=[0, 0, -1.5, 1], pixels=[3, 2], **SMOKE, **keys)
                self.assert_alike(mesh, sphere, "mean", error * ERRORS)
                errors = np.hypot(mesh["image_error"], sphere["image_error"])
                self.assertLess(np.mean(np.abs(mesh["image"] - sphere["image"]) > 3 * errors), 0.2)

    def test_fields_bend_rays_in_it(self):
        mesh, sphere = self.both(field="parabolic", index=1.4, alpha=0.3, method="light", samples=10000,
                                 step=0.05, **SMOKE, **BEAM, **DISK)
        self.assert_balance(mesh)
        self.assert_alike(mesh, sphere, "total", 0.06)
        self.assert_alike(mesh, sphere, "energy/absorbed_body", 0.05)

    def test_text_is_read_as_bytes_are(self):
        """Also inside out; the spacing is the longest side / 64, and the result has volumes."""
        keys = {**ROOM, **BEAM, **DISK, **SMOKE, "method": "light", "samples": 1000, "body_mesh_crease": 0}
        triangles = ball(3)
        write_stl(self.folder / "bytes.stl", triangles)
        write_stl(self.folder / "text.stl", triangles[:, ::-1], text=True)
        first = self.render("bytes.h5", body_mesh="bytes.stl", **keys)
        second = self.render("text.h5", body_mesh="text.stl", body_mesh_spacing=2 / 64, **keys)
        self.assertEqual(first["energy/scattered"], second["energy/scattered"])
        told = attributes(self.folder / "bytes.h5")
        self.assertAlmostEqual(told["mesh_volume"], volume(triangles), places=6)
        self.assertAlmostEqual(told["body_volume"], volume(triangles), delta=0.002)


class Focus(RenderTest):
    """A ball lens of triangles focuses parallel light as the exact ball does, at the default spacing."""

    def focus(self, **body):
        done = self.call("trace", field="homogeneous", light="disk", ray_count=300, origin=[0, 0, -3], beam_radius=0.15,
                         stop_plane=[0, 0, 2, 0, 0, 1], image_plane=[0, 0, 0, 0, 0, 1], max_length=20, out="focus.h5", **body)
        return datasets(self.folder / "focus.h5")["image/focus"], done.stderr

    def test_coarse_balls(self):
        exact, _ = self.focus(body_sphere=[0, 0, 0, 1], index=1.5)
        for times, error in ((3, 0.005), (2, 0.02)):  # 1280 and 320 triangles
            write_stl(self.folder / "ico.stl", icosphere(times))
            found, note = self.focus(body_mesh="ico.stl", index=1.5)
            self.assertAlmostEqual(found / exact, 1, delta=error)
            self.assertIn("degrees are taken as one curved surface", note)
            self.assertNotIn("warning", note)
        plane, note = self.focus(body_mesh="ico.stl", body_mesh_crease=0, index=1.5)
        self.assertGreater(abs(plane / exact - 1), 0.05)

    def test_other_formats_and_materials(self):
        """OBJ and PLY, also as bodies of their own index; turned triangles are reported."""
        triangles = icosphere(2)
        exact, _ = self.focus(ball=[0, 0, 0, 1, 1.5, 0, 0, 0])
        for name in ("ico.obj", "ico.ply"):
            write_polygons(self.folder / name, triangles)
            found, note = self.focus(mesh=name, mesh_material=[1.5, 0, 0, 0])
            self.assertAlmostEqual(found / exact, 1, delta=0.02)
        triangles[::9] = triangles[::9, ::-1]
        write_polygons(self.folder / "turned.ply", triangles)
        again, note = self.focus(mesh="turned.ply", mesh_material=[1.5, 0, 0, 0])
        self.assertAlmostEqual(again, found, delta=1e-9)
        self.assertIn("orientation of 36 triangles was reversed", note)

    def test_prism(self):
        """A prism of 60 degrees deflects as Snell's law states, to rounding: plane faces stay plane."""
        a, b, c = np.array([-1, 0, 0]), np.array([1, 0, 0]), np.array([0, 0, 3**0.5])
        up = np.array([0, 1, 0])
        corners = [a - up, b - up, c - up, a + up, b + up, c + up]
        faces = [[0, 1, 2], [3, 5, 4], [0, 3, 4], [0, 4, 1], [1, 4, 5], [1, 5, 2], [2, 5, 3], [2, 3, 0]]
        write_polygons(self.folder / "prism.obj", np.array([[corners[i] for i in face] for face in faces]))
        tilt = 0.7  # of the light against the normal of the face at the left
        normal, along = np.array([-np.cos(np.pi / 6), 0, np.sin(np.pi / 6)]), np.array([np.sin(np.pi / 6), 0, np.cos(np.pi / 6)])
        light = -np.cos(tilt) * normal + np.sin(tilt) * along
        middle = (a + c) / 2
        self.call("trace", field="homogeneous", light="line", ray_count=1, origin=list(middle - 3 * light), direction=list(light),
                  body_mesh="prism.obj", index=1.5, max_length=9, stop_plane=[3, 0, 0, 1, 0, 0], out="prism.h5")
        found = datasets(self.folder / "prism.h5")
        inside = np.arcsin(np.sin(tilt) / 1.5)
        out = np.arcsin(1.5 * np.sin(np.pi / 3 - inside))
        turn = np.arctan2(light[2], light[0]) - np.arctan2(found["exit/dz"][0], found["exit/dx"][0])
        self.assertAlmostEqual(turn, tilt + out - np.pi / 3, delta=1e-12)


class Refused(RenderTest):
    GOOD = {**BOX, "beam_light": [0, 0, 0, 0, 0, 1, 0.3, 2], "sensor": "directional", "samples": 100}

    def refuse(self, *words, **keys):
        before = self.listing()
        done = self.call("render", status=2, **{"out": "bad.h5", **self.GOOD, **keys})
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)
        self.assertEqual(self.listing(), before)

    def write(self, name, triangles):
        write_stl(self.folder / name, triangles)
        return name

    def test_files(self):
        good = ball(3) / 2 + [0, 0, 2]
        lost = good.copy()
        lost[7, 1] = [np.nan, 0, 2]
        self.render(**self.GOOD, body_mesh=self.write("good.stl", good))
        self.refuse("none.stl", body_mesh="none.stl")
        self.refuse("body_mesh = open.stl", "not a closed surface", "open edges", body_mesh=self.write("open.stl", good[5:]))
        self.refuse("body_mesh = empty.stl", "no triangle", body_mesh=self.write("empty.stl", good[:0]))
        self.refuse("body_mesh = lost.stl", "must be finite", body_mesh=self.write("lost.stl", lost))
        self.refuse("must be inside of the stage", body_mesh=self.write("far.stl", good + [0, 0, 1.6]))
        for name, text, word in (("words.stl", "no triangles here", "not an STL file"),
                                 ("part.stl", "solid\nvertex 1 2 3\n", "three vertices"),
                                 ("letters.stl", "solid\nvertex 1 2 x\n", "three numbers")):
            (self.folder / name).write_text(text)
            self.refuse(f"body_mesh = {name}", word, body_mesh=name)
        (self.folder / "cut.stl").write_bytes((self.folder / "good.stl").read_bytes()[:-20])
        self.refuse("body_mesh = cut.stl", body_mesh="cut.stl")

    def test_marks_of_text_files_and_bytes_beyond_the_triangles(self):
        """A byte order mark, capitals and trailing bytes are accepted; a wrong count is reported."""
        good = ball(2) / 2 + [0, 0, 2]
        write_stl(self.folder / "text.stl", good, text=True)
        text, data = (self.folder / "text.stl").read_text(), (self.folder / self.write("good.stl", good)).read_bytes()
        count = len(good)
        files = {"mark.stl": ("\ufeff" + text).encode(), "capitals.stl": text.upper().encode(), "tail.stl": data + b"made by x" * 20,
                 "few.stl": data[:80] + np.uint32(count - 3).tobytes() + data[84:],
                 "many.stl": data[:80] + np.uint32(count + 3).tobytes() + data[84:]}
        for name, content in files.items():
            (self.folder / name).write_bytes(content)
        for name in ("mark.stl", "capitals.stl", "tail.stl"):
            self.render(**self.GOOD, body_mesh=name, body_mesh_crease=0)
            self.assertAlmostEqual(attributes(self.folder / "render.h5")["mesh_volume"], volume(good), places=6)
        self.refuse("body_mesh = few.stl", "not a closed surface", "150 bytes after", body_mesh="few.stl")
        self.refuse("body_mesh = many.stl", f"the header counts {count + 3} triangles", body_mesh="many.stl")

    def test_parts_over_one_another(self):
        good = ball(3) / 2 + [0, 0, 2]
        both = np.concatenate([good, good + [0.3, 0, 0]])
        self.refuse("body_mesh = both.stl", "overlap or lie inside one another", body_mesh=self.write("both.stl", both), body_mesh_spacing=0.05)

    def test_keys(self):
        write_stl(self.folder / "ball.stl", ball(3) / 2 + [0, 0, 2])
        for spacing, word in ((0.9, "too coarse"), (1e-4, "too fine"), (-1, "must be positive")):
            self.refuse("body_mesh_spacing", word, body_mesh="ball.stl", body_mesh_spacing=spacing)
        self.refuse("body_mesh_spacing", "is a key of body_mesh", body_mesh_spacing=0.1)
        self.refuse("give one body", body_mesh="ball.stl", body_sphere=[0, 0, 2, 0.5])


if __name__ == "__main__":
    unittest.main()
