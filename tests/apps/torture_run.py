"""Runs one process of the program under limits, environment, streams and signals, and returns how it
ended."""

import contextlib
import dataclasses
import os
import shlex
import signal
import subprocess
import tempfile
import time

from program import PROGRAM, SLOWNESS, catches

MOST_S = 20 * SLOWNESS  # for scenes of hundredths of a second
OBEYS_S = 2 * SLOWNESS
# Protects the machine; a program with sanitizers reserves more memory than there is.
GUARD = ("--fsize=1000000000", "--core=0") + (("--as=8000000000",) if SLOWNESS == 1 else ())


@dataclasses.dataclass(frozen=True)
class Hindrance:
    """Obstacles to a process; none by default."""
    limits: tuple = ()  # options of prlimit
    environment: tuple = ()  # words of env
    redirections: str = ""  # shell redirections
    reader_goes_s: float | None = None  # time at which the pipe of stdout and stderr is closed
    signals: tuple = ()  # (seconds since it could catch one, or since the last one, number)
    patience_s: float | None = None  # time after which it is stopped; None: it must end by itself


@dataclasses.dataclass(frozen=True)
class Ended:
    status: int | None  # None: it did not end, and was killed
    stderr: str
    sent: tuple  # numbers of signals
    obeyed_s: float  # from the first signal to the end
    command: str

    @property
    def was_killed(self):
        return signal.SIGKILL in self.sent or self.status in (None, -signal.SIGKILL)

    @property
    def was_cut(self):
        """Returns whether it had no time to clean up."""
        return self.was_killed or (len(self.sent) > 1 and self.status in (-self.sent[-1], 130))


def command_of(words, hindrance):
    command = ["prlimit", *GUARD, *hindrance.limits, PROGRAM, *words]
    if hindrance.redirections:
        command = ["sh", "-c", f'exec "$@" {hindrance.redirections}', "sh", *command]
    return ["env", *hindrance.environment, *command] if hindrance.environment else command


def ends_within(process, seconds):
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(timeout=max(0, seconds))
    return process.poll() is not None


def wait_until_it_catches(process, number):
    deadline = time.monotonic() + MOST_S
    while process.poll() is None and not catches(process, number) and time.monotonic() < deadline:
        time.sleep(0.001)


def send_signals(process, hindrance):
    """Sends signals; returns [(number, time)] of those sent before its end."""
    sent = []
    for delay, number in hindrance.signals:
        if not sent and number != signal.SIGKILL:
            wait_until_it_catches(process, number)
        if ends_within(process, delay):
            return sent
        sent.append((number, time.monotonic()))
        process.send_signal(number)
    if hindrance.patience_s and not ends_within(process, hindrance.patience_s):
        sent.append((signal.SIGTERM, time.monotonic()))
        process.send_signal(signal.SIGTERM)
    return sent


def accompany(process, hindrance):
    """Follows it to its end; returns (status, numbers of the signals sent, seconds since the first)."""
    try:
        sent = send_signals(process, hindrance)
        status = process.returncode if ends_within(process, MOST_S) else None
        first = sent[0][1] if sent else time.monotonic()
        return status, tuple(number for number, _ in sent), time.monotonic() - first
    finally:
        process.kill()
        process.wait()


def start(command, folder, output, errors):
    return subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=output,
                            stderr=errors)


def start_with_reader_that_goes(command, folder, seconds):
    read, write = os.pipe()
    process = start(command, folder, write, write)
    os.close(write)
    time.sleep(seconds)
    os.close(read)
    return process


def run(folder, words, hindrance=Hindrance()):
    command = command_of(words, hindrance)
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
        if hindrance.reader_goes_s is None:
            process = start(command, folder, output, errors)
        else:
            process = start_with_reader_that_goes(command, folder, hindrance.reader_goes_s)
        status, sent, obeyed_s = accompany(process, hindrance)
        errors.seek(0)
        return Ended(status, errors.read().decode(errors="replace"), sent, obeyed_s,
                     shlex.join(command))
