"""Regressions found by attacks: two runs with one result, links, closed streams, limits, signals."""

import os
import random
import resource
import signal
import subprocess
import time
import unittest

import h5py

from program import BOX, PROGRAM, RESUMES, SLAB, SLOWNESS, WHOLE, ProgramTest, cpu_of_children, flags

SHORT = {**BOX, "samples": 4000}
LONG = {**BOX, "seconds": 60, "threads": 1}
INTERLEAVINGS = 200 if WHOLE else 6
WIDE = {"covariance": "full", "view_angles": [0.1 * i for i in range(15)]}  # 45 kB of result


class Owner(ProgramTest):
    def test_one_at_a_time(self):
        for subcommand, keys in (("covariance", LONG), ("flux", {**BOX, "seconds": 60}),
                                 ("sweep", {**SLAB, "g": [0.5], "optical_depth": [2],
                                            "tilts": [0, 0.1], "seconds": 60,
                                            "target_error": 1e-7})):
            with self.subTest(subcommand=subcommand):
                process = self.start(subcommand, **keys, out="x.h5")
                self.wait_until(process, (self.folder / ".x.h5.lock").exists)
                time.sleep(0.1)
                done = self.call("covariance", **SHORT, out="x.h5", status=2)
                self.assertIn(f"out = x.h5: process {process.pid} on ", done.stderr)
                process.send_signal(signal.SIGTERM)
                self.assertEqual(process.wait(timeout=30), 75)
                self.assertFalse((self.folder / ".x.h5.lock").exists())
                self.call("covariance", **SHORT, out="x.h5")
                for path in self.folder.glob("x.h5*"):
                    subprocess.run(["rm", "-r", path], check=True)

    def test_a_lock_of_the_dead_does_not_hold(self):
        process = self.start("covariance", **LONG, out="x.h5")
        self.wait_until(process, (self.folder / ".x.h5.lock").exists)
        process.kill()
        process.wait()
        self.call("covariance", **SHORT, out="x.h5")
        self.assertEqual([path.name for path in self.folder.iterdir()], ["x.h5"])

    def test_a_file_of_others_is_set_aside(self):
        self.call("covariance", **SHORT, out="other.h5")
        process = self.start("covariance", **LONG, out="x.h5")
        self.wait_until(process, (self.folder / ".x.h5.lock").exists)
        time.sleep(0.3)
        (self.folder / "other.h5").rename(self.folder / "x.h5")
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=30), 75)
        self.assertIn("found a foreign file at x.h5", process.stderr.read())
        with h5py.File(self.folder / "x.h5.aside-1") as file:
            self.assertEqual(file.attrs["samples"], 4000)

    def test_two_runs_and_kills(self):
        """A result finished before remains, whatever ran and was killed."""
        moments = random.Random(3)
        self.call("covariance", **SHORT, seed=7, out="x.h5")
        finished = (self.folder / "x.h5").read_bytes()
        for _ in range(INTERLEAVINGS):
            processes = [self.start("covariance", **LONG, seed=seed, out="x.h5") for seed in (1, 2)]
            time.sleep(moments.uniform(0, 0.4))
            for process in moments.sample(processes, 2):
                process.send_signal(moments.choice((signal.SIGTERM, signal.SIGKILL)))
                time.sleep(moments.uniform(0, 0.02))
            for process in processes:
                process.wait(timeout=30)
            kept = [path for path in self.folder.glob("x.h5*") if path.read_bytes() == finished]
            self.assertEqual(len(kept), 1, list(self.folder.iterdir()))
            kept[0].rename(self.folder / "keep")
            for path in self.folder.glob("x.h5*"):
                path.unlink()
            (self.folder / "keep").rename(self.folder / "x.h5")


class Files(ProgramTest):
    def test_links_are_followed(self):
        (self.folder / "link.h5").symlink_to("there.h5")
        self.call("covariance", **SHORT, out="link.h5")
        self.assertTrue((self.folder / "link.h5").is_symlink())
        self.assertTrue((self.folder / "there.h5").is_file())
        (self.folder / "a.h5").symlink_to("b.h5")
        (self.folder / "b.h5").symlink_to("a.h5")
        done = self.call("covariance", **SHORT, out="a.h5", status=2)
        self.assertIn("loop of symbolic links", done.stderr)

    def test_write_protection_is_respected(self):
        self.call("covariance", **SHORT, out="x.h5")
        (self.folder / "x.h5").chmod(0o444)
        done = self.call("covariance", **SHORT, out="x.h5", status=4)
        self.assertIn("write-protected", done.stderr)

    def test_limit_on_the_size_of_files(self):
        command = [PROGRAM, "covariance", *flags({**SHORT, **WIDE, "out": "x.h5"})]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=60,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE,
                                                                    (8192, 8192)))
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertIn("File too large", done.stderr)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_loops_of_links(self):
        (self.folder / "a").symlink_to("b")
        (self.folder / "b").symlink_to("a")
        for keys in ({"structure": "a", "scatterer": "tm", "radius": 0.1, "index": 1.5},
                     {"near_sensors": "a"}):
            done = self.call("covariance", **BOX, **keys, out="x.h5", status=2)
            self.assertNotIn("filesystem error", done.stderr)
        self.call("trace", field="luneburg", rays="a", out="x.h5", status=2)

    def test_long_values_are_shortened(self):
        done = self.call("covariance", **{**BOX, "scatterer": "x" * 5000}, out="x.h5", status=2)
        self.assertLess(len(done.stderr), 500)


