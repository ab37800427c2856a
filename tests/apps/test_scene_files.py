"""Scene files: what is accepted, and rejected files: status 2, one line that names the file, no result."""

import pathlib
import re
import unittest

import h5py

from program import BOX, DATA, TILTS, WHOLE, ProgramTest, flags, toml
from refusing import RefusingTest


class SceneFile(RefusingTest):
    def refused_text(self, text, words):
        with self.subTest(text=text):
            self.write("scene.toml", toml(BOX) + text)
            self.assert_refused(words, "covariance", config="scene.toml")

    def test_tables(self):
        for text in ("[[medium]]\nalbedo = 0.9\n", "[medium]\nalbedo = 0.9\n", "[medium]\n",
                     "[covariance]\nalbedo = 0.9\n", "[default]\nalbedo = 0.9\n",
                     "medium.albedo = 0.9\n", "medium = {albedo = 0.9}\n"):
            self.refused_text(text, ["scene.toml, line 4", "no [tables]"])

    def test_what_is_no_key(self):
        self.refused_text('help = true\n', ["help"])
        self.refused_text('config = "other.toml"\n', ["config"])
        self.refused_text('out = "other.h5"\n', ["out"])
        self.refused_text("print-config = true\n", ["print-config"])

    def test_what_is_no_line_of_a_scene(self):
        for text in ("nonsense\n", "= 3\n", "two words = 3\n", "tilts = [0 0.5]\n", "length_unit = um\n",
                     "index = 1.5+0.1i\n", "light_angles = 30deg\n", "g\n", "g=\n", "g 3\n", "g = 1 2\n", "g = 1, 2\n",
                     "tilts = 0,5\n", "tilts = 0 5\n", "g = 0.5 albedo = 1\n", "g == 3\n", "; g\n",
                     "resume\n", "-- = 3\n", "++ = 3\n", "--g = 3\n", ".g = 3\n",
                     'tilts = ["0"5]\n', "tilts = [0] 5\n", 'tilts = ["0"] 5\n', "tilts = 0]\n"):
            self.refused_text(text, ["scene.toml, line 4: "])

    def test_what_is_not_closed(self):
        """An open value must not lose its last number or take in the keys below."""
        for text in ("tilts = [0, 0.5", "tilts = [0, 0.5\ng = 1\n",
                     "tilts = [0, 0.5\ntilts = [1]\n", "tilts = [, 0.5]\n", "tilts = [0, , 0.5]\n",
                     "tilts = [[0, 0.5]]\n", 'index = "1.5\n', "index = '1.5"):
            self.refused_text(text, ["scene.toml, line "])

    def test_text_that_could_not_be_written_back(self):
        for text in ('index = "1.5\\n"\n', "index = '1\"5'\n"):
            self.refused_text(text, ["index", "must not contain control"])
        for value in ('a"b.csv', "a\\b.csv", "a\nb.csv"):
            self.assert_refused(["near_sensors", "must not contain control"], "covariance",
                                *flags(BOX), near_sensors=value)

    def test_unreadable(self):
        self.assert_refused(["config", "none.toml"], "covariance", *flags(BOX), config="none.toml")
        (self.folder / "folder").mkdir()
        self.assert_refused(["config", "folder"], "covariance", *flags(BOX), config="folder")

    def test_binary(self):
        with h5py.File(self.folder / "binary.toml", "w") as file:
            file["x"] = list(range(1000))
        self.assert_refused(["binary.toml", "text"], "covariance", config="binary.toml")
        for noise in (bytes(range(256)) * 40, bytes(range(128, 256)) * 40, b"\xff" * 999):
            (self.folder / "noise.toml").write_bytes(noise)
            self.assert_refused(["noise.toml"], "covariance", config="noise.toml")

    def test_an_empty_file_says_what_is_missing(self):
        self.write("empty.toml", "")
        self.assert_refused(["depth"], "covariance", config="empty.toml")


class AcceptedScenes(ProgramTest):
    """Forms of scene files that are accepted."""

    def resolved(self, text):
        self.write("scene.toml", text)
        return self.call("covariance", "--config", "scene.toml", "--print-config").stdout

    def test_comments_blank_lines_and_long_arrays(self):
        plain = toml({**BOX, **TILTS})
        decorated = plain.replace("width = 20", "# a box\n\n  width=20   # wavelengths\r")
        decorated = decorated.replace("[0, 0.04, 0.16]", "[0,\n  0.04,  # small\n  0.16]")
        self.assertEqual(self.resolved(decorated), self.resolved(plain))

    def test_blanks_around_commas_and_a_comma_at_the_end(self):
        plain = toml({**BOX, **TILTS})
        for tilts in ("[ 0 ,0.04\t, 0.16 ]", "[0, 0.04, 0.16,]",
                      "['0' , \"0.04\", 0.16\n, # last\n]"):
            with self.subTest(tilts=tilts):
                self.assertEqual(self.resolved(plain.replace("[0, 0.04, 0.16]", tilts)),
                                 self.resolved(plain))

    def test_a_hash_in_a_text(self):
        for name in ("a#b.csv", "a #b, [c] = 'd'.csv"):
            self.write(name, "x,z\n0,15\n1,15\n")
            text = self.resolved(toml({**BOX, "near_sensors": name}) + "# it's \"open\n")
            self.assertIn(f'near_sensors = "{name}"\n', text)

    def test_a_byte_order_mark(self):
        self.assertEqual(self.resolved("\ufeff" + toml(BOX)), self.resolved(toml(BOX)))

    def test_without_a_newline_at_the_end(self):
        self.assertEqual(self.resolved(toml(BOX)[:-1]), self.resolved(toml(BOX)))

    def test_shipped_scenes(self):
        former = pathlib.Path(__file__).parent / "scenes_0.2.0"  # of version 0.2.0, where they differ
        for scene in [*former.glob("*.toml"), *sorted((DATA / "scenes").glob("*.toml"))[::1 if WHOLE else 2]]:
            text = scene.read_text()
            tilts = {"slab_hg": 33, "gallery": 40, "diffusion_map": 40}.get(scene.stem)
            for subcommand in (("sweep",) if tilts else ("solve",) if "\nmap = " in text else
                               ("field",) if "\nfields = " in text else
                               ("render",) if "\nsensor = " in text else
                               ("reflectance",) if "\ndistances = " in text else
                               ("image",) if "\nobject_x = " in text else
                               ("trace",) if "\nmax_length = " in text else
                               ("design",) if "\ndesign = " in text else
                               ("covariance",) if '"hg"' in text else ("validate", "covariance")):
                with self.subTest(scene=scene.name, subcommand=subcommand):
                    pictures = [DATA / name for name in re.findall(r'"data/(pictures/[^"]+)"', text)]
                    text = self.call(subcommand, "--config", scene, "--print-config",
                                     *(["--pictures", *pictures] if pictures else [])).stdout
                    if tilts:
                        listed = text.split("tilts = ")[1].split("]")[0]
                        self.assertEqual(len(listed.split(",")), tilts)

    def test_a_flag_beats_the_file(self):
        self.write("scene.toml", toml(BOX))
        text = self.call("covariance", "--print-config", width=3, config="scene.toml").stdout
        self.assertIn("width = 3\n", text)
        self.assertNotIn("20", text)


if __name__ == "__main__":
    unittest.main()
