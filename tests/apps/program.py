"""Runs the program under test: FLATSPECKLE is its path, FLATSPECKLE_DATA the folder data/."""

import contextlib
import os
import pathlib
import resource
import signal
import subprocess
import tempfile
import time
import unittest

import h5py
import numpy as np

PROGRAM = os.environ["FLATSPECKLE"]
DATA = pathlib.Path(os.environ["FLATSPECKLE_DATA"])

BOX = {"width": 20, "depth": 10, "count": 31}
CYLINDERS = {"width": 20, "depth": 10, "count": 20, "scatterer": "tm", "radius": 0.16}
SLAB = {"domain": "slab", "depth": 100, "scatterer": "hg", "optical_depth": 2, "g": 0.5}
SLOWNESS = float(os.environ.get("FLATSPECKLE_SLOWNESS", 1))  # above 1 with sanitizers
LLVM_OPENMP = "libomp" in subprocess.run(["ldd", PROGRAM], capture_output=True, text=True).stdout
MOST_USER_S = 0.3 * SLOWNESS  # bad input is rejected before anything is computed
WHOLE = "FLATSPECKLE_TEST_WHOLE" in os.environ  # by night: all tests at their full sizes
RESUMES = signal.SIGUSR1  # caught once a run can be interrupted and resumed; others ignore it
SAMPLES, ERRORS = (1, 1) if WHOLE else (0.25, 2)  # long runs: a quarter of their samples, twice their errors by day
nightly = unittest.skipUnless(WHOLE, "takes minutes: run by night")
TILTS = {"covariance": "memory_effect", "tilts": [0, 0.04, 0.16], "view_angles": [0.1, 0.5]}


def flags(keys):
    """Returns {"tilts": [0, 0.1], "resume": True} as --tilts 0 0.1 --resume; None leaves a key out."""
    words = []
    for key, value in keys.items():
        if value is None or value is False:
            continue
        words.append(f"--{key}")
        if value is not True:
            words += [str(item) for item in (value if isinstance(value, list) else [value])]
    return words


def toml(keys):
    """Returns keys as a scene file."""

    def show(value):
        if isinstance(value, bool):
            return str(value).lower()
        if isinstance(value, list):
            return "[" + ", ".join(show(item) for item in value) + "]"
        return f'"{value}"' if isinstance(value, str) else repr(value)

    return "".join(f"{key} = {show(value)}\n" for key, value in keys.items() if value is not None)


def datasets(path, leave_out=("wall_s", "cpu_s", "trace_cpu_s", "state")):
    """Returns every dataset of a result file by its full name, without names that have a part in leave_out:
    times differ from run to run."""
    found = {}

    def add(name, item):
        if isinstance(item, h5py.Dataset) and not set(name.split("/")) & set(leave_out):
            found[name] = item[()]

    with h5py.File(path) as file:
        file.visititems(add)
    return found


def bits_of(values):
    """Returns the bits of numbers, and texts unchanged."""
    values = np.asarray(values)
    return values.tolist() if values.dtype == object else values.tobytes()


def attributes(path):
    with h5py.File(path) as file:
        return dict(file.attrs)


def cpu_of_children():
    """Returns the CPU seconds of the processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def user_seconds_of_children():
    """Returns the user CPU seconds of the processes that have ended, without the system's time to load them."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime


def user_seconds(process):
    """Returns the user CPU seconds of a running process."""
    with open(f"/proc/{process.pid}/stat") as status:
        return int(status.read().rsplit(")", 1)[1].split()[11]) / os.sysconf("SC_CLK_TCK")


def catches(process, number):
    """Returns whether the process has a handler for this signal."""
    with open(f"/proc/{process.pid}/status") as status:
        caught = next(line for line in status if line.startswith("SigCgt"))
    return int(caught.split()[1], 16) >> (number - 1) & 1


class ProgramTest(unittest.TestCase):
    """Base of tests that run the program, each in a folder of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def call(self, *words, status=0, **keys):
        """Runs the program with words, then keys as flags, and checks its exit status and that rejections (2)
        are quick."""
        command = [PROGRAM, *map(str, words), *flags(keys)]
        before = user_seconds_of_children()
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=600)
        self.assertEqual(done.returncode, status, f"{command}\n{done.stdout}{done.stderr}")
        if status == 2:
            self.assertLess(user_seconds_of_children() - before, MOST_USER_S,
                            f"{command}\n{done.stderr}")
        return done

    def seconds_of(self, *words, **keys):
        """Returns the seconds that a call takes."""
        started = time.monotonic()
        self.call(*words, **keys)
        return time.monotonic() - started

    def start(self, *words, **keys):
        """Starts the program without waiting for it; it is stopped at the latest when the test ends."""
        process = subprocess.Popen([PROGRAM, *map(str, words), *flags(keys)], cwd=self.folder,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.end, process)
        return process

    @staticmethod
    def end(process):
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        process.wait()
        process.stderr.close()

    def wait_until(self, process, condition):
        """Waits until the condition holds, while the process runs."""
        deadline = time.monotonic() + 60
        while not condition():
            time.sleep(0.002)
            self.assertIsNone(process.poll(), "it ended before")
            self.assertLess(time.monotonic(), deadline)

    def wait_until_it_catches(self, process, number=RESUMES):
        self.wait_until(process, lambda: catches(process, number))

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def write_older_result(self, name):
        """Writes a file that passes for a result as long as the program does not read it."""
        (self.folder / name).write_bytes(b"\x89HDF\r\n\x1a\n of an older run")

    def listing(self):
        """Returns the files of the folder, hidden ones included, with contents and time of change."""
        return {path.name: (path.stat().st_mtime_ns, path.read_bytes())
                for path in self.folder.iterdir() if path.is_file()}

    def assert_same_data(self, first, second):
        """Checks that both have the same datasets, bit for bit."""
        first, second = datasets(self.folder / first), datasets(self.folder / second)
        self.assertEqual(first.keys(), second.keys())
        self.assertTrue(first)
        for name, values in first.items():
            self.assertEqual(bits_of(values), bits_of(second[name]), name)