@unittest.skipIf(SLOWNESS > 1, "a sanitizer's shadow memory is larger than these limits")
class Memory(ProgramTest):
    def test_little_address_space(self):
        """OpenBLAS waits forever if it gets no memory."""
        for megabytes in (200, 300):
            for keys in ({**BOX, **WIDE, "samples": 4000}, {**BOX, "width": -1}):
                self.check_refused(keys, megabytes)

    def test_little_address_space_of_threads(self):
        """The OpenMP runtime ends the program if it cannot start a thread."""
        error = self.check_refused({**SHORT, "threads": 50}, 300)
        self.assertIn("threads: ulimit -v", error)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_address_space_that_two_threads_fill(self):
        """Each thread gets its BLAS buffer before another can take the memory."""
        for _ in range(12 if WHOLE else 4):
            done = self.limited("validate", dict(
                width=20, depth=10, count=31, covariance="memory_effect", tilts=[0, 0.04, 0.16],
                view_angles=[0.1, 0.5], samples=4000, wave_samples=20, threads=2), 400)
            self.assertEqual(done.returncode, 0, done.stderr)

    def check_refused(self, keys, megabytes):
        done = self.limited("covariance", keys, megabytes)
        self.assertEqual(done.returncode, 2, done.stderr)
        return done.stderr

    def limited(self, command, keys, megabytes):
        return subprocess.run(
            [PROGRAM, command, *flags({**keys, "out": "x.h5"})],
            cwd=self.folder, capture_output=True, text=True, timeout=60,
            env={**os.environ, "OMP_NUM_THREADS": "2"},
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS,
                                                  (megabytes << 20, megabytes << 20)))


class Streams(ProgramTest):
    def test_closed_ones_end_nothing(self):
        for closed in ("stdout", "stderr"):
            with self.subTest(closed=closed):
                read, write = os.pipe()
                os.close(read)
                command = [PROGRAM, "covariance", *flags({**SHORT, "out": f"{closed}.h5"})]
                done = subprocess.run(command, cwd=self.folder, timeout=60,
                                      **{"stdout": subprocess.DEVNULL,
                                         "stderr": subprocess.DEVNULL, closed: write})
                os.close(write)
                self.assertEqual(done.returncode, 0)
                self.assertTrue((self.folder / f"{closed}.h5").exists())


class Signals(ProgramTest):
    def check_ends(self, process, status, delay=0.5):
        self.wait_until_it_catches(process, RESUMES if status == 75 else signal.SIGTERM)
        time.sleep(delay)
        process.send_signal(signal.SIGTERM)
        sent = time.monotonic()
        self.assertEqual(process.wait(timeout=60), status)
        self.assertLess(time.monotonic() - sent, 2 * SLOWNESS)

    def test_what_cannot_be_resumed(self):
        for words in (("trace", "--connect", 0, 0, 0, 0.3, 0, 3, "--max_length", 5, "--trials", 10**6,
                       "--field", "parabolic", "--alpha", 0.5, "--index", 1.5),
                      ("solve", "--width", 200, "--depth", 200, "--count", 3000)):
            with self.subTest(words=words[0]):
                process = self.start(*map(str, words), out="x.h5")
                self.check_ends(process, 130)
                self.assertEqual(list(self.folder.iterdir()), [])

    def test_a_limit_on_processor_time(self):
        command = [PROGRAM, "covariance", *flags({**LONG, "out": "x.h5"})]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=60,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (1, 20)))
        self.assertEqual(done.returncode, 75, done.stderr)
        self.assertEqual([path.name for path in self.folder.iterdir()], ["x.h5"])

    def test_long_batches(self):
        """A path in a thick, narrow box takes seconds, and so does transport in a slab."""
        for keys in ({"width": 4, "depth": 20, "scatterer": "hg", "optical_depth": 3000},
                     {"width": 100, "depth": 20, "scatterer": "hg", "optical_depth": 1e4},
                     {**SLAB, "g": 0.9997, "optical_depth": 10}):
            with self.subTest(keys=keys):
                process = self.start("covariance", **keys, view_angles=[0], threads=1, out="x.h5",
                                     **({} if "domain" in keys else {"samples": 10**7}))
                self.check_ends(process, 75, 1 if WHOLE else 0.3)

    def test_paths_without_end_are_refused(self):
        for optical_depth in (1e5, 1e9, 1e30):
            for subcommand in ("covariance", "flux"):
                done = self.call(subcommand, width=100, depth=20, scatterer="hg", out="x.h5",
                                 optical_depth=optical_depth, status=2)
                self.assertIn("optical_depth", done.stderr)

    def test_seconds_are_kept(self):
        """Covers a thick box, and a narrow one in which walkers would multiply without end."""
        for keys in ({"width": 100, "depth": 20, "scatterer": "hg", "optical_depth": 1000},
                     {"width": 0.01, "depth": 10, "count": 31}):
            with self.subTest(keys=keys):
                began = cpu_of_children()
                self.call("covariance", **keys, view_angles=[0.3], seconds=0.1, threads=1,
                          out="x.h5")
                self.assertLess(cpu_of_children() - began, 2.2 * SLOWNESS)


if __name__ == "__main__":
    unittest.main()
