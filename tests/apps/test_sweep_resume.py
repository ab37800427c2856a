"""Sweeps that are killed, interrupted, and whose files are damaged: nothing is lost, every number
comes out the same."""

import random
import shutil
import signal
import time
import unittest

from program import attributes
from sweeps import MANY, SLOW, SWEEP, SweepTest, is_complete

# About two seconds of two threads.
LONG = {**MANY, "samples": 40_000}


class Kill(SweepTest):
    def test_at_twenty_moments(self):
        start = self.seconds_of("--version")
        duration = self.seconds_of("sweep", **LONG, out="whole.h5") - start
        moments = random.Random(1)
        kept, ended, midway = {}, 0, 0
        for _ in range(20):
            process = self.start("sweep", "--resume", **LONG, out="sweep.h5")
            time.sleep(start + moments.random() * 0.15 * duration)
            process.kill()
            if process.wait() == 0:
                (self.folder / "sweep.h5").unlink()
                kept, ended = {}, ended + 1
            else:
                kept = self.check_left_behind(kept)
                midway += 0 < len(kept) < 40
        self.assertGreater(midway, 5)
        self.assertLess(ended, 5)
        done = self.call("sweep", "--resume", **LONG, out="sweep.h5")
        self.assertNotIn("warning", done.stderr)
        self.assert_same_data("sweep.h5", "whole.h5")
        self.assertFalse(self.points().exists())

    def check_left_behind(self, before):
        """A finished point stays as it is until the result is there."""
        if (self.folder / "sweep.h5").exists():
            self.assert_same_data("sweep.h5", "whole.h5")
        else:
            after = self.finished()
            self.assertLessEqual(before.items(), after.items())
        return self.finished()

    def test_what_was_being_written_is_cleared_away(self):
        """Of a kill while a file is written, before the unfinished file has gone, and before the
        folder has gone."""
        self.call("sweep", **SWEEP, out="whole.h5")
        self.all_points(SWEEP)
        name = next(iter(self.finished()))
        place = self.points()
        (place / f".{name}.tmp-1").write_bytes(b"left behind")
        shutil.copy(place / name, place / name.replace(".h5", ".part.h5"))
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
        """Points that stop at a number of samples, and such that stop at an error, of which many
        are unfinished at a time."""
        for stop in ({}, {"samples": None, "method": "mc", "target_error": 0.0008}):
            with self.subTest(stop=stop):
                keys = {**SLOW, **stop}
                self.call("sweep", **keys, out="whole.h5")
                for number, threads in ((signal.SIGINT, 2), (signal.SIGTERM, 1),
                                        (signal.SIGINT, 3)):
                    self.interrupted(number, **{**keys, "threads": threads}, resume=True,
                                     out="sweep.h5")
                    self.assertFalse((self.folder / "sweep.h5").exists())
                parts = [name for name in self.shards() if name.endswith(".part.h5")]
                self.assertTrue(parts)
                done = self.call("sweep", "--resume", **keys, out="sweep.h5")
                self.assertNotIn("warning", done.stderr)
                self.assert_same_data("sweep.h5", "whole.h5")
                self.assertFalse(self.points().exists())
                (self.folder / "sweep.h5").unlink()

    def test_goes_on_from_where_it_was(self):
        """And does not begin the point again: the time of the first part counts as well."""
        keys = {**SLOW, "optical_depth": [3], "samples": 3_000_000}
        self.interrupted(cpu_s=0.3, **keys, out="sweep.h5")
        (name, data), = self.shards().items()
        self.assertTrue(name.endswith(".part.h5"))
        before = attributes(self.points() / name)
        self.assertGreater(before["samples"], 1000)
        self.interrupted(cpu_s=0.1, **keys, resume=True, out="sweep.h5")
        after = attributes(self.points() / name)
        self.assertGreater(after["samples"], before["samples"])
        self.assertGreater(after["wall_s"], before["wall_s"])
        self.assertGreater(after["cpu_s"], before["cpu_s"])

    def test_by_both_methods(self):
        keys = {"domain": "box", "width": 10, "depth": 10, "scatterer": "point",
                "density": [0.2, 0.4], "tilts": [0, 0.1], "method": "both", "samples": 600_000,
                "wave_samples": 16000, "threads": 2}
        self.call("sweep", **keys, out="whole.h5")
        for cpu_s in (0.1, 0.3):
            self.interrupted(cpu_s=cpu_s, **keys, resume=True, out="sweep.h5")
        self.call("sweep", "--resume", **keys, out="sweep.h5")
        self.assert_same_data("sweep.h5", "whole.h5")

    def test_of_a_share(self):
        self.call("sweep", **SLOW, out="whole.h5")
        self.interrupted(**SLOW, shard="0/2", out="sweep.h5")
        self.call("sweep", **SLOW, shard="1/2", out="sweep.h5")
        self.call("sweep", **SLOW, shard="0/2", out="sweep.h5", status=2)
        self.call("sweep", "--resume", **SLOW, shard="0/2", out="sweep.h5")
        self.assertEqual(len(self.finished()), 3)
        self.assertEqual(self.shards(), self.finished())
        self.call("merge", out="sweep.h5")
        self.assert_same_data("sweep.h5", "whole.h5")

    def test_where_an_older_result_lies(self):
        """Which a new sweep may replace, in one go or in several."""
        self.call("sweep", **SLOW, out="whole.h5")
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
    """All points are finished, or unfinished, and then some files are damaged."""

    def setUp(self):
        super().setUp()
        self.call("sweep", **SWEEP, out="whole.h5")

    def damage(self, names, change, out="sweep.h5"):
        """Returns what the damaged files hold."""
        damaged = {}
        for name in names:
            path = self.points(out) / name
            damaged[name] = change(path.read_bytes())
            path.write_bytes(damaged[name])
        return damaged

    def check_mended(self, damaged, whole="whole.h5", keys=SWEEP):
        """Each damaged file is told of, kept beside, and done again."""
        done = self.call("sweep", "--resume", **keys, out="sweep.h5")
        warnings = [line for line in done.stderr.splitlines() if line.startswith("warning: ")]
        self.assertEqual(len(warnings), len(damaged), done.stderr)
        for name in damaged:
            self.assertTrue(any(f"/{name} " in line and "set aside" in line for line in warnings),
                            done.stderr)
        self.assert_same_data("sweep.h5", whole)
        self.assertEqual(self.shards(),
                         {f"{name}.aside-1": data for name, data in damaged.items()})
        shutil.rmtree(self.points(), ignore_errors=True)
        (self.folder / "sweep.h5").unlink()
        return warnings

    def test_of_finished_points(self):
        for change in (truncated, emptied, flipped_at(5000, 3), lambda data: data + b"\0",
                       lambda data: data[:-1], lambda data: b"\0" * len(data)):
            self.all_points(SWEEP)
            names = list(self.finished())[1:4]
            for line in self.check_mended(self.damage(names, change)):
                self.assertIn("damaged", line)

    def test_of_any_byte(self):
        self.call("sweep", **MANY, out="many.h5")
        positions = random.Random(2)
        for _ in range(3):
            self.all_points(MANY)
            damaged = {}
            for name in self.finished():
                flip = flipped_at(positions.randrange(1 << 20), positions.randrange(8))
                damaged |= self.damage([name], flip)
            self.assertEqual(len(damaged), 40)
            self.check_mended(damaged, "many.h5", MANY)

    def test_of_no_file_at_all(self):
        """A folder in the place of a point."""
        self.all_points(SWEEP)
        path = self.points() / next(iter(self.finished()))
        path.unlink()
        path.mkdir()
        (path / "inside").write_text("kept")
        done = self.call("sweep", "--resume", **SWEEP, out="sweep.h5")
        self.assertIn("set aside", done.stderr)
        self.assertEqual((self.points() / f"{path.name}.aside-1" / "inside").read_text(), "kept")
        self.assert_same_data("sweep.h5", "whole.h5")

    def test_of_unfinished_points(self):
        self.call("sweep", **SLOW, out="slow.h5")
        for change in (truncated, emptied, flipped_at(9000, 0)):
            self.interrupted(**SLOW, out="sweep.h5")
            names = [name for name in self.shards() if name.endswith(".part.h5")]
            self.assertTrue(names)
            self.check_mended(self.damage(names, change), "slow.h5", SLOW)

    def foreign(self, **changes):
        """The finished points of another sweep under the same names."""
        self.all_points({**SWEEP, **changes}, out="other.h5")
        files = self.finished("other.h5")
        shutil.rmtree(self.points("other.h5"))
        return files

    def test_of_another_sweep(self):
        for changes in ({"seed": 2}, {"depth": 101}, {"tilts": [0, 0.001, 0.011]},
                        {"view_angles": [0.1]}, {"samples": 4001}, {"target_error": 0.5},
                        {"reversed_paths": "no"}):
            with self.subTest(changes=changes):
                others = self.foreign(**changes)
                self.all_points(SWEEP)
                self.assertEqual(others.keys(), self.finished().keys())
                name = list(others)[2]
                damaged = self.damage([name], lambda _: others[name])
                for line in self.check_mended(damaged):
                    self.assertIn("another sweep", line)

    def test_of_another_point(self):
        self.all_points(SWEEP)
        first, second, *_ = files = self.finished()
        self.check_mended(self.damage([first], lambda _: files[second]))

    def test_of_unfinished_points_of_another_sweep(self):
        keys = {**SLOW, "optical_depth": [3], "samples": 3_000_000}
        self.call("sweep", **keys, out="slow.h5")
        self.interrupted(**keys, seed=2, out="sweep.h5")
        for line in self.check_mended(self.shards(), "slow.h5", keys):
            self.assertIn("another sweep", line)

    def test_of_an_unfinished_point_under_a_finished_ones_name(self):
        self.interrupted(**SLOW, out="sweep.h5")
        name = next(name for name in self.shards() if name.endswith(".part.h5"))
        path = self.points() / name
        path.rename(self.points() / name.replace(".part.h5", ".h5"))
        self.call("sweep", **SLOW, out="slow.h5")
        done = self.call("sweep", "--resume", **SLOW, out="sweep.h5")
        self.assertIn("cannot be used", done.stderr)
        self.assert_same_data("sweep.h5", "slow.h5")

    def test_time_and_again(self):
        """What was set aside before is kept as well."""
        kept = {}
        for number in (1, 2, 3):
            self.all_points({**SWEEP, "resume": True})
            name = next(iter(self.finished()))
            damaged = self.damage([name], flipped_at(100 * number, 0))
            kept[f"{name}.aside-{number}"] = damaged[name]
            self.call("sweep", "--resume", **SWEEP, out="sweep.h5")
            self.assertEqual(self.shards(), kept)
            (self.folder / "sweep.h5").unlink()


