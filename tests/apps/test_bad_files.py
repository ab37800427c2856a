"""Result files that cannot be written or resumed: status 2, one line, nothing changed."""

import unittest

import h5py

from program import BOX, flags
from refusing import COMMANDS, RefusingTest


class Output(RefusingTest):
    def test_out_that_cannot_be_written(self):
        self.write("file", "a regular file")
        (self.folder / "folder").mkdir()
        for subcommand, scene in COMMANDS.items():
            for out in ("none/result.h5", "file/result.h5", "/proc/result.h5", "/dev/null/result.h5",
                        "folder", "folder/", "/dev/null", "n" * 300 + ".h5"):
                with self.subTest(subcommand=subcommand, out=out):
                    self.assert_refused([out], subcommand, *flags(scene), out=out)

    def test_out_missing(self):
        for subcommand, scene in COMMANDS.items():
            with self.subTest(subcommand=subcommand):
                self.assert_refused(["out", "--out"], subcommand, *flags(scene), out=None)
                self.assert_refused(["out"], subcommand, *flags(scene), "--out", out=None)
                self.assert_refused(["out"], subcommand, *flags(scene), "--out=", out=None)

    def test_out_is_a_file_of_another_kind(self):
        self.write("mine.txt", "precious")
        for subcommand, scene in COMMANDS.items():
            self.assert_refused(["mine.txt", "not a result"], subcommand, *flags(scene),
                                out="mine.txt")

    def test_out_before_a_scene_that_is_wrong(self):
        self.assert_refused(["width"], "covariance", *flags({**BOX, "width": -3}))


class Resume(RefusingTest):
    KEYS = {**BOX, "samples": 3000, "resume": True}

    def test_what_is_no_run(self):
        self.write("text.h5", "not HDF5")
        self.refused_resume("text.h5", ["text.h5"])
        with h5py.File(self.folder / "other.h5", "w") as file:
            file["x"] = 1.0
        self.refused_resume("other.h5", ["other.h5", "never contained a run"])
        (self.folder / "empty.h5").write_bytes(b"")
        self.refused_resume("empty.h5", ["empty.h5"])

    def test_another_run(self):
        self.call("covariance", **{**self.KEYS, "seed": 2, "target_error": 1e-6}, out="run.h5",
                  status=3)
        self.refused_resume("run.h5", ["run.h5", "another run", "seed = 2"])

    def test_a_truncated_run(self):
        self.call("covariance", **self.KEYS, target_error=1e-6, out="run.h5", status=3)
        whole = (self.folder / "run.h5").read_bytes()
        for size in (len(whole) - 1, len(whole) // 2, 100):
            with self.subTest(size=size):
                (self.folder / "run.h5").write_bytes(whole[:size])
                self.refused_resume("run.h5", ["run.h5"])

    def test_a_damaged_run(self):
        """Damages every place: HDF5 itself may crash on it."""
        self.call("covariance", **self.KEYS, target_error=1e-6, out="run.h5", status=3)
        whole = (self.folder / "run.h5").read_bytes()
        for place in range(0, len(whole), len(whole) // 20):
            with self.subTest(place=place):
                damaged = bytearray(whole)
                damaged[place] ^= 1
                (self.folder / "run.h5").write_bytes(damaged)
                self.refused_resume("run.h5", ["run.h5", "damaged"])

    def refused_resume(self, name, words):
        before = self.listing()
        done = self.call("covariance", **self.KEYS, out=name, status=2)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)
        self.assertEqual(self.listing(), before)


if __name__ == "__main__":
    unittest.main()
