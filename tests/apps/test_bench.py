"""bench: the three kinds of benchmark, their rows and exit status, and the report from them."""

import json
import subprocess
import sys
import unittest

import h5py
import numpy as np

from program import DATA, ProgramTest

KINDS = ("error", "stability", "plan")
PLOTS = DATA.parent / "plots"


def texts(file, name):
    return [text.decode() for text in file[name][...]]


def report_of(folder, out):
    """Runs plots/report.py, which needs matplotlib."""
    files = [folder / f"{kind}.h5" for kind in KINDS]
    return subprocess.run([sys.executable, "-B", PLOTS / "report.py", *files, "--out", out],
                          capture_output=True, text=True, timeout=300)


def has_matplotlib():
    return subprocess.run([sys.executable, "-c", "import matplotlib"],
                          capture_output=True).returncode == 0


class Bench(ProgramTest):
    """Tests of results that are made once."""

    results = {}

    def bench(self, kind):
        """Returns the result file of a kind, and the output."""
        if kind not in self.results:
            done = self.call("bench", kind, "--quick", threads=2, out="bench.h5")
            self.results[kind] = (self.folder / "bench.h5").read_bytes(), done.stdout
        contents, printed = self.results[kind]
        path = self.folder / f"{kind}.h5"
        path.write_bytes(contents)
        return path, printed

    def test_stability(self):
        path, printed = self.bench("stability")
        with h5py.File(path) as file:
            names, refusals = texts(file, "name"), texts(file, "refusal")
            cases = set(zip(texts(file, "module"), names, texts(file, "invariant")))
            self.assertEqual(len(cases), len(names))
            self.assertTrue(np.all(file["passed"][...] == 1))
            self.assertTrue(file.attrs["converged"])
            within = file["figure"][...] <= file["limit"][...]
            for name, refusal, good in zip(names, refusals, within):
                self.assertIn(name, printed)
                self.assertIn(refusal, printed)
                self.assertTrue(refusal or good, name)
        self.assertIn(f"{len(names)} cases, 0 failed", printed)

    def test_plan(self):
        path, printed = self.bench("plan")
        with h5py.File(path) as file:
            self.assertEqual(set(texts(file, "module")),
                             {"mc", "transport", "fields", "fit", "imaging", "wave solver", "grin rays", "render", "design"})
            ratio = file["general_s"][...] / file["special_s"][...]
            np.testing.assert_allclose(ratio, file["ratio"][...], rtol=3)  # medians of few
            self.assertTrue(np.all(file["difference"][...] <= file["limit"][...]))
            self.assertTrue(np.all(file["passed"][...] == 1))
            for name in texts(file, "left_out"):
                self.assertIn(name, printed)

    def test_error(self):
        path, _ = self.bench("error")
        with h5py.File(path) as file:
            count = len(file["curve"])
            of_curve = file["of_curve"][...]
            self.assertTrue(np.all(np.diff(of_curve.astype(int)) >= 0))
            self.assertEqual(set(of_curve), set(range(count)))
            self.assertTrue(np.all(file["cpu_s"][...] > 0))
            self.assertTrue(np.all(file["relative_error"][...] > 0))
            self.assertTrue(all(texts(file, "reference")))

    @unittest.skipUnless(has_matplotlib(), "this python has no matplotlib")
    def test_report(self):
        for kind in KINDS:
            self.bench(kind)
        out = self.folder / "report"
        done = report_of(self.folder, out)
        self.assertEqual(done.returncode, 0, done.stderr)
        page, text = (out / "report.html").read_text(), (out / "report.md").read_text()
        for outside in ("http://", "https://", "<script", "<link"):
            self.assertNotIn(outside, page)
        for picture in out.glob("*.png"):
            self.assertIn(f"({picture.name})", text)
            self.assertLess(picture.stat().st_size, 300_000, picture.name)
        numbers = json.loads((out / "numbers.json").read_text())
        with h5py.File(self.folder / "stability.h5") as file:
            self.assertEqual(numbers["stability.rows"]["value"], len(file["case"]))
            for name in texts(file, "name"):
                self.assertIn(name.split("<")[0].split("|")[0], text)
        self.assertTrue(all(number["text"] for number in numbers.values()))

    def test_a_failing_row_is_told(self):
        """Reports a row that is made to fail, as none fails by itself."""
        if not has_matplotlib():
            self.skipTest("this python has no matplotlib")
        for kind in KINDS:
            self.bench(kind)
        with h5py.File(self.folder / "stability.h5", "r+") as file:
            file["passed"][0] = 0
        out = self.folder / "report"
        self.assertEqual(report_of(self.folder, out).returncode, 0)
        self.assertIn("**FAILED**", (out / "report.md").read_text())
        numbers = json.loads((out / "numbers.json").read_text())
        self.assertEqual(numbers["stability.failed"]["value"], 1)

    def test_bad_input(self):
        for words in ((), ("speed",), ("plan",), ("plan", "error")):
            done = self.call("bench", *words, status=2)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.call("bench", "plan", out="no/such/folder.h5", status=2)
        self.call("bench", "plan", out="x.h5", threads=-1, status=2)
        self.assertEqual(self.listing(), {})


if __name__ == "__main__":
    unittest.main()
