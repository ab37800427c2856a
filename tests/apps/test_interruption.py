"""Interrupted, killed and resumed runs: nothing is lost or damaged, and the numbers are the same."""

import random
import signal
import struct
import time
import unittest
import zlib

import h5py
import numpy as np

import journals
from program import BOX, RESUMES, TILTS, WHOLE, ProgramTest, attributes, catches, datasets, flags

# Each runs for 0.15 seconds or more on two threads.
LONG = {
    "mc": ("covariance", {**BOX, **TILTS, "samples": 600_000}),
    "wave": ("covariance", {**BOX, **TILTS, "samples": 5000, "method": "wave"}),
    "validate, in mc": ("validate", {**BOX, **TILTS, "samples": 600_000, "wave_samples": 20}),
    "validate, in wave": ("validate", {**BOX, **TILTS, "samples": 5000, "wave_samples": 8000}),
}
SHORT = {**BOX, **TILTS, "samples": 20_000, "threads": 2}
NEVER = 1e-9  # a target error that is not reached


def set_checksum(path):
    """Writes the checksum as the program does, so that it accepts a changed file."""
    data = path.read_bytes()
    path.write_bytes(data + struct.pack("<4sIQ", b"seal", zlib.crc32(data), len(data)))


class Interruption(ProgramTest):
    def interrupt(self, number, delay, *words, caught=RESUMES, **keys):
        """Signals once the run has begun, i.e. handles `caught`; returns the exit status."""
        process = self.start(*words, **keys)
        self.wait_until_it_catches(process, caught)
        time.sleep(delay)
        process.send_signal(number)
        return process.wait(timeout=60)

    def check_resumable(self, name):
        with h5py.File(self.folder / name) as file:
            self.assertEqual(file.attrs["converged"], 0)
            self.assertIn("identity", file.attrs)
            self.assertIn("state", file)
        self.assertEqual([path for path in self.listing() if ".tmp" in path], [])
        self.assertIn("--resume", self.call("explain", name).stdout)
        self.assertIn("continue it with --resume", self.call("export", name, "intensity", status=2).stderr)

    def test_resumed_equals_uninterrupted(self):
        """Covers both parts of `validate` by night, its second one by day."""
        for name, (subcommand, keys) in LONG.items():
            if name == "validate, in mc" and not WHOLE:
                continue
            with self.subTest(run=name):
                out = {"out": f"{name}.h5", "threads": 2}
                for number, delay in ((signal.SIGINT, 0.05), (signal.SIGTERM, 0.02)):
                    status = self.interrupt(number, delay, subcommand, "--resume", **keys, **out)
                    self.assertEqual(status, 75)
                    self.check_resumable(out["out"])
                done = self.call(subcommand, "--resume", **keys, **out)
                self.assertIn("wrote", done.stdout)
                self.call(subcommand, **keys, out="whole.h5")
                self.assert_same_data(out["out"], "whole.h5")
                self.check_complete(out["out"], "whole.h5")

    def check_complete(self, resumed, whole):
        resumed, whole = attributes(self.folder / resumed), attributes(self.folder / whole)
        self.assertEqual(resumed["converged"], 1)
        for key in ("samples", "identity", "plan", "seed"):
            self.assertEqual(resumed[key], whole[key])

    def test_before_the_second_batch(self):
        lights = [1e-4 * i for i in range(6000)]
        status = self.interrupt(signal.SIGTERM, 0.05, "flux", **BOX, light_angles=lights,
                                threads=1, out="run.h5", samples=1_000_000)
        self.assertIn((status, list(self.listing())), [(130, []), (75, ["run.h5"])])

    def test_within_one_solution_of_many(self):
        keys = {"width": 80, "depth": 80, "count": 3000, "wavelengths": [0.9, 1.1],
                "wavelength_count": 2, "solver": "dense", "threads": 1, "out": "run.h5"}
        self.assertEqual(self.interrupt(signal.SIGTERM, 0.4, "solve", caught=signal.SIGTERM, **keys), 130)
        self.assertEqual(list(self.listing()), [])

    def test_an_older_result_is_kept(self):
        self.call("covariance", **SHORT, out="run.h5")
        older = (self.folder / "run.h5").read_bytes()
        keys = {**LONG["mc"][1], "threads": 2, "out": "run.h5"}
        for aside in (("run.h5.aside-1",), ("run.h5.aside-1", "run.h5.aside-2")):
            self.assertEqual(self.interrupt(signal.SIGINT, 0.05, "covariance", **keys), 75)
            self.check_resumable("run.h5")
            self.assertEqual(sorted(self.listing()), ["run.h5", *aside])
            self.assertEqual((self.folder / "run.h5.aside-1").read_bytes(), older)
        self.call("covariance", "--resume", **keys)
        self.call("covariance", **SHORT, out="run.h5")
        self.assert_same_data("run.h5", "run.h5.aside-1")

    def test_the_trace_goes_on_by_other_threads_to_another_stop(self):
        keys = LONG["mc"][1]
        self.interrupt(signal.SIGINT, 0.05, "covariance", **keys, threads=2, out="run.h5")
        before = datasets(self.folder / "run.h5", leave_out=())["state/run/trace/samples"]
        keys = {**keys, "samples": 700_000}
        self.call("covariance", "--resume", **keys, threads=3, out="run.h5")
        trace = datasets(self.folder / "run.h5", leave_out=())
        samples = trace["trace/samples"]
        np.testing.assert_array_equal(samples[:len(before) - 1], before[:-1])
        self.assertEqual(samples[-1], keys["samples"])
        self.assertTrue(np.all(np.diff(trace["trace/wall_s"]) >= 0))
        self.call("covariance", **keys, out="whole.h5")
        self.assert_same_data("run.h5", "whole.h5")

    def test_a_part_that_waits_its_turn_is_kept(self):
        """While the first part takes more samples, the file still contains the second one."""
        scene = LONG["validate, in wave"][1]
        self.interrupt(signal.SIGINT, 0.1, "validate", **scene, threads=2, out="run.h5")
        before = datasets(self.folder / "run.h5", leave_out=())["state/wave/group_sums"]
        more = {**scene, "samples": 50_000_000}
        status = self.interrupt(signal.SIGINT, 0.05, "validate", "--resume", **more, threads=2,
                                out="run.h5")
        self.assertEqual(status, 75)
        after = datasets(self.folder / "run.h5", leave_out=())
        np.testing.assert_array_equal(after["state/wave/group_sums"], before)
        with h5py.File(self.folder / "run.h5") as file:
            self.assertGreater(file["state/mc/group_samples"][()].sum(), scene["samples"])

    def test_that_it_begins_anew_is_said(self):
        keys = {**LONG["mc"][1], "threads": 2, "out": "run.h5"}
        self.interrupt(signal.SIGINT, 0.05, "covariance", **keys)
        for noted, of in ((True, {}), (False, {}), (False, {"seed": 2})):
            done = self.call("covariance", **{**keys, **of, "samples": 1000})
            self.assertEqual("--resume would continue it" in done.stderr, noted)

    def test_another_seed_may_not(self):
        keys = LONG["mc"][1]
        self.interrupt(signal.SIGINT, 0.05, "covariance", **keys, threads=2, out="run.h5")
        before = self.listing()
        self.call("covariance", "--resume", **keys, seed=2, out="run.h5", status=2)
        self.assertEqual(self.listing(), before)

    def test_a_second_signal_ends_at_once(self):
        self.call("covariance", **SHORT, out="run.h5")
        before = self.listing()
        process = self.start("covariance", width=200, depth=200, count=3000, method="wave",
                             threads=1, samples=9, out="run.h5")
        self.wait_until_it_catches(process)
        time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        self.wait_until(process, lambda: not catches(process, signal.SIGINT))
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=60), -signal.SIGINT)
        (self.folder / ".run.h5.lock").unlink()  # no longer locked
        self.assertEqual(self.listing(), before)

    def test_solve_ends_at_once(self):
        """A solve has nothing to resume."""
        process = self.start("solve", width=200, depth=200, count=3000, out="run.h5")
        self.wait_until_it_catches(process, signal.SIGINT)
        time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=60), 130)
        self.assertEqual(self.listing(), {})


