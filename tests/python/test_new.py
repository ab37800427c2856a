"""`flatspeckle new PURPOSE` prints a scene that its subcommand accepts and that loads as a Scene."""

import re
import subprocess
import unittest

from package import PackageTest, fs

PURPOSES = ["memory-effect", "validate", "near-field", "waveguide", "lens", "imaging", "matrix", "tissue"]


def printed(*words):
    return subprocess.run([fs.program.path(), *words], capture_output=True, text=True)


class New(PackageTest):
    def test_each_is_a_scene_of_its_subcommand(self):
        for purpose in PURPOSES:
            with self.subTest(purpose=purpose):
                text = printed("new", purpose).stdout
                path = self.folder / "scene.toml"
                path.write_text(text)
                subcommand = re.search(r"flatspeckle (\w+) --config", text)[1]
                done = printed(subcommand, "--config", path, "--out", self.folder / "r.h5", "--print-config")
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertTrue(fs.Scene.load(path))

    def test_what_is_refused(self):
        for words in ([], ["nothing"], ["lens", "lens"]):
            done = printed("new", *words)
            self.assertEqual((done.returncode, done.stderr.count("\n"), done.stdout), (2, 1, ""))
            self.assertTrue(all(purpose in done.stderr for purpose in PURPOSES))


if __name__ == "__main__":
    unittest.main()
