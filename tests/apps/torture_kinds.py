"""The kinds of runs of torture.py, each a function of a Case."""

import os
import signal

from program import LLVM_OPENMP, SLOWNESS
from torture_damage import damage, damage_bytes, mutated
from torture_run import Hindrance
from torture_scenes import LONG, OLDER, POINTS, RESUMABLE, SCENES, STOPPED

PATIENCE_S = 1.5 * SLOWNESS
ENDS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGKILL)


def mutated_scene(case):
    """Runs values out of all bounds, which may take forever but must end on a signal."""
    subcommand, keys = case.random.choice(SCENES)
    case.put_older_result(subcommand)
    case.run(subcommand, mutated(keys, case.library.rows[subcommand], case.random),
             Hindrance(patience_s=PATIENCE_S))


def files_of(case, keys):
    """Returns the paths of files that a scene reads."""
    found = [case.folder / value for value in keys.values() if isinstance(value, str)]
    folders = [path for path in found if path.is_dir()]
    return [path for path in found if path.is_file()] + \
        [inside for folder in folders for inside in sorted(folder.iterdir())]


def damaged_input(case):
    """Damages input; it may become another scene, so that the run takes long."""
    subcommand, keys = case.random.choice([scene for scene in SCENES if files_of(case, scene[1])])
    case.put_older_result(subcommand)
    damage(case.random.choice(files_of(case, keys)), case.random)
    case.run(subcommand, keys, Hindrance(patience_s=PATIENCE_S))


def damaged_scene_file(case):
    subcommand, keys = case.random.choice([scene for scene in SCENES if scene[0] != "place"])
    case.put_older_result(subcommand)
    words = case.in_scene_file(subcommand, keys)
    damage_bytes(case.folder / "scene.toml", case.random)
    case.run(subcommand, keys, Hindrance(patience_s=PATIENCE_S), words=words)


def damaged_result(case):
    """Damages the result of an older run at --out, which is to be resumed or replaced."""
    source, keys = case.random.choice([("older.h5", OLDER), ("stopped.h5", STOPPED)])
    (case.folder / source).rename(case.folder / "x.h5")
    damage(case.folder / "x.h5", case.random)
    case.run("covariance", {**keys, **case.random.choice([{}, {"resume": True}])})


def damaged_points(case):
    """Damages points of a sweep that is resumed: they are made again."""
    points = case.folder / "x.h5.shards"
    (case.folder / "points.h5.shards").rename(points)
    damage_bytes(points / "share-0-of-1.points", case.random)
    case.run("sweep", {**POINTS, "resume": True}, statuses=(0,),
             whole=case.library.whole("sweep", POINTS))


def interrupting_signals(case, duration):
    """Returns one of the signals at a random moment, or SIGTERM twice."""
    moment = case.random.uniform(0, 1.2 * duration)
    if case.random.random() < 0.2:
        between = case.random.choice([0, case.random.uniform(0, 0.05)])
        return ((moment, signal.SIGTERM), (between, signal.SIGTERM))
    return ((moment, case.random.choice(ENDS)),)


def interrupted(case):
    """Interrupts one to four times at random, then runs to the end: the result is undisturbed."""
    subcommand, keys = case.random.choice(LONG)
    case.put_older_result(subcommand)
    whole = case.library.whole(subcommand, keys)
    duration = case.library.duration(subcommand, keys)
    for _ in range(case.random.choice([1, 1, 2, 4])):
        case.run(subcommand, case.going_on(subcommand, keys),
                 Hindrance(signals=interrupting_signals(case, duration)), whole=whole)
    case.run(subcommand, case.going_on(subcommand, keys), statuses=(0,), whole=whole)


# LLVM's OpenMP (14) ends any program whose files may not hold its 1024 bytes of shared memory, or
# whose OMP_NUM_THREADS it cannot read.
FILE_SIZES = [1024 if LLVM_OPENMP else size for size in (0, 1, 100)] + [4096, 10_000, 20_000,
                                                                       40_000, 10**6]
THREADS = ["0", "-1", "1000", "1,2,3"] + ([] if LLVM_OPENMP else ["abc", ""])


def limited(case):
    """Limits the size of files, open files or memory."""
    subcommand, keys = case.random.choice(SCENES)
    case.put_older_result(subcommand)
    limit = case.random.choice(
        [f"--fsize={case.random.choice(FILE_SIZES)}"] * 6 +
        [f"--nofile={case.random.choice([5, 6, 8, 12, 20])}"] * 4 +
        [f"--as={case.random.choice([120, 150, 250, 400, 700, 1500, 3000])}000000"] *
        (2 if SLOWNESS == 1 else 0))
    case.run(subcommand, keys, Hindrance(limits=(limit,)), statuses=(0, 2, 4),
             whole=case.library.whole(subcommand, keys))


def short_of_time(case):
    """Limits processor time to a second, soft or hard."""
    subcommand, keys = case.random.choice([scene for scene in LONG if "samples" in scene[1]])
    case.put_older_result(subcommand)
    case.run(subcommand, {**keys, "samples": 100 * keys["samples"]},
             Hindrance(limits=(case.random.choice(["--cpu=1:1", "--cpu=1:5"]),)),
             statuses=(-signal.SIGKILL, 75))


def closed_folder(case):
    """Forbids writing to the folder, except by the superuser."""
    subcommand, keys = case.random.choice(SCENES)
    words = case.as_flags(subcommand, keys)
    case.folder.chmod(0o555)
    case.run(subcommand, keys, statuses=(0,) if os.geteuid() == 0 else (4,), words=words)
    case.folder.chmod(0o755)