RAYS = {"field": "parabolic", "alpha": 0.5, "index": 1.5, "connect": [0, 0, 0, 0.3, 0, 3], "max_length": 5}


class Alike(ProgramTest):
    """SIGINT, SIGTERM and SIGHUP do the same, and leave only files that can be resumed."""

    def ended(self, process, number, delay=0.1):
        self.wait_until(process, lambda: catches(process, number) and
                        list(self.folder.glob(".*.lock")))
        time.sleep(delay)
        process.send_signal(number)
        return process.wait(timeout=60)

    def test_what_cannot_go_on(self):
        self.write("frames.csv", "a\n" + "".join(f"{i * i % 97}\n" for i in range(4000)))
        for words, keys in (("trace", {**RAYS, "trials": 10**7}),
                            ("solve", {"width": 200, "depth": 200, "count": 3000}),
                            ("place", {"width": 30, "depth": 30, "radii": 0.4, "packing_fraction": 0.5,
                                       "structure": "s.h5", "realizations": 10**6}),
                            ("recover", {"frames": "frames.csv", "points": 40, "recovery": "phases",
                                         "starts": 10000, "phase_iterations": 100000})):
            out = "x.csv" if words == "place" else "x.h5"
            for number in (signal.SIGHUP, signal.SIGTERM)[:2 if WHOLE else 1]:
                with self.subTest(words=words, number=number):
                    self.assertEqual(self.ended(self.start(words, **keys, out=out), number), 130)
                    (self.folder / "x.csv").unlink(missing_ok=True)  # before its structure factor
                    self.assertEqual([path.name for path in self.folder.iterdir()], ["frames.csv"])

    def test_a_fit_goes_on(self):
        self.write("curve.csv", "tilt,field_correlation,error\n0.002,0.8,0.05\n0.004,0.6,0.05\n")
        keys = {"free": "g=0:0.8", "depth": 100, "optical_depth": 2, "measurement": "curve.csv",
                "method": "mc", "model_share": 0.01, "threads": 1}
        self.call("fit", **keys, out="whole.h5")
        for number in (signal.SIGTERM, signal.SIGHUP):
            process = self.start("fit", **keys, out="x.h5")
            self.wait_until(process, lambda: (self.folder / "x.h5.search").exists() and
                            len(journals.records(self.folder / "x.h5.search")) > 2)
            process.send_signal(number)
            self.assertEqual(process.wait(timeout=60), 75)
            self.assertEqual(sorted(path.name for path in self.folder.iterdir()),
                             ["curve.csv", "whole.h5", "x.h5.search"])
            self.call("fit", "--resume", **keys, out="x.h5")
            self.assert_same_data("x.h5", "whole.h5")
            (self.folder / "x.h5").unlink()
        self.check_other_measurement(keys)

    def check_other_measurement(self, keys):
        """Checks that a fit is not resumed with a table that has changed, though only in its errors."""
        process = self.start("fit", **keys, out="x.h5")
        self.wait_until(process, lambda: (self.folder / "x.h5.search").exists() and
                        len(journals.records(self.folder / "x.h5.search")) > 0)
        process.kill()
        process.wait()
        self.write("curve.csv", "tilt,field_correlation,error\n0.002,0.8,0.05\n0.004,0.6,0.02\n")
        refused = self.call("fit", "--resume", **keys, out="x.h5", status=2)
        self.assertIn("another search", refused.stderr)


