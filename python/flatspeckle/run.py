"""Runs the program: its progress is passed on, an interruption reaches it, its exit status is told."""

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
    """Where nothing is said: on terminals and in notebooks."""
    if wanted is not None:
        return wanted
    return sys.stderr is not None and (sys.stderr.isatty() or "ipykernel" in sys.modules)


def chunks(end):
    """What comes out of a pipe or a terminal, whose other side closes with an error."""
    with contextlib.suppress(OSError):
        while chunk := os.read(end, 65536):
            yield chunk.replace(b"\r\n", b"\n")


def listen(end, progress):
    """All that the program says; what it refuses is for the exception."""
    said = b""
    for chunk in chunks(end):
        said += chunk
        if progress and not chunk.startswith(b"flatspeckle: "):
            sys.stderr.write(chunk.decode(errors="replace"))
            sys.stderr.flush()
    return said.decode(errors="replace")


def ended(process):
    """Of a call that is left while the program runs: it is interrupted once, and keeps its state."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    process.wait()


def run(command, progress=None):
    """(exit status, standard output, standard error). Raises KeyboardInterrupt where the user or the
    program was interrupted."""
    progress = shows_progress(progress)
    end, other = pty.openpty() if progress else os.pipe()
    with tempfile.TemporaryFile() as printed:
        try:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=printed, stderr=other,
                                       start_new_session=True)  # or Ctrl-C would reach it twice
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
