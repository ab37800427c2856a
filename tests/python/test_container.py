"""The container's recipe, as far as it can be checked without a container: instructions, stages, paths, shell."""

import pathlib
import re
import subprocess
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
RECIPE = ROOT / "scripts/Containerfile"
KNOWN = {"FROM", "RUN", "COPY", "ENTRYPOINT"}


def instructions():
    """Returns (word, rest) of each line, with continued lines concatenated."""
    text = re.sub(r"\\\\\n", " ", RECIPE.read_text())
    lines = [line.strip() for line in text.splitlines()]
    return [tuple(line.split(maxsplit=1)) for line in lines if line and not line.startswith("#")]


class Container(unittest.TestCase):
    def test_instructions(self):
        words = [word for word, _ in instructions()]
        self.assertLessEqual(set(words), KNOWN)
        self.assertEqual((words[0], words[-1]), ("FROM", "ENTRYPOINT"))

    def test_stages_and_copies(self):
        stages = []
        for word, rest in instructions():
            if word == "FROM":
                found = re.fullmatch(r"[\w.-]+:[\w.-]+(?: AS (\w+))?", rest)
                self.assertTrue(found, rest)
                stages.append(found[1])
            if word == "COPY":
                stage, source = re.fullmatch(r"(?:--from=(\w+) )?(\S+) \S+", rest).groups()
                self.assertIn(stage, [None, *stages[:-1]])
                self.assertTrue(stage or (ROOT / source).exists(), source)

    def test_shell(self):
        for word, rest in instructions():
            if word == "RUN":
                self.assertEqual(subprocess.run(["sh", "-n", "-c", rest], capture_output=True).returncode, 0, rest)
        for script in re.findall(r"/flatspeckle/(scripts/\S+)", RECIPE.read_text()):
            self.assertTrue((ROOT / script).stat().st_mode & 0o100)
            self.assertEqual(subprocess.run(["bash", "-n", ROOT / script]).returncode, 0)

    def test_the_package_lies_where_it_is_copied_from(self):
        folder = re.search(r"cmake -S \. -B (\S+)", (ROOT / "scripts/package.sh").read_text())[1]
        self.assertIn(f"COPY --from=build /flatspeckle/{folder}/flatspeckle_*.deb", RECIPE.read_text())
        self.assertIn("build", (ROOT / ".dockerignore").read_text().split())


if __name__ == "__main__":
    unittest.main()