def bad_streams(case):
    """Closes streams, fills them, or uses a pipe whose reader ends: the result is there nevertheless."""
    subcommand, keys = case.random.choice(SCENES)
    case.put_older_result(subcommand)
    hindrance = Hindrance(redirections=case.random.choice(
        ["<&-", ">&-", "2>&-", ">&- 2>&-", "<&- >&-", "<&- >&- 2>&-", ">/dev/full",
         "2>/dev/full", ">/dev/full 2>/dev/full"]))
    if case.random.random() < 0.3:
        hindrance = Hindrance(reader_goes_s=case.random.uniform(0, 0.05))
    case.run(subcommand, keys, hindrance, statuses=(0,), whole=case.library.whole(subcommand, keys))


# Variables of the BLAS kernel, on which last bits depend, and of sanitizers.
KEPT = [f"{name}={value}" for name, value in os.environ.items()
        if name.startswith(("OPENBLAS_CORETYPE", "ASAN_", "TSAN_", "UBSAN_", "LSAN_"))]
ENVIRONMENTS = [
    *((f"LC_ALL={name}",) for name in ("de_DE.UTF-8", "tr_TR.UTF-8", "C", "C.utf8", "\u00e4/../x",
                                       "x" * 5000, "")),
    ("TMPDIR=absent",), ("TMPDIR=/dev/null",), ("-u", "HOME"), ("HOME=",), ("-u", "PATH"),
    ("-i", *KEPT),
    *((f"COLUMNS={value}",) for value in ("0", "-1", "1", "abc", "99999999999999999999")),
    *((f"{name}={value}",) for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")
      for value in THREADS),
    ("OMP_STACKSIZE=1",), ("OMP_THREAD_LIMIT=1",), ("OMP_DYNAMIC=true", "OMP_PROC_BIND=spread"),
    ("HDF5_USE_FILE_LOCKING=x",), ("TZ=:/absent",), ("TERM=",),
    ("POSIXLY_CORRECT=1",), ("MALLOC_ARENA_MAX=1",), ("GOMP_CPU_AFFINITY=99",),
]


def odd_environment(case):
    """Sets odd environment variables, which must not change a bit."""
    subcommand, keys = case.random.choice(SCENES + LONG)
    case.put_older_result(subcommand)
    case.run(subcommand, keys, Hindrance(environment=case.random.choice(ENVIRONMENTS)),
             statuses=(0,), whole=case.library.whole(subcommand, keys))


def two_owners(case):
    """Runs two processes with one --out and different seeds; the second is rejected or follows the first."""
    subcommand, keys = case.random.choice(
        [scene for scene in LONG if scene[0] in RESUMABLE and "of" not in scene[1]])  # some take no seed
    case.put_older_result(subcommand)
    run_two(case, subcommand, keys, ("x.h5", "x.h5"))


def linked_owners(case):
    """Runs two processes on a result and a link to it, which may be dangling. The points of sweeps are next
    to the given name."""
    subcommand, keys = case.random.choice(
        [scene for scene in LONG if scene[0] in RESUMABLE and scene[0] != "sweep"])
    if case.random.random() < 0.5:
        (case.folder / "older.h5").rename(case.folder / "y.h5")
    (case.folder / "x.h5").symlink_to("y.h5")
    outs = ["x.h5", "y.h5"]
    case.random.shuffle(outs)
    run_two(case, subcommand, keys, outs)


def run_two(case, subcommand, keys, outs):
    duration = case.library.duration(subcommand, keys)

    delays = [case.random.choice([0, case.random.uniform(0, duration)]) for _ in range(2)]
    hindrances = [Hindrance(signals=interrupting_signals(case, duration)
                            if case.random.random() < 0.5 else ()) for _ in range(2)]
    case.run_both(subcommand, [{**keys, "seed": seed} for seed in (1, 2)], hindrances, delays, outs)


# Subcommands that only print; explain is given a result.
PRINTING = (["keys", "json"], ["keys", "markdown"], ["new", "lens"], ["explain", "older.h5"], ["datasets"],
            ["--help"], ["--version"], ["render", "--help"])


def full_output(case):
    """Checks that subcommands that only print fail if their output is lost."""
    words = case.random.choice(PRINTING)
    case.run(words[0], {}, Hindrance(redirections=">/dev/full"), statuses=(1,), words=words)


def long_number(case):
    """Checks that a number of very many digits is read or rejected at once."""
    subcommand, keys = case.random.choice(SCENES)
    names = [name for name, value in keys.items()
             if isinstance(value, (int, float)) and not isinstance(value, bool)]
    if not names:
        return
    digits = case.random.choice("01379") * case.random.choice([400, 800, 3000, 30_000, 120_000])
    text = case.random.choice(["1{}", "-{}", "0.{}", "1e{}", "1.5e-{}", "{}x", "{}:{}", "1e5{}e1"])
    value = text.replace("{}", digits)
    case.put_older_result(subcommand)
    case.run(subcommand, {**keys, case.random.choice(names): value}, Hindrance(patience_s=PATIENCE_S))


# Relative frequencies of the kinds.
KINDS = {mutated_scene: 35, damaged_input: 10, damaged_scene_file: 5, damaged_result: 4,
         damaged_points: 2, interrupted: 12, limited: 8, short_of_time: 1, closed_folder: 1,
         bad_streams: 7, odd_environment: 8, two_owners: 7, linked_owners: 4, full_output: 1,
         long_number: 3}