class Links(ProgramTest):
    def test_a_link_is_the_file_that_it_leads_to(self):
        """The second of two runs to one file by two names is rejected; the older result is kept until the
        new one is there."""
        self.call("covariance", **SHORT, seed=5, out="run.h5")
        older = (self.folder / "run.h5").read_bytes()
        (self.folder / "alias.h5").symlink_to("run.h5")
        keys = {**BOX, **TILTS, "samples": 50_000_000, "threads": 1}
        for first, second in (("alias.h5", "run.h5"), ("run.h5", "alias.h5")):
            process = self.start("covariance", **keys, out=first)
            self.wait_until_it_catches(process)
            for words in (["covariance", *flags({**SHORT, "seed": 2})], ["design"]):
                refused = self.call(*words, out=second, status=2)
                self.assertIn("works on it", refused.stderr)
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.wait(timeout=60), 75)
            self.assertTrue((self.folder / "alias.h5").is_symlink())
            aside = self.folder / "run.h5.aside-1"
            self.assertEqual(aside.read_bytes(), older)
            self.assertFalse(aside.is_symlink())
            aside.replace(self.folder / "run.h5")
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["alias.h5", "run.h5"])


class Kill(ProgramTest):
    def test_killed_at_any_moment(self):
        duration = self.seconds_of("covariance", **SHORT, out="whole.h5")
        self.call("covariance", **SHORT, seed=2, out="older.h5")
        older = (self.folder / "older.h5").read_bytes()
        moments = random.Random(1)
        for previous in (None, older) * 4:
            (self.folder / "run.h5").unlink(missing_ok=True)
            if previous:
                (self.folder / "run.h5").write_bytes(previous)
            process = self.start("covariance", **SHORT, out="run.h5")
            time.sleep(moments.random() * duration)
            process.kill()
            process.wait()
            self.check_left_behind(previous)
        self.write(".run.h5.tmp-1", "left behind")
        self.call("covariance", **SHORT, out="run.h5")
        self.assertEqual([path.name for path in self.folder.iterdir() if path.name.startswith(".")], [])
        self.assert_same_data("run.h5", "whole.h5")

    def check_left_behind(self, previous):
        path = self.folder / "run.h5"
        if not path.exists():
            self.assertIsNone(previous)
        elif path.read_bytes() != previous:
            self.assert_same_data("run.h5", "whole.h5")


