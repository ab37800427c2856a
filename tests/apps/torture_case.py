"""A run of one or several processes in its own folder, with the failures found."""

import concurrent.futures
import json
import pathlib
import random
import shutil
import time

import h5py

from program import flags
from torture_checks import (FINISHED, check_end, check_new_files, check_old_files, check_refusal,
                            check_result, check_same_data, snapshot)
from torture_library import out_of, own_keys
from torture_run import Hindrance, run
from torture_scenes import GOES_ON

DOCUMENTED = (0, 2, 3, 4)
SEARCHES = ("search", "state", "evaluations")  # files that fit, design and optimise resume


def scene_file(keys, quoted):
    """Returns keys as TOML; quoted: numbers in quotes like words."""
    def show(value):
        if isinstance(value, bool):
            return str(value).lower()
        if isinstance(value, list):
            return "[" + ", ".join(show(item) for item in value) + "]"
        return json.dumps(value, ensure_ascii=False) if quoted(value) else str(value)
    return "".join(f"{key} = {show(value)}\n" for key, value in keys.items() if value is not None)


def is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


def is_finished(path):
    with h5py.File(path) as file:
        return bool(file.attrs.get("complete", file.attrs["converged"]))


class Case:
    def __init__(self, library, folder, seed, number):
        self.library = library
        self.folder = pathlib.Path(folder)
        self.random = random.Random(f"{seed} {number}")
        self.failures = []  # (what, command)
        self.commands = []
        shutil.copytree(library.files, self.folder, dirs_exist_ok=True)

    def put_older_result(self, subcommand):
        """Puts an older result at the output path, in half of the cases."""
        if subcommand != "place" and self.random.random() < 0.5:
            shutil.copy(self.folder / "older.h5", self.folder / "x.h5")

    def going_on(self, subcommand, keys):
        """Returns keys with --resume, if there is anything to resume."""
        points = self.folder / "x.h5.shards"
        out = self.folder / "x.h5"
        begun = list(points.glob("*.points")) if points.is_dir() else \
            any((self.folder / f"x.h5.{kind}").exists() for kind in SEARCHES) or \
            out.exists() and out.read_bytes() != (self.folder / "older.h5").read_bytes()
        return {**keys, "resume": True} if subcommand in GOES_ON and begun else keys

    def own_flags(self, subcommand):
        return flags(own_keys(subcommand, self.random.choice([1, 1, 1, 2])))

    def as_flags(self, subcommand, keys):
        return [subcommand, *flags(keys), *self.own_flags(subcommand)]

    def in_scene_file(self, subcommand, keys):
        """Returns words for a scene file; only a flag may name the second output of place."""
        by_flag = {"structure": keys.get("structure")} if subcommand == "place" else {}
        quote_numbers = self.random.random() < 0.3
        in_file = {key: value for key, value in keys.items() if key not in by_flag}
        text = scene_file(in_file, lambda value: isinstance(value, str) and
                          (quote_numbers or not is_number(value)))
        (self.folder / "scene.toml").write_text(text)
        return [subcommand, "--config", "scene.toml", *flags(by_flag),
                *self.own_flags(subcommand)]

    def words(self, subcommand, keys):
        """Returns flags or a scene file; too many words for a command line go into a file."""
        as_flags = sum(map(len, flags(keys))) < 100_000 and self.random.random() < 0.6
        return (self.as_flags if as_flags else self.in_scene_file)(subcommand, keys)

    def run(self, subcommand, keys, hindrance=Hindrance(), statuses=DOCUMENTED, whole=None,
            words=None):
        """Runs one process and checks it; whole: its datasets if it succeeds."""
        words = words or self.words(subcommand, keys)
        before = snapshot(self.folder)
        ended = run(self.folder, words, hindrance)
        self.commands.append(ended.command)
        for what in (*check_end(ended, statuses),
                     *check_refusal(ended, heard=not hindrance.redirections and
                                    hindrance.reader_goes_s is None),
                     *self.check_files(subcommand, keys, ended, before),
                     *self.check_result(subcommand, keys, ended, whole)):
            self.fail(f"{what}: {ended.stderr[-300:].strip()}", ended.command)
        return ended

    def fail(self, what, command):
        self.failures.append((what, command))

    def check_files(self, subcommand, keys, ended, before):
        out, after = out_of(subcommand), snapshot(self.folder)
        outputs = {out, str(keys.get("structure"))} if subcommand == "place" else {out}
        yield from check_new_files(before, after, out, ended, outputs)
        yield from check_old_files(before, after, lambda name: ended.status != 2 and (
            self.may_replace(out, keys, ended) if name == out else
            name in outputs or name.startswith(
                (f"{out}.shards/", ".", *(f"{out}.{kind}" for kind in SEARCHES)))))

    def may_replace(self, out, keys, ended):
        """Returns whether the older file at --out may be replaced."""
        path = self.folder / out
        cut_after_its_end = ended.was_cut and path.exists() and is_finished(path)
        return ended.status in FINISHED or "resume" in keys or cut_after_its_end

    def check_result(self, subcommand, keys, ended, whole):
        """Checks the result; a sweep without a finished point, or one share, has none."""
        path = self.folder / out_of(subcommand)
        none_yet = subcommand == "sweep" and ended.status == 3 and not path.exists()
        if ended.status not in FINISHED or none_yet or "shard" in keys:
            return
        complaints = list(check_result(path))
        if not complaints and whole is not None:
            complaints = check_same_data(path, whole)
        yield from complaints

    def run_both(self, subcommand, keys, hindrances, delays, outs=("x.h5", "x.h5")):
        """Runs two processes with one --out, or two names of one file, with different seeds."""
        words = [[subcommand, *flags({**each, **own_keys(subcommand, self.random.choice([1, 2])), "out": out})]
                 for each, out in zip(keys, outs)]
        wholes = [self.library.whole(subcommand, each) for each in keys]
        before = snapshot(self.folder)
        with concurrent.futures.ThreadPoolExecutor() as pool:
            both = list(pool.map(self.run_later, delays, words, hindrances))
        command = " & ".join(ended.command for ended in both)
        self.commands.append(command)
        for ended in both:
            for what in (*check_end(ended, DOCUMENTED), *check_refusal(ended, heard=True)):
                self.fail(f"{what}: {ended.stderr[-300:].strip()}", command)
        for what in self.check_after_both(both, wholes, before):
            self.fail(f"{what}: {[ended.status for ended in both]}", command)

    def run_later(self, delay, words, hindrance):
        time.sleep(delay)
        return run(self.folder, words, hindrance)

    def check_after_both(self, both, wholes, before):
        """Checks that the result of a process that succeeded is there, or else the older file."""
        after = snapshot(self.folder)
        was_cut = any(ended.was_cut for ended in both)
        yield from (f"left {name}" for name in after.keys() - before.keys()
                    if "/." in f"/{name}" and not was_cut)
        finished = [path for path in self.folder.glob("[xy].h5*") if path.is_file() and
                    path.read_bytes() not in (before.get("x.h5"), before.get("y.h5")) and is_finished(path)]
        yield from (what for path in finished for what in check_result(path))
        for path in finished:
            if all(list(check_same_data(path, whole)) for whole in wholes):
                yield f"{path.name} is the result of neither"
        if any(ended.status == 0 for ended in both) and not finished:
            yield "the finished result is lost"
        yield from check_old_files(before, after, lambda name: name in ("x.h5", "y.h5") and finished or
                                   name.startswith((".", "x.h5.shards/", "y.h5.shards/")))
