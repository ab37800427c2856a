"""Sweeps that are killed or interrupted or whose files are damaged: nothing is lost, and every number
is the same."""

import random
import shutil
import signal
import struct
import time
import unittest

import journals
from program import WHOLE, attributes
from sweeps import MANY, SLOW, SWEEP, SweepTest, is_complete, names_of

# About two seconds of one thread, by day 0.7.
LONG = {**MANY, "samples": 40_000 if WHOLE else 14_000}
ONE = {**SLOW, "optical_depth": [3], "samples": 1_000_000 if WHOLE else 250_000}


class Kill(SweepTest):
    def test_at_many_moments(self):
        """Kills a random time after a random number of finished points."""
        self.call("sweep", **LONG, out="whole.h5")
        moments = random.Random(1)
        kept, ended, midway = {}, 0, 0
        times = 20 if WHOLE else 8
        for _ in range(times):
            process = self.start("sweep", "--resume", **LONG, out="sweep.h5")
            points = len(kept) + moments.randrange(6)
            while process.poll() is None and len(self.finished()) < points:
                time.sleep(0.002)
            time.sleep(0.03 * moments.random())
            process.kill()
            if process.wait() == 0:
                (self.folder / "sweep.h5").unlink()
                kept, ended = {}, ended + 1
            else:
                kept = self.check_left_behind(kept)
                midway += 0 < len(kept) < 40
        self.assertGreater(midway, times // 5)
        self.assertLess(ended, times // 2)
        done = self.call("sweep", "--resume", **LONG, out="sweep.h5")
        self.assertNotIn("warning", done.stderr)
        self.assert_same_data("sweep.h5", "whole.h5")
        self.assertFalse(self.points().exists())

    def check_left_behind(self, before):
        """Checks that finished points are unchanged until the result is there."""
        if (self.folder / "sweep.h5").exists():
            self.assert_same_data("sweep.h5", "whole.h5")
        else:
            after = self.finished()
            self.assertLessEqual(before.items(), after.items())
        return self.finished()

    def test_what_was_being_written_is_cleared_away(self):
        """Kills while a file is written, before the unfinished file is removed, and before the folder is
        removed."""
        self.whole(SWEEP)
        self.all_points(SWEEP)
        name = next(iter(self.finished()))
        place = self.points()
        (place / f".{name}.part.tmp-1").write_bytes(b"left behind")
        for ending in (".part", ".part.h5"):  # the second of an earlier version
            shutil.copy(self.journal(), place / f"{name}{ending}")
        self.call("sweep", "--resume", **SWEEP, out="sweep.h5")
        self.assertFalse(place.exists())
        self.assert_same_data("sweep.h5", "whole.h5")

        self.all_points(SWEEP, out="again.h5")
        shutil.copy(self.folder / "sweep.h5", self.folder / "again.h5")
        done = self.call("sweep", "--resume", **SWEEP, out="again.h5")
        self.assertIn("complete", done.stdout)
        self.assertFalse(self.points("again.h5").exists())


class Interruption(SweepTest):
    def test_in_the_midst_of_points(self):
        """Covers points that stop at a number of samples, and at an error, of which many are unfinished
        at a time."""
        for stop in ({}, {"samples": None, "method": "mc", "target_error": 0.0008 if WHOLE else 0.0015}):
            with self.subTest(stop=stop):
                keys = {**SLOW, **stop}
                self.whole(keys)
                unfinished = {}
                for number, threads in ((signal.SIGINT, 2), (signal.SIGTERM, 1), (signal.SIGINT, 3))[:3 if WHOLE else 2]:
                    self.interrupted(number, cpu_s=0.06, **{**keys, "threads": threads}, resume=True, out="sweep.h5")
                    self.assertFalse((self.folder / "sweep.h5").exists())
                    unfinished.update(self.unfinished())
                self.assertTrue(unfinished)
                done = self.call("sweep", "--resume", **keys, out="sweep.h5")
                self.assertNotIn("warning", done.stderr)
                self.assert_same_data("sweep.h5", "whole.h5")
                self.assertFalse(self.points().exists())
                (self.folder / "sweep.h5").unlink()

    def test_goes_on_from_where_it_was(self):
        """The point does not begin again: the time of the first part is included."""
        keys = {**SLOW, "optical_depth": [3], "samples": 3_000_000}
        costs = []
        for _ in range(2):
            self.interrupted(cpu_s=0.3, **keys, resume=True, out="sweep.h5")
            name, = self.unfinished()
            (_, _), (_, state) = journals.records(self.points() / name)
            costs.append((*struct.unpack("<Q", state[:8]), *struct.unpack("<2d", state[-16:])))
        for first, both in zip(*costs):  # batches, wall and processor time
            self.assertGreater(both, first)

    def test_by_both_methods(self):
        keys = {"domain": "box", "width": 10, "depth": 10, "scatterer": "point",
                "density": [0.2, 0.4], "tilts": [0, 0.1], "method": "both", "samples": 600_000 if WHOLE else 150_000,
                "wave_samples": 16000 if WHOLE else 4000, "threads": 2}
        self.call("sweep", **keys, out="whole.h5")
        for cpu_s in (0.1, 0.3 if WHOLE else 0.15):
            self.interrupted(cpu_s=cpu_s, **keys, resume=True, out="sweep.h5")
        self.call("sweep", "--resume", **keys, out="sweep.h5")
        self.assert_same_data("sweep.h5", "whole.h5")

    def test_of_a_share(self):
        self.whole(SLOW)
        self.interrupted(**SLOW, shard="0/2", out="sweep.h5")
        self.call("sweep", **SLOW, shard="1/2", out="sweep.h5")
        self.call("sweep", **SLOW, shard="0/2", out="sweep.h5", status=2)
        self.call("sweep", "--resume", **SLOW, shard="0/2", out="sweep.h5")
        self.assertEqual(len(self.finished()), 3)
        self.assertFalse(self.unfinished())
        self.call("merge", out="sweep.h5")
        self.assert_same_data("sweep.h5", "whole.h5")

    def test_where_an_older_result_lies(self):
        """A new sweep may replace the older result, interrupted or not."""
        self.whole(SLOW)
        self.call("sweep", **SWEEP, out="sweep.h5")
        older = (self.folder / "sweep.h5").read_bytes()
        self.interrupted(**SLOW, out="sweep.h5")
        self.assertEqual((self.folder / "sweep.h5").read_bytes(), older)
        self.call("sweep", "--resume", **SLOW, out="sweep.h5")
        self.assert_same_data("sweep.h5", "whole.h5")


def truncated(data):
    return data[:len(data) * 2 // 3]


def emptied(_):
    return b""


def flipped_at(position, bit):
    def flip(data):
        changed = bytearray(data)
        changed[position % len(changed)] ^= 1 << bit
        return bytes(changed)

    return flip


class Damage(SweepTest):
    """Damage to the files of finished and unfinished points."""

    def setUp(self):
        super().setUp()
        self.whole(SWEEP)

    def check_mended(self, backups, whole="whole.h5", keys=SWEEP):
        """Checks that damaged files are reported, kept as backups, and made again."""
        done = self.call("sweep", "--resume", **keys, out="sweep.h5")
        warnings = [line for line in done.stderr.splitlines() if line.startswith("warning: ")]
        self.assertEqual(len(warnings), len(backups), done.stderr)
        for name in backups:
            self.assertTrue(any(f"{name}.aside-1" in line for line in warnings), done.stderr)
        self.assert_same_data("sweep.h5", whole)
        self.assertEqual(self.shards(), {f"{name}.aside-1": data for name, data in backups.items()})
        shutil.rmtree(self.points(), ignore_errors=True)
        (self.folder / "sweep.h5").unlink()
        return warnings

    def damage(self, path, change):
        """Returns the new contents of the file, by name."""
        path.write_bytes(change(path.read_bytes()))
        return {path.name: path.read_bytes()}

    def test_of_finished_points(self):
        positions = random.Random(2)
        flips = [flipped_at(positions.randrange(1 << 20), positions.randrange(8))
                 for _ in range(12 if WHOLE else 5)]
        for change in (*flips, lambda data: data + bytes(100), lambda data: bytes(len(data))):
            self.all_points(SWEEP)
            for line in self.check_mended(self.damage(self.journal(), change)):
                self.assertIn("damaged", line)

    def test_of_what_was_cut_off(self):
        """Truncation, as by a failure of the machine, needs no report."""
        for change in (truncated, emptied, lambda data: data[:-1], lambda data: data[:7]):
            self.all_points(SWEEP)
            self.damage(self.journal(), change)
            self.check_mended({})

    def test_of_unfinished_points(self):
        keys = SLOW if WHOLE else ONE
        self.whole(keys, "slow.h5")
        for change in (truncated, emptied, flipped_at(9000, 0)):
            self.interrupted(**keys, out="sweep.h5")
            damaged = {}
            for name in self.unfinished():
                damaged |= self.damage(self.points() / name, change)
            self.assertTrue(damaged)
            self.check_mended(damaged, "slow.h5", keys)

    def test_of_no_file_at_all(self):
        """A folder replaces the file of an unfinished point."""
        self.call("sweep", **SWEEP, shard="1/2", out="sweep.h5")
        path = self.points() / f"{sorted(set(names_of(SWEEP)) - self.finished().keys())[0]}.part"
        path.mkdir()
        (path / "inside").write_text("kept")
        done = self.call("sweep", "--resume", **SWEEP, out="sweep.h5")
        self.assertIn("renamed to", done.stderr)
        self.assertEqual((self.points() / f"{path.name}.aside-1" / "inside").read_text(), "kept")
        self.assert_same_data("sweep.h5", "whole.h5")

    def test_of_another_sweep(self):
        """Points of another sweep are unchanged."""
        for changes in ({"seed": 2}, {"depth": 101}, {"tilts": [0, 0.001, 0.011]},
                        {"view_angles": [0.1]}, {"samples": 4001}, {"target_error": 0.5},
                        {"reversed_paths": "no"}):
            with self.subTest(changes=changes):
                self.all_points({**SWEEP, **changes})
                before = self.shards()
                done = self.call("sweep", "--resume", **SWEEP, out="sweep.h5", status=2)
                self.assert_one_line(done.stderr, "another sweep", next(iter(changes)))
                self.assertEqual(self.shards(), before)
                shutil.rmtree(self.points())

    def test_of_unfinished_points_of_another_sweep(self):
        """Also covers the state of another point."""
        keys = ONE
        self.whole(keys, "slow.h5")
        for changes in ({"seed": 2}, {"optical_depth": [2]}):
            self.interrupted(**{**keys, **changes}, out="other.h5")
            (other, data), = self.unfinished("other.h5").items()
            shutil.rmtree(self.points("other.h5"))
            self.points().mkdir()
            name = other.replace("optical_depth=2", "optical_depth=3")
            (self.points() / name).write_bytes(data)
            for line in self.check_mended(self.shards(), "slow.h5", keys):
                self.assertIn("another sweep", line)

    def test_time_and_again(self):
        """Earlier backups are kept as well."""
        kept = {}
        for number in (1, 2, 3):
            self.all_points({**SWEEP, "resume": True})
            damaged = self.damage(self.journal(), flipped_at(100 * number, 0))
            kept |= {f"{name}.aside-{number}": data for name, data in damaged.items()}
            self.call("sweep", "--resume", **SWEEP, out="sweep.h5")
            self.assertEqual(self.shards(), kept)
            (self.folder / "sweep.h5").unlink()

    def test_of_a_sweep_of_an_earlier_version(self):
        """Earlier versions stored points in separate files."""
        self.points().mkdir()
        (self.points() / "mc_optical_depth=1_g=0_albedo=1.h5").write_bytes(b"a point")
        before = self.shards()
        for words in (["sweep"], ["sweep", "--resume"]):
            done = self.call(*words, **SWEEP, out="sweep.h5", status=2)
            self.assert_one_line(done.stderr, "sweep.h5.shards", "one file per point")
        done = self.call("merge", out="sweep.h5", status=2)
        self.assert_one_line(done.stderr, "sweep.h5.shards", "one file per point")
        self.assertEqual(self.shards(), before)


class MergeOfDamage(SweepTest):
    def setUp(self):
        super().setUp()
        self.whole(SWEEP)
        self.all_points(SWEEP)
        self.names = list(self.finished())

    def check_refused(self, *words):
        before = self.shards()
        done = self.call("merge", out="sweep.h5", status=2)
        self.assert_one_line(done.stderr, *words)
        self.assertFalse((self.folder / "sweep.h5").exists())
        self.assertEqual(self.shards(), before)
        return done

    def check_partial(self, missing):
        before = self.shards()
        self.call("merge", "--partial", out="sweep.h5", status=3)
        self.assertEqual(self.shards(), before)
        self.assertFalse(is_complete(self.folder / "sweep.h5"))
        self.assert_points_equal("sweep.h5", "whole.h5")
        self.assertEqual(attributes(self.folder / "sweep.h5")["samples"], 4000 * (8 - missing))

    def test_missing(self):
        journals.drop(self.journal(), *self.names[:2])
        self.check_refused("2 of 8", "--partial")
        self.check_partial(2)

    def test_damaged(self):
        whole = self.journal().read_bytes()
        place = whole.index(self.names[5].encode())
        self.journal().write_bytes(flipped_at(place, 5)(whole))
        done = self.check_refused("3 of 8", "--partial")
        self.assertIn("is damaged; 5 of its points are used", done.stderr)
        self.check_partial(3)
        self.journal().write_bytes(whole)
        self.call("merge", out="merged.h5", shards="sweep.h5.shards")
        self.assert_same_data("merged.h5", "whole.h5")

    def test_of_another_sweep(self):
        """Points of both sweeps are mixed, in either order."""
        self.call("sweep", **SWEEP, seed=2, shard="1/2", out="other.h5")
        for name in ("a.points", "z.points"):
            shutil.copy(self.journal(1, 2, "other.h5"), self.points() / name)
            done = self.call("merge", out="merged.h5", shards="sweep.h5.shards")
            self.assertIn("another sweep (seed = 2)", done.stderr)
            self.assert_same_data("merged.h5", "whole.h5")
            (self.points() / name).unlink()

    def test_then_resumed(self):
        """A partial result can be continued."""
        journals.drop(self.journal(), self.names[0])
        self.check_partial(1)
        self.call("sweep", "--resume", **SWEEP, out="sweep.h5")
        self.assert_same_data("sweep.h5", "whole.h5")

    def test_nothing_there(self):
        journals.drop(self.journal(), *self.names)
        self.check_refused("sweep.h5.shards")
        self.assert_one_line(self.call("merge", out="none.h5", status=2).stderr, "none.h5.shards")
        done = self.call("merge", "--partial", out="none.h5", status=2)
        self.assert_one_line(done.stderr, "none.h5.shards")

    def test_unfinished_only(self):
        self.interrupted(**{**SLOW, "optical_depth": [3], "samples": 2_000_000}, out="slow.h5")
        self.assert_one_line(self.call("merge", out="slow.h5", status=2).stderr, "slow.h5.shards")


if __name__ == "__main__":
    unittest.main()