class Target(ProgramTest):
    def test_not_reached_then_resumed(self):
        done = self.call("covariance", **SHORT, target_error=NEVER, out="run.h5", status=3)
        self.assertIn("--resume", done.stdout)
        self.assertEqual(attributes(self.folder / "run.h5")["converged"], 0)
        self.call("covariance", **SHORT, out="whole.h5")
        self.assert_same_data("run.h5", "whole.h5")

        more = {**SHORT, "samples": 50_000}
        self.call("covariance", "--resume", **more, target_error=NEVER, out="run.h5", status=3)
        self.call("covariance", **more, out="whole.h5")
        self.assert_same_data("run.h5", "whole.h5")

        self.call("covariance", "--resume", **more, target_error=0.5, out="run.h5")
        self.assert_same_data("run.h5", "whole.h5")
        self.assertEqual(attributes(self.folder / "run.h5")["converged"], 1)

    def test_not_reached_by_one_part_of_validate(self):
        scene = {**BOX, **TILTS, "samples": 400_000, "wave_samples": 20, "target_error": 0.05}
        self.call("validate", **scene, out="run.h5", status=3)
        self.call("validate", "--resume", **{**scene, "wave_samples": 40}, out="run.h5", status=3)
        self.call("validate", **{**scene, "wave_samples": 40}, out="whole.h5", status=3)
        self.assert_same_data("run.h5", "whole.h5")

    def test_reached(self):
        self.call("covariance", **{**SHORT, "samples": None}, target_error=0.05, out="run.h5")
        with h5py.File(self.folder / "run.h5") as file:
            self.assertLessEqual(file["trace/relative_error"][-1], 0.05)
            self.assertEqual(file.attrs["converged"], 1)

    def test_seconds(self):
        started = time.monotonic()
        self.call("covariance", **{**SHORT, "samples": None}, seconds=0.1, out="run.h5")
        self.assertLess(time.monotonic() - started, 20)
        self.call("covariance", **{**SHORT, "samples": None}, seconds=0.1, target_error=NEVER,
                  out="run.h5", status=3)


WIDE = {**BOX, "covariance": "full", "light_angles": [1e-2 * i for i in range(14)],
        "view_angles": [1e-2 * i for i in range(1, 15)], "threads": 2}  # with 19306 sums


