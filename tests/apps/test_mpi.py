"""Sweeps over several processes: FLATSPECKLE_MPIRUN is the launcher of MPI."""

import os
import signal
import subprocess
import time
import unittest

import journals
from program import PROGRAM, SLAB, WHOLE, attributes, flags
from sweeps import SweepTest

MPIRUN = os.environ["FLATSPECKLE_MPIRUN"]
# Open MPI requires permission to run as root, and with more processes than cores.
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1"}

SWEEP = {"depth": 100, "optical_depth": [2, 5], "g": [0, 0.5], "albedo": [1, 0.9],
         "tilts": [0, 0.001, 0.002, 0.004]}
LONG = {**SWEEP, "samples": 150_000}


class Mpi(SweepTest):
    def launch(self, ranks, *words, **keys):
        """Starts `ranks` processes of the program, in a group of their own."""
        command = [MPIRUN, "-n", str(ranks), PROGRAM, *words, *flags(keys)]
        process = subprocess.Popen(command, cwd=self.folder, env=ENVIRONMENT, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   start_new_session=True)
        self.addCleanup(self.end_group, process)
        return process

    @staticmethod
    def end_group(process):
        try:
            os.killpg(process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        process.communicate()

    def run_ranks(self, ranks, *words, status=0, **keys):
        process = self.launch(ranks, *words, **keys)
        stdout, stderr = process.communicate(timeout=300)
        self.assertEqual(process.returncode, status, stdout + stderr)
        return stdout, stderr

    def members(self, process):
        """Returns the processes of the program in this launch, rank 0 first."""
        found = {}
        for entry in os.listdir("/proc"):
            if not entry.isdigit():
                continue
            try:
                with open(f"/proc/{entry}/environ", "rb") as file:
                    environment = dict(word.split(b"=", 1) for word in file.read().split(b"\0")
                                       if b"=" in word)
                target = os.readlink(f"/proc/{entry}/exe")
                with open(f"/proc/{entry}/stat") as file:
                    parent = int(file.read().rsplit(")", 1)[1].split()[1])
            except OSError:
                continue
            if parent == process.pid and os.path.samefile(target, PROGRAM):
                found[int(environment[b"OMPI_COMM_WORLD_RANK"])] = int(entry)
        return [found[rank] for rank in sorted(found)]

    def wait_for_a_point(self, process):
        """Waits until the first point is finished; returns the folder of points."""
        shards = self.folder / "run.h5.shards"
        deadline = time.monotonic() + 60
        while not journals.points_in(shards):
            self.assertIsNone(process.poll())
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.002)
        return shards

    def test_ranks_do_not_change_the_numbers(self):
        for stop in ({"samples": 20_000}, {"target_error": 0.01}):
            self.call("sweep", **SWEEP, **stop, threads=2, out="alone.h5")
            for ranks in (1, 2, 4) if WHOLE else (4,) if "samples" in stop else (2,):
                self.run_ranks(ranks, "sweep", **SWEEP, **stop, threads=2, out=f"{ranks}.h5")
                self.assert_same_data(f"{ranks}.h5", "alone.h5")
                self.assertEqual(attributes(self.folder / f"{ranks}.h5")["ranks"], ranks)

    def test_cores_are_not_given_out_twice(self):
        self.run_ranks(3, "sweep", **SWEEP, samples=2000, out="run.h5")
        shared = len(os.sched_getaffinity(0))
        self.assertLessEqual(attributes(self.folder / "run.h5")["threads"], max(1, shared // 3))

    def test_a_rank_that_is_killed_ends_the_job(self):
        self.whole(LONG)
        for victim in (0, 1, 2) if WHOLE else (2,):
            with self.subTest(rank=victim):
                process = self.launch(3, "sweep", **LONG, threads=1, out="run.h5")
                shards = self.wait_for_a_point(process)
                os.kill(self.members(process)[victim], signal.SIGKILL)
                _, stderr = process.communicate(timeout=60)
                self.assertNotEqual(process.returncode, 0)
                self.assertIn("signal 9", stderr)
                self.assertTrue(journals.points_in(shards))
                self.assertFalse((self.folder / "run.h5").exists())
                self.run_ranks(2, "sweep", "--resume", **LONG, threads=1, out="run.h5")
                self.assert_same_data("run.h5", "whole.h5")
                (self.folder / "run.h5").unlink()

    def test_an_interrupt_is_resumable(self):
        process = self.launch(2, "sweep", **LONG, threads=1, out="run.h5")
        self.wait_for_a_point(process)
        os.kill(self.members(process)[0], signal.SIGTERM)
        stdout, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 75)
        self.assertIn("--resume", stdout)
        self.run_ranks(3, "sweep", "--resume", **LONG, threads=1, out="run.h5")
        self.whole(LONG)
        self.assert_same_data("run.h5", "whole.h5")

    def test_faults_are_told_once(self):
        _, stderr = self.run_ranks(3, "sweep", **{**SWEEP, "g": [2]}, out="run.h5", status=2)
        self.assertEqual(stderr.count("g = 2"), 1)
        _, stderr = self.run_ranks(3, "covariance", **SLAB, out="run.h5", status=2)
        self.assertEqual(stderr.count("must run as one process"), 1)

    def test_a_fault_of_rank_0_alone_ends_all(self):
        self.write("run.h5.shards", "in the way")
        _, stderr = self.run_ranks(3, "sweep", **SWEEP, samples=2000, out="run.h5", status=4)
        self.assertEqual(stderr.count("cannot make the folder"), 1)


if __name__ == "__main__":
    unittest.main()
