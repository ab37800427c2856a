"""Soak test: a covariance run of --seconds on a small disk that a neighbour fills and empties, interrupted,
killed and resumed at random. What was saved stays, and the result equals that of an undisturbed run
bit for bit."""

import argparse
import contextlib
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time

from mounts import go_where_mounts_are_allowed, mounts_allowed
from program import BOX, PROGRAM, RESUMES, attributes, datasets, flags
from torture_run import wait_until_it_catches

KEYS = {**BOX, "covariance": "full", "view_angles": [0.1 * i for i in range(15)], "threads": 1}
DISK_KIB = 8000
SKIPPED = 77


def start(folder, **more):
    command = [PROGRAM, "covariance", *flags({**KEYS, **more, "out": "x.h5"})]
    return subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                            text=True)


def samples_per_second(folder):
    start(folder, seconds=2).communicate(timeout=60)
    made = attributes(folder / "x.h5")
    return made["samples"] / made["wall_s"]


class Neighbour(threading.Thread):
    """Fills the disk except for some bytes, or empties it, for up to half a second each."""

    def __init__(self, folder):
        super().__init__(daemon=True)
        self.file, self.over = folder / "filler", threading.Event()
        self.random = random.Random(1)

    def run(self):
        while not self.over.wait(self.random.uniform(0, 0.5)):
            self.fill(self.random.choice([0, 0, 4096, 100_000, 1_000_000]))
            self.over.wait(self.random.uniform(0, 0.5))
            self.file.unlink()

    def fill(self, left):
        with open(self.file, "wb", buffering=0) as file, contextlib.suppress(OSError):
            while True:
                file.write(b"\0" * 4096)
        os.truncate(self.file, max(0, self.file.stat().st_size - left))


class Soak:
    def __init__(self, folder, samples, seconds):
        self.folder, self.samples, self.seconds = folder, samples, seconds
        self.random = random.Random(2)
        self.saved = 0
        self.statuses = {}

    def go_on(self):
        """Runs the program until it ends or is stopped. Returns its exit status."""
        process = start(self.folder, samples=self.samples, resume=True)
        wait_until_it_catches(process, RESUMES)
        try:
            process.wait(timeout=self.random.expovariate(40 / self.seconds))
        except subprocess.TimeoutExpired:
            process.send_signal(self.random.choice([signal.SIGTERM] * 5 + [signal.SIGKILL]))
        error = process.communicate(timeout=60)[1]
        self.check(process.returncode, error)
        return process.returncode

    def check(self, status, error):
        self.statuses[status] = self.statuses.get(status, 0) + 1
        if status not in (0, 4, 75, 130, -signal.SIGKILL):
            sys.exit(f"status {status}: {error}")
        if status == 4 and "No space left" not in error:
            sys.exit(f"status 4: {error}")
        path = self.folder / "x.h5"
        saved = attributes(path)["samples"] if path.exists() else 0
        if saved < self.saved or (status == 75 and saved == 0):
            sys.exit(f"of {self.saved:g} samples {saved:g} are left, status {status}: {error}")
        self.saved = saved


def same(first, second):
    first, second = datasets(first), datasets(second)
    return first.keys() == second.keys() and \
        all(first[name].tobytes() == second[name].tobytes() for name in first)


def disturb(soaked, neighbour):
    """Disturbs the run to its end; the neighbour stops when the time is over."""
    began = time.monotonic()
    neighbour.start()
    while soaked.go_on() != 0:
        if time.monotonic() - began > soaked.seconds:
            neighbour.over.set()
    neighbour.over.set()
    neighbour.join()
    print(f"{soaked.samples:g} samples in {time.monotonic() - began:.0f} s; times of each status: "
          f"{soaked.statuses}", flush=True)


def soak(seconds, disk, elsewhere):
    soaked = Soak(disk, int(0.4 * seconds * samples_per_second(elsewhere)), seconds)
    undisturbed = start(elsewhere, samples=soaked.samples)
    try:
        disturb(soaked, Neighbour(disk))
        error = undisturbed.communicate(timeout=10 * seconds)[1]
    finally:
        undisturbed.kill()
    if undisturbed.returncode != 0:
        sys.exit(f"the undisturbed run ended with {undisturbed.returncode}: {error}")
    left = {path.name for path in disk.iterdir() if not
            (path.name.startswith(".x.h5.tmp-") and -signal.SIGKILL in soaked.statuses)}
    if left != {"x.h5"}:
        sys.exit(f"left: {left}")
    if not same(disk / "x.h5", elsewhere / "x.h5"):
        sys.exit("differs from an undisturbed run")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60)
    seconds = parser.parse_args().seconds
    if not mounts_allowed():
        sys.exit(SKIPPED)
    with tempfile.TemporaryDirectory() as disk, tempfile.TemporaryDirectory() as elsewhere:
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={DISK_KIB}k", "tmpfs", disk],
                       check=True)
        try:
            soak(seconds, pathlib.Path(disk), pathlib.Path(elsewhere))
        finally:
            subprocess.run(["umount", "--lazy", disk], check=True)


if __name__ == "__main__":
    go_where_mounts_are_allowed()
    main()
