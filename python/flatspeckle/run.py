"""Runs the program, shows its progress, forwards interrupts, and returns its exit status."""

import contextlib
import os
import pty
import signal
import subprocess
import sys
import tempfile

DONE, BAD_INPUT, TARGET_MISSED, FAILED = 0, 2, 3, 4
INTERRUPTED = (75, 130)


def shows_progress(wanted):
    """Whether to show progress; by default on terminals and in notebooks."""
    if wanted is not None:
        return wanted
    return sys.stderr is not None and (sys.stderr.isatty() or "ipykernel" in sys.modules)


def chunks(end):
    """Yields the output of a pipe or terminal until the program closes it, which may raise OSError."""
    with contextlib.suppress(OSError):
        while chunk := os.read(end, 65536):
            yield chunk.replace(b"\r\n", b"\n")


def listen(end, progress):
    """Returns all output on standard error. Shows progress, but not error lines, which become the message of an
    exception."""
    said = b""
    for chunk in chunks(end):
        said += chunk
        if progress and not chunk.startswith(b"flatspeckle: "):
            sys.stderr.write(chunk.decode(errors="replace"))
            sys.stderr.flush()
    return said.decode(errors="replace")


def ended(process):
    """Waits for the program. If the call was interrupted, interrupts the program once, which then saves its state."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    process.wait()


def run(command, progress=None):
    """Returns (exit status, standard output, standard error). Raises KeyboardInterrupt if the user interrupted the
    call or the program."""
    progress = shows_progress(progress)
    end, other = pty.openpty() if progress else os.pipe()
    with tempfile.TemporaryFile() as printed:
        try:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=printed, stderr=other,
                                       start_new_session=True)  # otherwise Ctrl-C would interrupt it twice
        finally:
            os.close(other)
        try:
            said = listen(end, progress)
        finally:
            ended(process)
            os.close(end)
        if process.returncode in INTERRUPTED:
            raise KeyboardInterrupt
        printed.seek(0)
        return process.returncode, printed.read().decode(errors="replace"), said
