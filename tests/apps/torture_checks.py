"""Checks after the end of a process, whatever happened to it. Each check yields complaints."""

import re

import h5py
import numpy as np

import program
from torture_run import MOST_S, OBEYS_S

MOST_LETTERS = 500  # of the line of a rejection
FINISHED = (0, 3)
# Times, and counts of this run alone, not of the resumed one (docs/format.md).
COST = ("wall_s", "cpu_s", "trace_cpu_s", "state", "trials", "flights", "lost_flights", "joins", "lost_values")


def datasets(path):
    return program.datasets(path, leave_out=COST)


def snapshot(folder):
    """Returns {path in the folder: its bytes} of all files, including subfolders."""
    return {str(path.relative_to(folder)): path.read_bytes()
            for path in sorted(folder.rglob("*")) if path.is_file() and not path.is_symlink()}


def values_of(file):
    """Yields (name, numbers) of all floating-point datasets and attributes."""
    items = {"/": file}
    file.visititems(lambda name, item: items.update({name: item}))
    for name, item in items.items():
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "fc":
            yield name, item[()]
        for key, value in item.attrs.items():
            if np.asarray(value).dtype.kind in "fc":
                yield f"{name} @{key}", value


def check_result(path):
    """Checks that the result exists, can be read, and contains only finite numbers."""
    if not path.exists():
        yield f"no {path.name}"
    elif path.suffix == ".csv":
        if "nan" in path.read_text().lower() or "inf" in path.read_text().lower():
            yield f"{path.name}: not finite"
    else:
        try:
            with h5py.File(path) as file:
                wrong = [name for name, values in values_of(file)
                         if not np.all(np.isfinite(values))]
        except OSError as error:
            yield f"{path.name}: {error}"
        else:
            yield from (f"{path.name}: {name} is not finite" for name in wrong)


def check_same_data(path, reference):
    """Checks that it has the same datasets, bit for bit."""
    if path.suffix == ".csv":
        return
    found = datasets(path)
    different = [name for name in sorted({*found, *reference}) if name not in found or
                 name not in reference or
                 program.bits_of(found[name]) != program.bits_of(reference[name])]
    if different:
        yield f"{path.name} differs from an undisturbed run: {', '.join(different[:5])}"


def check_end(ended, statuses):
    """Checks that the process ended in time, with a documented status or by the signal sent."""
    allowed = {*statuses, *((75, 130, 0, 3) if ended.sent else ()),
               *(-number for number in ended.sent if ended.was_cut)}
    if ended.status is None:
        yield (f"did not end within {MOST_S:g} s" + (" of a signal" if ended.sent else ""))
        return
    if ended.status not in allowed:
        yield f"status {ended.status}"
    if ended.sent and not ended.was_killed and ended.obeyed_s > OBEYS_S:
        yield f"ended {ended.obeyed_s:.1f} s after a signal"


def check_refusal(ended, heard):
    """Checks that a rejection is one short line, apart from notes, warnings and output before memory runs out.
    heard: stderr was complete."""
    if ended.status != 2 or not heard:
        return
    lines = [line for line in ended.stderr.splitlines() if not line.startswith(("note: ", "warning: "))]
    if lines and "more memory than is available" in lines[-1]:
        del lines[:-1]
    if len(lines) != 1 or not lines[0].startswith("flatspeckle: "):
        yield f"{len(lines)} lines for a refusal"
    if len(ended.stderr) > MOST_LETTERS:
        yield f"{len(ended.stderr)} letters for a refusal"


def check_new_files(before, after, out, ended, outputs):
    """Checks that the only new files are the result, backups of what it replaced, the points of a sweep, and
    the state of an unfinished search."""
    for name in after.keys() - before.keys():
        own = name in outputs or re.fullmatch(re.escape(out) + r"\.aside-\d+", name)
        point = name.startswith(f"{out}.shards/") and "/." not in name
        search = ended.status != 0 and re.fullmatch(
            re.escape(out) + r"\.(search|state|evaluations)", name)
        left = re.search(r"(^|/)\.[^/]*(\.lock|\.tmp-\d+)$", name)
        if ended.status == 2 or not (own or point or search or (left and ended.was_cut)):
            yield f"left {name}"


def is_kept(name, data, after):
    """Returns whether the file is in place or in a backup."""
    return any(after[path] == data for path in after
               if path == name or re.fullmatch(re.escape(name) + r"\.aside-\d+", path))


def check_old_files(before, after, replaced):
    """Checks that old files are kept, except those that may be replaced."""
    for name, data in before.items():
        if not replaced(name) and not is_kept(name, data, after):
            yield f"{name} is {'changed' if name in after else 'lost'}"
