"""Small disks for tests that fill them."""

import os
import subprocess
import sys


def mounts_allowed():
    """Returns whether this process may mount, by a trial."""
    try:
        done = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", "/mnt"],
                              capture_output=True, timeout=10)
    except (OSError, subprocess.TimeoutExpired):
        return False
    if done.returncode == 0:
        subprocess.run(["umount", "/mnt"], check=True)
    return done.returncode == 0


def go_where_mounts_are_allowed():
    """Restarts in a private mount namespace, if the system grants one: its mounts end with it and are
    invisible to others."""
    if os.environ.get("IN_OWN_NAMESPACE"):
        return
    for flags in (["--mount"], ["--map-root-user", "--mount"]):
        try:
            granted = subprocess.run(["unshare", *flags, "true"], capture_output=True).returncode
        except OSError:
            return
        if granted == 0:
            os.environ["IN_OWN_NAMESPACE"] = "1"
            os.execvp("unshare", ["unshare", *flags, sys.executable, "-B", *sys.argv])