class MergeOfDamage(SweepTest):
    def setUp(self):
        super().setUp()
        self.call("sweep", **SWEEP, out="whole.h5")
        self.all_points(SWEEP)
        self.names = list(self.finished())

    def change(self, name, data):
        (self.points() / name).write_bytes(data)

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
        for name in self.names[:2]:
            (self.points() / name).unlink()
        self.check_refused("2 of 8", "--partial")
        self.check_partial(2)

    def test_damaged(self):
        for change in (truncated, emptied, flipped_at(7000, 5)):
            whole = (self.points() / self.names[0]).read_bytes()
            self.change(self.names[0], change(whole))
            done = self.check_refused("1 of 8", self.names[0][:-3], "--partial")
            self.assertIn(f"{self.names[0][:-3]} is damaged", done.stderr)
            self.check_partial(1)
            (self.folder / "sweep.h5").unlink()
            self.change(self.names[0], whole)
        self.call("merge", out="sweep.h5")
        self.assert_same_data("sweep.h5", "whole.h5")

    def test_of_another_sweep(self):
        """Whichever of the files comes first in the folder."""
        self.all_points({**SWEEP, "seed": 2}, out="other.h5")
        for name in self.names:
            own = (self.points() / name).read_bytes()
            self.change(name, (self.points("other.h5") / name).read_bytes())
            done = self.check_refused("1 of 8", name[:-3])
            self.assertIn("another sweep", done.stderr)
            self.check_partial(1)
            (self.folder / "sweep.h5").unlink()
            self.change(name, own)

    def test_then_resumed(self):
        """A partial result is no end."""
        (self.points() / self.names[0]).unlink()
        self.check_partial(1)
        self.call("sweep", "--resume", **SWEEP, out="sweep.h5")
        self.assert_same_data("sweep.h5", "whole.h5")

    def test_nothing_there(self):
        for name in self.names:
            (self.points() / name).unlink()
        self.check_refused("sweep.h5.shards")
        self.assert_one_line(self.call("merge", out="none.h5", status=2).stderr, "none.h5.shards")
        done = self.call("merge", "--partial", out="none.h5", status=2)
        self.assert_one_line(done.stderr, "none.h5.shards")

    def test_unfinished_only(self):
        self.interrupted(**{**SLOW, "optical_depth": [3], "samples": 2_000_000}, out="slow.h5")
        self.assert_one_line(self.call("merge", out="slow.h5", status=2).stderr, "slow.h5.shards")


if __name__ == "__main__":
    unittest.main()
