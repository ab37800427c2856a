"""Each tutorial runs, draws its picture, and finds its own assertions true, within a minute."""

import os
import subprocess
import sys
import unittest

from package import ROOT, PackageTest

TUTORIALS = sorted((ROOT / "docs/tutorials").glob("*.py"))
MOST_S = 60 * float(os.environ.get("FLATSPECKLE_SLOWNESS", 1))


class Tutorials(PackageTest):
    def test_each(self):
        environment = {**os.environ, "PYTHONPATH": str(ROOT / "python"), "MPLBACKEND": "Agg"}
        for script in TUTORIALS:
            with self.subTest(tutorial=script.stem):
                done = subprocess.run([sys.executable, "-B", script], cwd=self.folder, capture_output=True, text=True,
                                      env=environment, timeout=MOST_S)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertTrue((self.folder / f"{script.stem}.png").is_file())

    def test_all_are_in_the_guide_with_their_pictures(self):
        guide = (ROOT / "docs/tutorials.md").read_text()
        for script in TUTORIALS:
            for name in (script.name, f"{script.stem}.png"):
                self.assertIn(f"(tutorials/{name})", guide)
                self.assertTrue(script.with_name(name).is_file())
        self.assertGreater(len(TUTORIALS), 6)


if __name__ == "__main__":
    unittest.main()
