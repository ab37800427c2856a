"""Sweeps whose disk becomes full, read-only or vanishes: one clear line, status 4, nothing lost."""

import contextlib
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

from mounts import go_where_mounts_are_allowed, mounts_allowed
from sweeps import MANY, SLOW, SWEEP, SweepTest

# About a second of one thread.
STEADY = {**MANY, "samples": 15_000}


class DiskTest(SweepTest):
    """Base of tests with a separate disk, whose size each test sets."""

    def setUp(self):
        super().setUp()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.aside = pathlib.Path(folder.name)

    def mount(self, size, folder=None):
        """Mounts a disk of `size` KiB there."""
        folder = folder or self.folder
        if not mounts_allowed():
            self.skipTest("mounting is not allowed here")
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}k", "tmpfs", folder], check=True)
        self.addCleanup(subprocess.run, ["umount", "--lazy", folder], check=True)

    def remount(self, option, folder=None):
        """Retries until no file is open for writing."""
        for _ in range(1000):
            if subprocess.run(["mount", "-o", f"remount,{option}", folder or self.folder],
                              capture_output=True).returncode == 0:
                return
            time.sleep(0.001)
        self.fail(f"remount,{option}")

    def fill(self, left=0):
        """Fills the disk except for `left` bytes."""
        with open(self.folder / "filler", "wb", buffering=0) as file, \
                contextlib.suppress(OSError):
            while True:
                file.write(b"\0" * 4096)
        size = (self.folder / "filler").stat().st_size
        os.truncate(self.folder / "filler", max(0, size - left))

    def check_stopped(self, process, *words):
        """Checks status 4, one line, and no result."""
        error = process.communicate(timeout=60)[1]
        self.assertEqual(process.returncode, 4, error)
        self.assert_one_line(error, *words)
        self.assertFalse((self.folder / "sweep.h5").exists())

    def check_goes_on(self, keys, kept=None):
        """Checks that finished points are unchanged and that the result equals an undisturbed one."""
        if kept is not None:
            self.assertEqual(self.finished(), kept)
            self.call("sweep", "--resume", **keys, shard="0/1", out="sweep.h5")
            self.assertLessEqual(kept.items(), self.finished().items())
        done = self.call("sweep", "--resume", **keys, out="sweep.h5")
        self.assertNotIn("warning", done.stderr)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["sweep.h5"])
        self.whole(keys, self.aside / "whole.h5")
        self.assert_same_data("sweep.h5", self.aside / "whole.h5")


class Full(DiskTest):
    def test_while_points_end(self):
        self.mount(12)
        self.check_stopped(self.start("sweep", **MANY, out="sweep.h5"), "No space left", ".shards/")
        kept = self.finished()
        self.assertGreater(len(kept), 5)
        self.assertLess(len(kept), 40)
        self.assertFalse(self.unfinished())
        self.check_stopped(self.start("sweep", "--resume", **MANY, out="sweep.h5"), "No space left")
        self.remount("size=4m")
        self.check_goes_on(MANY, {**kept, **self.finished()})

    def test_while_unfinished_points_are_saved(self):
        self.mount(2000)
        process = self.start("sweep", **SLOW, out="sweep.h5")
        self.wait_until(process, lambda: self.finished())
        process.send_signal(signal.SIGSTOP)
        self.fill()
        process.send_signal(signal.SIGINT)
        process.send_signal(signal.SIGCONT)
        self.check_stopped(process, "No space left", ".part")
        kept = self.finished()
        (self.folder / "filler").unlink()
        self.check_goes_on(SLOW, kept)

    def test_while_the_result_is_written(self):
        self.mount(2000)
        self.all_points(SWEEP)
        kept, before = self.finished(), self.shards()
        for left in (0, 4096, 20480):
            self.fill(left)
            process = self.start("sweep", "--resume", **SWEEP, out="sweep.h5")
            self.check_stopped(process, "No space left", "sweep.h5")
            self.assertEqual(self.shards(), before)
            self.check_stopped(self.start("merge", out="sweep.h5"), "No space left", "sweep.h5")
            self.assertEqual(self.shards(), before)
        (self.folder / "filler").unlink()
        self.check_goes_on(SWEEP, kept)

    def test_from_the_beginning(self):
        self.mount(100)
        self.fill()
        self.check_stopped(self.start("sweep", **SWEEP, out="sweep.h5"), "No space left")
        (self.folder / "filler").unlink()
        self.remount("size=4m")
        self.check_goes_on(SWEEP)

    def test_an_older_result_stays(self):
        self.mount(2000)
        self.call("sweep", **SWEEP, seed=2, out="sweep.h5")
        older = (self.folder / "sweep.h5").read_bytes()
        self.all_points(SWEEP)
        self.fill(20480)
        self.call("sweep", "--resume", **SWEEP, out="sweep.h5", status=4)
        self.assertEqual((self.folder / "sweep.h5").read_bytes(), older)
        (self.folder / "filler").unlink()
        self.check_goes_on(SWEEP)


