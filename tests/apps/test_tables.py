"""Tables from spreadsheets and instruments give the numbers of the plain one; likely mistakes in paths, values and
outputs are reported."""

import os
import resource
import subprocess
import unittest

import h5py
import numpy as np

from program import BOX, PROGRAM, SLAB, datasets, flags
from refusing import RefusingTest

PLACES = "x,z,radius,index_re,index_im\n0,0,0.3,1.5,0\n0.5,2,0.4,1.33,0.01\n"
SOLVE = {"scatterer": "tm", "light_angles": 0.2, "view_angles": [0.2, 1.0, 3.0]}
LAYERS = "thickness,optical_depth,g\n20,2,0.9\n30.5,3,0.7\n"
LAYERED = {"domain": "slab", "scatterer": "hg", "light_angles": [0, 1]}


def forms(plain):
    """Yields the table in the forms of other programs."""
    rows = [line.split(",") for line in plain.splitlines()]

    def written(between, show=str, end="\n"):
        return end.join(between.join(map(show, row)) for row in rows) + end

    def comma(field):
        return field.replace(".", ",")

    return {"quoted": written(",", '"{}"'.format).encode(), "semicolons": written(";", comma).encode(),
            "tabs": written("\t", comma, "\r\n").encode("utf-16"), "spaces": written("  ").encode(),
            "excel": ("sep=;\r\n" + written(";", comma, ";;\r\n")).encode("utf-8-sig"), "numpy": b"# " + plain.encode(),
            "old": written(",", end="\r").encode()}


class Tables(RefusingTest):
    def assert_as_plain(self, subcommand, key, plain, scene):
        """Checks that each form gives the same numbers, bit for bit."""
        self.write("plain.csv", plain)
        self.call(subcommand, **{**scene, key: "plain.csv"}, out="plain.h5")
        for name, text in forms(plain).items():
            with self.subTest(key=key, form=name):
                (self.folder / "other.csv").write_bytes(text)
                self.call(subcommand, **{**scene, key: "other.csv"}, out="other.h5")
                self.assert_same_data("plain.h5", "other.h5")

    def test_placements(self):
        self.assert_as_plain("solve", "placement", PLACES, SOLVE)

    def test_layers(self):
        self.assert_as_plain("flux", "layers", LAYERS, LAYERED)

    def test_rays(self):
        self.assert_as_plain("trace", "rays", "x,y,z,dx,dy,dz\n0.1,0.2,-1.5,0,0.1,1\n",
                             {"field": "luneburg", "stop_plane": [0, 0, 2, 0, 0, 1], "max_length": 5})

    def test_degrees(self):
        self.write("radians.csv", f"angle,value\n0,2\n{np.pi / 2!r},1\n{np.pi!r},0.5\n")
        self.write("degrees.csv", "angle_deg,value\n0,2\n90,1\n180,0.5\n")
        for name in ("radians", "degrees"):
            self.call("flux", **{**SLAB, "scatterer": "phase_table", "g": None}, phase_table=f"{name}.csv", out=f"{name}.h5")
        self.assert_same_data("radians.h5", "degrees.h5")
        self.write("points.csv", "light_angles_deg,g\n0,0.5\n30,0.7\n")
        self.call("sweep", **{**SLAB, "g": None}, of="flux", points="points.csv", out="points.h5")
        np.testing.assert_allclose(datasets(self.folder / "points.h5")["light_angles"], [0, np.pi / 6], rtol=1e-15)

    def test_each_reason_names_key_file_and_line(self):
        for text, words in (("x;z\n0,5;1\n1.5;2\n", ["line 2", "0,5", "line 3", "decimal point"]),
                            ("x\tz\n1,234\t5\n", ["line 2", "1,234", "thousands"]),
                            ("0,1\n2,3\n", ["line 1", "column names"]), ("x,z\n1,\"2\n", ["line 2", "quotation marks"]),
                            ("x,z\n1,2,3,4\n", ["line 2", "decimal commas"]), ("PK\x03\x04", ["not a text file"]),
                            ("x,y\n1,2\n", ["column \"y\"", "x, z"]), ("x\n1\n", ["column"])):
            self.write("bad.csv", text)
            self.assert_refused(["placement = bad.csv", *words], "solve", placement="bad.csv")
            self.assert_refused(["near_sensors = bad.csv", *words], "covariance", **BOX, near_sensors="bad.csv")
        self.write("header.csv", "x,z,radius,amplitude\n")
        self.assert_refused(["density_blobs = header.csv", "at least one row"], "covariance", width=20, depth=10, density=0.1,
                            density_blobs="header.csv")


