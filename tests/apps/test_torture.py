"""torture.py reports no failure in two seconds, and its checks detect programs that misbehave."""

import pathlib
import signal
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

import h5py

from program import BOX, PROGRAM, ProgramTest
from torture_case import Case
from torture_library import Library
from torture_run import Hindrance
from torture_scenes import OLDER

TORTURE = pathlib.Path(__file__).with_name("torture.py")
REFUSED = {**BOX, "width": -3}
# (what a script does after the program, its keys, the complaint)
MISBEHAVIOURS = [
    ("status=1", REFUSED, "status 1"),
    ("kill -SEGV $$", OLDER, "status -11"),
    ("echo more >&2", REFUSED, "2 lines for a refusal"),
    ("printf %600s . >&2", REFUSED, "642 letters for a refusal"),
    ("rm x.h5", REFUSED, "x.h5 is lost"),
    ("echo >>x.h5", REFUSED, "x.h5 is changed"),
    ("echo 0,14 >>sensors.csv", OLDER, "sensors.csv is changed"),
    ("touch .x.h5.tmp-1", OLDER, "left .x.h5.tmp-1"),
    ("touch y", OLDER, "left y"),
    ("rm x.h5", OLDER, "no x.h5"),
    ("cp stopped.h5 x.h5; status=75", OLDER, "x.h5 is changed"),
    ("cp structure.h5 x.h5", OLDER, "x.h5 differs from an undisturbed run"),
    ("cp infinite.h5 x.h5", OLDER, "x.h5: excess is not finite"),
    ("echo x >x.h5", OLDER, "x.h5: Unable to open file"),
]


class Torture(ProgramTest):
    def test_nothing_is_found(self):
        done = subprocess.run([sys.executable, "-B", TORTURE, "--runs", "500", "--seconds", "2"],
                              capture_output=True, text=True, timeout=550)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


class Checks(ProgramTest):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.library = Library(pathlib.Path(folder.name))
        with h5py.File(cls.library.files / "infinite.h5", "w") as file:
            file["excess"] = [1, float("inf")]
        cls.whole = cls.library.whole("covariance", OLDER)

    def complaints(self, script, keys, hindrance=Hindrance()):
        """Returns the complaints about this script, with an older result in place."""
        program = self.write("program", f"#!/bin/sh\n{script}\n")
        program.chmod(0o755)
        case = Case(self.library, tempfile.mkdtemp(dir=self.folder), 1, 1)
        (case.folder / "older.h5").rename(case.folder / "x.h5")
        with mock.patch("torture_run.PROGRAM", str(program)):
            case.run("covariance", keys, hindrance, whole=self.whole)
        return [what for what, _ in case.failures]

    def test_misbehaviour_is_found(self):
        run = f'"{PROGRAM}" "$@"\nstatus=$?\n'
        for keys in (REFUSED, OLDER):
            self.assertEqual(self.complaints(f"{run}exit $status", keys), [])
        for does, keys, told in MISBEHAVIOURS:
            with self.subTest(does=does, told=told):
                found = self.complaints(f"{run}{does}\nexit $status", keys)
                self.assertTrue(any(what.startswith(told) for what in found), found)

    def test_deafness_is_found(self):
        with mock.patch("torture_checks.OBEYS_S", 1):
            told, = self.complaints("trap : TERM; sleep 2; exit 75", OLDER,
                                    Hindrance(signals=((0, signal.SIGTERM),)))
        self.assertRegex(told, r"ended \d\.\d s after a signal")

    def test_a_hang_is_found(self):
        with mock.patch("torture_run.MOST_S", 0.5):
            told, = self.complaints("exec sleep 9", OLDER)
        self.assertIn("did not end", told)


if __name__ == "__main__":
    unittest.main()