class Extension(ProgramTest):
    """A finished run is extended on request, with the result of a run of the full length."""
    SLAB = {"domain": "slab", "depth": 100, "scatterer": "hg", "optical_depth": 2, "g": 0.5}
    RUNS = {"covariance": ({**SHORT}, {"samples": 61_000}),
            "flux": ({**SLAB, "samples": 20_000}, {"samples": 60_000}),
            "validate": ({**SHORT, "wave_samples": 20}, {"wave_samples": 50})}

    def check_same(self, first, second):
        self.assert_same_data(first, second)
        for key in ("samples", "converged", "identity", "plan"):
            self.assertEqual(attributes(self.folder / first)[key],
                             attributes(self.folder / second)[key])

    def test_by_samples(self):
        for subcommand, (keys, more) in self.RUNS.items():
            with self.subTest(run=subcommand):
                self.call(subcommand, **keys, out="run.h5")
                done = self.call(subcommand, "--resume", **{**keys, **more}, out="run.h5")
                self.assertIn("wrote", done.stdout)
                self.call(subcommand, **{**keys, **more}, out="whole.h5")
                self.check_same("run.h5", "whole.h5")

    def test_by_target_error(self):
        keys = {**SHORT, "samples": None, "out": "run.h5"}
        for target in (0.05, 0.04, 0.02):
            self.call("covariance", "--resume", **keys, target_error=target)
        self.call("covariance", **{**keys, "out": "whole.h5"}, target_error=0.02)
        self.check_same("run.h5", "whole.h5")

    def test_by_seconds(self):
        keys = {**SHORT, "samples": None, "out": "run.h5"}
        samples = []
        for seconds in (0.2, 0.5):
            self.call("covariance", "--resume", **keys, seconds=seconds)
            samples.append(attributes(self.folder / "run.h5")["samples"])
        self.assertLess(samples[0], samples[1])

    def test_large_sums_are_kept_on_demand(self):
        """An interrupted run that starts afresh keeps the finished result; by night its result is the same."""
        for keeps, samples, afresh in ((True, 112_000, False), (False, 116_000, False), (False, 120_000, True))[:3 if WHOLE else 2]:
            done = self.call("covariance", **WIDE, keep_state=keeps, samples=samples, out="run.h5", resume=True)
            self.assertEqual("--keep_state" in done.stdout, not keeps)
            self.assertEqual("does not contain the sums" in done.stderr, afresh)
        self.check_interrupted_afresh()
        if WHOLE:
            self.call("covariance", **WIDE, samples=120_000, out="whole.h5")
            self.check_same("run.h5", "whole.h5")

    def check_interrupted_afresh(self):
        finished = (self.folder / "run.h5").read_bytes()
        process = self.start("covariance", "--resume", **WIDE, samples=50_000_000, out="run.h5")
        self.wait_until_it_catches(process)
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=60), 75)
        self.assertEqual((self.folder / "run.h5.aside-1").read_bytes(), finished)
        (self.folder / "run.h5.aside-1").rename(self.folder / "run.h5")


class Resume(ProgramTest):
    def test_other_sensors_in_the_same_file_may_not(self):
        keys = {**BOX, "samples": 3000, "target_error": NEVER, "near_sensors": "s.csv"}
        self.write("s.csv", "x,z\n0,15\n1,15\n")
        self.call("covariance", **keys, out="run.h5", status=3)
        self.write("s.csv", "x,z\n0,15\n1,15.000000000000002\n")
        before = self.listing()
        done = self.call("covariance", "--resume", **keys, out="run.h5", status=2)
        self.assertIn("sensors", done.stderr)
        self.assertEqual(self.listing(), before)
        self.write("s.csv", "z,x\n15,0\n15,1\n")
        self.call("covariance", "--resume", **keys, out="run.h5", status=3)

    def test_another_version_may_not(self):
        self.call("covariance", **SHORT, target_error=NEVER, out="run.h5", status=3)
        with h5py.File(self.folder / "run.h5", "r+") as file:
            version = file.attrs["version"]
            self.assertIn(f"flatspeckle {version}\n", file.attrs["identity"])
            file.attrs["identity"] = file.attrs["identity"].replace(version, "0.0.0")
        set_checksum(self.folder / "run.h5")
        done = self.call("covariance", "--resume", **SHORT, out="run.h5", status=2)
        self.assertIn("another run (flatspeckle 0.0.0)", done.stderr)

    def test_of_a_finished_run_changes_nothing(self):
        self.call("covariance", **SHORT, out="run.h5")
        before = self.listing()
        done = self.call("covariance", "--resume", **SHORT, out="run.h5")
        self.assertIn("complete; this call requests no more", done.stdout)
        self.call("covariance", "--resume", **{**SHORT, "samples": 2000}, out="run.h5")
        self.call("covariance", "--resume", **SHORT, seconds=1e-3, out="run.h5")
        self.assertEqual(self.listing(), before)

    def test_of_nothing_starts_afresh(self):
        self.call("covariance", "--resume", **SHORT, out="run.h5")
        self.call("covariance", **SHORT, out="whole.h5")
        self.assert_same_data("run.h5", "whole.h5")

    def test_without_resume_a_result_is_replaced(self):
        self.call("covariance", **SHORT, seed=2, out="run.h5")
        self.call("covariance", **SHORT, out="run.h5")
        self.call("covariance", **SHORT, out="whole.h5")
        self.assert_same_data("run.h5", "whole.h5")

    def test_from_the_stored_configuration(self):
        self.call("covariance", **SHORT, target_error=NEVER, out="run.h5", status=3)
        self.write("run.toml", attributes(self.folder / "run.h5")["config"])
        self.call("covariance", config="run.toml", resume=True, target_error=0.9, out="run.h5")


if __name__ == "__main__":
    unittest.main()