class Paths(RefusingTest):
    def setUp(self):
        super().setUp()
        (self.folder / "scenes").mkdir()
        self.write("scenes/layers.csv", LAYERS)
        self.write("scenes/scene.toml", 'domain = "slab"\nscatterer = "hg"\nlayers = "layers.csv"\n')

    def thicknesses(self, **keys):
        self.call("flux", **{"config": "scenes/scene.toml", "out": "r.h5", **keys})
        return datasets(self.folder / "r.h5")["layer_thickness"].tolist()

    def test_beside_the_scene_then_in_the_working_folder(self):
        self.assertEqual(self.thicknesses(), [20, 30.5])
        with h5py.File(self.folder / "r.h5") as file:
            self.assertIn('layers = "scenes/layers.csv"', file.attrs["config"])
        self.write("layers.csv", LAYERS.replace("30.5", "7"))
        self.assertEqual(self.thicknesses(), [20, 30.5])
        self.assertEqual(self.thicknesses(layers="layers.csv"), [20, 7])  # given as a flag
        (self.folder / "scenes/layers.csv").unlink()
        self.assertEqual(self.thicknesses(), [20, 7])

    def test_in_neither(self):
        (self.folder / "scenes/layers.csv").unlink()
        self.assert_refused(["layers = layers.csv", str(self.folder / "scenes"), f"working folder {self.folder}"], "flux",
                            config="scenes/scene.toml")

    def test_of_keys_that_choose_by_words_too(self):
        self.write("scenes/places.csv", PLACES)
        self.write("scenes/solve.toml", 'scatterer = "tm"\nplacement = "places.csv"\n')
        self.call("solve", config="scenes/solve.toml", out="r.h5")
        self.write("scenes/drawn.toml", 'scatterer = "soft"\nradius = 0.1\nplacement = "hard_disk"\n')
        self.call("solve", config="scenes/drawn.toml", width=9, depth=9, count=3, out="r.h5")


class Slips(RefusingTest):
    def note(self, *words, **keys):
        return self.call(*words, **keys, out="r.h5").stderr

    def test_percent_in_measurements(self):
        medium = {"depth": 100, "optical_depth": 5, "free": "g=0.1:0.95"}
        for column, value, error in (("squared_contrast", 90, 3), ("reflectance", 1.2, 0.1), ("transmittance", 50, 30),
                                     ("reflectance", -0.3, 0.01), ("field_correlation", 1.6, 1)):
            axis = {"squared_contrast": "exposure", "field_correlation": "tilt"}.get(column)
            self.write("m.csv", f"{column},error{',' + axis if axis else ''}\n{value},{error}{',0.01' if axis else ''}\n")
            self.assert_refused([f"measurement = m.csv, {column} = {value}", "to 1", "percent"], "fit", **medium, measurement="m.csv")

    def test_no_scatterers_are_noted(self):
        self.write("none.csv", "x,z\n")
        self.assertIn("no scatterers", self.note("solve", placement="none.csv"))
        self.assertIn("count = 0", self.note("covariance", **{**BOX, "count": 0}, samples=50))

    def test_indices_that_look_like_another_quantity_are_noted(self):
        with h5py.File(self.folder / "grid.h5", "w") as file:
            file["excess"] = np.full((4, 4, 4), 1.33)
            file["excess"].attrs.update(origin=[-3.0] * 3, spacing=[2.0] * 3)
        trace = {"field": "grid", "grid": "grid.h5", "origin": [0, 0, -2], "ray_count": 1, "max_length": 3}
        self.assert_refused(["grid.h5", "grid_values = index"], "trace", **trace)
        self.note("trace", **trace, grid_values="excess")
        with h5py.File(self.folder / "other.h5", "w") as file:
            file["index"] = np.full((4, 4, 4), 1.33)
        other = {**trace, "grid": "other.h5"}
        self.assert_refused(["other.h5", "no dataset excess", "grid_values = index"], "trace", **other)
        self.assert_refused(["other.h5", "no attribute origin", "spacing"], "trace", **other, grid_values="index")
        with h5py.File(self.folder / "grid.h5", "a") as file:
            file["excess"][0, 0, 0] = 0.33
        self.assertNotIn("n - 1", self.note("trace", **trace))
        self.write("p.csv", "x,z,radius,index_re\n0,0,0.3,0.33\n")
        self.assertIn("n, not n - 1", self.note("solve", scatterer="tm", placement="p.csv"))
        self.write("p.csv", "x,z,radius,index_re,index_im\n0,0,0.3,0.05,2.2\n")  # a metal
        self.assertNotIn("n - 1", self.note("solve", scatterer="tm", placement="p.csv"))

    def test_long_numbers_are_refused_at_once(self):
        for figures in (401, 3000, 100_000):
            for key, text in (("depth", "1" + "0" * figures), ("view_angles", "0." + "1" * figures)):
                self.assert_refused([f"{key} = ", "400 digits"], "covariance", **{**SLAB, key: text})
        self.assert_refused(["view_angles = 60001"], "covariance", **{**SLAB, "view_angles": "1+" * 60_000 + "1"})

    def test_a_table_of_points_beside_the_points_of_images(self):
        self.write("p.csv", "optical_depth,photons\n1,2\n2,4\n")
        scene = {"of": "image", "width": 20, "depth": 10, "scatterer": "hg", "object_x": [0, 3], "object_depth": -30,
                 "camera": [-0.5, 0.5], "pixels": 512, "repeats": 1, "threads": 1}
        printed = self.call("sweep", "--print-config", **scene, points=2, points_table="p.csv", out="r.h5").stdout
        self.assertIn('points_table = "p.csv"', printed)
        self.assertIn("points = 2", printed)
        self.assert_refused(["vary is not given", "points_table"], "sweep", **scene)
        self.assert_refused(["points = p.csv", "whole number", "points_table"], "sweep", **scene, points="p.csv")