class ReadOnly(DiskTest):
    def test_from_the_beginning(self):
        self.mount(2000)
        self.call("sweep", **SWEEP, shard="0/2", out="sweep.h5")
        kept = self.finished()
        self.remount("ro")
        for words in (["sweep"], ["sweep", "--resume"]):
            self.check_stopped(self.start(*words, **SWEEP, out="sweep.h5"), "Read-only", "sweep.h5")
        self.check_stopped(self.start("merge", out="sweep.h5"), "Read-only", "sweep.h5")
        self.remount("rw")
        self.check_goes_on(SWEEP, kept)

    def test_the_folder_of_points_alone(self):
        """All points are finished: `merge`, which only reads them, makes the result."""
        self.all_points(SWEEP)
        self.points().rename(self.folder / "points")
        self.points().mkdir()
        self.mount(2000, self.points())
        for path in (self.folder / "points").iterdir():
            shutil.copy(path, self.points())
        shutil.rmtree(self.folder / "points")
        self.remount("ro", self.points())
        done = self.call("sweep", "--resume", **SWEEP, out="sweep.h5", status=4)
        self.assert_one_line(done.stderr, "sweep.h5.shards", "Read-only")
        self.call("merge", out="sweep.h5")
        self.whole(SWEEP, self.aside / "whole.h5")
        self.assert_same_data("sweep.h5", self.aside / "whole.h5")


class Vanished(DiskTest):
    def begin(self):
        process = self.start("sweep", **STEADY, out="sweep.h5")
        self.wait_until(process, lambda: len(self.finished()) > 3)
        return process

    def test_folder_of_points(self):
        """The journal is open, so the sweep ends undisturbed."""
        process = self.begin()
        self.points().rename(self.aside / "points")
        self.assertEqual(process.wait(timeout=60), 0, process.stderr.read())
        self.whole(STEADY, self.aside / "whole.h5")
        self.assert_same_data("sweep.h5", self.aside / "whole.h5")

    def test_folder_of_the_result(self):
        place = self.folder / "place"
        place.mkdir()
        process = self.start("sweep", **STEADY, out="place/sweep.h5")
        self.wait_until(process, lambda: len(self.finished("place/sweep.h5")) > 3)
        place.rename(self.folder / "elsewhere")
        self.check_stopped(process, "place/", "No such file")
        for path in (self.folder / "elsewhere").iterdir():
            path.rename(self.folder / path.name)
        (self.folder / "elsewhere").rmdir()
        self.check_goes_on(STEADY, self.finished())

    def test_at_an_interrupt(self):
        process = self.begin()
        process.send_signal(signal.SIGSTOP)
        self.points().rename(self.aside / "points")
        process.send_signal(signal.SIGINT)
        process.send_signal(signal.SIGCONT)
        self.check_stopped(process, ".shards/", "No such file")
        self.check_goes_on(STEADY)


if __name__ == "__main__":
    go_where_mounts_are_allowed()
    unittest.main()
