"""Each tutorial runs within a minute, draws its picture, and its assertions hold; six of them by night."""

import contextlib
import multiprocessing
import os
import runpy
import sys
import traceback
import unittest

import matplotlib

matplotlib.use("Agg")

from package import ROOT, WHOLE, PackageTest

TUTORIALS = sorted((ROOT / "docs/tutorials").glob("*.py"))
BY_NIGHT = {"classics", "contrast_and_flow", "imaging", "lens", "own_cylinders", "waveguide"}
MOST_S = 60 * float(os.environ.get("FLATSPECKLE_SLOWNESS", 1))


class Tutorials(PackageTest):
    def run_script(self, script):
        """Runs `python SCRIPT` in the test's folder; its standard error goes to SCRIPT.error."""
        os.chdir(self.folder)
        with open(f"{script.stem}.error", "w") as heard, contextlib.redirect_stderr(heard):
            try:
                runpy.run_path(str(script), run_name="__main__")
            except BaseException:
                traceback.print_exc()
                sys.exit(1)

    def test_each(self):
        """Runs each in a fork of this process, which has loaded matplotlib and xarray."""
        for script in TUTORIALS:
            if script.stem in BY_NIGHT and not WHOLE:
                continue
            with self.subTest(tutorial=script.stem):
                process = multiprocessing.get_context("fork").Process(target=self.run_script, args=[script])
                process.start()
                process.join(MOST_S)
                process.kill()  # does nothing if it has ended
                process.join()
                self.assertEqual(process.exitcode, 0, (self.folder / f"{script.stem}.error").read_text())
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