class Resources(RefusingTest):
    def test_files_that_cannot_be_read(self):
        for key, path in (("near_sensors", "/proc/self/mem"), ("near_sensors", "/tmp"), ("body_mesh", "/proc/self/mem"),
                          ("config", "/proc/self/mem")):
            with self.subTest(key=key, path=path):
                subcommand, scene = ("render", {"stage_box": [-1, -1, 0, 1, 1, 4]}) if key == "body_mesh" else ("field", BOX | {"samples": None})
                self.assert_refused([path, "read"], subcommand, *flags(scene), f"--{key}", path)

    def test_a_target_of_more_paths_than_can_be(self):
        done = self.call("field", **{**BOX, "samples": None}, fields=4, method="covariance", target_error=1e-12, out="x.h5",
                         status=2)
        self.assertIn("target_error = 1e-12: requires", done.stderr)

    def test_a_full_device(self):
        self.call("flux", **SLAB, out="r.h5")
        for words in (["keys", "json"], ["new", "lens"], ["explain", "r.h5"], ["datasets"], ["--help"], ["flux", "--help"],
                      ["--version"]):
            with self.subTest(words=words), open("/dev/full", "w") as full:
                done = subprocess.run([PROGRAM, *words], stdout=full, stderr=subprocess.PIPE, text=True, cwd=self.folder)
                self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
                self.assertIn("output cannot be written", done.stderr)
        words = ["flux", *flags(SLAB), "--out", "x.h5"]
        with open("/dev/full", "w") as full:
            done = subprocess.run([PROGRAM, *words], stdout=full, stderr=subprocess.PIPE, text=True, cwd=self.folder)
        self.assertEqual(done.returncode, 0, "the result is there")
        self.assertIn("output cannot be written", done.stderr)

    def test_a_reader_that_ends(self):
        read, write = os.pipe()
        os.close(read)
        done = subprocess.run([PROGRAM, "keys", "json"], stdout=write, stderr=subprocess.PIPE, text=True)
        os.close(write)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    @unittest.skipIf("FLATSPECKLE_SLOWNESS" in os.environ, "sanitizers take all addresses")
    def test_little_address_space(self):
        """Covers 100 MB and more, in which the libraries can be loaded."""
        for megabytes in (105, 120, 160):
            limit = megabytes << 20
            environment = {key: value for key, value in os.environ.items() if key != "OPENBLAS_NUM_THREADS"}
            done = subprocess.run([PROGRAM, "flux", *flags({**SLAB, "threads": 2, "out": "r.h5"})], capture_output=True, text=True,
                                  cwd=self.folder, env=environment, timeout=100,
                                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
            with self.subTest(megabytes=megabytes):
                self.assertIn(done.returncode, (0, 2), done.stderr)
                self.assertEqual(done.stderr.count("\n"), 1 if done.returncode else 0, done.stderr)


if __name__ == "__main__":
    unittest.main()
